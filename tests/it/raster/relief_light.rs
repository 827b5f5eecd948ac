//! Light on heights that are shown per pixel: what keeps it off, and what must not.

use displace_glsl::methods::{METHODS, Method};
use displace_server::domain::{
    image::{
        HeightMap, ImageSet, RenderAlpha, RenderInstance, RenderLight, RenderMaterial, RenderScene, SelfShadow, Shading,
    },
    request::Shadows,
};
use displace_tests::meshes;
use glam::DVec3;

use super::{
    looks::assert_agrees,
    reference,
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
    scene.instances.push(RenderInstance { world_from_mesh: above, ..scene.instances[0] });
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
    assert!(lit > 150 && dark == 0, "{dark} of {lit}");
    assert_agrees(&RenderScene { shadows: Shadows::Ray, ..scene }, 1e-2, "a ball in a pit");
}

/// Facets that lie 20 degrees apart: rays leave by triangles that what is struck is far behind.
#[test]
fn a_coarse_ball_with_pits_is_lit_up_to_its_edge() {
    let made: RenderMaterial = in_relief(raised(-0.1, 0.05));
    let mut builder = Builder::lit(view_camera([0.0, 0.5, 3.2], [0.0; 3], 45.0, SIDE, SIDE));
    builder.add(render_mesh(&meshes::icosphere(1)), made, IDENTITY);
    let sun = DVec3::new(0.8, 0.3, 0.5);
    let scene = lit_by(sun.to_array(), builder);
    let open = render(&scene, SIDE, SIDE);
    let with = render(&RenderScene { shadows: Shadows::Ray, ..scene.clone() }, SIDE, SIDE);
    let place = |i: usize| DVec3::from_array(open.position.as_ref().expect("positions")[i].map(f64::from));
    let faces = |i: &usize| place(*i).dot(sun) > 0.05;
    let count = darker(&open, &with).into_iter().filter(faces).count();
    assert!(count <= 25, "{count} pixels");
    assert_agrees(&RenderScene { shadows: Shadows::Ray, ..scene }, 1e-2, "a coarse ball");
}

/// Waves no steeper than 0.2, under a sun at more than 20 degrees: there is no shadow anywhere.
#[test]
fn heights_that_no_sun_is_hidden_by_are_lit_in_shadow_maps_by_every_method() {
    for row in METHODS.iter().filter(|row| row.marcher.is_some_and(|marcher| marcher.finds_depth)) {
        let mut builder = Builder::lit(view_camera([0.0, 2.2, 1.6], [0.0; 3], 50.0, SIDE, SIDE));
        let mut waved = in_relief(waves(64, 0.01));
        waved.relief.as_mut().expect("relief").steps = if row.method == Method::Exact { 0 } else { 12 };
        builder.add(render_mesh(&meshes::plane(2)), waved, scaled(2.0, [0.0; 3]));
        let mut scene = lit_by([0.9, 0.38, 0.2], builder);
        scene.relief.method = row.method;
        let mapped = RenderScene { shadows: Shadows::Map, ..scene.clone() };
        let count = darker(&render(&scene, SIDE, SIDE), &render(&mapped, SIDE, SIDE)).len();
        assert!(count <= 40, "{}: {count} pixels", row.name);
        if row.method == Method::Steep {
            assert_agrees(&mapped, 1e-2, row.name);
        }
    }
}

