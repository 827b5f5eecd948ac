//! The base surface at a fine vertex. The twin of `subdivide.comp`.

use glam::{DVec3, DVec4};

use super::{
    frame::{self, MIN_BLENDED_NORMAL},
    site::{Site, vector},
    smooth::{self, Fields},
};
use crate::{layout::geometry::block, tables::Tables};

/// What the displacement passes read.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Base {
    pub position: DVec3,
    pub direction: DVec3,
    pub uv: [f64; 2],
    /// Unit.
    pub normal: DVec3,
    /// Unit and perpendicular to `normal`, and the handedness; zero without a table of tangents.
    pub tangent: DVec4,
}

/// Vertex `index` of a block of fine vertices.
#[must_use]
pub fn base(tables: &Tables, which: u32, index: u32) -> Base {
    at(tables, &Site::of(tables, which, index), which == block::CORNERS)
}

/// At any site; a `corner`'s own normal counts as unit.
#[must_use]
pub fn at(tables: &Tables, site: &Site, corner: bool) -> Base {
    let Fields { position, normal, direction } = smooth::fields(tables, site);
    let (position, normal, direction) = (position.x_axis, normal.x_axis, direction.x_axis);
    let divisor = if corner { 1.0 } else { normal.length().max(MIN_BLENDED_NORMAL) };
    let w = |table: &[[f32; 4]]| frame::scalar_jet(site.b, site.av.map(|av| f64::from(table[av as usize][3]))).x;
    let unit = normal.try_normalize().unwrap_or_else(|| vector(&tables.av_normal[site.av[0] as usize]));
    Base {
        position,
        direction: direction / divisor,
        uv: [w(&tables.av_position_u), w(&tables.av_direction_v)],
        normal: unit,
        tangent: tangent(tables, site, unit),
    }
}

fn tangent(tables: &Tables, site: &Site, normal: DVec3) -> DVec4 {
    if tables.av_tangent.is_empty() {
        return DVec4::ZERO;
    }
    let still = glam::DMat3::from_cols(normal, DVec3::ZERO, DVec3::ZERO);
    let (along, _) = frame::tangents_at(tables, site, still);
    let handedness = site.b.dot(DVec3::from_array(site.av.map(|av| f64::from(tables.av_tangent[av as usize][3]))));
    along.x_axis.extend(if handedness < 0.0 { -1.0 } else { 1.0 })
}
