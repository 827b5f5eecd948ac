//! Normals from the finished triangles (Max 1999). The twin of `normals_geometric.comp`.

use glam::DVec3;

use super::{
    samples::place_in_triangle,
    site::{Site, vector},
    triangles::fine_vertex,
};
use crate::{lattice, layout::geometry::block, tables::Tables};

/// Lattice neighbours of a point, anticlockwise; the first again at the end.
const NEIGHBOURS: [[i64; 2]; 7] = [[1, 0], [0, 1], [-1, 1], [-1, 0], [0, -1], [1, -1], [1, 0]];

/// Vertex `index` of a block; `position(v)` is that of fine vertex v.
#[must_use]
pub fn normal(tables: &Tables, which: u32, index: u32, position: impl Fn(u32) -> DVec3) -> DVec3 {
    let n = tables.segments();
    let sum: DVec3 = match which {
        block::INTERIORS => {
            let points = lattice::interior_points(tables.lattice.level) as u32;
            let (i, j) = lattice::interior_point(tables.lattice.level, u64::from(index % points));
            facets_around(tables, index / points, [i as u32, j as u32], &position)
        }
        block::EDGES => gathered(tables, tables.lattice.corners + index / (n - 1), index % (n - 1) + 1, &position),
        _ => gathered(tables, index, 0, &position),
    };
    let base = || Site::of(tables, which, index).blend_table(&tables.av_normal).normalize();
    sum.try_normalize().unwrap_or_else(base)
}

fn gathered(tables: &Tables, list: u32, along: u32, position: &impl Fn(u32) -> DVec3) -> DVec3 {
    let point = |item: u32| place_in_triangle(tables, item, along, tables.segments());
    let items = tables.contributions_of(list).iter();
    items.map(|&item| facets_around(tables, item / 3, point(item), position)).sum()
}

/// Facets of base triangle t around a lattice point, on the side of the shading normals.
fn facets_around(tables: &Tables, t: u32, ij: [u32; 2], position: &impl Fn(u32) -> DVec3) -> DVec3 {
    let n = i64::from(tables.segments());
    let centre = position(fine_vertex(tables, t, ij[0], ij[1]));
    let edge = |[di, dj]: [i64; 2]| {
        let (i, j) = (i64::from(ij[0]) + di, i64::from(ij[1]) + dj);
        let inside = i >= 0 && j >= 0 && i + j <= n;
        inside.then(|| position(fine_vertex(tables, t, i as u32, j as u32)) - centre)
    };
    let facet = |pair: &[[i64; 2]]| {
        let (a, b) = (edge(pair[0])?, edge(pair[1])?);
        let weight = a.length_squared() * b.length_squared();
        (weight > 0.0).then(|| a.cross(b) / weight)
    };
    let sum: DVec3 = NEIGHBOURS.windows(2).filter_map(facet).sum();
    let triangle = &tables.base_triangles[t as usize];
    let p = triangle.av.map(|av| vector(&tables.av_position_u[av as usize]));
    let shading: DVec3 = triangle.av.iter().map(|&av| vector(&tables.av_normal[av as usize])).sum();
    if (p[1] - p[0]).cross(p[2] - p[0]).dot(shading) < 0.0 { -sum } else { sum }
}
