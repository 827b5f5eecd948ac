//! What a surface looks like where a ray hits it: the material of glTF 2.0, 3.9, read between texels of the finest level.

use glam::{DMat3, DVec2, DVec3, DVec4};

use displace_glsl::layout::raster::{MAP_BASE_COLOR, MAP_EMISSIVE, MAP_METALLIC_ROUGHNESS, MAP_NORMAL, MAP_OCCLUSION};

use super::{
    super::field::wrapped,
    bump,
    projection::{Spot, spots},
    scene::OracleMesh,
    world::blend,
};
use crate::domain::{
    detail::{Sampling, Wrap},
    image::{ColorMap, RenderMap, RenderMaterial},
    projection::Projection,
};

/// Farther texels than this have no others between them.
const FARTHEST: f64 = (1u64 << 52) as f64;

/// A place on a triangle of a mesh.
pub(super) struct Corners<'m> {
    pub(super) mesh: &'m OracleMesh,
    pub(super) vertices: [usize; 3],
    /// In the mesh.
    pub(super) triangle: usize,
    pub(super) weights: DVec3,
    pub(super) uv_channels: usize,
    pub(super) projection: Projection,
}

/// What shading knows of a place.
#[derive(Clone, Copy, Debug)]
pub(super) struct Look {
    /// Linear RGBA.
    pub(super) base: DVec4,
    /// Linear radiance.
    pub(super) emissive: DVec3,
    /// Of the normal map where there is one, bent by what else bends: world, unit or 0, on the side that is seen.
    pub(super) normal: DVec3,
    /// Share of light from everywhere that arrives.
    pub(super) open: f64,
    pub(super) metallic: f64,
    /// Perceptual.
    pub(super) roughness: f64,
    pub(super) unlit: bool,
}

impl Look {
    /// Whether rays that meet it can be followed one by one.
    pub(super) fn is_mirror(&self) -> bool {
        self.metallic >= 1.0 && self.roughness <= 0.0
    }
}

impl Corners<'_> {
    pub(super) fn uv(&self, channel: usize) -> DVec2 {
        blend(self.weights, [0, 1, 2].map(|corner| self.uv_of_corner(channel, corner)))
    }

    pub(super) fn uv_of_corner(&self, channel: usize, corner: usize) -> DVec2 {
        DVec2::from_array(self.mesh.uvs[self.vertices[corner] * self.uv_channels + channel].map(f64::from))
    }

    pub(super) fn uv_of_base_color(&self, material: &RenderMaterial) -> DVec2 {
        self.uv(material.maps[MAP_BASE_COLOR].as_ref().map_or(0, |map| map.uv_channel as usize))
    }

    pub(super) fn read(&self, map: &RenderMap) -> DVec4 {
        match self.spots() {
            Some(spots) => spots.iter().map(|spot| at(map, spot.uv) * spot.share).sum(),
            None => at(map, self.uv(map.uv_channel as usize)),
        }
    }

    /// Where maps are projected, where this place lies on them.
    fn spots(&self) -> Option<Vec<Spot>> {
        let place = blend(self.weights, self.vertices.map(|v| self.mesh.positions[v]));
        let normal = |v: usize| DVec3::from_array(self.mesh.normals[v].map(f64::from));
        spots(self.projection, &self.mesh.projection_box, place, blend(self.weights, self.vertices.map(normal)))
    }

    /// Minus the slope that a projected normal map describes, in the mesh's space.
    fn slope(&self, map: &RenderMap, scale: f64) -> Option<DVec3> {
        let of = |spot: &Spot| {
            let bent = at(map, spot.uv).truncate();
            (spot.axes[0] * bent.x + spot.axes[1] * bent.y) * (scale * spot.share / bent.z.max(1.0 / 64.0))
        };
        self.spots().map(|spots| spots.iter().map(of).sum())
    }

    fn base_color(&self, material: &RenderMaterial) -> DVec4 {
        let mut color = DVec4::from_array(material.base_color_factor.map(f64::from));
        if !self.mesh.colors.is_empty() {
            let of = |v: usize| DVec4::from_array(self.mesh.colors[v].map(f64::from));
            color *= blend(self.weights, self.vertices.map(of));
        }
        material.maps[MAP_BASE_COLOR].as_ref().map_or(color, |map| color * self.read(map))
    }

    /// Tangent in the mesh's space, and the sign of the bitangent.
    pub(super) fn tangent(&self) -> Option<(DVec3, f64)> {
        let corners = self.mesh.tangents.get(3 * self.triangle..3 * self.triangle + 3)?;
        let of = |k: usize| DVec4::from_array(corners[k].map(f64::from));
        let tangent = blend(self.weights, [of(0), of(1), of(2)]);
        (tangent.w != 0.0).then(|| (tangent.truncate(), tangent.w.signum()))
    }
}

