//! What refinement to a tolerance says of its result.

/// How near the triangles of one base mesh are to its surface.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Fit {
    /// No place is farther from the surface, both ways, mesh-local units. With views: `tolerance_local` of the plan
    /// times the largest ratio of a triangle's distance to what is allowed there.
    pub bound_local: f64,
    /// The tolerance that the result keeps: that of the plan, or, where the budget ended refinement, the bound.
    pub tolerance_local: f64,
    /// Whether the bound is proven. Where it is not, some detail has no bound, or the plan asks at texels alone.
    pub certified: bool,
    /// Rounds of splitting edges.
    pub rounds: u32,
    /// Rounds of collapsing them.
    pub collapse_rounds: u32,
    /// Whether `max_triangles` of the plan ended refinement before the tolerance was kept.
    pub budget_reached: bool,
}
