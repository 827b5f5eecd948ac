//! Images by rays through the command line: what the reference makes, what a device refuses, what a file says.

use std::collections::BTreeMap;

use displace_tests::{cli::Run, data::sample, device, server};
use exr::prelude::{AttributeValue, Text};

fn render(url: &str, output: &std::path::Path, flags: &[&str]) -> Run {
    let (mesh, output) = (sample("models/torus.gltf"), output.to_string_lossy());
    let args = ["render", &*mesh.to_string_lossy(), "--size", "48x32", "--orbit", "30,60", "--server", url];
    server::displace(&[&args[..], flags, &["--json", "-o", &*output]].concat())
}

fn attributes(path: &std::path::Path) -> BTreeMap<String, AttributeValue> {
    let meta = exr::meta::MetaData::read_from_file(path, true).expect("an EXR");
    let own = &meta.headers[0].own_attributes.other;
    own.iter().map(|(name, value)| (name.to_string(), value.clone())).collect()
}

#[test]
fn a_supersampled_image_says_how_it_was_taken() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.exr");
    let flags = ["--supersample", "16", "--shadows", "ray", "--light", "0,2,0", "--ambient", "0.25"];
    let report = render(server::reference(), &path, &flags).expect_success().json();
    assert_eq!(report["device"], "reference");
    let found = attributes(&path);
    let text = |text: &str| AttributeValue::Text(Text::from(text));
    let expected = [
        ("displace.samples", AttributeValue::I32(16)),
        ("displace.filter", text("box")),
        ("displace.shadows", text("ray")),
        ("displace.light_direction", AttributeValue::FloatVec3((0.0, 1.0, 0.0))),
        ("displace.ambient", AttributeValue::F32(0.25)),
        ("displace.device", text("reference")),
        ("displace.build", text(displace_server::BUILD_ID)),
        ("displace.residual_world", AttributeValue::F64(0.0)),
    ];
    for (name, value) in expected {
        assert_eq!(found.get(name), Some(&value), "{name}");
    }
}

#[test]
fn samples_and_shadows_make_images_of_their_own() {
    let folder = tempfile::tempdir().unwrap();
    let image = |name: &str, flags: &[&str]| {
        let path = folder.path().join(name);
        let report = render(server::reference(), &path, flags).expect_success().json();
        (std::fs::read(path).unwrap(), report["cached"].as_bool().unwrap())
    };
    let (own, _) = image("own.png", &[]);
    let (four, _) = image("four.png", &["--supersample", "4"]);
    let (more, _) = image("more.png", &["--supersample", "64"]);
    let (shadows, _) = image("shadows.png", &["--shadows", "ray"]);
    let (traced, _) = image("traced.png", &["--shadows", "ray", "--supersample", "64"]);
    assert!(own != four && four != more && own != shadows && more != traced && shadows != traced);
    // What is left open is filled in: the same request.
    assert_eq!(image("again.png", &["--shadows", "ray", "--shading", "phong"]), (shadows, true));
}

#[test]
fn a_device_that_does_not_trace_says_what_does() {
    if device::without_gpu("the refusal of rays") {
        return;
    }
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.png");
    let cases: [(&[&str], &str); 2] = [
        (&["--supersample", "5"], "4, 16, 64, 256 and 1024"),
        (&["--expr", "0.1*u", "--exact"], "surface.geometry.exact"),
    ];
    for (flags, field) in cases {
        let run = render(server::validated(), &path, flags);
        assert_ne!(run.code, Some(0), "{run:?}");
        let said = format!("{}{}", run.stdout, run.stderr);
        assert!(said.contains("--device reference") && said.contains(field), "{said}");
        assert!(!path.exists());
    }
}

#[test]
fn a_device_takes_samples_and_shadows() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("out.exr");
    render(server::validated(), &path, &["--supersample", "16", "--shadows", "ray"]).expect_success();
    let found = attributes(&path);
    assert_eq!(found.get("displace.samples"), Some(&AttributeValue::I32(16)));
    assert_eq!(found.get("displace.shadows"), Some(&AttributeValue::Text(Text::from("ray"))));
}

#[test]
fn samples_out_of_range_are_refused() {
    let folder = tempfile::tempdir().unwrap();
    for samples in ["0", "1025"] {
        let run = render(server::reference(), &folder.path().join("out.png"), &["--supersample", samples]);
        assert_eq!(run.code, Some(2), "{run:?}");
    }
}
