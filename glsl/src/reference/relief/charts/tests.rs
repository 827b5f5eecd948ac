//! Ways over charts against places found among all triangles.

use super::{super::tests::Random, *};

/// A square of squares, each cut into two triangles, with corners moved about on the map; side 0 to 2.
struct Sheet {
    triangles: Vec<[u32; 3]>,
    places: Vec<DVec2>,
    positions: Vec<DVec3>,
    sides: Vec<ChartSides>,
}

const SQUARES: u32 = 6;

impl Sheet {
    /// Places of vertices, from those of even squares.
    fn new(place: impl Fn(DVec2) -> DVec2, seed: u64) -> Self {
        let mut random = Random(seed);
        let row = SQUARES + 1;
        let mut positions = Vec::new();
        for k in 0..row * row {
            let inner = |i: u32| i > 0 && i < SQUARES && i != SQUARES / 2;
            let jitter = |i: u32, random: &mut Random| if inner(i) { random.within(-0.3, 0.3) } else { 0.0 };
            let [i, j] = [k % row, k / row];
            let (x, y) = (f64::from(i) + jitter(i, &mut random), f64::from(j) + jitter(j, &mut random));
            positions.push(DVec3::new(x, y, 0.0) / f64::from(SQUARES));
        }
        let square = |k: u32| {
            let a = k / SQUARES * row + k % SQUARES;
            let [b, c, d] = [a + 1, a + row, a + row + 1];
            if k.is_multiple_of(2) { [[a, b, d], [a, d, c]] } else { [[a, b, c], [b, d, c]] }
        };
        let triangles: Vec<[u32; 3]> = (0..SQUARES * SQUARES).flat_map(square).collect();
        let places = positions.iter().map(|p| place(p.truncate())).collect();
        let mut sheet = Self { triangles, places, positions, sides: Vec::new() };
        sheet.sides = (0..sheet.triangles.len()).map(|t| sheet.beyond(t)).collect();
        sheet
    }

    /// By looking at all sides of all triangles.
    fn beyond(&self, t: usize) -> ChartSides {
        let mut sides = ChartSides { across: [CHART_OPEN; 3], how: [0; 3] };
        for k in 0..3 {
            let ends = |t: usize, k: usize| [self.triangles[t][k], self.triangles[t][(k + 1) % 3]];
            let [a, b] = ends(t, k);
            let all = (0..self.triangles.len()).flat_map(|t| (0..3).map(move |k| (t, k)));
            let Some((other, side)) = all.clone().find(|(t, k)| ends(*t, *k) == [b, a]) else { continue };
            let mirrored = (self.area(t) < 0.0) != (self.area(other) < 0.0);
            sides.across[k] = other as u32;
            sides.how[k] = Crossing { side: side as u32, mirrored, turns: [0; 2] }.packed();
        }
        sides
    }

    fn corners(&self, t: usize) -> [DVec2; 3] {
        self.triangles[t].map(|v| self.places[v as usize])
    }

    fn area(&self, t: usize) -> f64 {
        let [a, b, c] = self.corners(t);
        (b - a).perp_dot(c - a)
    }

    /// Least weight of a place.
    fn inside(&self, t: usize, place: DVec2) -> f64 {
        let [a, b, c] = self.corners(t);
        let weight = |p: DVec2, q: DVec2| (q - p).perp_dot(place - p) / self.area(t);
        weight(a, b).min(weight(b, c)).min(weight(c, a))
    }

    fn holds(&self, place: DVec2) -> bool {
        (0..self.triangles.len()).any(|t| self.inside(t, place) > -1e-9)
    }

    fn followed(&self, way: Way, until: f64) -> Way {
        let charts = Charts {
            sides: &self.sides,
            triangles: &self.triangles,
            place: &|v| self.places[v as usize],
            position: &|v| self.positions[v as usize],
        };
        way.followed(&charts, until, MOST_BENDS)
    }

    /// A way from a random triangle.
    fn way(&self, random: &mut Random) -> Way {
        let t = (random.unit() * self.triangles.len() as f64) as usize;
        let weights = DVec3::new(random.unit(), random.unit(), random.unit()) + 0.01;
        let [a, b, c] = self.corners(t);
        let place = (a * weights.x + b * weights.y + c * weights.z) / weights.element_sum();
        Way::new(t, place, DVec2::from_angle(random.within(0.0, std::f64::consts::TAU)))
    }
}

