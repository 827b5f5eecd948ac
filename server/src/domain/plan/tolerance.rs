//! What a tolerance asks of one base mesh, in the mesh's own units.

mod reserve;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::{MAX_PAGES, PAGE_ELEMENTS, view::ViewPlan};
use crate::domain::{
    Error, Result,
    mesh::Mesh,
    report::Warning,
    request::{Allowed, ErrorAt, Quality, Tolerance},
    scene::{Instance, Scene},
};
pub use reserve::Reserve;

/// Device memory that a triangle takes while it is refined and collapsed.
pub const BYTES_PER_TRIANGLE: u64 = 300;
/// Triangles of one mesh: half of what a stream holds, since edges outnumber triangles by half and more at borders.
pub const MOST_TRIANGLES: u64 = PAGE_ELEMENTS * MAX_PAGES / 2;
/// Nearer than this share of the scene's diagonal an eye sees everything as large as there: what it is inside of
/// would have no end.
const NEAREST: f64 = 1e-3;
/// Of the mesh's extent: below it, f32 positions decide the distance.
const LEAST: f64 = 4.0 / (1 << 24) as f64;
/// Views times instances of one mesh: each is asked for every triangle.
const MOST_VIEWS: usize = 4096;

/// How near the triangles of one base mesh stay to its surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct TolerancePlan {
    /// Largest distance allowed, mesh-local units; with views the least that is allowed anywhere.
    pub tolerance_local: f64,
    /// Units of the request (shares of the diagonal, world units, pixels) for one local unit, where the tolerance
    /// is `tolerance_local`.
    pub unit_per_local: f64,
    /// One for each view and instance; empty where the tolerance is the same everywhere.
    pub views: Vec<ViewPlan>,
    pub error_at: ErrorAt,
    pub quality: Quality,
    /// Refinement stops, complete and conforming, before it would make more triangles.
    pub max_triangles: u64,
    /// Whether the triangles of the result may span several base triangles where those are denser than the tolerance asks
    /// for: not where a normal map is tied to them, a skin or a morph target moves them, or views ask for more here than
    /// there.
    #[serde(default)]
    pub spans_base: bool,
    /// What `tolerance_local` and the views are short of what was asked for.
    #[serde(default)]
    pub reserve: Option<Reserve>,
}

impl TolerancePlan {
    /// Plans for `scene.meshes[index]`. A warning tells where less is asked for than f32 positions hold.
    ///
    /// Fails where the scene has no extent that a share or a pixel could refer to.
    pub fn new(
        scene: &Scene,
        index: usize,
        tolerance: &Tolerance,
        max_triangles: u64,
    ) -> Result<(Self, Option<Warning>)> {
        let Tolerance { allowed, error_at, quality } = tolerance;
        let mut plan = Self {
            tolerance_local: 0.0,
            unit_per_local: 0.0,
            views: views(scene, index, allowed)?,
            error_at: *error_at,
            quality: *quality,
            max_triangles: max_triangles.min(MOST_TRIANGLES),
            spans_base: false,
            reserve: None,
        };
        plan.tolerance_local = match allowed {
            Allowed::Diagonal(share) => share * diagonal(scene)? / largest_scale(scene, index),
            Allowed::World(world) => world / largest_scale(scene, index),
            Allowed::Pixels { .. } => plan.views.iter().map(ViewPlan::least).fold(f64::MAX, f64::min),
        };
        let warning = plan.clamp(&scene.meshes[index].mesh, allowed);
        Ok((plan, warning))
    }

    /// Largest distance allowed to what lies in the sphere, mesh-local units.
    ///
    /// The sphere holds a triangle and the displaced surface that it stands for. Without views this is
    /// `tolerance_local`; else the least that a view allows ([`ViewPlan::tolerance_at`]), never below it.
    #[must_use]
    pub fn tolerance_at(&self, centre: DVec3, radius: f64) -> f64 {
        if self.views.is_empty() {
            return self.tolerance_local;
        }
        let of_views = self.views.iter().map(|view| view.tolerance_at(centre, radius));
        of_views.fold(f64::MAX, f64::min).max(self.tolerance_local)
    }

