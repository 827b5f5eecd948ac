//! Where scenarios are measured: device and twins, watched for what must hold anywhere.

use std::{
    cell::{Cell, RefCell},
    sync::Arc,
};

use displace_glsl::{
    methods::Method,
    reference::relief::{Course, MOST_STEPS, March, ReliefMap},
};
use rayon::prelude::*;

use super::{
    judge::{Ledger, Rule},
    own::Own,
};
use crate::{
    domain::{
        Error, Result,
        cancel::NoProgress,
        detail::Detail,
        image::{ImagePlan, ImageSet, RenderScene},
        mesh::Mesh,
        plan::SurfacePlan,
        request::{Geometry, Refinement},
        surface::Surface,
    },
    jobs::WorkContext,
    oracle::invariants,
    render::JobContext,
};

/// Steps and reads that no march may go beyond: exact's own bound.
const MOST_READS: u32 = 1 << 17;
/// Rays that one thread marches one after the other.
const LOT: usize = 64;

pub(super) struct Lab<'a> {
    pub(super) context: &'a WorkContext<'a>,
    pub(super) own: &'a Own,
    ledger: RefCell<Ledger>,
    /// Things of a kind that were made again: marches, surfaces, images.
    again: Cell<[bool; 3]>,
}

impl<'a> Lab<'a> {
    pub(super) fn new(context: &'a WorkContext<'a>, own: &'a Own) -> Self {
        Self { context, own, ledger: RefCell::default(), again: Cell::default() }
    }

    pub(super) fn into_ledger(self) -> Ledger {
        self.ledger.into_inner()
    }

    pub(super) fn note(&self, rule: Rule, fault: Option<String>) {
        self.ledger.borrow_mut().note(rule, fault);
    }

    /// Whether this is the first of a kind, which is made twice.
    fn is_first(&self, kind: usize) -> bool {
        let mut again = self.again.get();
        let first = !again[kind];
        again[kind] = true;
        self.again.set(again);
        first
    }

    /// By the f64 twin.
    pub(super) fn marches(&self, method: Method, map: &ReliefMap, courses: &[Course]) -> Result<Vec<March>> {
        self.context.cancel.check()?;
        let marcher = method.marcher().ok_or_else(|| Error::internal("a method that marches not"))?;
        let setting = f64::from(marcher.setting);
        let run = || -> Vec<March> {
            courses.par_iter().with_min_len(LOT).map(|course| (marcher.twin)(map, course, setting)).collect()
        };
        let marches = run();
        if self.is_first(0) {
            let same = run() == marches;
            self.note(Rule::SameBytes, (!same).then(|| format!("{} marches", method.name())));
        }
        for march in &marches {
            self.watch(method, march);
        }
        Ok(marches)
    }

    fn watch(&self, method: Method, march: &March) {
        let is_finite = march.s.is_finite() && march.place.is_finite();
        self.note(Rule::Finite, (!is_finite).then(|| format!("{}: {march:?}", method.name())));
        let most = if method == Method::Exact { MOST_READS } else { MOST_STEPS + 8 };
        let unbounded = march.capped || march.steps > most || march.fetches > MOST_READS;
        self.note(Rule::BoundedMarch, unbounded.then(|| format!("{}: {march:?}", method.name())));
    }

    /// Displaced by the device, uniformly: nothing of what welding made sound may be torn.
    pub(super) fn displaced(&self, mesh: &Mesh, detail: &Arc<Detail>, geometry: &Geometry) -> Result<Surface> {
        let Refinement::Uniform(level) = geometry.refinement else {
            return Err(Error::internal("a tolerance that was not planned"));
        };
        let details = vec![Some(Arc::clone(detail)); mesh.primitives.len()];
        self.planned(mesh, &details, &SurfacePlan::uniform(0, mesh, level, geometry)?)
    }

    /// As [`Self::displaced`], of a base that is torn itself: finite is all that it must be.
    pub(super) fn displaced_torn(&self, mesh: &Mesh, detail: &Arc<Detail>, level: u32) -> Result<Surface> {
        let plan = SurfacePlan::uniform(0, mesh, level, &super::meshes::uniform(level))?;
        let (surface, _) = self.context.executor.displace(&self.quiet(), &plan, mesh, &[Some(Arc::clone(detail))])?;
        let broken = invariants::not_finite("positions_finite", &surface.positions);
        self.note(Rule::Finite, broken.map(|broken| format!("{}: {broken}", mesh.name)));
        Ok(surface)
    }

    pub(super) fn planned(&self, mesh: &Mesh, details: &[Option<Arc<Detail>>], plan: &SurfacePlan) -> Result<Surface> {
        self.context.cancel.check()?;
        let run = || Ok::<_, Error>(self.context.executor.displace(&self.quiet(), plan, mesh, details)?.0);
        let surface = run()?;
        if self.is_first(1) {
            let same = run()? == surface;
            self.note(Rule::SameBytes, (!same).then(|| format!("the surface of {}", mesh.name)));
        }
        self.look_over(mesh, &surface);
        Ok(surface)
    }

    /// Files the checks of a surface under the rules they are of.
    fn look_over(&self, mesh: &Mesh, surface: &Surface) {
        let broken = invariants::of_surface(mesh, surface);
        let told = |is_finite: bool| {
            let of = |rule: &str| rule.ends_with("_finite") == is_finite;
            let first = broken.iter().find(|broken| of(broken.rule));
            first.map(|broken| format!("{}: {broken}", mesh.name))
        };
        self.note(Rule::Finite, told(true));
        self.note(Rule::NoCrack, told(false));
    }

    /// An image, by the device.
    pub(super) fn shot(&self, scene: &RenderScene, size: [u32; 2]) -> Result<ImageSet> {
        self.supersampled(scene, size, 1)
    }

    /// The same, of so many samples along either side.
    pub(super) fn supersampled(&self, scene: &RenderScene, size: [u32; 2], supersample: u32) -> Result<ImageSet> {
        self.context.cancel.check()?;
        let plan = ImagePlan { supersample, ..ImagePlan::new(size[0], size[1], &scene.contents())? };
        let run = || Ok::<_, Error>(self.context.executor.render(&self.quiet(), &plan, scene)?.0);
        let image = run()?;
        if self.is_first(2) {
            let same = run()?.color == image.color;
            self.note(Rule::SameBytes, (!same).then(|| "an image".to_owned()));
        }
        let wrong = image.color.iter().position(|color| color.iter().any(|channel| !channel.is_finite()));
        self.note(Rule::Finite, wrong.map(|pixel| format!("pixel {pixel} {:?}", image.color[pixel])));
        if let Some(counters) = image.counters {
            self.note(Rule::BoundedMarch, (counters.cap_hits > 0).then(|| format!("{counters:?}")));
        }
        Ok(image)
    }

    /// What a scenario's own passes tell is not the job's.
    fn quiet(&self) -> JobContext<'a> {
        JobContext { cancel: self.context.cancel, progress: &NoProgress }
    }
}
