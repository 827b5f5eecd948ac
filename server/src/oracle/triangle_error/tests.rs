//! The exact deviation against sampling, against a one-dimensional maximiser, and where it is known by hand.

use std::{hint::black_box, sync::Arc, time::Instant};

use glam::{DVec2, DVec3};

use super::{deviation, max_error};
use crate::domain::detail::{Map, Sampling, Wrap};
use crate::oracle::{
    field::Field,
    test_maps::{Random, any_field},
};

struct Case {
    field: Field,
    corners: [DVec2; 3],
    heights: [f64; 3],
}

impl Case {
    /// h − L.
    fn at(&self, barycentrics: DVec3) -> f64 {
        let [a, b, c] = self.corners;
        let p = a * barycentrics.x + b * barycentrics.y + c * barycentrics.z;
        self.field.value(0, p.x, p.y) - barycentrics.dot(DVec3::from_array(self.heights))
    }

    /// What h is off by where a place is rounded: texels are in [0, 1], so slopes are at most 2.
    fn rounding(&self) -> f64 {
        let far = self.corners.iter().fold(1.0_f64, |far, c| far.max(c.abs().max_element()));
        4.0 * f64::EPSILON * far
    }

    fn size(&self) -> f64 {
        let [a, b, c] = self.corners;
        a.distance(b).max(b.distance(c)).max(c.distance(a))
    }
}

fn field(width: u32, height: u32, texels: Vec<f32>, wrap: Wrap) -> Field {
    let wrap = [wrap; 2];
    Field::new(&Arc::new(Map {
        width,
        height,
        channels: 1,
        texels: texels.into(),
        wrap,
        sampling: Sampling::Center,
        source_bits: 32,
    }))
}

/// Some of them needles and points, some with corners on the lattice, some far away. `size` is in texels.
fn any_case(random: &mut Random, size: f64) -> Case {
    let field = any_field(random);
    let centre = DVec2::from([0; 2].map(|_| random.between(-10.0, 70.0))) * random.pick(&[1.0, 1.0, 1.0, 1000.0]);
    let shape = random.unit();
    let mut corners = [0; 3].map(|_| centre + size * DVec2::from([0; 2].map(|_| random.between(-0.5, 0.5))));
    if shape < 0.1 {
        corners[2] = corners[0].lerp(corners[1], random.between(-0.5, 1.5));
    } else if shape < 0.15 {
        corners = [centre; 3];
    } else if shape < 0.4 {
        corners = corners.map(DVec2::round);
    }
    let slack = random.pick(&[0.0, 0.1, 1.0]);
    let heights = corners.map(|c| field.value(0, c.x, c.y) + slack * random.between(-1.0, 1.0));
    Case { field, corners, heights }
}

#[derive(Clone, Copy)]
struct Range(f64, f64);

impl Range {
    fn of(values: impl Iterator<Item = f64>) -> Self {
        values.fold(Self(f64::INFINITY, f64::NEG_INFINITY), |Self(low, high), v| Self(low.min(v), high.max(v)))
    }

    fn and(self, o: Self) -> Self {
        Self(self.0.min(o.0), self.1.max(o.1))
    }
}

/// 64 samples a texel and more.
fn sampled(case: &Case) -> Range {
    let n = (64.0 * case.size()).ceil().max(8.0) as u32;
    let grid = (0..=n).flat_map(|i| (0..=n - i).map(move |j| [i, j, n - i - j].map(|k| f64::from(k) / f64::from(n))));
    Range::of(grid.map(|b| case.at(DVec3::from_array(b))))
}

/// Every lattice point of the bounding box that is inside. Needles have none whose barycentrics are known.
fn lattice(case: &Case) -> Range {
    let [a, b, c] = case.corners;
    let (ab, ac) = (b - a, c - a);
    let area = ab.perp_dot(ac);
    if area.abs() < 1e-6 * case.size().powi(2) {
        return Range::of([].into_iter());
    }
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    let rows = low.y as i64 - 1..=high.y as i64 + 1;
    let points = rows.flat_map(|y| (low.x as i64 - 1..=high.x as i64 + 1).map(move |x| (x, y)));
    let inside = points.filter_map(|(x, y)| {
        let p = DVec2::new(x as f64, y as f64) - a;
        let (v, w) = (p.perp_dot(ac) / area, ab.perp_dot(p) / area);
        let plane = (1.0 - v - w) * case.heights[0] + v * case.heights[1] + w * case.heights[2];
        (v >= 0.0 && w >= 0.0 && v + w <= 1.0).then(|| case.field.texel(0, x, y) - plane)
    });
    Range::of(inside)
}

