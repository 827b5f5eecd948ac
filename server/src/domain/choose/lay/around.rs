//! What is around a triangle, as far as rays over its heights lead: how it bends, and where its chart ends.

use glam::{DVec2, DVec3};

use super::{Lay, frame, norm};
use crate::domain::choose::patch::{BaseTriangle, Patch};

/// Triangles looked at.
const MOST: usize = 64;
/// Of the greatest height: rays at up to 72 degrees from the normal lead no farther.
const TANGENT: f64 = 3.0;
/// Charts end where triangles fold by more than 60 degrees.
const LEAST_COSINE: f64 = 0.5;
/// Of a texel: no less is a seam.
const APART_TEXELS: f64 = 1e-3;

/// Of one triangle.
pub(in crate::domain::choose) struct Around {
    direction_rate: f64,
    bend_rate: f64,
    seams: Vec<[DVec3; 2]>,
}

/// What lies across a side.
#[derive(Clone, Copy, Debug)]
pub(super) enum Across {
    End,
    /// And the map is mirrored, or goes on.
    Goes(usize, bool),
}

impl Around {
    /// From side to side over what is near, in the order of their distance by sides.
    pub(super) fn of(lay: &Lay<'_>, first: usize) -> Self {
        let mut around = Self { direction_rate: 0.0, bend_rate: 0.0, seams: Vec::new() };
        let Some(chart) = Chart::of(lay, first) else { return around };
        // Those before the next were looked at; whether the map lies on all on the way as it does on the first.
        let mut known = vec![(first, true)];
        let mut next = 0;
        while let Some(&(t, is_alike)) = known.get(next) {
            next += 1;
            around.add(lay, t, is_alike.then_some(&chart));
            for side in (0..3).filter(|side| chart.is_near(lay, t, *side)) {
                match lay.across[t][side] {
                    Across::End => around.seams.push(side_of(lay, t, side)),
                    Across::Goes(there, mirrored) => {
                        if known.len() < MOST && known.iter().all(|(known, _)| *known != there) {
                            known.push((there, is_alike && !mirrored));
                        }
                    }
                }
            }
        }
        around
    }

    fn add(&mut self, lay: &Lay<'_>, t: usize, chart: Option<&Chart>) {
        self.direction_rate = self.direction_rate.max(lay.of_triangles[t].direction_rate);
        if let Some(bend) = chart.and_then(|chart| chart.bend(lay, t)) {
            self.bend_rate = self.bend_rate.max(bend);
        }
    }

    pub(in crate::domain::choose) fn told(&self, base: BaseTriangle) -> BaseTriangle {
        BaseTriangle { direction_rate: self.direction_rate, bend_rate: self.bend_rate, ..base }
    }

    /// Of a part of the triangle, at least.
    pub(in crate::domain::choose) fn seam_distance(&self, patch: &Patch) -> f64 {
        let middle = patch.corners.iter().sum::<DVec3>() / 3.0;
        let radius = patch.corners.iter().fold(0.0, |most: f64, c| most.max(c.distance(middle)));
        let distance = |seam: &[DVec3; 2]| (to_segment(middle, *seam) - radius).max(0.0);
        self.seams.iter().map(distance).fold(f64::INFINITY, f64::min)
    }
}

pub(super) fn to_segment(point: DVec3, [a, b]: [DVec3; 2]) -> f64 {
    let along = b - a;
    let t = ((point - a).dot(along) / along.length_squared().max(f64::MIN_POSITIVE)).clamp(0.0, 1.0);
    point.distance(a + along * t)
}

pub(super) fn side_of(lay: &Lay<'_>, t: usize, side: usize) -> [DVec3; 2] {
    let corners = lay.corners(t);
    [corners[side], corners[(side + 1) % 3]]
}

impl Across {
    pub(super) fn of(lay: &Lay<'_>, t: usize, side: usize) -> Self {
        let mesh = lay.mesh;
        let edge = mesh.ae_ge[mesh.triangles[t].ae[side] as usize] as usize;
        let &[first, second] = mesh.ge_side.list(edge) else { return Self::End };
        let other = if first as usize == t * 3 + side { second } else { first } as usize;
        let there = other / 3;
        let folds = lay.of_triangles[t].normal.dot(lay.of_triangles[there].normal) < LEAST_COSINE;
        let strange = mesh.triangles[t].primitive != mesh.triangles[there].primitive;
        if folds || strange || !goes_on(lay, [t * 3 + side, other]) {
            return Self::End;
        }
        let turn = |t: usize| lay.texels(t).map_or(0.0, |[a, b, c]| (b - a).perp_dot(c - a));
        Self::Goes(there, turn(t) * turn(there) < 0.0)
    }
}

/// Whether both ends of a side lie at the same place of the map for both triangles, or whole periods away.
fn goes_on(lay: &Lay<'_>, sides: [usize; 2]) -> bool {
    let end = |side: usize, k: usize| {
        let (t, corner) = (side / 3, (side % 3 + k) % 3);
        let av = lay.mesh.triangles[t].av[corner];
        (lay.mesh.av_gv[av as usize], lay.texels(t).map(|texels| texels[corner]))
    };
    let own = [end(sides[0], 0), end(sides[0], 1)];
    let other = [end(sides[1], 0), end(sides[1], 1)];
    let apart = own.map(|(gv, texel)| {
        let twin = other.iter().find(|(there, _)| *there == gv)?;
        Some(twin.1? - texel?)
    });
    let [Some(a), Some(b)] = apart else { return false };
    let is_whole = |k: usize| {
        let turns = (a[k] / lay.size[k]).round();
        (a[k] - turns * lay.size[k]).abs() < APART_TEXELS && (turns == 0.0 || lay.repeats[k])
    };
    a.distance(b) < APART_TEXELS && is_whole(0) && is_whole(1)
}

/// A triangle as its map goes on beyond it.
struct Chart {
    axes: [DVec3; 2],
    /// What the axes are on the map.
    texels: [DVec2; 2],
    middle: DVec3,
    reach: f64,
}

impl Chart {
    fn of(lay: &Lay<'_>, t: usize) -> Option<Self> {
        let (corners, [p, q, r]) = (lay.corners(t), lay.texels(t)?);
        let (axes, shares) = frame(corners)?;
        let texels = [shares.x_axis, shares.y_axis].map(|share| (q - p) * share.x + (r - p) * share.y);
        let middle = corners.iter().sum::<DVec3>() / 3.0;
        let radius = corners.iter().fold(0.0, |most: f64, c| most.max(c.distance(middle)));
        Some(Self { axes, texels, middle, reach: radius + TANGENT * lay.highest })
    }

    fn is_near(&self, lay: &Lay<'_>, t: usize, side: usize) -> bool {
        to_segment(self.middle, side_of(lay, t, side)) <= self.reach
    }

    /// How far the surface is from where this plane would have it, for each unit of length.
    fn bend(&self, lay: &Lay<'_>, t: usize) -> Option<f64> {
        let [x, y] = lay.of_triangles[t].texel_axes;
        let there = self.texels.map(|texels| x * texels.x + y * texels.y);
        let bend = norm(there[0] - self.axes[0], there[1] - self.axes[1]);
        bend.is_finite().then_some(bend)
    }
}
