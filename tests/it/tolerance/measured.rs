//! The distance that a report tells as found, beside the one that it promises.

use displace_tests::{maps, meshes, server};
use serde_json::Value;

/// What a report says of a wall of 32 triangles.
fn accuracy(detail: &[&str], flags: &[&str]) -> Value {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).to_str().expect("temporary folders are UTF-8").to_owned();
    std::fs::write(path("wall.glb"), meshes::plane(4).to_glb()).expect("it is written");
    std::fs::write(path("noise.png"), maps::noise16(24, 3)).expect("it is written");
    let (wall, noise, out) = (path("wall.glb"), path("noise.png"), path("out.glb"));
    let detail: Vec<&str> = detail.iter().map(|word| if *word == "NOISE" { &noise } else { *word }).collect();
    let args = ["apply", &wall, "-o", &out, "--json", "--server", server::reference()];
    server::displace(&[&args[..], &detail, flags].concat()).expect_success().json()["accuracy"].clone()
}

fn figure(accuracy: &Value, of: &str) -> f64 {
    accuracy[of].as_f64().unwrap_or_else(|| panic!("no {of} in {accuracy}"))
}

#[test]
fn what_is_found_is_near_the_bound_and_never_above_it() {
    for flags in [
        &["--tolerance", "4e-3"][..],
        &["--tolerance-world", "5e-3", "--compress", "quantize"],
        &["--tolerance-world", "5e-3", "--feather", "0", "--compress", "meshopt"],
        &["--tolerance-px", "0.5", "--view", "0,0,3;0,0,0;40;320x240"],
        &["--tolerance", "2e-3", "--max-triangles", "200"],
    ] {
        let accuracy = accuracy(&["--height", "NOISE", "--scale", "0.06"], flags);
        let (measured, bound) = (figure(&accuracy, "measured"), figure(&accuracy, "bound"));
        assert!(measured > 0.4 * bound && measured <= bound, "{flags:?}: {accuracy}");
    }
}

#[test]
fn the_distance_found_of_a_known_curve_is_that_of_its_middle() {
    // Over sides of a quarter of u: (1/4)^2 / 4 of the factor, in their middles.
    let flags = ["--tolerance-world", "0.01", "--max-triangles", "32"];
    let measured = figure(&accuracy(&["--expr", "1.28*u*(1-u)"], &flags), "measured");
    assert!((measured - 1.28 / 64.0).abs() < 1e-6, "{measured}");
}
