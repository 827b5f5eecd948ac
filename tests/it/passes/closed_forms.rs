//! Results that can be written down: offsets of cubes and spheres, sine sheets, zero displacement.

use displace_server::oracle::invariants;
use displace_tests::meshes;
use glam::Vec3;

use super::*;

fn constant(value: f32) -> Map {
    map([4, 4], 1, |_, _, _| value)
}

#[test]
fn a_hard_cube_grows_by_a_constant_height_with_sharp_closed_corners() {
    let mesh = welded(&meshes::cube());
    for surface in on_both(&mesh, &geometry(3), Some(&height(constant(0.5), 0.25))) {
        assert_eq!(invariants::of_surface(&mesh, &surface), []);
        for (position, normal) in surface.positions.iter().zip(&surface.normals) {
            // Every face moves out by 0.125 and stays flat; its normal stays its own.
            let along = Vec3::from(*position).dot(Vec3::from(*normal));
            assert!((along - 0.625).abs() < 1e-6, "{position:?} {normal:?}");
            let axis = normal.iter().map(|x| x.abs()).fold(0.0, f32::max);
            assert!(axis > 1.0 - 1e-6, "{normal:?}");
        }
        let corners = surface.positions[..24].iter().flatten();
        assert!(corners.map(|x| (x.abs() - 0.625).abs()).fold(0.0, f32::max) < 1e-6);
    }
}

#[test]
fn a_smooth_sphere_moves_along_its_unit_normals() {
    let mesh = welded(&meshes::icosphere(1));
    let flat = run(vulkan(), &mesh, &geometry(3), None);
    for surface in on_both(&mesh, &geometry(3), Some(&height(constant(1.0), 0.25))) {
        for ((position, from), normal) in surface.positions.iter().zip(&flat.positions).zip(&flat.normals) {
            let expected = Vec3::from(*from) + 0.25 * Vec3::from(*normal);
            assert!(Vec3::from(*position).distance(expected) < 1e-6, "{position:?} {expected}");
            // Unit displacement: the coarse triangles' middles are not thinned.
            assert!((distance(*position, *from) - 0.25).abs() < 1e-6);
        }
    }
}

#[test]
fn no_displacement_changes_no_bit() {
    for mesh in meshes::all() {
        let mesh = welded(&mesh);
        let zero = height(map([8, 8], 1, |_, _, _| 0.0), 1.0);
        let [plain, zero] = [None, Some(&zero)].map(|detail| run(vulkan(), &mesh, &geometry(2), detail));
        assert_eq!(plain.positions, zero.positions, "{}", mesh.name);
        assert_eq!(plain.normals, zero.normals, "{}", mesh.name);
        for (av, gv) in mesh.av_gv.iter().enumerate() {
            assert_eq!(plain.positions[av], mesh.gv_position[*gv as usize]);
            assert_eq!(plain.normals[av], mesh.av_normal[av]);
        }
    }
}

#[test]
fn a_sine_sheet_has_its_normals() {
    let mesh = welded(&meshes::plane(2));
    // y = 0.05 sin(4 pi x): the normal is (-0.2 pi cos(4 pi x), 1, 0), normalised.
    for surface in on_both(&mesh, &geometry(5), Some(&expression("sin(4*pi*x)", 0.05))) {
        for (position, normal) in surface.positions.iter().zip(&surface.normals) {
            let slope = 0.2 * std::f32::consts::PI * (4.0 * std::f32::consts::PI * position[0]).cos();
            let expected = Vec3::new(-slope, 1.0, 0.0).normalize();
            assert!(Vec3::from(*normal).distance(expected) < 3e-6, "{position:?}: {normal:?} {expected}");
        }
    }
}

#[test]
fn normals_of_a_mapped_sine_sheet_converge_with_the_texels() {
    let mesh = welded(&meshes::plane(1));
    let error = |size: u32| {
        let wave = |x: u32| (std::f64::consts::TAU * 2.0 * (f64::from(x) + 0.5) / f64::from(size)).sin() as f32;
        let surface = run(vulkan(), &mesh, &geometry(6), Some(&height(map([size, 4], 1, |x, _, _| wave(x)), 0.05)));
        let one = |(position, normal): (&[f32; 3], &[f32; 3])| {
            let slope = 0.2 * std::f32::consts::PI * (4.0 * std::f32::consts::PI * (position[0] + 0.5)).cos();
            Vec3::from(*normal).distance(Vec3::new(-slope, 1.0, 0.0).normalize())
        };
        surface.positions.iter().zip(&surface.normals).map(one).fold(0.0, f32::max)
    };
    let errors = [32, 64, 128].map(error);
    // Central differences: at least the first order in the texel is seen.
    assert!(errors[1] < 0.6 * errors[0] && errors[2] < 0.6 * errors[1], "{errors:?}");
    assert!(errors[2] < 5e-3, "{errors:?}");
}

#[test]
fn geometric_normals_of_a_flat_sheet_are_its_own() {
    let mesh = welded(&meshes::plane(2));
    let g = Geometry { normals: Normals::Geometric, ..geometry(4) };
    for surface in on_both(&mesh, &g, Some(&height(constant(0.5), 0.5))) {
        assert!(surface.normals.iter().all(|n| distance(*n, [0.0, 1.0, 0.0]) < 1e-6));
    }
}

