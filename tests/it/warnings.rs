//! Inputs on which a method fails as it must, and the warning that says so: folds, long triangles, terraces, and
//! vectors without a frame. Through the command line and the reference device.

use std::io::Cursor;

use displace_server::oracle::invariants::not_finite;
use displace_tests::{
    glb, maps,
    meshes::{self, TestMesh},
    server::{displace, reference},
};
use image::{ImageBuffer, ImageFormat, Luma, Rgb};
use serde_json::Value;

/// The report of `apply` with these arguments; its result is finite.
fn applied(mesh: &TestMesh, map: Option<(&str, &[u8])>, args: &[&str]) -> Value {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
    let (input, output, map_path) = (path("in.glb"), path("out.glb"), path("map.png"));
    std::fs::write(&input, mesh.to_glb()).expect("the mesh can be written");
    let mut all = vec!["apply", &input, "-o", &output, "--json", "--server", reference()];
    if let Some((option, bytes)) = map {
        std::fs::write(&map_path, bytes).expect("the map can be written");
        all.extend([option, &map_path]);
    }
    all.extend(args);
    let report = displace(&all).expect_success().json();
    for part in glb::read(&std::fs::read(&output).expect("the result was written")) {
        assert_eq!(not_finite("positions_finite", &part.positions), None, "{}", mesh.name);
        assert_eq!(not_finite("normals_finite", &part.normals), None, "{}", mesh.name);
    }
    report
}

fn warning<'a>(report: &'a Value, code: &str) -> Option<&'a str> {
    let warnings = report["warnings"].as_array().expect("a list");
    warnings.iter().find(|warning| warning["code"] == code).and_then(|warning| warning["message"].as_str())
}

#[test]
fn a_concave_wall_folds_over_once_it_is_moved_beyond_its_axis() {
    let tube = meshes::concave_cylinder(24, 4);
    let flipped = [0.5, 0.9, 1.1, 1.3, 1.5].map(|height: f64| {
        let expression = format!("{height}*sin(pi*v)^2");
        let report = applied(&tube, None, &["--expr", &expression, "--uniform", "3"]);
        let flipped = report["flipped"].as_u64().expect("it is counted");
        let told = warning(&report, "foldover");
        assert_eq!(told.is_some(), flipped > 0, "{height}: {told:?}");
        if let Some(message) = told {
            assert!(message.starts_with(&format!("{flipped} of {} triangles", report["triangles"])), "{message}");
            assert!(message.contains("near (") && message.contains("lower the scale"), "{message}");
        }
        flipped
    });
    assert_eq!(flipped[..2], [0, 0]);
    assert!(flipped[1..].is_sorted_by(|a, b| a < b), "{flipped:?}");
}

#[test]
fn stretch_is_one_on_what_is_only_moved_and_told_where_it_is_long() {
    let plane = meshes::plane(4);
    let moved = applied(&plane, None, &["--expr", "0.5", "--uniform", "4"]);
    assert!((moved["stretch"]["max"].as_f64().unwrap() - 1.0).abs() < 1e-4, "{}", moved["stretch"]);
    assert_eq!(warning(&moved, "stretch"), None);
    // A slope of 10 on a fifth of the plane.
    let slope = applied(&plane, None, &["--expr", "10*max(0.2-u, 0)", "--uniform", "5"]);
    let stretch = |key: &str| slope["stretch"][key].as_f64().unwrap();
    let secant = 101f64.sqrt();
    assert!((stretch("max") - secant).abs() < 1e-2, "{}", slope["stretch"]);
    assert!(stretch("p99") <= stretch("max") && stretch("p99") > 0.99 * secant, "{}", slope["stretch"]);
    let message = warning(&slope, "stretch").expect("it is long");
    assert!(message.contains("10.0 times on base triangle") && message.contains("lower the scale"), "{message}");
}

#[test]
fn what_a_view_sees_too_near_to_keep_its_pixels_there_is_told() {
    let plane = meshes::plane(4);
    let told = |eye: &str| {
        let view = format!("{eye};0,0,0;60;64x64");
        let args = ["--expr", "0.02", "--tolerance-px", "2", "--view", &view];
        warning(&applied(&plane, None, &args), "view_too_near").map(ToOwned::to_owned)
    };
    // The plane becomes y = 0.02; its diagonal is the root of 2.
    let message = told("0.3,0.0205,0.3").expect("half a thousandth above it");
    for part in ["nearer to a view than 1.414e-3", "2 pixels", "move the view away"] {
        assert!(message.contains(part), "{part}: {message}");
    }
    assert_eq!(told("0.3,1.5,0.3"), None);
}

fn png(image: &image::DynamicImage) -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    image.write_to(&mut bytes, ImageFormat::Png).expect("a PNG can be written to memory");
    bytes.into_inner()
}

#[test]
fn an_8_bit_ramp_shows_terraces_and_a_16_bit_one_does_not() {
    let plane = meshes::plane(4);
    let eight = png(&ImageBuffer::from_fn(256, 256, |x, _| Luma([x as u8])).into());
    let sixteen = maps::png16(256, 256, |x, _| (257 * x) as u16);
    let told = |map: &[u8], scale: &str| {
        let report = applied(&plane, Some(("--height", map)), &["--scale", scale, "--uniform", "2"]);
        warning(&report, "terracing_8bit").map(ToOwned::to_owned)
    };
    let message = told(&eight, "0.1").expect("steps of 0.1 / 255 on texels of 1 / 256 have a slope of 0.1");
    assert!(message.contains("a slope of 0.10") && message.contains("16 bits"), "{message}");
    assert_eq!(told(&sixteen, "0.1"), None);
    assert_eq!(told(&eight, "0.01"), None, "a slope of 0.01 is not seen");
}

fn vectors() -> Vec<u8> {
    let value = |x: u32, y: u32, channel: u32| (maps::hash(x, y, channel) >> 16) as u16;
    png(&ImageBuffer::from_fn(32, 32, |x, y| Rgb([value(x, y, 1), value(x, y, 2), value(x, y, 3)])).into())
}

#[test]
fn vectors_without_a_frame_are_told_and_give_no_nan() {
    let mut flat = meshes::icosphere(1);
    flat.uvs.iter_mut().for_each(|uv| *uv = [0.25, 0.75]);
    let mut pole = meshes::uv_sphere(12, 6);
    // Without height in v, the triangles round the first pole have no UV area.
    pole.uvs.iter_mut().for_each(|uv| uv[1] = uv[1].max(1.0 / 6.0));
    for (mesh, invented) in
        [(flat, 80), (pole, 12), (meshes::uv_sphere(12, 6), 0), (meshes::mirrored_uv_sphere(12, 6), 0)]
    {
        let report = applied(&mesh, Some(("--vector", &vectors())), &["--scale", "0.1", "--uniform", "2"]);
        let told = warning(&report, "degenerate_tangents");
        assert_eq!(told.is_some(), invented > 0, "{}: {told:?}", mesh.name);
        assert!(told.is_none_or(|message| message.starts_with(&format!("{invented} of "))), "{told:?}");
    }
    // Heights need no frame.
    let mut flat = meshes::icosphere(1);
    flat.uvs.iter_mut().for_each(|uv| *uv = [0.25, 0.75]);
    let report = applied(&flat, Some(("--height", &maps::noise16(32, 1))), &["--scale", "0.1", "--uniform", "2"]);
    assert_eq!(warning(&report, "degenerate_tangents"), None);
}
