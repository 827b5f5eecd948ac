//! Twin of `surroundings`: what a surface sees of an environment, by its hemisphere and by the lobe of its roughness.

use std::f64::consts::PI;

use glam::{DMat3, DVec3, DVec4};

use super::{
    brdf::{MIN_ALPHA, MIN_COSINE, distribution, grazing, visibility, visible_normal},
    environment::Environment,
    moments::Spread,
};
use crate::layout::light::LOBE_SAMPLES;

/// What a fragment sees of an environment.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Surroundings {
    /// Irradiance over pi.
    pub diffuse: DVec3,
    /// Mean radiance over the lobe, weighed by what Fresnel reflects as from the front.
    pub facing: DVec3,
    /// The same, weighed by what it adds at grazing angles.
    pub grazing: DVec3,
}

/// The box that an environment is seen of from a place in it, world space.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Room {
    /// Where the environment was seen from.
    pub centre: DVec3,
    pub low: DVec3,
    pub high: DVec3,
}

impl Room {
    /// Where a ray from `position` along `d` meets a wall, as the centre sees it, of any length; and how much narrower a
    /// cone along it looks from there. Exact where all that is seen are the walls (box projection, Lagarde and Zanuttini
    /// 2012).
    #[must_use]
    pub fn looked_up(&self, position: DVec3, d: DVec3) -> (DVec3, f64) {
        let inverse = DVec3::ONE.copysign(d) / d.abs().max(DVec3::splat(1e-20));
        let far = ((self.low - position) * inverse).max((self.high - position) * inverse);
        let t = far.min_element().max(0.0);
        let wall = position + t * d - self.centre;
        (wall, t / wall.length().max(1e-10))
    }
}

/// An environment, and the room that it shows.
#[derive(Clone, Copy, Debug)]
pub struct Around<'a> {
    pub environment: &'a Environment,
    pub room: Option<Room>,
}

impl Around<'_> {
    fn arriving(&self, position: DVec3, d: DVec3, width: f64) -> DVec3 {
        let (d, share) = self.room.map_or((d, 1.0), |room| room.looked_up(position, d));
        self.environment.mirror(d, width * share)
    }
}

/// At `position`, seen from `eye`: w = 1 a place, w = 0 the direction towards an orthographic camera. Without a roughness
/// the surface is a mirror.
#[must_use]
pub fn seen(
    around: Around<'_>,
    position: DVec3,
    normal: DVec3,
    eye: DVec4,
    roughness: Option<f64>,
    footprint: f64,
) -> Surroundings {
    let v = (eye.truncate() - eye.w * position).normalize();
    let n = visible_normal(normal, v);
    let diffuse = around.environment.diffuse(n);
    let Some(roughness) = roughness else {
        let mirrored = around.arriving(position, 2.0 * n.dot(v) * n - v, footprint);
        return Surroundings { diffuse, facing: mirrored, grazing: mirrored };
    };
    let arriving = |d, width| around.arriving(position, d, width);
    let [facing, grazing] = over_lobe(arriving, v, roughness.clamp(0.0, 1.0), footprint, |_| (n, 0.0));
    Surroundings { diffuse, facing, grazing }
}

/// Twin of `surroundings_moments`: the same where many normals lie under the fragment, each sample with its own.
#[must_use]
pub fn seen_by_normals(
    around: Around<'_>,
    position: DVec3,
    normal: DVec3,
    spread: &Spread,
    eye: DVec4,
    roughness: f64,
    footprint: f64,
) -> Surroundings {
    let v = (eye.truncate() - eye.w * position).normalize();
    let n = visible_normal(normal, v);
    let roughness = roughness.clamp(0.0, 1.0);
    let added = added_area(spread, (roughness * roughness).max(MIN_ALPHA));
    let normal = |i: u32| visible_normal(sampled_normal(n, spread, i), v);
    let arriving = |d, width| around.arriving(position, d, width);
    let [facing, grazing] = over_lobe(arriving, v, roughness, footprint, |i| (normal(i), added));
    let diffuse =
        (0..LOBE_SAMPLES).map(|i| around.environment.diffuse(normal(i))).sum::<DVec3>() / f64::from(LOBE_SAMPLES);
    Surroundings { diffuse, facing, grazing }
}

/// Of the Gaussian of slopes (Box and Muller 1958), by a set that is even over it and over the lobe's samples together.
fn sampled_normal(n: DVec3, spread: &Spread, i: u32) -> DVec3 {
    let u = f64::from(i.reverse_bits()) / 2f64.powi(32) + 0.5 / f64::from(LOBE_SAMPLES);
    let radius = (-2.0 * (1.0 - u).ln()).sqrt();
    let (sine, cosine) = (PLASTIC_TURN * f64::from(i)).sin_cos();
    (n + radius * (cosine * spread.major + sine * spread.minor)).normalize()
}

/// Solid angle that the normals add to what a sample fills of the mirrored lobe seen head on.
fn added_area(spread: &Spread, alpha: f64) -> f64 {
    let wider = [spread.major, spread.minor].map(|axis| 2.0 * axis.length_squared() + alpha * alpha);
    4.0 * PI / f64::from(LOBE_SAMPLES) * ((wider[0] * wider[1]).sqrt() - alpha * alpha)
}

