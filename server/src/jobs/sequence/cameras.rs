//! Where each frame is seen from. Orbits turn around the scene as it is displaced, which is framed once for all frames.

use crate::{
    domain::{
        Result, camera,
        image::RenderCamera,
        report::Report,
        request::{Allowed, ErrorAt, Geometry, Quality, Refinement, Tolerance},
        sequence::SequenceRequest,
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
    let bounds = bounds(context, inputs, request, report)?;
    let [width, height] = [request.render.width, request.render.height];
    let of = |choice| camera::render_camera(choice, &inputs.scene, bounds, width, height);
    Ok(Cameras { each: request.cameras.iter().map(of).collect::<Result<_>>()?, bounds })
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
