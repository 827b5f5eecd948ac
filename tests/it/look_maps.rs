//! Maps that a request puts in place of those of materials, through the command line: in images, in the result, and
//! projected onto meshes without texture coordinates.

use std::path::Path;

use displace_tests::{
    cli::Run,
    meshes,
    server::{displace, reference},
};
use image::{ImageBuffer, Rgb};
use serde_json::{Value, json};

/// A mesh with a material, an OBJ without texture coordinates, and a map of 16 x 16, in a folder.
struct Bench(tempfile::TempDir);

impl Bench {
    fn new(material: &Value) -> Self {
        let bench = Self(tempfile::tempdir().expect("a temporary folder"));
        std::fs::write(bench.path("in.glb"), meshes::plane(2).to_glb_with_material(material)).expect("written");
        let map = ImageBuffer::from_fn(16, 16, |x, y| Rgb([16 * x as u8, 255 - 12 * y as u8, 5 * (x + y) as u8]));
        map.save(bench.path("map.png")).expect("written");
        let bare = "v -.5 0 .5\nv .5 0 .5\nv .5 0 -.5\nv -.5 0 -.5\nf 1 2 3 4\n";
        std::fs::write(bench.path("bare.obj"), bare).expect("written");
        bench
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).to_string_lossy().into_owned()
    }

    /// Words that end in .glb, .obj, .exr or .png are files in the folder.
    fn run(&self, command: &str) -> Run {
        let is_file = |word: &str| [".glb", ".obj", ".exr", ".png"].iter().any(|end| word.ends_with(end));
        let word = |word: &str| if is_file(word) { self.path(word) } else { word.to_owned() };
        let mut words: Vec<String> = command.split_whitespace().map(word).collect();
        words.extend(["--json", "--server", reference()].map(str::to_owned));
        displace(&words)
    }

    fn pixels(&self, name: &str) -> Vec<u8> {
        image::open(self.path(name)).expect("an image").into_rgba8().into_raw()
    }
}

fn document(path: impl AsRef<Path>) -> Value {
    let bytes = std::fs::read(path).expect("the result was written");
    let length = u32::from_le_bytes(bytes[12..16].try_into().expect("four")) as usize;
    serde_json::from_slice(&bytes[20..20 + length]).expect("JSON")
}

const VIEW: &str = "--size 48x48 --orbit 20,60 --shading pbr";

#[test]
fn each_map_is_in_the_result_as_in_images() {
    let dull = json!({
        "name": "dull", "emissiveFactor": [0, 0, 0],
        "pbrMetallicRoughness": { "metallicFactor": 0, "roughnessFactor": 0.5 },
        "extensions": { "KHR_materials_emissive_strength": { "emissiveStrength": 2.0 } }
    });
    for (flag, texture) in [
        ("--metallic-roughness", "/pbrMetallicRoughness/metallicRoughnessTexture/index"),
        ("--occlusion", "/occlusionTexture/index"),
        ("--emissive", "/emissiveTexture/index"),
    ] {
        let bench = Bench::new(&dull);
        bench.run(&format!("apply in.glb {flag} map.png --method flat --uniform 0 -o out.glb")).expect_success();
        let document = document(bench.path("out.glb"));
        let index = document.pointer(&format!("/materials/0{texture}")).and_then(Value::as_u64).expect("a texture");
        let source = document["textures"][index as usize]["source"].as_u64().expect("an image");
        let view = document["images"][source as usize]["bufferView"].as_u64().expect("in the file");
        let bytes = document["bufferViews"][view as usize]["byteLength"].as_u64().expect("a length");
        assert_eq!(bytes, std::fs::metadata(bench.path("map.png")).expect("there").len());
        bench.run(&format!("render in.glb {flag} map.png {VIEW} -o a.png")).expect_success();
        bench.run(&format!("render out.glb {VIEW} -o b.png")).expect_success();
        bench.run(&format!("render in.glb {VIEW} -o c.png")).expect_success();
        assert_eq!(bench.pixels("a.png"), bench.pixels("b.png"), "{flag}");
        assert_ne!(bench.pixels("a.png"), bench.pixels("c.png"), "{flag} shows");
    }
}

#[test]
fn factors_of_zero_would_hide_a_map_and_become_one() {
    let dull = json!({ "name": "dull", "pbrMetallicRoughness": { "metallicFactor": 0, "roughnessFactor": 0.5 } });
    let bench = Bench::new(&dull);
    let all = "--metallic-roughness map.png --emissive map.png --occlusion map.png";
    bench.run(&format!("apply in.glb {all} --method flat --uniform 0 -o out.glb")).expect_success();
    let material = &document(bench.path("out.glb"))["materials"][0];
    assert_eq!(material["pbrMetallicRoughness"]["metallicFactor"], 1.0);
    assert_eq!(material["pbrMetallicRoughness"]["roughnessFactor"], 0.5);
    assert_eq!(material["emissiveFactor"], json!([1.0, 1.0, 1.0]));
    assert_eq!(material["occlusionTexture"].get("strength"), None);
}

