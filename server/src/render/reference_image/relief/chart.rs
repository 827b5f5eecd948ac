//! A mesh as it lies on the map of its heights.

use std::sync::Arc;

use displace_glsl::{layout::relief::ChartSides, reference::relief::charts::Charts};
use glam::{DVec2, DVec3};

use super::Heights;
use crate::render::reference_image::place::{Place, vec3};

/// Of one material.
pub(super) struct Chart {
    triangles: Arc<Vec<[u32; 3]>>,
    positions: Arc<Vec<[f32; 3]>>,
    uvs: Arc<Vec<[f32; 2]>>,
    sides: Arc<Vec<ChartSides>>,
    uv_channels: usize,
    uv_channel: usize,
    map_from_uv: [[f32; 3]; 2],
}

impl Chart {
    pub(super) fn new(place: &Place<'_>, heights: &Heights, sides: Arc<Vec<ChartSides>>) -> Self {
        Self {
            triangles: Arc::clone(&place.mesh.triangles),
            positions: Arc::clone(&place.mesh.positions),
            uvs: Arc::clone(&place.mesh.uvs),
            sides,
            uv_channels: place.uv_channels,
            uv_channel: heights.uv_channel as usize,
            map_from_uv: heights.map_from_uv,
        }
    }

    pub(super) fn with<T>(&self, use_it: impl FnOnce(&Charts<'_>) -> T) -> T {
        let uv = |v: u32| DVec2::from_array(self.uvs[v as usize * self.uv_channels + self.uv_channel].map(f64::from));
        use_it(&Charts {
            sides: &self.sides,
            triangles: &self.triangles,
            place: &|v| on_map(&self.map_from_uv, uv(v)),
            position: &|v| vec3(self.positions[v as usize]),
        })
    }
}

/// On the map, which is 1 wide and high.
pub(super) fn on_map(map_from_uv: &[[f32; 3]; 2], uv: DVec2) -> DVec2 {
    DVec2::from_array(map_from_uv.map(|row| DVec3::from_array(row.map(f64::from)).dot(uv.extend(1.0))))
}
