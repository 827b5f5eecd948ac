//! Smooth bases: how far one is from straight over a region, and its normals and directions there. A polynomial stays
//! within the hull of its control net, so what is left of the net once the straight part is gone is a bound.

use glam::DVec3;

use super::{
    field::{Field, Scalar},
    layers::Patch,
};
use crate::{
    bezier::Net,
    expression::{Interval, IntervalJet, interval_jet::hull},
    layout::geometry::NONE,
    patches::{PatchNode, Patches, Summary, into_part, within_triangle},
    reference::{
        frame::MIN_BLENDED_NORMAL,
        site::Site,
        smooth::{self, Fields},
    },
};

/// Nodes that bend by so little of the resolution, and whose normals turn so little, count as flat triangles.
const SMALL_BEND: f64 = 0.25;
const SMALL_TURN: f64 = 1.0 / 512.0;

/// A corner of a part: where it lies in the part's patch, and its shares of the region's corners.
#[derive(Clone, Copy)]
struct At {
    b: DVec3,
    share: DVec3,
}

/// A triangle of a region that lies in one Bézier triangle.
struct Part {
    leaf: PatchNode,
    /// Stands for the patches of a node that is small.
    summary: Option<Summary>,
    corners: [At; 3],
    /// Of directions, from the whole triangle to the patch.
    scale: f64,
}

/// The part of a smooth base between three places of a base triangle.
struct Region<'p> {
    patches: &'p Patches,
    triangle: u32,
    /// Barycentrics of the base triangle.
    corners: [DVec3; 3],
    parts: Vec<Part>,
    /// Nodes that bend less than this count as summed up, local units; 0 is none.
    small: f64,
}

impl<'p> Region<'p> {
    fn new(patch: &Patch<'p>, corners: [DVec3; 3], small: f64) -> Option<Self> {
        let patches = patch.places.tables.patches.as_deref()?;
        let corners = corners.map(|b| within_triangle(patch.patch, b));
        let mut region = Self { patches, triangle: patch.patch / 8, corners, parts: Vec::new(), small };
        let shares = [DVec3::X, DVec3::Y, DVec3::Z];
        let whole = (0..3).map(|k| At { b: corners[k], share: shares[k] }).collect();
        region.cut(region.triangle as usize, whole, 1.0);
        Some(region)
    }

    /// Adds what of a convex polygon lies in the patches of a node.
    fn cut(&mut self, node: usize, polygon: Vec<At>, scale: f64) {
        if polygon.len() < 3 {
            return;
        }
        let is_small = |s: &&Summary| s.place_radius <= self.small && s.normal_radius <= SMALL_TURN;
        let summary = self.patches.summaries.get(node).filter(is_small).copied();
        let node = self.patches.nodes[node];
        if node.parts == NONE || summary.is_some() {
            let fan = (1..polygon.len() - 1).map(|k| [polygon[0], polygon[k], polygon[k + 1]]);
            return self.parts.extend(fan.map(|corners| Part { leaf: node, summary, corners, scale }));
        }
        for part in 0..4 {
            let kept = if part < 3 {
                clipped(polygon.clone(), |b| b[part] - 0.5)
            } else {
                (0..3).fold(polygon.clone(), |kept, k| clipped(kept, |b| 0.5 - b[k]))
            };
            let inside = kept.into_iter().map(|at| At { b: into_part(part, at.b), ..at }).collect();
            let scale = scale * if part == 3 { -2.0 } else { 2.0 };
            self.cut(node.parts as usize + part, inside, scale);
        }
    }

    fn whole(&self, share: DVec3) -> DVec3 {
        blend(self.corners, share)
    }

    /// From the region's first corner along its side k.
    fn side(&self, part: &Part, k: usize) -> DVec3 {
        (self.corners[k + 1] - self.corners[0]) * part.scale
    }

    fn position(&self, part: &Part) -> Net {
        self.patches.position(&part.leaf)
    }

