//! What lies under a place of the image, what it looks like, and its light: the twins of the passes put together.

use std::sync::Arc;

use displace_glsl::{
    layout::raster::{
        LIGHT_SUN, Light, MAP_BASE_COLOR, MAP_SLOTS, MATERIAL_UNLIT, Material, PART_COLORED, PART_MIRRORED, Part,
    },
    reference::{
        appearance::{Appearance, Under, appearance},
        lights::incoming,
        mip::Level,
        shade_phong::{Reflected, reflected},
        shadow_rays::Ray,
        surface::{Barycentrics, barycentrics, unit_or_zero},
        texture,
        transform::homogeneous,
    },
};
use glam::{DVec2, DVec3, DVec4};

use crate::{
    domain::{
        Result,
        image::{ColorMap, RenderMap, RenderMaterial, RenderMesh, RenderScene, Shading},
        request::Shadows,
    },
    render::{
        image::{
            shading::eye_and_depth,
            tables::{Tables, wrap_numbers},
        },
        occluders::Shade,
    },
};

/// A triangle of an instance.
pub(super) struct Place<'a> {
    pub(super) part: &'a Part,
    pub(super) mesh: &'a RenderMesh,
    pub(super) rows: &'a [[f32; 4]],
    /// Number in its mesh.
    pub(super) triangle: usize,
    pub(super) uv_channels: usize,
}

impl Place<'_> {
    fn vertices(&self) -> [usize; 3] {
        self.mesh.triangles[self.triangle].map(|v| v as usize)
    }

    fn world(&self, first: usize, p: DVec4) -> DVec3 {
        DVec3::from_array([0, 1, 2].map(|k| DVec4::from_array(self.rows[first + k].map(f64::from)).dot(p)))
    }

    fn position(&self, weights: DVec3) -> DVec3 {
        self.world(4, blend(weights, self.vertices().map(|v| vec3(self.mesh.positions[v]))).extend(1.0))
    }

    fn normal(&self, weights: DVec3) -> DVec3 {
        let normal = blend(weights, self.vertices().map(|v| vec3(self.mesh.normals[v])));
        unit_or_zero(self.world(7, normal.extend(0.0)))
    }

    /// Of the triangle's front.
    fn front(&self) -> DVec3 {
        let [a, b, c] = self.vertices().map(|v| vec3(self.mesh.positions[v]));
        let across = (b - a).cross(c - a);
        let largest = across.abs().max_element();
        unit_or_zero(self.world(7, (if largest > 0.0 { across / largest } else { across }).extend(0.0)))
    }

    fn uv(&self, channel: u32, weights: DVec3) -> DVec2 {
        let uv = |v: usize| self.mesh.uvs[v * self.uv_channels + channel as usize];
        let [a, b, c] = self.vertices().map(|v| DVec2::from_array(uv(v).map(f64::from)));
        a * weights.x + b * weights.y + c * weights.z
    }

    fn color(&self, weights: DVec3) -> DVec4 {
        if self.part.flags & PART_COLORED == 0 {
            return DVec4::ONE;
        }
        let [a, b, c] = self.vertices().map(|v| DVec4::from_array(self.mesh.colors[v].map(f64::from)));
        a * weights.x + b * weights.y + c * weights.z
    }

    /// In the world.
    fn tangent(&self, weights: DVec3) -> DVec4 {
        let Some(corners) = self.mesh.tangents.get(3 * self.triangle..3 * self.triangle + 3) else {
            return DVec4::ZERO;
        };
        let [a, b, c] = [0, 1, 2].map(|k| DVec4::from_array(corners[k].map(f64::from)));
        let tangent = a * weights.x + b * weights.y + c * weights.z;
        self.world(4, tangent.truncate().extend(0.0)).extend(tangent.w)
    }
}

pub(super) struct Hit {
    pub(super) position: DVec3,
    pub(super) uv: DVec2,
    pub(super) look: Appearance,
    facing: DVec3,
    /// At the vertices, for Gouraud's light: positions and normals towards the viewer's side.
    corners: [(DVec3, DVec3); 3],
    weights: DVec3,
}

/// The twins with what they need to know of the scene.
pub(super) struct Shader {
    shade: Option<Shade>,
    /// Mip levels of each material's maps.
    maps: Vec<[Option<Arc<Vec<Level>>>; MAP_SLOTS]>,
    shading: Shading,
    ambient: f64,
    eye: DVec4,
    view_depth: DVec4,
}

impl Shader {
    pub(super) fn new(scene: &RenderScene, tables: &Tables) -> Result<Self> {
        let (eye, view_depth) = eye_and_depth(&scene.camera);
        let [eye, view_depth] = [eye, view_depth].map(|v| DVec4::from_array(v.map(f64::from)));
        let (shading, ambient) = (scene.shading, f64::from(scene.lighting.ambient));
        let is_shaded = scene.shadows == Shadows::Ray && !tables.lights.is_empty();
        let shade = if is_shaded { Some(Shade::new(scene, tables)?) } else { None };
        Ok(Self { shade, maps: map_levels(scene), shading, ambient, eye, view_depth })
    }

    pub(super) fn depth(&self, position: DVec3) -> f64 {
        self.view_depth.dot(position.extend(1.0))
    }

