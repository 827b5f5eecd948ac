//! Tables of smooth bases; see `smooth.glsl`.

mirrors! {
    /// A part of a base triangle: either split into four, or one Bézier triangle. Node t is base triangle t as a whole.
    pub struct PatchNode {
        /// Index of the first of four parts, at the three corners and in the middle, or `geometry::NONE`.
        pub parts: u32,
        /// Index of the origin; the net follows, less the origin.
        pub points: u32,
        /// 2 to 4.
        pub degree: u32,
        /// Index of two quadratic nets, of normals and of directions; or `geometry::NONE`: the patch's own normals.
        pub normals: u32,
        /// Of a node that is a whole triangle: index of a mask of its corners and three directions, which take the place
        /// of the normals' there; or `geometry::NONE`.
        pub given: u32,
        /// The side normals are on: 1 or −1 where they go against the winding.
        pub side: f32,
    }

    pub struct FieldsParams {
        pub count: u32,
    }
}
