//! The same request gives the same bytes: again, on one driver thread or two, and for triangles in
//! another order.

use std::collections::BTreeMap;

use displace_server::vulkan::Testing;
use displace_tests::{maps, meshes};

use super::*;

type Bits = ([u32; 3], [u32; 3], [u32; 2]);

/// Each fine triangle as its vertices' bits, turned to start at the smallest, all sorted.
fn canonical(surface: &Surface) -> Vec<[Bits; 3]> {
    let vertex = |v: u32| -> Bits {
        let v = v as usize;
        let uv = [surface.attributes[0][2 * v], surface.attributes[0][2 * v + 1]];
        (surface.positions[v].map(f32::to_bits), surface.normals[v].map(f32::to_bits), uv.map(f32::to_bits))
    };
    let mut all: Vec<[Bits; 3]> = surface
        .triangles
        .iter()
        .map(|t| {
            let mut corners = t.map(vertex);
            let first = (0..3).min_by_key(|k| corners[*k]).unwrap_or(0);
            corners.rotate_left(first);
            corners
        })
        .collect();
    all.sort_unstable();
    all
}

#[test]
fn results_are_equal_to_the_byte_again_and_again() {
    let mesh = welded_with_tangents(&meshes::cube());
    let detail = height(noise([64, 64], 1), 0.2);
    let first = run(vulkan(), &mesh, &geometry(4), Some(&detail));
    for _ in 0..3 {
        assert_eq!(run(vulkan(), &mesh, &geometry(4), Some(&detail)), first);
    }
}

/// What only huge meshes or GPUs reach: several pages to a stream, copies through staging memory, one element a
/// thread.
#[test]
fn pages_staging_and_batches_change_no_byte() {
    let ways = [
        Testing { page_shift: Some(10), ..Testing::default() },
        Testing { force_staging: true, ..Testing::default() },
        Testing { batch: Some(1), ..Testing::default() },
    ];
    let details = [
        height(noise([128, 96], 1), 0.2),
        detail([layer(LayerSource::VectorTangent(Arc::new(noise([64, 64], 3))), 0.1, 0.5)]),
        expression("0.05*sin(20*x)*cos(9*u)", 1.0),
    ];
    for testing in ways {
        let options = DeviceOptions { validation: true, testing: testing.clone(), ..Default::default() };
        let device = VulkanExecutor::with_device(Device::open(&options).expect("opens"));
        for mesh in [meshes::cube(), meshes::torus(8, 6)] {
            let mesh = welded_with_tangents(&mesh);
            for (detail, normals) in details.iter().zip([Normals::Analytic, Normals::Analytic, Normals::Geometric]) {
                let geometry = Geometry { normals, ..geometry(3) };
                let [expected, found] = [vulkan(), &device].map(|device| run(device, &mesh, &geometry, Some(detail)));
                assert!(expected == found, "{} with {testing:?}", mesh.name);
            }
        }
    }
}

#[test]
fn permuted_triangles_give_the_same_surface() {
    // Interior vertices are blended in the order of their triangle's corners, so a rotated triangle may
    // differ in the last bits there; the level has none. Places and shared edges are equal to the bit.
    for source in [meshes::torus(10, 6), meshes::cube(), meshes::moebius(16, 2), meshes::uv_sphere(12, 6)] {
        let reference = run(vulkan(), &welded(&source), &geometry(1), Some(&height(noise([32, 32], 1), 0.1)));
        for seed in 0..3 {
            let mesh = welded(&source.permuted(seed));
            let surface = run(vulkan(), &mesh, &geometry(1), Some(&height(noise([32, 32], 1), 0.1)));
            let (a, b) = (positions_only(&reference), positions_only(&surface));
            assert!(a == b, "{} with seed {seed}", source.name);
        }
    }
}

/// How often each position occurs, without the order of anything.
fn positions_only(surface: &Surface) -> BTreeMap<[[u32; 3]; 3], u32> {
    let mut counts = BTreeMap::new();
    for triangle in canonical(surface) {
        let mut places = triangle.map(|v| v.0);
        places.sort_unstable();
        *counts.entry(places).or_insert(0) += 1;
    }
    counts
}

/// Driver threads are read from the environment when the driver starts, so each count needs a process: this
/// test runs itself.
#[test]
fn one_driver_thread_or_two_give_the_same_bytes() {
    const CHILD: &str = "DISPLACE_TEST_DIGEST_CHILD";
    let digest = || {
        let mesh = welded_with_tangents(&meshes::cube());
        let surface = run(vulkan(), &mesh, &geometry(5), Some(&height(noise([64, 64], 1), 0.2)));
        let words = surface.positions.iter().chain(&surface.normals).flatten().map(|x| x.to_bits());
        words.fold(0u32, |sum, word| maps::hash(sum, word, 1))
    };
    if std::env::var_os(CHILD).is_some() {
        println!("digest={:08x}", digest());
        return;
    }
    let mut digests = ["1", "2"].map(|threads| {
        let output = std::process::Command::new(std::env::current_exe().expect("this test has a path"))
            .args(["--exact", "passes::determinism::one_driver_thread_or_two_give_the_same_bytes", "--nocapture"])
            .env(CHILD, "1")
            .env("LP_NUM_THREADS", threads)
            .output()
            .expect("the test can run itself");
        let text = String::from_utf8_lossy(&output.stdout).into_owned();
        text.split("digest=").nth(1).unwrap_or_else(|| panic!("no digest in {text}")).trim()[..8].to_owned()
    });
    digests.sort();
    assert_eq!(digests[0], digests[1]);
    assert_eq!(digests[0], format!("{:08x}", digest()));
}
