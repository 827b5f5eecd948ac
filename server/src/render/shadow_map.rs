//! What lights see: a camera for each side of each light, over the scene as it stops light. Both executors draw it by the
//! rasteriser they have.

use displace_glsl::{
    layout::{
        raster::{MAP_BASE_COLOR, MAP_SLOTS},
        shadow::{SHADOW_FACES, ShadowFace},
    },
    methods::Method,
};
use glam::{DMat3, DMat4, DVec3, DVec4};
use rayon::prelude::*;

use super::image::tables::pixel_from_world;
use crate::domain::{
    Error, Result,
    image::{
        ImagePlan, LightShape, Lighting, ReliefSettings, RenderAlpha, RenderBump, RenderCamera, RenderLight,
        RenderMaterial, RenderScene, Shading,
        shadow_map::{SIDE_PX, WIDE_PX},
    },
    request::Shadows,
};

/// A point takes six sides.
const MOST_LIGHTS: usize = 64;
/// Beyond what a side is for, so that windows of samples lie inside.
const MARGIN_PX: f64 = 4.0;
/// How far what is as steep as 45 degrees may rise, so many texels along, before it shades itself.
const BIAS_TEXELS: f64 = 0.5;
/// What is nearer to a place that shines than this share of the scene's diagonal stops nothing.
const NEAR_SHARE: f64 = 1e-4;

/// A side of a light: where it is seen from, and how its texels lie.
pub(crate) struct Side {
    pub(crate) camera: RenderCamera,
    pub(crate) face: ShadowFace,
}

/// Sides to draw, and which of them each light reads.
pub(crate) struct ShadowPlan {
    pub(crate) sides: Vec<Side>,
    /// `SHADOW_FACES` for each light.
    pub(crate) faces: Vec<ShadowFace>,
    /// Of all sides.
    pub(crate) texels: u64,
}

impl ShadowPlan {
    /// `None` where the scene asks for no shadow maps.
    pub(crate) fn new(scene: &RenderScene) -> Result<Option<Self>> {
        let lights = scene.lighting.lights.len();
        if scene.shadows != Shadows::Map || lights == 0 {
            return Ok(None);
        }
        if lights > MOST_LIGHTS {
            let message = format!(
                "the file has {lights} lights, and shadow maps are for up to {MOST_LIGHTS}: take shadows ray, or name the lights to take"
            );
            return Err(Error::too_large("lighting.shadows", message));
        }
        let mut plan = Self { sides: Vec::new(), faces: Vec::new(), texels: 0 };
        let corners = corners(scene);
        for light in &scene.lighting.lights {
            plan.add(light, &corners);
        }
        Ok(Some(plan))
    }

    fn add(&mut self, light: &RenderLight, corners: &[DVec3]) {
        match light.shape {
            LightShape::Sun { direction_world } => {
                let face = self.push(sun(wide(direction_world), corners), WIDE_PX);
                self.faces.extend([face; SHADOW_FACES]);
            }
            LightShape::Spot { position_world, direction_world, cone_cosines: [_, outer], .. }
                if light.shape.looks_one_way() =>
            {
                let tangent = f64::from(1.0 - outer * outer).max(0.0).sqrt() / f64::from(outer);
                let eye = wide(position_world);
                let lens = Lens::new(eye, wide(direction_world), tangent, near(eye, corners), WIDE_PX);
                let face = self.push(lens, WIDE_PX);
                self.faces.extend([face; SHADOW_FACES]);
            }
            LightShape::Point { position_world, .. } | LightShape::Spot { position_world, .. } => {
                let eye = wide(position_world);
                for axis in AXES {
                    let face = self.push(Lens::new(eye, axis, 1.0, near(eye, corners), SIDE_PX), SIDE_PX);
                    self.faces.push(face);
                }
            }
        }
    }

    fn push(&mut self, lens: Lens, size: u32) -> ShadowFace {
        let camera = lens.camera();
        let texel_from_world = pixel_from_world(&camera, [size; 2]);
        let row = |k: usize| texel_from_world.row(k).as_vec4().to_array();
        let face = ShadowFace {
            row_x: row(0),
            row_y: row(1),
            row_z: row(2),
            row_w: row(3),
            first: self.texels as u32,
            size,
            bias: lens.bias[0] as f32,
            bias_share: lens.bias[1] as f32,
        };
        self.texels += u64::from(size).pow(2);
        self.sides.push(Side { camera, face });
        face
    }
}

const AXES: [DVec3; SHADOW_FACES] = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];

