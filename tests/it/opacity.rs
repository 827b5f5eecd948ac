//! Alpha through the command line: what the file says, and opacity maps in images and in the result.

use std::{io::Cursor, path::Path};

use displace_tests::{
    cli::Run,
    meshes::{self, TestMesh},
    server::{displace, reference},
};
use image::{DynamicImage, ImageBuffer, ImageFormat, Luma, Rgb, Rgba};
use serde_json::{Value, json};

fn write(path: &Path, image: impl Into<DynamicImage>) {
    let mut bytes = Cursor::new(Vec::new());
    image.into().write_to(&mut bytes, ImageFormat::Png).expect("a PNG can be written to memory");
    std::fs::write(path, bytes.into_inner()).expect("it can be written");
}

fn opacity(x: u32, y: u32) -> u8 {
    (16 * x + 3 * y) as u8
}

fn color(x: u32, y: u32) -> [u8; 3] {
    [255 - 9 * x as u8, 13 * y as u8, 40]
}

/// A plane with a material, an opacity map of 16 x 16 and base colours of that size and another, in a folder.
struct Bench(tempfile::TempDir);

impl Bench {
    fn new(material: &Value) -> Self {
        let bench = Self(tempfile::tempdir().expect("a temporary folder"));
        std::fs::write(bench.path("in.glb"), meshes::plane(2).to_glb_with_material(material)).expect("written");
        write(bench.path("opacity.png").as_ref(), ImageBuffer::from_fn(16, 16, |x, y| Luma([opacity(x, y)])));
        write(bench.path("color.png").as_ref(), ImageBuffer::from_fn(16, 16, |x, y| Rgb(color(x, y))));
        write(bench.path("wide.png").as_ref(), ImageBuffer::from_fn(32, 16, |x, y| Rgb(color(x % 16, y))));
        bench
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_string_lossy().into_owned()
    }

    /// Words that end in .glb or .png are files in the folder.
    fn run(&self, command: &str) -> Run {
        let word = |word: &str| {
            if word.ends_with(".glb") || word.ends_with(".png") { self.path(word) } else { word.to_owned() }
        };
        let mut words: Vec<String> = command.split_whitespace().map(word).collect();
        words.extend(["--json", "--server", reference()].map(str::to_owned));
        displace(&words)
    }

    /// `out.glb`, and the base colour of its first material.
    fn result(&self) -> (gltf::Gltf, Vec<u8>) {
        let bytes = std::fs::read(self.path("out.glb")).expect("the result was written");
        let file = gltf::Gltf::from_slice(&bytes).expect("the result is a GLB");
        let material = file.materials().next().expect("a material");
        let used = material.pbr_metallic_roughness().base_color_texture().expect("a map");
        let gltf::image::Source::View { view, .. } = used.texture().source().source() else { panic!("a URI") };
        let blob = file.blob.as_deref().expect("a GLB has bytes");
        let png = &blob[view.offset()..view.offset() + view.length()];
        let pixels = image::load_from_memory(png).expect("a PNG").into_rgba8().into_raw();
        (file, pixels)
    }

    fn pixels(&self, name: &str) -> Vec<u8> {
        image::open(self.path(name)).expect("an image").into_rgba8().into_raw()
    }
}

const VIEW: &str = "--size 48x48 --orbit 20,60";

#[test]
fn an_opacity_map_is_the_alpha_of_the_result_and_of_images() {
    let bench =
        Bench::new(&json!({ "name": "sheet", "pbrMetallicRoughness": { "baseColorFactor": [1, 0.5, 1, 0.25] } }));
    bench
        .run("apply in.glb --opacity opacity.png --base-color color.png --method flat --uniform 0 -o out.glb")
        .expect_success();
    let (file, pixels) = bench.result();
    let material = file.materials().next().expect("a material");
    assert_eq!(material.alpha_mode(), gltf::material::AlphaMode::Blend);
    assert_eq!(material.pbr_metallic_roughness().base_color_factor(), [1.0, 0.5, 1.0, 1.0]);
    let texel = |i: u32| {
        let [r, g, b] = color(i % 16, i / 16);
        [r, g, b, opacity(i % 16, i / 16)]
    };
    assert_eq!(pixels, (0..256).flat_map(texel).collect::<Vec<u8>>());
    bench.run(&format!("render in.glb --opacity opacity.png --base-color color.png {VIEW} -o a.png")).expect_success();
    bench.run(&format!("render out.glb {VIEW} -o b.png")).expect_success();
    assert_eq!(bench.pixels("a.png"), bench.pixels("b.png"));
}

