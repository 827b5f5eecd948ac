//! Passes of physically based light and of environments against their f64 twins.

use displace_glsl::{
    SHADERS,
    layout::{
        light::{LOBE_SAMPLES, ShadePbrParams, Surroundings, SurroundingsParams, TABLE_SIDE},
        raster::{Appearance, LIGHT_POINT, LIGHT_SUN, Light, NORMALS_OF_PIXELS, ShadePhongParams, SurfacePoint},
    },
    reference::{
        appearance::Appearance as Seen,
        brdf_table::Table,
        environment::Environment as Twin,
        moments::Spread,
        shade_pbr::{Lighting, Place, radiance},
        shade_phong::from_surroundings,
        surroundings::{Around, Change, Surroundings as Sky, mirrored_footprint, seen},
    },
};
use displace_server::{
    domain::environment::Environment,
    render::image::environment::{EnvironmentStreams, record_table, table},
    vulkan::Stream,
};
use glam::{DVec3, DVec4};
use rand::{RngExt as _, SeedableRng, rngs::StdRng};

use super::{device, passes::run};

fn wide(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

fn stream<T: bytemuck::Pod>(name: &str, elements: &[T]) -> Stream {
    Stream::from_slice(device(), name, elements).expect("fits")
}

fn empty(name: &str, element_bytes: u32) -> Stream {
    Stream::new(device(), name, element_bytes, 0).expect("fits")
}

fn made_table() -> Stream {
    let table = table(device(), true).expect("fits");
    run(|recorder| record_table(recorder, &table).expect("records"));
    table
}

#[test]
fn the_table_of_albedo_is_that_of_the_twin() {
    let (found, expected) = (made_table().read::<[f32; 3]>().expect("reads"), Table::new());
    let rows = expected.cells.iter().chain(&expected.averages);
    assert_eq!(found.len(), (TABLE_SIDE * TABLE_SIDE + TABLE_SIDE) as usize);
    let off =
        |(found, expected): (&[f32; 3], &[f64; 3])| (wide(*found) - DVec3::from_array(*expected)).abs().max_element();
    let worst = found.iter().zip(rows).map(off).fold(0.0, f64::max);
    // Means of 1024 terms of a few roundings each; where lobes are 1/1024 wide a rounding of a cosine counts a thousandfold.
    assert!(worst < 1e-4, "{worst}");
}

/// Unrelated texels, some far brighter than others.
fn map(width: u32, height: u32) -> Environment {
    let mut random = StdRng::seed_from_u64(7);
    let texel = |_| [0; 3].map(|_| random.random_range(0.0f32..2.0).powi(4));
    Environment { width, height, texels: (0..width * height).map(texel).collect() }
}

fn lit_by(environment: &Environment) -> (EnvironmentStreams, Twin) {
    let streams = EnvironmentStreams::upload(device(), environment).expect("fits");
    run(|recorder| streams.record(recorder).expect("records"));
    (streams, Twin::new(environment.width as usize, &environment.texels))
}

#[test]
fn levels_of_an_environment_are_those_of_the_twin() {
    // Odd sizes too: a pole then faces the middle between two texels.
    for (width, height) in [(32, 16), (13, 7)] {
        let (streams, twin) = lit_by(&map(width, height));
        let levels: Vec<[u32; 4]> = streams.levels.read().expect("reads");
        let texels: Vec<[f32; 4]> = streams.texels.read().expect("reads");
        let expected: Vec<_> = twin.mips.iter().chain([&twin.irradiance]).collect();
        assert_eq!((levels.len(), streams.mips as usize), (expected.len(), twin.mips.len()));
        for ([first, level_width, ..], expected) in levels.iter().zip(expected) {
            assert_eq!(*level_width as usize, expected.width);
            let found = &texels[*first as usize..][..expected.texels.len()];
            for (found, expected) in found.iter().zip(&expected.texels) {
                let off = (0..3).map(|k| (f64::from(found[k]) - expected[k]).abs()).fold(0.0, f64::max);
                // Means of nine values of up to 16, level by level.
                assert!(off < 16.0 * 2e-6, "{width} x {height}, {level_width} wide: {found:?} for {expected:?}");
            }
        }
    }
}

/// A triangle in the world as it is, and fragments anywhere on it.
struct Scene {
    positions: [[f32; 3]; 3],
    normals: [[f32; 3]; 3],
    rows: Vec<[f32; 4]>,
    points: Vec<SurfacePoint>,
    appearances: Vec<Appearance>,
    eye: [f32; 4],
}

impl Scene {
    fn new(count: usize) -> Self {
        let mut random = StdRng::seed_from_u64(3);
        let mut rows = vec![[0f32; 4]; 10];
        for k in 0..3 {
            rows[4 + k][k] = 1.0;
            rows[7 + k][k] = 1.0;
        }
        let normals = [[0.3, 0.2, 1.0], [-0.4, 0.1, 1.2], [0.1, -0.5, 0.9]];
        let positions = [[-1.0, -1.0, 0.0], [2.0, -1.0, 0.3], [0.0, 1.5, -0.2]];
        let mut scene =
            Self { positions, normals, rows, points: vec![], appearances: vec![], eye: [0.4, -0.3, 2.0, 1.0] };
        for _ in 0..count {
            let point = scene.point(&mut random);
            let mut share = || random.random_range(0.0f32..1.0);
            let bent = wide(point.normal) + 0.8 * (wide([share(), share(), share()]) - 0.5);
            scene.appearances.push(Appearance {
                base: [share(), share(), share(), share()],
                emissive: [share(); 3],
                metallic: share().round(),
                normal: bent.normalize().as_vec3().to_array(),
                roughness: share(),
                occlusion: share(),
                flags: 0,
            });
            scene.points.push(point);
        }
        scene
    }

    fn point(&self, random: &mut StdRng) -> SurfacePoint {
        let mut share = || random.random_range(0.1f32..1.0);
        let weights = DVec3::new(share().into(), share().into(), share().into());
        let weights = weights / weights.element_sum();
        let mut change = || random.random_range(-0.01f32..0.01);
        let [dx, dy] = [0; 2].map(|_| [change(), change(), change()]);
        SurfacePoint {
            vertices: [0, 1, 2],
            at: weights.as_vec3().to_array(),
            at_dx: dx,
            at_dy: dy,
            position: Self::blend(&self.positions, weights).as_vec3().to_array(),
            normal: Self::blend(&self.normals, weights).normalize().as_vec3().to_array(),
            facing: [0.0, 0.0, 1.0],
            flip: 1.0,
            ..SurfacePoint::default()
        }
    }

    fn blend(corners: &[[f32; 3]; 3], weights: DVec3) -> DVec3 {
        (0..3).map(|k| wide(corners[k]) * weights[k]).sum()
    }

    fn footprint(&self, point: &SurfacePoint, normal: DVec3) -> f64 {
        let across = Self::blend(&self.normals, wide(point.at));
        let (length, n) = (across.length(), wide(point.normal));
        let turned = |at: [f32; 3]| {
            let change = Self::blend(&self.normals, wide(at)) / length;
            change - change.dot(n) * n
        };
        let change = Change {
            normal: [turned(point.at_dx), turned(point.at_dy)],
            position: [point.at_dx, point.at_dy].map(|at| Self::blend(&self.positions, wide(at))),
        };
        mirrored_footprint(&change, normal, wide(point.position), self.eye())
    }

    fn eye(&self) -> DVec4 {
        DVec4::from_array(self.eye.map(f64::from))
    }

    /// What the device sees of an environment; mirrors without samples.
    fn surroundings(&self, environment: &EnvironmentStreams, samples: u32) -> Vec<Surroundings> {
        let count = self.points.len() as u32;
        let found =
            Stream::new(device(), "surroundings", size_of::<Surroundings>() as u32, count.into()).expect("fits");
        let bound = [
            ("points", &stream("points", &self.points)),
            ("appearances", &stream("appearances", &self.appearances)),
            ("positions", &stream("positions", &self.positions)),
            ("normals", &stream("normals", &self.normals)),
            ("instance_rows", &stream("rows", &self.rows)),
            ("environment_levels", &environment.levels),
            ("environment_texels", &environment.texels),
            ("surroundings", &found),
        ];
        let params = SurroundingsParams {
            count,
            normals: NORMALS_OF_PIXELS,
            mips: environment.mips,
            samples,
            eye: self.eye,
            ..Default::default()
        };
        run(|recorder| recorder.dispatch(&SHADERS.surroundings, count.into(), &params, &bound).expect("records"));
        found.read().expect("reads")
    }
}

#[test]
fn what_fragments_see_of_an_environment_is_what_the_twin_sees() {
    let (scene, (streams, twin)) = (Scene::new(300), lit_by(&map(64, 32)));
    for samples in [LOBE_SAMPLES, 0] {
        let found = scene.surroundings(&streams, samples);
        for ((found, point), look) in found.iter().zip(&scene.points).zip(&scene.appearances) {
            let (position, normal) = (wide(point.position), wide(look.normal));
            let footprint = scene.footprint(point, normal);
            let roughness = (samples > 0).then_some(f64::from(look.roughness));
            let around = Around { environment: &twin, room: None };
            let expected = seen(around, position, normal, scene.eye(), roughness, footprint);
            let off = (wide(found.diffuse) - expected.diffuse).abs().max_element();
            assert!(off < 1e-4, "{found:?} for {expected:?}");
            for (found, expected) in [(found.facing, expected.facing), (found.grazing, expected.grazing)] {
                let off = (wide(found) - expected).abs().max_element();
                // 64 texels a turn, neighbours 16 apart, directions good to 1e-6; weights of grazing light to as much.
                assert!(off < 2.0 * 16.0 * 64.0 * 1e-6, "{found:?} for {expected:?}");
            }
        }
    }
}

fn twin_of(sky: &Surroundings) -> Sky {
    Sky { diffuse: wide(sky.diffuse), facing: wide(sky.facing), grazing: wide(sky.grazing) }
}

fn lights() -> Vec<Light> {
    let sun = Light { kind: LIGHT_SUN, direction: [0.6, 0.0, 0.8], color: [3.0, 2.5, 2.0], ..Light::default() };
    let lamp = Light { kind: LIGHT_POINT, position: [-1.0, 0.5, 1.5], color: [1.0, 4.0, 2.0], ..Light::default() };
    vec![sun, lamp]
}

#[test]
fn light_of_the_metallic_roughness_model_is_that_of_the_twin() {
    let (scene, table, lights) = (Scene::new(500), made_table(), lights());
    let (count, twin_table) = (scene.points.len(), Table::new());
    let sky: Vec<Surroundings> = (0..count)
        .map(|i| Surroundings {
            diffuse: [0.5, 0.1 * (i % 7) as f32, 1.0],
            facing: [0.2, 2.0, 0.3 * (i % 5) as f32],
            grazing: [0.3, 1.0, 0.2 * (i % 3) as f32],
        })
        .collect();
    let shadows: Vec<f32> = (0..count * 2).map(|i| (i % 3) as f32 / 2.0).collect();
    for multiple_scattering in [false, true] {
        let shaded = Stream::new(device(), "radiance", 16, count as u64).expect("fits");
        let bound = [
            ("points", &stream("points", &scene.points)),
            ("appearances", &stream("appearances", &scene.appearances)),
            ("lights", &stream("lights", &lights)),
            ("shadows", &stream("shadows", &shadows)),
            ("surroundings", &stream("surroundings", &sky)),
            ("brdf_table", &table),
            ("radiance", &shaded),
        ];
        let params = ShadePbrParams {
            count: count as u32,
            lights: 2,
            shadowed: 1,
            multiple_scattering: multiple_scattering.into(),
            eye: scene.eye,
            ambient: 0.25,
            has_environment: 1,
        };
        run(|recorder| recorder.dispatch(&SHADERS.shade_pbr, count as u64, &params, &bound).expect("records"));
        let found: Vec<[f32; 4]> = shaded.read().expect("reads");
        for (i, found) in found.iter().enumerate() {
            let (point, look) = (&scene.points[i], &scene.appearances[i]);
            let shares = [shadows[2 * i], shadows[2 * i + 1]].map(f64::from);
            let lighting =
                Lighting { table: &twin_table, lights: &lights, shares: &shares, ambient: 0.25, multiple_scattering };
            let place = Place {
                position: wide(point.position),
                normal: wide(point.normal),
                spread: Spread::default(),
                eye: scene.eye(),
                pixel: [0; 2],
            };
            let sky = twin_of(&sky[i]);
            let expected = radiance(&widened(look), &place, &lighting, &sky);
            let off = (DVec4::from_array(found.map(f64::from)) - expected).abs().max_element();
            // The table to 1e-4; lobes to a few units of f32 over alpha, at most 1024.
            assert!(off < 5e-4 * (1.0 + expected.max_element()), "{found:?} for {expected}: {look:?}");
        }
    }
}

fn widened(look: &Appearance) -> Seen {
    Seen {
        base: DVec4::from_array(look.base.map(f64::from)),
        emissive: wide(look.emissive),
        metallic: look.metallic.into(),
        normal: wide(look.normal),
        roughness: look.roughness.into(),
        occlusion: look.occlusion.into(),
        flags: look.flags,
    }
}

#[test]
fn phongs_model_adds_what_mirrors_show_of_an_environment() {
    let scene = Scene::new(100);
    let sky = Surroundings { diffuse: [0.5, 0.25, 1.0], facing: [2.0, 1.0, 0.0], grazing: [1.0; 3] };
    let count = scene.points.len();
    let shaded = Stream::new(device(), "radiance", 16, count as u64).expect("fits");
    let bound = [
        ("points", &stream("points", &scene.points)),
        ("appearances", &stream("appearances", &scene.appearances)),
        ("lights", &empty("lights", std::mem::size_of::<Light>() as u32)),
        ("shadows", &empty("shadows", 4)),
        ("positions", &stream("positions", &scene.positions)),
        ("normals", &stream("normals", &scene.normals)),
        ("instance_rows", &stream("rows", &scene.rows)),
        ("surroundings", &stream("surroundings", &vec![sky; count])),
        ("radiance", &shaded),
    ];
    let params = ShadePhongParams {
        count: count as u32,
        eye: scene.eye,
        reflectivity: 0.5,
        has_environment: 1,
        ..ShadePhongParams::default()
    };
    run(|recorder| recorder.dispatch(&SHADERS.shade_phong, count as u64, &params, &bound).expect("records"));
    let sky = twin_of(&sky);
    for (found, look) in shaded.read::<[f32; 4]>().expect("reads").iter().zip(&scene.appearances) {
        let look = widened(look);
        let expected = look.emissive + from_surroundings(&sky, look.base.truncate(), look.occlusion, 0.5);
        let off = (wide([found[0], found[1], found[2]]) - expected).abs().max_element();
        assert!(off < 1e-6, "{found:?} for {expected}");
    }
}