    fn normals(&self, part: &Part) -> (Net, Option<Net>) {
        normals(self.patches, &part.leaf)
    }

    /// Unit normal and direction over a part.
    fn frame(&self, part: &Part) -> [Field; 2] {
        if let Some(summary) = part.summary {
            let corners = part.corners.map(|at| blend(summary.normals, at.b));
            let unit = Field { corners, curvature: summary.normal_radius };
            return [unit, self.with_given(part, unit)];
        }
        let over = |net: &Net| field(&net.within(part.corners.map(|at| at.b)));
        let (normal, direction) = self.normals(part);
        let normal = over(&normal);
        let unit = sized(normal).unit();
        let direction = direction.map_or(unit, |direction| over(&direction).over(normal, MIN_BLENDED_NORMAL));
        [unit, self.with_given(part, direction)]
    }

    fn with_given(&self, part: &Part, direction: Field) -> Field {
        let Some((mask, given)) = self.patches.given(self.triangle) else { return direction };
        let places = part.corners.map(|at| self.whole(at.share));
        let left = Scalar { corners: places.map(|b| 1.0 - b.dot(mask)), curvature: 0.0 };
        let own = places.map(|b| blend(given, b * mask));
        direction.times(left).add(Field::linear(own))
    }
}

/// Not unit, over the whole patch; and the directions that go with them, unless they are the same.
pub(super) fn normals(patches: &Patches, leaf: &PatchNode) -> (Net, Option<Net>) {
    if let Some([normal, direction]) = patches.normals(leaf) {
        return (normal, Some(direction));
    }
    let net = patches.position(leaf);
    let [u, v] = [net.along(DVec3::new(-1.0, 1.0, 0.0)), net.along(DVec3::new(-1.0, 0.0, 1.0))];
    let size = u.longest().max(v.longest()).max(f64::MIN_POSITIVE);
    let by = 1.0 / size;
    let sized = |net: &Net, by: f64| Net::new(net.degree, |j, k| net.point(j, k) * by);
    (sized(&u, by).cross(&sized(&v, by * f64::from(leaf.side))), None)
}

/// Keeps what has `f` at or above 0; what only touches goes, unless it is all there is.
fn clipped(polygon: Vec<At>, f: impl Fn(DVec3) -> f64) -> Vec<At> {
    let values: Vec<f64> = polygon.iter().map(|at| f(at.b)).collect();
    let (low, high) = values.iter().fold((0.0f64, 0.0f64), |(low, high), x| (low.min(*x), high.max(*x)));
    if low == 0.0 {
        return polygon;
    }
    if high == 0.0 {
        return Vec::new();
    }
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (k, at) in polygon.iter().enumerate() {
        let next = (k + 1) % polygon.len();
        if values[k] >= 0.0 {
            kept.push(*at);
        }
        if values[k] * values[next] < 0.0 {
            let t = values[k] / (values[k] - values[next]);
            let to = polygon[next];
            kept.push(At { b: at.b + (to.b - at.b) * t, share: at.share + (to.share - at.share) * t });
        }
    }
    kept
}

pub(super) fn blend(corners: [DVec3; 3], share: DVec3) -> DVec3 {
    corners[0] * share.x + corners[1] * share.y + corners[2] * share.z
}

pub(super) fn field(net: &Net) -> Field {
    let corners = net.corners();
    Field { corners, curvature: net.less(corners).longest() }
}

/// At a length near 1: only the direction counts.
pub(super) fn sized(field: Field) -> Field {
    let by = 1.0 / field.most().max(f64::MIN_POSITIVE);
    Field { corners: field.corners.map(|c| c * by), curvature: field.curvature * by }
}

