//! Watertightness: whatever the map, the mesh and the rule, positions of one place are one.

use displace_server::oracle::invariants;
use displace_tests::meshes;

use super::*;

fn rules() -> [(SeamRule, f32); 4] {
    [(SeamRule::Mean, 3.0), (SeamRule::Dominant, 3.0), (SeamRule::Mean, 0.0), (SeamRule::Dominant, 0.0)]
}

fn noisy_details() -> Vec<Arc<Detail>> {
    vec![
        height(noise([32, 32], 1), 0.2),
        detail([layer(LayerSource::VectorTangent(Arc::new(noise([16, 16], 3))), 0.2, 0.5)]),
        detail([layer(LayerSource::VectorObject(Arc::new(noise([16, 16], 3))), 0.2, 0.5)]),
        expression("sin(20*pi*u) + noise(9*v, 9*u, z)", 0.1),
    ]
}

#[test]
fn no_mesh_cracks_under_noise() {
    for source in meshes::all() {
        let mesh = welded_with_tangents(&source);
        for detail in noisy_details() {
            for (seams, feather_texels) in rules() {
                for level in [0, 1, 3] {
                    let g = Geometry { seams, feather_texels, ..geometry(level) };
                    let surface = run(vulkan(), &mesh, &g, Some(&detail));
                    let what = format!("{} {seams:?} {feather_texels} level {level}", mesh.name);
                    assert_eq!(invariants::of_surface(&mesh, &surface), [], "{what}");
                }
            }
        }
    }
}

#[test]
fn primitives_with_different_details_stay_together() {
    // A torus in two primitives, one with a map, one without.
    let torus = meshes::torus(12, 8);
    let half = torus.triangles.len() / 2;
    let parts = [&torus.triangles[..half], &torus.triangles[half..]].map(|triangles| {
        let mut part = torus.clone();
        part.triangles = triangles.to_vec();
        primitive(&part)
    });
    let mesh = weld("two parts", &parts).expect("valid");
    let job = JobContext { cancel: &Cancel::default(), progress: &NoProgress };
    let details = [Some(height(noise([32, 32], 1), 0.2)), None];
    for executor in [vulkan() as &dyn Executor, &ReferenceExecutor] {
        let (surface, _) = executor.displace(&job, &planned(&mesh, &geometry(3)), &mesh, &details).expect("runs");
        assert_eq!(invariants::of_surface(&mesh, &surface), []);
        assert!(surface.mismatch_max > 0.05, "{}", surface.mismatch_max);
    }
}

#[test]
fn a_map_that_tiles_across_the_seam_has_no_mismatch() {
    let mesh = welded(&meshes::torus(12, 8));
    let surface = run(vulkan(), &mesh, &geometry(3), Some(&height(noise([32, 32], 1), 0.2)));
    assert_eq!(surface.mismatch_max, 0.0);
}

#[test]
fn feathered_seams_leave_no_cliff() {
    // The largest step between neighbouring vertices near a seam: a cliff without feather, a slope with.
    let mesh = welded(&meshes::cube());
    let mut halves = map([32, 32], 1, |x, _, _| if x < 16 { 0.0 } else { 1.0 });
    halves.wrap = [Wrap::Clamp; 2];
    let halves = height(halves, 0.2);
    let step = |feather_texels: f32| {
        let g = Geometry { feather_texels, ..geometry(6) };
        let surface = run(vulkan(), &mesh, &g, Some(&halves));
        assert!(surface.mismatch_max > 0.19);
        let longest = |t: &[u32; 3]| {
            let p = t.map(|v| surface.positions[v as usize]);
            distance(p[0], p[1]).max(distance(p[1], p[2])).max(distance(p[2], p[0]))
        };
        surface.triangles.iter().map(longest).fold(0.0, f32::max)
    };
    let (cliff, ramp) = (step(0.0), step(8.0));
    assert!(ramp < 0.75 * cliff, "{ramp} against {cliff}");
}

#[test]
fn smooth_seams_have_bit_equal_normals_on_both_sides() {
    let mesh = welded(&meshes::torus(12, 8));
    let surface = run(vulkan(), &mesh, &geometry(2), Some(&height(noise([32, 32], 1), 0.05)));
    for gv in 0..mesh.gv_position.len() {
        let normals: Vec<[f32; 3]> = mesh.gv_av.list(gv).iter().map(|av| surface.normals[*av as usize]).collect();
        assert!(normals.windows(2).all(|pair| pair[0] == pair[1]), "{normals:?}");
    }
}

#[test]
fn degenerate_texture_coordinates_do_no_harm() {
    let mut source = meshes::icosphere(1);
    source.uvs.iter_mut().for_each(|uv| *uv = [0.25, 0.75]);
    let mesh = welded_with_tangents(&source);
    for detail in noisy_details() {
        let surface = run(vulkan(), &mesh, &geometry(2), Some(&detail));
        assert_eq!(invariants::of_surface(&mesh, &surface), []);
        assert!(surface.normals.iter().all(|n| (glam::Vec3::from(*n).length() - 1.0).abs() < 1e-5));
    }
}

/// Each triangle has UVs of its own at the middle of the fan and along the spine of the book.
#[test]
fn crowded_vertices_are_answered_in_time_and_crowded_edges_refused() {
    let sheets = |count: u32, spine: bool| {
        let around = |i: u32| (i as f32 * std::f32::consts::TAU / count as f32).sin_cos();
        let mut mesh = meshes::plane(1);
        mesh.positions = (0..count)
            .flat_map(|i| {
                let ((s, c), (s1, c1)) = (around(i), around(i + 1));
                if spine { [[0.0; 3], [0.0, 1.0, 0.0], [s, 0.5, c]] } else { [[0.0; 3], [s, 0.0, c], [s1, 0.0, c1]] }
            })
            .collect();
        mesh.normals = vec![[0.0, 1.0, 0.0]; mesh.positions.len()];
        mesh.uvs = (0..3 * count).map(|v| [(v as f32 * 0.618).fract(), (v as f32 * 0.382).fract()]).collect();
        mesh.triangles = (0..count).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        welded(&mesh)
    };
    let detail = height(noise([64, 64], 1), 0.2);
    let fan = sheets(20_000, false);
    let surface = run(vulkan(), &fan, &geometry(0), Some(&detail));
    assert_eq!(invariants::one_position_per_place(&fan, &surface), None);
    let job = JobContext { cancel: &Cancel::default(), progress: &NoProgress };
    let book = sheets(100, true);
    let error = vulkan().displace(&job, &planned(&book, &geometry(1)), &book, &[Some(detail)]).expect_err("refused");
    assert!(error.message.contains("100 sheets") && error.message.contains("--feather 0"), "{error}");
}