/// Cameras along +x, -x, +y, -y, +z, -z from a place in a scene so large, that see a little more than a quarter turn each.
pub(crate) fn sides(eye: DVec3, reach: f64, size: u32) -> [RenderCamera; SHADOW_FACES] {
    let near = NEAR_SHARE * if reach > 0.0 { reach } else { 1.0 };
    AXES.map(|axis| Lens::new(eye, axis, 1.0, near, size).camera())
}

struct Lens {
    eye: DVec3,
    view_from_world: DMat4,
    clip_from_view: DMat4,
    /// Of depth: constant, and as a share of depth.
    bias: [f64; 2],
}

impl Lens {
    fn camera(&self) -> RenderCamera {
        RenderCamera {
            view_from_world: self.view_from_world.as_mat4().to_cols_array(),
            clip_from_view: self.clip_from_view.as_mat4().to_cols_array(),
            eye_world: self.eye.as_vec3().to_array(),
        }
    }

    /// From a place; `tangent` of the half angle that is needed.
    fn new(eye: DVec3, forward: DVec3, tangent: f64, near: f64, size: u32) -> Self {
        let tangent = tangent / (1.0 - 2.0 * MARGIN_PX / f64::from(size));
        let clip_from_view = DMat4::from_cols(
            DVec4::new(1.0 / tangent, 0.0, 0.0, 0.0),
            DVec4::new(0.0, 1.0 / tangent, 0.0, 0.0),
            DVec4::new(0.0, 0.0, 0.0, -1.0),
            DVec4::new(0.0, 0.0, near, 0.0),
        );
        // Depth is near / distance: a step of a texel's width along the view changes it by this share.
        let bias = [0.0, BIAS_TEXELS * 2.0 * tangent / f64::from(size)];
        Self { eye, view_from_world: view(eye, forward), clip_from_view, bias }
    }
}

/// Along parallel rays, fitted to the corners of the scene's boxes as the light sees them.
fn sun(towards: DVec3, corners: &[DVec3]) -> Lens {
    let turned = view(DVec3::ZERO, -towards);
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for corner in corners {
        let p = turned.transform_point3(*corner);
        (low, high) = (low.min(p), high.max(p));
    }
    if !low.is_finite() || !high.is_finite() {
        (low, high) = (DVec3::ZERO, DVec3::ZERO);
    }
    let least = 1e-3 * (high - low).max_element().max(1e-6);
    let half = (0.5 * (high - low)).max(DVec3::splat(least)) * DVec3::new(1.0, 1.0, 1.01);
    let half = half / DVec3::new(margin(), margin(), 1.0);
    let eye = turned.inverse().transform_point3(0.5 * (low + high));
    let clip_from_view = DMat4::from_cols(
        DVec4::new(1.0 / half.x, 0.0, 0.0, 0.0),
        DVec4::new(0.0, 1.0 / half.y, 0.0, 0.0),
        DVec4::new(0.0, 0.0, 0.5 / half.z, 0.0),
        DVec4::new(0.0, 0.0, 0.5, 1.0),
    );
    let texel = 2.0 * half.x.max(half.y) / f64::from(WIDE_PX);
    let bias = [BIAS_TEXELS * texel * 0.5 / half.z, 0.0];
    Lens { eye, view_from_world: view(eye, -towards), clip_from_view, bias }
}

fn margin() -> f64 {
    1.0 - 2.0 * MARGIN_PX / f64::from(WIDE_PX)
}

fn view(eye: DVec3, forward: DVec3) -> DMat4 {
    let backward = -forward.normalize();
    let (right, up) = backward.any_orthonormal_pair();
    let rotation = DMat3::from_cols(right, up, backward).transpose();
    DMat4::from_mat3(rotation) * DMat4::from_translation(-eye)
}

fn near(eye: DVec3, corners: &[DVec3]) -> f64 {
    let reach = corners.iter().map(|corner| corner.distance(eye)).fold(0.0, f64::max);
    NEAR_SHARE * if reach > 0.0 && reach.is_finite() { reach } else { 1.0 }
}

