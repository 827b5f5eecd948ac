//! Highlights of a plane with a normal map over distance, against the mean of the model over 2^18 normals of it: 4096 of a
//! pixel of 32 texels.

use std::{
    f64::consts::{PI, TAU},
    sync::LazyLock,
};

use glam::{DVec2, DVec3, DVec4};
use rayon::prelude::*;

use super::super::*;
use crate::reference::{
    brdf::{Reflectance, brdf, visible_normal},
    brdf_table::Table,
    lobe_of_normals::Scatter,
    mip::Level,
    shade_pbr::{Lighting, reflected},
    texture::{WRAP_REPEAT, bilinear, trilinear},
};

const SIDE: usize = 256;
const WRAP: [u32; 2] = [WRAP_REPEAT; 2];
/// Normals of a texel each way.
const SAMPLES: usize = 2;
/// Of the grid of pixels, by which it is off the map's, pixels.
const OFF: DVec2 = DVec2::new(0.37, 0.21);

struct Maps {
    slopes: Vec<Level>,
    moments: Vec<Level>,
    normals: Vec<Level>,
}

fn level(texel: impl Fn(usize, usize) -> [f64; 4]) -> Vec<Level> {
    let texels = (0..SIDE * SIDE).map(|i| texel(i % SIDE, i / SIDE)).collect();
    Level { width: SIDE, height: SIDE, texels, alpha_scale: 1.0 }.chain()
}

impl Maps {
    fn new(slope: impl Fn(usize, usize) -> DVec2) -> Self {
        let all: Vec<DVec2> = (0..SIDE * SIDE).map(|i| slope(i % SIDE, i / SIDE)).collect();
        let at = |x: usize, y: usize| all[y * SIDE + x];
        let near = |x: usize, y: usize| at((x + SIDE - 1) % SIDE, (y + SIDE - 1) % SIDE).as_vec2().to_array();
        let around = |x: usize, y: usize| [0, 1, 2].map(|j| [0, 1, 2].map(|i| near(x + i, y + j)));
        let moments = |x: usize, y: usize| products(&around(x, y)).map(f64::from);
        Self {
            slopes: level(|x, y| [at(x, y).x, at(x, y).y, 1.0, 1.0]),
            moments: level(|x, y| DVec3::from_array(moments(x, y)).extend(1.0).to_array()),
            normals: level(|x, y| at(x, y).extend(1.0).normalize().extend(1.0).to_array()),
        }
    }

    /// Slopes of a height over the map, in units of a texel's side.
    fn of_heights(height: impl Fn(f64, f64) -> f64) -> Self {
        Self::new(|x, y| {
            let (x, y) = (x as f64 + 0.5, y as f64 + 0.5);
            let along = |dx: f64, dy: f64| height(x - dx, y - dy) - height(x + dx, y + dy);
            DVec2::new(along(0.5, 0.0), along(0.0, 0.5))
        })
    }

    fn variance(&self) -> f64 {
        let [xx, yy, ..] = self.moments.last().expect("a pyramid has a top").texels[0];
        0.5 * (xx + yy)
    }
}

/// Numbers between 0 and 1 (SplitMix64, Steele et al. 2014).
fn random(state: &mut u64) -> f64 {
    *state = state.wrapping_add(0x9E37_79B9_7F4A_7C15);
    let mut z = *state;
    z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    ((z ^ (z >> 31)) >> 11) as f64 / 2f64.powi(53)
}

/// Sums of many waves of random direction and phase, 8 to 40 of them over the map: Gaussian, with so much deviation along
/// either axis.
fn gaussian(deviation: f64) -> Maps {
    let state = &mut 7;
    let waves: Vec<(DVec2, f64)> = (0..256)
        .map(|_| {
            let (length, turn) = (8.0 + 32.0 * random(state), TAU * random(state));
            ((length * DVec2::from_angle(turn)).round(), TAU * random(state))
        })
        .collect();
    let sized = |(wave, phase): &(DVec2, f64), at: DVec2| wave.normalize() * (TAU * wave.dot(at) + phase).sin();
    let scale = deviation * (4.0 / waves.len() as f64).sqrt();
    Maps::new(|x, y| {
        let at = DVec2::new(x as f64 + 0.5, y as f64 + 0.5) / SIDE as f64;
        scale * waves.iter().map(|wave| sized(wave, at)).sum::<DVec2>()
    })
}

fn smooth_step(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * (3.0 - 2.0 * x)
}

/// Rows of bricks, each half a brick on, with rounded rims of `rim` texels.
fn bricks() -> Maps {
    Maps::of_heights(|x, y| {
        let row = (y / 16.0).floor();
        let (u, v) = ((x + 16.0 * row.rem_euclid(2.0)).rem_euclid(32.0), y.rem_euclid(16.0));
        2.0 * smooth_step(u.min(32.0 - u).min(v.min(16.0 - v)) / 5.0)
    })
}

