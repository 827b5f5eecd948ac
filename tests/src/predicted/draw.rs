//! A random part of a random triangle, on a random map, seen from somewhere.

use displace_server::domain::choose::patch::{BaseTriangle, Patch, PatchView, View};
use glam::{DMat2, DMat4, DQuat, DVec2, DVec3, DVec4};
use rand::{RngExt, rngs::StdRng};

use super::maps::TestMap;

/// Heights range over 1.
pub struct Case<'m> {
    pub map: &'m TestMap,
    /// The whole triangle.
    pub whole: Patch,
    /// The part that is looked at.
    pub view: PatchView,
    /// Four rows, rounded to f32.
    pub rows: Vec<[f32; 4]>,
    /// Neither directions nor normals differ over the triangle: it may go on beyond its sides.
    pub is_flat: bool,
}

impl<'m> Case<'m> {
    /// None of what is not all before the viewer, or is seen from behind.
    pub fn draw(maps: &'m [TestMap], random: &mut StdRng) -> Option<Self> {
        let map = &maps[random.random_range(0..maps.len())];
        let (whole, is_flat) = triangle(map, random)?;
        let rows = rows(&whole, random);
        let view = view(&rows);
        let mut part = whole;
        for _ in 0..random.random_range(0..4) {
            part = part.split()[random.random_range(0..4)];
        }
        let view = PatchView::new(part, &view).filter(|view| view.is_front && view.area_px > 1.0)?;
        Some(Self { map, whole, view, rows, is_flat })
    }

    /// Weights of the corners of the whole triangle: the corners of the part, and places in it.
    #[must_use]
    pub fn feet(&self, count: usize, random: &mut StdRng) -> Vec<DVec3> {
        let corners = self.view.patch.corners.map(|corner| self.weights(corner));
        let mut inside = || {
            let (a, b): (f64, f64) = (random.random(), random.random());
            let (a, b) = if a + b > 1.0 { (1.0 - a, 1.0 - b) } else { (a, b) };
            corners[0] * (1.0 - a - b) + corners[1] * a + corners[2] * b
        };
        let drawn: Vec<DVec3> = (3..count).map(|_| inside()).collect();
        corners.into_iter().chain(drawn).collect()
    }

    fn weights(&self, point: DVec3) -> DVec3 {
        let [a, b, c] = self.whole.corners;
        let (e, f, p) = (b - a, c - a, point - a);
        let gram = DMat2::from_cols_array(&[e.dot(e), e.dot(f), e.dot(f), f.dot(f)]);
        let share = gram.inverse() * DVec2::new(p.dot(e), p.dot(f));
        DVec3::new(1.0 - share.x - share.y, share.x, share.y)
    }
}

fn unit(random: &mut StdRng) -> DVec3 {
    loop {
        let v = DVec3::from_array([0; 3].map(|_| random.random_range(-1.0..1.0)));
        if (0.1..1.0).contains(&v.length()) {
            return v.normalize();
        }
    }
}

/// From low to high, each factor as likely.
fn factor(random: &mut StdRng, low: f64, high: f64) -> f64 {
    low * (high / low).powf(random.random())
}

fn triangle(map: &TestMap, random: &mut StdRng) -> Option<(Patch, bool)> {
    // The range of heights is 1.
    let side = factor(random, 2.0, 300.0);
    let corners = [0; 3].map(|_| unit(random) * side);
    let front = (corners[1] - corners[0]).cross(corners[2] - corners[0]);
    let longest = (0..3).map(|k| corners[k].distance(corners[(k + 1) % 3])).fold(0.0, f64::max);
    if front.length() < 0.1 * longest * longest {
        return None;
    }
    let front = front.normalize();
    let (normals, directions, is_flat) = normals(front, random);
    let texels = texels(corners, factor(random, 0.7, 250.0) / longest, random);
    let inside = |c: DVec2| c + map.facts.size() * 0.5;
    let texels = texels.map(inside);
    let base = BaseTriangle::new(corners, normals, directions, texels);
    let seam_distance = f64::INFINITY;
    Some((Patch { corners, normals, directions, texels, base, seam_distance, is_rim: false }, is_flat))
}

/// Half are flat, some of them with a normal that leans; others bend, and some have mitres.
fn normals(front: DVec3, random: &mut StdRng) -> ([DVec3; 3], [DVec3; 3], bool) {
    let kind: f64 = random.random();
    let lean = if kind < 0.1 { 0.4 } else { 0.0 };
    let mean = (front + unit(random) * lean).normalize();
    if kind < 0.5 {
        return ([mean; 3], [mean; 3], true);
    }
    let bend = factor(random, 0.01, 0.5);
    let normals = [0; 3].map(|_| (mean + unit(random) * bend).normalize());
    if kind < 0.9 {
        return (normals, normals, false);
    }
    let mitre = |n: DVec3| n + n.any_orthogonal_vector() * random.random_range(0.0..0.8);
    (normals, normals.map(mitre), false)
}

