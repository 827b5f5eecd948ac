//! The plan of each base mesh, and what all of them take together.

use std::sync::Arc;

use super::JobLimits;
use crate::domain::{
    Error, Result,
    detail::Detail,
    gltf,
    mesh::Mesh,
    plan::{BYTES_PER_TRIANGLE, SurfacePlan, TessellationPlan},
    request::{Geometry, Refinement, Tolerance},
    scene::Scene,
    surface::Surface,
};

pub(super) struct Plans {
    each: Vec<SurfacePlan>,
    /// Of each mesh: what its plan tells, and once its surface is made, what that has.
    sizes: Vec<Size>,
    /// Most triangles of all meshes together, where a tolerance decides.
    budget: u64,
}

#[derive(Clone, Copy)]
struct Size {
    vertices: u64,
    triangles: u64,
}

impl Plans {
    /// Plans, and refuses what exceeds a limit. Warnings go to the scene.
    pub(super) fn make(scene: &mut Scene, geometry: &Geometry, limits: &JobLimits) -> Result<Self> {
        let plans = match &geometry.refinement {
            Refinement::Uniform(level) => Self::uniform(scene, *level, geometry)?,
            // Those of the base: nothing is displaced by them.
            Refinement::Exact => Self::uniform(scene, 0, geometry)?,
            Refinement::Tolerance(tolerance) => Self::within_tolerance(scene, tolerance, geometry, limits)?,
        };
        plans.check(scene, geometry, limits)?;
        Ok(plans)
    }

    fn uniform(scene: &Scene, level: u32, geometry: &Geometry) -> Result<Self> {
        let meshes = scene.meshes.iter().enumerate();
        let each = meshes.map(|(index, m)| SurfacePlan::uniform(index, &m.mesh, level, geometry));
        Ok(Self::new(each.collect::<Result<_>>()?, u64::MAX))
    }

    fn within_tolerance(
        scene: &mut Scene,
        tolerance: &Tolerance,
        geometry: &Geometry,
        limits: &JobLimits,
    ) -> Result<Self> {
        let of_host = scene.meshes.iter().map(|m| limits.host_bytes / output_bytes(&m.mesh, 1, 1)).min();
        let budget = geometry.max_triangles.unwrap_or(u64::MAX).min(of_host.unwrap_or(u64::MAX));
        let most = budget.min(limits.device_bytes / BYTES_PER_TRIANGLE);
        let mut each = Vec::with_capacity(scene.meshes.len());
        for index in 0..scene.meshes.len() {
            let (plan, warning) = SurfacePlan::within_tolerance(index, scene, tolerance, geometry, most)?;
            scene.warnings.extend(warning);
            each.push(plan);
        }
        Ok(Self::new(each, budget))
    }

    /// Keeps back what quantising will take of tolerances.
    pub(super) fn keep_back(&mut self, scene: &Scene, details: &[Vec<Option<Arc<Detail>>>]) {
        let free = gltf::obstacles(scene).into_iter().map(|obstacle| obstacle.is_none());
        for ((plan, free), (m, details)) in self.each.iter_mut().zip(free).zip(scene.meshes.iter().zip(details)) {
            if free {
                keep_back(plan, &m.mesh, details);
            }
        }
    }

    /// Triangles stay within base triangles from now on.
    pub(super) fn keep_within_base(&mut self) {
        for plan in &mut self.each {
            if let TessellationPlan::Tolerance(tolerance) = &mut plan.tessellation {
                tolerance.spans_base = false;
            }
        }
    }

    fn new(each: Vec<SurfacePlan>, budget: u64) -> Self {
        let sizes = each.iter().map(|plan| Size { vertices: plan.vertices, triangles: plan.triangles }).collect();
        Self { each, sizes, budget }
    }

    fn check(&self, scene: &Scene, geometry: &Geometry, limits: &JobLimits) -> Result<()> {
        if let Some(max) = geometry.max_triangles.filter(|max| self.triangles() > *max) {
            return Err(Error::invalid("geometry.max_triangles", self.too_many(geometry, max)));
        }
        if self.device_bytes() > limits.device_bytes {
            return Err(too_large(geometry, "device memory", self.device_bytes(), limits.device_bytes));
        }
        if self.output_bytes(scene) > limits.host_bytes {
            return Err(too_large(geometry, "host memory", self.output_bytes(scene), limits.host_bytes));
        }
        Ok(())
    }

