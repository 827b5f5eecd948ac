//! A colour and a shape for each method, so that either alone tells them apart.

use displace_glsl::methods::Method;

/// Radius, pixels.
pub(super) const RADIUS: f64 = 5.5;
/// Of the star around the automatic choice.
pub(super) const HALO: f64 = 15.0;

#[derive(Clone, Copy, Debug, PartialEq)]
pub(in crate::jobs) struct Mark {
    pub(in crate::jobs) color: &'static str,
    shape: Shape,
    pub(in crate::jobs) filled: bool,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum Shape {
    Circle,
    Square,
    Diamond,
    Up,
    Down,
    Left,
    Star,
    Plus,
    Cross,
}

/// Colours that stand out from white and from near black.
pub(in crate::jobs) fn mark(method: &str) -> Mark {
    use Shape::{Circle, Cross, Diamond, Down, Left, Plus, Square, Star, Up};
    let of = |method: Method| {
        let (color, shape, filled) = match method {
            Method::Flat => ("#7f8791", Circle, false),
            Method::Bump => ("#a8741a", Circle, true),
            Method::Normal => ("#a8741a", Diamond, false),
            Method::Parallax => ("#b0559f", Down, false),
            Method::ParallaxLimited => ("#b0559f", Down, true),
            Method::ParallaxIterative => ("#b0559f", Left, true),
            Method::Steep => ("#2f7fd0", Square, false),
            Method::Occlusion => ("#2f7fd0", Square, true),
            Method::Relief => ("#0f9488", Diamond, true),
            Method::Cone => ("#5d8f1c", Up, true),
            Method::Exact => ("#d2402f", Star, true),
            Method::Displacement => ("#7a5fd3", Plus, true),
            Method::Vector => ("#7a5fd3", Cross, true),
            // Never a point of its own: a chart marks the one that it chooses.
            Method::Auto => ("#7f8791", Plus, false),
        };
        Mark { color, shape, filled }
    };
    let known = displace_glsl::methods::METHODS.iter().find(|row| row.name == method);
    of(known.map_or(Method::Flat, |row| row.method))
}

impl Mark {
    /// The outline around (x, y), as an SVG path.
    pub(in crate::jobs) fn path(&self, x: f64, y: f64) -> String {
        let r = RADIUS;
        let polygon = |corners: &[[f64; 2]]| {
            let corners = corners.iter().map(|[dx, dy]| format!("{:.1} {:.1}", x + dx, y + dy));
            format!("M{}Z", corners.collect::<Vec<_>>().join("L"))
        };
        match self.shape {
            Shape::Circle => format!("M{:.1} {y:.1}a{r} {r} 0 1 0 {d} 0a{r} {r} 0 1 0 -{d} 0Z", x - r, d = 2.0 * r),
            Shape::Square => polygon(&square(0.85 * r)),
            Shape::Diamond => polygon(&[[0.0, -1.2 * r], [1.2 * r, 0.0], [0.0, 1.2 * r], [-1.2 * r, 0.0]]),
            Shape::Up => polygon(&[[0.0, -1.2 * r], [1.1 * r, 0.8 * r], [-1.1 * r, 0.8 * r]]),
            Shape::Down => polygon(&[[0.0, 1.2 * r], [1.1 * r, -0.8 * r], [-1.1 * r, -0.8 * r]]),
            Shape::Left => polygon(&[[-1.2 * r, 0.0], [0.8 * r, 1.1 * r], [0.8 * r, -1.1 * r]]),
            Shape::Star => polygon(&star(1.4 * r, 0.6 * r)),
            Shape::Plus => polygon(&plus(1.2 * r, 0.4 * r, 0.0)),
            Shape::Cross => polygon(&plus(1.2 * r, 0.4 * r, std::f64::consts::FRAC_PI_4)),
        }
    }
}

fn square(r: f64) -> [[f64; 2]; 4] {
    [[-r, -r], [r, -r], [r, r], [-r, r]]
}

/// What the automatic choice has around it, as an SVG path.
pub(super) fn halo([x, y]: [f64; 2]) -> String {
    let corners = star(HALO, 0.62 * HALO);
    let corners = corners.iter().map(|[dx, dy]| format!("{:.1} {:.1}", x + dx, y + dy));
    format!("M{}Z", corners.collect::<Vec<_>>().join("L"))
}

/// Five points.
fn star(outer: f64, inner: f64) -> Vec<[f64; 2]> {
    let corner = |k: u32| {
        let (sin, cos) = (f64::from(k) * std::f64::consts::PI / 5.0).sin_cos();
        let r = if k.is_multiple_of(2) { outer } else { inner };
        [r * sin, -r * cos]
    };
    (0..10).map(corner).collect()
}

/// Arms of length `a` and half width `b`, turned.
fn plus(a: f64, b: f64, angle: f64) -> Vec<[f64; 2]> {
    let (sin, cos) = angle.sin_cos();
    let corners =
        [[b, -a], [b, -b], [a, -b], [a, b], [b, b], [b, a], [-b, a], [-b, b], [-a, b], [-a, -b], [-b, -b], [-b, -a]];
    corners.map(|[x, y]| [x * cos - y * sin, x * sin + y * cos]).into()
}

#[cfg(test)]
mod tests {
    use displace_glsl::methods::METHODS;

    use super::*;

    #[test]
    fn without_colour_no_two_methods_look_the_same() {
        for (k, a) in METHODS.iter().enumerate() {
            for b in &METHODS[k + 1..] {
                let [p, q] = [a, b].map(|row| mark(row.name));
                assert!((p.path(0.0, 0.0), p.filled) != (q.path(0.0, 0.0), q.filled), "{} {}", a.name, b.name);
            }
        }
    }
}
