//! Frames, from what was typed.

use displace_proto::v1::{self, view::Camera};

use crate::args::{CameraArgs, SequenceArgs, TessellationArg};

/// The views of a render, and what makes frames of them.
pub(crate) fn sequence(camera: &CameraArgs, args: &SequenceArgs) -> (Vec<v1::View>, Option<v1::Sequence>) {
    let view = super::view(camera);
    if !args.is_asked() {
        return (vec![view], None);
    }
    let tessellation = match args.tessellation {
        None => v1::SequenceTessellation::Unspecified,
        Some(TessellationArg::Frozen) => v1::SequenceTessellation::Frozen,
        Some(TessellationArg::PerFrame) => v1::SequenceTessellation::PerFrame,
        Some(TessellationArg::Hysteresis) => v1::SequenceTessellation::Hysteresis,
    };
    let tessellation = tessellation.into();
    let Some(frames) = args.orbit_frames else {
        return (vec![view], Some(v1::Sequence { tessellation, animation: animation(args) }));
    };
    let views = (0..frames).map(|number| turned(view.clone(), 360.0 * number as f32 / frames as f32)).collect();
    (views, Some(v1::Sequence { tessellation, animation: None }))
}

/// A number is one unless an animation has it for a name, which the server knows.
fn animation(args: &SequenceArgs) -> Option<v1::CameraAnimation> {
    use v1::camera_animation::{Pace, Which};
    let which = args.animation.clone().map(Which::Name);
    let pace = args.frames.map(Pace::Frames).or(args.fps.map(Pace::Fps));
    which.map(|which| v1::CameraAnimation { which: Some(which), pace })
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
    fn an_animation_has_one_view_and_a_pace() {
        use v1::camera_animation::{Pace, Which};
        let (views, sequence) = asked(&["--animation", "Fly", "--fps", "12.5", "--camera", "Main"]);
        assert_eq!(views[0].camera, Some(Camera::Named("Main".into())));
        let animation = sequence.and_then(|sequence| sequence.animation).unwrap();
        assert_eq!((animation.which, animation.pace), (Some(Which::Name("Fly".into())), Some(Pace::Fps(12.5))));
        for bad in
            [&["--animation", "Fly"][..], &["--frames", "3"], &["--animation", "0", "--frames", "3", "--orbit", "0,0"]]
        {
            assert!(Typed::try_parse_from([&["displace"], bad].concat()).is_err(), "{bad:?}");
        }
    }

    #[test]
    fn an_image_is_no_sequence() {
        let (views, sequence) = asked(&["--orbit", "30,20"]);
        assert_eq!((views.len(), sequence), (1, None));
    }
}
