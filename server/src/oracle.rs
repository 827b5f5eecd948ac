//! The oracle: what is right, and by how much anything is off. f64 on the CPU, written from the definitions
//! and with other code than the passes and their twins, which it judges.
//!
//! | file | answers |
//! |---|---|
//! | `field.rs` | a map as the bilinear function it stands for |
//! | `bvh.rs` | which boxes are near a point, on a ray, or touched by a box |
//! | `predicates.rs` | on which side of a line or plane a point lies, exactly |
//! | `topology.rs` | which corners of triangles are one place, and which edges they share |
//! | `invariants.rs` | whether a mesh or surface keeps what it must |
//! | `facts.rs` | area, volume, stretch, self-intersections and the like of one mesh |

pub mod bvh;
pub mod facts;
pub mod field;
pub mod invariants;
pub mod predicates;
pub mod topology;
