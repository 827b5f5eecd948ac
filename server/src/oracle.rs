//! The oracle: what is right, and by how much anything is off. f64 on the CPU, written from the definitions
//! and with other code than the passes and their twins, which it judges.
//!
//! | file | answers |
//! |---|---|
//! | `field.rs` | a map as the bilinear function it stands for |
//! | `bvh.rs` | which boxes are near a point, on a ray, or touched by a box |
//! | `triangle_error.rs` | how far at most a flat triangle is from the map it stands for |
//! | `height_field.rs` | where a ray meets a map first |

pub mod bvh;
pub mod field;
pub mod height_field;
#[cfg(test)]
mod test_maps;
pub mod triangle_error;
