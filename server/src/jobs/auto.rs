//! What is settled of an image before anything is made: the method of each material (`Method::Auto`), and triangles within
//! pixels of the image's own camera.
//!
//! | file | what it does |
//! |---|---|
//! | `auto/candidates.rs` | what there is to show a material by, its predicted errors and cost |
//! | `auto/realised.rs` | from what was chosen to what is displaced, marched and bent |
//! | `auto/rest.rs` | what is finer than displaced triangles bends normals |
//! | `auto/measured.rs` | what an image is really off by |

mod candidates;
mod measured;
mod realised;
mod rest;

use std::sync::Arc;

use displace_glsl::methods::Method;

use super::{
    AssetReader, JobLimits, exact,
    inputs::{self, Inputs},
    lens,
    plans::Plans,
};
use crate::{
    domain::{
        Result,
        choice::Choice,
        cost::CostModel,
        detail::Detail,
        image::{ImageSet, RenderCamera},
        report::PassTime,
        request::{Aov, Refinement, RenderRequest, Tolerance},
    },
    render::JobContext,
};

pub(super) use candidates::{MOST_TEXELS, Seen, Weighing, grounds, weigh};
pub(super) use realised::displace_all;

/// An image whose method, triangles and camera are known.
pub(super) struct Settled {
    pub(super) request: RenderRequest,
    pub(super) inputs: Inputs,
    /// Where it was needed to decide; else what is made decides.
    pub(super) camera: Option<RenderCamera>,
    /// Of `Method::Auto`.
    pub(super) choices: Vec<Choice>,
    /// The materials that these are of.
    materials: Vec<Option<usize>>,
    /// Those of them whose detail is heights alone.
    heights: Vec<Option<usize>>,
    /// What the surface has that the image stands for, whatever shows it.
    details: Vec<Vec<Option<Arc<Detail>>>>,
    pub(super) passes: Vec<PassTime>,
}

impl Settled {
    fn new(request: RenderRequest, inputs: Inputs, camera: Option<RenderCamera>) -> Self {
        let (choices, materials, heights, passes) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
        let details = inputs.details.clone();
        Self { request, inputs, camera, choices, materials, heights, details, passes }
    }

    /// Whether something else than triangles within the tolerance shows a detail.
    fn shows_otherwise(&self) -> bool {
        self.choices.iter().any(|choice| !choice.chosen.is_displaced())
    }

    /// What the image needs besides what was asked for, so that it can be measured.
    pub(super) fn measured_aovs(&self) -> &'static [Aov] {
        if self.shows_otherwise() { &[Aov::Depth, Aov::Position, Aov::Uv] } else { &[] }
    }

    /// Notes what the image is off by. Whether all of it is as near as it was predicted to be.
    pub(super) fn measure(&mut self, desk: Desk<'_>, images: &ImageSet) -> Result<bool> {
        if self.measured_aovs().is_empty() {
            return Ok(true);
        }
        let scene = (&self.inputs.scene, self.details.as_slice());
        let geometry = &self.request.surface.geometry;
        let measure = || Ok(measured::p99_px(scene, geometry, images, &self.materials));
        let errors = inputs::timed(desk.job.progress, "measure", &mut self.passes, measure)?;
        for (choice, error_px) in self.choices.iter_mut().zip(errors) {
            choice.measured_px = error_px;
        }
        Ok(self.choices.iter().all(|choice| choice.is_kept()))
    }
}

/// What deciding needs.
#[derive(Clone, Copy)]
pub(super) struct Desk<'a> {
    pub(super) assets: &'a dyn AssetReader,
    pub(super) limits: &'a JobLimits,
    pub(super) job: &'a JobContext<'a>,
    pub(super) model: CostModel,
    /// Whether samples are rays, which meet triangles alone.
    pub(super) traces_rays: bool,
}

/// Loads what the request names, and decides what it leaves open.
pub(super) fn settle(desk: Desk<'_>, request: &RenderRequest) -> Result<Settled> {
    let request = request.clone();
    let Some(tolerance_px) = request.own_camera_px() else {
        let inputs = Inputs::load(desk.assets, desk.limits, desk.job, &request.surface)?;
        return Ok(Settled::new(request, inputs, None));
    };
    let asked = request.surface.geometry.clone();
    let mut request = request;
    request.surface.geometry.refinement = Refinement::Uniform(0);
    let inputs = Inputs::load(desk.assets, desk.limits, desk.job, &request.surface)?;
    let camera = exact::camera(desk.job.cancel, &inputs, &request)?;
    let within = within(asked.tolerance(), tolerance_px, &camera, &request);
    let mut settled = Settled::new(request, inputs, Some(camera));
    if settled.request.surface.method == Method::Auto {
        let mut passes = Vec::new();
        let asked = settled.request.clone();
        let of_heights = || grounds(desk, &settled.inputs, &asked);
        let grounds = inputs::timed(desk.job.progress, "height_facts", &mut passes, of_heights)?;
        let choose = || weigh(desk, &settled.inputs, &grounds, (&asked, &camera), tolerance_px);
        let weighed = inputs::timed(desk.job.progress, "choose", &mut passes, choose)?;
        let is_still = |w: &Weighing<'_>| !w.chosen().method.moves_vertices() && w.chosen().method != Method::Flat;
        let bent = || rest::bent(desk, &settled.inputs, &asked, weighed.iter().any(is_still));
        let bent = inputs::timed(desk.job.progress, "decode_bumps", &mut passes, bent)?;
        realised::realise(desk, &mut settled, &weighed, &within, &bent)?;
        settled.passes = passes;
    } else {
        settled.request.surface.geometry.refinement = within;
        settled.inputs.plans = Plans::make(&mut settled.inputs.scene, &settled.request.surface.geometry, desk.limits)?;
    }
    Ok(settled)
}

/// As asked, with the camera for a view.
fn within(asked: Option<&Tolerance>, tolerance_px: f64, camera: &RenderCamera, request: &RenderRequest) -> Refinement {
    match (lens::within(tolerance_px, camera, [request.width, request.height]), asked) {
        (Refinement::Tolerance(own), Some(asked)) => {
            Refinement::Tolerance(Tolerance { allowed: own.allowed, ..asked.clone() })
        }
        (own, _) => own,
    }
}
