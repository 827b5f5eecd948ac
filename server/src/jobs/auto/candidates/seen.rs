//! The patches of a material that a camera sees, and what methods do on them.

use std::sync::Arc;

use displace_glsl::methods::Method;
use glam::{DVec3, DVec4};
use rayon::prelude::*;

use crate::domain::{
    chart::Setting,
    choose::{
        cost::{fetches_per_pixel, triangles_for},
        facts::HeightFacts,
        patch::PatchView,
        patches::{over_view, patches_of, view_of},
        predict::{Predicted, predict_each},
    },
    cost::Work,
    image::RenderCamera,
    relief::Relief,
    request::{RenderRequest, Shadows},
    scene::{Scene, SceneMesh},
};

/// Samples of a pixel, each of which is marched.
const SAMPLES: f64 = 4.0;
/// Rays of a sample through prisms, of which it meets more than one.
const SHELL_RAYS: f64 = 2.0;
/// What faces away is taken to be as fine as what faces the eye, at most so many times.
const MOST_UNSEEN: f64 = 64.0;
/// What f32 rounds of what a device marches.
const ROUNDING_PX: f64 = 2e-3;

pub(in crate::jobs) struct Seen<'a> {
    request: &'a RenderRequest,
    facts: Arc<HeightFacts>,
    patches: Vec<PatchView>,
    /// Area of all that has the material over that of what faces the eye.
    unseen: f64,
    /// Of some part nothing is known, as where it reaches behind the eye.
    has_unknown: bool,
}

impl<'a> Seen<'a> {
    pub(in crate::jobs) fn new(
        scene: &Scene,
        material: Option<usize>,
        (relief, facts): (&Relief, Arc<HeightFacts>),
        camera: &RenderCamera,
        request: &'a RenderRequest,
    ) -> Self {
        let (mut patches, mut unknown, mut front, mut back) = (Vec::new(), 0, 0.0, 0.0);
        for instance in &scene.instances {
            let view = view_of(camera, instance, [request.width, request.height]);
            let seen = patches_of(scene, instance.mesh, &|other| other == material, relief, &view);
            patches.extend(seen.seen);
            unknown += seen.unknown;
            let [facing, away] = areas(&scene.meshes[instance.mesh], material, view.eye);
            (front, back) = (front + facing, back + away);
        }
        // Both sides are patches where both are seen.
        let is_double = material.is_some_and(|m| scene.materials[m].double_sided);
        let unseen = if is_double { 1.0 } else { (1.0 + back / front.max(f64::MIN_POSITIVE)).min(MOST_UNSEEN) };
        Self { request, facts, patches, unseen, has_unknown: unknown > 0 }
    }

    /// Bounds of what 99 of 100 pixels, and of what the outline, is off by.
    pub(in crate::jobs) fn predicted(&self, settings: &[(Method, Setting)]) -> Vec<[f64; 2]> {
        if self.has_unknown {
            return vec![[f64::INFINITY; 2]; settings.len()];
        }
        let of = |patch: &PatchView| predict_each(settings, patch, &self.facts);
        let of_patches: Vec<Vec<Predicted>> = self.patches.par_iter().map(of).collect();
        let over = |(k, (method, _)): (usize, &(Method, Setting))| {
            let areas = self.patches.iter().map(|patch| patch.area_px);
            let of_method: Vec<(Predicted, f64)> = of_patches.iter().map(|of| of[k]).zip(areas).collect();
            self.over_view(*method, &of_method)
        };
        settings.iter().enumerate().map(over).collect()
    }

    fn over_view(&self, method: Method, of_patches: &[(Predicted, f64)]) -> [f64; 2] {
        if self.leaves_others_lit(method) {
            return [f64::INFINITY; 2];
        }
        let (error_px, outline_px) = over_view(of_patches);
        let rounding_px = if method.marcher().is_some() { ROUNDING_PX } else { 0.0 };
        [error_px + rounding_px, outline_px]
    }

    /// Heights per pixel shadow nothing but themselves, unless maps of what lights see tell; bent normals not even that.
    fn leaves_others_lit(&self, method: Method) -> bool {
        let marches = method.marcher().is_some_and(|marcher| marcher.finds_depth);
        match self.request.look.shadows {
            Shadows::None => false,
            Shadows::Map => !marches,
            Shadows::Ray => true,
        }
    }

    pub(in crate::jobs) fn work(&self, method: Method, setting: Setting) -> Work {
        let image = f64::from(self.request.width) * f64::from(self.request.height);
        let covered: f64 = self.patches.iter().filter(|patch| patch.is_front).map(|patch| patch.area_px).sum();
        let work = Work { pixels: covered.min(image), ..Work::default() };
        if let Setting::TolerancePx(px) = setting {
            let seen: f64 = self
                .patches
                .par_iter()
                .map(|patch| triangles_for(px, patch, &self.facts))
                .collect::<Vec<f64>>()
                .iter()
                .sum();
            let triangles = self.unseen * seen;
            return Work { vertices: 0.5 * triangles, triangles, ..work };
        }
        if method.marcher().is_none() {
            return work;
        }
        let rays = work.pixels * SAMPLES * if setting == Setting::Shell { SHELL_RAYS } else { 1.0 };
        let share = rays / covered.max(f64::MIN_POSITIVE);
        let fetches =
            |patch: &PatchView| patch.area_px * share * fetches_per_pixel(method, setting, patch, &self.facts);
        Work { rays, fetches: self.patches.iter().map(fetches).sum(), ..work }
    }
}

/// Of what has a material: facing the eye (its place and 1, or the way to it and 0), and away from it; mesh-local.
fn areas(SceneMesh { mesh, .. }: &SceneMesh, material: Option<usize>, eye: DVec4) -> [f64; 2] {
    let place = |av: u32| DVec3::from_array(mesh.gv_position[mesh.av_gv[av as usize] as usize].map(f64::from));
    let of = mesh.primitives.iter().filter(|primitive| primitive.material == material);
    let triangles = of.flat_map(|primitive| primitive.triangles.start as usize..primitive.triangles.end as usize);
    triangles.fold([0.0; 2], |[front, back], t| {
        let [a, b, c] = mesh.triangles[t].av.map(place);
        let normal = 0.5 * (b - a).cross(c - a);
        let area = normal.length();
        if normal.dot(eye.truncate() - a * eye.w) > 0.0 { [front + area, back] } else { [front, back + area] }
    })
}