const LEAST_WEIGHT: f64 = 1e-6;
const GOLDEN_TURN: f64 = 2.399_963_229_73;
const PLASTIC_TURN: f64 = 4.743_036_25;

/// Means over the lobe by filtered importance sampling (Krivanek and Colbert 2008), no finer than the pixel's footprint.
/// `normal`: of each sample, and the solid angle that others add to what it fills.
fn over_lobe(
    arriving: impl Fn(DVec3, f64) -> DVec3,
    v: DVec3,
    roughness: f64,
    footprint: f64,
    normal: impl Fn(u32) -> (DVec3, f64),
) -> [DVec3; 2] {
    let alpha = (roughness * roughness).max(MIN_ALPHA);
    let (mut facing, mut grazed) = ((DVec3::ZERO, 0.0), (DVec3::ZERO, 0.0));
    for i in 0..LOBE_SAMPLES {
        let (n, added) = normal(i);
        let (world_from_local, local) = lobe_frame(v, n);
        let sample = lobe_sample(local, alpha, i);
        if sample.weight <= 0.0 {
            continue;
        }
        let width = (sample.width.powi(2) + local.z * added).sqrt().max(footprint);
        let light = arriving(world_from_local * sample.light, width);
        let (front, rest) = (sample.weight * (1.0 - sample.fresnel), sample.weight * sample.fresnel);
        facing = (facing.0 + front * light, facing.1 + front);
        grazed = (grazed.0 + rest * light, grazed.1 + rest);
    }
    // Seen from the front, next to nothing is reflected as at grazing angles: it is lit as the rest is.
    let mean = facing.0 / f64::max(facing.1, 1e-20);
    [mean, (grazed.0 + LEAST_WEIGHT * mean) / (grazed.1 + LEAST_WEIGHT)]
}

/// A frame of the world with z along `n` and v in its xz plane, and v in it.
fn lobe_frame(v: DVec3, n: DVec3) -> (DMat3, DVec3) {
    let cosine = n.dot(v).max(MIN_COSINE);
    let side = v - cosine * n;
    let other = if n.x.abs() < 0.7 { DVec3::X } else { DVec3::Y };
    let x = if side.length_squared() > 1e-8 { side.normalize() } else { n.cross(other).normalize() };
    (DMat3::from_cols(x, n.cross(x), n), DVec3::new((1.0 - cosine * cosine).max(0.0).sqrt(), 0.0, cosine))
}

/// What a sample stands for: light, what is reflected of it, and the radians that it fills.
struct LobeSample {
    light: DVec3,
    weight: f64,
    fresnel: f64,
    width: f64,
}

fn lobe_sample(v: DVec3, alpha: f64, i: u32) -> LobeSample {
    let n = f64::from(LOBE_SAMPLES);
    let h = half_vector(v, alpha, [GOLDEN_TURN * f64::from(i), (f64::from(i) + 0.5) / n]);
    let vh = v.dot(h);
    let light = 2.0 * vh * h - v;
    let masked = (alpha * alpha + (1.0 - alpha * alpha) * v.z * v.z).sqrt();
    let towards = 2.0 * v.z / (v.z + masked);
    let density = towards * distribution(alpha, h.z, h.truncate().length_squared()) / (4.0 * v.z);
    let weight = if light.z > 0.0 { visibility(alpha, v.z, light.z) * 4.0 * light.z * v.z / towards } else { 0.0 };
    LobeSample { light, weight, fresnel: grazing(vh), width: (n * density).sqrt().recip() }
}

/// Half vectors of GGX around z as `v` sees them (Heitz 2018), by caps of the ball that the ellipsoid comes from (Dupuy and
/// Benyoub 2023).
fn half_vector(v: DVec3, alpha: f64, [turn, share]: [f64; 2]) -> DVec3 {
    let stretched = DVec3::new(v.x * alpha, v.y * alpha, v.z).normalize();
    let z = (1.0 - share) * (1.0 + stretched.z) - stretched.z;
    let radius = (1.0 - z * z).clamp(0.0, 1.0).sqrt();
    let cap = DVec3::new(radius * turn.cos(), radius * turn.sin(), z) + stretched;
    DVec3::new(cap.x * alpha, cap.y * alpha, cap.z.max(1e-6)).normalize()
}

/// How a surface changes from a pixel to the next, along x and y of the image.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Change {
    /// Of the unit normal that vertices' normals give; zero where shading is flat.
    pub normal: [DVec3; 2],
    /// Of the place in the world.
    pub position: [DVec3; 2],
}

/// Radians that r = 2 (n.v) n - v moves by from this pixel to the next, whichever way it moves more. `n`: unit, as
/// `visible_normal` has it.
#[must_use]
pub fn mirrored_footprint(change: &Change, n: DVec3, position: DVec3, eye: DVec4) -> f64 {
    let way = eye.truncate() - eye.w * position;
    let (v, nearness) = (way.normalize(), eye.w / way.length());
    let along = |axis: usize| {
        let (dn, step) = (change.normal[axis], change.position[axis]);
        let dv = -nearness * (step - step.dot(v) * v);
        (2.0 * ((dn.dot(v) + n.dot(dv)) * n + n.dot(v) * dn) - dv).length()
    };
    along(0).max(along(1))
}

#[cfg(test)]
mod tests;
