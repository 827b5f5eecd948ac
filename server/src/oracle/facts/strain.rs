//! How a displacement stretches and turns the triangles of a base mesh.

use glam::DVec3;
use rayon::prelude::*;

use crate::domain::{mesh::Mesh, report::Stretch, surface::Surface};

/// Stretch beyond this is told: on a height field it is a slope of 75 degrees, and a texel covers four times its
/// length.
pub const LONG: f64 = 4.0;

/// Fine triangles a thread takes at a time.
const LOT: usize = 1 << 14;

/// The stretch of a fine triangle is the largest singular value of the affine map from its part of the flat base
/// triangle to where it was moved (Sander et al. 2001): 1 is no stretch, 2 doubles a length.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Strain {
    /// Fine triangles measured: those of base triangles with area.
    pub triangles: u64,
    /// Where the largest is.
    pub max_at: Option<Spot>,
    max_square: f64,
    /// Stretched more than [`LONG`].
    pub long: u64,
    /// Fine triangles that face against their base triangle.
    pub flipped: u64,
    pub first_flipped: Option<Spot>,
    counts: Counts,
}

/// A fine triangle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Spot {
    /// Base triangle.
    pub triangle: u32,
    /// Its first corner, mesh-local units.
    pub position: [f32; 3],
}

impl Strain {
    #[must_use]
    pub fn of(mesh: &Mesh, surface: &Surface) -> Self {
        let lots = surface.triangles.par_chunks(LOT).enumerate();
        let measured = lots.fold(Self::default, |mut strain, (lot, triangles)| {
            strain.add_lot(mesh, surface, lot * LOT, triangles);
            strain
        });
        measured.reduce(Self::default, Self::joined)
    }

    /// Of two surfaces, or two parts of one, `self` before `other`.
    #[must_use]
    pub fn joined(mut self, other: Self) -> Self {
        if other.max_square > self.max_square {
            (self.max_square, self.max_at) = (other.max_square, other.max_at);
        }
        self.triangles += other.triangles;
        self.long += other.long;
        self.flipped += other.flipped;
        self.first_flipped = self.first_flipped.or(other.first_flipped);
        self.counts.add(&other.counts);
        self
    }

    /// None where nothing was measured. p99 is at most 0.8 % above the true percentile of the fine triangles.
    #[must_use]
    pub fn stretch(&self) -> Option<Stretch> {
        let max = self.max_square.sqrt();
        (self.triangles > 0).then(|| Stretch { p99: self.counts.percentile(0.99).min(max), max })
    }

    /// The inner loop of every report: without closures over arrays, which are not inlined in builds for tests.
    fn add_lot(&mut self, mesh: &Mesh, surface: &Surface, first: usize, triangles: &[[u32; 3]]) {
        let mut walk = Walk::from(first as u64, surface.level);
        let mut frame = Frame::of(mesh, walk.base, surface.level);
        for &[a, b, c] in triangles {
            if let Some(frame) = &frame {
                let at = surface.positions[a as usize];
                let corners = [exact(at), exact(surface.positions[b as usize]), exact(surface.positions[c as usize])];
                let (square, flipped) = frame.of_fine(corners, walk.upright());
                self.add(square, flipped, Spot { triangle: walk.base as u32, position: at });
            }
            if walk.advance() && walk.base < mesh.triangles.len() {
                frame = Frame::of(mesh, walk.base, surface.level);
            }
        }
    }

    #[inline]
    fn add(&mut self, square: f64, flipped: bool, spot: Spot) {
        self.triangles += 1;
        self.counts.count(square);
        self.long += u64::from(square > LONG * LONG);
        if square > self.max_square {
            (self.max_square, self.max_at) = (square, Some(spot));
        }
        if flipped {
            self.flipped += 1;
            self.first_flipped = self.first_flipped.or(Some(spot));
        }
    }
}

#[inline]
fn exact(p: [f32; 3]) -> DVec3 {
    DVec3::new(f64::from(p[0]), f64::from(p[1]), f64::from(p[2]))
}

/// A base triangle with area, prepared for its fine triangles.
struct Frame {
    /// From the sides of a fine triangle to derivatives along two unit vectors across each other.
    inverse: [f64; 3],
    normal: DVec3,
}

impl Frame {
    fn of(mesh: &Mesh, base: usize, level: u32) -> Option<Self> {
        let place = |av: u32| exact(mesh.gv_position[mesh.av_gv[av as usize] as usize]);
        let [a, b, c] = mesh.triangles[base].av;
        let (p, q, r) = (place(a), place(b), place(c));
        let normal = (q - p).cross(r - p);
        let along = (q - p).length();
        let (across, skew) = (normal.length() / along, (q - p).dot(r - p) / along);
        let segments = (1u64 << level) as f64;
        let inverse = [segments / along, -segments * skew / (along * across), segments / across];
        (inverse[0] + inverse[1] + inverse[2]).is_finite().then_some(Self { inverse, normal })
    }

