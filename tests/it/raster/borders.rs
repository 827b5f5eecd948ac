//! Relief at the borders of charts: against fine triangles, and nothing of what lies beside a chart on the map.

use std::sync::Arc;

use displace_glsl::methods::{METHODS, Method};
use displace_server::domain::{
    image::{HeightMap, ImageSet, RenderLight, RenderMaterial, RenderMesh, RenderRelief, RenderScene, SelfShadow},
    request::Aov,
};

use super::{
    differing, reference, render,
    scenes::{Builder, IDENTITY, LEAK, material, view_camera},
};

const SIDE: u32 = 128;
const TEXELS: u32 = 64;
const MAP_FROM_UV: [[f32; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// Of texel (x, y).
fn map(height: impl Fn(u32, u32) -> f32) -> HeightMap {
    let heights = (0..TEXELS * TEXELS).map(|i| height(i % TEXELS, i / TEXELS)).collect();
    HeightMap { width: TEXELS, height: TEXELS, heights, repeats: [true; 2], thinnest_texels: 4.0 }
}

/// From -0.08 to 0.12.
fn hills(x: u32, y: u32) -> f32 {
    let turn = |i: u32| (i as f32 + 0.5) / TEXELS as f32 * std::f32::consts::TAU;
    0.02 + 0.1 * (3.0 * turn(x) + 0.4).sin() * (2.0 * turn(y)).cos()
}

fn height_at(map: &HeightMap, [u, v]: [f64; 2]) -> f64 {
    let n = i64::from(TEXELS);
    let (x, y) = (u * n as f64 - 0.5, v * n as f64 - 0.5);
    let at = |i: i64, j: i64| f64::from(map.heights[(j.rem_euclid(n) * n + i.rem_euclid(n)) as usize]);
    let mix = |a: f64, b: f64, t: f64| a + (b - a) * t;
    let (i, j) = (x.floor() as i64, y.floor() as i64);
    let row = |j: i64| mix(at(i, j), at(i + 1, j), x - x.floor());
    mix(row(j), row(j + 1), y - y.floor())
}

/// A surface over the unit square: position and unit normal.
type Surface = fn(f64, f64) -> ([f64; 3], [f64; 3]);

/// A square of side 2 that faces up, v towards the viewer.
fn lying(u: f64, v: f64) -> ([f64; 3], [f64; 3]) {
    ([2.0 * u - 1.0, 0.0, 2.0 * v - 1.0], [0.0, 1.0, 0.0])
}

/// Around the y axis; once round is where it began, but for the rounding of sin(2 pi).
fn around(u: f64, v: f64) -> ([f64; 3], [f64; 3]) {
    let angle = u * std::f64::consts::TAU;
    let (x, z) = (angle.cos(), angle.sin());
    ([0.8 * x, 1.0 - 2.0 * v, 0.8 * z], [x, 0.0, z])
}

/// In so many columns and rows, moved by the heights where there are any.
fn grid(
    [columns, rows]: [u32; 2],
    surface: Surface,
    uv: fn(f64, f64) -> [f64; 2],
    heights: Option<&HeightMap>,
) -> RenderMesh {
    let mut mesh = RenderMesh::default();
    let (mut positions, mut normals, mut uvs, mut triangles) = (vec![], vec![], vec![], vec![]);
    for k in 0..(columns + 1) * (rows + 1) {
        let (u, v) =
            (f64::from(k % (columns + 1)) / f64::from(columns), f64::from(k / (columns + 1)) / f64::from(rows));
        let (position, normal) = surface(u, v);
        let lift = heights.map_or(0.0, |map| height_at(map, uv(u, v)));
        positions.push([0, 1, 2].map(|i| (position[i] + lift * normal[i]) as f32));
        normals.push(normal.map(|x| x as f32));
        uvs.push(uv(u, v).map(|x| x as f32));
    }
    for k in 0..columns * rows {
        let a = k / columns * (columns + 1) + k % columns;
        let (b, c, d) = (a + 1, a + columns + 2, a + columns + 1);
        triangles.extend([[a, d, c], [a, c, b]]);
    }
    (mesh.positions, mesh.normals) = (Arc::new(positions), Arc::new(normals));
    (mesh.uvs, mesh.triangles) = (Arc::new(uvs), Arc::new(triangles));
    mesh
}

fn relief(map: &HeightMap) -> RenderMaterial {
    let mut made = RenderMaterial { double_sided: false, ..material([1.0; 3], None) };
    made.relief = Some(RenderRelief { map: Arc::new(map.clone()), uv_channel: 0, map_from_uv: MAP_FROM_UV, steps: 0 });
    made
}

/// Unlit, coloured by where on the surface it is: red along, green across.
fn tinted(mut mesh: RenderMesh, places: &[[f64; 2]]) -> RenderMesh {
    mesh.colors =
        Arc::new(places.iter().map(|[u, v]| [0.1 + 0.8 * *u as f32, 0.1 + 0.8 * *v as f32, 0.5, 1.0]).collect());
    mesh
}

fn places([columns, rows]: [u32; 2]) -> Vec<[f64; 2]> {
    let place =
        |k: u32| [f64::from(k % (columns + 1)) / f64::from(columns), f64::from(k / (columns + 1)) / f64::from(rows)];
    (0..(columns + 1) * (rows + 1)).map(place).collect()
}

/// A base in relief, the same as fine triangles, coloured by their vertices, and without heights.
struct Pair {
    base: RenderScene,
    truth: RenderScene,
    flat: RenderScene,
}

fn pair(eye: [f32; 3], size: [u32; 2], surface: Surface, uv: fn(f64, f64) -> [f64; 2], map: &HeightMap) -> Pair {
    let scene = |mesh: RenderMesh, material: RenderMaterial| {
        let mut builder = Builder::unlit(view_camera(eye, [0.0; 3], 45.0, SIDE, SIDE));
        builder.add(mesh, material, IDENTITY);
        let mut scene = builder.finish();
        scene.relief.method = Method::Exact;
        scene.aovs = vec![Aov::Depth, Aov::Position];
        scene
    };
    let fine = size.map(|n| n * (256 / n));
    let base = tinted(grid(size, surface, uv, None), &places(size));
    let moved = tinted(grid(fine, surface, uv, Some(map)), &places(fine));
    let plain = RenderMaterial { double_sided: false, ..material([1.0; 3], None) };
    Pair { base: scene(base.clone(), relief(map)), truth: scene(moved, plain.clone()), flat: scene(base, plain) }
}

fn covered(image: &ImageSet) -> Vec<bool> {
    image.color.iter().map(|c| c[2] < 0.5 * LEAK).collect()
}

/// Pixels of the second image, of those that the base covers, that are farther than one from where the first is covered as they are.
fn farther_than_a_pixel(image: &ImageSet, truth: &ImageSet, flat: &ImageSet) -> usize {
    let (seen, expected, width) = (covered(image), covered(truth), SIDE as usize);
    let near = |i: usize| {
        let steps = [0, 1, width - 1, width, width + 1];
        steps.iter().any(|d| seen.get(i + d) == Some(&expected[i]) || i >= *d && seen[i - d] == expected[i])
    };
    let inside = covered(flat);
    (0..seen.len()).filter(|i| inside[*i] && !near(*i)).count()
}

/// Mean over pixels that both cover.
fn colors_apart(image: &ImageSet, truth: &ImageSet) -> f64 {
    let both: Vec<usize> = (0..truth.color.len()).filter(|i| covered(image)[*i] && covered(truth)[*i]).collect();
    let apart = |i: &usize| (0..3).map(|c| f64::from((image.color[*i][c] - truth.color[*i][c]).abs())).sum::<f64>();
    both.iter().map(apart).sum::<f64>() / both.len() as f64
}

fn once(u: f64, v: f64) -> [f64; 2] {
    [u, v]
}

/// There and back.
fn mirrored(u: f64, v: f64) -> [f64; 2] {
    [1.0 - (2.0 * u - 1.0).abs(), v]
}

/// Pixels off the outline, how far colours are apart, and how far those of a base without heights are.
fn off(Pair { base, truth, flat }: &Pair) -> (usize, f64, f64) {
    let [image, truth, flat] = [base, truth, flat].map(|scene| render(scene, SIDE, SIDE));
    (farther_than_a_pixel(&image, &truth, &flat), colors_apart(&image, &truth), colors_apart(&flat, &truth))
}

/// Below the base, so that nothing of it is beyond the base's outline but towards the viewer.
fn carved() -> HeightMap {
    map(|x, y| hills(x, y) - 0.12)
}

#[test]
fn a_sheet_ends_where_fine_triangles_do_and_shows_their_colours() {
    for eye in [[0.4, 1.3, 2.0], [-2.0, 0.8, -0.9]] {
        for size in [[1, 1], [4, 2]] {
            let (pixels, apart, flat) = off(&pair(eye, size, lying, once, &carved()));
            println!("{eye:?} {size:?}: {pixels} {apart} {flat}");
            assert!(pixels == 0 && apart < 0.025 && flat > 3.0 * apart, "{eye:?} {size:?}: {pixels}, {apart}, {flat}");
        }
    }
}

/// So far along a map that repeats that f32 tells hardly a sixteenth of a texel.
fn far_along(u: f64, v: f64) -> [f64; 2] {
    [u + 1024.0, v - 2048.0]
}

#[test]
fn a_sheet_ends_where_it_does_however_many_turns_of_the_map_lie_before_it() {
    for (eye, map) in [([-2.0, 0.8, -0.9], carved()), ([0.4, 1.3, 2.0], map(hills))] {
        let [near, far] =
            [once, far_along].map(|uv| covered(&render(&pair(eye, [4, 2], lying, uv, &map).base, SIDE, SIDE)));
        let apart = near.iter().zip(&far).filter(|(near, far)| near != far).count();
        assert!(apart <= 4, "{eye:?}: {apart} pixels");
    }
}

#[test]
fn a_mirrored_sheet_shows_what_fine_triangles_do() {
    for size in [[2, 1], [8, 4]] {
        for map in [carved(), map(hills)] {
            let (pixels, apart, flat) = off(&pair([0.2, 0.9, 2.0], size, lying, mirrored, &map));
            println!("{size:?}: {pixels} {apart} {flat}");
            assert!(pixels == 0 && apart < 0.025 && flat > 3.0 * apart, "{size:?}: {pixels}, {apart}, {flat}");
        }
    }
}

/// The same, cut open on the other side.
fn around_from_behind(u: f64, v: f64) -> ([f64; 3], [f64; 3]) {
    around(u + 0.5, v)
}

#[test]
fn a_cylinder_looks_the_same_wherever_it_is_cut_open() {
    let heights = map(hills);
    let image = |surface: Surface, uv: fn(f64, f64) -> [f64; 2]| {
        let made = pair([3.0, 0.6, 0.2], [32, 4], surface, uv, &heights);
        render(&made.base, SIDE, SIDE)
    };
    let (before, behind) = (image(around, once), image(around_from_behind, |u, v| [u + 0.5, v]));
    let depths = |image: &ImageSet| image.depth.clone().expect("depths");
    let apart = |(a, b): (&f32, &f32)| (a.is_finite() || b.is_finite()) && (a - b).abs() > 1e-3;
    let count = depths(&before).iter().zip(&depths(&behind)).filter(|pair| apart(*pair)).count();
    assert!(count <= 16, "{count} pixels");
}

/// A square with half of the map.
fn atlas(map: &HeightMap) -> RenderScene {
    let mut builder = Builder::lit(view_camera([0.3, 0.9, 2.2], [0.0; 3], 50.0, SIDE, SIDE));
    builder.add(grid([3, 3], lying, |u, v| [0.5 * u, v], None), relief(map), IDENTITY);
    let mut scene = builder.finish();
    scene.lighting.lights = vec![RenderLight::sun([0.8, 0.36, 0.48])];
    scene
}

#[test]
fn nothing_of_another_chart_of_the_map_is_read() {
    // The texel beside the chart belongs to both: heights are bilinear.
    let other = |height: f32| map(move |x, y| if x <= TEXELS / 2 || x == TEXELS - 1 { hills(x, y) } else { height });
    // Cones know of heights nearby: the steps they allow differ.
    for row in METHODS.iter().filter(|row| row.marcher.is_some() && row.method != Method::Cone) {
        for self_shadow in [SelfShadow::None, SelfShadow::Hard] {
            let image = |height: f32| {
                let mut scene = atlas(&other(height));
                scene.relief.method = row.method;
                let is_parallax = row.marcher.as_ref().is_some_and(|marcher| !marcher.finds_depth);
                scene.relief.self_shadow = if is_parallax { SelfShadow::None } else { self_shadow };
                render(&scene, SIDE, SIDE)
            };
            assert!(image(0.1).color == image(-0.07).color, "{} {self_shadow:?}", row.name);
        }
    }
}

#[test]
fn borders_seams_and_bends_are_those_of_the_twins() {
    let hills = map(hills);
    let carved = carved();
    for row in METHODS.iter().filter(|row| row.marcher.is_some()) {
        for (name, Pair { base: mut scene, .. }) in [
            ("sheet", pair([0.4, 1.3, 2.0], [2, 2], lying, once, &carved)),
            ("mirrored", pair([0.2, 0.9, 2.0], [2, 1], lying, mirrored, &hills)),
            ("cylinder", pair([3.0, 0.6, 0.2], [16, 4], around, once, &hills)),
            ("seams", pair([3.0, 0.6, 0.2], [4, 4], around, |u, v| [0.7 * u, v], &hills)),
        ] {
            scene.relief.method = row.method;
            scene.lighting.lights = vec![RenderLight::point([0.5, 1.5, 1.0])];
            let apart = differing(&render(&scene, 96, 96), &reference(&scene, 96, 96), 1e-2);
            assert!(apart <= 92, "{} {name}: {apart} pixels", row.name);
        }
    }
}