    fn too_many(&self, geometry: &Geometry, max: u64) -> String {
        let triangles = self.triangles();
        match &geometry.refinement {
            Refinement::Uniform(level) => format!(
                "level {level} makes {triangles} triangles, more than the {max} allowed: lower the level or raise the limit"
            ),
            Refinement::Exact | Refinement::Tolerance(_) => format!(
                "the mesh has {triangles} triangles before any is split, more than the {max} allowed: raise the limit, or simplify the mesh"
            ),
        }
    }

    pub(super) fn each(&self) -> &[SurfacePlan] {
        &self.each
    }

    /// The plan of a mesh once those before it are made: it gets what they left of the budget, and leaves to those
    /// after it what they have at least.
    pub(super) fn next(&mut self, index: usize) -> &SurfacePlan {
        let others = self.triangles() - self.sizes[index].triangles;
        let left = self.budget.saturating_sub(others);
        let plan = &mut self.each[index];
        if let TessellationPlan::Tolerance(tolerance) = &mut plan.tessellation {
            tolerance.max_triangles = tolerance.max_triangles.min(left);
        }
        plan
    }

    /// Counts are those of the surface from now on.
    pub(super) fn made(&mut self, index: usize, surface: &Surface) {
        self.sizes[index] = Size { vertices: surface.vertices_used(), triangles: surface.triangles.len() as u64 };
    }

    /// Whether the counts are known before anything is made; else they are the least until then.
    pub(super) fn are_counted(&self) -> bool {
        self.each.iter().all(|plan| plan.tessellation.is_counted())
    }

    pub(super) fn triangles(&self) -> u64 {
        self.sizes.iter().map(|size| size.triangles).sum()
    }

    pub(super) fn vertices(&self) -> u64 {
        self.sizes.iter().map(|size| size.vertices).sum()
    }

    /// Vertices and triangles of all instances, each counted as often as its mesh is used.
    pub(super) fn instanced(&self, scene: &Scene) -> (u64, u64) {
        let sizes = scene.instances.iter().filter_map(|instance| self.sizes.get(instance.mesh));
        sizes.fold((0, 0), |(vertices, triangles), size| (vertices + size.vertices, triangles + size.triangles))
    }

    /// Meshes are worked on one after the other: the largest decides.
    pub(super) fn device_bytes(&self) -> u64 {
        self.each.iter().map(device_bytes).max().unwrap_or(0)
    }

    /// The streams of all surfaces, which are also the body of the GLB.
    pub(super) fn output_bytes(&self, scene: &Scene) -> u64 {
        let meshes = scene.meshes.iter().zip(&self.sizes);
        meshes.map(|(m, size)| output_bytes(&m.mesh, size.vertices, size.triangles)).sum()
    }
}

/// Keeps back what quantising will take of a tolerance.
pub(super) fn keep_back(plan: &mut SurfacePlan, mesh: &Mesh, details: &[Option<Arc<Detail>>]) {
    let TessellationPlan::Tolerance(tolerance) = &mut plan.tessellation else { return };
    let reach = details.iter().flatten().map(|detail| detail.reach(mesh)).fold(0.0, f64::max);
    // Without a bound it is seen afterwards whether the grid is fine enough.
    tolerance.keep_back(mesh, mesh.bulge() + if reach.is_finite() { reach } else { 0.0 });
}

/// A tolerance takes as much at least to work on the base alone.
fn device_bytes(plan: &SurfacePlan) -> u64 {
    match &plan.tessellation {
        TessellationPlan::Uniform { .. } => plan.device_bytes,
        TessellationPlan::Tolerance(_) => plan.device_bytes.max(plan.triangles * BYTES_PER_TRIANGLE),
    }
}

pub(super) fn output_bytes(mesh: &Mesh, vertices: u64, triangles: u64) -> u64 {
    let components: u64 = mesh.attributes.iter().map(|a| a.components as u64).sum();
    vertices * (24 + 4 * components) + triangles * 12
}

/// The error of a plan that asks for more than one job may take.
pub(super) fn too_large(geometry: &Geometry, what: &str, needed: u64, allowed: u64) -> Error {
    let (field, remedy) = match geometry.refinement {
        Refinement::Uniform(_) => ("geometry.uniform", "lower the level"),
        Refinement::Exact => ("mesh", "simplify the mesh"),
        Refinement::Tolerance(_) => ("geometry.tolerance", "allow more, or give max_triangles"),
    };
    let message = format!("the job needs {needed} bytes of {what}; this server gives a job {allowed}: {remedy}");
    Error::too_large(field, message)
}

#[cfg(test)]
mod tests;
