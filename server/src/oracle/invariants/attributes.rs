//! That attributes are those of the base: at its corners to the bit, between them linear.

use super::Broken;
use crate::domain::{
    mesh::{Attribute, Mesh},
    surface::Surface,
};

/// Of the largest magnitude among the corners: a few roundings of f32.
const ROUNDING: f64 = 1.0 / (1 << 21) as f64;

/// Every attribute of a surface is the base's at avs and the mean of the corners by their weights elsewhere, so it
/// cannot jump within a chart. Joints and weights, which are blended otherwise, are left out.
#[must_use]
pub fn attributes(mesh: &Mesh, surface: &Surface) -> Option<Broken> {
    let pairs = mesh.attributes.iter().zip(&surface.attributes);
    let linear =
        pairs.filter(|(base, _)| !base.semantic.starts_with("JOINTS_") && !base.semantic.starts_with("WEIGHTS_"));
    let offences = linear.flat_map(|(base, fine)| {
        (0..surface.positions.len())
            .filter(move |vertex| !is_mean(base, fine, *vertex, &surface.site(mesh, *vertex)))
            .map(move |vertex| (base.semantic.as_str(), vertex))
    });
    Broken::of("attributes", offences, |(semantic, vertex)| format!("{semantic} of vertex {vertex}"))
}

fn is_mean(base: &Attribute, fine: &[f32], vertex: usize, (avs, weights): &([u32; 3], [f64; 3])) -> bool {
    (0..base.components).all(|k| {
        let Some(&found) = fine.get(vertex * base.components + k) else { return false };
        let corners = avs.map(|av| f64::from(base.values[av as usize * base.components + k]));
        let expected: f64 = corners.iter().zip(weights).map(|(value, weight)| value * weight).sum();
        let largest = corners.iter().fold(0f64, |most, value| most.max(value.abs()));
        let slack = if weights.contains(&1.0) { 0.0 } else { ROUNDING * largest };
        (f64::from(found) - expected).abs() <= slack
    })
}
