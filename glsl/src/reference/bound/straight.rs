//! The bound where nothing bends but the map: a flat base triangle with one normal, one direction and one map of heights.

use glam::DVec3;

use super::{Asked, MapPlace, lattice::Lattice, layers::FARTHEST_TEXEL, search};
use crate::{
    layout::geometry::Layer,
    reference::{place::Places, site::vector},
};

/// Directions within this of upright, as sines, displace straight up.
const UPRIGHT: f64 = 1e-5;

/// Of base triangle t: the length of its one direction, upright; not a number where more than the map bends.
pub(in crate::reference) fn direction(places: &Places<'_>, t: usize) -> f64 {
    let tables = places.tables;
    let av = tables.base_triangles[t].av.map(|av| av as usize);
    let one = |k: usize| tables.av_normal[k] == tables.av_normal[av[0]] && at(places, k) == at(places, av[0]);
    let (up, facing) = (at(places, av[0]), vector(&tables.triangle_facing[t]));
    let is_upright = up.dot(facing) > 0.0 && up.cross(facing).length() <= UPRIGHT * up.length() * facing.length();
    let is_flat = tables.patches.is_none() && tables.correction(t as u32).is_none() && av.into_iter().all(one);
    let is_straight = is_flat && is_upright && matches!(places.layers(tables.base_triangles[t].detail), [_]);
    if is_straight { at(places, av[0]).length() } else { f64::NAN }
}

fn at(places: &Places<'_>, av: usize) -> DVec3 {
    vector(&places.tables.av_direction_v[av])
}

/// None where the triangle is not straight, or it is not known where its corners lie in its map.
pub(super) fn bound(places: &Places<'_>, asked: Asked, t: u32, corners: [MapPlace; 3], cap: f64) -> Option<f64> {
    let direction = *places.straight.get(t as usize)?;
    let is_near = |c: &MapPlace| c.x.abs() < FARTHEST_TEXEL && c.y.abs() < FARTHEST_TEXEL;
    // Not a number where it is not straight, or the corner is not known.
    if !(direction >= 0.0 && corners.iter().all(is_near)) {
        return None;
    }
    let number = places.tables.details[places.tables.base_triangles[t as usize].detail as usize].start as usize;
    let layer: &Layer = &places.tables.layers[number];
    let scale = direction * f64::from(layer.scale).abs();
    let cap = if scale == 0.0 { f64::INFINITY } else { cap / scale };
    let lattice = Lattice::new(places.tables, layer, 0);
    let found = search::greatest(&lattice, &places.pyramids[number][0], corners, asked.at_texels, cap) * scale;
    Some(if found.is_nan() { f64::INFINITY } else { found })
}
