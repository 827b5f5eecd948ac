//! Distances and normals at places spread evenly over a sheet.

use glam::DVec3;
use rayon::prelude::*;

use super::sheet::Sheet;
use crate::domain::{Result, cancel::Cancel};

/// The distance from A to B over places spread evenly over A, and how its normals differ there.
pub fn sampled(a: &Sheet<'_>, b: &Sheet<'_>, count: usize, width: f64, cancel: &Cancel) -> Result<Vec<Sampled>> {
    let area = |t: u32| {
        let [p, q, r] = a.corners(t);
        (q - p).cross(r - p).length()
    };
    let mut total = 0.0;
    let areas: Vec<f64> = (0..a.triangles.len() as u32)
        .map(|t| {
            total += area(t);
            total
        })
        .collect();
    let one = |k: usize| -> Result<Option<Sampled>> {
        if k.is_multiple_of(1024) {
            cancel.check()?;
        }
        let triangle = areas.partition_point(|&sum| sum <= total * (k as f64 + 0.5) / count as f64) as u32;
        if triangle as usize >= a.triangles.len() {
            return Ok(None);
        }
        let at = spread(k);
        let near = b.near_enough(a.point(triangle, at), None, width);
        Ok(near.map(|near| {
            let (own, other) = (a.normal(triangle, at), b.normal(near.triangle, near.at));
            Sampled { distance: near.upper, normal_deg: own.angle_between(other).to_degrees() }
        }))
    };
    let samples: Vec<Option<Sampled>> = (0..count).into_par_iter().map(one).collect::<Result<_>>()?;
    Ok(samples.into_iter().flatten().collect())
}

/// The largest distance from around each vertex of A to B: of the vertex itself, and of the middles of its
/// triangles and of their sides, where a triangle that stands for a surface is farthest.
pub fn around_vertices(a: &Sheet<'_>, b: &Sheet<'_>, width: f64, cancel: &Cancel) -> Result<Vec<f64>> {
    let distance = |place: DVec3| b.near_enough(place, None, width).map_or(0.0, |near| near.upper);
    let mut farthest: Vec<f64> = a.positions.par_iter().map(|&place| distance(place)).collect();
    let middle = DVec3::splat(1.0 / 3.0);
    let ats = [middle, DVec3::new(0.5, 0.5, 0.0), DVec3::new(0.0, 0.5, 0.5), DVec3::new(0.5, 0.0, 0.5)];
    let of_triangle = |t: usize| -> Result<f64> {
        if t.is_multiple_of(1024) {
            cancel.check()?;
        }
        Ok(ats.map(|at| distance(a.point(t as u32, at))).into_iter().fold(0.0, f64::max))
    };
    let of_triangles: Vec<f64> = (0..a.triangles.len()).into_par_iter().map(of_triangle).collect::<Result<_>>()?;
    for (triangle, distance) in a.triangles.iter().zip(of_triangles) {
        triangle.iter().for_each(|&v| farthest[v as usize] = farthest[v as usize].max(distance));
    }
    Ok(farthest)
}

/// One of the places.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sampled {
    /// World units.
    pub distance: f64,
    /// Between shading normals; not a number where either has none.
    pub normal_deg: f64,
}

/// Barycentrics spread evenly (R2, Roberts 2018), folded into the triangle.
fn spread(k: usize) -> DVec3 {
    let (u, v) = ((k as f64 * 0.754_877_666_246_693).fract(), (k as f64 * 0.569_840_290_998_053).fract());
    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
    DVec3::new(1.0 - u - v, u, v)
}
