//! Maps that are projected: the device against its twins and the oracle's own formulas, and what must hold whatever the
//! scene.

use std::sync::Arc;

use displace_glsl::layout::raster::{MAP_BASE_COLOR, MAP_NORMAL};
use displace_server::domain::{
    detail::Wrap,
    image::{ColorMap, Filter, ImageSet, RenderMap, RenderMaterial, RenderScene},
    projection::{Projection, ProjectionBox},
};
use displace_tests::meshes::{self, TestMesh};
use glam::DVec3;

use super::{
    differing,
    looks::rich,
    reference, render,
    scenes::{Builder, IDENTITY, render_mesh, view_camera},
};

pub(crate) const PROJECTIONS: [Projection; 7] = [
    Projection::Sphere,
    Projection::SphereAsPrinted,
    Projection::PlanarX,
    Projection::PlanarY,
    Projection::PlanarZ,
    Projection::Box,
    Projection::Triplanar,
];
const SIDE: u32 = 96;

fn plainly(map: ColorMap) -> Option<RenderMap> {
    let map_from_uv = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
    Some(RenderMap { map: Arc::new(map), uv_channel: 0, map_from_uv, wrap: [Wrap::Repeat, Wrap::Clamp] })
}

fn map(side: u32, texel: impl Fn(f64, f64) -> [f64; 3]) -> ColorMap {
    let place = |i: u32| (f64::from(i) + 0.5) / f64::from(side);
    let texels = (0..side * side).map(|i| {
        let [r, g, b] = texel(place(i % side), place(i / side)).map(|c| c as f32);
        [r, g, b, 1.0]
    });
    ColorMap { width: side, height: side, texels: texels.collect() }
}

/// One mesh without texture coordinates, projected, showing its map as it is.
fn shown(mesh: &TestMesh, map: ColorMap, projection: Projection, eye: [f32; 3]) -> RenderScene {
    let mut builder = Builder::unlit(view_camera(eye, [0.0; 3], 40.0, SIDE, SIDE));
    let mut made = render_mesh(mesh);
    made.uvs = Arc::new(vec![[0.0; 2]; mesh.positions.len()]);
    made.projection_box = ProjectionBox::of(mesh.positions.iter().copied());
    let mut material = RenderMaterial { base_color_factor: [1.0; 4], unlit: true, ..RenderMaterial::default() };
    material.maps[MAP_BASE_COLOR] = plainly(map);
    builder.add(made, material, IDENTITY);
    RenderScene { projection, filter: Filter::Bilinear, ..builder.finish() }
}

/// A torus and a ball with every kind of map, one of them leaning and twice as high.
pub(crate) fn two_bodies(projection: Projection) -> RenderScene {
    let mut builder = Builder::lit(view_camera([1.5, 1.6, 3.0], [0.0, 0.0, 0.0], 45.0, SIDE, SIDE));
    for (mesh, leaning) in [(meshes::torus(48, 24), false), (meshes::uv_sphere(24, 12), true)] {
        let mut made = render_mesh(&mesh);
        made.projection_box = ProjectionBox::of(mesh.positions.iter().copied());
        let mut world = IDENTITY;
        if leaning {
            (world[0], world[1], world[4], world[5], world[10]) = (0.3, 0.1, -0.2, 0.6, 0.3);
        }
        builder.add(made, rich(), world);
    }
    RenderScene { projection, ..builder.finish() }
}

#[test]
fn every_projection_agrees_with_its_twin() {
    for projection in PROJECTIONS {
        for filter in [Filter::Trilinear, Filter::Ewa] {
            let scene = RenderScene { filter, ..two_bodies(projection) };
            let apart = differing(&render(&scene, SIDE, SIDE), &reference(&scene, SIDE, SIDE), 1e-2);
            // Rounding decides what is seen, and on which side of an edge of a box; as much as without projections.
            assert!(apart <= 92, "{projection:?}, {filter:?}: {apart} pixels");
        }
    }
}

/// Pixels that show one triangle, and so do their neighbours, and where on the mesh they lie.
fn inner(image: &ImageSet) -> impl Iterator<Item = (usize, DVec3)> + '_ {
    let (triangle, position) =
        (image.triangle.as_ref().expect("asked for"), image.position.as_ref().expect("asked for"));
    let side = SIDE as usize;
    let is_inner = move |i: &usize| {
        let (x, y) = (i % side, i / side);
        let same = |j: usize| triangle[j] == triangle[*i];
        triangle[*i] != u32::MAX
            && x > 0
            && y > 0
            && x + 1 < side
            && y + 1 < side
            && [i - 1, i + 1, i - side, i + side].into_iter().all(same)
    };
    (0..side * side).filter(is_inner).map(move |i| (i, DVec3::from_array(position[i].map(f64::from))))
}