    pub(super) fn hit(&self, place: &Place<'_>, source: &RenderMaterial, factors: &Material, at_px: [f64; 2]) -> Hit {
        let b = barycentrics(place.vertices().map(|v| {
            let h = homogeneous(place.rows, place.mesh.positions[v]);
            DVec3::new(h.x - at_px[0] * h.w, h.y - at_px[1] * h.w, h.w)
        }));
        let flip = if b.clockwise != (place.part.flags & PART_MIRRORED != 0) { -1.0 } else { 1.0 };
        let normal = flip * place.normal(b.at);
        let under = Under { color: place.color(b.at), normal, flip, tangent: place.tangent(b.at) };
        let corner = |weights: DVec3| (place.position(weights), flip * place.normal(weights));
        let base_channel = source.maps[MAP_BASE_COLOR].as_ref().map_or(0, |map| map.uv_channel);
        Hit {
            position: place.position(b.at),
            uv: place.uv(base_channel, b.at),
            look: appearance(factors, &under, &self.mapped(place, source, &b)),
            facing: flip * place.front(),
            corners: [DVec3::X, DVec3::Y, DVec3::Z].map(corner),
            weights: b.at,
        }
    }

    /// The alpha of a place, at the finest level of its map.
    pub(super) fn alpha(&self, place: &Place<'_>, source: &RenderMaterial, weights: DVec3) -> f64 {
        let alpha = f64::from(source.base_color_factor[3]) * place.color(weights).w;
        match (&source.maps[MAP_BASE_COLOR], &self.maps[place.part.material as usize][MAP_BASE_COLOR]) {
            (Some(map), Some(levels)) => {
                let at = on_map(map, place.uv(map.uv_channel, weights), 1.0);
                alpha * texture::bilinear(&levels[0], at, wrap_numbers(map.wrap))[3]
            }
            _ => alpha,
        }
    }

    /// What each map shows; white where there is none.
    fn mapped(&self, place: &Place<'_>, source: &RenderMaterial, b: &Barycentrics) -> [DVec4; MAP_SLOTS] {
        let levels = &self.maps[place.part.material as usize];
        std::array::from_fn(|slot| match (&source.maps[slot], &levels[slot]) {
            (Some(map), Some(levels)) => filtered(place, map, levels, b),
            _ => DVec4::ONE,
        })
    }

    /// `is_opaque` gets a triangle's number over all instances, and weights of its corners.
    pub(super) fn radiance(&self, tables: &Tables, hit: &Hit, is_opaque: impl Fn(u32, DVec3) -> bool) -> DVec3 {
        let look = &hit.look;
        let base = look.base.truncate();
        if look.flags & MATERIAL_UNLIT != 0 {
            return base;
        }
        let seen = tables.lights.iter().filter(|light| !self.is_shadowed(light, hit, &is_opaque));
        let direct: DVec3 = seen.map(|light| self.reflected(light, hit).of(base)).sum();
        base * (self.ambient * look.occlusion) + look.emissive + direct
    }

    fn reflected(&self, light: &Light, hit: &Hit) -> Reflected {
        match self.shading {
            Shading::Flat => {
                let centre = blend(DVec3::splat(1.0 / 3.0), hit.corners.map(|corner| corner.0));
                reflected(light, centre, hit.facing, self.eye)
            }
            Shading::Gouraud => {
                let corners = hit.corners.map(|(position, normal)| reflected(light, position, normal, self.eye));
                Reflected::blended(corners, hit.weights)
            }
            Shading::Phong => reflected(light, hit.position, hit.look.normal, self.eye),
        }
    }

    fn is_shadowed(&self, light: &Light, hit: &Hit, is_opaque: impl Fn(u32, DVec3) -> bool) -> bool {
        let Some(shade) = &self.shade else { return false };
        let direction = incoming(light, hit.position).direction;
        if hit.look.normal.dot(direction) <= 0.0 && hit.look.normal != DVec3::ZERO {
            return true;
        }
        let end = if light.kind == LIGHT_SUN { f64::INFINITY } else { vec3(light.position).distance(hit.position) };
        let origin = hit.position + hit.facing * f64::from(shade.offset_world);
        shade.occluders.stop(&Ray { origin, direction, end }, is_opaque)
    }
}

fn filtered(place: &Place<'_>, map: &RenderMap, levels: &[Level], b: &Barycentrics) -> DVec4 {
    let uv = |weights: DVec3, one: f64| on_map(map, place.uv(map.uv_channel, weights), one);
    let (at, dx, dy) = (uv(b.at, 1.0), uv(b.dx, 0.0), uv(b.dy, 0.0));
    DVec4::from_array(texture::trilinear(levels, at, dx, dy, wrap_numbers(map.wrap)))
}

/// Where a UV lies on the map; `one` is 0 for differences.
fn on_map(map: &RenderMap, uv: DVec2, one: f64) -> [f64; 2] {
    map.map_from_uv.map(|row| row.map(f64::from)).map(|r| r[0] * uv.x + r[1] * uv.y + r[2] * one)
}

fn vec3(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

fn blend(weights: DVec3, corners: [DVec3; 3]) -> DVec3 {
    corners[0] * weights.x + corners[1] * weights.y + corners[2] * weights.z
}

/// Mip levels per material; materials that share a map share its levels.
fn map_levels(scene: &RenderScene) -> Vec<[Option<Arc<Vec<Level>>>; MAP_SLOTS]> {
    let mut known: Vec<(Arc<ColorMap>, Arc<Vec<Level>>)> = Vec::new();
    let mut levels = |map: &Arc<ColorMap>| match known.iter().find(|(other, _)| Arc::ptr_eq(other, map)) {
        Some((_, levels)) => levels.clone(),
        None => {
            let levels = Arc::new(finest_level(map).chain());
            known.push((map.clone(), levels.clone()));
            levels
        }
    };
    let of_material = |material: &RenderMaterial| {
        std::array::from_fn(|slot| material.maps[slot].as_ref().map(|used| levels(&used.map)))
    };
    scene.materials.iter().map(of_material).collect()
}

fn finest_level(map: &ColorMap) -> Level {
    let texels = map.texels.iter().map(|texel| texel.map(f64::from)).collect();
    Level { width: map.width as usize, height: map.height as usize, texels, alpha_scale: 1.0 }
}
