//! The bound of an expression, from intervals of its value and slopes over ever smaller parts of the patch.

use glam::DVec3;

use super::{
    field::Scalar,
    layers::{FARTHEST_TEXEL, Patch},
    smooth,
};
use crate::{
    expression::{Interval, IntervalJet, Number, evaluate, reads},
    layout::geometry::Layer,
    reference::{displace_expression::code, site::vector},
};

/// A patch is quartered so often at most.
const DEPTH: u32 = 4;

/// The height, and how far at most it is from straight, up to `resolution` more; above `cap` any bound above `cap`.
pub(super) fn height(patch: &Patch<'_>, layer: &Layer, cap: f64, resolution: f64) -> Scalar {
    let part = Part { patch, layer, corners: patch.corners };
    let values = patch.corners.map(|b| part.at(b));
    if part.is_cut() {
        return Scalar { corners: values, curvature: f64::INFINITY };
    }
    if layer.scale == 0.0 {
        return Scalar { corners: [0.0; 3], curvature: 0.0 };
    }
    let unscaled = |height: f64| height / f64::from(layer.scale.abs());
    let limits = Limits { cap: unscaled(cap), resolution: unscaled(resolution) };
    let curvature = part.greatest([DVec3::X, DVec3::Y, DVec3::Z], values, &limits, DEPTH);
    let height = |value: f64| f64::from(layer.scale) * (value - f64::from(layer.midlevel));
    Scalar { corners: values.map(height), curvature: curvature * f64::from(layer.scale.abs()) }
}

/// Where to stop: above `cap`, and where the bound is within `resolution` of the truth.
struct Limits {
    cap: f64,
    resolution: f64,
}

struct Part<'p> {
    patch: &'p Patch<'p>,
    layer: &'p Layer,
    /// Of the whole patch, as barycentrics among its attribute vertices.
    corners: [DVec3; 3],
}

impl Part<'_> {
    fn place(&self, share: DVec3) -> DVec3 {
        self.corners[0] * share.x + self.corners[1] * share.y + self.corners[2] * share.z
    }

    fn at(&self, b: DVec3) -> f64 {
        let linear = |values: [f64; 3]| values[0] * b.x + values[1] * b.y + values[2] * b.z;
        let variables = self.variables(linear, smooth::at(self.patch, b));
        evaluate(code(self.patch.places.tables, self.layer), &variables)
    }

    /// The largest distance from what is straight between the `values` at the corners of the patch, over the part
    /// with these shares of them.
    fn greatest(&self, shares: [DVec3; 3], values: [f64; 3], limits: &Limits, depth: u32) -> f64 {
        let straight = |share: DVec3| share.dot(DVec3::from_array(values));
        let apart = |share: DVec3| (self.at(self.place(share)) - straight(share)).abs();
        let here = shares.iter().fold(0.0, |most: f64, share| most.max(apart(*share)));
        let deviation = self.deviation(shares);
        if deviation <= limits.resolution || here > limits.cap || depth == 0 {
            return if deviation.is_nan() { f64::INFINITY } else { here + deviation };
        }
        let [a, b, c] = shares;
        let (ab, bc, ca) = (0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a));
        let mut worst: f64 = 0.0;
        for part in [[ab, bc, ca], [a, ab, ca], [ab, b, bc], [ca, bc, c]] {
            worst = worst.max(self.greatest(part, values, limits, depth - 1));
            if worst > limits.cap {
                break;
            }
        }
        worst
    }

    /// Texel space is cut off far out, which bends what is read there.
    fn is_cut(&self) -> bool {
        let tables = self.patch.places.tables;
        let far = |av: &u32| {
            let uv = [tables.av_position_u[*av as usize][3], tables.av_direction_v[*av as usize][3]].map(f64::from);
            [self.layer.texel_from_u, self.layer.texel_from_v].iter().any(|row| {
                (f64::from(row[0]) * uv[0] + f64::from(row[1]) * uv[1] + f64::from(row[2])).abs() >= FARTHEST_TEXEL
            })
        };
        self.patch.av.iter().any(far)
    }

    /// With slopes in [g − r, g + r] along two sides, f is within (r1 + r2) / 2 of what is straight.
    fn deviation(&self, shares: [DVec3; 3]) -> f64 {
        let places = shares.map(|share| self.place(share));
        let variables = self.variables(|values| affine(places, values), self.base_bounds(places));
        let jet = evaluate(code(self.patch.places.tables, self.layer), &variables);
        let radius = |slope: Interval| 0.5 * (slope.hi - slope.lo);
        0.5 * (radius(jet.slope[0]) + radius(jet.slope[1]))
    }

    /// Position and normal of a smooth base; anything where they are not read.
    fn base_bounds(&self, places: [DVec3; 3]) -> Option<[[IntervalJet; 3]; 2]> {
        if reads(code(self.patch.places.tables, self.layer), 2..=7) {
            return smooth::bounds(self.patch, places);
        }
        self.patch.places.tables.patches.as_ref().map(|_| [[IntervalJet::constant(1.0); 3]; 2])
    }

    /// The variables an expression reads, from what is affine between the attribute vertices; position and normal are
    /// those of a smooth base where it is one.
    fn variables<N: Number>(&self, affine: impl Fn([f64; 3]) -> N, base: Option<[[N; 3]; 2]>) -> [N; 8] {
        let tables = self.patch.places.tables;
        let av = self.patch.av.map(|av| av as usize);
        let uv = av.map(|av| [tables.av_position_u[av][3], tables.av_direction_v[av][3]].map(f64::from));
        let row = |[a, b, c]: [f32; 3]| affine(uv.map(|[u, v]| f64::from(a) * u + f64::from(b) * v + f64::from(c)));
        let position = |k: usize| affine(av.map(|av| f64::from(tables.av_position_u[av][k])));
        let normal = |k: usize| affine(av.map(|av| vector(&tables.av_normal[av])[k]));
        let is_smooth = base.is_some();
        let [p, normal] = base.unwrap_or_else(|| [[0, 1, 2].map(position), [0, 1, 2].map(normal)]);
        let square = normal[0].powi(2).add(normal[1].powi(2)).add(normal[2].powi(2));
        let flat = !is_smooth && av.iter().all(|other| tables.av_normal[*other] == tables.av_normal[av[0]]);
        let unit = |k: usize| if flat { normal[k] } else { normal[k].div(square.sqrt()) };
        let l = self.layer;
        [row(l.texel_from_u), row(l.texel_from_v), p[0], p[1], p[2], unit(0), unit(1), unit(2)]
    }
}

/// Over the triangle with these barycentrics, by the shares of its second and third corner.
fn affine(places: [DVec3; 3], values: [f64; 3]) -> IntervalJet {
    let at = places.map(|b| b.dot(DVec3::from_array(values)));
    let (low, high) = (at[0].min(at[1]).min(at[2]), at[0].max(at[1]).max(at[2]));
    let slope = [at[1] - at[0], at[2] - at[0]].map(Interval::constant);
    IntervalJet::new(Interval::new(low, high).widened(), slope)
}