/// Of the boxes of all instances, in the world.
fn corners(scene: &RenderScene) -> Vec<DVec3> {
    let nothing = || (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let bounds = scene.meshes.iter().map(|mesh| {
        let points = mesh.positions.par_iter().map(|p| wide(*p)).filter(|p| p.is_finite()).map(|p| (p, p));
        points.reduce(nothing, |a, b| (a.0.min(b.0), a.1.max(b.1)))
    });
    let bounds: Vec<_> = bounds.collect();
    let of_instance = |instance: &crate::domain::image::RenderInstance| {
        let world_from_mesh = DMat4::from_cols_array(&instance.world_from_mesh.map(f64::from));
        let (low, high) = bounds[instance.mesh];
        let corner = move |k: usize| {
            let pick = |axis: usize| if k >> axis & 1 == 0 { low[axis] } else { high[axis] };
            world_from_mesh.transform_point3(DVec3::new(pick(0), pick(1), pick(2)))
        };
        (0..8).map(corner)
    };
    scene.instances.iter().flat_map(of_instance).filter(|corner| corner.is_finite()).collect()
}

/// The scene as it stops light: from both sides, where alpha is above the cut-off that rays have, and of heights that are
/// shown per pixel by the method that takes no steps, which would come and go along what is seen.
pub(crate) fn stopping(scene: &RenderScene) -> RenderScene {
    let finds_depth = scene.marcher().is_some_and(|marcher| marcher.finds_depth);
    let method = if finds_depth { Method::Exact } else { scene.relief.method };
    RenderScene {
        materials: scene.materials.iter().map(stopping_material).collect(),
        lighting: Lighting { lights: Vec::new(), environment: None, ..scene.lighting.clone() },
        shading: Shading::Flat,
        shadows: Shadows::None,
        reflectors: Vec::new(),
        aovs: Vec::new(),
        relief: ReliefSettings { method, ..scene.relief },
        ..scene.clone()
    }
}

fn stopping_material(material: &RenderMaterial) -> RenderMaterial {
    let cutoff = material.alpha.cutoff();
    let alpha = if cutoff > 0.0 { RenderAlpha::Mask { cutoff } } else { RenderAlpha::Opaque };
    let mut maps: [_; MAP_SLOTS] = Default::default();
    if cutoff > 0.0 {
        maps[MAP_BASE_COLOR] = material.maps[MAP_BASE_COLOR].clone();
    }
    RenderMaterial { maps, alpha, bump: RenderBump::default(), double_sided: true, ..material.clone() }
}

/// Of one side.
pub(crate) fn image_plan(scene: &RenderScene, face: &ShadowFace) -> Result<ImagePlan> {
    ImagePlan::new(face.size, face.size, &scene.contents())
}

fn wide(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn projected(face: &ShadowFace, p: DVec3) -> DVec3 {
        let rows = [face.row_x, face.row_y, face.row_z, face.row_w].map(|row| DVec4::from_array(row.map(f64::from)));
        let h = DVec4::from_array(rows.map(|row| row.dot(p.extend(1.0))));
        h.truncate() / h.w
    }

    fn box_of(low: DVec3, high: DVec3) -> Vec<DVec3> {
        (0..8).map(|k| DVec3::select(glam::BVec3::new(k & 1 == 0, k & 2 == 0, k & 4 == 0), low, high)).collect()
    }

    fn planned(light: RenderLight, corners: &[DVec3]) -> ShadowPlan {
        let mut plan = ShadowPlan { sides: Vec::new(), faces: Vec::new(), texels: 0 };
        plan.add(&light, corners);
        plan
    }

    #[test]
    fn a_sun_sees_the_whole_scene_and_what_is_nearer_deeper() {
        let corners = box_of(DVec3::new(-1.0, -2.0, -3.0), DVec3::new(5.0, 2.0, 1.0));
        let towards = DVec3::new(0.48, 0.6, 0.64);
        let plan = planned(RenderLight::sun(towards.as_vec3().to_array()), &corners);
        for corner in &corners {
            let p = projected(&plan.faces[0], *corner);
            assert!(p.min_element() > 0.0 && p.x.max(p.y) < f64::from(WIDE_PX) && p.z < 1.0, "{p}");
            assert!(projected(&plan.faces[0], *corner + 0.1 * towards).z > p.z);
        }
        assert_eq!(plan.texels, u64::from(WIDE_PX).pow(2));
    }

    #[test]
    fn each_side_of_a_point_shows_what_lies_its_way() {
        let plan = planned(RenderLight::point([1.0, 2.0, 3.0]), &box_of(DVec3::ZERO, DVec3::splat(9.0)));
        for k in 0..600u32 {
            let part = |shift: u32| f64::from(k.wrapping_mul(2_654_435_761) >> shift & 0xff) / 127.5 - 1.0;
            let away = DVec3::new(part(8), part(16), part(24));
            let face = &plan.faces[displace_glsl::reference::shadow_map::side_of(away)];
            let p = projected(face, DVec3::new(1.0, 2.0, 3.0) + away);
            let window = 1.5..f64::from(SIDE_PX) - 1.5;
            assert!(window.contains(&p.x) && window.contains(&p.y) && p.z > 0.0, "{away}: {p}");
        }
    }
}
