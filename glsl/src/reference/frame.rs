//! Jets, and the frame of the base surface. The twin of `frame.glsl`.

use glam::{DMat3, DVec3, Vec3Swizzles};

use super::{
    site::{Site, vector},
    smooth::{self, Fields},
};
use crate::tables::Tables;

/// Shortest blended normal a direction is divided by: opposite normals would send it to infinity.
pub const MIN_BLENDED_NORMAL: f64 = 0.125;
/// Squared length below which a tangent is as good as parallel to the normal.
pub const MIN_TANGENT_SQUARE: f64 = 1e-8;

/// A vector with its derivatives along b1 and b2, as columns.
pub type Jet = DMat3;

#[must_use]
pub fn jet(b: DVec3, [x, y, z]: [DVec3; 3]) -> Jet {
    DMat3::from_cols(x * b.x + y * b.y + z * b.z, y - x, z - x)
}

#[must_use]
pub fn scalar_jet(b: DVec3, v: [f64; 3]) -> DVec3 {
    DVec3::new(b.dot(DVec3::from_array(v)), v[1] - v[0], v[2] - v[0])
}

/// The product of a scalar jet (value, derivatives) and a vector jet.
#[must_use]
pub fn product(s: DVec3, m: Jet) -> Jet {
    DMat3::from_cols(s.x * m.x_axis, s.y * m.x_axis + s.x * m.y_axis, s.z * m.x_axis + s.x * m.z_axis)
}

#[must_use]
pub fn dot_jet(a: Jet, b: Jet) -> DVec3 {
    let d = |u: DVec3, v: DVec3| u.dot(b.x_axis) + a.x_axis.dot(v);
    DVec3::new(a.x_axis.dot(b.x_axis), d(a.y_axis, b.y_axis), d(a.z_axis, b.z_axis))
}

#[must_use]
pub fn cross_jet(a: Jet, b: Jet) -> Jet {
    let d = |u: DVec3, v: DVec3| u.cross(b.x_axis) + a.x_axis.cross(v);
    DMat3::from_cols(a.x_axis.cross(b.x_axis), d(a.y_axis, b.y_axis), d(a.z_axis, b.z_axis))
}

/// 1 / |m| with its derivatives; flat where `least` takes over.
#[must_use]
pub fn inverse_length(m: Jet, least: f64) -> DVec3 {
    let size = m.x_axis.length();
    let r = 1.0 / size.max(least);
    let slope = if size > least { -r * r * r } else { 0.0 };
    DVec3::new(r, slope * m.x_axis.dot(m.y_axis), slope * m.x_axis.dot(m.z_axis))
}

/// Unit vector at right angles to unit n.
#[must_use]
pub fn any_perpendicular(n: DVec3) -> DVec3 {
    let axis = if n.x.abs() < 0.6 { DVec3::X } else { DVec3::Y };
    (axis - n * n.dot(axis)).normalize()
}

#[derive(Clone, Copy, Debug)]
pub struct Frame {
    pub position: Jet,
    pub normal: Jet,
    pub direction: Jet,
    pub u: DVec3,
    pub v: DVec3,
}

#[must_use]
pub fn frame_at(tables: &Tables, site: &Site) -> Frame {
    let Fields { position, normal, direction } = smooth::fields(tables, site);
    let w = |table: &[[f32; 4]]| scalar_jet(site.b, site.av.map(|av| f64::from(table[av as usize][3])));
    Frame {
        position,
        normal: product(inverse_length(normal, 1e-12), normal),
        direction: product(inverse_length(normal, MIN_BLENDED_NORMAL), direction),
        u: w(&tables.av_position_u),
        v: w(&tables.av_direction_v),
    }
}

/// Unit tangent and bitangent, made perpendicular to the normal.
#[must_use]
pub fn tangents_at(tables: &Tables, site: &Site, normal: Jet) -> (Jet, Jet) {
    let raw = site.av.map(|av| tables.av_tangent[av as usize]);
    let t = jet(site.b, raw.map(|v| vector(&v)));
    let q = t - product(dot_jet(normal, t), normal);
    let tangent = if q.x_axis.length_squared() > MIN_TANGENT_SQUARE {
        product(inverse_length(q, 1e-12), q)
    } else {
        DMat3::from_cols(any_perpendicular(normal.x_axis), DVec3::ZERO, DVec3::ZERO)
    };
    let handedness = site.b.dot(DVec3::from_array(raw.map(|v| f64::from(v[3]))));
    let bitangent = cross_jet(normal, tangent);
    (tangent, if handedness < 0.0 { -bitangent } else { bitangent })
}

/// (value, derivatives) of an affine row of u and v.
#[must_use]
pub fn affine(row: [f32; 3], u: DVec3, v: DVec3) -> DVec3 {
    let [a, b, c] = row.map(f64::from);
    let linear = a * u + b * v;
    DVec3::new(linear.x + c, linear.y, linear.z)
}

/// Derivatives of a scalar jet.
#[must_use]
pub fn slopes(s: DVec3) -> [f64; 2] {
    s.yz().to_array()
}