    /// Largest distance allowed to a triangle with these displaced corners, mesh-local units. The surface it stands for
    /// lies around it by no more than that.
    #[must_use]
    pub fn allowed_to(&self, corners: [DVec3; 3]) -> f64 {
        if self.views.is_empty() {
            return self.tolerance_local;
        }
        let centre = corners.iter().sum::<DVec3>() / 3.0;
        let radius = corners.iter().fold(0.0, |most: f64, c| most.max(c.distance(centre)));
        self.tolerance_at(centre, radius + self.tolerance_at(centre, radius))
    }

    /// Keeps the tolerance above what positions resolve: below, the test for it would be noise.
    fn clamp(&mut self, mesh: &Mesh, allowed: &Allowed) -> Option<Warning> {
        let sphere = Sphere::around(mesh);
        let least = LEAST * sphere.extent;
        // With views what counts is how near the mesh is, not how near anything could be.
        let asked = self.tolerance_at(sphere.centre, sphere.radius);
        self.tolerance_local = self.tolerance_local.max(least);
        if asked >= least {
            self.unit_per_local = allowed.value() / self.tolerance_local;
            return None;
        }
        self.unit_per_local = allowed.value() / asked;
        let message = format!(
            "mesh '{}' is to stay within {asked:.3e} local units of its surface, but f32 positions that reach {:.3e} hold no less than {least:.3e}, which is kept instead: allow {:.3e} or more ({}), or move the mesh to its origin",
            mesh.name,
            sphere.extent,
            allowed.value() * least / asked,
            allowed.unit(),
        );
        Some(Warning::new("tolerance_clamped", message))
    }
}

/// Around the undisplaced mesh, mesh-local units.
struct Sphere {
    centre: DVec3,
    radius: f64,
    /// Of the mesh: the largest coordinate, or side of its box.
    extent: f64,
    /// Longest side of the mesh's box.
    longest: f64,
}

impl Sphere {
    fn around(mesh: &Mesh) -> Self {
        let points = || mesh.gv_position.iter().map(|p| DVec3::from_array(p.map(f64::from)));
        let low = points().reduce(DVec3::min).unwrap_or_default();
        let high = points().reduce(DVec3::max).unwrap_or_default();
        let longest = (high - low).max_element();
        let extent = low.abs().max(high.abs()).max_element().max(longest);
        Self { centre: 0.5 * (low + high), radius: 0.5 * (high - low).length(), extent, longest }
    }
}

fn diagonal(scene: &Scene) -> Result<f64> {
    if scene.diagonal > 0.0 {
        return Ok(scene.diagonal);
    }
    Err(Error::invalid(
        "geometry.tolerance",
        "the scene has no extent, so that neither a share of its diagonal nor a pixel says anything: give world units",
    ))
}

/// The instances that show anything of a mesh; the mesh as it is where none does.
fn uses(scene: &Scene, index: usize) -> Vec<Instance> {
    let of_mesh = scene.instances.iter().filter(|instance| instance.mesh == index);
    let visible: Vec<Instance> = of_mesh.filter(|instance| instance.singular_values()[1] > 0.0).copied().collect();
    if visible.is_empty() { vec![Instance::as_it_is(index)] } else { visible }
}

/// Most that any instance of a mesh enlarges a distance.
fn largest_scale(scene: &Scene, index: usize) -> f64 {
    uses(scene, index).iter().map(|instance| instance.singular_values()[1]).fold(0.0, f64::max)
}

fn views(scene: &Scene, index: usize, allowed: &Allowed) -> Result<Vec<ViewPlan>> {
    let Allowed::Pixels { tolerance_px, views } = allowed else { return Ok(Vec::new()) };
    let near_world = NEAREST * diagonal(scene)?;
    let uses = uses(scene, index);
    if views.len() * uses.len() > MOST_VIEWS {
        let message = format!(
            "{} views of {} instances of mesh '{}' are more than the {MOST_VIEWS} pairs allowed: give fewer views, or a tolerance in world units",
            views.len(),
            uses.len(),
            scene.meshes[index].mesh.name
        );
        return Err(Error::too_large("geometry.tolerance.pixels.views", message));
    }
    let pairs = views.iter().flat_map(|view| uses.iter().map(move |instance| (view, instance)));
    pairs.map(|(view, instance)| ViewPlan::new(view, instance, *tolerance_px, near_world)).collect()
}

#[cfg(test)]
mod tests;
