//! A triangle of an instance, and what its vertices carry.

use displace_glsl::{
    layout::raster::{PART_COLORED, Part},
    reference::surface::unit_or_zero,
};
use glam::{DVec2, DVec3, DVec4};

use crate::domain::image::RenderMesh;

/// A triangle of an instance.
#[derive(Clone, Copy)]
pub(super) struct Place<'a> {
    pub(super) part: &'a Part,
    pub(super) mesh: &'a RenderMesh,
    pub(super) rows: &'a [[f32; 4]],
    /// Number in its mesh.
    pub(super) triangle: usize,
    pub(super) uv_channels: usize,
}

impl Place<'_> {
    pub(super) fn vertices(&self) -> [usize; 3] {
        self.mesh.triangles[self.triangle].map(|v| v as usize)
    }

    pub(super) fn world(&self, first: usize, p: DVec4) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|k| DVec4::from_array(self.rows[first + k].map(f64::from)).dot(p)))
    }

    pub(super) fn position(&self, weights: DVec3) -> DVec3 {
        self.world(4, blend(weights, self.vertices().map(|v| vec3(self.mesh.positions[v]))).extend(1.0))
    }

    pub(super) fn normal(&self, weights: DVec3) -> DVec3 {
        let normal = blend(weights, self.vertices().map(|v| vec3(self.mesh.normals[v])));
        unit_or_zero(self.world(7, normal.extend(0.0)))
    }

    /// Of the unit normal at `weights`, where they change so.
    pub(super) fn normal_change(&self, weights: DVec3, change: DVec3) -> DVec3 {
        let of = |weights: DVec3| {
            let normal = blend(weights, self.vertices().map(|v| vec3(self.mesh.normals[v])));
            self.world(7, normal.extend(0.0))
        };
        let length = of(weights).length();
        if length < 1e-15 {
            return DVec3::ZERO;
        }
        (of(change) / length).reject_from_normalized(of(weights) / length)
    }

    pub(super) fn position_change(&self, change: DVec3) -> DVec3 {
        self.world(4, blend(change, self.vertices().map(|v| vec3(self.mesh.positions[v]))).extend(0.0))
    }

    /// Of the triangle's front.
    pub(super) fn front(&self) -> DVec3 {
        let [a, b, c] = self.vertices().map(|v| vec3(self.mesh.positions[v]));
        let across = (b - a).cross(c - a);
        let largest = across.abs().max_element();
        unit_or_zero(self.world(7, (if largest > 0.0 { across / largest } else { across }).extend(0.0)))
    }

    pub(super) fn uv(&self, channel: u32, weights: DVec3) -> DVec2 {
        let uv = |v: usize| self.mesh.uvs[v * self.uv_channels + channel as usize];
        let [a, b, c] = self.vertices().map(|v| DVec2::from_array(uv(v).map(f64::from)));
        a * weights.x + b * weights.y + c * weights.z
    }

    pub(super) fn color(&self, weights: DVec3) -> DVec4 {
        if self.part.flags & PART_COLORED == 0 {
            return DVec4::ONE;
        }
        let [a, b, c] = self.vertices().map(|v| DVec4::from_array(self.mesh.colors[v].map(f64::from)));
        a * weights.x + b * weights.y + c * weights.z
    }

    /// In the world.
    pub(super) fn tangent(&self, weights: DVec3) -> DVec4 {
        let Some(corners) = self.mesh.tangents.get(3 * self.triangle..3 * self.triangle + 3) else {
            return DVec4::ZERO;
        };
        let [a, b, c] = [0, 1, 2].map(|k| DVec4::from_array(corners[k].map(f64::from)));
        let tangent = a * weights.x + b * weights.y + c * weights.z;
        self.world(4, tangent.truncate().extend(0.0)).extend(tangent.w)
    }
}

pub(super) fn vec3(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

pub(super) fn blend(weights: DVec3, corners: [DVec3; 3]) -> DVec3 {
    corners[0] * weights.x + corners[1] * weights.y + corners[2] * weights.z
}
