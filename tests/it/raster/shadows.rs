//! Shadow maps against their twin, against rays, and where no shadow may be: acne and leaks; and balls of light against
//! theirs, and against the image oracle.

use std::sync::Arc;

use displace_glsl::layout::raster::MAP_BASE_COLOR;
use displace_server::{
    domain::{
        cancel::{Cancel, NoProgress},
        image::{ImageSet, LightShape, Lighting, RenderAlpha, RenderLight, RenderMaterial, RenderScene, Shading},
        request::Shadows,
    },
    oracle::image::{Exposure, OracleScene, render as trace},
};
use displace_tests::meshes;

use super::{
    differing,
    looks::still_life,
    reference, render,
    scenes::{Builder, IDENTITY, checker, render_mesh, view_camera},
};

fn shaded(scene: &RenderScene, shadows: Shadows) -> ImageSet {
    render(&RenderScene { shadows, ..scene.clone() }, 96, 96)
}

/// With nothing but these lights.
fn lit_by(scene: RenderScene, lights: Vec<RenderLight>) -> RenderScene {
    let lighting = Lighting { lights, ambient: 0.0, background: [0.0; 3], environment: None };
    RenderScene { lighting, ..scene }
}

/// Pixels whose shares of the light, of what arrives without shadows, are farther apart than a half; and all that are lit.
fn apart(open: &ImageSet, a: &ImageSet, b: &ImageSet) -> (usize, usize) {
    let sum = |image: &ImageSet, i: usize| image.color[i][..3].iter().sum::<f32>();
    let lit: Vec<usize> = (0..open.color.len()).filter(|i| sum(open, *i) > 1e-3).collect();
    let share = |image: &ImageSet, i: usize| sum(image, i) / sum(open, i);
    (lit.iter().filter(|i| (share(a, **i) - share(b, **i)).abs() > 0.5).count(), lit.len())
}

#[test]
fn shadow_maps_agree_with_their_twin_and_with_rays() {
    let scene = still_life();
    let mapped = shaded(&scene, Shadows::Map);
    let twin = reference(&RenderScene { shadows: Shadows::Map, ..scene.clone() }, 96, 96);
    let off = differing(&mapped, &twin, 4e-3);
    assert!(off <= 92, "{off} pixels");
    for light in scene.lighting.lights.clone() {
        let scene = lit_by(scene.clone(), vec![light]);
        let [open, mapped, traced] = [Shadows::None, Shadows::Map, Shadows::Ray].map(|kind| shaded(&scene, kind));
        let (off, lit) = apart(&open, &mapped, &traced);
        // Facets of the ball that turn away before its normals do are in its own shadow.
        assert!(lit > 2000 && off * 100 <= lit, "{off} of {lit} under {light:?}");
    }
}

/// A plane and a ball that stands away from it, of which no point that faces the light is in shadow but those below the
/// ball.
fn ball_over_plane() -> RenderScene {
    let mut builder = Builder::lit(view_camera([0.0, 3.0, 6.0], [0.0, 0.0, 0.0], 40.0, 96, 96));
    builder.mesh(&meshes::icosphere(5), [0.8; 3]);
    let mut ground = IDENTITY;
    (ground[0], ground[10], ground[13]) = (9.0, 9.0, -1.5);
    let white = RenderMaterial { base_color_factor: [0.8, 0.8, 0.8, 1.0], ..RenderMaterial::default() };
    builder.add(render_mesh(&meshes::plane(9)), white, ground);
    builder.finish()
}

