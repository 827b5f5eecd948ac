//! That fine triangles tile their base triangles: in whole numbers, so exactly.

use displace_glsl::layout::refine::UNIT;
use rayon::prelude::*;

use super::Broken;
use crate::domain::{mesh::Mesh, surface::Surface};

type Point = [i64; 2];

/// The fine triangles of each base triangle cover it once and lie within it, and none has its corners the wrong way
/// round. Whole-number coordinates are the weights of the second and third corner in units of 2^-24.
///
/// Triangles that all run counter-clockwise, whose inner sides cancel in pairs and whose other sides run once round
/// the base triangle, cover every point of it once. Of triangles that span several nothing is asked.
#[must_use]
pub fn partition(mesh: &Mesh, surface: &Surface) -> Option<Broken> {
    if surface.layout.is_spanning() {
        return None;
    }
    let tiling = Tiling { mesh, surface };
    let fault = |t: usize| tiling.fault(t).map(|what| (t, what));
    let faults: Vec<(usize, String)> = (0..mesh.triangles.len()).into_par_iter().filter_map(fault).collect();
    Broken::of("partition", faults, |(t, what)| format!("base triangle {t}: {what}"))
}

/// Units of a whole side.
const SIDE: i64 = UNIT as i64;

struct Tiling<'a> {
    mesh: &'a Mesh,
    surface: &'a Surface,
}

impl Tiling<'_> {
    fn fault(&self, t: usize) -> Option<String> {
        let fine = &self.surface.triangles[self.surface.triangles_of(t)];
        let mut sides = Vec::with_capacity(3 * fine.len());
        let mut double_area = 0;
        for ids in fine {
            let Some([a, b, c]) = self.corners(t, *ids) else {
                return Some(format!("{ids:?} has a vertex of elsewhere"));
            };
            let own = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            if own <= 0 {
                return Some(format!("{ids:?} has {own} / 2 square units"));
            }
            double_area += own;
            sides.extend([[a, b], [b, c], [c, a]]);
        }
        if double_area != SIDE * SIDE {
            return Some(format!("its triangles have {double_area} / 2 square units, not {} / 2", SIDE * SIDE));
        }
        loose_side(&mut sides)
    }

    fn corners(&self, t: usize, ids: [u32; 3]) -> Option<[Point; 3]> {
        let [a, b, c] = ids.map(|v| self.point(t, v as usize));
        Some([a?, b?, c?])
    }

    /// Where a fine vertex lies in base triangle `t`.
    fn point(&self, t: usize, vertex: usize) -> Option<Point> {
        let [_, b1, b2] = self.surface.layout.place(self.mesh, vertex).within(self.mesh, t)?;
        Some([b1.into(), b2.into()])
    }
}

/// A side that neither cancels with another nor lies once on the border of the base triangle.
fn loose_side(sides: &mut [[Point; 2]]) -> Option<String> {
    let undirected = |&[a, b]: &[Point; 2]| [a.min(b), a.max(b)];
    sides.sort_unstable_by_key(undirected);
    let loose = |group: &&[[Point; 2]]| match group {
        [side] => !on_border(*side),
        [one, other] => one[0] != other[1],
        _ => true,
    };
    sides
        .chunk_by(|a, b| undirected(a) == undirected(b))
        .find(loose)
        .map(|group| format!("side {:?} is loose", group[0]))
}

/// On the border and running with it.
fn on_border([a, b]: [Point; 2]) -> bool {
    let sum = |p: Point| p[0] + p[1];
    a[1] == 0 && b[1] == 0 && a[0] < b[0]
        || sum(a) == SIDE && sum(b) == SIDE && a[1] < b[1]
        || a[0] == 0 && b[0] == 0 && a[1] > b[1]
}
