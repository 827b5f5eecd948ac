//! Which tessellation each frame of a sequence shows, and which cameras each of them is made for.
//!
//! Let A and B be two tessellations of one surface S, and let all three be taken at the same place of the base. Both keep
//! τ pixels in the cameras of the frames in which A becomes B, so there |A - S| <= t_A and |B - S| <= t_B, lengths that no
//! image shows longer than τ. What is shown in between is (1 - α) A + α B:
//!
//! * It keeps τ: the ball of radius max(t_A, t_B) around S is convex.
//! * It moves by no more than 2 τ Δα ρ from one frame to the next: A and B are at most 2 τ apart on the image, what is between
//!   them is seen on the straight line between them, and the place α is seen at z_A z_B / ((1 - α) z_A + α z_B)^2 of even
//!   speed, z being depths, which is at most ρ = max(z_A, z_B) / min(z_A, z_B). They are depths of two places that are
//!   2 τ pixels apart or less, seen from the side, so ρ <= 3/2 wherever τ is less than a tenth of the distance to the image
//!   counted in pixels, and near 1 wherever τ is a few pixels.
//!
//! One made for each frame alone keeps τ/2 there and in the next, where it gives way to another that does: both are seen within
//! τ/2 of S, so that what jumps jumps by τ at most.
//!
//! With Δα = 1 / [`MORPH_FRAMES`] = 1/4 the surface jumps by ρ τ/2 at most, which is less than τ.

use std::{iter, ops::Range};

use glam::{DVec3, DVec4};

use super::SequenceTessellation;
use crate::domain::image::RenderCamera;

/// Frames in which one tessellation becomes the next.
pub const MORPH_FRAMES: usize = 4;
/// A tessellation is kept while every place has at least this share of the error that each of its frames allows there
/// (`methods.md` D.4 of the design: finer above 1, coarser below 0.6).
const COARSER: f64 = 0.6;

/// Which tessellations there are, and which one each frame shows.
#[derive(Clone, Debug, PartialEq)]
pub struct Timeline {
    /// Of each tessellation, the frames whose cameras it is made for.
    pub made_for: Vec<Range<usize>>,
    pub shown: Vec<Shown>,
}

/// What a frame shows: a tessellation, on its way to the next.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shown {
    pub tessellation: usize,
    /// From 0, itself, up to but without 1, the next.
    pub morph: f64,
}

impl Timeline {
    /// `eyes`: one for each frame; `corners`: of a box around the scene, world units.
    #[must_use]
    pub fn new(tessellation: SequenceTessellation, eyes: &[Eye], corners: &[DVec3]) -> Self {
        let frames = eyes.len();
        match tessellation {
            SequenceTessellation::Frozen => {
                Self { made_for: iter::once(0..frames).collect(), shown: vec![whole(0); frames] }
            }
            SequenceTessellation::PerFrame => {
                // And for the next, whose camera sees what it jumps to.
                let made_for = (0..frames).map(|k| k..(k + 2).min(frames)).collect();
                Self { made_for, shown: (0..frames).map(whole).collect() }
            }
            SequenceTessellation::Hysteresis => Self::kept(eyes, corners),
        }
    }

    /// Each is kept as long as it suits its frames, those in which it comes and goes among them.
    fn kept(eyes: &[Eye], corners: &[DVec3]) -> Self {
        let mut timeline = Self { made_for: Vec::new(), shown: vec![whole(0)] };
        // The first frame that shows any of it.
        let mut first = 0;
        loop {
            let number = timeline.made_for.len();
            let end = end_of(eyes, corners, first);
            timeline.made_for.push(first..end);
            if end == eyes.len() {
                timeline.shown.resize(end, whole(number));
                return timeline;
            }
            // Its last frames are those in which it becomes the next.
            timeline.shown.resize(end - MORPH_FRAMES, whole(number));
            let on_its_way = |k| Shown { tessellation: number, morph: k as f64 / MORPH_FRAMES as f64 };
            timeline.shown.extend((1..MORPH_FRAMES).map(on_its_way));
            timeline.shown.push(whole(number + 1));
            first = end - MORPH_FRAMES;
        }
    }
}

fn whole(tessellation: usize) -> Shown {
    Shown { tessellation, morph: 0.0 }
}

/// The end of the longest run from `first` on in which no place is allowed more than 1 / `COARSER` of the least of the run;
/// at least as long as it takes to come and to go.
fn end_of(eyes: &[Eye], corners: &[DVec3], first: usize) -> usize {
    let least = (first + 2 * MORPH_FRAMES).min(eyes.len());
    let mut ranges = vec![[f64::INFINITY, 0.0]; corners.len()];
    for (k, eye) in eyes.iter().enumerate().skip(first) {
        for ([low, high], corner) in ranges.iter_mut().zip(corners) {
            let allowed = eye.allowed(*corner);
            (*low, *high) = (low.min(allowed), high.max(allowed));
        }
        if k >= least && ranges.iter().any(|[low, high]| low < &(COARSER * high)) {
            return k;
        }
    }
    eyes.len()
}

