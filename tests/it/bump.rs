//! Bump and normal maps through the command line: what flags mean, what of it results hold, what is refused.

use std::{io::Cursor, path::Path};

use displace_tests::{
    cli::Run,
    meshes,
    server::{displace, reference},
};
use exr::prelude::{FlatSamples, ReadChannels as _, ReadLayers as _, read};
use glam::DVec3;
use image::{DynamicImage, ImageBuffer, ImageFormat, Luma, Rgb};
use serde_json::json;

const VIEW: &str = "--size 48x48 --eye 0.1,1.6,0.2 --look-at 0,0,0";

fn write(path: &Path, image: impl Into<DynamicImage>) {
    let mut bytes = Cursor::new(Vec::new());
    image.into().write_to(&mut bytes, ImageFormat::Png).expect("a PNG can be written to memory");
    std::fs::write(path, bytes.into_inner()).expect("it can be written");
}

/// A normal map that is smooth and whose red and green differ.
fn waves(x: u32, y: u32) -> [u8; 3] {
    let wave = |i: u32, k: f64| 0.4 * (std::f64::consts::TAU * k * (f64::from(i) + 0.5) / 64.0).sin();
    let n = DVec3::new(wave(x, 2.0), wave(y, 3.0), 1.0).normalize();
    n.to_array().map(|c| (127.5 + 127.5 * c).round() as u8)
}

/// A plane and a ball with a normal map each, maps in several ways of writing, in a folder.
struct Bench(tempfile::TempDir);

impl Bench {
    fn new() -> Self {
        let bench = Self(tempfile::tempdir().expect("a temporary folder"));
        let plain = json!({ "name": "surface", "doubleSided": true });
        let file = |name: &str, bytes: Vec<u8>| std::fs::write(bench.path(name), bytes).expect("written");
        file("plane.glb", meshes::plane(2).to_glb_with_material(&plain));
        file("ball.glb", meshes::uv_sphere(24, 12).to_glb_with_material(&plain));
        file("mirrored.glb", meshes::mirrored_uv_sphere(24, 12).to_glb_with_material(&plain));
        let map = |name: &str, texel: &dyn Fn(u32, u32) -> [u8; 3]| {
            write(bench.path(name).as_ref(), ImageBuffer::from_fn(64, 64, |x, y| Rgb(texel(x, y))));
        };
        map("waves.png", &waves);
        map("down.png", &|x, y| {
            let [r, g, b] = waves(x, y);
            [r, 255 - g, b]
        });
        map("turned.png", &|x, y| waves(x, 63 - y));
        map("swapped.png", &|x, y| {
            let [r, g, b] = waves(x, y);
            [g, r, b]
        });
        map("flat.png", &|_, _| [128, 128, 255]);
        map("slanted.png", &|_, _| [230, 128, 204]);
        let height = |x: u32| (32768.0 + 20000.0 * (std::f64::consts::TAU * (f64::from(x) + 0.5) / 64.0).sin()) as u16;
        write(bench.path("height.png").as_ref(), ImageBuffer::from_fn(64, 64, |x, _| Luma([height(x)])));
        bench
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_string_lossy().into_owned()
    }

    /// Words with an ending are files in the folder.
    fn run(&self, command: &str) -> Run {
        let is_file = |word: &str| [".glb", ".png", ".exr"].iter().any(|ending| word.ends_with(ending));
        let word = |word: &str| if is_file(word) { self.path(word) } else { word.to_owned() };
        let mut words: Vec<String> = command.split_whitespace().map(word).collect();
        words.extend(["--json", "--server", reference()].map(str::to_owned));
        displace(&words)
    }

    fn render(&self, what: &str) -> Vec<u8> {
        self.run(&format!("render {what} {VIEW} -o out.png")).expect_success();
        image::open(self.path("out.png")).expect("an image").into_rgb8().into_raw()
    }

    /// Normals and places of what is seen.
    fn normals(&self, what: &str) -> Vec<(DVec3, DVec3)> {
        self.run(&format!("render {what} {VIEW} --aov normal,position -o out.exr")).expect_success();
        let file = read().no_deep_data().largest_resolution_level().all_channels().first_valid_layer().all_attributes();
        let image = file.from_file(self.path("out.exr")).expect("an EXR");
        let channel = |name: String| {
            let found = image.layer_data.channel_data.list.iter().find(|c| c.name == *name.as_str());
            match &found.unwrap_or_else(|| panic!("no {name}")).sample_data {
                FlatSamples::F32(values) => values.clone(),
                _ => panic!("{name} is not f32"),
            }
        };
        let vectors = |layer: &str| {
            let [x, y, z] = ["X", "Y", "Z"].map(|axis| channel(format!("{layer}.{axis}")));
            (0..x.len()).map(move |i| DVec3::new(x[i].into(), y[i].into(), z[i].into())).collect::<Vec<_>>()
        };
        let pairs = vectors("normal").into_iter().zip(vectors("position"));
        let seen: Vec<_> = pairs.filter(|(normal, _)| *normal != DVec3::ZERO).collect();
        assert!(seen.len() > 300, "{} pixels see something", seen.len());
        seen
    }
}