#[test]
fn ways_end_in_the_triangle_that_holds_their_end_or_where_no_triangle_goes_on() {
    let mut random = Random(3);
    let mut ends = [0; 2];
    for seed in 0..20 {
        // Turned and sheared, and in half of the sheets mirrored.
        let flip = if seed % 2 == 0 { 1.0 } else { -1.0 };
        let sheet = Sheet::new(|p| DVec2::new(flip * (p.x + 0.2 * p.y), 1.5 * p.y - 0.3 * p.x), seed);
        for _ in 0..200 {
            let (way, until) = (sheet.way(&mut random), random.within(0.0, 1.5));
            let found = sheet.followed(way.clone(), until);
            let place = way.place(found.t);
            assert!(sheet.inside(found.triangle, place) > -1e-9, "{found:?}");
            assert_eq!(found.turns, DVec2::ZERO);
            match found.end {
                End::Inside => assert_eq!(found.t, until),
                End::Open => assert!(!sheet.holds(way.place(found.t + 1e-6)), "{found:?}"),
                End::Seam => panic!("there is none"),
            }
            ends[usize::from(found.end == End::Open)] += 1;
        }
    }
    assert!(ends.iter().all(|count| *count > 500), "{ends:?}");
}

/// Places fold at half of x: the way on the surface is straight all the same.
#[test]
fn a_way_over_a_mirrored_sheet_is_straight_on_the_surface() {
    let mut random = Random(4);
    let folded = |p: DVec2| DVec2::new(0.5 - (p.x - 0.5).abs(), p.y);
    let mut bent = 0;
    for seed in 0..10 {
        let (sheet, flat) = (Sheet::new(folded, seed), Sheet::new(|p| p, seed));
        for _ in 0..200 {
            let (way, until) = (flat.way(&mut random), random.within(0.0, 0.8));
            let is_beyond = sheet.area(way.triangle) < 0.0;
            let flip = DVec2::new(if is_beyond { -1.0 } else { 1.0 }, 1.0);
            let start = Way::new(way.triangle, folded(way.from), way.rate * flip);
            let found = sheet.followed(start, until);
            let expected = flat.followed(way.clone(), until);
            assert_eq!((found.triangle, found.end), (expected.triangle, expected.end));
            assert!((found.t - expected.t).abs() < 1e-9);
            assert!((found.place(found.t) - folded(way.place(found.t))).length() < 1e-9);
            for (place, t) in &found.bends {
                assert!((place.x - 0.5).abs() < 1e-9 && (*place - folded(way.place(*t))).length() < 1e-9);
            }
            bent += found.bends.len();
        }
    }
    assert!(bent > 300, "{bent}");
}

/// Two triangles that lead into each other for ever, each a turn farther on.
#[test]
fn a_band_that_goes_round_is_left_after_as_many_triangles_as_are_looked_at() {
    let places = [DVec2::ZERO, DVec2::X, DVec2::Y, DVec2::ONE];
    let joined = |side, turns| Crossing { side, mirrored: false, turns };
    let (right, left) = (joined(0, [1, 0]), joined(1, [-1, 0]));
    let (up, down) = (joined(2, [0, 0]), joined(2, [0, 0]));
    // Sides: (bottom, diagonal) of the lower, whose third is its left.
    let triangles = [[2, 0, 1], [1, 3, 2]];
    let sides = [
        ChartSides { across: [1, CHART_OPEN, 1], how: [Crossing { side: 0, ..left }.packed(), 0, up.packed()] },
        ChartSides { across: [0, CHART_OPEN, 0], how: [right.packed(), 0, down.packed()] },
    ];
    let place = |v: u32| places[v as usize];
    let charts = Charts { sides: &sides, triangles: &triangles, place: &place, position: &|v| place(v).extend(0.0) };
    for turns in [0.0, 3.0, -5.0] {
        let way = Way::new(0, DVec2::new(0.25, 0.25), DVec2::X * if turns < 0.0 { -1.0 } else { 1.0 });
        let found = way.followed(&charts, f64::abs(turns), MOST_BENDS);
        assert_eq!((found.turns, found.triangle, found.end), (DVec2::new(turns, 0.0), 0, End::Inside));
    }
    let way = Way::new(0, DVec2::new(0.25, 0.25), DVec2::X);
    let far = way.followed(&charts, 1000.0, MOST_BENDS);
    assert_eq!((far.t, far.end, far.turns), (1000.0, End::Inside, DVec2::new(MOST_CROSSED as f64 / 2.0, 0.0)));
}
