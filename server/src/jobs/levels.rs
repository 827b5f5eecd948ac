//! Levels of detail: from the same base and detail, each coarser than the one before it.

use super::{WorkContext, bumps, fits, inputs, inputs::Inputs, normal_maps, packing, plans};
use crate::domain::{
    Error, Result,
    gltf::{self, Chain, Level},
    lods,
    plan::{SurfacePlan, TessellationPlan, TolerancePlan},
    report::{self, Lod, PassTime, Warning},
    request::{Compression, DisplaceRequest, Tolerance},
    scene::Scene,
    surface::Surface,
};

/// All levels but the first, and what a report says of all.
#[derive(Debug, Default)]
pub(super) struct Levels {
    pub(super) chains: Vec<Chain>,
    pub(super) report: Vec<Lod>,
    pub(super) normal_maps: Vec<report::NormalMap>,
}

/// Fails where the mesh has levels of its own: those made of them would be told apart by nobody.
pub(super) fn check(scene: &Scene, levels: u32) -> Result<()> {
    let Some(node) = gltf::node_with_lods(scene).filter(|_| levels > 1) else { return Ok(()) };
    let message = format!(
        "{levels} levels are asked for, and nodes[{node}] of the mesh has levels of its own (MSFT_lod): leave lods out, and they pass through, or export the mesh without them"
    );
    Err(Error::invalid("lods", message))
}

/// Makes the levels below those that `surfaces` are. Warnings go to the scene.
pub(super) fn make(
    context: &WorkContext<'_>,
    inputs: &mut Inputs,
    surfaces: &[Surface],
    request: &DisplaceRequest,
    passes: &mut Vec<PassTime>,
) -> Result<Levels> {
    let Some(asked) = request.geometry.tolerance().filter(|_| request.lods > 1) else { return Ok(Levels::default()) };
    let maker = Maker {
        context,
        inputs,
        request,
        asked,
        may_quantize: gltf::obstacles(&inputs.scene).iter().map(Option::is_none).collect(),
    };
    let shown = gltf::shown_by_nodes(&inputs.scene);
    let of_maps = normal_maps::kept_bytes(inputs, &request.geometry, request.lods);
    let mut tally = Tally { bytes: inputs.plans.output_bytes(&inputs.scene) + of_maps, ..Tally::default() };
    let mut chains = Vec::new();
    for (mesh, surface) in surfaces.iter().enumerate() {
        let (chain, lods) = maker.chain(mesh, surface, shown[mesh], &mut tally, passes)?;
        if !chain.levels.is_empty() {
            chains.push(chain);
        }
        tally.lods.push(lods);
    }
    let report = summed(&tally.lods, request.lods);
    inputs.scene.warnings.extend(tally.warnings);
    Ok(Levels { chains, report, normal_maps: tally.normal_maps })
}

/// What all chains take together.
#[derive(Default)]
struct Tally {
    /// Of all surfaces so far, and of all normal maps.
    bytes: u64,
    /// Of each mesh, level 0 first.
    lods: Vec<Vec<Lod>>,
    normal_maps: Vec<report::NormalMap>,
    warnings: Vec<Warning>,
}

struct Maker<'a> {
    context: &'a WorkContext<'a>,
    inputs: &'a Inputs,
    request: &'a DisplaceRequest,
    asked: &'a Tolerance,
    /// Of each mesh.
    may_quantize: Vec<bool>,
}

/// One level as it is made.
struct Made {
    plan: SurfacePlan,
    level: Level,
}