fn most(a: &[u8], b: &[u8]) -> u8 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| a.abs_diff(*b)).max().unwrap_or(0)
}

fn degrees(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}

#[test]
fn ways_of_writing_a_normal_map_show_the_same() {
    let bench = Bench::new();
    let plain = bench.render("ball.glb --normal waves.png");
    for other in ["down.png --flip-green", "turned.png --flip-v", "swapped.png --swizzle grb"] {
        assert!(most(&plain, &bench.render(&format!("ball.glb --normal {other}"))) <= 1, "{other}");
    }
    assert!(most(&plain, &bench.render("ball.glb --normal down.png")) > 20, "green the wrong way round shows");
    assert!(most(&plain, &bench.render("ball.glb --method flat")) > 20, "the map shows");
}

/// Red along T and green along S, where UVs are not mirrored.
#[test]
fn cyslice_is_the_swizzle_grb_until_uvs_are_mirrored() {
    let bench = Bench::new();
    let [printed, right] = ["--preset cyslice", "--swizzle grb"].map(|how| {
        ["plane.glb", "mirrored.glb"].map(|mesh| bench.normals(&format!("{mesh} --normal waves.png {how}")))
    });
    let mean = |mesh: usize| {
        let pairs = printed[mesh].iter().zip(&right[mesh]);
        pairs.map(|(a, b)| degrees(a.0, b.0)).sum::<f64>() / printed[mesh].len() as f64
    };
    assert!(mean(0) < 0.01, "{} degrees on a plane", mean(0));
    assert!(mean(1) > 5.0, "{} degrees where half of the UVs are mirrored", mean(1));
}

#[test]
fn an_exact_zero_leaves_flat_maps_flat() {
    let bench = Bench::new();
    let tilt = |how: &str| {
        let normals = bench.normals(&format!("plane.glb --normal flat.png {how}"));
        normals.iter().map(|(normal, _)| degrees(*normal, DVec3::Y)).fold(0.0, f64::max)
    };
    let (gltf, exact) = (tilt(""), tilt("--exact-zero"));
    assert!((0.30..0.33).contains(&gltf), "2 c - 1 of 128 tilts by {gltf} degrees");
    // 16 bits of 2 c - 1, which the result holds, have no zero either.
    assert!(exact < 0.002, "{exact} degrees");
}

/// Vertices are displaced; the normals seen are those of the plane bent by the map, not of the displaced plane.
#[test]
fn a_normal_map_beside_heights_replaces_their_slopes() {
    let bench = Bench::new();
    let heights = "--height height.png --scale 0.2 --uniform 4";
    let bent = bench.normals(&format!("plane.glb {heights} --normal slanted.png"));
    // Of the plane, red leans along x and green along -z.
    let m = [230.0, 128.0, 204.0].map(|c| 2.0 * c / 255.0 - 1.0);
    let expected = DVec3::new(m[0], m[2], -m[1]);
    let apart = bent.iter().map(|(normal, _)| degrees(*normal, expected)).fold(0.0, f64::max);
    assert!(apart < 0.01, "{apart} degrees");
    let height = |f: fn(f64, f64) -> f64, start: f64| bent.iter().map(|(_, place)| place.y).fold(start, f);
    assert!(height(f64::max, 0.0) - height(f64::min, 1.0) > 0.08, "vertices are displaced");
    let displaced = bench.normals(&format!("plane.glb {heights}"));
    let steepest = displaced.iter().map(|(normal, _)| degrees(*normal, DVec3::Y)).fold(0.0, f64::max);
    assert!(steepest > 15.0, "without the map the slopes show: {steepest} degrees");
}

/// What is within a tolerance has vertices of its own; the base's normals are found there as well.
#[test]
fn a_normal_map_beside_heights_within_a_tolerance_does_too() {
    let bench = Bench::new();
    let bent =
        bench.normals("plane.glb --height height.png --scale 0.2 --tolerance 1e-3 --normal flat.png --exact-zero");
    let apart = bent.iter().map(|(normal, _)| degrees(*normal, DVec3::Y)).fold(0.0, f64::max);
    assert!(apart < 0.01, "{apart} degrees");
}