/// A wall 0.3 high, and a lamp 0.1 above the ground before it, from which all ways come down to the ground.
/// From so far away that a mean of the heights is marched there, while the sun sees a finer level.
#[test]
fn a_rough_floor_is_as_bright_under_shadow_maps_from_afar_as_from_near_by() {
    let noise = |i: u32| (i.wrapping_mul(0x9E37_79B9) ^ i.wrapping_mul(0x85EB_CA6B) >> 13) >> 24;
    // As high and as wide in the world however large the floor is, which is seen from as far away.
    let map = |far: f32| {
        let heights = (0..128 * 128).map(|i| noise(i) as f32 / 255.0 * 0.03 / far).collect();
        HeightMap { width: 128, height: 128, heights, repeats: [true; 2], thinnest_texels: 1.0 }
    };
    let mean = |image: &ImageSet| {
        let lit = image.color.iter().map(|color| f64::from(color[0]));
        lit.sum::<f64>() / image.color.len() as f64
    };
    let share = |far: f32| {
        let mut builder = Builder::lit(view_camera([0.0, 0.9 * far, 0.45 * far], [0.0; 3], 30.0, SIDE, SIDE));
        let (mut material, tiles) = (in_relief(map(far)), [[far, 0.0, 0.0], [0.0, far, 0.0]]);
        material.relief.iter_mut().for_each(|relief| relief.map_from_uv = tiles);
        material.maps.iter_mut().flatten().for_each(|map| map.map_from_uv = tiles);
        builder.add(render_mesh(&meshes::plane(2)), material, scaled(far, [0.0; 3]));
        let scene = lit_by([1.0, 1.0, 0.3], builder);
        let [open, shaded] = [Shadows::None, Shadows::Map]
            .map(|shadows| mean(&render(&RenderScene { shadows, ..scene.clone() }, SIDE, SIDE)));
        shaded / open
    };
    let (near, far) = (share(1.0), share(6.0));
    assert!(near < 0.97 && far > 0.85 * near, "{far} {near}");
}

#[test]
fn what_stands_behind_a_lamp_shadows_nothing() {
    let map = waves(64, 0.0);
    let heights = (0..64 * 64).map(|i| if i % 64 >= 40 { 0.3 } else { 0.0 }).collect();
    let mut builder = Builder::lit(view_camera([-0.6, 2.4, 1.2], [-0.2, 0.0, 0.0], 45.0, SIDE, SIDE));
    builder.add(
        render_mesh(&meshes::plane(2)),
        in_relief(HeightMap { heights, repeats: [false; 2], ..map }),
        scaled(2.0, [0.0; 3]),
    );
    let mut scene = lit_by([0.0, 1.0, 0.0], builder);
    scene.lighting.lights = vec![RenderLight::point([0.1, 0.2, 0.0])];
    for self_shadow in [SelfShadow::Hard, SelfShadow::Soft] {
        let open = render(&scene, SIDE, SIDE);
        let mut shadowed = scene.clone();
        shadowed.relief.self_shadow = self_shadow;
        let image = render(&shadowed, SIDE, SIDE);
        let position = |i: usize| open.position.as_ref().expect("positions")[i];
        let on_ground = |i: &usize| position(*i)[0] < 0.0 && position(*i)[1].abs() < 0.01 && open.color[*i][0] > 0.1;
        let count = (0..open.color.len()).filter(on_ground).count();
        let dark = darker(&open, &image).into_iter().filter(on_ground).count();
        assert!(count > 1000 && dark == 0, "{self_shadow:?}: {dark} of {count}");
        assert_agrees(&shadowed, 1e-2, &format!("{self_shadow:?}"));
    }
}

#[test]
fn marches_behind_a_pane_are_counted_once_whatever_else_is_shown() {
    let mut builder = Builder::lit(view_camera([0.0, 2.2, 1.6], [0.0; 3], 50.0, SIDE, SIDE));
    builder.add(render_mesh(&meshes::plane(2)), in_relief(waves(64, 0.05)), scaled(2.0, [0.0; 3]));
    let mut pane = material([0.2, 0.5, 0.9], None);
    (pane.alpha, pane.base_color_factor[3]) = (RenderAlpha::Blend, 0.4);
    builder.add(render_mesh(&meshes::plane(1)), pane, scaled(0.8, [0.0, 0.4, 0.0]));
    let scene = lit_by([0.3, 1.0, 0.1], builder);
    let counters = |image: ImageSet| image.counters.expect("counters");
    let all = counters(render(&scene, SIDE, SIDE));
    let bare = RenderScene { aovs: Vec::new(), ..scene.clone() };
    assert_eq!(counters(render(&bare, SIDE, SIDE)), all);
    let mut shifted = scene.clone();
    shifted.relief.method = Method::Parallax;
    shifted.materials[0].alpha = RenderAlpha::Mask { cutoff: 0.5 };
    for scene in [scene, shifted] {
        let [found, twin] =
            [render(&scene, SIDE, SIDE), reference(&scene, SIDE, SIDE)].map(|image| counters(image).rays);
        assert!(found.abs_diff(twin) * 500 < found, "{found} rays, {twin} of the twin");
    }
}
