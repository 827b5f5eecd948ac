//! Everything `measure` tells of two sheets.

use super::{
    cracks, facts,
    hausdorff::{Directed, Settings, directed},
    metrics::flip::magma,
    samples::{Sampled, sampled},
    sheet::Sheet,
};
use crate::domain::{
    Error, Result,
    cancel::{Cancel, Progress},
    measurement::{Distance, Hausdorff, Measurement, NormalDeviation, SheetFacts, Volume},
    report::Warning,
};

/// Places from which root mean squares and normals are taken, each way.
const SAMPLES: usize = 1 << 16;
/// Meshes with more triangles are not searched for self-intersections.
const MOST_SEARCHED: usize = 4_000_000;
/// Pieces cut each way before the distance is told as far as it is known.
const MOST_CUTS: u64 = 20_000_000;

/// A measurement, and what is to be warned of.
pub struct Measured {
    pub measurement: Measurement,
    pub warnings: Vec<Warning>,
}

/// Measures `b` against `a`, the reference. `precision_world` is above 0.
pub fn measure(
    a: &Sheet<'_>,
    b: &Sheet<'_>,
    precision_world: f64,
    diagonal: f64,
    cancel: &Cancel,
    progress: &dyn Progress,
) -> Result<Measured> {
    let settings = Settings { precision: precision_world, max_cuts: MOST_CUTS };
    let empty = || {
        let field = if a.triangles.is_empty() { "mesh" } else { "result" };
        Error::invalid(field, "has no triangles: there is nothing to measure")
    };
    let there = directed(a, b, &settings, cancel, progress)?.ok_or_else(empty)?;
    let back = directed(b, a, &settings, cancel, progress)?.ok_or_else(empty)?;
    let width = precision_world / 8.0;
    let samples = [sampled(a, b, SAMPLES, width, cancel)?, sampled(b, a, SAMPLES, width, cancel)?];
    let (lo, hi) = (there.lo.max(back.lo), there.hi.max(back.hi));
    let ([volume_a, volume_b], [facts_a, facts_b]) = facts_of(a, b);
    cancel.check()?;
    let mut warnings = Vec::new();
    if hi - lo > precision_world {
        let message = format!(
            "the distance is known to {:e} world units where {precision_world:e} was asked: the search ended early, or the detail jumps; ask for less precision",
            hi - lo
        );
        warnings.push(Warning::new("precision_not_reached", message));
    }
    let rounding = a.rounding();
    if rounding > precision_world / 8.0 {
        let why = format!(
            "rounding moves the surface by {rounding:e} world units; write the expression without differences of large numbers, or ask for less precision"
        );
        warnings.push(Warning::estimated_not_certified("the distance", &why));
    }
    let measurement = Measurement {
        hausdorff: Hausdorff { lo, hi, a_to_b: distance(&there, &samples[0]), b_to_a: distance(&back, &samples[1]) },
        rms: root_mean_square(samples.iter().flatten()),
        normal_deg: normals(samples.iter().flatten()),
        seam_gap: cracks::widest(a, b, hi.max(precision_world)),
        volume: Volume { a: volume_a, b: volume_b },
        stretch: a.stretch(),
        diagonal,
        precision: precision_world,
        unit: "world".into(),
        a: facts_a,
        b: facts_b,
    };
    Ok(Measured { measurement, warnings })
}

fn distance(found: &Directed, samples: &[Sampled]) -> Distance {
    let [at, nearest] = found.at.map(|p| p.to_array());
    let mean = samples.iter().map(|s| s.distance).sum::<f64>() / samples.len().max(1) as f64;
    Distance { lo: found.lo, hi: found.hi, mean, rms: root_mean_square(samples.iter()), at, nearest }
}

fn root_mean_square<'s>(samples: impl Iterator<Item = &'s Sampled>) -> f64 {
    let (sum, count) = samples.fold((0.0, 0u64), |(sum, count), s| (sum + s.distance * s.distance, count + 1));
    (sum / count.max(1) as f64).sqrt()
}

/// `None` where no place has a normal on both sides.
fn normals<'s>(samples: impl Iterator<Item = &'s Sampled>) -> Option<NormalDeviation> {
    let mut angles: Vec<f64> = samples.map(|s| s.normal_deg).filter(|angle| angle.is_finite()).collect();
    angles.sort_unstable_by(f64::total_cmp);
    let at = |share: f64| angles[((angles.len() - 1) as f64 * share).round() as usize];
    (!angles.is_empty()).then(|| NormalDeviation { p50: at(0.5), p95: at(0.95), p99: at(0.99), max: at(1.0) })
}

/// Volumes and facts of both; only `b` is searched for self-intersections.
fn facts_of(a: &Sheet<'_>, b: &Sheet<'_>) -> ([Option<f64>; 2], [SheetFacts; 2]) {
    let [of_a, of_b] = [a, b].map(|sheet| {
        let positions: Vec<[f32; 3]> = sheet.positions.iter().map(|p| p.as_vec3().to_array()).collect();
        (facts::MeshFacts::of(&positions, &sheet.triangles), positions)
    });
    let searched = b.triangles.len() <= MOST_SEARCHED;
    let pairs = searched.then(|| facts::self_intersections(&of_b.1, &b.triangles, 0).count);
    let volumes = [of_a.0.volume, of_b.0.volume];
    (volumes, [in_short(a, &of_a.0, None), in_short(b, &of_b.0, pairs)])
}

fn in_short(sheet: &Sheet<'_>, found: &facts::MeshFacts, self_intersections: Option<u64>) -> SheetFacts {
    SheetFacts {
        triangles: found.triangles,
        area: found.area,
        boundary_edges: found.boundary_edges,
        non_manifold_edges: found.non_manifold_edges,
        degenerate_triangles: found.degenerate_triangles,
        components: found.components,
        euler_characteristic: found.euler_characteristic,
        facing_back: sheet.facing_back(),
        residual: sheet.largest_residual(),
        self_intersections,
    }
}

/// Colours of vertices by their distance, from none, black, to the largest, pale yellow; and the largest.
#[must_use]
pub fn colors(of_vertex: &[f64]) -> (Vec<[u8; 3]>, f64) {
    let largest = of_vertex.iter().copied().fold(0.0, f64::max);
    let share = |d: f64| if largest > 0.0 { (d / largest) as f32 } else { 0.0 };
    let magma = magma();
    (of_vertex.iter().map(|&d| magma(share(d))).collect(), largest)
}