/// Both ends of h − L on edge k: golden sections (Kiefer 1953) between neighbouring lattice lines.
fn edge(case: &Case, k: usize) -> Range {
    let (a, b) = (case.corners[k], case.corners[(k + 1) % 3]);
    let at = |t: f64| case.at(DVec3::AXES[k] * (1.0 - t) + DVec3::AXES[(k + 1) % 3] * t);
    let mut cuts = vec![0.0, 1.0];
    for axis in [0, 1] {
        let (low, high) = (a[axis].min(b[axis]) as i64 - 1, a[axis].max(b[axis]) as i64 + 1);
        cuts.extend((low..=high).map(|i| (i as f64 - a[axis]) / (b[axis] - a[axis])));
    }
    cuts.retain(|t| (0.0..=1.0).contains(t));
    cuts.sort_by(f64::total_cmp);
    let parts = cuts.windows(2).map(|w| Range(-golden(&|t| -at(t), w[0], w[1]), golden(&at, w[0], w[1])));
    parts.fold(Range::of(cuts.iter().map(|&t| at(t))), Range::and)
}

/// The greatest value met on the way to the maximum of a function that has one between a and b.
fn golden(f: &dyn Fn(f64) -> f64, mut a: f64, mut b: f64) -> f64 {
    const SHARE: f64 = 0.618_033_988_749_894_8;
    let (mut c, mut d) = (b - SHARE * (b - a), a + SHARE * (b - a));
    let (mut at_c, mut at_d) = (f(c), f(d));
    for _ in 0..24 {
        if at_c > at_d {
            (b, d, at_d) = (d, c, at_c);
            c = b - SHARE * (b - a);
            at_c = f(c);
        } else {
            (a, c, at_c) = (c, d, at_d);
            d = a + SHARE * (b - a);
            at_d = f(d);
        }
    }
    at_c.max(at_d)
}

const SMALL: [f64; 5] = [1e-3, 0.1, 0.7, 1.5, 3.0];

fn agree_on(cases: u32, sizes: &[f64]) {
    let mut random = Random(7);
    for k in 0..cases {
        let size = random.pick(sizes);
        let case = any_case(&mut random, size);
        let found = deviation(&case.field, 0, case.corners, case.heights);
        let name = format!("case {k}: {:?}, heights {:?}, {found:?}", case.corners, case.heights);
        let points = (0..3).map(|k| edge(&case, k)).fold(lattice(&case), Range::and);
        let all = if size <= 3.0 { sampled(&case).and(points) } else { points };
        let (low, high) = (found.lowest.value, found.highest.value);
        let rounding = case.rounding();
        assert!(low <= all.0 + rounding && high >= all.1 - rounding, "{name}: {} {} is beyond", all.0, all.1);
        assert!(points.0 - low < 1e-7 && high - points.1 < 1e-7, "{name}: maximiser {} {}", points.0, points.1);
        assert!(all.0 - low < 1e-4 && high - all.1 < 1e-4, "{name}: samples {} {}", all.0, all.1);
        for end in [found.lowest, found.highest] {
            let b = end.barycentrics;
            assert!(b.min_element() >= 0.0 && (b.element_sum() - 1.0).abs() < 1e-14, "{name}");
            assert!((case.at(b) - end.value).abs() < 1e-7, "{name}: there it is {}", case.at(b));
        }
    }
}

#[test]
fn the_deviation_is_what_sampling_and_a_maximiser_find() {
    agree_on(400, &SMALL);
}

#[test]
fn the_deviation_is_what_sampling_and_a_maximiser_find_on_ten_thousand_triangles() {
    agree_on(10_000, &SMALL);
}

#[test]
fn over_many_texels_the_deviation_is_what_a_maximiser_finds() {
    agree_on(500, &[10.0, 40.0]);
}

