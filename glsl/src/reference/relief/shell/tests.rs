//! Places under points, hulls, ranges of rays, and what lies between neighbours.

use super::*;

/// Numbers of [0, 1), always the same.
pub(crate) struct Numbers(u64);

impl Numbers {
    pub(crate) fn new() -> Self {
        Self(0x9E37_79B9_7F4A_7C15)
    }

    pub(crate) fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        (self.0 >> 11) as f64 / (1u64 << 53) as f64
    }

    pub(crate) fn unit(&mut self) -> DVec3 {
        let (z, turn) = (2.0 * self.next() - 1.0, std::f64::consts::TAU * self.next());
        let across = (1.0 - z * z).sqrt();
        DVec3::new(across * turn.cos(), across * turn.sin(), z)
    }

    fn weights(&mut self) -> DVec3 {
        let (a, b) = (self.next(), self.next());
        let (a, b) = if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) };
        DVec3::new(1.0 - a - b, a, b)
    }

    /// A triangle that is no sliver, with directions up to 30 degrees from its normal and so up to 60 from each other.
    fn prism(&mut self, scale: f64, place: DVec3) -> ([DVec3; 3], [DVec3; 3]) {
        loop {
            let corners = [0; 3].map(|_| self.unit());
            let normal = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
            if normal.length() > 0.5 {
                let directions = [0; 3].map(|_| {
                    let lean = self.unit().reject_from_normalized(normal.normalize()).normalize();
                    let length = 0.5 + self.next();
                    (normal.normalize() + lean * (30f64.to_radians().tan() * self.next())) * length
                });
                return (corners.map(|c| place + c * scale), directions);
            }
        }
    }
}

#[test]
fn the_place_under_a_point_is_the_one_it_was_made_of() {
    let mut numbers = Numbers::new();
    for scale in [1e-4, 1.0, 1e4] {
        for _ in 0..2000 {
            let (corners, directions) = numbers.prism(scale, DVec3::ZERO);
            let prism = Prism::new(corners, directions, -0.2 * scale..0.2 * scale).unwrap();
            let (weights, height) = (numbers.weights(), (0.4 * numbers.next() - 0.2) * scale);
            let point = blend(&corners, weights) + blend(&directions, weights).normalize() * height;
            let local = prism.local(point);
            let under = prism.under(local, prism.guess(local)).unwrap();
            assert!((under.weights - weights).abs().max_element() < 1e-10, "{under:?} {weights}");
            assert!((prism.height(&under) - height).abs() < 1e-10 * scale);
        }
    }
}

#[test]
fn the_hull_holds_all_of_the_prism() {
    let mut numbers = Numbers::new();
    for _ in 0..200 {
        let (corners, directions) = numbers.prism(1.0, DVec3::ZERO);
        let prism = Prism::new(corners, directions, -0.2..0.3).unwrap();
        let (hull, outward) = (prism.hull(INFLATION), numbers.unit());
        let most = hull.iter().fold(f64::NEG_INFINITY, |most, p| most.max(p.dot(outward)));
        for _ in 0..100 {
            let (weights, height) = (numbers.weights(), 0.5 * numbers.next() - 0.2);
            let point = blend(&corners, weights) + blend(&directions, weights).normalize() * height;
            assert!(point.dot(outward) <= most);
        }
    }
}

