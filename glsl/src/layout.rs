//! The structs that cross to the shaders. Each is written by hand on both sides; the offsets reflected
//! from SPIR-V are compared at compile time, so drift is an error that names the field.

/// Declares `repr(C)` structs that must lie as the GLSL structs of the same names do (scalar layout).
/// The push constants `Params` of pass `x_y` are called `XYParams` here.
macro_rules! mirrors {
    ($($(#[$meta:meta])* pub struct $name:ident { $($(#[$field_meta:meta])* pub $field:ident: $ty:ty,)* })*) => {$(
        $(#[$meta])*
        #[repr(C)]
        #[derive(Clone, Copy, Debug, Default, PartialEq, bytemuck::Pod, bytemuck::Zeroable)]
        pub struct $name { $($(#[$field_meta])* pub $field: $ty,)* }

        const _: () = {
            use crate::offsets::$name as glsl;
            $(assert!(
                core::mem::offset_of!($name, $field) == glsl::$field,
                concat!(stringify!($name), ".", stringify!($field), " is not where the GLSL struct has it")
            );)*
            assert!(
                [$(stringify!($field)),*].len() == glsl::MEMBERS,
                concat!(stringify!($name), " does not have as many members as the GLSL struct")
            );
            assert!(
                core::mem::size_of::<$name>() == glsl::SIZE,
                concat!(stringify!($name), " is not as large as the GLSL struct")
            );
        };
    )*};
}

mirrors! {
    /// Push constants of `fill`.
    pub struct FillParams {
        pub count: u32,
        pub value: u32,
    }
}

pub mod bound;
pub mod bump;
pub mod geometry;
pub mod light;
pub mod lists;
pub mod raster;
pub mod refine;
pub mod relief;
pub mod shadow;
pub mod simplify;
pub mod smooth;
