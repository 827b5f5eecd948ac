//! What an image is really off by.

use std::sync::Arc;

use crate::{
    domain::{detail::Detail, image::ImageSet, request::Geometry, scene::Scene},
    oracle::{
        reprojection::{self, reprojected},
        surface::{SeamChoice, Surface},
    },
};

/// Pixels that are looked at.
const MOST: usize = 16384;

/// Of each of `materials`, what 99 of 100 pixels that show it are off by; none where the image does not tell. The details
/// are those of each primitive of each mesh, as the surface has them that the image stands for.
pub(super) fn p99_px(
    (scene, details): (&Scene, &[Vec<Option<Arc<Detail>>>]),
    geometry: &Geometry,
    images: &ImageSet,
    materials: &[Option<usize>],
) -> Vec<Option<f64>> {
    let choice = SeamChoice::from(geometry);
    let pairs = scene.meshes.iter().zip(details);
    let surfaces: Vec<Surface<'_>> = pairs.map(|(m, details)| Surface::new(&m.mesh, details, choice)).collect();
    let pixels = reprojected(scene, &surfaces, images, MOST);
    materials.iter().map(|material| reprojection::p99_px(pixels.iter().filter(|p| p.material == *material))).collect()
}
