//! Where each frame is seen from. Orbits turn around the scene as it is displaced, which is framed once for all frames.

use crate::{
    domain::{
        Error, Result, camera, gltf,
        image::RenderCamera,
        report::Report,
        request::{Allowed, CameraChoice, ErrorAt, Geometry, Quality, Refinement, Tolerance},
        scene::Camera,
        sequence::{CameraAnimation, FRAMES, SequenceRequest},
    },
    jobs::{
        WorkContext, images,
        inputs::{self, Inputs},
        plans::Plans,
    },
};

/// Share of the diagonal that the triangles are off by that frame the scene, where its own depend on the cameras.
const FRAMING: f64 = 1e-2;

/// The frames' cameras, and the box of what they see, world units.
pub(super) struct Cameras {
    pub(super) each: Vec<RenderCamera>,
    pub(super) bounds: [[f32; 3]; 2],
}

pub(super) fn of(
    context: &WorkContext<'_>,
    inputs: &mut Inputs,
    request: &SequenceRequest,
    report: &mut Report,
) -> Result<Cameras> {
    request.cameras.iter().try_for_each(|choice| camera::check(choice, &inputs.scene))?;
    let way = request.animation.as_ref().map(|animation| way(context, inputs, request, animation)).transpose()?;
    let bounds = bounds(context, inputs, request, report)?;
    let [width, height] = [request.render.width, request.render.height];
    if let Some(way) = way {
        let of = |one: &Camera| camera::file_camera(one, bounds, width, height);
        return Ok(Cameras { each: way.iter().map(of).collect::<Result<_>>()?, bounds });
    }
    let of = |choice| camera::render_camera(choice, &inputs.scene, bounds, width, height);
    Ok(Cameras { each: request.cameras.iter().map(of).collect::<Result<_>>()?, bounds })
}

/// The camera in every frame.
fn way(
    context: &WorkContext<'_>,
    inputs: &mut Inputs,
    request: &SequenceRequest,
    animation: &CameraAnimation,
) -> Result<Vec<Camera>> {
    let scene = &mut inputs.scene;
    let is_own = |camera: &Camera| match &request.cameras[0] {
        CameraChoice::Named(name) => camera.name.as_ref() == Some(name),
        _ => true,
    };
    let number = scene.cameras.iter().position(is_own).unwrap_or(0);
    let (way, warning) = gltf::camera_way(scene, number, &animation.animation)?;
    scene.warnings.extend(warning);
    let Some(seconds) = animation.pace.seconds(way.seconds) else {
        let ([first, last], most) = (way.seconds, FRAMES.end());
        let message =
            format!("makes more than {most} frames of {:.3} seconds: take a slower pace, or frames", last - first);
        return Err(Error::invalid("sequence.animation.fps", message));
    };
    request.check_frames(seconds.len(), context.limits.host_bytes)?;
    let at =
        |seconds: &f64| Camera { world_from_camera: way.world_from_camera(*seconds), ..scene.cameras[number].clone() };
    Ok(seconds.iter().map(at).collect())
}

fn bounds(
    context: &WorkContext<'_>,
    inputs: &mut Inputs,
    request: &SequenceRequest,
    report: &mut Report,
) -> Result<[[f32; 3]; 2]> {
    let geometry = framing(request);
    inputs.plans = Plans::make(&mut inputs.scene, &geometry, context.limits)?;
    let (surfaces, times) = inputs.displaced(context)?;
    inputs::add_times(&mut report.passes, times);
    Ok(images::bounds(&inputs.scene, &surfaces))
}

/// What the frames show, or what is near it.
fn framing(request: &SequenceRequest) -> Geometry {
    let asked = &request.render.surface.geometry;
    if request.own_tolerance_px().is_none() {
        return asked.clone();
    }
    let allowed = Allowed::Diagonal(FRAMING);
    let tolerance = Tolerance { allowed, error_at: ErrorAt::Surface, quality: Quality::Normal };
    Geometry { refinement: Refinement::Tolerance(tolerance), ..asked.clone() }
}
