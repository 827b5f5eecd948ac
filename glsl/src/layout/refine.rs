//! Tables and push constants of refinement. Barycentrics and places along edges count units of 2^-24.

mirrors! {
    /// A geometric vertex: of a base gv (kind 0), on a base ge (1) with `param[0]` from its first gv, or inside a
    /// base triangle (2) with `param` = b1, b2.
    #[derive(Eq)]
    pub struct RefinedVertex {
        pub kind: u32,
        pub owner: u32,
        pub param: [u32; 2],
    }

    /// A geometric edge: of a base ge (kind 1), or inside a base triangle (2).
    pub struct RefinedEdge {
        pub gv: [u32; 2],
        /// On the flat base, local units.
        pub length_square: f32,
        pub kind: u32,
        pub owner: u32,
        /// See `reference/keys.rs`.
        pub key: u32,
    }

    /// Edge k joins vertices k and k + 1.
    #[derive(Eq)]
    pub struct RefinedTriangle {
        pub gv: [u32; 3],
        pub ge: [u32; 3],
        pub base: u32,
    }

    /// A base triangle. Bit k of `reversed`: its ge k runs from corner k + 1 to corner k.
    #[derive(Eq)]
    pub struct RefineBase {
        pub gv: [u32; 3],
        pub ge: [u32; 3],
        pub reversed: u32,
    }

    pub struct RefineNewParams {
        pub count: u32,
    }

    pub struct RefinePlacesParams {
        pub count: u32,
    }

    pub struct RefineJudgeParams {
        pub count: u32,
        /// Local units.
        pub allowed: f32,
    }

    pub struct RefineMarkParams {
        pub count: u32,
        pub closing: u32,
    }

    pub struct RefineCountParams {
        pub count: u32,
    }

    pub struct RefineVerticesParams {
        pub count: u32,
    }

    pub struct RefineEdgesParams {
        pub count: u32,
        pub marked: u32,
        pub vertices: u32,
    }

    pub struct RefineTrianglesParams {
        pub count: u32,
        pub edges: u32,
        pub marked: u32,
        pub vertices: u32,
    }
}

/// Units of a whole side.
pub const UNIT: u32 = 1 << 24;

/// Kinds of vertices and edges.
pub mod kind {
    pub const CORNER: u32 = 0;
    pub const EDGE: u32 = 1;
    pub const INTERIOR: u32 = 2;
}