#[test]
fn materials_without_a_map_keep_their_colour_and_cut_offs_stay() {
    let bench = Bench::new(&json!({ "name": "leaf", "alphaMode": "MASK", "alphaCutoff": 0.25 }));
    bench.run("apply in.glb --opacity opacity.png --method flat --uniform 0 -o out.glb").expect_success();
    let (file, pixels) = bench.result();
    let material = file.materials().next().expect("a material");
    assert_eq!((material.alpha_mode(), material.alpha_cutoff()), (gltf::material::AlphaMode::Mask, Some(0.25)));
    let expected = ImageBuffer::from_fn(16, 16, |x, y| Rgba([255, 255, 255, opacity(x, y)]));
    assert_eq!(pixels, expected.into_raw());
}

#[test]
fn an_opacity_map_of_another_size_than_the_colour_is_refused_with_both() {
    let bench = Bench::new(&json!({ "name": "sheet" }));
    let run =
        bench.run("apply in.glb --opacity opacity.png --base-color wide.png --method flat --uniform 0 -o out.glb");
    assert_eq!(run.code, Some(2), "{run:?}");
    for part in ["16 x 16", "'sheet'", "32 x 16", "scale one"] {
        assert!(run.stderr.contains(part), "{part}: {}", run.stderr);
    }
}

#[test]
fn blended_materials_are_shown_as_asked() {
    let half = json!({ "name": "glass", "alphaMode": "BLEND", "doubleSided": true, "pbrMetallicRoughness": { "baseColorFactor": [1, 1, 1, 0.4] } });
    let bench = Bench::new(&half);
    let centre = |alpha: &str| {
        bench
            .run(&format!("render in.glb {VIEW} --ambient 0.5 --light 0,-1,0 --alpha {alpha} -o {alpha}.png"))
            .expect_success();
        bench.pixels(&format!("{alpha}.png"))[4 * (24 * 48 + 24)]
    };
    let (mask, blend) = (centre("mask"), centre("blend"));
    assert!(mask < 70, "alpha 0.4 is cut off: {mask}");
    assert!(mask < blend && blend < 220, "the background shows through: {blend}");
    let seen: std::collections::HashSet<u8> = {
        centre("stochastic");
        bench.pixels("stochastic.png").chunks(4).map(|pixel| pixel[0]).collect()
    };
    assert!(seen.len() >= 5, "0 to 4 of a pixel's samples see the surface: {seen:?}");
}

/// So many sheets, one above the other.
fn stack(sheets: u32) -> TestMesh {
    let mut mesh = meshes::plane(1);
    let sheet = mesh.clone();
    for k in 1..sheets {
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(sheet.positions.iter().map(|[x, y, z]| [*x, y + 0.01 * k as f32, *z]));
        mesh.normals.extend(&sheet.normals);
        mesh.uvs.extend(&sheet.uvs);
        mesh.triangles.extend(sheet.triangles.iter().map(|t| t.map(|v| v + first)));
    }
    mesh
}

#[test]
fn more_sheets_than_layers_are_told_and_chance_has_no_such_limit() {
    let glass = json!({ "name": "glass", "alphaMode": "BLEND", "doubleSided": true, "pbrMetallicRoughness": { "baseColorFactor": [1, 1, 1, 0.1] } });
    let bench = Bench::new(&glass);
    let warned = |sheets: u32, alpha: &str| {
        std::fs::write(bench.path("in.glb"), stack(sheets).to_glb_with_material(&glass)).expect("written");
        let report = bench.run(&format!("render in.glb {VIEW} --alpha {alpha} -o out.png")).expect_success().json();
        let warnings = report["warnings"].as_array().expect("a list").clone();
        warnings.iter().any(|warning| warning["code"] == "layers_left_out")
    };
    assert!(!warned(8, "blend") && warned(9, "blend") && !warned(9, "stochastic"));
}
