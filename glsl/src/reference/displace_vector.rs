//! The displacement of a vector layer. The twin of `displace_vector.comp`.

use glam::{DVec3, Vec4Swizzles};

use super::{map, subdivide::Base};
use crate::{
    layout::geometry::{Layer, kind},
    tables::Tables,
};

#[must_use]
pub fn displacement(tables: &Tables, layer: &Layer, base: &Base) -> DVec3 {
    let p = map::texel_space(layer, base.uv[0], base.uv[1]);
    let channel = |k| (map::bilinear(tables, layer, k, p) - f64::from(layer.midlevel)) * f64::from(layer.scale);
    let d = DVec3::new(channel(0), channel(1), channel(2));
    if layer.kind == kind::VECTOR_OBJECT {
        return d;
    }
    let tangent = base.tangent.xyz();
    let bitangent = base.normal.cross(tangent) * base.tangent.w;
    tangent * d.x + bitangent * d.y + base.direction * d.z
}
