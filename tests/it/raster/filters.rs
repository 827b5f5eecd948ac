//! The passes that filter maps against their f64 twins, from the same f32 input.

use std::sync::Arc;

use displace_glsl::{
    ComputeShader, SHADERS,
    layout::raster::{MAP_SLOTS, SurfacePoint, TextureParams, TextureUse},
    reference::{
        mip::Level,
        texture::{Filter, filtered},
    },
};
use displace_server::{
    domain::cancel::{Cancel, NoProgress},
    vulkan::{Device, Stream},
};
use rand::{RngExt as _, SeedableRng, rngs::StdRng};

use super::device;

/// Sizes of all kinds: one texel, a row, odd, not square, large.
const SIZES: [[usize; 2]; 8] = [[1, 1], [1, 9], [64, 1], [3, 3], [37, 29], [256, 4], [64, 64], [400, 300]];
/// Every map is used with each of the wraps along u and along v.
const WRAPS: u32 = 9;
const PLACES_PER_USE: usize = 40;

fn shader(filter: Filter) -> &'static ComputeShader {
    match filter {
        Filter::Nearest => &SHADERS.texture_nearest,
        Filter::Bilinear => &SHADERS.texture_bilinear,
        Filter::Trilinear => &SHADERS.texture_trilinear,
        Filter::Anisotropic => &SHADERS.texture_anisotropic,
        Filter::Ewa => &SHADERS.texture_ewa,
    }
}

/// Maps of random texels in 0 to 1, of values that f32 holds, and scales of alpha.
fn maps(random: &mut StdRng) -> Vec<Vec<Level>> {
    let map = |[width, height]: [usize; 2]| {
        let texel = |random: &mut StdRng| [0; 4].map(|_| f64::from(random.random::<f32>()));
        let texels = (0..width * height).map(|_| texel(random)).collect();
        let mut levels = Level { width, height, texels, alpha_scale: 1.0 }.chain();
        for level in &mut levels {
            level.alpha_scale = f64::from(random.random_range(0.5f32..2.0));
            level.texels.iter_mut().flatten().for_each(|value| *value = f64::from(*value as f32));
        }
        levels
    };
    SIZES.map(map).to_vec()
}

/// Streams `levels` and `texels`, and the first level of each map.
fn pyramids(device: &Arc<Device>, maps: &[Vec<Level>]) -> (Stream, Stream, Vec<u32>) {
    let (mut rows, mut texels, mut firsts) = (Vec::new(), Vec::<[f32; 4]>::new(), Vec::new());
    for levels in maps {
        firsts.push(rows.len() as u32);
        for level in levels {
            let scale = (level.alpha_scale as f32).to_bits();
            rows.push([texels.len() as u32, level.width as u32, level.height as u32, scale]);
            texels.extend(level.texels.iter().map(|texel| texel.map(|value| value as f32)));
            texels.resize(texels.len().next_multiple_of(2), [0.0; 4]);
        }
    }
    let pairs: &[[f32; 8]] = bytemuck::cast_slice(&texels);
    let stream = |name: &str| Stream::from_slice(device, name, &rows).expect("fits");
    (stream("levels"), Stream::from_slice(device, "texels", pairs).expect("fits"), firsts)
}

/// What one thread filters: a place and the sides of a pixel, in units of the map.
#[derive(Clone, Copy, Debug)]
struct Place {
    map: usize,
    wrap: u32,
    uv: [f32; 2],
    dx: [f32; 2],
    dy: [f32; 2],
}

impl Place {
    fn wraps(&self) -> [u32; 2] {
        [self.wrap % 3, self.wrap / 3]
    }

    /// The corners of the triangle have uv (0, 0), (1, 0) and (0, 1), so that weights are uv.
    fn point(&self) -> SurfacePoint {
        let at = |[u, v]: [f32; 2]| [0.0, u, v];
        SurfacePoint {
            material: self.map as u32 * WRAPS + self.wrap,
            vertices: [0, 1, 2],
            at: at(self.uv),
            at_dx: at(self.dx),
            at_dy: at(self.dy),
            ..Default::default()
        }
    }

    fn expected(&self, filter: Filter, maps: &[Vec<Level>]) -> [f64; 4] {
        let [uv, dx, dy] = [self.uv, self.dx, self.dy].map(|p| p.map(f64::from));
        filtered(filter, &maps[self.map], uv, dx, dy, self.wraps())
    }
}

/// Random places and sides: footprints from much less than a texel to more than the map, of any shape.
fn places(random: &mut StdRng, maps: &[Vec<Level>]) -> Vec<Place> {
    let mut places = Vec::new();
    for (map, levels) in maps.iter().enumerate() {
        for k in 0..WRAPS as usize * PLACES_PER_USE {
            let size = [levels[0].width as f32, levels[0].height as f32];
            let length = random.random_range(-3.0f32..7.0).exp2();
            let width = length * random.random_range(-6.0f32..0.0).exp2();
            let [angle, turn] = [0; 2].map(|_| random.random_range(0.0f32..std::f32::consts::TAU));
            let side = |angle: f32| {
                let (x, y) = (length * angle.cos(), width * angle.sin());
                [(x * turn.cos() - y * turn.sin()) / size[0], (x * turn.sin() + y * turn.cos()) / size[1]]
            };
            let (dx, dy) = (side(angle), side(angle + 1.4));
            let uv = [0; 2].map(|_| random.random_range(-1.5f32..2.5));
            places.push(Place { map, wrap: k as u32 % WRAPS, uv, dx, dy });
        }
    }
    places
}

