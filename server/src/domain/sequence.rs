//! Images one after the other: what is asked for, and what is told of them.

mod timeline;

use serde::{Deserialize, Serialize};

use super::{
    Digest, Error, Result,
    request::{CameraChoice, ImageFormat, RenderRequest},
};
pub use timeline::{Eye, MORPH_FRAMES, Shown, Timeline};

/// Frames of one sequence.
pub const FRAMES: std::ops::RangeInclusive<usize> = 1..=1000;

#[derive(Clone, Debug, Serialize)]
pub struct SequenceRequest {
    /// Every frame but for its camera, which is that of the first. A tolerance in pixels that has no views is that of the
    /// frames' own cameras.
    pub render: RenderRequest,
    /// One for each frame; of an animation the one that it moves.
    pub cameras: Vec<CameraChoice>,
    pub animation: Option<CameraAnimation>,
    pub tessellation: SequenceTessellation,
}

/// Frames along the way that the file's animation takes a camera.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct CameraAnimation {
    /// Its name, or its number in the file.
    pub animation: String,
    pub pace: Pace,
}

#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub enum Pace {
    /// So many, from the first key to the last one.
    Frames(u32),
    /// So many a second.
    Fps(f64),
}

impl Pace {
    /// Seconds of the frames between these two, both among them where the pace allows; none where they are too many.
    #[must_use]
    pub fn seconds(self, [first, last]: [f64; 2]) -> Option<Vec<f64>> {
        let (count, step) = match self {
            Self::Frames(count) => (f64::from(count), (last - first) / f64::from(count.saturating_sub(1).max(1))),
            // What a frame is short of by rounding is none.
            Self::Fps(fps) => ((fps * (last - first) + 1e-6).floor() + 1.0, 1.0 / fps),
        };
        let most = *FRAMES.end() as f64;
        (count <= most).then(|| (0..count as u32).map(|k| (first + f64::from(k) * step).min(last)).collect())
    }
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
        self.output_bytes_of(self.frames_known())
    }

    /// What is known before the file is read.
    fn frames_known(&self) -> usize {
        match &self.animation {
            Some(CameraAnimation { pace: Pace::Frames(count), .. }) => *count as usize,
            _ => self.cameras.len(),
        }
    }

    /// Refuses more frames than host memory holds.
    pub fn check_frames(&self, count: usize, allowed_bytes: u64) -> Result<()> {
        let needed = self.output_bytes_of(count);
        if needed <= allowed_bytes {
            return Ok(());
        }
        let message = format!(
            "{count} frames of {} x {} pixels may take {needed} bytes of host memory; this server gives a job {allowed_bytes}: ask for up to {} of them, or smaller ones",
            self.render.width,
            self.render.height,
            allowed_bytes / (needed / count.max(1) as u64).max(1)
        );
        Err(Error::too_large("views", message))
    }

    /// As [`Self::check_frames`], of those that are known.
    pub fn check(&self, allowed_bytes: u64) -> Result<()> {
        self.check_frames(self.frames_known(), allowed_bytes)
    }

    fn output_bytes_of(&self, count: usize) -> u64 {
        let render = &self.render;
        let own = match render.format {
            ImageFormat::Png => PNG_BYTES,
            ImageFormat::Exr => EXR_BYTES,
        };
        let pixels = u64::from(render.width) * u64::from(render.height);
        pixels * (own + AOV_BYTES * render.aovs.len() as u64) * count as u64
    }

    /// As [`RenderRequest::assets`].
    #[must_use]
    pub fn assets(&self) -> Vec<Digest> {
        self.render.assets()
    }

    /// Pixels of the frames' own cameras that triangles may be off by; none where something else decides.
    #[must_use]
    pub fn own_tolerance_px(&self) -> Option<f64> {
        self.render.own_camera_px()
    }

    /// What each tessellation is made to keep of them: half where the next frame has another one, so that the two together
    /// are nowhere farther apart than what is allowed.
    #[must_use]
    pub fn kept_px(&self) -> Option<f64> {
        let share = if self.tessellation == SequenceTessellation::PerFrame { 0.5 } else { 1.0 };
        Some(share * self.own_tolerance_px()?)
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn frames_are_spread_from_the_first_key_to_the_last_or_come_at_a_rate() {
        assert_eq!(Pace::Frames(3).seconds([1.0, 2.0]), Some(vec![1.0, 1.5, 2.0]));
        assert_eq!(Pace::Frames(1).seconds([1.0, 2.0]), Some(vec![1.0]));
        assert_eq!(Pace::Fps(4.0).seconds([0.0, 1.0]), Some(vec![0.0, 0.25, 0.5, 0.75, 1.0]));
        assert_eq!(Pace::Fps(10.0).seconds([0.0, f64::from(0.7f32)]).map(|all| all.len()), Some(8));
        assert_eq!(Pace::Fps(24.0).seconds([0.0, 50.0]), None, "more than a sequence has");
    }
}
