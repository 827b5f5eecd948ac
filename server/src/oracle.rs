//! The oracle: what is right, and by how much anything is off. f64 on the CPU, written from the definitions
//! and with other code than the passes and their twins, which it judges.
//!
//! | file | answers |
//! |---|---|
//! | `field.rs` | a map as the bilinear function it stands for |
//! | `bvh.rs` | which boxes are near a point, on a ray, or touched by a box |
//! | `ray.rs` | what a ray hits first, without leaks |
//! | `image.rs` | what a scene of triangles looks like |

pub mod bvh;
pub mod field;
pub mod image;
pub mod ray;
