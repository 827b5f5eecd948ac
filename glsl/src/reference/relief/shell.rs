//! Twin of `geometry_shell`: the prism over a triangle, P(b) + h N(b)/|N(b)| for heights h from `low` to `high`, and what
//! of a ray lies in it (Porumbescu, Budge, Feng and Joy 2005).
//!
//! With k = h/|N(b)| the prism is trilinear: P(b) + k N(b). Its sides are ruled, so that a ray meets each where a quadratic
//! is zero (Ramsey, Potter and Hansen 2004), and the place under a point follows by Newton's method. Prisms of neighbours
//! share their sides; weights as low as -[`INFLATION`] count as inside, so that no ray slips between them.

mod range;

use std::ops::Range;

use glam::{DMat3, DVec3};

/// As in `geometry_shell.glsl`: how far beyond its sides a prism goes, as a weight.
pub const INFLATION: f64 = 1.0 / 4096.0;
/// Beyond the least and the greatest height, of their distance.
const MARGIN: f64 = 1.0 / 64.0;
/// Newton's method has found the place after these, or there is none.
const NEWTON_STEPS: usize = 8;
/// Of a prism's size: how near a place must come to the point it is under.
const NEWTON_RESIDUAL: f64 = 1e-4;
/// Directions are told from each other by this least length of what lies between them, of the longest.
const LEAST_LENGTH: f64 = 0.05;

/// The prism over a triangle, in units of the triangle's longest side, from its first corner.
#[derive(Clone, Debug)]
pub struct Prism {
    /// Mesh-local.
    first: DVec3,
    /// Longest side, mesh-local.
    pub side: f64,
    corners: [DVec3; 3],
    /// The longest is 1.
    directions: [DVec3; 3],
    /// Heights with a margin, so that rays begin above what is as high as any and end below what is as low.
    pub heights: Range<f64>,
    /// k of those heights anywhere in the prism.
    pub reach: Range<f64>,
    /// Unit normal of the triangle.
    upright: DVec3,
}

/// A place under a point, or the place over it where the height is negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Under {
    /// Of the corners; their sum is 1.
    pub weights: DVec3,
    /// Along the directions as they are between the corners.
    pub k: f64,
}

impl Under {
    #[must_use]
    pub fn is_inside(&self) -> bool {
        self.weights.min_element() >= -INFLATION
    }
}

impl Prism {
    /// Mesh-local corners, directions and heights; none of a triangle without area or directions.
    #[must_use]
    pub fn new(corners: [DVec3; 3], directions: [DVec3; 3], heights: Range<f64>) -> Option<Self> {
        let first = corners[0];
        let sides = [corners[1] - first, corners[2] - first, corners[2] - corners[1]];
        let side = sides.iter().fold(0.0, |most: f64, side| most.max(side.length()));
        let longest = directions.iter().fold(0.0, |most: f64, direction| most.max(direction.length()));
        let corners = [DVec3::ZERO, sides[0] / side, sides[1] / side];
        let upright = corners[1].cross(corners[2]).try_normalize().filter(|n| n.is_finite())?;
        let directions = directions.map(|direction| direction / longest);
        let margin = ((heights.end - heights.start) / side * MARGIN).max(INFLATION);
        let heights = heights.start / side - margin..heights.end / side + margin;
        let reach = reach(&directions, &heights)?;
        Some(Self { first, side, corners, directions, heights, reach, upright })
    }

    /// Units of the prism, from its first corner.
    #[must_use]
    pub fn local(&self, point: DVec3) -> DVec3 {
        (point - self.first) / self.side
    }

    /// Of a place, mesh-local.
    #[must_use]
    pub fn height(&self, under: &Under) -> f64 {
        under.k * blend(&self.directions, under.weights).length() * self.side
    }

    /// Six points around the prism when its sides are this far out, as a weight: at the corners, below, then above. All of
    /// it is between them. Mesh-local.
    #[must_use]
    pub fn hull(&self, inflation: f64) -> [DVec3; 6] {
        self.local_hull(inflation).map(|point| self.global(point))
    }

    /// The triangle at k, in units of the prism.
    pub(super) fn raised(&self, k: f64) -> [DVec3; 3] {
        [0, 1, 2].map(|i| self.corners[i] + self.directions[i] * k)
    }

    fn global(&self, point: DVec3) -> DVec3 {
        self.first + point * self.side
    }

    fn local_hull(&self, inflation: f64) -> [DVec3; 6] {
        let corners = [0, 1, 2].map(|i| blend(&self.corners, inflated(i, inflation)));
        let directions = [0, 1, 2].map(|i| blend(&self.directions, inflated(i, inflation)));
        std::array::from_fn(|n| {
            corners[n % 3] + directions[n % 3] * if n < 3 { self.reach.start } else { self.reach.end }
        })
    }

    /// The place under a point in units of the prism, by Newton's method from `near`.
    #[must_use]
    pub fn under(&self, point: DVec3, near: Under) -> Option<Under> {
        let mut at = near;
        for _ in 0..NEWTON_STEPS {
            let step = self.jacobian(&at).inverse() * self.residual(point, &at);
            at.weights += DVec3::new(-step.x - step.y, step.x, step.y);
            at.k += step.z;
        }
        let is_near = self.residual(point, &at).abs().max_element() <= NEWTON_RESIDUAL;
        is_near.then_some(at)
    }

    fn residual(&self, point: DVec3, at: &Under) -> DVec3 {
        point - blend(&self.corners, at.weights) - blend(&self.directions, at.weights) * at.k
    }

    /// How the point moves with the second and the third weight, which the first makes up for, and with k.
    pub(super) fn jacobian(&self, at: &Under) -> DMat3 {
        let along = |i: usize| self.corners[i] - self.corners[0] + (self.directions[i] - self.directions[0]) * at.k;
        DMat3::from_cols(along(1), along(2), blend(&self.directions, at.weights))
    }

    /// Where Newton's method starts for a point that nothing is known of: under the middle.
    #[must_use]
    pub fn guess(&self, point: DVec3) -> Under {
        let weights = DVec3::splat(1.0 / 3.0);
        let rise = blend(&self.directions, weights).dot(self.upright);
        let k = if rise > LEAST_LENGTH { point.dot(self.upright) / rise } else { 0.0 };
        Under { weights, k: k.clamp(self.reach.start, self.reach.end) }
    }
}

/// k of heights: these, over what the directions may be long between the corners.
fn reach(directions: &[DVec3; 3], heights: &Range<f64>) -> Option<Range<f64>> {
    let middle = directions.iter().map(|d| d.normalize_or_zero()).sum::<DVec3>().try_normalize()?;
    let least = directions.iter().fold(1.0, |least: f64, d| least.min(d.dot(middle))).max(LEAST_LENGTH);
    let low = if heights.start < 0.0 { heights.start / least } else { heights.start };
    let high = if heights.end > 0.0 { heights.end / least } else { heights.end };
    (low <= high && low.is_finite() && high.is_finite()).then_some(low..high)
}

/// Weights of a corner of the inflated triangle.
fn inflated(corner: usize, inflation: f64) -> DVec3 {
    let mut weights = DVec3::splat(-inflation);
    weights[corner] = 1.0 + 2.0 * inflation;
    weights
}

pub(super) fn blend(corners: &[DVec3; 3], weights: DVec3) -> DVec3 {
    corners[0] * weights.x + corners[1] * weights.y + corners[2] * weights.z
}

#[cfg(test)]
pub(crate) mod tests;
