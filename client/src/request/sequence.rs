//! Frames, from what was typed.

use displace_proto::v1::{self, view::Camera};

use crate::args::{CameraArgs, SequenceArgs, TessellationArg};

/// The views of a render, and what makes frames of them.
pub(crate) fn sequence(camera: &CameraArgs, args: &SequenceArgs) -> (Vec<v1::View>, Option<v1::Sequence>) {
    let view = super::view(camera);
    let Some(frames) = args.orbit_frames else { return (vec![view], None) };
    let tessellation = match args.tessellation {
        None => v1::SequenceTessellation::Unspecified,
        Some(TessellationArg::Frozen) => v1::SequenceTessellation::Frozen,
        Some(TessellationArg::PerFrame) => v1::SequenceTessellation::PerFrame,
        Some(TessellationArg::Hysteresis) => v1::SequenceTessellation::Hysteresis,
    };
    let views = (0..frames).map(|number| turned(view.clone(), 360.0 * number as f32 / frames as f32)).collect();
    (views, Some(v1::Sequence { tessellation: tessellation.into() }))
}

fn turned(mut view: v1::View, degrees: f32) -> v1::View {
    if let Some(Camera::Orbit(orbit)) = &mut view.camera {
        orbit.azimuth_degrees += degrees;
    }
    view
}

#[cfg(test)]
mod tests {
    use clap::Parser as _;

    use super::*;

    #[derive(clap::Parser)]
    struct Typed {
        #[command(flatten)]
        camera: CameraArgs,
        #[command(flatten)]
        sequence: SequenceArgs,
    }

    fn asked(flags: &[&str]) -> (Vec<v1::View>, Option<v1::Sequence>) {
        let typed = Typed::try_parse_from([&["displace"], flags].concat()).unwrap_or_else(|e| panic!("{e}"));
        sequence(&typed.camera, &typed.sequence)
    }

    #[test]
    fn frames_of_an_orbit_are_one_turn_from_where_it_begins() {
        let (views, sequence) = asked(&["--orbit", "30,20", "--orbit-frames", "4", "--tessellation", "hysteresis"]);
        let azimuth = |view: &v1::View| match &view.camera {
            Some(Camera::Orbit(orbit)) => orbit.azimuth_degrees,
            other => panic!("{other:?}"),
        };
        assert_eq!(views.iter().map(azimuth).collect::<Vec<_>>(), [30.0, 120.0, 210.0, 300.0]);
        assert_eq!(sequence.map(|s| s.tessellation()), Some(v1::SequenceTessellation::Hysteresis));
    }

    #[test]
    fn an_image_is_no_sequence() {
        let (views, sequence) = asked(&["--orbit", "30,20"]);
        assert_eq!((views.len(), sequence), (1, None));
    }
}
