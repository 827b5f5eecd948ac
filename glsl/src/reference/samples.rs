//! The places where details are evaluated with derivatives. The twin of `samples.comp`.

use glam::{DVec2, DVec3};

use super::{
    frame::{Jet, product},
    site::Site,
};
use crate::{
    lattice,
    layout::geometry::{BaseTriangle, NONE, OWN, SamplesParams, SeamSide, block, rule},
    tables::Tables,
};

/// A sample in f64; see the struct of the same name in `sample.glsl`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sample {
    pub site: Site,
    pub detail: u32,
    pub weight: DVec3,
    pub turn: DVec2,
}

impl Sample {
    /// From what the device wrote.
    #[must_use]
    pub fn from_device(sample: &crate::layout::geometry::Sample) -> Self {
        let [b1, b2] = sample.b.map(f64::from);
        Self {
            site: Site { av: sample.av, b: DVec3::new(1.0 - b1 - b2, b1, b2), patch: sample.patch_code },
            detail: sample.detail,
            weight: DVec3::from_array(sample.weight.map(f64::from)),
            turn: DVec2::from_array(sample.turn.map(f64::from)),
        }
    }

    fn whole(site: Site, detail: u32) -> Self {
        Self { site, detail, weight: DVec3::X, turn: DVec2::ONE }
    }

    /// A jet at the site, as it counts at the vertex.
    #[must_use]
    pub fn counted(&self, d: Jet) -> Jet {
        product(self.weight, Jet::from_cols(d.x_axis, d.y_axis * self.turn.x, d.z_axis * self.turn.y))
    }
}

/// Sample number `index` of the block, or nothing.
#[must_use]
pub fn sample(tables: &Tables, params: &SamplesParams, index: u32) -> Option<Sample> {
    let n = tables.segments();
    match params.block {
        block::SEAM_CORNERS => {
            let side = tables.seam_corners[index as usize];
            Some(Sample::whole(Site::at_vertex(side.id), side.detail))
        }
        block::SEAM_EDGES => {
            let side = tables.seam_sides[(index / (n - 1)) as usize];
            Some(edge_sample(tables, side, f64::from(index % (n - 1) + 1) / f64::from(n)))
        }
        _ => {
            let (t, [i, j]) = lattice_point(tables, params.block, index);
            vertex_sample(tables, params, t, f64::from(i) / f64::from(n), f64::from(j) / f64::from(n))
        }
    }
}

/// The sample of base triangle t at (b1, b2): its own, or one side of the seam along `params.side`.
#[must_use]
pub fn vertex_sample(tables: &Tables, params: &SamplesParams, t: u32, b1: f64, b2: f64) -> Option<Sample> {
    let triangle = &tables.base_triangles[t as usize];
    let site = Site::inside(tables, t, DVec3::new(1.0 - b1 - b2, b1, b2));
    if params.side == OWN {
        return Some(Sample::whole(site, triangle.detail));
    }
    ramp_sample(tables, params, t, triangle, site.b)
}

fn edge_sample(tables: &Tables, side: SeamSide, t: f64) -> Sample {
    Sample::whole(Site::on_edge(tables, side.id, t), side.detail)
}

/// Barycentric k as a jet.
fn weight_jet(b: DVec3, k: usize) -> DVec3 {
    [DVec3::new(b.x, -1.0, -1.0), DVec3::new(b.y, 1.0, 0.0), DVec3::new(b.z, 0.0, 1.0)][k]
}

fn ramp_sample(tables: &Tables, params: &SamplesParams, t: u32, triangle: &BaseTriangle, b: DVec3) -> Option<Sample> {
    let correction = tables.correction(t)?;
    let side = params.side as usize;
    let which = correction.seam[side];
    let weight = DVec3::X - weight_jet(b, (side + 2) % 3) * f64::from(correction.inverse_width[side]);
    if which == NONE || weight.x <= 0.0 {
        return None;
    }
    let seam = tables.seams[which as usize];
    let entry = (params.rank < seam.count).then(|| tables.seam_sides[(seam.first + params.rank) as usize])?;
    if entry.same_as != params.rank {
        return None;
    }
    let reversed = triangle.reversed >> side & 1 == 1;
    let (next, own) = ((side + 1) % 3, correction.rank[side] == params.rank);
    let to = weight_jet(b, if reversed { side } else { next });
    let from = weight_jet(b, if reversed { next } else { side });
    let both = to.x + from.x;
    let mut sample = edge_sample(tables, entry, to.x / both);
    sample.weight = weight * (share(seam.distinct, params.rule, params.rank) - f64::from(u8::from(own)));
    let slope = |k: usize| (from.x * to[k] - to.x * from[k]) / (both * both);
    sample.turn = DVec2::new(slope(1), slope(2));
    Some(sample)
}

/// Share of a side with this rank in the reconciled value.
#[must_use]
pub fn share(distinct: u32, which: u32, rank: u32) -> f64 {
    match which {
        rule::MEAN => 1.0 / f64::from(distinct),
        _ => f64::from(u8::from(rank == 0)),
    }
}

/// The base triangle and the lattice point of sample `index` of a block of vertices.
#[must_use]
pub fn lattice_point(tables: &Tables, which: u32, index: u32) -> (u32, [u32; 2]) {
    let n = tables.segments();
    if which == block::INTERIORS {
        let points = lattice::interior_points(tables.lattice.level) as u32;
        let t = tables.triangle_order[(index / points) as usize];
        let (i, j) = lattice::interior_point(tables.lattice.level, u64::from(index % points));
        return (t, [i as u32, j as u32]);
    }
    let points = if which == block::EDGES { n - 1 } else { 1 };
    let item = tables.contributions[(index / points) as usize];
    let along = if which == block::EDGES { index % points + 1 } else { 0 };
    (item / 3, place_in_triangle(tables, item, along, n))
}

/// The point `along` the ae of side `item % 3` of triangle `item / 3`, where a whole side is n; 0 is the side's
/// first corner.
#[must_use]
pub fn place_in_triangle(tables: &Tables, item: u32, along: u32, n: u32) -> [u32; 2] {
    let (t, k) = (item / 3, item % 3);
    let reversed = tables.base_triangles[t as usize].reversed >> k & 1 == 1;
    let along = if reversed && along > 0 { n - along } else { along };
    [[along, 0], [n - along, along], [0, n - along]][k as usize]
}
