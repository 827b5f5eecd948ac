//! Twin of `geometry_quadric`: a ray over the quadric that a bent surface is near to, from where it strikes the base as it is
//! raised by the greatest height (Oliveira and Policarpo 2005).
//!
//! The surface bends away from the plane through a place of the base by r·S r, S being a symmetric tensor: of directions r
//! in that plane half the normal curvature, negative where the surface is convex. The three coefficients of the quadric
//! are S in any frame of the plane; as a tensor of space it is blended over a triangle without a frame.

use std::ops::Range;

use glam::{DMat3, DVec2, DVec3, DVec4};

use crate::layout::relief::COURSE_NODES;

use super::shell::{Prism, Under};

/// Concave surfaces are not raised to where they meet themselves.
const LEAST_GROWTH: f64 = 0.25;

/// A triangle of a bent surface.
#[derive(Clone, Debug)]
pub struct Bent {
    prism: Prism,
    /// k of the raised triangle.
    raise: f64,
    /// S of the corners, in units of the prism.
    bends: [DMat3; 3],
}

/// A ray over the quadric of the place where it struck. Heights are in units of the prism, t counts from there.
#[derive(Clone, Copy, Debug)]
pub struct Flight {
    /// Along the ray, where it strikes.
    pub t: f64,
    pub weights: DVec3,
    weights_rate: DVec3,
    height: f64,
    height_rate: f64,
    /// How the height grows with the square of t.
    bend: f64,
}

impl Bent {
    /// Mesh-local; `bends` as in [`tensor`]. The triangle is raised by `raise` at its corners: all of a mesh alike, so that it
    /// stays closed.
    #[must_use]
    pub fn new(
        corners: [DVec3; 3],
        directions: [DVec3; 3],
        bends: [[f64; 6]; 3],
        heights: Range<f64>,
        raise: f64,
    ) -> Option<Self> {
        let prism = Prism::new(corners, directions.map(DVec3::normalize_or_zero), heights)?;
        let raise = raise / prism.side;
        let bends = bends.map(|bend| tensor(bend) * prism.side);
        Some(Self { prism, raise, bends })
    }

    #[must_use]
    pub fn prism(&self) -> &Prism {
        &self.prism
    }

    /// Where a ray, in units of the prism, strikes the raised front; none where it meets no front or goes up from there.
    #[must_use]
    pub fn strike(&self, origin: DVec3, direction: DVec3) -> Option<Flight> {
        let raised = self.prism.raised(self.raise);
        let (e1, e2) = (raised[1] - raised[0], raised[2] - raised[0]);
        let normal = e1.cross(e2);
        let facing = -normal.dot(direction);
        let from = origin - raised[0];
        let across = from.cross(direction);
        let t = normal.dot(from) / facing;
        let (b1, b2) = (e2.dot(across) / facing, -e1.dot(across) / facing);
        let at = Under { weights: DVec3::new(1.0 - b1 - b2, b1, b2), k: self.raise };
        (facing > 0.0 && at.is_inside()).then(|| self.flight(t, at, direction))
    }

    fn flight(&self, t: f64, at: Under, direction: DVec3) -> Flight {
        let jacobian = self.prism.jacobian(&at);
        let rates = jacobian.inverse() * direction;
        let length = jacobian.z_axis.length();
        let upright = jacobian.z_axis / length;
        let height_rate = direction.dot(upright);
        let along = direction - upright * height_rate;
        let weights = at.weights;
        let bends = self.bends[0] * weights.x + self.bends[1] * weights.y + self.bends[2] * weights.z;
        Flight {
            t,
            weights,
            weights_rate: DVec3::new(-rates.x - rates.y, rates.x, rates.y),
            height: at.k * length,
            height_rate,
            bend: raised_bend(along.dot(bends * along), along.length_squared(), at.k * length),
        }
    }
}

impl Bent {
    /// How long a ray stays between the heights: until it leaves them below, or above where the surface bends away.
    #[must_use]
    pub fn time(&self, flight: &Flight) -> Option<f64> {
        let Flight { height, height_rate, bend, .. } = *flight;
        if height_rate >= 0.0 {
            return None;
        }
        let time = |level: f64, is_first: bool| {
            let above = height - level;
            let discriminant = height_rate * height_rate + 4.0 * above * bend;
            let q = 0.5 * (discriminant.sqrt() - height_rate);
            let time = if is_first { above / q } else { -q / bend };
            (discriminant >= 0.0 && time > 0.0 && time.is_finite()).then_some(time)
        };
        time(self.prism.heights.start, true).or_else(|| time(self.prism.heights.end, false))
    }
}

impl Bent {
    /// Where a ray, mesh-local, leads over a height map, whose texels the corners are at: (x, y, height, t) at even times from
    /// where it strikes, t no less than `least`. Empty where it does not come between the heights.
    ///
    /// Between nodes a course is straight, and heights are off by an 8²·8th of what the surface bends along it at most.
    #[must_use]
    pub fn course(&self, origin: DVec3, direction: DVec3, texels: &[DVec2; 3], least: f64) -> Vec<DVec4> {
        let (origin, direction) = (self.prism.local(origin), direction / self.prism.side);
        let flight = self.strike(origin, direction).filter(|flight| flight.t >= least);
        let Some((flight, time)) = flight.and_then(|flight| Some((flight, self.time(&flight)?))) else {
            return Vec::new();
        };
        let node = |n: usize| {
            let time = time * (n as f64 / (COURSE_NODES - 1) as f64);
            let (weights, height) = flight.under(time);
            let at = texels[0] * weights.x + texels[1] * weights.y + texels[2] * weights.z;
            DVec4::new(at.x, at.y, height * self.prism.side, flight.t + time)
        };
        (0..COURSE_NODES).map(node).collect()
    }
}

impl Flight {
    /// Of the corners, and the height in units of the prism, after a time.
    #[must_use]
    pub fn under(&self, time: f64) -> (DVec3, f64) {
        let height = self.height + time * (self.height_rate - time * self.bend);
        (self.weights + self.weights_rate * time, height)
    }
}

/// Rows of a symmetric tensor: xx, xy, xz, yy, yz, zz.
#[must_use]
pub fn tensor([xx, xy, xz, yy, yz, zz]: [f64; 6]) -> DMat3 {
    DMat3::from_cols(DVec3::new(xx, xy, xz), DVec3::new(xy, yy, yz), DVec3::new(xz, yz, zz))
}

/// Of the parallel surface at a height: a curvature κ is κ / (1 + height κ) there. Near where it has no bound it stays.
fn raised_bend(bend: f64, along_squared: f64, height: f64) -> f64 {
    let growth = 1.0 - 2.0 * height * bend / along_squared;
    if along_squared > 0.0 { bend / growth.max(LEAST_GROWTH) } else { 0.0 }
}

#[cfg(test)]
mod tests;
