//! The tessellator's passes on a Vulkan device, for flat bases whose details are height layers, within a tolerance that is
//! the same everywhere.
//!
//! | file | passes | makes |
//! |---|---|---|
//! | `tables.rs` | | what the bound reads of the base mesh |
//! | `pyramids.rs` | pyramid_blocks, pyramid_levels | planes near ever larger blocks of each map |
//! | `maps.rs` | bound_places, bound_maps, bound_sides, bound_starts, bound_large | how far a map is from linear over regions, few texels or many |
//! | `bounds.rs` | bound_fields, bound_line_counts, bound_lines, bound_ramps | the bound of listed triangles |
//! | `refine.rs` | refine_new, refine_places, refine_judge, and those of `render::refine` | rounds of refinement |
//! | `simplify.rs`, `simplify/` | star_*, simplify_places, collapse_*, flip_* | rounds of collapses and flips |

pub mod bounds;
mod maps;
pub mod pyramids;
mod refine;
pub mod simplify;
pub mod tables;

use std::sync::Arc;

use displace_glsl::{
    reference::{
        bound::Asked,
        collapse::{Facet, Simplified},
        place::Places,
    },
    tables::Tables,
};

use super::{Tessellated, Work, refine::Grown};
use crate::{
    domain::{Result, mesh::Mesh, plan::TolerancePlan},
    render::JobContext,
    vulkan::{Device, DeviceKind},
};
use bounds::Bounds;
pub use refine::refine;
use simplify::Simplification;

/// Whether the passes can do what is planned.
#[must_use]
pub fn supports(plan: &TolerancePlan, tables: &Tables) -> bool {
    plan.views.is_empty() && tables::supports(tables)
}

/// Whether a device is to do what is planned.
pub(super) fn is_chosen(device: &Device, plan: &TolerancePlan, tables: &Tables) -> bool {
    is_faster(device.info().kind) && supports(plan, tables)
}

/// Software devices run on the cores that the twins run on, and do more work: all moves at once, in rounds that wait for
/// the host.
fn is_faster(kind: DeviceKind) -> bool {
    kind != DeviceKind::Cpu
}

/// Whether jobs on a device of this kind ever run the pass `name`: where not, it need not be compiled.
#[must_use]
pub fn runs(kind: DeviceKind, name: &str) -> bool {
    let of_tessellation = ["pyramid_", "bound_", "refine_", "star_", "simplify_", "collapse_", "flip_"];
    is_faster(kind) || !of_tessellation.iter().any(|start| name.starts_with(start))
}

/// As [`super::tessellate_on`], on the device whether or not that is faster; what is planned is supported.
pub fn tessellate(
    device: &Arc<Device>,
    job: &JobContext<'_>,
    plan: &TolerancePlan,
    tables: &Tables,
    mesh: &Mesh,
) -> Result<Tessellated> {
    super::attempts(job, plan, tables, mesh, Some(device))
}

/// What all attempts at a tessellation share.
pub(super) struct OnDevice {
    device: Arc<Device>,
    bounds: Bounds,
    /// What f32 may take off a bound, local units.
    rounding: f64,
}

/// Of the largest height: bounds of small triangles are off by less.
const ROUNDING: f64 = 8.0 / (1 << 24) as f64;

impl OnDevice {
    pub(super) fn new(job: &JobContext<'_>, device: &Arc<Device>, places: &Places<'_>, asked: Asked) -> Result<Self> {
        let bounds = Bounds::new(job, device, places, asked)?;
        let rounding = ROUNDING * tables::largest_height(places.tables);
        Ok(Self { device: Arc::clone(device), bounds, rounding })
    }
}

impl Work<'_> {
    /// As `refine`; vertices are placed by the twin.
    pub(super) fn refine_on(&self, on: &OnDevice, share: f64, limit: u64) -> Result<Option<Grown>> {
        let allowed = share * self.within(self.plan.tolerance_local);
        let found = refine(self.job, &on.device, &on.bounds, self.places.base, allowed, limit)?;
        let Some((refined, rounds)) = found else { return Ok(None) };
        let mut grown = Grown { rounds, ..self.start()? };
        self.place(&refined, &mut grown)?;
        grown.mesh.triangles = refined.triangles.iter().map(Facet::from).collect();
        grown.mesh.vertices = refined.vertices;
        Ok(Some(grown))
    }

    /// As `simplify`.
    pub(super) fn simplify_on(&self, on: &OnDevice, mesh: &mut Simplified, sweeps: u32) -> Result<u32> {
        let allowed = self.within(self.plan.tolerance_local);
        let tolerance = (allowed - on.rounding).max(0.5 * allowed);
        let mut simplified = Simplification::new(self.job, &on.device, &on.bounds, self.places, mesh, tolerance)?;
        let rounds = simplified.run(sweeps)?;
        mesh.triangles = simplified.read()?;
        Ok(rounds)
    }
}
