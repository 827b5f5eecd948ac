//! A triangle with the triangles around its corners, under Loop's rules (Loop 1987; limits and tangents by Hoppe et al.
//! 1994 and Biermann, Levin and Zorin 2000).

use std::f64::consts::{PI, TAU};

use displace_glsl::bezier::Net;
use glam::DVec3;

/// How a vertex moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    Inside,
    /// On a curve that its two neighbours along the border decide: a cubic B-spline.
    Border,
    /// Stays where it is.
    Fixed,
}

/// A vertex and its neighbours anticlockwise; all the way round where `closed`.
#[derive(Clone, Debug)]
pub(super) struct Corner {
    pub(super) kind: Kind,
    pub(super) closed: bool,
    pub(super) centre: DVec3,
    pub(super) ring: Vec<DVec3>,
    /// Which of the ring is the triangle's next corner; the one after that follows it.
    pub(super) at: usize,
}

impl Corner {
    /// After one subdivision.
    fn moved(&self) -> DVec3 {
        match self.kind {
            Kind::Fixed => self.centre,
            Kind::Border => 0.75 * self.centre + 0.125 * self.border(),
            Kind::Inside => {
                let beta = self.weight();
                (1.0 - beta * self.ring.len() as f64) * self.centre + beta * self.ring.iter().sum::<DVec3>()
            }
        }
    }

    pub(super) fn limit(&self) -> DVec3 {
        match self.kind {
            Kind::Fixed => self.centre,
            Kind::Border => (4.0 * self.centre + self.border()) / 6.0,
            Kind::Inside => {
                let (beta, n) = (self.weight(), self.ring.len() as f64);
                (3.0 * self.centre + 8.0 * beta * self.ring.iter().sum::<DVec3>()) / (3.0 + 8.0 * n * beta)
            }
        }
    }

    /// Of the limit surface, on the side from which the ring runs anticlockwise; any length, 0 where there is none.
    pub(super) fn normal(&self) -> DVec3 {
        let n = self.ring.len();
        if self.closed {
            // Two triangles back to back span no plane.
            if n < 3 {
                return DVec3::ZERO;
            }
            let sum = |f: fn(f64) -> f64| -> DVec3 {
                self.ring.iter().enumerate().map(|(k, q)| *q * f(TAU * k as f64 / n as f64)).sum()
            };
            return sum(f64::cos).cross(sum(f64::sin));
        }
        let (first, last) = (self.ring[0], self.ring[n - 1]);
        if self.kind == Kind::Fixed {
            return (first - self.centre).cross(last - self.centre);
        }
        (first - last).cross(self.across())
    }

    /// Into the surface from a border.
    fn across(&self) -> DVec3 {
        let n = self.ring.len();
        match n {
            2 => self.border() - 2.0 * self.centre,
            3 => self.ring[1] - self.centre,
            _ => {
                let angle = PI / (n - 1) as f64;
                let inner = self.ring[1..n - 1].iter().enumerate().map(|(k, q)| *q * (angle * (k + 1) as f64).sin());
                -(angle.sin() * self.border() + (2.0 * angle.cos() - 2.0) * inner.sum::<DVec3>())
            }
        }
    }

    fn border(&self) -> DVec3 {
        self.ring[0] + self.ring[self.ring.len() - 1]
    }

    fn weight(&self) -> f64 {
        let n = self.ring.len() as f64;
        (0.625 - (0.375 + 0.25 * (TAU / n).cos()).powi(2)) / n
    }

    fn neighbour(&self, k: usize) -> DVec3 {
        self.ring[k % self.ring.len()]
    }

    /// Whether the edge to neighbour k has triangles on both sides.
    fn is_inner(&self, k: usize) -> bool {
        self.closed || (k > 0 && k + 1 < self.ring.len())
    }

