//! `measure` over the real command line: results against the surfaces they stand for, and refusals.

use displace_tests::{cli::Displace, meshes};
use serde_json::Value;

fn measured(displace: &Displace, args: &[&str]) -> Value {
    displace.run([&["measure"], args, &["--json"]].concat()).expect_success().json()
}

fn figure(found: &Value, path: &str) -> f64 {
    found.pointer(path).and_then(Value::as_f64).unwrap_or_else(|| panic!("{path} is missing in {found}"))
}

/// A plane as a GLB, its path as text.
fn plane(displace: &Displace) -> String {
    let path = displace.file("plane.glb", &meshes::plane(2).to_glb());
    path.to_str().unwrap().to_owned()
}

#[test]
fn a_finer_result_is_nearer_to_the_surface_and_the_interval_is_as_narrow_as_asked() {
    let displace = Displace::default();
    let mesh = plane(&displace);
    let detail = ["--expr", "0.1*sin(9*u)*cos(7*v)"];
    let mut last = f64::INFINITY;
    for level in ["1", "3", "5"] {
        let args = [&["apply", &mesh, "--uniform", level, "-o", "out.glb", "-q"][..], &detail].concat();
        displace.run(args).expect_success();
        let found = measured(&displace, &[&[mesh.as_str(), "out.glb", "--precision", "1e-4"][..], &detail].concat());
        let (lo, hi) = (figure(&found, "/hausdorff/lo"), figure(&found, "/hausdorff/hi"));
        assert!(lo <= hi && hi - lo <= 1e-4 * figure(&found, "/diagonal"), "{found}");
        assert!(hi < last && figure(&found, "/rms") <= hi, "{found}");
        assert_eq!(figure(&found, "/seam_gap"), 0.0);
        last = lo;
    }
    assert!(last < 2e-3, "{last}");
}

#[test]
fn two_meshes_are_measured_as_they_are_and_the_painted_one_can_be_read() {
    let displace = Displace::default();
    let mesh = plane(&displace);
    displace.run(["apply", &mesh, "--expr", "0*u+0.25", "--uniform", "2", "-o", "up.glb", "-q"]).expect_success();
    let found = measured(&displace, &[&mesh, "up.glb", "-o", "error.glb"]);
    let (lo, hi) = (figure(&found, "/hausdorff/lo"), figure(&found, "/hausdorff/hi"));
    assert!(lo <= 0.25 + 1e-7 && hi >= 0.25 - 1e-7 && hi - lo < 2e-4, "{found}");
    assert!(figure(&found, "/normal_deg/max") < 1e-3, "{found}");
    assert_eq!(found["b"]["triangles"], 8 * 16);
    assert_eq!(found["b"]["self_intersections"], 0);
    let painted = gltf::Gltf::open(displace.folder().join("error.glb")).unwrap();
    assert_eq!(painted.meshes().count(), 2);
    let has_colors = painted.meshes().all(|m| m.primitives().all(|p| p.get(&gltf::Semantic::Colors(0)).is_some()));
    assert!(has_colors);
}

#[test]
fn a_painted_mesh_shows_the_distance_between_its_vertices_too() {
    let displace = Displace::default();
    let (mesh, waves) = (plane(&displace), ["--expr", "0.1*sin(2*pi*u)"]);
    displace.run(["apply", &mesh, waves[0], waves[1], "--uniform", "1", "-o", "waves.glb", "-q"]).expect_success();
    let found = measured(&displace, &[&mesh, waves[0], waves[1], "waves.glb", "-o", "error.glb"]);
    let painted = gltf::Gltf::open(displace.folder().join("error.glb")).unwrap();
    let extras = painted.document.as_json().asset.extras.as_ref().expect("the range is told");
    let high = serde_json::from_str::<serde_json::Value>(extras.get()).unwrap()["distance"]["high"].as_f64().unwrap();
    let back = figure(&found, "/hausdorff/b_to_a/hi");
    // The vertices lie on the surface; the farthest place lies near the middle of a side.
    assert!(high > 0.8 * back && high <= back + 1e-7, "{high} of {back}");
}

#[test]
fn a_distance_that_rounding_blurs_is_called_an_estimate() {
    let displace = Displace::default();
    let mesh = plane(&displace);
    let warned = |expression: &str| {
        let found = measured(&displace, &[&mesh, &mesh, "--expr", expression]);
        found["warnings"].as_array().unwrap().iter().any(|w| w["code"] == "estimated_not_certified")
    };
    assert!(warned("0.1*((1e15+u)-1e15)"));
    assert!(!warned("0.1*u"));
}

#[test]
fn a_crack_is_told_by_its_width() {
    let displace = Displace::default();
    let closed = displace.file("closed.glb", &meshes::cube().to_glb());
    let mut open = meshes::cube();
    // One corner of one face is torn off: its vertex moves alone.
    open.positions[0][0] += 0.01;
    let open = displace.file("open.glb", &open.to_glb());
    let found = measured(&displace, &[closed.to_str().unwrap(), open.to_str().unwrap()]);
    let gap = figure(&found, "/seam_gap");
    assert!(gap > 1e-3 && gap <= 0.0101, "{gap}");
    assert!(found["b"]["boundary_edges"].as_u64().unwrap() > 0);
}

#[test]
fn what_cannot_be_measured_is_refused_by_name() {
    let displace = Displace::default();
    let mesh = plane(&displace);
    let junk = displace.file("junk.glb", b"glTF");
    for (args, words) in [
        (vec![mesh.as_str(), "missing.glb"], vec!["missing.glb"]),
        (vec![mesh.as_str(), junk.to_str().unwrap()], vec!["GLB"]),
        (vec![mesh.as_str(), mesh.as_str(), "--precision", "0"], vec!["--precision", "1e-7 to 1"]),
        (vec![mesh.as_str(), mesh.as_str(), "-o", "error.png"], vec!["--output", ".glb"]),
        (vec![mesh.as_str(), mesh.as_str(), "--height", "none.png"], vec!["--height", "none.png"]),
        (
            vec![mesh.as_str(), mesh.as_str(), "--expr", "0.001*sin(1/(u-0.5))"],
            vec!["finite everywhere", "division by 0"],
        ),
        (vec![mesh.as_str(), mesh.as_str(), "--expr", "noise(u*3e9,0,0)"], vec!["bounded"]),
    ] {
        let run = displace.run([&["measure"][..], &args].concat());
        assert_eq!(run.code, Some(2), "{args:?}: {}", run.stderr);
        words.iter().for_each(|word| assert!(run.stderr.contains(word), "{args:?}: {}", run.stderr));
    }
}

#[test]
fn the_surface_itself_is_rendered_on_the_reference_alone() {
    let displace = Displace::default();
    let mesh = plane(&displace);
    let render = |device: &str, output: &str| {
        displace.run([
            "render",
            &mesh,
            "--expr",
            "0.1*sin(9*u)",
            "--exact",
            "--supersample",
            "4",
            "--size",
            "48x32",
            "--device",
            device,
            "-o",
            output,
        ])
    };
    render("reference", "exact.png").expect_success();
    assert_eq!(image::image_dimensions(displace.folder().join("exact.png")).unwrap(), (48, 32));
    let refused = render("0", "no.png");
    assert_eq!(refused.code, Some(2), "{}", refused.stderr);
    assert!(refused.stderr.contains("--device reference"), "{}", refused.stderr);
}