impl Maker<'_> {
    fn chain(
        &self,
        mesh: usize,
        surface: &Surface,
        is_shown: bool,
        tally: &mut Tally,
        passes: &mut Vec<PassTime>,
    ) -> Result<(Chain, Vec<Lod>)> {
        let first = &self.inputs.plans.each()[mesh];
        let mut chain = Chain { mesh, levels: Vec::new(), coverages: Vec::new() };
        let mut lods = vec![lod(first, surface)];
        let mut tolerances_local = vec![tolerance_local(first, surface)];
        let levels = if is_shown { self.request.lods } else { 1 };
        for number in 1..levels {
            let before = chain.levels.last().map_or(surface, |level| &level.surface);
            let mut made = self.level(mesh, lods[number as usize - 1].tolerance, passes)?;
            if made.level.surface.triangles.len() >= before.triangles.len() {
                tally.warnings.push(self.ended(mesh, number, before, &made));
                break;
            }
            self.check_size(mesh, &made.level.surface, tally)?;
            lods.push(lod(&made.plan, &made.level.surface));
            tolerances_local.push(tolerance_local(&made.plan, &made.level.surface));
            let geometry = &self.request.geometry;
            let surface = (mesh, &made.level.surface);
            let maps = normal_maps::make(self.context, self.inputs, geometry, surface, number, passes)?;
            made.level.normal_maps = maps.maps;
            tally.normal_maps.extend(maps.report);
            chain.levels.push(made.level);
        }
        chain.coverages = lods::coverages(radius(surface), &tolerances_local);
        Ok((chain, lods))
    }

    /// The level after one that keeps `achieved`, in the unit of the request.
    fn level(&self, mesh: usize, achieved: f64, passes: &mut Vec<PassTime>) -> Result<Made> {
        let Inputs { scene, details, plans, .. } = self.inputs;
        let tolerance = Tolerance { allowed: self.asked.allowed.with_value(lods::STEP * achieved), ..*self.asked };
        let TessellationPlan::Tolerance(first) = &plans.each()[mesh].tessellation else {
            return Err(Error::internal("levels without a tolerance"));
        };
        let geometry = &self.request.geometry;
        let (mut plan, _) = SurfacePlan::within_tolerance(mesh, scene, &tolerance, geometry, first.max_triangles)?;
        let quantizes = self.request.compression != Compression::None && self.may_quantize[mesh];
        if quantizes {
            plans::keep_back(&mut plan, &scene.meshes[mesh].mesh, &details[mesh]);
        }
        let base = &scene.meshes[mesh].mesh;
        let (mut surface, times) = self.context.executor.displace(&self.context.job(), &plan, base, &details[mesh])?;
        inputs::add_times(passes, times);
        bumps::keep_base_normals(self.context, self.inputs, geometry, (mesh, &mut surface), passes)?;
        let grid = quantizes.then(|| packing::grid(&plan, &mut surface)).flatten();
        Ok(Made { plan, level: Level { surface, grid, normal_maps: Vec::new() } })
    }

    fn ended(&self, mesh: usize, number: u32, before: &Surface, made: &Made) -> Warning {
        let base = &self.inputs.scene.meshes[mesh].mesh;
        let triangles = [before, &made.level.surface].map(|surface| surface.triangles.len());
        let ended = Ended { number, of: self.request.lods, triangles, of_base: base.triangles.len() };
        Warning::new("lods_ended", ended.message(&base.name, lod(&made.plan, &made.level.surface).tolerance))
    }

    fn check_size(&self, mesh: usize, surface: &Surface, tally: &mut Tally) -> Result<()> {
        let base = &self.inputs.scene.meshes[mesh].mesh;
        tally.bytes += plans::output_bytes(base, surface.positions.len() as u64, surface.triangles.len() as u64);
        let allowed = self.context.limits.host_bytes;
        if tally.bytes <= allowed {
            return Ok(());
        }
        let message = format!(
            "{} levels need {} bytes of host memory or more; this server gives a job {allowed}: ask for fewer levels, or allow more",
            self.request.lods, tally.bytes
        );
        Err(Error::too_large("lods", message))
    }
}

/// A chain of fewer levels than were asked for.
struct Ended {
    number: u32,
    of: u32,
    /// Of the last level, and of the one that would have come after it.
    triangles: [usize; 2],
    of_base: usize,
}

impl Ended {
    /// `tolerance` is that of the level left out, in the unit of the request.
    fn message(&self, mesh: &str, tolerance: f64) -> String {
        let Self { number, of, triangles: [last, next], of_base } = self;
        let (why, remedy) = if last == of_base {
            ("which are the mesh's own, and no level has fewer", "ask for fewer levels, or simplify the mesh first")
        } else {
            ("so it would save nothing", "ask for fewer levels")
        };
        format!(
            "mesh '{mesh}' has {number} of {of} levels of detail: the next, within {tolerance:.3e}, would have {next} triangles, and the last has {last}, {why}: {remedy}"
        )
    }
}

