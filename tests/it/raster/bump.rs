//! Bent normals: the device against the twins, and both against surfaces whose normals are known in closed form.

use std::{f64::consts::TAU, sync::Arc};

use displace_glsl::layout::{
    bump::BUMP_SLOTS,
    raster::{MAP_DETAIL, MAP_NORMAL},
};
use displace_server::domain::{
    detail::Wrap,
    expression::Program,
    image::{
        BumpKind, BumpUse, ColorMap, Filter, ImageSet, RenderFormula, RenderMap, RenderMaterial, RenderMesh,
        RenderScene,
    },
    weld::mikk_tangents,
};
use displace_tests::meshes::{self, TestMesh};
use glam::{DVec2, DVec3};

use super::{
    reference, render,
    scenes::{Builder, IDENTITY, render_mesh, view_camera},
};

const SIDE: u32 = 96;
const AS_IT_IS: [[f32; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

fn grey() -> RenderMaterial {
    RenderMaterial { base_color_factor: [0.7, 0.7, 0.7, 1.0], ..RenderMaterial::default() }
}

fn map(side: u32, texel: impl Fn(DVec2) -> DVec3) -> Arc<ColorMap> {
    let place = |i: u32| (f64::from(i) + 0.5) / f64::from(side);
    let texel = |i: u32| texel(DVec2::new(place(i % side), place(i / side))).extend(1.0).as_vec4().to_array();
    Arc::new(ColorMap { width: side, height: side, texels: (0..side * side).map(texel).collect() })
}

fn with_map(mut material: RenderMaterial, slot: usize, kind: BumpKind, map: &Arc<ColorMap>) -> RenderMaterial {
    let map = Arc::clone(map);
    material.maps[MAP_DETAIL + slot] =
        Some(RenderMap { map, uv_channel: 0, map_from_uv: AS_IT_IS, wrap: [Wrap::Repeat; 2] });
    material.bump.uses[slot] = BumpUse { kind, scale: 1.0 };
    material
}

fn with_formula(mut material: RenderMaterial, source: &str, scale: f32) -> RenderMaterial {
    let program = Arc::new(Program::parse(source).expect("a formula"));
    material.bump.formulas.push(RenderFormula { program, scale, uv_channel: 0, map_from_uv: AS_IT_IS });
    material
}

/// With MikkTSpace's tangents.
fn framed(mesh: &TestMesh) -> RenderMesh {
    let (p, n, uv) = (&mesh.positions, &mesh.normals, &mesh.uvs);
    let tangents =
        mikk_tangents(&mesh.triangles, |v| p[v as usize], |v| n[v as usize], |v| uv[v as usize]).expect("tangents");
    RenderMesh { tangents: Arc::new(tangents), ..render_mesh(mesh) }
}

fn scene(mesh: RenderMesh, material: RenderMaterial, eye: [f32; 3]) -> RenderScene {
    let mut builder = Builder::lit(view_camera(eye, [0.0; 3], 35.0, SIDE, SIDE));
    builder.add(mesh, material, IDENTITY);
    builder.finish()
}

/// Place, normal and texture coordinates of each pixel that sees something.
fn seen(image: &ImageSet) -> Vec<(DVec3, DVec3, DVec2)> {
    let wide = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
    let (places, normals, uvs) = (image.position.as_ref(), image.normal.as_ref(), image.uv.as_ref());
    let (places, normals, uvs) = (places.expect("asked for"), normals.expect("asked for"), uvs.expect("asked for"));
    let all = (0..places.len()).map(|i| (wide(places[i]), wide(normals[i]), DVec2::from(uvs[i].map(f64::from))));
    all.filter(|(_, normal, _)| *normal != DVec3::ZERO).collect()
}

fn degrees(a: DVec3, b: DVec3) -> f64 {
    a.cross(b).length().atan2(a.dot(b)).to_degrees()
}

/// Largest angle between the normals seen and those expected of place and coordinates.
fn most_apart(image: &ImageSet, expected: impl Fn(DVec3, DVec2) -> DVec3) -> f64 {
    let seen = seen(image);
    assert!(seen.len() > 2000, "{} pixels see something", seen.len());
    seen.into_iter().map(|(place, normal, uv)| degrees(normal, expected(place, uv))).fold(0.0, f64::max)
}

const ABOVE: [f32; 3] = [0.1, 1.6, 0.2];

/// Every kind of slope together, on a ball whose own normal map bends as well, seen on both sides.
#[test]
fn bent_normals_agree_with_their_twins() {
    let wave = |f: f64, g: f64| {
        map(16, move |uv| DVec3::new((f * TAU * uv.x).sin(), (g * TAU * uv.y).cos(), 0.0) * 0.4 + DVec3::Z)
    };
    let mut material = RenderMaterial { double_sided: true, normal_scale: 0.5, ..grey() };
    for (slot, kind) in
        [BumpKind::Height, BumpKind::Tangent, BumpKind::Object, BumpKind::CySlice].into_iter().enumerate()
    {
        material = with_map(material, slot, kind, &wave(1.0 + slot as f64, 2.0));
        material.bump.uses[slot].scale = 0.1 + 0.05 * slot as f32;
    }
    material = with_formula(material, "sin(9*x + 4*ny) * cos(5*u)", 0.05);
    material = with_formula(material, "noise(4*x, 4*y, 4*z)", 0.1);
    let own = wave(3.0, 1.0);
    material.maps[MAP_NORMAL] =
        Some(RenderMap { map: own, uv_channel: 0, map_from_uv: AS_IT_IS, wrap: [Wrap::Repeat; 2] });
    let mut uneven = IDENTITY;
    (uneven[0], uneven[5], uneven[10]) = (-0.8, 1.2, 1.0);
    for faceted in [false, true] {
        material.bump.faceted = faceted;
        let mut builder = Builder::lit(view_camera([0.4, 1.2, 3.0], [0.0; 3], 45.0, SIDE, SIDE));
        let mut open = meshes::uv_sphere(24, 12);
        open.triangles.retain(|t| t.iter().all(|&v| open.positions[v as usize][1] < 0.6));
        builder.add(framed(&open), material.clone(), uneven);
        let scene = builder.finish();
        let (image, expected) = (render(&scene, SIDE, SIDE), reference(&scene, SIDE, SIDE));
        let pairs: Vec<_> = seen(&image).into_iter().zip(seen(&expected)).collect();
        let apart = pairs.iter().filter(|((_, a, _), (_, b, _))| (*a - *b).length() > 2e-3).count();
        assert!(pairs.len() > 3000 && apart * 100 <= pairs.len(), "faceted {faceted}: {apart} of {}", pairs.len());
        let smooth = seen(&render(&smoothed(&scene), SIDE, SIDE));
        let bent = pairs.iter().zip(&smooth).filter(|(((_, a, _), _), (_, b, _))| degrees(*a, *b) > 2.0).count();
        assert!(bent * 2 > pairs.len(), "faceted {faceted}: {bent} of {} are bent", pairs.len());
    }
}

fn smoothed(scene: &RenderScene) -> RenderScene {
    let mut scene = scene.clone();
    for material in &mut scene.materials {
        material.bump = Default::default();
        material.maps[MAP_NORMAL] = None;
    }
    scene
}

#[test]
fn a_sine_over_a_plane_is_shaded_as_if_it_were_displaced() {
    let material = with_formula(grey(), "sin(2*pi*3*u)", 0.05);
    let image = render(&scene(render_mesh(&meshes::plane(3)), material, ABOVE), SIDE, SIDE);
    let apart = most_apart(&image, |_, uv| DVec3::new(-0.05 * TAU * 3.0 * (TAU * 3.0 * uv.x).cos(), 1.0, 0.0));
    assert!(apart < 0.01, "{apart} degrees");
}

/// Slopes between texels are those of the texels: a map of n texels a period errs by (tau / n)^2 / 8 of the steepest.
#[test]
fn a_map_of_slopes_bends_as_the_heights_it_was_made_of() {
    let slope = |u: f64| 0.05 * TAU * 3.0 * (TAU * 3.0 * u).cos();
    let slopes = map(192, |uv| DVec3::new(slope(uv.x), 0.0, 0.0));
    let material = with_map(grey(), 0, BumpKind::Height, &slopes);
    let scene = RenderScene { filter: Filter::Bilinear, ..scene(render_mesh(&meshes::plane(3)), material, ABOVE) };
    let image = render(&scene, SIDE, SIDE);
    let bound = (0.05 * TAU * 3.0 * (TAU / 64.0).powi(2) / 8.0).to_degrees();
    let apart = most_apart(&image, |_, uv| DVec3::new(-slope(uv.x), 1.0, 0.0));
    assert!(apart < bound + 0.01, "{apart} of {bound} degrees");
}

/// H = a sin(k x) at a place of the unit sphere, its gradient along it, and the normals that follow.
fn waves(place: DVec3, a: f64, k: f64) -> (f64, DVec3, DVec3) {
    let n = place.normalize();
    let height = a * (k * n.x).sin();
    let along = DVec3::X - n * n.x;
    let gradient = a * k * (k * n.x).cos() * along;
    (height, n - gradient, (1.0 + height) * n - gradient)
}

#[test]
fn bump_on_a_sphere_errs_by_no_more_than_height_times_curvature() {
    let (a, k) = (0.1, 8.0);
    let material = with_formula(grey(), "sin(8*x)", a as f32);
    let image = render(&scene(render_mesh(&meshes::icosphere(6)), material, [0.5, 0.8, 3.5]), SIDE, SIDE);
    // The formula is read along facets that lie up to 0.6 degrees askew: its slopes of 0.8 are off by 0.8 of that.
    let own = most_apart(&image, |place, _| waves(place, a, k).1);
    assert!(own < 0.5, "{own} degrees from Blinn's normal");
    let excess = |(place, normal, _): (DVec3, DVec3, DVec2)| {
        let (height, _, displaced) = waves(place, a, k);
        degrees(normal, displaced) - (height.abs() / (2.0 - height.abs())).asin().to_degrees()
    };
    let excess = seen(&image).into_iter().map(excess).fold(f64::MIN, f64::max);
    assert!(excess < 0.5, "{excess} degrees above the bound");
    let apart = most_apart(&image, |place, _| waves(place, a, k).2);
    assert!(apart > 1.5, "what is left out shows: {apart} degrees");
}

fn brightness(image: &ImageSet) -> Vec<f64> {
    image.color.iter().map(|c| f64::from(c[0])).collect()
}

fn correlation(a: &[f64], b: &[f64]) -> f64 {
    let mean = |x: &[f64]| x.iter().sum::<f64>() / x.len() as f64;
    let (ma, mb) = (mean(a), mean(b));
    let product =
        |x: &[f64], mx: f64, y: &[f64], my: f64| x.iter().zip(y).map(|(p, q)| (p - mx) * (q - my)).sum::<f64>();
    product(a, ma, b, mb) / (product(a, ma, a, ma) * product(b, mb, b, mb)).sqrt()
}

/// One sign for both, + along the outward normal; West's displacement prints the other one.
#[test]
fn bump_and_displacement_are_light_in_the_same_places() {
    let (a, k, eye) = (0.03, 16.0, [0.5, 0.8, 3.5]);
    let ball = meshes::icosphere(6);
    let moved = |sign: f64| {
        let mut mesh = ball.clone();
        for (p, n) in mesh.positions.iter_mut().zip(&mut mesh.normals) {
            let place = DVec3::from_array(p.map(f64::from));
            let (height, _, normal) = waves(place, sign * a, k);
            *p = (place * (1.0 + height)).as_vec3().to_array();
            *n = normal.normalize().as_vec3().to_array();
        }
        render_mesh(&mesh)
    };
    let smooth = brightness(&render(&scene(render_mesh(&ball), grey(), eye), SIDE, SIDE));
    let relief = |mesh: RenderMesh, material: RenderMaterial| -> Vec<f64> {
        let shaded = brightness(&render(&scene(mesh, material, eye), SIDE, SIDE));
        shaded.iter().zip(&smooth).map(|(a, b)| a - b).collect()
    };
    let bumped = relief(render_mesh(&ball), with_formula(grey(), "sin(16*x)", a as f32));
    let out = correlation(&bumped, &relief(moved(1.0), grey()));
    let inwards = correlation(&bumped, &relief(moved(-1.0), grey()));
    assert!(out > 0.8 && inwards < -0.4, "{out} out, {inwards} in");
}

/// Seen from the side where the map turns round: what is left of the seam mirrors what is right of it, but for the
/// diagonals of the mesh's quads: the median angle between both.
fn mirrored_pairs(kind: BumpKind) -> f64 {
    let value = |uv: DVec2| DVec3::new(0.3 * (TAU * 4.0 * uv.x).sin(), 0.3 * (TAU * 3.0 * uv.y).cos(), 0.9);
    let material = with_map(grey(), 0, kind, &map(128, value));
    let image = render(&scene(framed(&meshes::mirrored_uv_sphere(48, 24)), material, [3.5, 0.0, 0.0]), SIDE, SIDE);
    let normals = image.normal.as_ref().expect("asked for");
    let at = |x: u32, y: u32| DVec3::from_array(normals[(y * SIDE + x) as usize].map(f64::from));
    let pair = |(x, y): (u32, u32)| (at(x, y), at(SIDE - 1 - x, y) * DVec3::new(1.0, 1.0, -1.0));
    let pairs = (0..SIDE).flat_map(|y| (0..SIDE / 2).map(move |x| (x, y))).map(pair);
    let mut apart: Vec<f64> =
        pairs.filter(|(a, b)| *a != DVec3::ZERO && *b != DVec3::ZERO).map(|(a, b)| degrees(a, b)).collect();
    assert!(apart.len() > 1500, "{} pairs", apart.len());
    apart.sort_by(f64::total_cmp);
    apart[apart.len() / 2]
}

#[test]
fn mirrored_uvs_show_no_seam_but_in_the_frame_that_cyslice_prints() {
    for kind in [BumpKind::Height, BumpKind::Tangent] {
        let apart = mirrored_pairs(kind);
        assert!(apart < 0.4, "{kind:?}: {apart} degrees");
    }
    let printed = mirrored_pairs(BumpKind::CySlice);
    assert!(printed > 10.0, "green is inverted on one side: {printed} degrees");
}

/// A plane, or the same bent round the z axis, and the frame of its texture there: tangent, bitangent up, normal.
fn sheet(curvature: f32) -> TestMesh {
    let mut mesh = meshes::plane(24);
    if curvature == 0.0 {
        return mesh;
    }
    for (p, n) in mesh.positions.iter_mut().zip(&mut mesh.normals) {
        let (sin, cos) = (curvature * p[0]).sin_cos();
        (p[0], p[1]) = (sin / curvature, (cos - 1.0) / curvature);
        *n = [sin, cos, 0.0];
    }
    mesh
}

/// CySlice's reason for texture space: "object space normal maps are invalidated once the object changes shape".
#[test]
fn object_space_breaks_when_the_mesh_bends_and_tangent_space_does_not() {
    let value = |uv: DVec2| DVec3::new(0.4 * (TAU * 3.0 * uv.x).sin(), 0.4 * (TAU * 3.0 * uv.y).cos(), 1.0).normalize();
    // Of the plane: x along the tangent, -z along the bitangent, y along the normal.
    let in_object = |uv: DVec2| {
        let m = value(uv);
        DVec3::new(m.x, m.z, -m.y)
    };
    let spaces = [(BumpKind::Tangent, map(128, value)), (BumpKind::Object, map(128, in_object))];
    let image = |curvature: f32, (kind, map): &(BumpKind, Arc<ColorMap>)| {
        render(&scene(framed(&sheet(curvature)), with_map(grey(), 0, *kind, map), ABOVE), SIDE, SIDE)
    };
    let at_rest: Vec<_> = spaces.iter().map(|space| seen(&image(0.0, space))).collect();
    let apart = at_rest[0].iter().zip(&at_rest[1]).map(|(a, b)| degrees(a.1, b.1)).fold(0.0, f64::max);
    assert!(apart < 0.05, "at rest the two are {apart} degrees apart");
    let curvature = 2.0;
    let truth = |place: DVec3, uv: DVec2| {
        let (m, turn) = (value(uv), (f64::from(curvature) * place.x).asin());
        let (sin, cos) = turn.sin_cos();
        m.x * DVec3::new(cos, -sin, 0.0) - m.y * DVec3::Z + m.z * DVec3::new(sin, cos, 0.0)
    };
    let mean = |space| {
        let seen = seen(&image(curvature, space));
        seen.iter().map(|(place, normal, uv)| degrees(*normal, truth(*place, *uv))).sum::<f64>() / seen.len() as f64
    };
    let [tangent, object] = [&spaces[0], &spaces[1]].map(mean);
    assert!(tangent < 0.5 && object > 15.0, "tangent space {tangent}, object space {object} degrees in the mean");
}

#[test]
fn every_slot_bends() {
    let slopes = map(4, |_| DVec3::new(0.25, 0.0, 0.0));
    let all = (0..BUMP_SLOTS).fold(grey(), |material, slot| with_map(material, slot, BumpKind::Height, &slopes));
    let image = render(&scene(render_mesh(&meshes::plane(3)), all, ABOVE), SIDE, SIDE);
    let apart = most_apart(&image, |_, _| DVec3::new(-1.0, 1.0, 0.0));
    assert!(apart < 0.001, "{apart} degrees");
}
