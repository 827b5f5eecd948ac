//! The vocabulary and the decisions of the server: no transport, no device, no async runtime.

pub mod base;
pub mod bump;
pub mod camera;
pub mod cancel;
pub mod chart;
pub mod describe;
pub mod detail;
pub mod digest;
pub mod encode;
pub mod environment;
pub mod error;
pub mod expression;
pub mod fit;
pub mod gltf;
pub mod grid;
pub mod image;
pub mod lods;
pub mod look;
pub mod maps;
pub mod measurement;
pub mod mesh;
pub mod normal_map;
pub mod plan;
pub mod preimage;
pub mod projection;
pub mod relief;
pub mod report;
pub mod request;
pub mod scene;
pub mod sequence;
pub mod surface;
pub mod weld;

pub use digest::Digest;
pub use error::{Error, ErrorKind, Result};