/// The figures of one mesh; lengths in the unit of the request.
fn lod(plan: &SurfacePlan, surface: &Surface) -> Lod {
    let (tolerance, bound) = fits::kept(plan, surface).unwrap_or_default();
    Lod { triangles: surface.triangles.len() as u64, vertices: surface.positions.len() as u64, tolerance, bound }
}

/// Of all meshes, for as many levels as the longest chain has.
fn summed(meshes: &[Vec<Lod>], levels: u32) -> Vec<Lod> {
    let longest = meshes.iter().map(Vec::len).max().unwrap_or(0).min(levels as usize);
    let at = |level: usize| meshes.iter().filter_map(move |lods| lods.get(level).or(lods.last()));
    let sum = |a: Lod, b: &Lod| Lod {
        triangles: a.triangles + b.triangles,
        vertices: a.vertices + b.vertices,
        tolerance: a.tolerance.max(b.tolerance),
        bound: a.bound.max(b.bound),
    };
    (0..longest).map(|level| at(level).fold(Lod::default(), sum)).collect()
}

/// Largest distance allowed anywhere on the surface, mesh-local units.
fn tolerance_local(plan: &SurfacePlan, surface: &Surface) -> f64 {
    let (TessellationPlan::Tolerance(plan), Some(fit)) = (&plan.tessellation, surface.fit) else { return 0.0 };
    if plan.views.is_empty() {
        return fit.tolerance_local;
    }
    let looser = fit.tolerance_local / plan.tolerance_local;
    let allowed =
        surface.triangles.iter().map(|triangle| allowed(plan, triangle.map(|v| surface.positions[v as usize])));
    looser * allowed.fold(0.0, f64::max)
}

fn allowed(plan: &TolerancePlan, corners: [[f32; 3]; 3]) -> f64 {
    let corners = corners.map(|p| glam::DVec3::from_array(p.map(f64::from)));
    let centre = corners.iter().sum::<glam::DVec3>() / 3.0;
    // A sphere around more would be allowed less.
    plan.tolerance_at(centre, corners.iter().map(|p| p.distance(centre)).fold(0.0, f64::max))
}

/// Of a sphere around the displaced mesh, centred at its box, mesh-local units.
fn radius(surface: &Surface) -> f64 {
    let points = || surface.positions.iter().map(|p| glam::DVec3::from_array(p.map(f64::from)));
    let low = points().reduce(glam::DVec3::min).unwrap_or_default();
    let high = points().reduce(glam::DVec3::max).unwrap_or_default();
    let centre = 0.5 * (low + high);
    points().map(|p| p.distance(centre)).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_ended_a_chain_is_told_as_it_is() {
        let ended = Ended { number: 3, of: 8, triangles: [32, 32], of_base: 32 };
        let message = ended.message("wall", 0.5);
        for part in ["'wall' has 3 of 8", "within 5.000e-1", "would have 32", "the mesh's own", "simplify the mesh"] {
            assert!(message.contains(part), "{part}: {message}");
        }
        let message = Ended { triangles: [40, 41], ..ended }.message("wall", 0.5);
        assert!(message.contains("would have 41 triangles, and the last has 40"), "{message}");
        assert!(!message.contains("own") && !message.contains("simplify"), "{message}");
    }

    #[test]
    fn a_mesh_whose_chain_ended_counts_with_its_last_level() {
        let lod = |triangles, tolerance| Lod { triangles, vertices: triangles, tolerance, bound: tolerance };
        let meshes =
            [vec![lod(100, 1.0), lod(30, 4.0), lod(9, 16.0)], vec![lod(12, 1.0)], vec![lod(40, 2.0), lod(11, 8.0)]];
        let found = summed(&meshes, 8);
        assert_eq!(found.iter().map(|l| l.triangles).collect::<Vec<_>>(), [152, 53, 32]);
        assert_eq!(found.iter().map(|l| l.tolerance).collect::<Vec<_>>(), [2.0, 8.0, 16.0]);
    }
}
