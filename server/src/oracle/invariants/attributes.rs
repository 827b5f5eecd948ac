//! That attributes are those of the base: at its corners to the bit, between them linear.

use super::{Broken, points};
use crate::domain::{
    mesh::{Attribute, Mesh},
    surface::Surface,
};

/// Of the largest magnitude among the corners: a few roundings of f32.
const ROUNDING: f64 = 1.0 / (1 << 21) as f64;

/// Every attribute of a surface is the base's at avs and the mean of the corners by lattice weight elsewhere, so it
/// cannot jump within a chart. Joints and weights, which are blended otherwise, are left out.
#[must_use]
pub fn attributes(mesh: &Mesh, surface: &Surface) -> Option<Broken> {
    let pairs = mesh.attributes.iter().zip(&surface.attributes);
    let linear =
        pairs.filter(|(base, _)| !base.semantic.starts_with("JOINTS_") && !base.semantic.starts_with("WEIGHTS_"));
    let offences = linear.flat_map(|(base, fine)| {
        stencils(mesh, surface.level)
            .enumerate()
            .filter(move |(vertex, stencil)| !is_mean(base, fine, *vertex, stencil))
            .map(move |(vertex, _)| (base.semantic.as_str(), vertex))
    });
    Broken::of("attributes", offences, |(semantic, vertex)| format!("{semantic} of vertex {vertex}"))
}

/// Base avs and their weights.
type Stencil = ([u32; 3], [f64; 3]);

fn is_mean(base: &Attribute, fine: &[f32], vertex: usize, (avs, weights): &Stencil) -> bool {
    (0..base.components).all(|k| {
        let Some(&found) = fine.get(vertex * base.components + k) else { return false };
        let corners = avs.map(|av| f64::from(base.values[av as usize * base.components + k]));
        let expected: f64 = corners.iter().zip(weights).map(|(value, weight)| value * weight).sum();
        let largest = corners.iter().fold(0f64, |most, value| most.max(value.abs()));
        let slack = if weights.contains(&1.0) { 0.0 } else { ROUNDING * largest };
        (f64::from(found) - expected).abs() <= slack
    })
}

/// Of all fine vertices, in their order.
fn stencils(mesh: &Mesh, level: u32) -> impl Iterator<Item = Stencil> {
    let n = 1u32 << level;
    let part = move |k: u32| f64::from(k) / f64::from(n);
    let corners = (0..mesh.av_gv.len() as u32).map(|av| ([av; 3], [1.0, 0.0, 0.0]));
    let along = move |&[a, b]: &[u32; 2]| (1..n).map(move |k| ([a, b, b], [part(n - k), part(k), 0.0]));
    let edges = mesh.ae_av.iter().flat_map(along);
    let inner = points(level).1;
    let within = mesh.triangles.iter().filter(move |_| inner > 0).flat_map(move |t| {
        let av = t.av;
        (1..n).flat_map(move |j| (1..n - j).map(move |i| (av, [part(n - i - j), part(i), part(j)])))
    });
    corners.chain(edges).chain(within)
}
