//! The f64 twins of the passes: the same inputs, the same stems, no device. Together they are the
//! `reference` executor and the measure of every pass.

pub mod appearance;
pub mod attributes;

pub mod bound;
pub mod brdf;
pub mod brdf_table;
pub mod clip;
pub mod collapse;
pub mod compact;
pub mod displace;
pub mod displace_expression;
pub mod displace_vector;
pub mod expand;
pub mod flip;
pub mod frame;
pub mod jets_correction;
pub mod jets_expression;
pub mod jets_height;
pub mod jets_vector;
pub mod keys;
pub mod lights;
pub mod map;
pub mod mip;
pub mod normals_analytic;
pub mod normals_geometric;
pub mod place;
pub mod raster;
pub mod reconcile_corners;
pub mod reconcile_edges;
pub mod reconcile_interiors;
pub mod refine;
pub mod samples;
pub mod scan;
pub mod shade_phong;
pub mod shadow_rays;
pub mod site;
pub mod smooth;
pub mod sort;
pub mod subdivide;
pub mod surface;
pub mod texture;
pub mod transform;
pub mod triangles;
