//! The corner corrections of seams, as hat functions. The twin of `jets_correction.comp`.

use glam::DVec3;

use super::{
    frame::{self, Jet},
    samples::Sample,
};

/// `av_correction[av]` is what av's candidate is short of the reconciled displacement.
#[must_use]
pub fn jet(av_correction: &[DVec3], sample: &Sample) -> Jet {
    sample.counted(frame::jet(sample.site.b, sample.site.av.map(|av| av_correction[av as usize])))
}