#[test]
fn on_the_diagonal_of_a_saddle_the_greatest_error_is_in_the_middle() {
    let field = field(2, 2, vec![0.0, 0.0, 0.0, 1.0], Wrap::Clamp);
    let found = deviation(&field, 0, [DVec2::ZERO, DVec2::ONE, DVec2::X], [0.0, 1.0, 0.0]);
    assert_eq!((found.lowest.value, found.lowest.barycentrics), (-0.25, DVec3::new(0.5, 0.5, 0.0)));
    assert_eq!((found.highest.value, found.error()), (0.0, 0.25));
}

#[test]
fn one_texel_in_a_million_is_found() {
    let mut texels = vec![0.0; 1 << 20];
    texels[300 * 1024 + 500] = 3.0;
    let field = field(1024, 1024, texels, Wrap::Repeat);
    let corners = [DVec2::new(-7.5, 3.1), DVec2::new(1020.3, 5.5), DVec2::new(400.1, 1000.7)];
    assert_eq!(max_error(&field, 0, corners, [0.0; 3]), 3.0);
    assert_eq!(max_error(&field, 0, corners.map(|c| c - DVec2::new(0.0, 400.0)), [0.5; 3]), 2.5);
}

#[test]
fn far_away_the_map_is_as_near_as_ever() {
    let mut random = Random(3);
    let texels = (0..35).map(|_| random.unit() as f32).collect();
    let field = field(7, 5, texels, Wrap::Repeat);
    let corners = [DVec2::new(0.25, 0.5), DVec2::new(9.75, 2.125), DVec2::new(3.5, 8.25)];
    let near = deviation(&field, 0, corners, [0.1, 0.2, 0.3]);
    let periods = DVec2::new(-7.0, 5.0) * f64::from(1 << 30);
    assert_eq!(deviation(&field, 0, corners.map(|c| c + periods), [0.1, 0.2, 0.3]), near);
}

#[test]
fn a_triangle_on_one_point_is_off_by_its_worst_corner() {
    let field = field(2, 2, vec![0.0, 1.0, 2.0, 7.0], Wrap::Mirror);
    let found = deviation(&field, 0, [DVec2::splat(0.5); 3], [2.0, 5.0, -1.0]);
    assert_eq!((found.lowest.value, found.lowest.barycentrics), (-2.5, DVec3::Y));
    assert_eq!((found.highest.value, found.highest.barycentrics), (3.5, DVec3::Z));
}

#[test]
fn a_plane_is_met_exactly() {
    let texels = (0..64 * 64).map(|k| (3 * (k % 64) + 2 * (k / 64)) as f32).collect();
    let field = field(64, 64, texels, Wrap::Clamp);
    let corners = [DVec2::new(0.5, 0.25), DVec2::new(62.75, 13.5), DVec2::new(21.0, 60.5)];
    let heights = corners.map(|c| 3.0 * c.x + 2.0 * c.y);
    assert!(max_error(&field, 0, corners, heights) < 1e-12);
    assert!((max_error(&field, 0, corners, heights.map(|h| h + 0.5)) - 0.5).abs() < 1e-12);
}

#[test]
#[ignore = "a measurement, run by hand: cargo test -p displace-server --lib triangle_error -- --ignored --nocapture"]
fn time_per_texel() {
    let mut random = Random(4);
    let texels = (0..1 << 18).map(|_| random.unit() as f32).collect();
    let field = field(512, 512, texels, Wrap::Repeat);
    for size in [0.1, 1.0, 4.0, 16.0, 64.0, 400.0] {
        let corner = |x: f64, y: f64| DVec2::new(20.3, 31.7) + size * DVec2::new(x, y);
        let corners = [corner(0.0, 0.1), corner(1.0, 0.0), corner(0.4, 1.0)];
        let time = || {
            let start = Instant::now();
            black_box((0..20).map(|_| max_error(&field, 0, black_box(corners), [0.5; 3])).sum::<f64>());
            start.elapsed().as_nanos() as f64 / 20.0
        };
        // The least of many short rounds: other processes only add to it.
        let ns = (0..200).map(|_| time()).fold(f64::INFINITY, f64::min);
        let texels = 0.5 * (corners[1] - corners[0]).perp_dot(corners[2] - corners[0]).abs();
        println!("{size:5} texels wide: {ns:9.0} ns, {:7.1} ns a texel of area", ns / texels);
    }
    assert!(max_error(&field, 0, [DVec2::ZERO; 3], [2.0; 3]) > 1.0);
}