#[test]
fn a_lit_plane_and_a_lit_ball_have_no_acne() {
    let places: [LightShape; 3] = [
        LightShape::Sun { direction_world: [0.0, 0.6, 0.8] },
        LightShape::Sun { direction_world: [0.96, 0.28, 0.0] },
        LightShape::Point { position_world: [2.0, 3.0, 4.0], range_world: None },
    ];
    for shape in places {
        let scene = lit_by(ball_over_plane(), vec![RenderLight { shape, color: [3.0; 3], radius: 0.0 }]);
        let [open, mapped, traced] = [Shadows::None, Shadows::Map, Shadows::Ray].map(|kind| shaded(&scene, kind));
        let (normals, positions) =
            (open.normal.as_ref().expect("asked for"), open.position.as_ref().expect("asked for"));
        let is_lit = |i: usize| {
            let (n, p) = (normals[i], positions[i]);
            let towards = match shape {
                LightShape::Point { position_world: at, .. } => {
                    let way: [f32; 3] = std::array::from_fn(|k| at[k] - p[k]);
                    let length = way.iter().map(|x| x * x).sum::<f32>().sqrt();
                    way.map(|x| x / length)
                }
                LightShape::Sun { direction_world } => direction_world,
                LightShape::Spot { .. } => unreachable!("none of them"),
            };
            let cosine: f32 = (0..3).map(|k| n[k] * towards[k]).sum();
            // The way to the light passes the ball, with room for the window of the map.
            let along: f32 = (0..3).map(|k| -p[k] * towards[k]).sum();
            let aside: f32 = (0..3).map(|k| (p[k] + along * towards[k]).powi(2)).sum::<f32>().sqrt();
            let is_ball = p.iter().map(|x| x * x).sum::<f32>() < 1.1;
            cosine > 0.15 && (is_ball || aside > 1.2)
        };
        let around = |i: usize| [0, 1, 2, 96, 98, 192, 193, 194].map(|k| i + k - 97);
        let inside = (0..96 * 96).filter(|i| (1..95).contains(&(i / 96)) && (1..95).contains(&(i % 96)));
        // Not where the rim of the ball runs through a pixel.
        let lit: Vec<usize> = inside.filter(|i| is_lit(*i) && around(*i).into_iter().all(is_lit)).collect();
        for &i in &lit {
            assert_eq!(mapped.color[i], open.color[i], "map, pixel {i} under {shape:?}");
            assert_eq!(traced.color[i], open.color[i], "rays, pixel {i} under {shape:?}");
        }
        let lit = lit.len();
        assert!(lit > 1500, "{lit}");
    }
}

#[test]
fn no_light_comes_through_a_closed_wall() {
    // From inside of a cube of one sheet, with lights outside of it.
    let mut builder = Builder::lit(view_camera([0.35, 0.3, 0.4], [-0.25, -0.2, -0.3], 90.0, 96, 96));
    builder.mesh(&meshes::cube(), [0.8; 3]);
    let scene = builder.finish();
    let reach = scene.meshes[0].positions.iter().flatten().fold(0f32, |most, x| most.max(x.abs()));
    for light in [RenderLight::sun([0.36, 0.8, 0.48]), RenderLight::point([-1.5, 2.0, 0.7])] {
        let scene = lit_by(scene.clone(), vec![light]);
        let [open, mapped, traced] = [Shadows::None, Shadows::Map, Shadows::Ray].map(|kind| shaded(&scene, kind));
        let positions = open.position.as_ref().expect("asked for");
        let bright = open.color.iter().filter(|c| c[0] > 0.05).count();
        assert!(bright > 1000, "{bright} pixels would be lit");
        assert!(traced.color.iter().all(|c| c[0] == 0.0), "rays leak");
        for (c, p) in mapped.color.iter().zip(positions) {
            // Windows of samples near an edge of the room look past it, and so do pixels that the edge runs through.
            let walls = p.iter().filter(|x| x.abs() > reach - 0.05).count();
            assert!(c[0] == 0.0 || walls >= 2, "{c:?} at {p:?} under {light:?}");
        }
    }
}

#[test]
fn holes_of_a_fence_let_light_through_to_the_map() {
    let mut builder = Builder::lit(view_camera([0.0, 3.0, 0.01], [0.0; 3], 40.0, 96, 96));
    let mut fence = RenderMaterial { base_color_factor: [1.0; 4], double_sided: true, ..RenderMaterial::default() };
    for (alpha, height) in [(RenderAlpha::Mask { cutoff: 0.5 }, 0.5), (RenderAlpha::Blend, 0.25)] {
        fence.alpha = alpha;
        fence.maps[MAP_BASE_COLOR] = super::scenes::material([1.0; 3], Some(checker(16, 16))).maps[0].clone();
        let mut raised = IDENTITY;
        (raised[0], raised[10], raised[13]) = (0.5, 0.5, height);
        builder.add(render_mesh(&meshes::plane(1)), fence.clone(), raised);
    }
    let ground = RenderMaterial { base_color_factor: [0.5, 0.5, 0.5, 1.0], ..RenderMaterial::default() };
    builder.add(render_mesh(&meshes::plane(1)), ground, IDENTITY);
    let mut scene = lit_by(builder.finish(), vec![RenderLight::sun([0.6, 0.8, 0.0])]);
    scene.meshes.iter_mut().for_each(|mesh| mesh.colors = Arc::default());
    let [open, mapped, traced] = [Shadows::None, Shadows::Map, Shadows::Ray].map(|kind| shaded(&scene, kind));
    let (off, lit) = apart(&open, &mapped, &traced);
    let dark = traced.color.iter().zip(&open.color).filter(|(a, b)| a[0] < 0.5 * b[0]).count();
    // Windows of a texel soften edges, of which a fence has many.
    assert!(dark > 150 && off * 50 <= lit, "{off} of {lit}, {dark} in shadow");
}