#[test]
fn a_mesh_without_coordinates_shows_a_map_that_is_projected() {
    let bench = Bench::new(&json!({}));
    let refused = bench.run(&format!("render bare.obj --base-color map.png {VIEW} -o none.png"));
    assert_eq!(refused.code, Some(2), "{refused:?}");
    assert!(refused.stderr.contains("--projection"), "{}", refused.stderr);
    let above = "--size 32x32 --eye 0,3,0.001 --look-at 0,0,0 --fov 20 --ambient 1 --light 0,-1,0";
    bench.run(&format!("render bare.obj --base-color map.png --projection planar {above} -o a.png")).expect_success();
    bench.run(&format!("render in.glb --base-color map.png {above} -o b.png")).expect_success();
    let (a, b) = (bench.pixels("a.png"), bench.pixels("b.png"));
    let middle = |pixels: &[u8]| pixels[4 * (16 * 32 + 8)..][..4].to_vec();
    assert_ne!(middle(&a), middle(&a[4 * 8..]), "the map shows");
    // The plane's own coordinates are those of a projection from above.
    let far = a.iter().zip(&b).filter(|(a, b)| a.abs_diff(**b) > 3).count();
    // Rounding decides a row of pixels at the outline.
    assert!(far <= 3 * 32, "{far} values differ");
}

#[test]
fn a_result_takes_no_projection() {
    let bench = Bench::new(&json!({}));
    let run = bench.run("apply in.glb --base-color map.png --projection box --method flat --uniform 0 -o out.glb");
    assert_eq!(run.code, Some(2), "{run:?}");
    assert!(run.stderr.contains("projection"), "{}", run.stderr);
}

#[test]
fn a_pre_image_is_a_picture_beside_the_image() {
    let bench = Bench::new(&json!({}));
    let seen = format!("render in.glb --base-color map.png {VIEW}");
    for image in ["a.png", "a.exr"] {
        bench.run(&format!("{seen} --preimage 24,24 -o {image}")).expect_success();
        let picture = image::open(bench.path("a.preimage.png")).expect("beside the image").into_rgb8();
        assert!(picture.pixels().any(|pixel| pixel.0 == [255, 96, 0]), "the pixel is drawn");
        std::fs::remove_file(bench.path("a.preimage.png")).expect("there");
    }
    bench.run(&format!("{seen} -o b.png")).expect_success();
    assert_eq!(bench.pixels("a.png"), bench.pixels("b.png"));
    for (pixel, part) in [("48,0", "0,0 to 47,47"), ("0,0", "shows nothing")] {
        let run = bench.run(&format!("{seen} --preimage {pixel} -o c.png"));
        assert_eq!(run.code, Some(2), "{run:?}");
        assert!(run.stderr.contains(part), "{}", run.stderr);
    }
    let bare = bench.run(&format!("render in.glb {VIEW} --preimage 24,24 -o c.png"));
    assert!(bare.code == Some(2) && bare.stderr.contains("--base-color"), "{bare:?}");
}

#[test]
fn rays_count_nothing_of_the_rasteriser() {
    let bench = Bench::new(&json!({}));
    bench.run(&format!("render in.glb {VIEW} --aov overdraw,samples -o a.png")).expect_success();
    for name in ["a.overdraw.png", "a.samples.png"] {
        assert_eq!(image::open(bench.path(name)).expect("beside the image").width(), 48);
    }
    let run = bench.run(&format!("render in.glb {VIEW} --aov depth,overdraw --supersample 16 -o b.png"));
    assert_eq!(run.code, Some(2), "{run:?}");
    assert!(run.stderr.contains("aovs[1]"), "{}", run.stderr);
}

#[test]
fn shadows_by_rays_do_not_see_holes_that_are_projected() {
    let leaf = json!({ "name": "leaf", "alphaMode": "MASK" });
    let bench = Bench::new(&leaf);
    let seen = format!("render in.glb --base-color map.png {VIEW} --projection box --shadows ray");
    let run = bench.run(&format!("{seen} -o a.png"));
    assert_eq!(run.code, Some(2), "{run:?}");
    assert!(run.stderr.contains("shadows map or none"), "{}", run.stderr);
    bench.run(&format!("{seen} --supersample 4 -o a.png")).expect_success();
    let mapped = seen.replace("--shadows ray", "--shadows map");
    bench.run(&format!("{mapped} -o a.png")).expect_success();
}
