//! The patches that a view sees of a scene's mesh, and what holds for the image of all of them.

use glam::{DMat4, DVec2, DVec3, DVec4};
use rayon::prelude::*;

use super::{
    lay::{Around, Lay, Rim},
    patch::{Patch, PatchView, View},
    predict::Predicted,
};
use crate::domain::{
    image::RenderCamera,
    relief::Relief,
    scene::{Instance, Scene, SceneMesh},
};

/// Patches of a triangle, at most: four at each of so many turns.
const MOST_SPLITS: u32 = 3;
/// What is no wider is not split, pixels.
const SMALL_PX: f64 = 12.0;

/// Patches of one material that a view sees, and how much of it they leave out.
#[derive(Clone, Debug, Default)]
pub struct Patches {
    pub seen: Vec<PatchView>,
    /// Triangles that reach behind the eye or have no area on the map: nothing is known of them.
    pub unknown: u32,
}

/// How a camera sees an instance; `size_px` as the image is drawn, its samples apart.
#[must_use]
pub fn view_of(camera: &RenderCamera, instance: &Instance, size_px: [u32; 2]) -> View {
    let [clip, eye_from_world] =
        [camera.clip_from_view, camera.view_from_world].map(|m| DMat4::from_cols_array(&m.map(f64::from)));
    let world = instance.world();
    let size = DVec2::new(f64::from(size_px[0]), f64::from(size_px[1]));
    let local = clip * eye_from_world * world;
    let [x, y, w] = [local.row(0), local.row(1), local.row(3)];
    let pixel_from_local = [(x + w) * (0.5 * size.x), (w - y) * (0.5 * size.y), w];
    let world_from_eye = eye_from_world.inverse();
    let is_perspective = clip.row(3).truncate() != DVec3::ZERO;
    let eye = world.inverse() * if is_perspective { world_from_eye.w_axis } else { world_from_eye.z_axis };
    // Reversed depth: at w = near, z is w.
    let near = if is_perspective { near_w(&clip) } else { 0.0 };
    View { pixel_from_local, eye: eye.truncate().extend(if is_perspective { 1.0 } else { 0.0 }), size_px: size, near }
}

fn near_w(clip: &DMat4) -> f64 {
    let (z, w) = (clip.row(2), clip.row(3));
    // z.z Z + z.w = w.z Z, at w = w.z Z.
    let depth = z.w / (w.z - z.z);
    (w.z * depth).abs()
}

/// Of the triangles of `mesh` that `takes` says have this relief, in the frustum: of each up to 64, the smaller the more it
/// fills of the image.
#[must_use]
pub fn patches_of(
    scene: &Scene,
    mesh: usize,
    takes: &dyn Fn(Option<usize>) -> bool,
    relief: &Relief,
    view: &View,
) -> Patches {
    let SceneMesh { mesh, .. } = &scene.meshes[mesh];
    let lay = Lay::new(mesh, relief);
    let rim = Rim::of(&lay, view);
    let mut patches = Patches::default();
    for primitive in mesh.primitives.iter().filter(|primitive| takes(primitive.material)) {
        let double_sided = primitive.material.is_some_and(|m| scene.materials[m].double_sided);
        let of_triangle = |t: u32| {
            let mut patches = Patches::default();
            Cut { lay: &lay, view, rim: &rim, t: t as usize, around: None }.add(double_sided, &mut patches);
            patches
        };
        let found: Vec<Patches> = primitive.triangles.clone().into_par_iter().map(of_triangle).collect();
        for Patches { seen, unknown } in found {
            patches.seen.extend(seen);
            patches.unknown += unknown;
        }
    }
    rim.tell(&mut patches.seen, view);
    patches
}

/// The error that no more than a share of the image's covered pixels exceed, of (error, area) each: what is bounded is told
/// by the base's area on the screen, what hides what left aside.
#[must_use]
pub fn quantile(mut errors: Vec<(f64, f64)>, share: f64) -> f64 {
    errors.sort_by(|a, b| a.0.total_cmp(&b.0));
    let all: f64 = errors.iter().map(|(_, area)| area).sum();
    let mut below = 0.0;
    for (error, area) in &errors {
        below += area;
        if below >= share * all {
            return *error;
        }
    }
    errors.last().map_or(0.0, |(error, _)| *error)
}

/// Of a view: the upper bound of its 99th percentile, and the greatest outline.
#[must_use]
pub fn over_view(predicted: &[(Predicted, f64)]) -> (f64, f64) {
    let errors = predicted.iter().map(|(p, area)| (p.error_px, *area)).collect();
    (quantile(errors, 0.99), predicted.iter().map(|(p, _)| p.outline_px).fold(0.0, f64::max))
}

/// A triangle that is taken in parts.
struct Cut<'a> {
    lay: &'a Lay<'a>,
    view: &'a View,
    rim: &'a Rim,
    t: usize,
    around: Option<Around>,
}

impl Cut<'_> {
    fn add(mut self, double_sided: bool, patches: &mut Patches) {
        let is_back = !double_sided && self.view.facing(self.lay.corners(self.t)) <= 0.0;
        if is_back {
            return;
        }
        let Some(patch) = self.lay.patch(self.t) else {
            patches.unknown += 1;
            return;
        };
        if self.is_outside(&patch) {
            return;
        }
        let around = self.lay.around(self.t);
        let base = around.told(patch.base);
        self.around = Some(around);
        self.split(Patch { base, ..patch }, MOST_SPLITS, patches);
    }

    fn split(&self, patch: Patch, splits: u32, patches: &mut Patches) {
        if self.is_outside(&patch) {
            return;
        }
        let seen = PatchView::new(patch, self.view);
        let is_small = seen.as_ref().is_some_and(|seen| seen.area_px <= SMALL_PX * SMALL_PX);
        if splits > 0 && !is_small {
            patch.split().into_iter().for_each(|part| self.split(part, splits - 1, patches));
            return;
        }
        let Some(mut seen) = seen else {
            patches.unknown += 1;
            return;
        };
        seen.patch.seam_distance = self.around.as_ref().map_or(0.0, |around| around.seam_distance(&patch));
        seen.patch.is_rim = self.rim.is_at(self.t, self.lay, &patch);
        patches.seen.push(seen);
    }

    /// Whether the patch, as high as heights go, is wholly beyond one side of the image or behind the eye.
    fn is_outside(&self, patch: &Patch) -> bool {
        let [x, y, w] = self.view.pixel_from_local;
        let size = self.view.size_px;
        let planes = [x, w * size.x - x, y, w * size.y - y, w];
        let reach = self.lay.reach();
        let beyond =
            |plane: &DVec4| patch.corners.iter().all(|c| plane.dot(c.extend(1.0)) < -reach * plane.truncate().length());
        planes.iter().any(beyond)
    }
}
