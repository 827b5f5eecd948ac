//! Sheets, seams and solids.

use std::sync::Arc;

use displace_glsl::methods::Method;

use super::*;
use crate::domain::image::{HeightMap, ReliefSettings, RenderMaterial};

const MAP_FROM_UV: [[f32; 3]; 2] = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];

/// Quads of position and texture coordinate, counter-clockwise, each with vertices of its own.
fn scene(quads: &[[([f32; 3], [f32; 2]); 4]], repeats: [bool; 2]) -> RenderScene {
    let vertices: Vec<_> = quads.iter().flatten().copied().collect();
    let triangles =
        (0..quads.len() as u32).flat_map(|q| [[4 * q, 4 * q + 1, 4 * q + 2], [4 * q, 4 * q + 2, 4 * q + 3]]);
    let mesh = RenderMesh {
        normals: Arc::new(vec![[0.0, 0.0, 1.0]; vertices.len()]),
        positions: Arc::new(vertices.iter().map(|v| v.0).collect()),
        uvs: Arc::new(vertices.iter().map(|v| v.1).collect()),
        triangles: Arc::new(triangles.collect()),
        material_of_triangles: vec![(0, 0)],
        ..RenderMesh::default()
    };
    let map = HeightMap { width: 1, height: 1, heights: vec![0.0], repeats, thinnest_texels: 1.0 };
    let relief = RenderRelief { map: Arc::new(map), uv_channel: 0, map_from_uv: MAP_FROM_UV, steps: 0 };
    let material = RenderMaterial { relief: Some(relief), ..RenderMaterial::default() };
    RenderScene {
        meshes: vec![mesh],
        materials: vec![material.clone(), material],
        relief: ReliefSettings { method: Method::Exact, ..ReliefSettings::default() },
        uv_channels: 1,
        ..RenderScene::default()
    }
}

/// From x to the next whole number along x, with these u; v is y.
fn strip(x: f32, [from, to]: [f32; 2]) -> [([f32; 3], [f32; 2]); 4] {
    let at = |x: f32, y: f32, u: f32| ([x, y, 0.0], [u, y]);
    [at(x, 0.0, from), at(x + 1.0, 0.0, to), at(x + 1.0, 1.0, to), at(x, 1.0, from)]
}

/// What is beyond the right side of the first quad: side 1 of its first triangle.
fn beyond(scene: &RenderScene) -> Result<(u32, Crossing), u32> {
    let first = sides(scene)[0][0];
    match first.across[1] {
        CHART_OPEN | CHART_SEAM => Err(first.across[1]),
        across => Ok((across, Crossing::of(first.how[1]))),
    }
}

#[test]
fn crossings_are_what_is_unpacked_of_them() {
    for turns in [[0, 0], [1, -1], [-MOST_TURNS, MOST_TURNS], [37, -2000]] {
        for side in 0..3 {
            for mirrored in [false, true] {
                let crossing = Crossing { side, mirrored, turns };
                assert_eq!(Crossing::of(crossing.packed()), crossing);
            }
        }
    }
}

#[test]
fn an_open_sheet_ends_at_its_rim_and_goes_on_within() {
    let scene = scene(&[strip(0.0, [0.0, 0.5]), strip(1.0, [0.5, 1.0])], [true; 2]);
    let all = &sides(&scene)[0];
    let crossing = Crossing { side: 2, mirrored: false, turns: [0; 2] };
    assert_eq!(beyond(&scene), Ok((3, crossing)));
    // Back again, over the diagonals, and out.
    assert_eq!([all[3].across[2], all[0].across[2], all[1].across[0]], [0, 1, 0]);
    assert_eq!(Crossing::of(all[3].how[2]), Crossing { side: 1, ..crossing });
    let open = all.iter().flat_map(|sides| sides.across).filter(|across| *across == CHART_OPEN).count();
    assert_eq!(open, 6);
}

#[test]
fn a_map_that_repeats_goes_on_by_whole_turns_and_one_that_does_not_has_a_seam() {
    let quads = [strip(0.0, [0.5, 3.0]), strip(1.0, [1.0, 2.0])];
    let crossing = Crossing { side: 2, mirrored: false, turns: [2, 0] };
    assert_eq!(beyond(&scene(&quads, [true; 2])), Ok((3, crossing)));
    assert_eq!(beyond(&scene(&quads, [false, true])), Err(CHART_SEAM));
    let part = [strip(0.0, [0.5, 1.0]), strip(1.0, [0.25, 2.0])];
    assert_eq!(beyond(&scene(&part, [true; 2])), Err(CHART_SEAM));
}