#[test]
fn bump_bends_as_displacement_does_and_normal_leaves_heights_out() {
    let bench = Bench::new();
    let heights = "--height height.png --scale 0.05";
    let bump = bench.normals(&format!("plane.glb {heights} --method bump --filter bilinear"));
    let slope = |x: f64| {
        let turn = std::f64::consts::TAU * (x + 0.5);
        0.05 * 20000.0 / 65535.0 * std::f64::consts::TAU * turn.cos()
    };
    let apart = |(normal, place): &(DVec3, DVec3)| degrees(*normal, DVec3::new(-slope(place.x), 1.0, 0.0));
    let most_apart = bump.iter().map(apart).fold(0.0, f64::max);
    // Central differences and blending of 64 texels a period take (tau / 64)^2 (1/6 + 1/8) of the slope.
    assert!(most_apart < 0.03, "{most_apart} degrees from the slopes of the heights");
    assert!(bump.iter().all(|(_, place)| place.y.abs() < 1e-6), "nothing moves");
    let beside = bench.render(&format!("plane.glb {heights} --normal waves.png --method normal"));
    assert_eq!(beside, bench.render("plane.glb --normal waves.png"));
    let both = bench.normals(&format!("plane.glb {heights} --normal slanted.png --method bump --filter bilinear"));
    let m = [230.0, 128.0, 204.0].map(|c| 2.0 * c / 255.0 - 1.0);
    let sum = |place: DVec3| DVec3::new(m[0] / m[2] - slope(place.x), 1.0, -m[1] / m[2]);
    let apart = both.iter().map(|(normal, place)| degrees(*normal, sum(*place))).fold(0.0, f64::max);
    assert!(apart < 0.03, "bump adds both: {apart} degrees");
}

#[test]
fn rays_see_the_same_bent_normals() {
    let bench = Bench::new();
    let what = "ball.glb --normal waves.png --normal slanted.png --space object --scale 0.3 --expr 0.02*sin(20*x) --method bump --filter bilinear";
    let rastered = bench.normals(what);
    let traced = bench.normals(&format!("{what} --supersample 1"));
    let near = |(normal, place): &&(DVec3, DVec3)| {
        traced.iter().any(|(n, p)| (*p - *place).length() < 0.01 && degrees(*n, *normal) < 1.0)
    };
    let agreeing = rastered.iter().filter(near).count();
    assert!(agreeing * 100 > 95 * rastered.len(), "{agreeing} of {}", rastered.len());
}

#[test]
fn a_result_holds_the_normal_map_and_shows_what_the_request_did() {
    let bench = Bench::new();
    for (map, kept) in [("waves.png --scale 0.5 --wrap clamp", true), ("down.png --flip-green", false)] {
        bench.run(&format!("apply ball.glb --normal {map} --uniform 0 -o out.glb")).expect_success();
        let bytes = std::fs::read(bench.path("out.glb")).expect("the result was written");
        let file = gltf::Gltf::from_slice(&bytes).expect("the result is a GLB");
        let used = file.materials().next().and_then(|m| m.normal_texture()).expect("a normal map");
        let gltf::image::Source::View { view, .. } = used.texture().source().source() else { panic!("a URI") };
        let blob = file.blob.as_deref().expect("a GLB has bytes");
        let image = &blob[view.offset()..view.offset() + view.length()];
        let given = std::fs::read(bench.path("waves.png")).expect("it is there");
        assert_eq!(image == given, kept, "{map}: the file's bytes where glTF reads them so");
        if kept {
            assert_eq!(used.scale(), 0.5);
            assert_eq!(used.texture().sampler().wrap_s(), gltf::texture::WrappingMode::ClampToEdge);
        }
        let asked = bench.render(&format!("ball.glb --normal {map}"));
        assert!(most(&asked, &bench.render("out.glb")) <= 1, "{map}");
    }
}

#[test]
fn what_files_cannot_hold_is_refused_by_name() {
    let bench = Bench::new();
    for (flags, parts) in [
        ("--height height.png --method bump", ["bump", "choose displacement"]),
        ("--normal waves.png --space object", ["object space", "bake"]),
        ("--normal waves.png --preset cyslice", ["CySlice", "--swizzle grb"]),
        ("--normal waves.png --normal down.png", ["second normal map", "merge"]),
    ] {
        let run = bench.run(&format!("apply ball.glb {flags} --uniform 0 -o out.glb"));
        assert_eq!(run.code, Some(2), "{flags}: {run:?}");
        for part in parts {
            assert!(run.stderr.contains(part), "{flags}, {part}: {}", run.stderr);
        }
    }
}

#[test]
fn contradictions_are_refused_with_what_to_do() {
    let bench = Bench::new();
    for (command, part) in [
        ("render plane.glb --height height.png --method normal", "has no normal map"),
        ("render plane.glb --method bump", "anything that bends normals"),
        ("render plane.glb --vector waves.png --method bump", "choose method vector"),
        ("render plane.glb --normal waves.png --uv-set 1", "TEXCOORD_1"),
        ("render plane.glb --normal height.png", "red, green and blue"),
        ("apply plane.glb --height height.png --normal waves.png --normals map", "leave one of them out"),
        ("measure plane.glb plane.glb --normal waves.png", "moves nothing"),
    ] {
        let run = bench.run(&format!("{command} {}", if command.starts_with("measure") { "" } else { "-o out.png" }));
        assert_eq!(run.code, Some(2), "{command}: {run:?}");
        assert!(run.stderr.contains(part), "{command}: {}", run.stderr);
    }
}