    /// The square of the stretch, and whether it is flipped. Fine triangles have the corners (i, j), (i + 1, j), (i, j + 1) when
    /// upright, else (i + 1, j), (i + 1, j + 1), (i, j + 1).
    #[inline]
    fn of_fine(&self, [a, b, c]: [DVec3; 3], upright: bool) -> (f64, bool) {
        let (i, j) = if upright { (b - a, c - a) } else { (b - c, b - a) };
        let (s, t) = (i * self.inverse[0], i * self.inverse[1] + j * self.inverse[2]);
        let (ss, st, tt) = (s.dot(s), s.dot(t), t.dot(t));
        let square = 0.5 * (ss + tt) + (0.25 * (ss - tt) * (ss - tt) + st * st).sqrt();
        (square, i.cross(j).dot(self.normal) < 0.0)
    }
}

/// Goes through the fine triangles in their order: rows of constant j, upright and inverted in turn.
struct Walk {
    base: usize,
    /// Triangles from here to the end of the base triangle.
    left: u64,
    /// Of them, those beyond this row: the square of the rows that follow.
    beyond: u64,
    segments: u64,
}

impl Walk {
    fn from(first: u64, level: u32) -> Self {
        let segments = 1u64 << level;
        let all = segments * segments;
        let left = all - first % all;
        let rows = (left - 1).isqrt();
        Self { base: (first / all) as usize, left, beyond: rows * rows, segments }
    }

    /// A row has one upright triangle more than inverted ones.
    #[inline]
    fn upright(&self) -> bool {
        (self.left - self.beyond) % 2 == 1
    }

    /// Is the next one in another base triangle?
    #[inline]
    fn advance(&mut self) -> bool {
        self.left -= 1;
        if self.left == 0 {
            *self = Self { base: self.base + 1, left: self.segments * self.segments, ..*self };
            self.beyond = (self.segments - 1) * (self.segments - 1);
            return true;
        }
        if self.left == self.beyond {
            let rows = self.beyond.isqrt() - 1;
            self.beyond = rows * rows;
        }
        false
    }
}

/// How many values lie in each 128th of an octave from 2^-16 to 2^16.
#[derive(Clone, Debug, PartialEq)]
struct Counts(Vec<u64>);

impl Default for Counts {
    fn default() -> Self {
        Self(vec![0; Self::SIZE])
    }
}

impl Counts {
    const SIZE: usize = 64 << 6;
    /// f32 bits of 2^-32, the square of the lowest, without the last 17.
    const LOWEST: usize = 95 << 6;

    #[inline]
    fn count(&mut self, square: f64) {
        let bin = ((square as f32).to_bits() >> 17) as usize;
        self.0[bin.saturating_sub(Self::LOWEST).min(Self::SIZE - 1)] += 1;
    }

    fn add(&mut self, other: &Self) {
        self.0.iter_mut().zip(&other.0).for_each(|(own, others)| *own += others);
    }

    /// The upper end of the bin in which the share `part` of all values is reached; infinite in the last.
    fn percentile(&self, part: f64) -> f64 {
        let wanted = (part * self.0.iter().sum::<u64>() as f64).ceil() as u64;
        let mut sum = 0;
        let reached = self.0.iter().position(|count| {
            sum += count;
            sum >= wanted
        });
        let next = reached.map_or(Self::SIZE, |bin| bin + 1);
        let bits = ((next + Self::LOWEST) as u32) << 17;
        if next < Self::SIZE { f64::from(f32::from_bits(bits)).sqrt() } else { f64::INFINITY }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_are_walked_in_order_from_anywhere() {
        for level in 0..4 {
            let n = 1u64 << level;
            let rows = (0..n).flat_map(|j| (0..2 * (n - j) - 1).map(|k| k % 2 == 0));
            let twice: Vec<bool> = rows.clone().chain(rows).collect();
            for first in 0..twice.len() {
                let mut walk = Walk::from(first as u64, level);
                for (at, &upright) in twice.iter().enumerate().skip(first) {
                    assert_eq!((walk.upright(), walk.base as u64), (upright, at as u64 / (n * n)), "{level} {at}");
                    walk.advance();
                }
            }
        }
    }

    #[test]
    fn percentiles_are_the_upper_ends_of_their_bins() {
        let mut counts = Counts::default();
        (1..=1000).for_each(|k| counts.count((f64::from(k) / 100.0).powi(2)));
        for part in [0.01, 0.5, 0.99] {
            let (found, exact) = (counts.percentile(part), 10.0 * part);
            assert!(found >= exact && found <= exact * 1.008, "{part}: {found}");
        }
        counts.count(1e30);
        assert_eq!(counts.percentile(1.0), f64::INFINITY);
    }
}
