//! How near a sheet comes to a point: exact for meshes; between two bounds, as close as asked, for surfaces.

use std::{cmp::Ordering, collections::BinaryHeap};

use glam::DVec3;

use super::{Sheet, closest::closest_on_triangle};

/// The nearest place of a sheet, as far as it is known.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Near {
    /// The distance is at least this.
    pub lower: f64,
    /// Distance to `place`, so the distance is at most this.
    pub upper: f64,
    pub place: DVec3,
    pub triangle: u32,
    /// Barycentrics in it.
    pub at: DVec3,
}

/// Cuts of one search that narrows the bounds of a surface.
const MOST_CUTS: usize = 4096;

impl Sheet<'_> {
    /// The place nearest to `point`; `hint` is a triangle that may be near. The bounds differ by at most `width`,
    /// but for surfaces that jump. `None` of an empty sheet.
    #[must_use]
    pub fn nearest(&self, point: DVec3, hint: Option<u32>, width: f64) -> Option<Near> {
        if self.residual.is_empty() {
            return self.nearest_of_mesh(point, hint, 0.0);
        }
        let (mut best, open) = self.nearest_of_surface(point, hint, 0.0)?;
        self.narrow(point, width, &mut best, open);
        Some(best)
    }

    /// A place that is at most `slack`, and of a surface twice the residual, farther than the nearest: much sooner
    /// found where many places are about as near.
    #[must_use]
    pub fn near_enough(&self, point: DVec3, hint: Option<u32>, slack: f64) -> Option<Near> {
        if self.residual.is_empty() {
            return self.nearest_of_mesh(point, hint, slack);
        }
        let (mut best, open) = self.nearest_of_surface(point, hint, slack)?;
        let least = open.iter().map(Piece::lower).fold(best.upper, f64::min);
        best.lower = (best.upper - slack).min(least).max(0.0);
        self.settle(point, &mut best);
        Some(best)
    }

    fn nearest_of_mesh(&self, point: DVec3, hint: Option<u32>, slack: f64) -> Option<Near> {
        let mut best = hint.map(|t| self.on_triangle(point, t));
        let limit = best.as_ref().map_or(f64::INFINITY, |b| within(b.1, slack));
        self.bvh.nearest(point, limit, |triangle, _| {
            let found = self.on_triangle(point, triangle);
            // Ties go to the lowest triangle, so that the order of the search does not show.
            if best.as_ref().is_none_or(|b| found.1 < b.1 || found.1 == b.1 && triangle < b.0) {
                best = Some(found);
            }
            best.as_ref().map_or(f64::INFINITY, |b| within(b.1, slack))
        });
        let (triangle, square, place, at) = best?;
        let distance = square.sqrt();
        Some(Near { lower: (distance - slack).max(0.0), upper: distance, place, triangle, at })
    }

    /// Triangle, squared distance, place and barycentrics.
    fn on_triangle(&self, point: DVec3, triangle: u32) -> (u32, f64, DVec3, DVec3) {
        let (place, at) = closest_on_triangle(point, self.corners(triangle));
        (triangle, place.distance_squared(point), place, at)
    }

    /// The best place on the triangles, and the pieces that may hold a nearer one of the surface.
    fn nearest_of_surface(&self, point: DVec3, hint: Option<u32>, slack: f64) -> Option<(Near, BinaryHeap<Piece>)> {
        let mut best: Option<Near> = None;
        let mut open: BinaryHeap<Piece> = BinaryHeap::new();
        let mut visit = |triangle: u32, least: f64| {
            let piece = Piece::whole(self, point, triangle);
            let upper = piece.distance + piece.residual;
            if best.as_ref().is_none_or(|b| upper < b.upper) {
                best = Some(Near { lower: 0.0, upper, place: piece.place, triangle, at: piece.at });
            }
            let limit = best.as_ref().map_or(least, |b| within(b.upper * b.upper, slack));
            if piece.lower() <= limit.sqrt() {
                open.push(piece);
            }
            limit
        };
        let limit = hint.map_or(f64::INFINITY, |t| visit(t, f64::INFINITY));
        self.bvh.nearest(point, limit, &mut visit);
        Some((best?, open))
    }

    /// Cuts the pieces that may hold the nearest place until the bounds are `width` apart.
    fn narrow(&self, point: DVec3, width: f64, best: &mut Near, mut open: BinaryHeap<Piece>) {
        self.settle(point, best);
        let mut cuts = 0;
        while let Some(piece) = open.pop() {
            best.lower = piece.lower().clamp(0.0, best.upper);
            if best.upper - best.lower <= width || cuts >= MOST_CUTS {
                return;
            }
            cuts += 1;
            for part in piece.quarters(self, point) {
                if part.distance < best.upper {
                    let place = self.point(part.triangle, part.at);
                    let upper = place.distance(point);
                    if upper < best.upper {
                        *best = Near { lower: 0.0, upper, place, triangle: part.triangle, at: part.at };
                    }
                }
                if part.lower() < best.upper {
                    open.push(part);
                }
            }
        }
        best.lower = best.upper;
    }

    /// From a place on a triangle to the one of the surface it stands for.
    fn settle(&self, point: DVec3, best: &mut Near) {
        best.place = self.point(best.triangle, best.at);
        best.upper = best.upper.min(best.place.distance(point));
    }
}

/// The square of a distance less the slack.
#[inline]
fn within(square: f64, slack: f64) -> f64 {
    if slack > 0.0 { (square.sqrt() - slack).max(0.0).powi(2) } else { square }
}

/// Part of a triangle of a surface.
struct Piece {
    triangle: u32,
    /// Barycentrics of its corners in the triangle.
    corners: [DVec3; 3],
    /// Of the triangle between the surface's places at the corners.
    distance: f64,
    residual: f64,
    place: DVec3,
    /// Where it is nearest, in barycentrics of the whole triangle.
    at: DVec3,
}

impl Piece {
    fn whole(sheet: &Sheet<'_>, point: DVec3, triangle: u32) -> Self {
        let (place, at) = closest_on_triangle(point, sheet.corners(triangle));
        let residual = sheet.residual(triangle);
        let corners = [DVec3::X, DVec3::Y, DVec3::Z];
        Self { triangle, corners, distance: place.distance(point), residual, place, at }
    }

    fn quarters(&self, sheet: &Sheet<'_>, point: DVec3) -> [Self; 4] {
        let [a, b, c] = self.corners;
        let [ab, bc, ca] = [0.5 * (a + b), 0.5 * (b + c), 0.5 * (c + a)];
        [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]].map(|corners| {
            let places = corners.map(|at| sheet.point(self.triangle, at));
            let (place, at) = closest_on_triangle(point, places);
            let residual = sheet.deviation(self.triangle, corners);
            let at = super::blend(corners, at);
            Self { triangle: self.triangle, corners, distance: place.distance(point), residual, place, at }
        })
    }

    fn lower(&self) -> f64 {
        (self.distance - self.residual).max(0.0)
    }
}

impl PartialEq for Piece {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}

impl Eq for Piece {}

impl PartialOrd for Piece {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

/// Nearest first from a heap that gives its largest.
impl Ord for Piece {
    fn cmp(&self, other: &Self) -> Ordering {
        other.lower().total_cmp(&self.lower()).then(other.triangle.cmp(&self.triangle))
    }
}