fn run(filter: Filter, maps: &[Vec<Level>], places: &[Place]) -> Vec<[f32; 4]> {
    let device = device();
    let (levels, texels, firsts) = pyramids(device, maps);
    let uses = (0..maps.len() as u32 * WRAPS).flat_map(|i| {
        let (map, wrap) = ((i / WRAPS) as usize, i % WRAPS);
        let used = TextureUse {
            map_u: [1.0, 0.0, 0.0],
            map_v: [0.0, 1.0, 0.0],
            wrap: (wrap % 3) | ((wrap / 3) << 2),
            uv_channel: 0,
            level_first: firsts[map],
            level_count: maps[map].len() as u32,
        };
        std::array::from_fn::<_, MAP_SLOTS, _>(|slot| if slot == 0 { used } else { TextureUse::default() })
    });
    let uses: Vec<TextureUse> = uses.collect();
    let points: Vec<SurfacePoint> = places.iter().map(Place::point).collect();
    let mapped = Stream::new(device, "mapped", 16, places.len() as u64).expect("fits");
    let bound = [
        ("points", &Stream::from_slice(device, "points", &points).expect("fits")),
        ("maps", &Stream::from_slice(device, "maps", &uses).expect("fits")),
        ("uvs", &Stream::from_slice(device, "uvs", &[[0f32, 0.0], [1.0, 0.0], [0.0, 1.0]]).expect("fits")),
        ("levels", &levels),
        ("texels", &texels),
        ("mapped", &mapped),
    ];
    let params = TextureParams { count: places.len() as u32, slot: 0, uv_channels: 1, footprint: 1.0 };
    let cancel = Cancel::default();
    let mut recorder = device.recorder(&cancel, &NoProgress);
    recorder.dispatch(shader(filter), places.len() as u64, &params, &bound).expect("records");
    recorder.finish().expect("runs");
    mapped.read().expect("reads")
}

/// How far f32 may be off on maps of range 1 (whose alpha is scaled by at most 2): a place is rounded by 2^-24 of up to two
/// periods of the map, a value changes by at most 1 per texel along an axis; a level is rounded by about 2^-21, between
/// levels a value changes by 1; a weight of an ellipse of 16 by 1 by some 2^8 ulp, as its determinant is a
/// difference of products that much larger.
fn allowed(filter: Filter, levels: &[Level]) -> f64 {
    let ulp = 2f64.powi(-24);
    let texels = (levels[0].width + levels[0].height) as f64;
    let place = 4.0 * texels * ulp;
    let scaled = 2.0;
    scaled
        * match filter {
            Filter::Nearest => ulp,
            Filter::Bilinear => place + 8.0 * ulp,
            Filter::Trilinear => place + 32.0 * ulp,
            Filter::Anisotropic => place + 32.0 * ulp,
            Filter::Ewa => place + 256.0 * ulp,
        }
}

/// Whether a place is so near to the border of a texel that rounding decides which it is on.
fn between_texels(place: &Place, finest: &Level) -> bool {
    let near = |u: f32, size: usize| {
        let p = f64::from(u) * size as f64;
        (p - p.round()).abs() < 8.0 * size as f64 * 2f64.powi(-24)
    };
    near(place.uv[0], finest.width) || near(place.uv[1], finest.height)
}

#[test]
fn filters_on_the_device_agree_with_their_twins() {
    let mut random = StdRng::seed_from_u64(17);
    let maps = maps(&mut random);
    let places = places(&mut random, &maps);
    for filter in Filter::ALL {
        let mut worst = 0f64;
        for (place, found) in places.iter().zip(run(filter, &maps, &places)) {
            if filter == Filter::Nearest && between_texels(place, &maps[place.map][0]) {
                continue;
            }
            let expected = place.expected(filter, &maps);
            let off = found.iter().zip(expected).map(|(a, b)| (f64::from(*a) - b).abs()).fold(0.0, f64::max);
            let part = off / allowed(filter, &maps[place.map]);
            assert!(part <= 1.0, "{filter:?}: {found:?} for {expected:?} at {place:?}");
            worst = worst.max(part);
        }
        println!("{filter:?}: at most {worst:.2} of what is allowed");
    }
}

#[test]
fn derivatives_that_are_not_numbers_or_endless_show_the_coarsest_level_on_the_device() {
    let mut random = StdRng::seed_from_u64(18);
    let maps = maps(&mut random);
    let mut places = Vec::new();
    for odd in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, 3e38] {
        for (map, which) in (0..maps.len()).flat_map(|map| (0..4).map(move |which| (map, which))) {
            let mut sides = [0.01f32; 4];
            sides[which] = odd;
            let [a, b, c, d] = sides;
            places.push(Place { map, wrap: which as u32 * 2, uv: [0.3, 0.8], dx: [a, b], dy: [c, d] });
        }
    }
    for filter in [Filter::Trilinear, Filter::Anisotropic, Filter::Ewa] {
        for (place, found) in places.iter().zip(run(filter, &maps, &places)) {
            let coarsest = maps[place.map].last().expect("has levels");
            let [r, g, b, a] = coarsest.texels[0];
            let expected = [r, g, b, (a * coarsest.alpha_scale).min(1.0)];
            for (found, expected) in found.iter().zip(expected) {
                assert!((f64::from(*found) - expected).abs() < 1e-6, "{filter:?}: {found} for {expected} at {place:?}");
            }
        }
    }
}