/// Square tiles with narrow grooves, each tilted a little.
fn tiles() -> Maps {
    Maps::of_heights(|x, y| {
        let (i, j) = ((x / 32.0).floor().rem_euclid(8.0), (y / 32.0).floor().rem_euclid(8.0));
        let (u, v) = (x.rem_euclid(32.0), y.rem_euclid(32.0));
        let mut state = (i * 8.0 + j) as u64;
        let tilt = 0.1 * (DVec2::new(random(&mut state), random(&mut state)) - 0.5);
        let groove = smooth_step(u.min(32.0 - u).min(v.min(32.0 - v)) / 3.0);
        groove * (1.5 + tilt.dot(DVec2::new(u - 16.0, v - 16.0)))
    })
}

/// Half vectors, evenly over slopes of up to 3.5 deviations.
const LIGHTS: usize = 32;

/// Radiance by half vector.
type Highlight = [f64; LIGHTS];

/// A metal that reflects all, seen from `v`, lit so that half vectors have the slopes of `halves`.
struct Scene<'a> {
    surface: Reflectance,
    lighting: Lighting<'a>,
    v: DVec3,
    lights: [DVec3; LIGHTS],
}

impl<'a> Scene<'a> {
    fn new(table: &'a Table, roughness: f64, view_degrees: f64, deviation: f64) -> Self {
        let v = DVec3::new(view_degrees.to_radians().sin(), 0.0, view_degrees.to_radians().cos());
        let half = |k: usize| {
            let radius = 3.5 * deviation * ((k as f64 + 0.5) / LIGHTS as f64).sqrt();
            (radius * DVec2::from_angle(2.4 * k as f64)).extend(1.0).normalize()
        };
        let lights = std::array::from_fn(half).map(|h| 2.0 * v.dot(h) * h - v);
        let lighting = Lighting { table, lights: &[], shares: &[], ambient: 0.0, multiple_scattering: false };
        Self { surface: Reflectance::new(DVec3::ONE, 1.0, roughness), lighting, v, lights }
    }

    fn of_normal(&self, n: DVec3) -> Highlight {
        let n = visible_normal(n, self.v);
        let one = |l: &DVec3| brdf(&self.surface, self.lighting.table, n, self.v, *l, false).x * n.dot(*l).max(0.0);
        self.lights.each_ref().map(one)
    }

    fn of_normals(&self, n: DVec3, spread: &Spread) -> Highlight {
        let normals = Scatter::new(visible_normal(n, self.v), spread);
        let one = |l: &DVec3| reflected(&self.surface, &self.lighting, &normals, self.v, *l).x;
        self.lights.each_ref().map(one)
    }
}

fn sum(a: Highlight, b: Highlight) -> Highlight {
    std::array::from_fn(|k| a[k] + b[k])
}

/// Mean over all normals.
fn truth(maps: &Maps, scene: &Scene<'_>) -> Highlight {
    let side = SIDE * SAMPLES;
    let place = |i: usize| (i as f64 + 0.5) / side as f64;
    let normal = |i: usize| {
        let [x, y, ..] = bilinear(&maps.slopes[0], [place(i % side), place(i / side)], WRAP);
        DVec3::new(x, y, 1.0).normalize()
    };
    (0..side * side)
        .into_par_iter()
        .map(|i| scene.of_normal(normal(i)))
        .reduce(|| [0.0; LIGHTS], sum)
        .map(|s| s / (side * side) as f64)
}

/// Means over all pixels of so many texels a side: by moments, and by the filtered normal alone.
fn shown(maps: &Maps, scene: &Scene<'_>, texels: usize) -> [Highlight; 2] {
    let (pixels, side) = (SIDE / texels, texels as f64 / SIDE as f64);
    let under =
        Under { color: DVec4::ONE, normal: DVec3::Z, flip: 1.0, tangent: DVec4::new(1.0, 0.0, 0.0, 1.0), tilt: None };
    let of_pixel = |i: usize| {
        let middle = side * (DVec2::new((i % pixels) as f64, (i / pixels) as f64) + OFF);
        let seen = |levels: &[Level]| trilinear(levels, middle.to_array(), [side, 0.0], [0.0, side], WRAP);
        let ([bx, by, ..], [xx, yy, xy, _]) = (seen(&maps.slopes), seen(&maps.moments));
        let mean = DVec2::new(bx, by);
        let share = covered(DVec2::new(texels as f64, 0.0), DVec2::new(0.0, texels as f64));
        let spread = in_world(&under, mean, covariance(mean, [xx, yy, xy]).map(|s| share * s));
        let [x, y, z, _] = seen(&maps.normals);
        let filtered = scene.of_normal(DVec3::new(x, y, z).normalize());
        [scene.of_normals(mean.extend(1.0).normalize(), &spread), filtered]
    };
    let both = |a: [Highlight; 2], b: [Highlight; 2]| [sum(a[0], b[0]), sum(a[1], b[1])];
    let sums = (0..pixels * pixels).into_par_iter().map(of_pixel).reduce(|| [[0.0; LIGHTS]; 2], both);
    sums.map(|sums| sums.map(|s| s / (pixels * pixels) as f64))
}

