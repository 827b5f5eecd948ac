//! Tables and push constants of simplification on the device; see `simplify.glsl`.

mirrors! {
    /// A triangle of the result.
    #[derive(Eq)]
    pub struct Facet {
        pub gv: [u32; 3],
        pub base: u32,
    }

    /// What is known of drawing a vertex into a neighbour.
    pub struct Candidate {
        /// [`NOWHERE`]: it may not go; one less: any way costs at least the error.
        pub to: u32,
        /// The largest of the triangles that come of it, local units.
        pub error: f32,
    }

    /// A base ge: its gvs, and how many base triangles have it.
    #[derive(Eq)]
    pub struct Sheets {
        pub gv: [u32; 2],
        pub count: u32,
    }

    /// A side between two triangles that may be turned.
    #[derive(Eq)]
    pub struct Flip {
        /// The triangle across, or [`NOWHERE`].
        pub other: u32,
        /// Its corner off the side.
        pub d: u32,
    }

    pub struct StarCountsParams {
        pub count: u32,
    }

    pub struct StarFillParams {
        pub count: u32,
    }

    pub struct SimplifyPlacesParams {
        pub count: u32,
    }

    pub struct CollapseSlotsParams {
        pub count: u32,
        pub first: u32,
    }

    pub struct CollapseMovesParams {
        pub count: u32,
        pub first: u32,
        pub tolerance: f32,
    }

    pub struct CollapseEstimateParams {
        pub count: u32,
        pub first: u32,
    }

    pub struct CollapsePlacesParams {
        pub count: u32,
        pub first: u32,
    }

    pub struct CollapseCandidateParams {
        pub count: u32,
        pub first: u32,
        pub tolerance: f32,
    }

    pub struct CollapseSelectParams {
        pub count: u32,
        pub round: u32,
    }

    pub struct CollapseApplyParams {
        pub count: u32,
    }

    pub struct CollapsePackParams {
        pub count: u32,
    }

    pub struct FlipFindParams {
        pub count: u32,
        pub tolerance: f32,
    }

    pub struct FlipPlacesParams {
        pub count: u32,
    }

    pub struct FlipChooseParams {
        pub count: u32,
        pub tolerance: f32,
    }

    pub struct FlipApplyParams {
        pub count: u32,
    }

    pub struct FlipAroundParams {
        pub count: u32,
    }
}

/// No vertex, no triangle.
pub const NOWHERE: u32 = u32::MAX;
