//! Heights that are shown per pixel, through the command line: what flags mean, and what is refused.

use std::io::Cursor;

use displace_tests::{
    cli::Run,
    data::sample,
    meshes,
    server::{displace, reference, validated},
};
use image::{DynamicImage, ImageBuffer, ImageFormat, Luma};
use serde_json::json;

/// A plane and a ball, opaque and blended, and maps, in a folder.
struct Bench(tempfile::TempDir);

impl Bench {
    fn new() -> Self {
        let bench = Self(tempfile::tempdir().expect("a temporary folder"));
        let file = |name: &str, bytes: Vec<u8>| std::fs::write(bench.path(name), bytes).expect("written");
        let plain = json!({ "name": "surface" });
        file("plane.glb", meshes::plane(2).to_glb_with_material(&plain));
        file("ball.glb", meshes::uv_sphere(24, 12).to_glb_with_material(&plain));
        file("glass.glb", meshes::plane(1).to_glb_with_material(&json!({ "name": "glass", "alphaMode": "BLEND" })));
        let turn = |i: u32| std::f64::consts::TAU * (f64::from(i) + 0.5) / 64.0;
        let height = |x: u32, y: u32| (32768.0 + 15000.0 * turn(x).sin() + 9000.0 * (2.0 * turn(y)).cos()) as u16;
        let waves: DynamicImage = ImageBuffer::from_fn(64, 64, |x, y| Luma([height(x, y)])).into();
        let mut bytes = Cursor::new(Vec::new());
        waves.write_to(&mut bytes, ImageFormat::Png).expect("a PNG can be written to memory");
        file("waves.png", bytes.into_inner());
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
}

#[test]
fn what_a_march_has_no_use_for_is_refused_with_what_to_do() {
    let bench = Bench::new();
    let steep = "--height waves.png --scale 0.1 --method steep";
    for (mesh, flags, field, part) in [
        ("plane", "--method bump --height waves.png --steps 8", "lighting.relief.steps", "takes none"),
        ("plane", "--method flat --self-shadow hard", "lighting.relief.self_shadow", "flat strikes nothing"),
        ("plane", "--method flat --silhouettes shell", "lighting.relief.silhouettes", "take a method that finds depth"),
        ("plane", "--aov cost", "aovs[0]", "such a method"),
        ("plane", &format!("{steep} --tolerance 1e-3"), "surface.geometry.tolerance", "steep moves none"),
        ("plane", &format!("{steep} --exact"), "surface.geometry.exact", "--method displacement"),
        ("plane", &format!("{steep} --projection box"), "surface.look.projection", "--projection uv"),
        ("plane", &format!("{steep} --preimage 4,4"), "preimage", "leave it out"),
        ("plane", &format!("{steep} --silhouettes shell --base pn"), "surface.geometry.base", "--silhouettes quadric"),
        ("plane", &format!("{steep} --supersample 4"), "samples", "rays meet triangles"),
        ("glass", steep, "lighting.alpha", "'glass'"),
        ("plane", "--method steep", "details", "give a height map"),
        ("plane", "--method steep --expr u", "details[0].layers[0].expression", "draw it into one"),
        ("plane", "--method steep --vector waves.png", "details[0].layers[0].vector", "choose method vector"),
        ("plane", &format!("{steep} --height waves.png"), "details[0].layers[1].height", "merge them"),
        ("plane", &format!("{steep} --uv-set 1"), "details", "TEXCOORD_1"),
    ] {
        let run = bench.run(&format!("render {mesh}.glb {flags} --size 16x16 -o out.png"));
        assert_eq!(run.code, Some(2), "{flags}: {run:?}");
        assert_eq!(run.json()["error"]["field"], field, "{flags}: {}", run.stderr);
        assert!(run.stderr.contains(part), "{flags}: {}", run.stderr);
    }
}

#[test]
fn a_file_holds_no_heights_per_pixel() {
    let bench = Bench::new();
    for flags in ["--uniform 0 -o out.glb", "--uniform 0 --dry-run"] {
        let run = bench.run(&format!("apply plane.glb --height waves.png --method steep {flags}"));
        assert_eq!(run.code, Some(2), "{flags}: {run:?}");
        assert!(run.stderr.contains("choose displacement, or render it"), "{flags}: {}", run.stderr);
    }
}

/// Blended surfaces that are cut off or left to chance are solid where they are.
#[test]
fn what_is_blended_has_heights_once_it_is_cut_off() {
    let bench = Bench::new();
    for alpha in ["mask", "stochastic"] {
        let render =
            format!("render glass.glb --height waves.png --method steep --alpha {alpha} --size 16x16 -o out.png");
        bench.run(&render).expect_success();
    }
}

/// Where no edge of the plane is in sight; four triangles a texel at least, four samples a pixel as both have by default.
#[test]
fn exact_shows_what_displacement_does_within_a_mean_flip_of_two_hundredths() {
    let bench = Bench::new();
    let map = sample("maps/rock_height.png");
    let remote = |words: &[&str]| displace(&[words, &["--server", validated(), "--json"]].concat()).expect_success();
    for eye in ["0,0.9,0.5", "0,0.5,0.7", "0.3,0.45,0.8"] {
        let drawn = |geometry: [&str; 2]| {
            let (mesh, out) = (bench.path("plane.glb"), bench.path(&format!("{}.png", geometry[1])));
            let detail = ["--height", &map.to_string_lossy(), "--scale", "0.06", "--midlevel", "0.5"];
            let camera = ["--size", "192x192", "--eye", eye, "--look-at", "0,0,0", "--fov", "16"];
            remote(&[&["render", &mesh], &detail[..], &camera[..], &geometry[..], &["-o", &out]].concat());
            out
        };
        let [exact, fine] = [["--method", "exact"], ["--uniform", "9"]].map(drawn);
        let flip = remote(&["compare", &exact, &fine]).json()["flip_mean"].as_f64().expect("a number");
        assert!(flip < 0.02, "{eye}: {flip}");
        assert!(flip > 0.001, "{eye}: {flip}: the two are the same picture");
    }
}
