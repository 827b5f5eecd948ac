//! A flat base whose heights are shown per pixel, against the same heights as fine triangles, by the same renderer.

use std::sync::Arc;

use displace_glsl::{layout::raster::MAP_BASE_COLOR, methods::Method, reference::relief::HeightLevel};
use glam::DVec2;

use crate::{
    domain::{
        camera::render_camera,
        cancel::{Cancel, NoProgress},
        detail::Wrap,
        image::{
            ColorMap, Filter, HeightMap, ImagePlan, ImageSet, LightShape, Lighting, ReliefSettings, RenderInstance,
            RenderLight, RenderMap, RenderMaterial, RenderMesh, RenderRelief, RenderScene, SelfShadow, Shading,
            Silhouettes,
        },
        request::{Aov, CameraChoice, Shadows},
        scene::Scene,
    },
    render::{JobContext, reference_image},
};

const SIDE_PX: u32 = 48;
const TEXELS: u32 = 16;
/// Of the fine triangles, for each texel.
const FINE: u32 = 4;
const IDENTITY: [f32; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
const MAP_FROM_UV: [[f32; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// Waves from -0.15 to 0.15 that tile.
fn heights() -> HeightMap {
    let turn = |i: u32| f64::from(i) / f64::from(TEXELS) * std::f64::consts::TAU;
    let height = |i: u32| 0.15 * (turn(i % TEXELS) * 2.0).sin() * (turn(i / TEXELS) + 0.4).cos();
    HeightMap {
        width: TEXELS,
        height: TEXELS,
        heights: (0..TEXELS * TEXELS).map(|i| height(i) as f32).collect(),
        repeats: [true; 2],
        thinnest_texels: 2.0,
    }
}

/// z = 0, from -2 to 2 along x and y, in so many squares a side; the map lies on it once.
fn grid(squares: u32, height: impl Fn(DVec2) -> f64) -> RenderMesh {
    let uv = |i: u32| [i % (squares + 1), i / (squares + 1)].map(|k| f64::from(k) / f64::from(squares));
    let vertices = (squares + 1).pow(2);
    let position = |i: u32| {
        let [u, v] = uv(i);
        [4.0 * u - 2.0, 4.0 * v - 2.0, height(DVec2::new(u, v))].map(|x| x as f32)
    };
    let square = |k: u32| {
        let a = k / squares * (squares + 1) + k % squares;
        let [b, c, d] = [a + 1, a + squares + 1, a + squares + 2];
        [[a, b, d], [a, d, c]]
    };
    RenderMesh {
        positions: Arc::new((0..vertices).map(position).collect()),
        normals: Arc::new(vec![[0.0, 0.0, 1.0]; vertices as usize]),
        uvs: Arc::new((0..vertices).map(|i| uv(i).map(|x| x as f32)).collect()),
        triangles: Arc::new((0..squares * squares).flat_map(square).collect()),
        material_of_triangles: vec![(0, 0)],
        ..RenderMesh::default()
    }
}

/// Waves of colour on 64 x 64 texels.
fn colors() -> RenderMap {
    let texel = |i: u32| {
        let [x, y] = [i % 64, i / 64].map(|k| f64::from(k) / 64.0 * std::f64::consts::TAU);
        [0.5 + 0.5 * (5.0 * x).sin(), 0.5 + 0.5 * (7.0 * y).sin(), 0.5 + 0.5 * (3.0 * (x + y)).cos(), 1.0]
            .map(|c| c as f32)
    };
    let map = ColorMap { width: 64, height: 64, texels: (0..64 * 64).map(texel).collect() };
    RenderMap { map: Arc::new(map), uv_channel: 0, map_from_uv: MAP_FROM_UV, wrap: [Wrap::Repeat; 2] }
}

fn scene(mesh: RenderMesh, unlit: bool) -> RenderScene {
    let choice = CameraChoice::LookAt { eye: [0.4, -1.2, 1.5], target: [0.0; 3], yfov_degrees: 35.0 };
    let camera = render_camera(&choice, &Scene::default(), [[-1.0; 3], [1.0; 3]], SIDE_PX, SIDE_PX).expect("a camera");
    let mut material = RenderMaterial { base_color_factor: [1.0; 4], unlit, ..RenderMaterial::default() };
    material.roughness_factor = 1.0;
    if unlit {
        material.maps[MAP_BASE_COLOR] = Some(colors());
    }
    let direction_world = [0.9, 0.1, 0.2].map(|x: f32| x / (0.81_f32 + 0.01 + 0.04).sqrt());
    let sun = RenderLight { color: [2.0; 3], shape: LightShape::Sun { direction_world }, radius: 0.0 };
    RenderScene {
        meshes: vec![mesh],
        instances: vec![RenderInstance { mesh: 0, world_from_mesh: IDENTITY, stands_for: None }],
        materials: vec![material],
        camera,
        lighting: Lighting { lights: vec![sun], ambient: 0.1, ..Lighting::default() },
        shading: Shading::Flat,
        filter: Filter::Trilinear,
        uv_channels: 1,
        aovs: vec![Aov::Depth, Aov::Position, Aov::Cost],
        ..RenderScene::default()
    }
}

fn displaced(unlit: bool) -> RenderScene {
    let map = heights();
    let level = HeightLevel { size: [TEXELS; 2], heights: map.heights, repeats: map.repeats };
    let mesh = grid(TEXELS * FINE, |uv| level.height(uv * f64::from(TEXELS) - 0.5));
    RenderScene { shadows: Shadows::Ray, ..scene(mesh, unlit) }
}

fn shown(method: Method, self_shadow: SelfShadow, unlit: bool) -> RenderScene {
    let mut scene = scene(grid(1, |_| 0.0), unlit);
    let relief = RenderRelief { map: Arc::new(heights()), uv_channel: 0, map_from_uv: MAP_FROM_UV, steps: 0 };
    scene.materials[0].relief = Some(relief);
    scene.relief = ReliefSettings { method, silhouettes: Silhouettes::None, self_shadow };
    scene
}

fn image(scene: &RenderScene) -> ImageSet {
    let job = JobContext { cancel: &Cancel::default(), progress: &NoProgress };
    let plan = ImagePlan::new(SIDE_PX, SIDE_PX, &scene.contents()).expect("a plan");
    reference_image::render(&job, &plan, scene).expect("an image").0
}

/// Mean over all pixels and channels.
fn difference(a: &ImageSet, b: &ImageSet) -> f64 {
    let of = |(a, b): (&[f32; 4], &[f32; 4])| (0..3).map(|c| f64::from((a[c] - b[c]).abs())).sum::<f64>() / 3.0;
    a.color.iter().zip(&b.color).map(of).sum::<f64>() / a.color.len() as f64
}

fn depths_apart(a: &ImageSet, b: &ImageSet) -> f64 {
    let [a, b] = [a, b].map(|images| images.depth.as_ref().expect("depths"));
    a.iter().zip(b).map(|(a, b)| f64::from((a - b).abs())).sum::<f64>() / a.len() as f64
}

/// Depths are those of places up to half a pixel apart: of small triangles that of the middle of what one covers, of relief
/// that of a sample.
#[test]
fn exact_heights_look_as_fine_triangles_do_and_are_as_far_away() {
    let truth = image(&displaced(true));
    let flat = image(&scene(grid(1, |_| 0.0), true));
    let found = image(&shown(Method::Exact, SelfShadow::None, true));
    let [color, depth] = [difference(&found, &truth), depths_apart(&found, &truth)];
    assert!(color < 0.002 && depth < 0.01, "{color} {depth}");
    assert!(difference(&flat, &truth) > 0.05 && depths_apart(&flat, &truth) > 0.05);
}

#[test]
fn hard_shadows_of_heights_fall_where_those_of_fine_triangles_do() {
    let truth = image(&displaced(false));
    let without = image(&shown(Method::Exact, SelfShadow::None, false));
    let found = image(&shown(Method::Exact, SelfShadow::Hard, false));
    let [apart, without] = [&found, &without].map(|image| difference(image, &truth));
    let soft = image(&shown(Method::Exact, SelfShadow::Soft, false));
    let sum = |image: &ImageSet| image.color.iter().map(|color| f64::from(color[0])).sum::<f64>();
    assert!(sum(&soft) < sum(&image(&shown(Method::Exact, SelfShadow::None, false))), "soft shadows take light");
    assert!(apart < 0.008 && without > 2.0 * apart, "{apart} {without}");
}

/// Heights below the base are behind it for rays towards a light, and are lit all the same.
#[test]
fn the_base_takes_no_light_from_heights_below_it() {
    let lit = shown(Method::Exact, SelfShadow::None, false);
    let shaded = RenderScene { shadows: Shadows::Ray, ..lit.clone() };
    assert_eq!(difference(&image(&lit), &image(&shaded)), 0.0);
}

#[test]
fn costs_of_pixels_add_up_to_those_of_the_image() {
    for method in [Method::Exact, Method::Steep, Method::Parallax] {
        let found = image(&shown(method, SelfShadow::None, true));
        let counters = found.counters.expect("counters");
        let costs = found.cost.expect("costs");
        let sum = |k: usize| costs.iter().map(|cost| cost[k] as u64).sum::<u64>();
        assert_eq!([sum(0), sum(1), sum(2)], [counters.fetches, counters.steps, counters.cap_hits]);
        assert!(counters.rays >= u64::from(SIDE_PX * SIDE_PX) && counters.fetches >= counters.rays, "{counters:?}");
    }
}

#[test]
fn outlines_are_refused_by_name() {
    for silhouettes in [Silhouettes::Shell, Silhouettes::Quadric] {
        let mut scene = shown(Method::Exact, SelfShadow::None, true);
        scene.relief.silhouettes = silhouettes;
        let job = JobContext { cancel: &Cancel::default(), progress: &NoProgress };
        let plan = ImagePlan::new(SIDE_PX, SIDE_PX, &scene.contents()).expect("a plan");
        let error = reference_image::render(&job, &plan, &scene).expect_err("what is not shown");
        assert_eq!(error.field.as_deref(), Some("lighting.relief.silhouettes"));
        assert!(error.message.contains("device reference"), "{}", error.message);
    }
}
