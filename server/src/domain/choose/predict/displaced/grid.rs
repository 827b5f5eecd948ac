//! The small triangles of a uniform level that meet a patch, one by one where they are few.
//!
//! A place is told in sides of small triangles from the first corner of the base triangle: they are the halves of unit squares.

use glam::{DMat2, DVec2};

use crate::domain::choose::{facts::Window, predict::Seen};

/// Small triangles, and texels around them, of a patch: of more only what holds for all is told.
const MOST: f64 = 16384.0;
/// Of a side: what overlaps by less touches.
const TOUCH: f64 = 1e-9;

pub(super) struct Grid<'a> {
    patch: &'a Seen<'a>,
    first: DVec2,
    /// Texels of the sides.
    sides: [DVec2; 2],
    /// Of the patch.
    corners: [DVec2; 3],
}

/// Half of a square: its right-angled corner, and whether it is the lower half.
#[derive(Clone, Copy, Debug)]
struct Half {
    corner: DVec2,
    turn: f64,
}

impl<'a> Grid<'a> {
    pub(super) fn of(patch: &'a Seen<'a>, parts: f64) -> Self {
        let [first, b, c] = patch.view.patch.base.texels;
        let sides = [(b - first) / parts, (c - first) / parts];
        let from_texels = DMat2::from_cols(sides[0], sides[1]).inverse();
        let corners = patch.view.patch.texels.map(|texel| from_texels * (texel - first));
        Self { patch, first, sides, corners }
    }

    /// The farthest that heights of the patch are from their small triangles; infinite where these are too many.
    pub(super) fn residual(&self) -> f64 {
        let [x, y, sum] = self.spans();
        let count = (x[1] - x[0] + 1.0) * (y[1] - y[0] + 1.0);
        let texels = self.window(DVec2::ZERO, 1.0).size() + 2.0;
        let looked_at = count * texels.element_product();
        if looked_at.is_nan() || looked_at > MOST {
            return f64::INFINITY;
        }
        let squares = steps(y).flat_map(|j| steps(x).map(move |i| DVec2::new(i, j)));
        let halves = squares.flat_map(|low| [Half { corner: low, turn: 1.0 }, Half { corner: low + 1.0, turn: -1.0 }]);
        halves.filter(|half| half.meets([x, y, sum])).map(|half| self.of_half(&half)).fold(0.0, f64::max)
    }

    /// Least and greatest of x, y and x + y on the patch: halves have sides along these.
    fn spans(&self) -> [[f64; 2]; 3] {
        let of = |value: fn(DVec2) -> f64| {
            let values = self.corners.map(value);
            [values.into_iter().fold(f64::INFINITY, f64::min), values.into_iter().fold(f64::NEG_INFINITY, f64::max)]
        };
        [of(|p| p.x), of(|p| p.y), of(DVec2::element_sum)]
    }

    fn texel(&self, at: DVec2) -> DVec2 {
        self.first + self.sides[0] * at.x + self.sides[1] * at.y
    }

    fn window(&self, corner: DVec2, turn: f64) -> Window {
        Window::around([corner, corner + DVec2::X * turn, corner + DVec2::Y * turn].map(|at| self.texel(at)))
    }

    /// By the plane through its corners, or by how the heights bend.
    fn of_half(&self, half: &Half) -> f64 {
        let facts = self.patch.facts;
        let height = |way: DVec2| facts.height(self.texel(half.corner + way * half.turn));
        let (origin, window) = (height(DVec2::ZERO), self.window(half.corner, half.turn));
        let rises = DVec2::new(height(DVec2::X) - origin, height(DVec2::Y) - origin) * half.turn;
        let slope = DMat2::from_cols(self.sides[0], self.sides[1]).inverse().transpose() * rises;
        // Of a half that is larger than the patch, only where that is.
        let own = window.within(&self.patch.view.window);
        let apart = facts.apart(&own, (self.texel(half.corner), origin), slope);
        apart.min(facts.bent(&window, window.size()))
    }
}

impl Half {
    fn meets(&self, spans: [[f64; 2]; 3]) -> bool {
        let end = self.corner + self.turn;
        let sum = self.corner.element_sum();
        let own = [[self.corner.x, end.x], [self.corner.y, end.y], [sum, sum + self.turn]];
        own.iter().zip(spans).all(|(own, [low, high])| {
            let [first, last] = [own[0].min(own[1]), own[0].max(own[1])];
            first < high - TOUCH && last > low + TOUCH
        })
    }
}

/// Squares that a span meets.
fn steps([low, high]: [f64; 2]) -> impl Iterator<Item = f64> + Clone {
    let (first, last) = ((low + TOUCH).floor() as i64, (high - TOUCH).floor() as i64);
    (first..=last.max(first)).map(|i| i as f64)
}