#[test]
fn what_is_mirrored_goes_on_mirrored() {
    let quads = [strip(0.0, [0.0, 0.5]), strip(1.0, [0.5, 0.0])];
    let crossing = Crossing { side: 2, mirrored: true, turns: [0; 2] };
    assert_eq!(beyond(&scene(&quads, [true; 2])), Ok((3, crossing)));
}

#[test]
fn what_has_no_area_on_the_map_has_seams_around_it() {
    let quads = [strip(0.0, [0.0, 0.5]), strip(1.0, [0.5, 0.5])];
    assert_eq!(beyond(&scene(&quads, [true; 2])), Err(CHART_SEAM));
}

#[test]
fn another_material_is_a_seam_and_so_are_three_triangles_at_an_edge() {
    let wall = [
        ([1.0, 1.0, 0.0], [0.5, 1.0]),
        ([1.0, 0.0, 0.0], [0.5, 0.0]),
        ([1.0, 0.0, 1.0], [1.0, 0.0]),
        ([1.0, 1.0, 1.0], [1.0; 2]),
    ];
    let two = [strip(0.0, [0.0, 0.5]), strip(1.0, [0.5, 1.0])];
    let mut other = scene(&two, [true; 2]);
    other.meshes[0].material_of_triangles = vec![(0, 0), (2, 1)];
    assert_eq!(beyond(&other), Err(CHART_SEAM));
    let three = [two[0], two[1], wall];
    let mut all = scene(&three, [true; 2]);
    assert_eq!(beyond(&all), Err(CHART_SEAM));
    all.meshes[0].material_of_triangles = vec![(0, 0), (4, 1)];
    assert_eq!(beyond(&all).map(|(across, _)| across), Ok(3));
}

#[test]
fn a_surface_goes_on_over_edges_of_45_degrees_and_not_over_those_of_a_cube() {
    for (rise, goes_on) in [(0.0, true), (-1.0, true), (-100.0, false)] {
        let mut quad = strip(1.0, [0.5, 1.0]);
        (quad[1].0[2], quad[2].0[2]) = (rise, rise);
        assert_eq!(beyond(&scene(&[strip(0.0, [0.0, 0.5]), quad], [true; 2])).is_ok(), goes_on, "{rise}");
    }
    let mut below = strip(1.0, [0.5, 1.0]);
    below.reverse();
    assert_eq!(beyond(&scene(&[strip(0.0, [0.0, 0.5]), below], [true; 2])), Err(CHART_SEAM), "turned around");
}

/// Split where it comes round, as it is in files.
#[test]
fn a_cylinder_goes_round_for_ever() {
    let quad = |k: u32| {
        let at = |k: u32, v: f32| {
            let angle = f64::from(k % 12) / 12.0 * std::f64::consts::TAU;
            ([angle.cos() as f32, angle.sin() as f32, v], [k as f32 / 12.0, v])
        };
        [at(k, 0.0), at(k + 1, 0.0), at(k + 1, 1.0), at(k, 1.0)]
    };
    let quads: Vec<_> = (0..12).map(quad).collect();
    let all = sides(&scene(&quads, [true; 2])).remove(0);
    let mut turns = 0;
    let mut t = 0;
    for _ in 0..12 {
        let crossing = Crossing::of(all[t].how[1]);
        turns += crossing.turns[0];
        // To the second triangle of the next quad, and over its diagonal to the first.
        let next = all[t].across[1] as usize;
        assert_eq!((crossing.side, next), (2, (t + 3) % 24));
        t = all[next].across[0] as usize;
    }
    assert_eq!((turns, t), (1, 0));
    let clamped = sides(&scene(&quads, [false; 2])).remove(0);
    assert_eq!((clamped[22].across[1], clamped[0].across[1]), (CHART_SEAM, 3));
}

#[test]
fn nothing_is_told_where_no_heights_are_shown_per_pixel() {
    let mut scene = scene(&[strip(0.0, [0.0, 0.5])], [true; 2]);
    assert_eq!(concatenated(&scene).len(), 2);
    scene.materials.iter_mut().for_each(|material| material.relief = None);
    assert!(sides(&scene).is_empty() && concatenated(&scene).is_empty());
}

/// As a turn of sin(2 pi) is from one of 0; vertices within are not looked at.
#[test]
fn positions_that_rounding_tells_apart_are_one_at_borders() {
    let mut second = strip(1.0, [0.5, 1.0]);
    second.iter_mut().for_each(|(position, _)| position[2] += 1.2e-7);
    assert!(beyond(&scene(&[strip(0.0, [0.0, 0.5]), second], [true; 2])).is_ok());
    second.iter_mut().for_each(|(position, _)| position[2] += 1e-3);
    assert_eq!(beyond(&scene(&[strip(0.0, [0.0, 0.5]), second], [true; 2])), Err(CHART_OPEN));
}