/// A map at a place in the units of texture coordinates.
fn at(map: &RenderMap, uv: DVec2) -> DVec4 {
    let place = map.map_from_uv.map(|row| DVec3::from_array(row.map(f64::from)).dot(uv.extend(1.0)));
    bilinear(&map.map, place, map.wrap)
}

pub(super) fn alpha(material: &RenderMaterial, corners: &Corners<'_>) -> f64 {
    corners.base_color(material).w
}

/// `normal`: interpolated, on the side that is seen; `side` is -1 where that is the back.
pub(super) fn look(m: &RenderMaterial, at: &Corners<'_>, normal: DVec3, side: f64, world_from_mesh: DMat3) -> Look {
    let read = |slot: usize| m.maps[slot].as_ref().map(|map| at.read(map));
    let surface = read(MAP_METALLIC_ROUGHNESS).unwrap_or(DVec4::ONE);
    let emitted = read(MAP_EMISSIVE).map_or(DVec3::ONE, DVec4::truncate);
    let shaded = read(MAP_OCCLUSION).map_or(0.0, |map| 1.0 - map.x);
    let slope = m.maps[MAP_NORMAL].as_ref().and_then(|map| at.slope(map, m.normal_scale.into()));
    let mapped = slope.map(|slope| tilted(normal * side, slope, world_from_mesh)).or_else(|| {
        let map = read(MAP_NORMAL)?;
        let bent = map.truncate() * DVec3::new(m.normal_scale.into(), m.normal_scale.into(), 1.0);
        in_frame(bent, at, normal * side, world_from_mesh)
    });
    let own = mapped.map_or(normal, |mapped| mapped * side);
    let bent = Some(m).filter(|m| !m.bump.is_empty());
    let bent = bent.and_then(|m| bump::bent(m, at, own * side, normal * side, world_from_mesh));
    Look {
        base: at.base_color(m),
        emissive: emitted * DVec3::from_array(m.emissive_factor.map(f64::from)),
        normal: bent.map_or(own, |bent| bent * side),
        open: 1.0 - f64::from(m.occlusion_strength) * shaded,
        metallic: surface.z * f64::from(m.metallic_factor),
        roughness: surface.y * f64::from(m.roughness_factor),
        unlit: m.unlit,
    }
}

/// A vector of the tangent frame (glTF 2.0, 3.7.2.1) around the normal of the front, in the world, unit.
fn in_frame(bent: DVec3, at: &Corners<'_>, front: DVec3, world_from_mesh: DMat3) -> Option<DVec3> {
    let (tangent, sign) = at.tangent()?;
    let tangent = (world_from_mesh * tangent).try_normalize()?;
    let frame = DMat3::from_cols(tangent, front.cross(tangent) * sign, front);
    (frame * bent).try_normalize()
}

/// The normal of the front where it is tilted by a slope, which stays as steep in the world.
fn tilted(front: DVec3, slope: DVec3, world_from_mesh: DMat3) -> DVec3 {
    let steep = (world_from_mesh * slope).normalize_or_zero() * slope.length();
    (front + steep.reject_from_normalized(front)).normalize_or_zero()
}

/// The map at (u, v) of [0, 1]², texel i of n at (i + 1/2) / n: at its finest level, whatever the pixel's size;
/// many samples a pixel are the filter.
fn bilinear(map: &ColorMap, at: [f64; 2], wrap: [Wrap; 2]) -> DVec4 {
    let size = [map.width, map.height];
    let place = [0, 1].map(|k| (at[k] * f64::from(size[k]) - 0.5).clamp(-FARTHEST, FARTHEST));
    let first = place.map(f64::floor);
    let texel = |i: i64, j: i64| {
        let x = wrapped(first[0] as i64 + i, size[0], wrap[0], Sampling::Center) as usize;
        let y = wrapped(first[1] as i64 + j, size[1], wrap[1], Sampling::Center) as usize;
        DVec4::from_array(map.texels[y * map.width as usize + x].map(f64::from))
    };
    let (s, t) = (place[0] - first[0], place[1] - first[1]);
    (texel(0, 0) * (1.0 - s) + texel(1, 0) * s) * (1.0 - t) + (texel(0, 1) * (1.0 - s) + texel(1, 1) * s) * t
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn maps_are_bilinear_between_texels_and_wrap() {
        let texels = [0.0, 1.0, 2.0, 7.0].map(|x| [x; 4]).to_vec();
        let map = ColorMap { width: 2, height: 2, texels };
        let value = |u, v, wrap| bilinear(&map, [u, v], [wrap; 2]).x;
        assert_eq!(value(0.5, 0.5, Wrap::Clamp), 2.5);
        assert_eq!(value(0.375, 0.75, Wrap::Clamp), 3.25);
        assert_eq!(value(0.0, 0.25, Wrap::Repeat), 0.5);
        assert_eq!(value(0.0, 0.25, Wrap::Mirror), 0.0);
        assert_eq!(value(-7.5, 0.25, Wrap::Clamp), 0.0);
        assert!(value(1e300, -1e300, Wrap::Repeat).is_finite());
    }
}
