//! What the cases come to, by their table.

use std::{collections::BTreeMap, fmt::Write as _};

/// What is no more than this share above the cheapest is on the front.
const NEAR: f64 = 1.1;

/// One row, by the names of the columns.
struct Case<'t>(BTreeMap<&'t str, &'t str>);

impl Case<'_> {
    fn text(&self, column: &str) -> &str {
        self.0.get(column).copied().unwrap_or_default()
    }

    fn number(&self, column: &str) -> f64 {
        self.text(column).parse().unwrap_or(f64::NAN)
    }

    fn is_kept(&self) -> bool {
        self.text("within") == "true"
    }

    fn is_near(&self, column: &str) -> bool {
        self.number("cost") <= NEAR * self.number(column)
    }

    /// Of what displacing takes, what this leaves out.
    fn saved(&self, [own, displaced]: [&str; 2]) -> f64 {
        1.0 - self.number(own) / self.number(displaced).max(f64::MIN_POSITIVE)
    }
}

/// Of a table with its head.
pub(crate) fn page(csv: &str) -> String {
    let mut lines = csv.lines();
    let columns: Vec<&str> = lines.next().unwrap_or_default().split(',').collect();
    let cases: Vec<Case<'_>> = lines.map(|line| Case(columns.iter().copied().zip(line.split(',')).collect())).collect();
    let all: Vec<&Case<'_>> = cases.iter().collect();
    let count = |is: &dyn Fn(&Case<'_>) -> bool| cases.iter().filter(|case| is(case)).count();
    let mut text = format!(
        "# What `--method auto` chooses, and what that costs

`cargo run -p displace-tests --example auto -- --out tests/charts/auto.csv` measures it, `-- --page tests/charts/auto.csv` makes this
page of it: {} cases, each a mesh of the corpus with a map on it, from one of four places, 192 x 192 pixels, with one of three
tolerances. Errors are those of the image: the reprojection error that 99 of 100 covered pixels do not exceed, and the pixels
inside one outline alone, of the image or of the surface, for each pixel of the outline. Costs are counted pixels, rays, lookups,
vertices and triangles by the cost model of lavapipe on two cores, triangles and vertices of all that is displaced.

* Within the tolerance, by both errors: {}.
* Off by no more than predicted: {}.
* No more than 10 % dearer than the cheapest of eleven others that is as near: {}.
* No more than 10 % dearer than the cheapest of these that is within the tolerance, which only measuring all of them tells: {}.

",
        cases.len(),
        count(&|case| case.is_kept()),
        count(&|case| case.number("measured_px") <= case.number("predicted_px")),
        count(&|case| case.is_near("front_cost")),
        count(&|case| case.is_near("enough_cost")),
    );
    text += "| tolerance | cases | chosen | cost saved, median | triangles saved, median | time saved, median |\n|---|---|---|---|---|---|\n";
    for tolerance in ["0.5", "1.5", "5"] {
        let own: Vec<&Case<'_>> = cases.iter().filter(|case| case.text("tolerance_px") == tolerance).collect();
        let _ = writeln!(text, "| {tolerance} px | {}", row(&own));
    }
    let _ = writeln!(text, "| all | {}", row(&all));
    // From far away displacing leaves a mesh as it is.
    let least = |scene: &str| {
        let own = cases.iter().filter(|case| case.text("scene") == scene);
        own.map(|case| case.number("displaced_triangles")).fold(f64::INFINITY, f64::min)
    };
    let is_refined = |case: &&Case<'_>| case.number("displaced_triangles") > 2.0 * least(case.text("scene"));
    let refined: Vec<&Case<'_>> = cases.iter().filter(is_refined).collect();
    let _ = writeln!(text, "| all where displacing more than doubles a mesh's triangles | {}", row(&refined));
    text += "\nSaved against displacing within the same tolerance: what is above 0 auto does without, below 0 it takes more. Time is that of \
             all passes, choosing and measuring among them, but for what a map or a device needs once.\n";
    for (title, misses) in [
        ("Not within the tolerance", cases.iter().filter(|case| !case.is_kept()).collect::<Vec<_>>()),
        (
            "More than 10 % dearer than what is as near",
            cases.iter().filter(|case| !case.is_near("front_cost")).collect(),
        ),
    ] {
        if !misses.is_empty() {
            text += &listed(title, &misses);
        }
    }
    text
}

fn row(cases: &[&Case<'_>]) -> String {
    let mut chosen: BTreeMap<&str, usize> = BTreeMap::new();
    for case in cases {
        *chosen.entry(case.text("method")).or_default() += 1;
    }
    let chosen: Vec<String> = chosen.iter().map(|(method, count)| format!("{method} {count}")).collect();
    let saved = |columns| 100.0 * median(cases.iter().map(|case| case.saved(columns)).collect());
    let (cost, triangles, time) =
        (saved(["cost", "displaced_cost"]), saved(["triangles", "displaced_triangles"]), saved(["ms", "displaced_ms"]));
    format!("{} | {} | {cost:.0} % | {triangles:.0} % | {time:.0} % |", cases.len(), chosen.join(", "))
}

fn listed(title: &str, cases: &[&Case<'_>]) -> String {
    let mut text = format!(
        "\n## {title}\n\n| scene | view | tolerance | chosen | error | outline | cost | cheaper | its cost |\n|---|---|---|---|---|---|---|---|---|\n"
    );
    for case in cases {
        let of = |column: &str| case.text(column);
        let _ = writeln!(
            text,
            "| {} | {} | {} px | {} {} | {} px | {} px | {} | `{}` | {} |",
            of("scene"),
            of("view"),
            of("tolerance_px"),
            of("method"),
            of("setting"),
            of("measured_px"),
            of("outline_px"),
            of("cost"),
            of("front"),
            of("front_cost")
        );
    }
    text
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values.get(values.len() / 2).copied().unwrap_or_default()
}