#[test]
fn geometric_normals_of_a_sphere_point_outwards() {
    let mesh = welded(&meshes::icosphere(2));
    let g = Geometry { normals: Normals::Geometric, ..geometry(2) };
    for surface in on_both(&mesh, &g, Some(&height(constant(1.0), 0.5))) {
        for (position, normal) in surface.positions.iter().zip(&surface.normals) {
            assert!(Vec3::from(*position).normalize().dot(Vec3::from(*normal)) > 0.995);
        }
    }
}

#[test]
fn tangent_vectors_along_the_normal_are_heights() {
    for mesh in [meshes::torus(8, 6), meshes::mirrored_uv_sphere(8, 6), meshes::cube()] {
        let mesh = welded_with_tangents(&mesh);
        let heights = noise([16, 16], 1);
        let vectors = map([16, 16], 3, |x, y, c| if c == 2 { heights.texels[(y * 16 + x) as usize] } else { 0.0 });
        let as_height = run(vulkan(), &mesh, &geometry(3), Some(&height(heights, 0.1)));
        let layer = layer(LayerSource::VectorTangent(Arc::new(vectors)), 0.1, 0.0);
        let as_vector = run(vulkan(), &mesh, &geometry(3), Some(&detail([layer])));
        assert!(worst(&as_height.positions, &as_vector.positions) < 1e-6, "{}", mesh.name);
    }
}

#[test]
fn tangent_vectors_on_a_plane_are_object_vectors() {
    // On the plane u runs along +x and v along +z; the bitangent of a right-handed frame on a V-down map
    // runs against v or along it by the handedness, which the mesh's own tangent says.
    let mesh = welded_with_tangents(&meshes::plane(1));
    let [tx, ty, tz, w] = mesh.av_tangent[0];
    let (tangent, normal) = (Vec3::new(tx, ty, tz), Vec3::Y);
    let bitangent = normal.cross(tangent) * w;
    let local = noise([8, 8], 3);
    let object = map([8, 8], 3, |x, y, c| {
        let at = ((y * 8 + x) * 3) as usize;
        let v = tangent * local.texels[at] + bitangent * local.texels[at + 1] + normal * local.texels[at + 2];
        v[c as usize]
    });
    let run_as = |source| run(vulkan(), &mesh, &geometry(4), Some(&detail([layer(source, 0.2, 0.0)])));
    let a = run_as(LayerSource::VectorTangent(Arc::new(local)));
    let b = run_as(LayerSource::VectorObject(Arc::new(object)));
    assert!(worst(&a.positions, &b.positions) < 1e-6);
    assert!(worst(&a.normals, &b.normals) < 1e-4);
}

#[test]
fn mirrored_halves_displace_as_mirror_images() {
    // u runs there and back: the map on the far half is the mirror image of that on the near half, so the
    // tangent displacement must mirror too. A wrong handedness would turn it the other way.
    let mesh = welded_with_tangents(&meshes::mirrored_uv_sphere(16, 8));
    let sideways = map([4, 4], 3, |_, _, c| if c == 1 { 1.0 } else { 0.0 });
    let surface = run(
        vulkan(),
        &mesh,
        &geometry(2),
        Some(&detail([layer(LayerSource::VectorTangent(Arc::new(sideways)), 0.1, 0.0)])),
    );
    let flat = run(vulkan(), &mesh, &geometry(2), None);
    let mut signs = std::collections::HashSet::new();
    for (moved, from) in surface.positions.iter().zip(&flat.positions) {
        if from[1].abs() < 0.6 {
            let up = moved[1] - from[1];
            assert!(up.abs() > 0.05, "{from:?} -> {moved:?}");
            signs.insert(up > 0.0);
        }
    }
    assert_eq!(signs.len(), 1, "v runs the same way on both halves, so must the displacement");
}

#[test]
fn a_direction_expression_reads_the_normal() {
    let mesh = welded(&meshes::icosphere(1));
    let flat = run(vulkan(), &mesh, &geometry(2), None);
    let surface = run(vulkan(), &mesh, &geometry(2), Some(&expression("max(ny, 0)", 0.5)));
    for ((moved, from), normal) in surface.positions.iter().zip(&flat.positions).zip(&flat.normals) {
        assert!((distance(*moved, *from) - 0.5 * normal[1].max(0.0)).abs() < 1e-6);
    }
}

#[test]
fn an_undefined_expression_is_refused_with_a_way_out() {
    let mesh = welded(&meshes::plane(1));
    let detail = expression("1/x", 0.1);
    for executor in [vulkan() as &dyn Executor, &ReferenceExecutor] {
        let job = JobContext { cancel: &Cancel::default(), progress: &NoProgress };
        let plan = planned(&mesh, &geometry(2));
        let error = executor.displace(&job, &plan, &mesh, &[Some(detail.clone())]).expect_err("1/0 is nowhere");
        assert!(error.message.contains("not finite"), "{error}");
    }
}

#[test]
fn flipped_triangles_are_counted() {
    let mesh = welded(&meshes::plane(1));
    // Turns the sheet around: x goes to -x.
    let turned = expression("0", 0.0);
    assert_eq!(run(vulkan(), &mesh, &geometry(2), Some(&turned)).flipped, 0);
    let fold = detail([layer(LayerSource::VectorObject(Arc::new(fold_map())), 1.0, 0.0)]);
    let [device, twin] = on_both(&mesh, &geometry(4), Some(&fold));
    assert!(device.flipped > 0);
    assert_eq!(device.flipped, twin.flipped);
}

/// Pulls the middle of the sheet far to one side: part of it folds over.
fn fold_map() -> Map {
    map([8, 8], 3, |x, _, c| if c == 0 && (3..5).contains(&x) { 0.8 } else { 0.0 })
}
