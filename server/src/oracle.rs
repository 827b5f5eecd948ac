//! The oracle: what is right, and by how much anything is off. f64 on the CPU, written from the definitions
//! and with other code than the passes and their twins, which it judges.
//!
//! | file | answers |
//! |---|---|
//! | `field.rs` | a map as the bilinear function it stands for |
//! | `surface.rs`, `surface/` | where the displaced surface is, and how far a triangle may be from it |
//! | `smooth.rs`, `smooth/` | smooth bases as polynomials |
//! | `parameter.rs`, `interval_jet.rs` | numbers, derivatives and bounds the surface is evaluated with |
//! | `dicing.rs`, `dicing/` | the surface as triangles with a certified residual |
//! | `sheet.rs`, `sheet/` | how near a mesh or a surface comes to a point |
//! | `hausdorff.rs` | how far two of them are apart, as an interval |
//! | `overlay.rs` | the same of meshes that lie over each other without folds, at once |
//! | `samples.rs` | the same at places spread evenly, with normals |
//! | `sampled_error.rs` | how far a result is found to be from its surface |
//! | `measure.rs`, `cracks.rs` | everything that is told of two of them |
//! | `bvh.rs` | which boxes are near a point, on a ray, or touched by a box |
//! | `metrics.rs` | how far two images are apart |
//! | `triangle_error.rs` | how far at most a flat triangle is from the map it stands for |
//! | `height_field.rs` | where a ray meets a map first |
//! | `ray.rs` | what a ray hits first, without leaks |
//! | `image.rs` | what a scene of triangles looks like |
//! | `predicates.rs` | on which side of a line or plane a point lies, exactly |
//! | `topology.rs` | which corners of triangles are one place, and which edges they share |
//! | `invariants.rs` | whether a mesh or surface keeps what it must |
//! | `facts.rs` | area, volume, stretch, self-intersections and the like of one mesh |

pub mod bvh;
pub mod cracks;
pub mod dicing;
pub mod facts;
pub mod field;
pub mod hausdorff;
pub mod height_field;
pub mod image;
pub mod interval_jet;
pub mod invariants;
pub mod measure;
pub mod metrics;
pub mod overlay;
pub mod parameter;
pub mod predicates;
pub mod ray;
pub mod reprojection;
pub mod sampled_error;
pub mod samples;
pub mod sheet;
pub mod smooth;
pub mod surface;
#[cfg(test)]
mod test_maps;
pub mod topology;
pub mod triangle_error;
