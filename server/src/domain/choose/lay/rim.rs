//! Where the outline of a mesh may be: its open sides, and those between what is seen from the front and from behind.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::{
    Lay,
    around::{side_of, to_segment},
};
use crate::domain::choose::patch::{Patch, PatchView, View};

/// Patches times sides of which distances are told.
const MOST: usize = 1 << 26;
/// Of a side: what is no farther is on it.
const NEAR: f64 = 1e-9;

pub(in crate::domain::choose) struct Rim {
    /// Of each triangle, whether its sides are part of it.
    sides: Vec<[bool; 3]>,
    /// On the screen; none where a side reaches behind the eye.
    segments: Option<Vec<Segment>>,
}

/// Of the outline.
#[derive(Clone, Copy, Debug)]
struct Segment {
    from: DVec2,
    along: DVec2,
    /// Of the square of its length.
    inverse: f64,
}

impl Rim {
    pub(in crate::domain::choose) fn of(lay: &Lay<'_>, view: &View) -> Self {
        let mesh = lay.mesh;
        let is_front: Vec<bool> = (0..mesh.triangles.len()).map(|t| view.facing(lay.corners(t)) > 0.0).collect();
        let is_rim = |t: usize, side: usize| {
            let edge = mesh.ae_ge[mesh.triangles[t].ae[side] as usize] as usize;
            let sides = mesh.ge_side.list(edge);
            sides.len() != 2 || sides.iter().any(|s| is_front[*s as usize / 3] != is_front[t])
        };
        let of_triangle = |t: usize| [0, 1, 2].map(|side| is_rim(t, side));
        let sides: Vec<[bool; 3]> = (0..mesh.triangles.len()).map(of_triangle).collect();
        let all = sides.iter().enumerate().flat_map(|(t, own)| (0..3).filter(|k| own[*k]).map(move |k| (t, k)));
        let on_screen = |(t, k): (usize, usize)| {
            let ends = side_of(lay, t, k);
            ends.iter().all(|p| view.w(*p) > view.near).then(|| Segment::between(ends.map(|p| view.pixel(p))))
        };
        let segments = all.map(on_screen).collect();
        Self { sides, segments }
    }

    /// Whether a part of triangle t is at it.
    pub(in crate::domain::choose) fn is_at(&self, t: usize, lay: &Lay<'_>, patch: &Patch) -> bool {
        let near = NEAR * patch.base.longest_side;
        let is_on = |side: usize| {
            let ends = side_of(lay, t, side);
            patch.corners.iter().any(|corner| to_segment(*corner, ends) <= near)
        };
        (0..3).any(|side| self.sides[t][side] && is_on(side))
    }

    /// How far it is from each patch.
    pub(in crate::domain::choose) fn tell(&self, patches: &mut [PatchView], view: &View) {
        let Some(segments) = self.segments.as_ref().filter(|s| s.len() * patches.len() <= MOST) else { return };
        patches.par_iter_mut().for_each(|patch| {
            let pixels = patch.patch.corners.map(|corner| view.pixel(corner));
            let middle = pixels.iter().sum::<DVec2>() / 3.0;
            let radius = pixels.iter().fold(0.0, |most: f64, p| most.max(p.distance(middle)));
            let square = |segment: &Segment| segment.distance_squared(middle);
            let least = segments.iter().map(square).fold(f64::INFINITY, f64::min);
            patch.outline_distance_px = (least.sqrt() - radius).max(0.0);
        });
    }
}

impl Segment {
    fn between([from, to]: [DVec2; 2]) -> Self {
        let along = to - from;
        Self { from, along, inverse: 1.0 / along.length_squared().max(f64::MIN_POSITIVE) }
    }

    #[inline]
    fn distance_squared(&self, point: DVec2) -> f64 {
        let way = point - self.from;
        let share = (way.dot(self.along) * self.inverse).clamp(0.0, 1.0);
        (way - self.along * share).length_squared()
    }
}

impl View {
    /// Above 0 where the front is seen, by the order of the corners.
    #[must_use]
    pub fn facing(&self, [a, b, c]: [DVec3; 3]) -> f64 {
        (b - a).cross(c - a).dot(self.eye.truncate() - a * self.eye.w)
    }
}