/// The map is linear in the cosines of u and in v, so finely that its own error is below 1 / 20000.
#[test]
fn a_ball_shows_its_map_where_the_formula_of_the_sphere_puts_it() {
    let color = |turn: f64, v: f64| [0.5 + 0.4 * turn.cos(), 0.5 + 0.4 * turn.sin(), v];
    let turning = map(512, |u, v| color(std::f64::consts::TAU * u, v));
    for (projection, eye) in [
        (Projection::Sphere, [4.0, 0.3, 0.1]),
        (Projection::Sphere, [0.2, 4.0, 0.1]),
        (Projection::SphereAsPrinted, [0.3, 0.4, -4.0]),
        (Projection::SphereAsPrinted, [0.3, 0.4, 4.0]),
    ] {
        let scene = shown(&meshes::icosphere(2), turning.clone(), projection, eye);
        let image = render(&scene, SIDE, SIDE);
        let mut count = 0;
        for (i, p) in inner(&image) {
            let level = p.x.hypot(p.z);
            // Beside a pole u changes too fast for a tolerance.
            if level < 0.1 {
                continue;
            }
            let turn = if projection == Projection::Sphere { (-p.z).atan2(p.x) } else { (p.x / level).acos() };
            let expected = color(turn, level.atan2(p.y) / std::f64::consts::PI);
            for k in 0..3 {
                let off = f64::from(image.color[i][k]) - expected[k];
                assert!(
                    off.abs() < 2e-4,
                    "{projection:?} from {eye:?}, pixel {i}: {:?} for {expected:?}",
                    image.color[i]
                );
            }
            count += 1;
        }
        assert!(count > 700, "{count} pixels");
    }
}

#[test]
fn a_box_shows_its_map_upright_on_all_sides() {
    let squares = map(256, |u, v| [u, v, 0.5]);
    for eye in [[1.0, 1.5, 2.0], [-1.0, -1.5, -2.0], [2.0, -1.0, -1.0], [-1.5, 1.2, 1.1]] {
        let image = render(&shown(&meshes::cube(), squares.clone(), Projection::Box, eye), SIDE, SIDE);
        let normal = image.normal.as_ref().expect("asked for");
        let mut count = 0;
        for (i, p) in inner(&image) {
            let side = normal[i].iter().sum::<f32>();
            let axis = (0..3).max_by(|a, b| normal[i][*a].abs().total_cmp(&normal[i][*b].abs())).expect("three");
            let right = f64::from(side) * [-p.z, p.x, p.x][axis];
            let [u, v] = [0.5 + right, 0.5 - [p.y, -p.z, p.y][axis]];
            // Beside the borders of the map it repeats or ends.
            if [u, v].into_iter().any(|t| !(0.01..=0.99).contains(&t)) {
                continue;
            }
            for (k, expected) in [u, v, 0.5].into_iter().enumerate() {
                let found = f64::from(image.color[i][k]);
                assert!((found - expected).abs() < 1e-5, "from {eye:?}, pixel {i}: {found} for {expected}");
            }
            count += 1;
        }
        assert!(count > 700, "{count} pixels");
    }
}

/// Rough enough that a wrong level shows, and another at each place.
fn rough(first: u32) -> ColorMap {
    let side = 64;
    let texel = |i: u32| {
        let (x, y) = ((i % side + side - first) % side, i / side);
        let hash = (x * 2_654_435 + y * 40_503 + x * y * 977) % 1021;
        let value = hash as f32 / 1021.0;
        [value, 1.0 - value, if x < 32 { 0.2 } else { 0.8 }, 1.0]
    };
    ColorMap { width: side, height: side, texels: (0..side * side).map(texel).collect() }
}

/// A quarter of a turn of map and viewer together changes nothing, and takes the seam to where it was not.
#[test]
fn no_seam_shows_on_a_turned_ball() {
    for filter in [Filter::Bilinear, Filter::Trilinear, Filter::Anisotropic, Filter::Ewa] {
        for eye in [[2.2, 0.8, 0.3f32], [0.9, 3.0, 0.2], [9.0, 1.0, 0.5]] {
            let [x, y, z] = eye;
            let ball = meshes::uv_sphere(32, 16);
            let scene = |first, eye| RenderScene { filter, ..shown(&ball, rough(first), Projection::Sphere, eye) };
            let (at_seam, turned) = (scene(0, eye), scene(16, [z, y, -x]));
            let (at_seam, turned) = (render(&at_seam, SIDE, SIDE), render(&turned, SIDE, SIDE));
            let apart = differing(&at_seam, &turned, 2e-2);
            // Rounding at the outline, and beside the pole.
            assert!(apart <= 24, "{filter:?} from {eye:?}: {apart} pixels");
        }
    }
}

#[test]
fn a_normal_map_tilts_a_plane_by_its_slope_along_the_axes_of_the_projection() {
    let mut scene = shown(&meshes::plane(3), map(4, |_, _| [0.5; 3]), Projection::PlanarY, [0.5, 2.0, 0.7]);
    scene.materials[0].unlit = false;
    scene.materials[0].normal_scale = 1.0;
    scene.materials[0].maps[MAP_NORMAL] = plainly(map(4, |_, _| [0.48, 0.36, 0.8]));
    for image in [render(&scene, SIDE, SIDE), reference(&scene, SIDE, SIDE)] {
        let normal = image.normal.as_ref().expect("asked for");
        for (i, _) in inner(&image) {
            // Up on the map is -z.
            let off = DVec3::from_array(normal[i].map(f64::from)) - DVec3::new(0.48, 0.8, -0.36);
            assert!(off.length() < 1e-6, "pixel {i}: {:?}", normal[i]);
        }
    }
}
