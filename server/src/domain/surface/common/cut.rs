//! What of one triangle lies in another, exactly: corners are whole numbers, and crossings are ratios of them.

/// A place in the plane: x / w, y / w, in units; w > 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Point {
    pub(super) x: i128,
    pub(super) y: i128,
    pub(super) w: i128,
}

/// Corners in units up to 2^24, turning left.
pub(super) type Triangle = [[i64; 2]; 3];

/// a x + b y + c w is above 0 to the left. Coefficients are below 2^50.
#[derive(Clone, Copy, Debug)]
struct Line {
    a: i128,
    b: i128,
    c: i128,
}

impl Line {
    fn through([from, to]: [[i64; 2]; 2]) -> Self {
        let [x, y] = [0, 1].map(|k| i128::from(to[k] - from[k]));
        let [from_x, from_y] = from.map(i128::from);
        Self { a: -y, b: x, c: y * from_x - x * from_y }
    }

    /// Its sign tells the side.
    fn over(self, p: Point) -> i128 {
        self.a * p.x + self.b * p.y + self.c * p.w
    }

    /// Where it crosses another.
    fn crossing(self, other: Self) -> Point {
        let x = self.b * other.c - other.b * self.c;
        let y = self.c * other.a - other.c * self.a;
        let w = self.a * other.b - other.a * self.b;
        if w < 0 { Point { x: -x, y: -y, w: -w } } else { Point { x, y, w } }
    }
}

fn sides(t: Triangle) -> [Line; 3] {
    [0, 1, 2].map(|k| Line::through([t[k], t[(k + 1) % 3]]))
}

fn point([x, y]: [i64; 2]) -> Point {
    Point { x: x.into(), y: y.into(), w: 1 }
}

/// The corners of what `t` and `other` share; fewer than three where that has no area (Sutherland and Hodgman 1974). Each
/// side remembers its line, so that a corner is a corner of either or where two lines of the triangles cross: cutting
/// again does not round, and numbers stay below 2^103.
pub(super) fn shared(t: Triangle, other: Triangle) -> Vec<Point> {
    let mut part: Vec<(Point, Line)> = t.map(point).into_iter().zip(sides(t)).collect();
    for line in sides(other) {
        part = left_of(line, &part);
    }
    part.into_iter().map(|(corner, _)| corner).collect()
}

/// Corners, and the line of the side that each begins.
fn left_of(line: Line, part: &[(Point, Line)]) -> Vec<(Point, Line)> {
    let mut kept = Vec::with_capacity(part.len() + 1);
    for (k, (corner, side)) in part.iter().enumerate() {
        let (here, there) = (line.over(*corner), line.over(part[(k + 1) % part.len()].0));
        if here >= 0 {
            kept.push((*corner, if here == 0 && there < 0 { line } else { *side }));
        }
        if here > 0 && there < 0 {
            kept.push((side.crossing(line), line));
        } else if here < 0 && there > 0 {
            kept.push((side.crossing(line), *side));
        }
    }
    kept
}

/// Weights of a triangle's corners at a place.
pub(super) fn weights(t: Triangle, at: Point) -> [f64; 3] {
    let [ab, bc, ca] = sides(t);
    let of = [bc, ca, ab].map(|side| side.over(at) as f64);
    let sum = of.iter().sum::<f64>();
    of.map(|weight| weight / sum)
}

/// The nearest whole units.
pub(super) fn rounded(p: Point) -> [i64; 2] {
    [p.x, p.y].map(|x| (2 * x + p.w).div_euclid(2 * p.w) as i64)
}

#[cfg(test)]
mod tests {
    use super::*;

    const WHOLE: Triangle = [[0, 0], [12, 0], [0, 12]];

    fn area(part: &[Point]) -> f64 {
        let at = |p: &Point| [p.x as f64 / p.w as f64, p.y as f64 / p.w as f64];
        let cross = |k: usize| {
            let ([ax, ay], [bx, by]) = (at(&part[k]), at(&part[(k + 1) % part.len()]));
            ax * by - bx * ay
        };
        (0..part.len()).map(cross).sum::<f64>() / 2.0
    }

    #[test]
    fn what_a_triangle_shares_with_itself_is_itself() {
        let corners: Vec<[i64; 2]> = shared(WHOLE, WHOLE).into_iter().map(rounded).collect();
        assert_eq!(corners, WHOLE);
    }

    #[test]
    fn corners_are_those_of_either_and_crossings() {
        let part = shared(WHOLE, [[3, 3], [15, 3], [3, 15]]);
        let corners: Vec<[i64; 2]> = part.iter().copied().map(rounded).collect();
        assert_eq!(corners.len(), 3, "{corners:?}");
        for corner in [[3, 3], [9, 3], [3, 9]] {
            assert!(corners.contains(&corner), "{corners:?}");
        }
    }

    #[test]
    fn what_only_touches_shares_no_area() {
        for other in [[[12, 0], [24, 0], [12, 12]], [[0, 0], [0, -12], [12, -12]], [[0, 0], [0, -5], [12, 0]]] {
            let part = shared(WHOLE, other);
            assert!(part.len() < 3 || area(&part) == 0.0, "{other:?}: {part:?}");
        }
    }

    #[test]
    fn parts_of_a_star_sum_to_what_they_are_cut_from() {
        let ring = [[0, 0], [12, 0], [0, 12]];
        let star = [0, 1, 2].map(|k| [ring[k], ring[(k + 1) % 3], [5, 3]]);
        let other = [0, 1, 2].map(|k| [ring[k], ring[(k + 1) % 3], [2, 7]]);
        let pairs = star.iter().flat_map(|a| other.iter().map(move |b| shared(*a, *b)));
        let sum: f64 = pairs.filter(|part| part.len() > 2).map(|part| area(&part)).sum();
        assert!((sum - 72.0).abs() < 1e-9, "{sum}");
    }

    #[test]
    fn a_place_is_the_mean_of_corners_by_its_weights() {
        let at = Point { x: 7, y: 5, w: 2 };
        let weights = weights(WHOLE, at);
        let mean = |axis: usize| (0..3).map(|k| weights[k] * WHOLE[k][axis] as f64).sum::<f64>();
        assert!((mean(0) - 3.5).abs() < 1e-12 && (mean(1) - 2.5).abs() < 1e-12, "{weights:?}");
        assert_eq!(rounded(at), [4, 3]);
    }
}
