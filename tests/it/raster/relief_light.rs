//! Light on heights that are shown per pixel: what keeps it off, and what must not.

use displace_glsl::methods::Method;
use displace_server::domain::{
    image::{HeightMap, ImageSet, RenderLight, RenderMaterial, RenderScene, Shading},
    request::Shadows,
};
use displace_tests::meshes;
use glam::DVec3;

use super::{
    looks::assert_agrees,
    relief::{in_relief, waves},
    render,
    scenes::{Builder, IDENTITY, material, render_mesh, view_camera},
};

const SIDE: u32 = 96;

/// Heights from `low` to `low + range`, waves between.
fn raised(low: f32, range: f32) -> HeightMap {
    let map = waves(64, 0.5 * range);
    let heights = map.heights.iter().map(|h| h + low + 0.5 * range).collect();
    HeightMap { heights, ..map }
}

fn scaled(scale: f32, at: [f32; 3]) -> [f32; 16] {
    let mut placed = IDENTITY;
    (placed[0], placed[5], placed[10]) = (scale, scale, scale);
    placed[12..15].copy_from_slice(&at);
    placed
}

fn lit_by(direction: [f64; 3], builder: Builder) -> RenderScene {
    let mut scene = builder.finish();
    scene.relief.method = Method::Exact;
    scene.shading = Shading::Phong;
    scene.lighting.lights = vec![RenderLight::sun(DVec3::from_array(direction).normalize().as_vec3().to_array())];
    scene
}

/// Pixels that are darker where rays meet triangles.
fn shaded(scene: &RenderScene) -> usize {
    let open = render(&RenderScene { shadows: Shadows::None, ..scene.clone() }, SIDE, SIDE);
    let shaded = render(&RenderScene { shadows: Shadows::Ray, ..scene.clone() }, SIDE, SIDE);
    darker(&open, &shaded).len()
}

fn darker(open: &ImageSet, shaded: &ImageSet) -> Vec<usize> {
    let is_darker = |i: &usize| shaded.color[*i][0] < open.color[*i][0] - 0.05;
    (0..open.color.len()).filter(is_darker).collect()
}

/// A floor, and 0.4 above it a smaller one of the same mesh and material.
fn floors(low: f32) -> RenderScene {
    let mut builder = Builder::lit(view_camera([0.0, 2.2, 1.6], [0.0; 3], 50.0, SIDE, SIDE));
    builder.add(render_mesh(&meshes::plane(2)), in_relief(raised(low, 0.05)), scaled(2.0, [0.0; 3]));
    let mut scene = lit_by([0.3, 1.0, 0.1], builder);
    let above = scaled(0.6, [0.0, 0.4, 0.0]);
    scene
        .instances
        .push(displace_server::domain::image::RenderInstance { world_from_mesh: above, ..scene.instances[0] });
    scene
}

#[test]
fn a_relief_shadows_others_of_its_material_and_not_itself() {
    for low in [-0.05, -0.02, 0.0] {
        let both = floors(low);
        let mut alone = both.clone();
        alone.instances.pop();
        let count = shaded(&both);
        assert!(count > 150, "{low}: {count} pixels below the upper floor");
        assert_eq!(shaded(&alone), 0, "{low}");
        assert_agrees(&RenderScene { shadows: Shadows::Ray, ..both }, 1e-2, &format!("from {low}"));
    }
}

#[test]
fn a_ball_in_a_pit_sees_the_sun() {
    let mut builder = Builder::lit(view_camera([0.0, 2.0, 0.8], [0.0; 3], 40.0, SIDE, SIDE));
    builder.add(render_mesh(&meshes::plane(2)), in_relief(raised(-0.2, 0.0)), scaled(2.0, [0.0; 3]));
    builder.add(render_mesh(&meshes::icosphere(3)), material([1.0, 0.5, 0.1], None), scaled(0.15, [0.0, -0.2, 0.0]));
    let scene = lit_by([0.1, 1.0, 0.1], builder);
    let open = render(&scene, SIDE, SIDE);
    let with = render(&RenderScene { shadows: Shadows::Ray, ..scene.clone() }, SIDE, SIDE);
    let is_ball = |i: &&usize| open.color[**i][2] < 0.5 * open.color[**i][0];
    let normal = |i: usize| DVec3::from_array(open.normal.as_ref().expect("normals")[i].map(f64::from));
    let lit = (0..open.color.len()).filter(|i| is_ball(&i) && normal(*i).y > 0.3).count();
    let dark = darker(&open, &with).iter().filter(|i| is_ball(i) && normal(**i).y > 0.3).count();
    assert!(lit > 300 && dark == 0, "{dark} of {lit}");
    assert_agrees(&RenderScene { shadows: Shadows::Ray, ..scene }, 1e-2, "a ball in a pit");
}

/// Facets that lie 20 degrees apart: rays leave by triangles that what is struck is far behind.
#[test]
fn a_coarse_ball_with_pits_is_lit_up_to_its_edge() {
    let made: RenderMaterial = in_relief(raised(-0.1, 0.05));
    let mut builder = Builder::lit(view_camera([0.0, 0.5, 3.2], [0.0; 3], 45.0, SIDE, SIDE));
    builder.add(render_mesh(&meshes::icosphere(1)), made, IDENTITY);
    let scene = lit_by([0.8, 0.3, 0.5], builder);
    let count = shaded(&scene);
    assert!(count <= 20, "{count} pixels");
    assert_agrees(&RenderScene { shadows: Shadows::Ray, ..scene }, 1e-2, "a coarse ball");
}
