//! Tables of the bound of the distance from triangles to the surface, and push constants of the `bound_*` and
//! `pyramid_*` passes; see `bound.glsl`. Places count units of 2^-24.

mirrors! {
    /// A triangle within a base triangle: barycentrics b1, b2 of its corners.
    #[derive(Eq)]
    pub struct FacetPlace {
        pub base: u32,
        pub a: [u32; 2],
        pub b: [u32; 2],
        pub c: [u32; 2],
    }

    /// A piece of an edge between two attribute vertices.
    #[derive(Eq)]
    pub struct Line {
        pub av: [u32; 2],
        /// First, and the one after the last.
        pub layers: [u32; 2],
        /// Where it starts, where it ends, and a place in between.
        pub along: [u32; 3],
    }

    /// A base triangle.
    pub struct BoundTriangle {
        pub av: [u32; 3],
        /// First, and the one after the last.
        pub layers: [u32; 2],
        /// Bit k: its ae k runs from corner k + 1 to corner k.
        pub reversed: u32,
        /// Index of its [`Ramps`], or `geometry::NONE`.
        pub ramps: u32,
        /// Least length of its directions.
        pub least: f32,
    }

    /// An attribute vertex.
    pub struct BoundVertex {
        pub direction: [f32; 3],
        pub normal: [f32; 3],
        /// What its sides agree on at a seam, less its own displacement; local units.
        pub correction: [f32; 3],
    }

    /// Texel space of an attribute vertex under one layer of its detail: the sum of both.
    pub struct TexelPlace {
        pub whole: [i32; 2],
        /// In [0, 1).
        pub rest: [f32; 2],
    }

    /// The ramps along the sides of a base triangle.
    pub struct Ramps {
        /// [`RampPart`]s of each side, and how many.
        pub first: [u32; 3],
        pub count: [u32; 3],
        /// Of a barycentric.
        pub inverse_width: [f32; 3],
    }

    /// One side of a seam.
    pub struct RampPart {
        pub av: [u32; 2],
        pub layers: [u32; 2],
        /// How often it counts in what the triangle's own side is short of.
        pub share: f32,
    }

    /// Part of a map: over it the values are in `range`, and are value + x · slope[0] + y · slope[1] + something in
    /// `rest`, with x and y in texels from its first. Ranges are least and greatest.
    pub struct MapBlock {
        pub value: f32,
        pub slope: [f32; 2],
        pub rest: [f32; 2],
        pub range: [f32; 2],
    }

    /// All blocks of a map: level by level, the finest first, row by row.
    #[derive(Eq)]
    pub struct MapPyramid {
        /// Of the map's period, across and down.
        pub cells: [i32; 2],
        /// Index of the first block.
        pub first: u32,
        /// The level of one block.
        pub top: u32,
    }

    /// A rectangle of texel space, sides included.
    pub struct Window {
        pub low: [f32; 2],
        pub high: [f32; 2],
    }

    /// Where the search over a large region begins; see `bound_plane.glsl`.
    pub struct MapSearch {
        pub around: Window,
        pub slope: [f32; 2],
        pub apart: f32,
        pub near: f32,
        pub low: [f32; 3],
        pub high: [f32; 3],
        pub period: [i32; 2],
        pub level: u32,
    }

    pub struct PyramidBlocksParams {
        pub count: u32,
        pub layer: u32,
    }

    pub struct PyramidLevelsParams {
        pub count: u32,
        pub layer: u32,
        /// 1 or more.
        pub level: u32,
    }

    /// A region on the map of a layer: lattice coordinates of its corners less `origin`.
    pub struct MapPlaces {
        pub x: [f32; 3],
        pub y: [f32; 3],
        pub origin: [i32; 2],
    }

    /// By what a region is bounded.
    pub struct MapUse {
        /// Or `geometry::NONE`.
        pub layer: u32,
        /// Of differences, unscaled.
        pub cap: f32,
    }

    pub struct BoundPlacesParams {
        pub count: u32,
        pub of_lines: u32,
        /// Number among the layers of a detail.
        pub layer: u32,
        /// Texel places of a vertex.
        pub stride: u32,
        /// Local units.
        pub cap: f32,
        /// Of a region that is not large: texels and crossings, about.
        pub most_texels: f32,
    }

    pub struct BoundMapsParams {
        pub count: u32,
        pub of_lines: u32,
        /// 1: maps count at their texels alone.
        pub at_texels: u32,
    }

    pub struct BoundSidesParams {
        /// Sides: three for each large region.
        pub count: u32,
        /// Place in the list of large regions.
        pub first: u32,
        pub of_lines: u32,
        pub at_texels: u32,
    }

    pub struct BoundStartsParams {
        pub count: u32,
        pub first: u32,
        pub of_lines: u32,
        /// Local units, over all layers.
        pub cap: f32,
        /// At most of a region.
        pub layers: u32,
    }

    pub struct BoundLargeParams {
        pub count: u32,
        pub first: u32,
        pub of_lines: u32,
        pub at_texels: u32,
    }

    pub struct BoundFieldsParams {
        pub count: u32,
        pub of_lines: u32,
        pub accumulate: u32,
    }

    pub struct BoundLineCountsParams {
        pub count: u32,
        pub cap: f32,
    }

    pub struct BoundLinesParams {
        pub count: u32,
    }

    pub struct BoundRampsParams {
        pub count: u32,
    }
}