/// A sun 30 degrees wide, and a ball of light.
fn wide_lights() -> Vec<RenderLight> {
    vec![
        RenderLight { radius: 0.26, ..RenderLight::sun([0.48, 0.6, 0.64]) },
        RenderLight { radius: 0.7, ..RenderLight::point([-1.5, 2.0, 1.5]) },
    ]
}

#[test]
fn lights_that_have_a_size_agree_with_their_twin() {
    for (shading, shadows) in [
        (Shading::Phong, Shadows::None),
        (Shading::Gouraud, Shadows::Ray),
        (Shading::Pbr, Shadows::Ray),
        (Shading::Phong, Shadows::Map),
    ] {
        let mut scene = RenderScene { shading, shadows, ..still_life() };
        scene.lighting.lights = wide_lights();
        let off = differing(&render(&scene, 96, 96), &reference(&scene, 96, 96), 1e-2);
        // Rounding decides one of 16 rays of a pixel in a few more places than one of one.
        assert!(off <= 200, "{off} pixels: {shading:?}, {shadows:?}");
    }
}

#[test]
fn a_ball_of_light_shines_on_what_lies_in_it() {
    let ball = RenderLight { radius: 0.5, ..RenderLight::point([1.5, -1.4, 1.5]) };
    let scene = RenderScene { shadows: Shadows::Ray, ..lit_by(ball_over_plane(), vec![ball]) };
    let (found, expected) = (render(&scene, 96, 96), reference(&scene, 96, 96));
    let off = differing(&found, &expected, 1e-2);
    assert!(off <= 100, "{off} pixels");
    let brightest = expected.color.iter().map(|c| c[0]).fold(0.0, f32::max);
    let bright = |image: &ImageSet| image.color.iter().filter(|c| c[0] > 0.5 * brightest).count();
    assert!(bright(&expected) > 20 && bright(&found) > 20, "{} {}", bright(&expected), bright(&found));
}

#[test]
fn lights_that_have_a_size_agree_with_the_oracle() {
    for (shading, shadows) in
        [(Shading::Phong, Shadows::Ray), (Shading::Phong, Shadows::None), (Shading::Pbr, Shadows::Ray)]
    {
        let mut scene = lit_by(ball_over_plane(), wide_lights());
        (scene.shading, scene.shadows, scene.aovs) = (shading, shadows, Vec::new());
        scene.materials.iter_mut().for_each(|material| material.roughness_factor = 0.6);
        let exposure = Exposure { width: 96, height: 96, samples: 64, shadows: shadows != Shadows::None };
        let expected = trace(&OracleScene::from(&scene), &exposure, &Cancel::default(), &NoProgress).expect("traces");
        let found = render(&scene, 96, 96);
        let off = |a: &[f32; 4], b: &[f32; 4]| f64::from(a[0] - b[0]);
        let pairs = || found.color.iter().zip(&expected.color);
        let mean = pairs().map(|(a, b)| off(a, b)).sum::<f64>() / 9216.0;
        let rms = (pairs().map(|(a, b)| off(a, b).powi(2)).sum::<f64>() / 9216.0).sqrt();
        let bright = pairs().map(|(_, b)| f64::from(b[0])).sum::<f64>() / 9216.0;
        // Noise of 16 directions a pixel has no mean; edges of what is seen differ by a few samples.
        assert!(mean.abs() < 3e-3 * bright && rms < 0.05 * bright, "{mean} {rms} of {bright}: {shading:?} {shadows:?}");
    }
}

#[test]
fn shadows_of_a_ball_of_light_have_a_penumbra_and_those_of_a_point_have_none() {
    let widths = [0.0, 0.7].map(|radius| {
        let light = RenderLight { radius, ..RenderLight::point([0.0, 4.0, 0.0]) };
        let scene = lit_by(ball_over_plane(), vec![light]);
        let [open, shaded] = [Shadows::None, Shadows::Ray].map(|kind| shaded(&scene, kind));
        let share = |(a, b): (&[f32; 4], &[f32; 4])| a[0] / b[0].max(1e-6);
        shaded.color.iter().zip(&open.color).map(share).filter(|share| (0.1..0.9).contains(share)).count()
    });
    assert!(widths[1] > 4 * widths[0] && widths[1] > 300, "{widths:?}");
}