    /// The new vertex on the edge to neighbour k.
    fn spoke(&self, k: usize) -> DVec3 {
        let (n, to) = (self.ring.len(), self.neighbour(k));
        if !self.is_inner(k % n) {
            return 0.5 * (self.centre + to);
        }
        0.375 * (self.centre + to) + 0.125 * (self.neighbour(k + n - 1) + self.neighbour(k + 1))
    }

    fn child(&self) -> Self {
        let ring = (0..self.ring.len()).map(|k| self.spoke(k)).collect();
        Self { centre: self.moved(), ring, ..*self }
    }

    /// The six neighbours from the triangle's next corner on, where the surface around is one polynomial's. Across a
    /// border they are mirrored, which makes the border's rules those of the inside.
    fn regular(&self) -> Option<[DVec3; 6]> {
        let (ring, c) = (&self.ring, self.centre);
        let all = match (self.kind, ring.len()) {
            (Kind::Inside, 6) => [0, 1, 2, 3, 4, 5].map(|k| ring[k]),
            (Kind::Border, 4) if !self.closed => {
                [ring[0], ring[1], ring[2], ring[3], c + ring[3] - ring[2], c + ring[0] - ring[1]]
            }
            _ => return None,
        };
        Some(std::array::from_fn(|k| all[(self.at + k) % 6]))
    }
}

/// A triangle by its corners, anticlockwise.
#[derive(Clone, Debug)]
pub(super) struct Around(pub(super) [Corner; 3]);

impl Around {
    /// The triangles at the three corners, and the one in the middle, whose corner k lies across from corner k.
    pub(super) fn parts(&self) -> [Self; 4] {
        let own = self.0.each_ref().map(Corner::child);
        let middle = [0, 1, 2].map(|k| self.middle(k));
        let seen = |k: usize, at: usize| Corner { at, ..middle[k].clone() };
        let [a, b, c] = own;
        [
            Self([a, seen(0, 2), seen(2, 0)]),
            Self([seen(0, 0), b, seen(1, 2)]),
            Self([seen(2, 2), seen(1, 0), c]),
            Self([seen(1, 1), seen(2, 1), seen(0, 1)]),
        ]
    }

    /// The new vertex between corners k and k + 1.
    pub(super) fn middle(&self, k: usize) -> Corner {
        let (i, j) = (&self.0[k], &self.0[(k + 1) % 3]);
        let n = i.ring.len();
        let mut ring = vec![j.moved(), j.spoke(j.at), i.spoke(i.at + 1), i.moved()];
        let closed = i.is_inner(i.at);
        if closed {
            ring.extend([i.spoke(i.at + n - 1), j.spoke(j.at + 2)]);
        }
        let kind = if closed { Kind::Inside } else { Kind::Border };
        Corner { kind, closed, centre: i.spoke(i.at), ring, at: 0 }
    }

    /// The quartic that the limit surface is over a regular triangle (Lai 1992).
    pub(super) fn quartic(&self) -> Option<Net> {
        let [a, b, c] = self.0.each_ref().map(Corner::regular);
        let hex = [a?, b?, c?];
        Some(Net::new(4, |j, k| {
            let powers = [4 - j - k, j, k];
            let most = (0..3).max_by_key(|corner| (powers[*corner], 2 - corner)).unwrap_or(0);
            let (p, h) = (self.0[most].centre, &hex[most]);
            let sum = match (powers[most], powers[(most + 1) % 3]) {
                (4, _) => 12.0 * p + 2.0 * h.iter().sum::<DVec3>(),
                (3, 1) => 12.0 * p + 4.0 * h[0] + 3.0 * (h[1] + h[5]) + h[2] + h[4],
                (3, _) => 12.0 * p + 4.0 * h[1] + 3.0 * (h[2] + h[0]) + h[3] + h[5],
                (_, 1) => 10.0 * p + 6.0 * (h[0] + h[1]) + h[5] + h[2],
                (_, 2) => 8.0 * (p + h[0]) + 4.0 * (h[1] + h[5]),
                _ => 8.0 * (p + h[1]) + 4.0 * (h[0] + h[2]),
            };
            sum / 24.0
        }))
    }
}