/// How far the base is from straight between its places at the corners of the patch; 0 where it is flat.
pub(super) fn bend(patch: &Patch<'_>) -> f64 {
    let Some(region) = Region::new(patch, patch.corners, SMALL_BEND * patch.resolution) else { return 0.0 };
    let places = corner_fields(patch).map(|fields| fields.position.x_axis);
    let of_part = |part: &Part| {
        if let Some(summary) = part.summary {
            let apart = |at: &At| blend(summary.places, at.b).distance(blend(places, at.share));
            return part.corners.iter().map(apart).fold(0.0, f64::max) + summary.place_radius;
        }
        let origin = region.patches.origin(&part.leaf);
        let straight = part.corners.map(|at| blend(places, at.share) - origin);
        region.position(part).within(part.corners.map(|at| at.b)).less(straight).longest()
    };
    region.parts.iter().map(of_part).fold(0.0, f64::max)
}

/// Unit normals and directions over the patch; none where the base is flat.
pub(super) fn frame(patch: &Patch<'_>) -> Option<[Field; 2]> {
    let region = Region::new(patch, patch.corners, SMALL_BEND * patch.resolution)?;
    let at_corners = corner_fields(patch);
    let values = [at_corners.map(|f| f.normal.x_axis), at_corners.map(|f| f.direction.x_axis)];
    let mut curvature = [0.0f64; 2];
    for part in &region.parts {
        for (k, field) in region.frame(part).into_iter().enumerate() {
            let apart = |(own, at): (&DVec3, &At)| own.distance(blend(values[k], at.share));
            let most = field.corners.iter().zip(&part.corners).map(apart).fold(0.0, f64::max);
            curvature[k] = curvature[k].max(most + field.curvature);
        }
    }
    Some([0, 1].map(|k| Field { corners: values[k], curvature: curvature[k] }))
}

fn corner_fields(patch: &Patch<'_>) -> [Fields; 3] {
    patch.corners.map(|b| fields(patch, b))
}

/// At barycentrics among the patch's attribute vertices.
fn fields(patch: &Patch<'_>, b: DVec3) -> Fields {
    smooth::fields(patch.places.tables, &Site { av: patch.av, b, patch: patch.patch })
}

/// Position and unit normal there; none where the base is flat.
pub(super) fn at(patch: &Patch<'_>, b: DVec3) -> Option<[[f64; 3]; 2]> {
    patch.places.tables.patches.as_ref()?;
    let Fields { position, normal, .. } = fields(patch, b);
    Some([position.x_axis.to_array(), normal.x_axis.to_array()])
}

/// Position and normal, not unit, over the region with these corners, with slopes along its first two sides.
pub(super) fn bounds(patch: &Patch<'_>, corners: [DVec3; 3]) -> Option<[[IntervalJet; 3]; 2]> {
    let region = Region::new(patch, corners, 0.0)?;
    let of_part = |part: &Part| {
        let origin = region.patches.origin(&part.leaf);
        let (normal, _) = region.normals(part);
        [jets(&region, part, &region.position(part), origin), jets(&region, part, &normal, DVec3::ZERO)]
    };
    let either = |a: IntervalJet, b: IntervalJet| {
        IntervalJet::new(hull(a.value, b.value), [0, 1].map(|k| hull(a.slope[k], b.slope[k])))
    };
    let both = |a: [[IntervalJet; 3]; 2], b: [[IntervalJet; 3]; 2]| {
        [0, 1].map(|n| [0, 1, 2].map(|k| either(a[n][k], b[n][k])))
    };
    region.parts.iter().map(of_part).reduce(both)
}

/// A net over a part, component by component.
fn jets(region: &Region<'_>, part: &Part, net: &Net, origin: DVec3) -> [IntervalJet; 3] {
    let places = part.corners.map(|at| at.b);
    let value = net.within(places);
    let slopes = [0, 1].map(|k| net.along(region.side(part, k)).within(places));
    let interval = |net: &Net, k: usize, from: f64| {
        let ends = net
            .points()
            .iter()
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), p| (low.min(p[k]), high.max(p[k])));
        Interval::new(ends.0 + from, ends.1 + from).widened()
    };
    [0, 1, 2].map(|k| IntervalJet::new(interval(&value, k, origin[k]), [0, 1].map(|s| interval(&slopes[s], k, 0.0))))
}
