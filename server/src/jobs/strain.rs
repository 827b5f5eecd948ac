//! What a report says of stretch and folds, measured on the result.

use crate::{
    domain::{
        report::{Report, Warning},
        scene::{Scene, SceneMesh},
        surface::Surface,
    },
    oracle::facts::{LONG, Spot, Strain},
};

/// Fills in flipped triangles and stretch, and warns of folds and of what is stretched beyond [`LONG`].
pub(super) fn describe(report: &mut Report, scene: &mut Scene, surfaces: &[Surface]) {
    let of_mesh = |(m, s): (&SceneMesh, &Surface)| (m.mesh.name.clone(), Strain::of(&m.mesh, s));
    let strains: Vec<(String, Strain)> = scene.meshes.iter().zip(surfaces).map(of_mesh).collect();
    let all = strains.iter().fold(Strain::default(), |all, (_, strain)| all.joined(strain.clone()));
    report.flipped = Some(surfaces.iter().map(|surface| surface.flipped).sum());
    report.stretch = all.stretch();
    scene.warnings.extend(foldover(report, &strains));
    scene.warnings.extend(stretched(&all, &strains));
}

fn foldover(report: &Report, strains: &[(String, Strain)]) -> Option<Warning> {
    let flipped = report.flipped.filter(|&flipped| flipped > 0)?;
    let first = strains.iter().find_map(|(name, strain)| Some(place(name, &strain.first_flipped?)));
    let first = first.map_or_else(String::new, |first| format!(", the first {first}"));
    let remedy = if report.method == "vector" {
        "overhangs do so rightly; where none is meant, lower the scale"
    } else {
        "the displacement folds the surface over; lower the scale below the radius of concave curvature, or smooth the map"
    };
    let message = format!("{flipped} of {} triangles face against their base{first}: {remedy}", report.triangles);
    Some(Warning::new("foldover", message))
}

fn stretched(all: &Strain, strains: &[(String, Strain)]) -> Option<Warning> {
    let stretch = all.stretch().filter(|stretch| stretch.max > LONG)?;
    let is_worst = |strain: &Strain| strain.stretch().is_some_and(|own| own.max == stretch.max);
    let (name, worst) = strains.iter().find(|(_, strain)| is_worst(strain))?;
    let message = format!(
        "{} of {} triangles are stretched more than {LONG} times, 99 % at most {:.2}, the most {:.1} times {}: texture and detail smear there; lower the scale, or use a vector map over a base that follows the shape",
        all.long,
        all.triangles,
        stretch.p99,
        stretch.max,
        place(name, &worst.max_at?)
    );
    Some(Warning::new("stretch", message))
}

fn place(mesh: &str, spot: &Spot) -> String {
    let [x, y, z] = spot.position;
    format!("on base triangle {} of mesh '{mesh}' near ({x:.4}, {y:.4}, {z:.4})", spot.triangle)
}
