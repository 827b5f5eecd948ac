//! Structs and push constants of the geometry passes.

mirrors! {
    /// One step of an expression; see [`crate::expression`].
    pub struct Instruction {
        pub op: u32,
        pub value: f32,
    }

    /// The size of a subdivided mesh; see `lattice.glsl`.
    pub struct Lattice {
        pub level: u32,
        /// Base attribute vertices.
        pub corners: u32,
        /// Base attribute edges.
        pub edges: u32,
    }

    /// A base triangle: `ae[k]` joins `av[k]` and `av[(k + 1) % 3]`; bit k of `reversed` is set where it
    /// runs against the triangle.
    pub struct BaseTriangle {
        pub av: [u32; 3],
        pub ae: [u32; 3],
        pub reversed: u32,
        pub detail: u32,
    }

    pub struct BaseEdge {
        pub av: [u32; 2],
        pub detail: u32,
        /// Where it lies on a smooth base; see `patches::on_edge`.
        pub patch_code: u32,
    }

    /// How lattice coordinates along one axis of a map become texels.
    pub struct MapAxis {
        pub low: i32,
        pub high: i32,
        pub period: i32,
        pub top: i32,
        pub fold: i32,
        pub inverse_period: f32,
    }

    /// One layer of a detail; see `map.glsl`.
    pub struct Layer {
        pub kind: u32,
        pub first: u32,
        pub row: u32,
        pub scale: f32,
        pub midlevel: f32,
        pub texel_from_u: [f32; 3],
        pub texel_from_v: [f32; 3],
        pub across: MapAxis,
        pub down: MapAxis,
    }

    /// The sides of one geometric vertex or edge.
    pub struct Seam {
        pub first: u32,
        pub count: u32,
        pub distinct: u32,
    }

    /// A side of a seam: an av or an ae.
    pub struct SeamSide {
        pub id: u32,
        pub detail: u32,
        pub same_as: u32,
    }

    /// How a base triangle is corrected at its seams.
    pub struct Correction {
        pub seam: [u32; 3],
        pub rank: [u32; 3],
        pub inverse_width: [f32; 3],
    }

    /// A place where a detail is evaluated with derivatives.
    pub struct Sample {
        pub av: [u32; 3],
        pub detail: u32,
        pub b: [f32; 2],
        /// Where the site lies on a smooth base; see `patches`.
        pub patch_code: u32,
        pub weight: [f32; 3],
        pub turn: [f32; 2],
    }

    /// A place in a base triangle, by the weights of its second and its third corner.
    pub struct TrianglePlace {
        pub triangle: u32,
        pub b: [f32; 2],
    }

    pub struct SubdivideParams {
        pub count: u32,
        pub first: u32,
        pub block: u32,
        pub with_normals: u32,
        pub with_tangents: u32,
        pub lattice: Lattice,
    }

    pub struct RestParams {
        pub count: u32,
        pub first: u32,
    }

    pub struct DisplaceParams {
        pub count: u32,
        pub first: u32,
        pub accumulate: u32,
        pub layer: Layer,
    }

    pub struct DisplaceVectorParams {
        pub count: u32,
        pub first: u32,
        pub accumulate: u32,
        pub layer: Layer,
    }

    pub struct DisplaceExpressionParams {
        pub count: u32,
        pub first: u32,
        pub accumulate: u32,
        pub with_normals: u32,
        pub layer: Layer,
    }

    pub struct SamplesParams {
        pub count: u32,
        pub start: u32,
        pub block: u32,
        pub side: u32,
        pub rank: u32,
        pub rule: u32,
        pub lattice: Lattice,
    }

    pub struct JetsHeightParams {
        pub count: u32,
        pub detail: u32,
        pub layer: u32,
        pub accumulate: u32,
    }

    pub struct JetsVectorParams {
        pub count: u32,
        pub detail: u32,
        pub layer: u32,
        pub accumulate: u32,
    }

    pub struct JetsExpressionParams {
        pub count: u32,
        pub detail: u32,
        pub layer: u32,
        pub accumulate: u32,
    }

    pub struct JetsCorrectionParams {
        pub count: u32,
    }

    pub struct ReconcileCornersParams {
        pub count: u32,
        pub start: u32,
        pub first_sample: u32,
        pub rule: u32,
    }

    pub struct ReconcileEdgesParams {
        pub count: u32,
        pub start: u32,
        pub first_sample: u32,
        pub rule: u32,
        pub lattice: Lattice,
    }

    pub struct ReconcileInteriorsParams {
        pub count: u32,
        pub start: u32,
        pub lattice: Lattice,
    }

    pub struct NormalsAnalyticParams {
        pub count: u32,
        pub start: u32,
        pub first_sample: u32,
        pub block: u32,
        pub lattice: Lattice,
    }

    pub struct NormalsGeometricParams {
        pub count: u32,
        pub first: u32,
        pub block: u32,
        pub lattice: Lattice,
    }

    pub struct TrianglesParams {
        pub count: u32,
        pub first: u32,
        pub lattice: Lattice,
    }

    pub struct AttributesParams {
        pub count: u32,
        pub start: u32,
        pub to: u32,
        pub block: u32,
        pub components: u32,
        pub lattice: Lattice,
    }
}

/// Blocks of fine vertices, as the shaders number them.
pub mod block {
    pub const CORNERS: u32 = 0;
    pub const EDGES: u32 = 1;
    pub const INTERIORS: u32 = 2;
    /// Sides of geometric vertices, in `samples` alone.
    pub const SEAM_CORNERS: u32 = 3;
    /// Sides of geometric edges, in `samples` alone.
    pub const SEAM_EDGES: u32 = 4;
    /// Vertices and places that the host lists, in `samples` and `normals_analytic`.
    pub const PLACES: u32 = 5;
}

/// [`Layer::kind`].
pub mod kind {
    pub const HEIGHT: u32 = 0;
    pub const VECTOR_TANGENT: u32 = 1;
    pub const VECTOR_OBJECT: u32 = 2;
    pub const EXPRESSION: u32 = 3;
}

/// How the candidates of a seam's sides become one.
pub mod rule {
    pub const MEAN: u32 = 0;
    pub const DOMINANT: u32 = 1;
}

/// [`SamplesParams::side`] of samples at the vertex itself.
pub const OWN: u32 = 3;
/// No seam, no correction, no detail.
pub const NONE: u32 = u32::MAX;

/// Words of the `counters` stream.
pub mod counter {
    pub const FLIPPED: usize = 0;
    pub const NOT_FINITE: usize = 1;
    /// Bits of an f32 >= 0.
    pub const MISMATCH: usize = 2;
    pub const COUNT: usize = 3;
}