/// Turned, stretched, perhaps mirrored, and anywhere.
fn texels(corners: [DVec3; 3], rate: f64, random: &mut StdRng) -> [DVec2; 3] {
    let x = (corners[1] - corners[0]).normalize();
    let y = (corners[2] - corners[0]).reject_from_normalized(x).normalize();
    let turn = DMat2::from_angle(random.random_range(0.0..std::f64::consts::TAU));
    let mirror = if random.random::<bool>() { -1.0 } else { 1.0 };
    let stretch = DVec2::new(1.0, mirror * factor(random, 0.5, 2.0));
    let shift = DVec2::new(random.random_range(-60.0..60.0), random.random_range(-60.0..60.0));
    corners.map(|c| turn * (DVec2::new((c - corners[0]).dot(x), (c - corners[0]).dot(y)) * stretch * rate) + shift)
}

/// From up to 85 degrees off the normal, near or far; one in eight without perspective.
fn rows(whole: &Patch, random: &mut StdRng) -> Vec<[f32; 4]> {
    let [a, b, c] = whole.corners;
    let (e, f) = (b - a, c - a);
    let front = e.cross(f).normalize();
    let front = if front.dot(whole.normals[0]) < 0.0 { -front } else { front };
    let weights = unit(random).abs();
    let target = (a * weights.x + b * weights.y + c * weights.z) / weights.element_sum();
    let angle = random.random_range(0.0..85f64).to_radians();
    let across = front.any_orthonormal_vector();
    let turned = DQuat::from_axis_angle(front, random.random_range(0.0..std::f64::consts::TAU)) * across;
    let backward = front * angle.cos() + turned * angle.sin();
    let distance = whole.base.longest_side * factor(random, 1.0, 12.0) + 3.0;
    let up = DQuat::from_axis_angle(backward, random.random_range(0.0..6.3)) * backward.any_orthonormal_vector();
    let view = DMat4::from_cols(
        up.cross(backward).extend(0.0),
        up.extend(0.0),
        backward.extend(0.0),
        (target + backward * distance).extend(1.0),
    );
    let is_flat = random.random::<f64>() < 0.125;
    let fov = random.random_range(15.0..75f64).to_radians();
    let size = factor(random, 96.0, 2048.0);
    let scale = 0.5 * size / (0.5 * fov).tan();
    let half = DVec4::new(0.0, 0.0, 0.0, 0.5 * size);
    // Pixels times w; depth, reversed; w.
    let [x, y] = [DVec4::X * scale, DVec4::Y * -scale];
    let all = if is_flat {
        [x / distance + half, y / distance + half, DVec4::new(0.0, 0.0, 1e-4, 0.5), DVec4::W]
    } else {
        let half = DVec4::new(0.0, 0.0, -0.5 * size, 0.0);
        [x + half, y + half, DVec4::W * 1e-5, DVec4::new(0.0, 0.0, -1.0, 0.0)]
    };
    let from_world = view.inverse().transpose();
    all.map(|row| (from_world * row).as_vec4().to_array()).to_vec()
}

fn view(rows: &[[f32; 4]]) -> View {
    let [x, y, z, w] = [0, 1, 2, 3].map(|k| DVec4::from_array(rows[k].map(f64::from)));
    // Where x, y and w are all 0; towards greater depth.
    let along = |[a, b, c]: [DVec4; 3]| {
        let minor = |k: usize| {
            let pick = |v: DVec4| DVec3::from_array([1, 2, 3].map(|j| v[(k + j) % 4]));
            let sign = if k.is_multiple_of(2) { 1.0 } else { -1.0 };
            sign * pick(a).dot(pick(b).cross(pick(c)))
        };
        DVec4::new(minor(0), minor(1), minor(2), minor(3))
    };
    let eye = along([x, y, w]);
    let is_flat = w.truncate() == DVec3::ZERO;
    let eye = if is_flat { eye.with_w(0.0).normalize() } else { eye / eye.w };
    let eye = if is_flat && z.dot(eye) < 0.0 { -eye } else { eye };
    View { pixel_from_local: [x, y, w], eye, size_px: DVec2::splat(1.0), near: 0.0 }
}
