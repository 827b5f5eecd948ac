//! The table, and the page that reads it.

use std::fmt::Write as _;

use crate::case::Row;

pub(crate) struct Model {
    pub(crate) name: &'static str,
    /// With ever smaller tolerances.
    pub(crate) alone: Vec<Row>,
    pub(crate) split: Vec<Row>,
}

/// Triangles that displacement alone takes to look as much like the surface.
enum Alone {
    About(f64),
    /// None that was tried does.
    MoreThan(u64),
}

impl Model {
    /// Between two that were tried, the logarithm of the count by the logarithm of FLIP.
    fn alone_at(&self, flip: f64) -> Alone {
        let Some(k) = self.alone.iter().position(|row| row.flip <= flip) else {
            return Alone::MoreThan(self.alone.iter().map(|row| row.triangles).max().unwrap_or(0));
        };
        let fine = &self.alone[k];
        let Some(coarse) = k.checked_sub(1).map(|k| &self.alone[k]) else {
            return Alone::About(fine.triangles as f64);
        };
        let share = (coarse.flip / flip).ln() / (coarse.flip / fine.flip).ln();
        let [a, b] = [coarse, fine].map(|row| (row.triangles as f64).ln());
        Alone::About((a + share * (b - a)).exp())
    }

    fn saving(&self, row: &Row) -> (String, f64) {
        match self.alone_at(row.flip) {
            Alone::About(count) => (format!("{count:.0}"), count / row.triangles as f64),
            Alone::MoreThan(count) => (format!("> {count}"), count as f64 / row.triangles as f64),
        }
    }
}

pub(crate) fn csv(models: &[Model]) -> String {
    let mut text = String::from(
        "model,kind,tolerance,triangles,bytes,flip_mean,silhouette_xor_px,bound_diagonal,angle_p50_deg,angle_p99_deg,alone_triangles,saving\n",
    );
    for model in models {
        for (kind, rows) in [("alone", &model.alone), ("split", &model.split)] {
            for row in rows {
                let [p50, p99] = row.angles.map_or_else(Default::default, |a| a.map(|x| format!("{x:.3}")));
                let (alone, saving) = if kind == "split" { model.saving(row) } else { (String::new(), f64::NAN) };
                let saving = if saving.is_nan() { String::new() } else { format!("{saving:.1}") };
                let Row { tolerance, triangles, bytes, flip, silhouette_px, bound, .. } = row;
                let _ = writeln!(
                    text,
                    "{},{kind},{tolerance},{triangles},{bytes},{flip:.6},{silhouette_px},{bound:.3e},{p50},{p99},{alone},{saving}",
                    model.name
                );
            }
        }
    }
    text
}

pub(crate) fn markdown(models: &[Model]) -> String {
    let mut text = String::from(
        "# What a normal map saves in triangles

`DISPLACE_CORPUS=... cargo run -p displace-tests --example split` makes this page and [`split.csv`](split.csv).

A mesh is displaced within a tolerance, a share of the diagonal, and a normal map is made for what its triangles leave out of the
surface (`apply --normals map`). Its picture, 256 x 256 pixels of 64 samples, is compared with that of the surface itself, by as many
rays (`render --exact`). The same is done with meshes that are displaced alone, with the surface's normals at their vertices, for
tolerances from 1e-2 to 3e-4; how many triangles those take to have the split's FLIP is read between the two nearest,
by logarithms. The report of a split states both errors: the bound of the geometry, certified, and the angle between the map's
normals and the surface's, half of the places and 99 of 100.

| model | tolerance | triangles | bytes | FLIP | outline px | bound | angle p50 / p99 | alone, same FLIP | saving |
|---|---|---|---|---|---|---|---|---|---|
",
    );
    for model in models {
        for row in &model.split {
            let (alone, saving) = model.saving(row);
            let at_least = if alone.starts_with('>') { "> " } else { "" };
            let [p50, p99] = row.angles.unwrap_or([f64::NAN; 2]);
            let _ = writeln!(
                text,
                "| {} | {} | {} | {} | {:.4} | {} | {:.2e} | {p50:.2}° / {p99:.2}° | {alone} | {at_least}{saving:.1} x |",
                model.name, row.tolerance, row.triangles, row.bytes, row.flip, row.silhouette_px, row.bound
            );
        }
    }
    text += &alone(models);
    text
}

fn alone(models: &[Model]) -> String {
    let mut text = String::from(
        "\nDisplaced alone:\n\n| model | tolerance | triangles | bytes | FLIP | outline px |\n|---|---|---|---|---|---|\n",
    );
    for model in models {
        for row in &model.alone {
            let Row { tolerance, triangles, bytes, flip, silhouette_px, .. } = row;
            let name = model.name;
            let _ = writeln!(text, "| {name} | {tolerance} | {triangles} | {bytes} | {flip:.4} | {silhouette_px} |");
        }
    }
    text
}