/// How large a camera sees things.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Eye {
    /// Of a world place: the depth, and 1 without perspective.
    row: DVec4,
    /// No depth counts for less.
    nearest: f64,
    scale: f64,
}

impl Eye {
    /// `nearest`: world units.
    #[must_use]
    pub fn new(camera: &RenderCamera, nearest: f64) -> Self {
        let clip_from_world = glam::DMat4::from_cols_array(&camera.clip_from_world().map(f64::from));
        Self { row: clip_from_world.row(3), nearest, scale: 1.0 / f64::from(camera.clip_from_view[5]).abs() }
    }

    /// World units of what it sees there as long as it sees one at depth 1, on its axis.
    fn allowed(&self, place: DVec3) -> f64 {
        self.scale * self.row.dot(place.extend(1.0)).max(self.nearest)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of eyes on the z axis, as far from the origin as said, that look along it.
    fn eyes(distances: impl IntoIterator<Item = f64>) -> Vec<Eye> {
        let eye = |distance| Eye { row: DVec4::new(0.0, 0.0, -1.0, distance), nearest: 1e-3, scale: 1.0 };
        distances.into_iter().map(eye).collect()
    }

    fn hysteresis(eyes: &[Eye]) -> Timeline {
        Timeline::new(SequenceTessellation::Hysteresis, eyes, &[DVec3::ZERO])
    }

    #[test]
    fn who_stands_still_keeps_one_tessellation() {
        let timeline = hysteresis(&eyes([3.0; 50]));
        assert_eq!((timeline.made_for.as_slice(), timeline.shown.len()), (std::slice::from_ref(&(0..50)), 50));
        assert!(timeline.shown.iter().all(|shown| *shown == whole(0)));
    }

    #[test]
    fn each_tessellation_is_made_for_every_frame_that_shows_any_of_it_and_the_one_before() {
        let approach = eyes((0..90).map(|k| 10.0 * 0.96f64.powi(k)));
        let Timeline { made_for, shown } = hysteresis(&approach);
        assert!(made_for.len() > 3 && shown.len() == 90, "{made_for:?}");
        for (k, Shown { tessellation, morph }) in shown.iter().enumerate() {
            assert!(made_for[*tessellation].contains(&k), "frame {k}");
            let next = if *morph > 0.0 { tessellation + 1 } else { *tessellation };
            assert!(made_for[next].contains(&k), "frame {k}");
            // What a jump is between, both are seen by the later frame's camera.
            let before = k.checked_sub(1).map(|before| shown[before].tessellation);
            assert!(before.is_none_or(|before| made_for[before].contains(&k)), "frame {k}");
        }
    }

    #[test]
    fn steps_between_frames_are_a_quarter_of_the_way_from_one_to_the_next() {
        let shown = hysteresis(&eyes((0..200).map(|k| 5.0 + 3.0 * (0.2 * f64::from(k)).sin()))).shown;
        let place = |shown: &Shown| shown.tessellation as f64 + shown.morph;
        let steps: Vec<f64> = shown.windows(2).map(|pair| place(&pair[1]) - place(&pair[0])).collect();
        assert!(steps.iter().all(|step| *step == 0.0 || *step == 0.25), "{steps:?}");
        assert!(steps.contains(&0.25) && steps.contains(&0.0));
    }

    #[test]
    fn no_place_is_finer_than_hysteresis_allows_unless_the_camera_is_too_fast_for_it() {
        let distances: Vec<f64> = (0..90).map(|k| 10.0 * 0.96f64.powi(k)).collect();
        for frames in hysteresis(&eyes(distances.clone())).made_for {
            let (near, far) = (distances[frames.end - 1], distances[frames.start]);
            assert!(near >= COARSER * far, "{frames:?}");
            // And would be, for one frame more.
            assert!(frames.end == 90 || distances[frames.end] < COARSER * far, "{frames:?}");
        }
        let fast = hysteresis(&eyes((0..40).map(|k| 10.0 * 0.8f64.powi(k))));
        assert!(fast.made_for.iter().rev().skip(1).all(|frames| frames.len() == 2 * MORPH_FRAMES), "{fast:?}");
    }

    #[test]
    fn each_frame_may_have_its_own_and_all_may_have_one() {
        let eyes = eyes([1.0, 2.0, 4.0]);
        let frozen = Timeline::new(SequenceTessellation::Frozen, &eyes, &[DVec3::ZERO]);
        assert_eq!((frozen.made_for, frozen.shown), (iter::once(0..3).collect(), vec![whole(0); 3]));
        let anew = Timeline::new(SequenceTessellation::PerFrame, &eyes, &[DVec3::ZERO]);
        assert_eq!((anew.made_for, anew.shown), (vec![0..2, 1..3, 2..3], vec![whole(0), whole(1), whole(2)]));
    }
}
