//! Rays from pixels: the camera's own matrices, inverted in f64.

use glam::{DMat4, DVec3, DVec4};

use super::super::bvh::Segment;
use crate::domain::image::RenderCamera;

/// The camera of an image.
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    clip_from_world: DMat4,
    world_from_clip: DMat4,
    /// Where all rays begin; none has one when they are parallel.
    eye: Option<DVec3>,
    /// Row of the view-space distance along the axis.
    depth: DVec4,
    size_px: [f64; 2],
    /// What runs clockwise appears counter-clockwise.
    pub(super) mirrored: bool,
}

impl View {
    pub(super) fn new(camera: &RenderCamera, width: u32, height: u32) -> Self {
        let wide = |m: [f32; 16]| DMat4::from_cols_array(&m.map(f64::from));
        let view_from_world = wide(camera.view_from_world);
        let clip_from_world = wide(camera.clip_from_view) * view_from_world;
        let world_from_clip = clip_from_world.inverse();
        // The one point whose clip x, y and w are 0.
        let eye = world_from_clip.z_axis;
        let is_orthographic = camera.clip_from_view[11] == 0.0;
        Self {
            clip_from_world,
            world_from_clip,
            eye: (!is_orthographic).then(|| eye.truncate() / eye.w),
            depth: -view_from_world.row(2),
            size_px: [f64::from(width), f64::from(height)],
            mirrored: clip_from_world.determinant() < 0.0,
        }
    }

    /// What is seen at a place of the image, pixels from its top left corner: from the near plane to the far one.
    pub(super) fn ray(&self, at_px: [f64; 2]) -> Segment {
        let (x, y) = (2.0 * at_px[0] / self.size_px[0] - 1.0, 1.0 - 2.0 * at_px[1] / self.size_px[1]);
        let far = self.world_from_clip * DVec4::new(x, y, 0.0, 1.0);
        let (origin, direction) = match self.eye {
            Some(eye) => (eye, far.truncate() - far.w * eye),
            None => {
                let near = (self.world_from_clip * DVec4::new(x, y, 1.0, 1.0)).truncate();
                (near, far.truncate() - near)
            }
        };
        let direction = direction.normalize();
        let (start, step) = (self.clip_from_world * origin.extend(1.0), self.clip_from_world * direction.extend(0.0));
        // Depth z / w is 1 at the near plane and 0 at the far one, which may be endlessly far.
        let from = (start.z - start.w) / (step.w - step.z);
        let to = -start.z / step.z;
        Segment { origin, direction, from, to: if to > from { to } else { f64::INFINITY } }
    }

    /// Where a place before the camera is seen, pixels from the top left corner.
    pub(super) fn px(&self, place: DVec3) -> [f64; 2] {
        let clip = self.clip_from_world * place.extend(1.0);
        [0.5 * (clip.x / clip.w + 1.0) * self.size_px[0], 0.5 * (1.0 - clip.y / clip.w) * self.size_px[1]]
    }

    /// Where all rays begin, if they do in one place.
    pub(super) fn eye(&self) -> Option<DVec3> {
        self.eye
    }

    pub(super) fn depth(&self, position: DVec3) -> f64 {
        self.depth.dot(position.extend(1.0))
    }
}
