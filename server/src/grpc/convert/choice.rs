//! What was chosen.

use displace_proto::v1;

use crate::domain::choice::{Choice, Weighed};

pub(super) fn to_choice(choice: &Choice) -> v1::Choice {
    v1::Choice {
        material: choice.material.clone(),
        chosen: Some(to_option(&choice.chosen)),
        next_better: choice.next_better.as_ref().map(to_option),
        next_cheaper: choice.next_cheaper.as_ref().map(to_option),
        tolerance_px: choice.tolerance_px,
        reason: choice.reason.clone(),
        measured_px: choice.measured_px,
        shades_rest: choice.shades_rest,
    }
}

fn to_option(weighed: &Weighed) -> v1::MethodOption {
    v1::MethodOption {
        method: weighed.method.clone(),
        setting: weighed.setting.clone(),
        predicted_px: weighed.predicted_px,
        predicted_outline_px: weighed.predicted_outline_px,
        cost_ms: weighed.cost_ms,
        pixels: weighed.work.pixels,
        rays: weighed.work.rays,
        fetches: weighed.work.fetches,
        vertices: weighed.work.vertices,
        triangles: weighed.work.triangles,
    }
}
