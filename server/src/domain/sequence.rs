//! Images one after the other: what is asked for, and what is told of them.

mod timeline;

use serde::{Deserialize, Serialize};

use super::{
    Digest,
    request::{Allowed, CameraChoice, ImageFormat, Refinement, RenderRequest},
};
pub use timeline::{Eye, MORPH_FRAMES, Shown, Timeline};

/// Frames of one sequence.
pub const FRAMES: std::ops::RangeInclusive<usize> = 1..=1000;

#[derive(Clone, Debug, Serialize)]
pub struct SequenceRequest {
    /// Every frame but for its camera, which is that of the first. A tolerance in pixels that has no views is that of the
    /// frames' own cameras.
    pub render: RenderRequest,
    /// One for each frame.
    pub cameras: Vec<CameraChoice>,
    pub tessellation: SequenceTessellation,
}

/// How triangles follow the camera.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize)]
pub enum SequenceTessellation {
    /// Once, for all frames.
    #[default]
    Frozen,
    /// Anew for each.
    PerFrame,
    /// Kept while it suits, then led over to the next.
    Hysteresis,
}

/// Host bytes of a pixel of a finished image: as many as it has before it is packed.
const PNG_BYTES: u64 = 4;
const EXR_BYTES: u64 = 16;
/// The same of an AOV.
const AOV_BYTES: u64 = 12;

impl SequenceRequest {
    /// What all frames may take in host memory, where they wait until the last one is made.
    #[must_use]
    pub fn output_bytes(&self) -> u64 {
        let render = &self.render;
        let own = match render.format {
            ImageFormat::Png => PNG_BYTES,
            ImageFormat::Exr => EXR_BYTES,
        };
        let pixels = u64::from(render.width) * u64::from(render.height);
        pixels * (own + AOV_BYTES * render.aovs.len() as u64) * self.cameras.len() as u64
    }

    /// As [`RenderRequest::assets`].
    #[must_use]
    pub fn assets(&self) -> Vec<Digest> {
        self.render.assets()
    }

    /// Pixels of the frames' own cameras that triangles may be off by; none where something else decides.
    #[must_use]
    pub fn own_tolerance_px(&self) -> Option<f64> {
        match &self.render.surface.geometry.refinement {
            Refinement::Tolerance(tolerance) => match &tolerance.allowed {
                Allowed::Pixels { tolerance_px, views } if views.is_empty() => Some(*tolerance_px),
                _ => None,
            },
            _ => None,
        }
    }
}

/// What a sequence says of itself.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SequenceReport {
    pub frames: Vec<Frame>,
    pub worst_pop_px: f64,
    pub tessellations: u32,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Frame {
    pub triangles: u64,
    pub ms: f64,
    /// How far the surface jumps from the frame before, pixels of this one.
    pub pop_px: f64,
    /// What its triangles are off by at most in its own camera.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance_px: Option<f64>,
    /// How far one tessellation has become the next.
    pub morph: f64,
}
