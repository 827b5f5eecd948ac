//! Images of heights that are shown per pixel: the device against the twins, and outlines against fine triangles.

use std::sync::Arc;

use displace_glsl::methods::{METHODS, Method};
use displace_server::domain::{
    detail::Wrap,
    image::{
        BumpKind, ColorMap, HeightMap, ImageSet, RenderLight, RenderMap, RenderMaterial, RenderMesh, RenderRelief,
        RenderScene, SelfShadow, Silhouettes,
    },
};
use displace_server::render::image::KeptCones;
use displace_tests::meshes::{self, TestMesh};
use glam::{DVec2, DVec3};

use super::{
    looks::assert_agrees,
    plan, render, render_after, render_plan,
    scenes::{Builder, IDENTITY, LEAK, material, render_mesh, view_camera},
};

const MAP_FROM_UV: [[f32; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// Waves that tile, from -`height` to `height`.
pub(super) fn waves(side: u32, height: f32) -> HeightMap {
    let turn = |i: u32| (i as f32 + 0.5) / side as f32 * std::f32::consts::TAU;
    let at = |i: u32| height * (3.0 * turn(i % side)).sin() * (2.0 * turn(i / side)).cos();
    let heights = (0..side * side).map(at).collect();
    HeightMap { width: side, height: side, heights, repeats: [true; 2], thinnest_texels: side as f32 / 12.0 }
}

/// As the jobs make it: heights, and the slopes of the same for normals.
pub(super) fn in_relief(map: HeightMap) -> RenderMaterial {
    let mut made = RenderMaterial { double_sided: false, ..material([0.8, 0.7, 0.6], None) };
    let slopes = slopes(&map);
    made.bump.uses[0].kind = BumpKind::Height;
    made.bump.uses[0].scale = 1.0;
    made.maps[displace_glsl::layout::raster::MAP_DETAIL] =
        Some(RenderMap { map: Arc::new(slopes), uv_channel: 0, map_from_uv: MAP_FROM_UV, wrap: [Wrap::Repeat; 2] });
    made.relief = Some(RenderRelief { map: Arc::new(map), uv_channel: 0, map_from_uv: MAP_FROM_UV, steps: 0 });
    made
}

fn slopes(map: &HeightMap) -> ColorMap {
    let n = map.width as i32;
    let height = |x: i32, y: i32| map.heights[(y.rem_euclid(n) * n + x.rem_euclid(n)) as usize];
    let half = n as f32 / 2.0;
    let texel = |i: i32| {
        let (x, y) = (i % n, i / n);
        let [dx, dy] = [height(x + 1, y) - height(x - 1, y), height(x, y + 1) - height(x, y - 1)];
        [dx * half, dy * half, 0.0, 1.0]
    };
    ColorMap { width: map.width, height: map.height, texels: (0..n * n).map(texel).collect() }
}

/// A floor in relief, uneven in scale and mirrored, with a ball that comes out of it.
fn floor(method: Method) -> RenderScene {
    let mut builder = Builder::lit(view_camera([0.2, 1.3, 1.6], [0.0, 0.0, 0.0], 50.0, 96, 96));
    let mut placed = IDENTITY;
    (placed[0], placed[5], placed[10]) = (-1.5, 0.8, 2.0);
    builder.add(render_mesh(&meshes::plane(2)), in_relief(waves(64, 0.06)), placed);
    let mut ball = IDENTITY;
    (ball[0], ball[5], ball[10], ball[12]) = (0.4, 0.4, 0.4, 0.3);
    builder.add(render_mesh(&meshes::uv_sphere(24, 12)), material([0.2, 0.5, 0.9], None), ball);
    let mut scene = builder.finish();
    scene.relief.method = method;
    scene.lighting.lights = vec![RenderLight::sun(DVec3::new(0.6, 0.4, 0.3).normalize().as_vec3().to_array())];
    scene
}

#[test]
fn every_method_that_marches_shows_what_its_twin_does_also_mirrored_and_with_a_ball_in_it() {
    for row in METHODS.iter().filter(|row| row.marcher.is_some()) {
        assert_agrees(&floor(row.method), 1e-2, row.name);
    }
}

#[test]
fn cones_are_made_once_for_each_map_and_show_the_same_to_the_byte() {
    let cones = KeptCones::default();
    let scene = floor(Method::Cone);
    let mut other = floor(Method::Cone);
    other.materials[0] = in_relief(waves(32, 0.05));
    let plan = plan(&scene, 96, 96);
    let mut shown = |scene: &RenderScene| {
        let (images, passes) = render_after(scene, &plan, &cones);
        assert!(images == render_plan(scene, &plan), "as if it were the first");
        passes.iter().any(|name| name == "cone_map")
    };
    assert_eq!([&scene, &scene, &other, &scene, &other].map(&mut shown), [true, false, true, false, false]);
    let scene = floor(Method::Cone);
    assert!(shown(&scene), "another map of the same heights");
}

#[test]
fn self_shadows_are_those_of_the_twins() {
    for self_shadow in [SelfShadow::Hard, SelfShadow::Soft] {
        let mut scene = floor(Method::Exact);
        scene.relief.self_shadow = self_shadow;
        assert_agrees(&scene, 1e-2, &format!("{self_shadow:?}"));
    }
}

#[test]
fn a_ball_in_relief_is_cut_where_its_depth_says() {
    // Heights of nothing but +0.05 lift the floor as much as a floor that lies higher.
    let image = |height: f32, y: f32| {
        let mut scene = floor(Method::Exact);
        scene.materials[0] = in_relief(HeightMap { heights: vec![height; 64 * 64], ..waves(64, 0.0) });
        scene.instances[0].world_from_mesh[13] = y;
        render(&scene, 96, 96)
    };
    let (lifted, higher) = (image(0.05, 0.0), image(0.0, 0.04));
    let covered = |image: &ImageSet| -> Vec<bool> { image.color.iter().map(|c| c[2] > c[0]).collect() };
    let apart = covered(&lifted).iter().zip(covered(&higher)).filter(|(a, b)| **a != *b).count();
    assert!(apart <= 8, "{apart} pixels of the ball");
}

/// The triangles of a mesh in `parts` x `parts` each, moved along their directions by the heights.
fn displaced(mesh: &TestMesh, map: &HeightMap, parts: usize) -> RenderMesh {
    let vector = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
    let n = map.width as i64;
    let height = |uv: DVec2| {
        let place = uv * n as f64 - 0.5;
        let (corner, f) = (place.floor(), place - place.floor());
        let at = |x: i64, y: i64| {
            let (x, y) = ((corner.x as i64 + x).rem_euclid(n), (corner.y as i64 + y).rem_euclid(n));
            f64::from(map.heights[(y * n + x) as usize])
        };
        let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
        mix(mix(at(0, 0), at(1, 0), f.x), mix(at(0, 1), at(1, 1), f.x), f.y)
    };
    let mut made = RenderMesh::default();
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    for triangle in &mesh.triangles {
        let corner = |k: usize| triangle[k] as usize;
        let place = |i: usize, j: usize| {
            let b = DVec3::new((parts - i - j) as f64, i as f64, j as f64) / parts as f64;
            let blend = |of: &dyn Fn(usize) -> DVec3| (0..3).map(|k| of(corner(k)) * b[k]).sum::<DVec3>();
            let uv = blend(&|v| DVec3::new(mesh.uvs[v][0].into(), mesh.uvs[v][1].into(), 0.0)).truncate();
            let along = blend(&|v| vector(mesh.normals[v])).normalize();
            (blend(&|v| vector(mesh.positions[v])) + along * height(uv)).as_vec3().to_array()
        };
        for i in 0..parts {
            for j in 0..parts - i {
                let mut add = |corners: [[f32; 3]; 3]| {
                    let first = positions.len() as u32;
                    positions.extend(corners);
                    triangles.push([first, first + 1, first + 2]);
                };
                add([place(i, j), place(i + 1, j), place(i, j + 1)]);
                if i + j + 2 <= parts {
                    add([place(i + 1, j), place(i + 1, j + 1), place(i, j + 1)]);
                }
            }
        }
    }
    made.normals = Arc::new(vec![[0.0, 1.0, 0.0]; positions.len()]);
    made.uvs = Arc::new(vec![[0.0; 2]; positions.len()]);
    made.positions = Arc::new(positions);
    made.triangles = Arc::new(triangles);
    made
}

/// Pixels that one image alone covers, and those at the outline of the second.
fn outlines(image: &ImageSet, truth: &ImageSet) -> [usize; 2] {
    let covered = |image: &ImageSet| -> Vec<bool> { image.color.iter().map(|c| c[0] < 0.5 * LEAK).collect() };
    let (seen, expected, width) = (covered(image), covered(truth), truth.width as usize);
    let rim = |i: usize| expected[i] && [i - 1, i + 1, i - width, i + width].iter().any(|k| !expected[*k]);
    let inside = |i: &usize| (1..width - 1).contains(&(i % width)) && (width..expected.len() - width).contains(i);
    let apart = (0..seen.len()).filter(|i| seen[*i] != expected[*i]).count();
    [apart, (0..seen.len()).filter(inside).filter(|i| rim(*i)).count()]
}

fn outline_of(mesh: &TestMesh, silhouettes: Silhouettes) -> f64 {
    const SIDE: u32 = 256;
    let map = waves(96, 0.08);
    let camera = || view_camera([1.2, 1.6, 2.4], [0.0; 3], 45.0, SIDE, SIDE);
    let mut builder = Builder::unlit(camera());
    builder.add(render_mesh(mesh), in_relief(map.clone()), IDENTITY);
    let mut scene = builder.finish();
    scene.relief.method = Method::Exact;
    scene.relief.silhouettes = silhouettes;
    let mut builder = Builder::unlit(camera());
    builder.add(displaced(mesh, &map, 12), material([0.8, 0.7, 0.6], None), IDENTITY);
    let [apart, rim] = outlines(&render(&scene, SIDE, SIDE), &render(&builder.finish(), SIDE, SIDE));
    assert!(rim > 300, "{rim} pixels of outline");
    let error = apart as f64 / rim as f64;
    println!("{} {silhouettes:?}: {error:.3} px", mesh.name);
    error
}

#[test]
fn a_shell_has_the_outline_of_fine_triangles_on_a_sphere_and_a_torus_within_half_a_pixel() {
    for mesh in [meshes::uv_sphere(32, 16), meshes::torus(32, 16)] {
        let (shell, none) = (outline_of(&mesh, Silhouettes::Shell), outline_of(&mesh, Silhouettes::None));
        assert!(shell < 0.5, "{}: {shell} px", mesh.name);
        assert!(none > 2.0 * shell, "{}: {none} px without", mesh.name);
    }
}

/// Each ray sees the quadric of one triangle: what is a saddle farther on, it misses.
#[test]
fn a_quadric_has_a_better_outline_than_the_base_and_on_a_sphere_less_than_half_as_far_off() {
    for (mesh, share) in [(meshes::uv_sphere(32, 16), 0.5), (meshes::torus(32, 16), 0.9)] {
        let (quadric, none) = (outline_of(&mesh, Silhouettes::Quadric), outline_of(&mesh, Silhouettes::None));
        assert!(quadric < share * none, "{}: {quadric} px, {none} px without", mesh.name);
    }
}
