//! The reprojection error of a method over a patch: the greatest of many rays, by the twins.

use displace_glsl::{
    methods::Method,
    reference::relief::{Course, March, ReliefMap, flat, level::level, pixel_ray::pixel_ray},
};
use displace_server::domain::chart::Setting;
use glam::{DVec2, DVec3, DVec4};

use rand::rngs::StdRng;

use super::draw::Case;

/// A method by a setting.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial {
    pub method: Method,
    pub setting: Setting,
}

/// All that are measured on every patch.
#[must_use]
pub fn trials() -> Vec<Trial> {
    use Method::{Cone, Displacement, Exact, Flat, Occlusion, Parallax, ParallaxIterative, ParallaxLimited, Steep};
    let of = |method: Method, setting| Trial { method, setting };
    let mut all: Vec<Trial> =
        [Flat, Parallax, ParallaxLimited, ParallaxIterative, Exact].map(|method| of(method, Setting::None)).into();
    for method in [Steep, Occlusion, Method::Relief, Cone] {
        all.extend([0, 8, 32].map(|steps| of(method, Setting::Steps(steps))));
    }
    all.extend([0, 2, 4, 6].map(|level| of(Displacement, Setting::Level(level))));
    all
}

/// Rays around the worst so far, and how often they are drawn closer.
const AROUND: usize = 24;
const ROUNDS: i32 = 4;

/// The greatest of the rays through these places of the base, weights of the whole triangle's corners, and of others around
/// the worst of them; and how much one reads on average.
#[must_use]
pub fn error_px(case: &Case<'_>, trial: &Trial, feet: &[DVec3], random: &mut StdRng) -> (f64, f64) {
    let of = |foot: DVec3| Some((foot, ray_px(case, trial, foot)?));
    let all: Vec<(DVec3, (f64, u32))> = feet.iter().filter_map(|foot| of(*foot)).collect();
    let fetches = all.iter().map(|(_, (_, fetches))| f64::from(*fetches)).sum::<f64>() / all.len().max(1) as f64;
    let worst = all.iter().map(|(foot, (px, _))| (*foot, *px)).max_by(|a, b| a.1.total_cmp(&b.1));
    let Some(mut worst) = worst else { return (0.0, fetches) };
    for round in 1..=ROUNDS {
        let near = case.feet(AROUND, random);
        let closer = near.iter().map(|foot| worst.0.lerp(*foot, 0.25f64.powi(round)));
        let found = closer.filter_map(|foot| Some((foot, ray_px(case, trial, foot)?.0)));
        worst = found.fold(worst, |worst, found| if found.1 > worst.1 { found } else { worst });
    }
    (worst.1, fetches)
}

/// And what it reads; none where what is struck is beyond a triangle that bends.
fn ray_px(case: &Case<'_>, trial: &Trial, foot: DVec3) -> Option<(f64, u32)> {
    match trial.method {
        Method::Flat => Some((apart(case, case.pixel(case.base(foot)), foot), 0)),
        Method::Displacement => Some((displaced(case, trial, foot), 0)),
        _ => marched(case, trial, foot),
    }
}

fn apart(case: &Case<'_>, pixel: DVec2, at: DVec3) -> f64 {
    case.pixel(case.surface(at)).distance(pixel)
}

fn displaced(case: &Case<'_>, trial: &Trial, foot: DVec3) -> f64 {
    let Setting::Level(level) = trial.setting else { return 0.0 };
    let parts = 2f64.powi(level as i32);
    let corners = small(foot, parts);
    let shares = shares(corners, foot);
    let point: DVec3 = (0..3).map(|k| case.surface(corners[k]) * shares[k]).sum();
    apart(case, case.pixel(point), foot)
}

/// Weights of the corners of the small triangle around a place.
fn small(at: DVec3, parts: f64) -> [DVec3; 3] {
    let (p, q) = (at.y * parts, at.z * parts);
    let (i, j) = (p.floor(), q.floor());
    let corner = |i: f64, j: f64| DVec3::new(1.0 - (i + j) / parts, i / parts, j / parts);
    if p - i + (q - j) <= 1.0 {
        [corner(i, j), corner(i + 1.0, j), corner(i, j + 1.0)]
    } else {
        [corner(i + 1.0, j + 1.0), corner(i, j + 1.0), corner(i + 1.0, j)]
    }
}

fn shares([a, b, c]: [DVec3; 3], at: DVec3) -> [f64; 3] {
    let flat = |v: DVec3| DVec2::new(v.y, v.z);
    let edges = glam::DMat2::from_cols(flat(b - a), flat(c - a));
    let share = edges.inverse() * flat(at - a);
    [1.0 - share.x - share.y, share.x, share.y]
}

/// None where what is struck is beyond a triangle that bends.
fn marched(case: &Case<'_>, trial: &Trial, foot: DVec3) -> Option<(f64, u32)> {
    let marcher = trial.method.marcher()?;
    let pixel = case.pixel(case.base(foot));
    let (map, texels) = case.level(pixel, foot);
    let whole = &case.whole;
    let base = flat::Base::new(whole.corners, case.normal(foot), texels)?;
    let ray = pixel_ray(&case.rows, pixel, whole.corners[0]);
    let range = case.map.facts.range;
    let course: Course = flat::course(&base, &ray, range[0]..range[1])?;
    let steps = if let Setting::Steps(steps) = trial.setting { steps } else { 0 };
    let march = if steps == map.steps {
        (marcher.twin)(map, &course, marcher.setting.into())
    } else {
        (marcher.twin)(&ReliefMap { steps, ..map.clone() }, &course, marcher.setting.into())
    };
    let at = base.weights(place(&march)?);
    (case.is_flat || at.min_element() >= 0.0).then(|| (apart(case, pixel, at), march.fetches))
}

fn place(march: &March) -> Option<DVec2> {
    march.is_hit().then_some(march.place)
}

impl Case<'_> {
    fn base(&self, at: DVec3) -> DVec3 {
        (0..3).map(|k| self.whole.corners[k] * at[k]).sum()
    }

    fn normal(&self, at: DVec3) -> DVec3 {
        (0..3).map(|k| self.whole.normals[k] * at[k]).sum::<DVec3>().normalize()
    }

    /// The true surface.
    fn surface(&self, at: DVec3) -> DVec3 {
        let normal: DVec3 = (0..3).map(|k| self.whole.normals[k] * at[k]).sum();
        let direction: DVec3 = (0..3).map(|k| self.whole.directions[k] * at[k]).sum();
        let texel: DVec2 = (0..3).map(|k| self.whole.texels[k] * at[k]).sum();
        self.base(at) + direction / normal.length() * self.map.levels[0].level.height(texel)
    }

    fn pixel(&self, point: DVec3) -> DVec2 {
        let [x, y, w] = [0, 1, 3].map(|k| DVec4::from_array(self.rows[k].map(f64::from)).dot(point.extend(1.0)));
        DVec2::new(x, y) / w
    }

    /// That is marched under a pixel, and where the corners lie on it.
    fn level(&self, pixel: DVec2, foot: DVec3) -> (&ReliefMap, [DVec2; 3]) {
        let levels = &self.map.levels;
        let finest = flat::Base::new(self.whole.corners, self.normal(foot), self.whole.texels);
        let k = finest.map_or(0, |base| level(&base, &self.rows, pixel, foot, levels.len()));
        let size = |map: &ReliefMap| DVec2::from_array(map.level.size.map(f64::from));
        let scale = size(&levels[k]) / size(&levels[0]);
        (&levels[k], self.whole.texels.map(|texel| (texel + 0.5) * scale - 0.5))
    }
}
