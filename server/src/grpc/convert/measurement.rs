//! What a measurement tells.

use displace_proto::v1;

use crate::domain::measurement::{Distance, Hausdorff, Measurement, NormalDeviation, SheetFacts};

pub(super) fn to_measurement(found: &Measurement) -> v1::Measurement {
    v1::Measurement {
        hausdorff: Some(to_hausdorff(&found.hausdorff)),
        rms: found.rms,
        normal_deg: found.normal_deg.map(to_normal_deviation),
        seam_gap: found.seam_gap,
        volume_a: found.volume.a,
        volume_b: found.volume.b,
        diagonal: found.diagonal,
        precision: found.precision,
        a: Some(to_facts(&found.a)),
        b: Some(to_facts(&found.b)),
        stretch: found.stretch.map(|stretch| v1::Stretch { p99: stretch.p99, max: stretch.max }),
    }
}

fn to_hausdorff(found: &Hausdorff) -> v1::Hausdorff {
    let (a_to_b, b_to_a) = (Some(to_distance(&found.a_to_b)), Some(to_distance(&found.b_to_a)));
    v1::Hausdorff { lo: found.lo, hi: found.hi, a_to_b, b_to_a }
}

fn to_distance(found: &Distance) -> v1::Distance {
    v1::Distance {
        lo: found.lo,
        hi: found.hi,
        mean: found.mean,
        rms: found.rms,
        at: found.at.to_vec(),
        nearest: found.nearest.to_vec(),
    }
}

fn to_normal_deviation(found: NormalDeviation) -> v1::NormalDeviation {
    v1::NormalDeviation { p50: found.p50, p95: found.p95, p99: found.p99, max: found.max }
}

fn to_facts(found: &SheetFacts) -> v1::SheetFacts {
    v1::SheetFacts {
        triangles: found.triangles,
        area: found.area,
        boundary_edges: found.boundary_edges,
        nonmanifold_edges: found.non_manifold_edges,
        degenerate_triangles: found.degenerate_triangles,
        components: found.components,
        euler_characteristic: found.euler_characteristic,
        facing_back: found.facing_back,
        residual: found.residual,
        self_intersections: found.self_intersections,
    }
}
