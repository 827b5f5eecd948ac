//! Which triangles have which texels: those whose centres lie in them by their texture coordinates. Triangles that share
//! a side leave no texel between them and share none, as long as they lie on its two sides.

use glam::{DVec2, DVec3};
use rayon::prelude::*;

use super::Sheet;
use crate::domain::{Error, Result};

/// Claims of one map at most: what a map of the largest size has when all of it is covered twice.
const MOST: f64 = (1u64 << 25) as f64;

/// A texel whose centre a triangle of the sheet covers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Claim {
    /// Row-major, from the top.
    pub texel: u32,
    pub triangle: u32,
    /// Weights of the second and the third corner.
    pub b: [f32; 2],
}

impl Claim {
    #[must_use]
    pub fn barycentrics(&self) -> DVec3 {
        let [b1, b2] = self.b.map(f64::from);
        DVec3::new(1.0 - b1 - b2, b1, b2)
    }
}

/// All claims, by triangle and then row. Coordinates outside 0 to 1 repeat. Fails where the triangles cover so many
/// texels that they must lie on each other many times; `name` is that of the mesh.
pub fn claims(sheet: &Sheet, size: [u32; 2], name: &str) -> Result<Vec<Claim>> {
    // With the rows and columns that are gone through where a sliver covers next to nothing.
    let area = |triangle: usize| {
        let corners = sheet.on_map(triangle, size);
        0.5 * doubled_area(corners).abs() + extent(corners.map(|c| c.x)) + extent(corners.map(|c| c.y))
    };
    let covered: f64 = (0..sheet.triangles.len()).into_par_iter().map(area).sum();
    if covered <= MOST {
        let of = |triangle: usize| of_triangle(sheet.on_map(triangle, size), triangle as u32, size);
        return Ok((0..sheet.triangles.len()).into_par_iter().flat_map_iter(of).collect());
    }
    let map = f64::from(size[0]) * f64::from(size[1]);
    let message = format!(
        "the texture coordinates of mesh '{name}' cover {covered:.3e} texels of a normal map of {} x {}, {:.1} times the map; at most {MOST:.3e} are taken: unwrap the mesh so that no two places share a texel, or lower normal_map_size",
        size[0],
        size[1],
        covered / map
    );
    Err(Error::invalid("geometry.normals", message))
}

fn of_triangle(corners: [DVec2; 3], triangle: u32, size: [u32; 2]) -> Vec<Claim> {
    let area = doubled_area(corners);
    let mut found = Vec::new();
    if area == 0.0 || !area.is_finite() {
        return found;
    }
    let (low, high) = span(corners.map(|c| c.y));
    for row in low..=high {
        let y = row as f64 + 0.5;
        let Some((left, right)) = crossing(corners, y) else { continue };
        for column in (left - 1.0).floor() as i64..=(right + 1.0).floor() as i64 {
            let centre = DVec2::new(column as f64 + 0.5, y);
            let Some(b) = inside(corners, area, centre) else { continue };
            let [x, y] = [column.rem_euclid(i64::from(size[0])), row.rem_euclid(i64::from(size[1]))];
            let texel = (y * i64::from(size[0]) + x) as u32;
            found.push(Claim { texel, triangle, b: [b.y as f32, b.z as f32] });
        }
    }
    found
}

fn extent(of: [f64; 3]) -> f64 {
    of.into_iter().fold(f64::NEG_INFINITY, f64::max) - of.into_iter().fold(f64::INFINITY, f64::min)
}

/// The rows whose centres may lie between.
fn span(y: [f64; 3]) -> (i64, i64) {
    let low = y.into_iter().fold(f64::INFINITY, f64::min);
    let high = y.into_iter().fold(f64::NEG_INFINITY, f64::max);
    ((low - 0.5).floor() as i64, (high - 0.5).ceil() as i64)
}

/// Where a row enters the triangle and where it leaves it, but for rounding.
fn crossing(corners: [DVec2; 3], y: f64) -> Option<(f64, f64)> {
    let sides = (0..3).map(|k| (corners[k], corners[(k + 1) % 3]));
    let at = |(p, q): (DVec2, DVec2)| {
        let between = p.y.min(q.y) <= y && y <= p.y.max(q.y);
        let along = if p.y == q.y { 0.0 } else { (y - p.y) / (q.y - p.y) };
        between.then_some(p.x + along * (q.x - p.x))
    };
    let places = || sides.clone().filter_map(at);
    let left = places().reduce(f64::min)?;
    Some((left, places().reduce(f64::max)?))
}