/// Of the places that a dense walk finds inside, and between `low` and `high`, all are in the range; of those outside
/// that are in it, each lies between two that are inside.
#[test]
fn a_rays_range_is_where_a_dense_walk_is_inside() {
    let mut numbers = Numbers::new();
    let mut seen = 0;
    for _ in 0..1000 {
        let (corners, directions) = numbers.prism(1.0, DVec3::ZERO);
        let prism = Prism::new(corners, directions, -0.2..0.2).unwrap();
        let weights = numbers.weights();
        let aim = blend(&corners, weights) + directions[0] * (0.4 * numbers.next() - 0.2);
        let direction = numbers.unit();
        let (origin, direction) = (prism.local(aim - direction * 5.0), direction / prism.side);
        let range = prism.range(origin, direction);
        const STEP: f64 = 1.0 / 512.0;
        let inside = |t: f64| {
            let point = origin + direction * t;
            let under = prism.under(point, prism.guess(point))?;
            let height = prism.height(&under);
            (under.is_inside() && (-0.2..=0.2).contains(&height)).then_some(t)
        };
        let walked: Vec<f64> = (0..5120).filter_map(|n| inside(f64::from(n) * STEP)).collect();
        let (Some(first), Some(last)) = (walked.first(), walked.last()) else { continue };
        seen += 1;
        let range = range.unwrap();
        assert!(range.start <= *first && *last <= range.end, "{range:?} {first} {last}");
        for end in [range.start + 1e-9, range.end - 1e-9] {
            let point = origin + direction * end;
            assert!(prism.holds(point), "{range:?} {first} {last}");
        }
    }
    assert!(seen > 800, "{seen}");
}

/// Triangles of a sphere of radius 1 whose vertices have its normals, subdivided from an octahedron.
pub(crate) fn sphere(levels: u32) -> Vec<[DVec3; 3]> {
    let mut triangles = Vec::new();
    for signs in 0..8 {
        let axis = |k: usize| DVec3::AXES[k] * if signs >> k & 1 == 1 { -1.0 } else { 1.0 };
        let is_turned = (signs as u32).count_ones() % 2 == 1;
        triangles.push(if is_turned { [axis(0), axis(2), axis(1)] } else { [axis(0), axis(1), axis(2)] });
    }
    for _ in 0..levels {
        let split = |[a, b, c]: [DVec3; 3]| {
            let [ab, bc, ca] = [(a + b).normalize(), (b + c).normalize(), (c + a).normalize()];
            [[a, ab, ca], [ab, b, bc], [ca, bc, c], [ab, bc, ca]]
        };
        triangles = triangles.into_iter().flat_map(split).collect();
    }
    triangles
}

#[test]
fn no_ray_slips_between_the_prisms_of_neighbours() {
    let prisms: Vec<Prism> =
        sphere(2).into_iter().map(|corners| Prism::new(corners, corners, 0.05..0.3).unwrap()).collect();
    let mut numbers = Numbers::new();
    let mut places = 0;
    for _ in 0..1000 {
        let direction = numbers.unit();
        let across = numbers.unit().reject_from_normalized(direction).normalize() * (1.23 * numbers.next());
        let origin = across - direction * 3.0;
        let ranges: Vec<_> =
            prisms.iter().filter_map(|prism| prism.range(prism.local(origin), direction / prism.side)).collect();
        for n in 0..600 {
            let t = f64::from(n) * 0.01;
            let radius = (origin + direction * t).length();
            if (1.1..1.24).contains(&radius) {
                places += 1;
                assert!(ranges.iter().any(|range| range.contains(&t)), "t {t} radius {radius}");
            }
        }
    }
    assert!(places > 30_000, "{places}");
}

#[test]
fn a_triangle_without_area_or_directions_has_no_prism() {
    let corners = [DVec3::ZERO, DVec3::X, DVec3::Y];
    assert!(Prism::new([DVec3::ONE; 3], [DVec3::Z; 3], 0.0..1.0).is_none());
    assert!(Prism::new([DVec3::ZERO, DVec3::X, DVec3::X * 2.0], [DVec3::Z; 3], 0.0..1.0).is_none());
    assert!(Prism::new(corners, [DVec3::ZERO; 3], 0.0..1.0).is_none());
    assert!(Prism::new(corners, [DVec3::Z, -DVec3::Z, DVec3::ZERO], 0.0..1.0).is_none());
    assert!(Prism::new(corners, [DVec3::Z; 3], 0.0..1.0).is_some());
}
