//! The bound of what seams add: along each side of a base triangle with a seam, a ramp w(b) r(t(b)).

use glam::DVec3;

use super::{
    MapPlace,
    field::{Field, Scalar, ratio_curvature},
    layers::Patch,
};
use crate::{
    layout::geometry::{BaseEdge, BaseTriangle, Correction, NONE, Seam},
    reference::samples::share,
};

/// Over the `patch` of base triangle t.
pub(super) fn bound(patch: &Patch<'_>, t: u32, cap: f64) -> f64 {
    let Some(correction) = patch.places.tables.correction(t) else { return 0.0 };
    let triangle = &patch.places.tables.base_triangles[t as usize];
    let mut sum = 0.0;
    for side in 0..3 {
        if correction.seam[side] != NONE && sum <= cap {
            sum += Ramp { patch, triangle, correction, side }.bound(cap - sum);
        }
    }
    sum
}

struct Ramp<'r> {
    patch: &'r Patch<'r>,
    triangle: &'r BaseTriangle,
    correction: &'r Correction,
    side: usize,
}

impl Ramp<'_> {
    fn bound(&self, cap: f64) -> f64 {
        let weight = self.weight();
        if weight.most() <= 0.0 {
            return 0.0;
        }
        let [to, from] = self.to_and_from();
        let along: [f64; 3] = std::array::from_fn(|k| to[k] / (to[k] + from[k]));
        let known = || along.iter().copied().filter(|t| t.is_finite());
        let (start, end) = (known().fold(1.0, f64::min), known().fold(0.0, f64::max));
        let seam = self.patch.places.tables.seams[self.correction.seam[self.side] as usize];
        let bend = self.bend(&seam, [start, end], cap / weight.most());
        let shortfall = |t: f64| self.patch.places.shortfall(&seam, self.correction.rank[self.side], t);
        let slope = shortfall(end).distance(shortfall(start)) / (end - start).max(f64::MIN_POSITIVE);
        let ratio = ratio_curvature(to, from, end - start);
        // Where t is not defined the weight is 0.
        let values = along.map(|t| if t.is_finite() { shortfall(t) } else { shortfall(start) });
        let curvature = if end > start { 2.0 * bend + slope * ratio } else { bend };
        Field { corners: values, curvature }.times(weight).curvature
    }

    /// max(0, 1 − b / width), with its kink.
    fn weight(&self) -> Scalar {
        let inverse_width = f64::from(self.correction.inverse_width[self.side]);
        let ramp = self.patch.corners.map(|b| 1.0 - b[(self.side + 2) % 3] * inverse_width);
        let (low, high) = ramp.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), x| (l.min(*x), h.max(*x)));
        let curvature = if low < 0.0 && high > 0.0 { -low * high / (high - low) } else { 0.0 };
        Scalar { corners: ramp.map(|w| w.max(0.0)), curvature }
    }

    fn to_and_from(&self) -> [[f64; 3]; 2] {
        let (side, next) = (self.side, (self.side + 1) % 3);
        let reversed = self.triangle.reversed >> side & 1 == 1;
        let (to, from) = if reversed { (side, next) } else { (next, side) };
        [self.patch.corners.map(|b| b[to]), self.patch.corners.map(|b| b[from])]
    }

    /// How far the shortfall is from straight between two places along the seam.
    fn bend(&self, seam: &Seam, [start, end]: [f64; 2], cap: f64) -> f64 {
        let tables = self.patch.places.tables;
        let mut sum = 0.0;
        for rank in self.patch.places.distinct(seam) {
            let own = f64::from(u8::from(rank == self.correction.rank[self.side]));
            let part = (share(seam.distinct, tables.rule, rank) - own).abs();
            if part == 0.0 {
                continue;
            }
            let entry = tables.seam_sides[(seam.first + rank) as usize];
            let BaseEdge { av: [a, b], patch_code, .. } = tables.base_edges[entry.id as usize];
            let corners = [start, end, end].map(|t| DVec3::new(1.0 - t, t, 0.0));
            // Other places than those of the triangle.
            let in_map = [MapPlace::NONE; 3];
            let patch =
                Patch { av: [a, b, b], patch: patch_code, detail: entry.detail, corners, in_map, ..*self.patch };
            sum += part * patch.bound((cap - sum) / part);
        }
        sum
    }
}
