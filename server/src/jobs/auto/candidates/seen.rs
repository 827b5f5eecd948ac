//! The patches of a material that a camera sees, and what methods do on them.

use displace_glsl::methods::Method;
use glam::DVec2;

use crate::domain::{
    chart::Setting,
    choose::{
        facts::{HeightFacts, Window},
        patch::PatchView,
        patches::{over_view, patches_of, view_of},
        predict::predict,
    },
    cost::Work,
    image::RenderCamera,
    relief::Relief,
    request::{RenderRequest, Shadows},
    scene::Scene,
};

/// Samples of a pixel, each of which is marched.
const SAMPLES: f64 = 4.0;
/// Rays of a sample through prisms, of which it meets more than one.
const SHELL_RAYS: f64 = 2.0;
/// Triangles of a square that is split no further, after collapsing.
const TRIANGLES: f64 = 1.2;
/// Turns of splitting a patch into four that are counted.
const MOST_SPLITS: u32 = 5;

pub(super) struct Seen<'a> {
    request: &'a RenderRequest,
    facts: HeightFacts,
    patches: Vec<PatchView>,
    /// Of some part nothing is known, as where it reaches behind the eye.
    has_unknown: bool,
}

impl<'a> Seen<'a> {
    pub(super) fn new(
        scene: &Scene,
        material: Option<usize>,
        relief: &Relief,
        camera: &RenderCamera,
        request: &'a RenderRequest,
    ) -> Self {
        let facts = HeightFacts::new(&relief.map);
        let (mut patches, mut unknown) = (Vec::new(), 0);
        for instance in &scene.instances {
            let view = view_of(camera, instance, [request.width, request.height]);
            let seen = patches_of(scene, instance.mesh, &|other| other == material, relief, &view);
            patches.extend(seen.seen);
            unknown += seen.unknown;
        }
        Self { request, facts, patches, has_unknown: unknown > 0 }
    }

    /// Bounds of what 99 of 100 pixels, and of what the outline, is off by.
    pub(super) fn predicted(&self, method: Method, shell: bool) -> [f64; 2] {
        if self.has_unknown || self.shadows_others(method) {
            return [f64::INFINITY; 2];
        }
        let setting = if shell { Setting::Shell } else { Setting::None };
        let of = |patch: &PatchView| (predict(method, setting, patch, &self.facts), patch.area_px);
        let (error_px, outline_px) = over_view(&self.patches.iter().map(of).collect::<Vec<_>>());
        [error_px, outline_px]
    }

    /// Heights per pixel shadow nothing but themselves, and bent normals not even that.
    fn shadows_others(&self, method: Method) -> bool {
        let marches = method.marcher().is_some_and(|marcher| marcher.finds_depth);
        self.request.look.shadows != Shadows::None && !(marches && self.request.look.shadows == Shadows::Map)
    }

    pub(super) fn work(&self, method: Method, shell: bool, tolerance_px: f64) -> Work {
        let image = f64::from(self.request.width) * f64::from(self.request.height);
        let covered: f64 = self.patches.iter().filter(|patch| patch.is_front).map(|patch| patch.area_px).sum();
        let work = Work { pixels: covered.min(image), ..Work::default() };
        if method.moves_vertices() {
            let triangles = self.patches.iter().map(|patch| self.triangles(patch, tolerance_px)).sum::<f64>();
            return Work { vertices: 0.5 * triangles, triangles, ..work };
        }
        if method.marcher().is_none() {
            return work;
        }
        let rays = work.pixels * SAMPLES * if shell { SHELL_RAYS } else { 1.0 };
        let share = rays / covered.max(f64::MIN_POSITIVE);
        let fetches = |patch: &PatchView| patch.area_px * share * self.fetches(method, patch);
        Work { rays, fetches: self.patches.iter().map(fetches).sum(), ..work }
    }

    fn fetches(&self, method: Method, patch: &PatchView) -> f64 {
        match method {
            Method::Exact => {
                let [low, high] = self.facts.heights(&patch.window);
                let travel = patch.slope.low.abs().max(patch.slope.high.abs()).max_element() * (high - low);
                (4.0 + 0.5 * travel).min(40.0)
            }
            Method::ParallaxIterative => 4.0,
            _ => 1.0,
        }
    }

    /// About as many as a tolerance takes.
    fn triangles(&self, patch: &PatchView, tolerance_px: f64) -> f64 {
        let residual = tolerance_px * patch.least_w / patch.rise.max(f64::MIN_POSITIVE);
        TRIANGLES * self.leaves(&patch.window, residual, MOST_SPLITS)
    }

    fn leaves(&self, window: &Window, residual: f64, splits: u32) -> f64 {
        if splits == 0 || self.facts.residual(window, window.size()) <= residual {
            return 1.0;
        }
        let middle = 0.5 * (window.low + window.high);
        let part = |x: bool, y: bool| {
            let pick = |after: bool, low: f64, mid: f64, high: f64| if after { (mid, high) } else { (low, mid) };
            let (x0, x1) = pick(x, window.low.x, middle.x, window.high.x);
            let (y0, y1) = pick(y, window.low.y, middle.y, window.high.y);
            Window { low: DVec2::new(x0, y0), high: DVec2::new(x1, y1) }
        };
        [(false, false), (true, false), (false, true), (true, true)]
            .map(|(x, y)| self.leaves(&part(x, y), residual, splits - 1))
            .iter()
            .sum()
    }
}