/// Errors relative to the whole highlight: of its energy, and of the mean over its half vectors.
#[derive(Clone, Copy, Debug, Default)]
struct Errors {
    energy: f64,
    shape: f64,
}

impl Errors {
    fn new(found: &Highlight, truth: &Highlight) -> Self {
        let all: f64 = truth.iter().sum();
        let apart = found.iter().zip(truth).map(|(a, b)| (a - b).abs()).sum::<f64>();
        Self { energy: found.iter().sum::<f64>() / all - 1.0, shape: apart / all }
    }

    fn or_worse(self, other: Self) -> Self {
        Self { energy: self.energy.abs().max(other.energy.abs()), shape: self.shape.max(other.shape) }
    }
}

/// Largest errors over eight octaves of distance, from a texel a pixel to 256: by moments, and without. Prints energies and
/// shapes of either.
fn worst(name: &str, maps: &Maps, roughness: f64, view_degrees: f64) -> [Errors; 2] {
    static TABLE: LazyLock<Table> = LazyLock::new(Table::new);
    let scene = Scene::new(&TABLE, roughness, view_degrees, maps.variance().sqrt());
    let truth = truth(maps, &scene);
    let mut worst = [Errors::default(); 2];
    let mut rows = [String::from("moments"), String::from("without")];
    for octave in 0..=8 {
        let errors = shown(maps, &scene, 1 << octave).map(|found| Errors::new(&found, &truth));
        for ((worst, row), errors) in worst.iter_mut().zip(&mut rows).zip(errors) {
            *worst = worst.or_worse(errors);
            *row += &format!(" {:+.1} ({:.1})", 100.0 * errors.energy, 100.0 * errors.shape);
        }
    }
    println!("{name}, roughness {roughness}, seen at {view_degrees} degrees, %:\n  {}\n  {}", rows[0], rows[1]);
    worst
}

/// What is printed are errors of energy, and of shape in brackets.
#[test]
fn highlights_of_gaussian_slopes_keep_their_energy_over_eight_octaves_of_distance() {
    let maps = gaussian(0.15);
    for (roughness, view_degrees) in [(0.2, 0.0), (0.2, 60.0), (0.5, 60.0)] {
        let [moments, without] = worst("Gaussian slopes of 0.15", &maps, roughness, view_degrees);
        assert!(moments.energy < 0.02, "{roughness} {view_degrees}: {moments:?}");
        assert!(without.shape > 5.0 * moments.shape, "{moments:?} {without:?}");
    }
}

/// Their slopes are far from Gaussian: most of a brick or tile is flat, and its rim is steep. From afar the highlight of the
/// flat parts is then spread too far.
#[test]
fn highlights_of_bricks_and_tiles_keep_three_quarters_of_their_energy() {
    for (name, maps) in [("bricks", bricks()), ("tiles", tiles())] {
        let [moments, _] = worst(name, &maps, 0.3, 0.0);
        assert!(moments.energy < 0.25, "{name}: {moments:?}");
    }
}

/// Light from everywhere, met by all normals: what a metal that reflects all makes of it by the lobe alone, over what one
/// normal's lobe makes of it.
#[test]
fn the_lobe_of_many_normals_has_the_energy_of_one() {
    let single = |roughness: f64, spread: &Spread, cosine: f64| {
        let surface = Reflectance::new(DVec3::ONE, 1.0, roughness);
        let v = DVec3::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine);
        let normals = Scatter::new(DVec3::Z, spread);
        let width = (surface.alpha.powi(2) + spread.major.length_squared()).sqrt();
        let count = 40_000;
        let one = |k: u32| {
            let u = (f64::from(k) + 0.5) / f64::from(count);
            let radius = width * (u / (1.0 - u)).sqrt();
            let h = (radius * DVec2::from_angle(2.399_963 * f64::from(k))).extend(1.0).normalize();
            let density = width * width / (PI * (width * width + radius * radius).powi(2)) / h.z.powi(3);
            let l = 2.0 * v.dot(h) * h - v;
            if v.dot(h) <= 0.0 { 0.0 } else { normals.lobe(surface.alpha, v, l) * 4.0 * v.dot(h) / density }
        };
        (0..count).map(one).sum::<f64>() / f64::from(count)
    };
    for roughness in [0.2, 0.4, 0.7] {
        for cosine in [1.0, 0.7] {
            let of = |deviation: f64| {
                let spread = Spread { major: deviation * DVec3::X, minor: 0.5 * deviation * DVec3::Y };
                single(roughness, &spread, cosine)
            };
            let (one, many) = (of(0.05 * roughness * roughness), of(0.2));
            println!("roughness {roughness}, seen under {cosine}: {one:.4} {many:.4}");
            assert!((many / one - 1.0).abs() < 0.03, "{roughness} {cosine}: {one} {many}");
        }
    }
}
