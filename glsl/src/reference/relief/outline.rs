//! The outline that rays through shells and over quadrics find, beside that of the displaced triangles.

use glam::{DVec2, DVec3, DVec4};

use super::{
    Course, HeightLevel, ReliefMap,
    quadric::Bent,
    shell::{Prism, blend, tests::sphere},
    steep,
};

const PIXELS: i32 = 160;
const TEXELS: u32 = 13;
const HIGHEST: f32 = 0.12;

/// Continuous over the sphere: an octant is the map, its neighbours mirror it.
fn texel(p: DVec3) -> DVec2 {
    let p = p.abs();
    DVec2::new(p.x, p.y) / (p.x + p.y + p.z) * f64::from(TEXELS - 1)
}

fn map() -> ReliefMap {
    let heights = (0..TEXELS * TEXELS).map(|i| i.wrapping_mul(2_654_435_761) >> 24).map(|h| h as f32 / 255.0 * HIGHEST);
    let level = HeightLevel { size: [TEXELS; 2], heights: heights.collect(), repeats: [false; 2] };
    ReliefMap { level, bounds: Vec::new(), cones: Vec::new(), thinnest_texels: 1.0, steps: 256 }
}

/// Middle of a pixel.
fn place(x: i32, y: i32) -> DVec2 {
    DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5) * (2.4 / f64::from(PIXELS)) - 1.2
}

/// By courses of triangle, origin and direction.
fn traced(triangles: usize, map: &ReliefMap, course: impl Fn(usize, DVec3, DVec3) -> Vec<DVec4>) -> Vec<bool> {
    let direction = DVec3::new(0.3, 0.2, -1.0).normalize();
    let (across, up) = direction.any_orthonormal_pair();
    let is_hit = |p: DVec2| {
        let origin = across * p.x + up * p.y - direction * 3.0;
        (0..triangles).any(|t| {
            let nodes = course(t, origin, direction);
            !nodes.is_empty() && steep::marched(map, &Course { nodes, cosine: 1.0, is_open: [false; 2] }, 0.0).is_hit()
        })
    };
    (0..PIXELS * PIXELS).map(|i| is_hit(place(i % PIXELS, i / PIXELS))).collect()
}

fn displaced(triangles: &[[DVec3; 3]], map: &ReliefMap) -> Vec<bool> {
    const PARTS: i32 = 16;
    let direction = DVec3::new(0.3, 0.2, -1.0).normalize();
    let (across, up) = direction.any_orthonormal_pair();
    let mut seen = vec![false; (PIXELS * PIXELS) as usize];
    for corners in triangles {
        let texels = corners.map(texel);
        let point = |i: i32, j: i32| {
            let b = DVec3::new(f64::from(PARTS - i - j), f64::from(i), f64::from(j)) / f64::from(PARTS);
            let at = texels[0] * b.x + texels[1] * b.y + texels[2] * b.z;
            let p = blend(corners, b) + blend(corners, b).normalize() * map.level.height(at);
            DVec2::new(p.dot(across), p.dot(up))
        };
        for (i, j) in (0..PARTS).flat_map(|i| (0..PARTS - i).map(move |j| (i, j))) {
            cover(&mut seen, [point(i, j), point(i + 1, j), point(i, j + 1)]);
            if i + j + 1 < PARTS {
                cover(&mut seen, [point(i + 1, j), point(i + 1, j + 1), point(i, j + 1)]);
            }
        }
    }
    seen
}

/// Whichever way it faces.
fn cover(seen: &mut [bool], [a, b, c]: [DVec2; 3]) {
    let column = |x: f64| (((x + 1.2) * f64::from(PIXELS) / 2.4) as i32).clamp(0, PIXELS - 1);
    let (low, high) = (a.min(b).min(c), a.max(b).max(c));
    for (x, y) in (column(low.x)..=column(high.x)).flat_map(|x| (column(low.y)..=column(high.y)).map(move |y| (x, y))) {
        let p = place(x, y);
        let sides = [(b - a).perp_dot(p - a), (c - b).perp_dot(p - b), (a - c).perp_dot(p - c)];
        if sides.iter().all(|side| *side >= 0.0) || sides.iter().all(|side| *side <= 0.0) {
            seen[(y * PIXELS + x) as usize] = true;
        }
    }
}

/// Pixels with a neighbour that is not as they are.
fn outline(seen: &[bool]) -> usize {
    let at = |x: i32, y: i32| seen[(y * PIXELS + x) as usize];
    let is_border = |i: i32| {
        let (x, y) = (i % PIXELS, i / PIXELS);
        x > 0 && y > 0 && at(x, y) && !(at(x - 1, y) && at(x, y - 1) && at(x + 1, y) && at(x, y + 1))
    };
    (0..PIXELS * PIXELS).filter(|i| is_border(*i)).count()
}

/// How many pixels differ, by how many are on the outline; and how many of those are well within.
fn compared(traced: &[bool], displaced: &[bool]) -> (f64, usize) {
    let length = outline(displaced);
    assert!(length > 300, "{length}");
    let differ: Vec<usize> = (0..traced.len()).filter(|&i| traced[i] != displaced[i]).collect();
    let is_within = |i: &&usize| place(**i as i32 % PIXELS, **i as i32 / PIXELS).length() < 0.9;
    (differ.len() as f64 / length as f64, differ.iter().filter(is_within).count())
}

/// 0.019 px; what remains is that the displaced triangles are 16 parts of a side each.
#[test]
fn the_outline_of_a_shell_is_that_of_the_displaced_triangles() {
    let (triangles, map) = (sphere(3), map());
    let prism = |c: &[DVec3; 3]| Prism::new(*c, *c, 0.0..f64::from(HIGHEST)).expect("has an area");
    let prisms: Vec<_> = triangles.iter().map(|c| (prism(c), c.map(texel))).collect();
    let traced =
        traced(triangles.len(), &map, |t, origin, direction| prisms[t].0.course(origin, direction, &prisms[t].1, 0.0));
    let (off, within) = compared(&traced, &displaced(&triangles, &map));
    assert_eq!(within, 0);
    assert!(off < 0.05, "{off}");
}

/// A quadric knows one triangle's map and its bend at one place, where rays along the outline lead over several: 0.93 px
/// are left of what the base's outline is off.
#[test]
fn the_outline_over_quadrics_is_near_that_of_the_displaced_triangles() {
    let (triangles, map) = (sphere(3), map());
    let half = [[-0.5, 0.0, 0.0, -0.5, 0.0, -0.5]; 3];
    let bent = |c: &[DVec3; 3]| {
        Bent::new(*c, *c, half, 0.0..f64::from(HIGHEST), 1.05 * f64::from(HIGHEST)).expect("has an area")
    };
    let bents: Vec<_> = triangles.iter().map(|c| (bent(c), c.map(texel))).collect();
    let traced =
        traced(triangles.len(), &map, |t, origin, direction| bents[t].0.course(origin, direction, &bents[t].1, 0.0));
    let displaced_outline = displaced(&triangles, &map);
    let (off, within) = compared(&traced, &displaced_outline);
    assert_eq!(within, 0);
    let flat = ReliefMap { level: HeightLevel { heights: vec![0.0; map.level.heights.len()], ..map.level }, ..map };
    let (of_base, _) = compared(&displaced(&triangles, &flat), &displaced_outline);
    assert!(off < 0.25 * of_base, "{off} {of_base}");
}