/// Barycentrics of a centre that the triangle has; on a side, one of the two triangles there has it.
fn inside(corners: [DVec2; 3], area: f64, centre: DVec2) -> Option<DVec3> {
    let mut b = DVec3::ZERO;
    for k in 0..3 {
        let (p, q) = (corners[(k + 1) % 3], corners[(k + 2) % 3]);
        let side = area.signum() * beside(p, q, centre);
        let along = area.signum() * (q - p);
        let owns = along.y < 0.0 || (along.y == 0.0 && along.x > 0.0);
        if side < 0.0 || (side == 0.0 && !owns) {
            return None;
        }
        b[k] = side / area.abs();
    }
    Some(b / b.element_sum())
}

/// Twice the area of p, q, c; of q, p, c it is the exact negative.
fn beside(p: DVec2, q: DVec2, c: DVec2) -> f64 {
    let ordered = (p.x, p.y) < (q.x, q.y);
    let (from, to) = if ordered { (p, q) } else { (q, p) };
    let area = (to - from).perp_dot(c - from);
    if ordered { area } else { -area }
}

fn doubled_area([a, b, c]: [DVec2; 3]) -> f64 {
    (b - a).perp_dot(c - a)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sheet(uvs: Vec<[f32; 2]>, triangles: Vec<[u32; 3]>) -> Sheet {
        Sheet { uvs, triangles, ..Sheet::default() }
    }

    /// A fan around a place that is no texel's centre, in the square from 0 to 1.
    fn fan(centre: [f32; 2]) -> Sheet {
        let uvs = vec![[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0], centre];
        sheet(uvs, vec![[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]])
    }

    fn counts(sheet: &Sheet, size: [u32; 2]) -> Vec<u32> {
        let mut counts = vec![0; (size[0] * size[1]) as usize];
        for claim in claims(sheet, size, "wall").unwrap() {
            counts[claim.texel as usize] += 1;
        }
        counts
    }

    #[test]
    fn triangles_that_fill_a_square_have_every_texel_once() {
        for centre in [[0.5, 0.5], [0.3, 0.7], [0.53125, 0.46875], [0.2, 0.9]] {
            assert!(counts(&fan(centre), [16, 16]).iter().all(|count| *count == 1), "{centre:?}");
            assert!(counts(&fan(centre), [37, 5]).iter().all(|count| *count == 1), "{centre:?}");
        }
    }

    #[test]
    fn a_claim_lies_where_its_texel_does() {
        let sheet = fan([0.3, 0.7]);
        for claim in claims(&sheet, [16, 16], "wall").unwrap() {
            let uv = sheet.uv(claim.triangle as usize, claim.barycentrics());
            let centre = DVec2::new(f64::from(claim.texel % 16) + 0.5, f64::from(claim.texel / 16) + 0.5) / 16.0;
            assert!(uv.distance(centre) < 1e-6, "{claim:?} at {uv}");
        }
    }

    #[test]
    fn coordinates_outside_repeat() {
        let uvs = vec![[-1.0, 2.0], [0.0, 2.0], [0.0, 3.0], [-1.0, 3.0]];
        let outside = sheet(uvs, vec![[0, 1, 2], [0, 2, 3]]);
        assert!(counts(&outside, [8, 8]).iter().all(|count| *count == 1));
    }

    #[test]
    fn a_mesh_tiled_too_often_is_refused_with_the_remedy() {
        let uvs = vec![[0.0, 0.0], [100.0, 0.0], [0.0, 100.0]];
        let error = claims(&sheet(uvs, vec![[0, 1, 2]]), [1024, 1024], "wall").unwrap_err();
        assert_eq!(error.field.as_deref(), Some("geometry.normals"));
        for part in ["'wall'", "5000.2 times", "unwrap", "normal_map_size"] {
            assert!(error.message.contains(part), "{part}: {}", error.message);
        }
    }
}
