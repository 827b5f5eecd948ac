//! That fine triangles tile their base triangles: in whole numbers, so exactly.

use rayon::prelude::*;

use super::{Broken, points};
use crate::domain::{mesh::Mesh, surface::Surface};

type Point = [i64; 2];

/// The fine triangles of each base triangle cover it once and lie within it, and none has its corners the wrong way
/// round. Whole-number coordinates (i, j) are n = 2^level times the weights of the second and third corner.
///
/// Triangles that all run counter-clockwise, whose inner sides cancel in pairs and whose other sides run once round
/// the base triangle, cover every point of it once.
#[must_use]
pub fn partition(mesh: &Mesh, surface: &Surface) -> Option<Broken> {
    let lattice = Lattice::new(mesh, surface.level);
    let fault = |t: usize| lattice.fault(t, surface).map(|what| (t, what));
    let faults: Vec<(usize, String)> = (0..mesh.triangles.len()).into_par_iter().filter_map(fault).collect();
    Broken::of("partition", faults, |(t, what)| format!("base triangle {t}: {what}"))
}

struct Lattice<'a> {
    mesh: &'a Mesh,
    level: u32,
    n: i64,
    /// Points within a triangle, by rank: rows of constant j, in rising i.
    inner: Vec<Point>,
}

impl<'a> Lattice<'a> {
    fn new(mesh: &'a Mesh, level: u32) -> Self {
        let n = 1i64 << level;
        let inner = (1..n).flat_map(|j| (1..n - j).map(move |i| [i, j])).collect();
        Self { mesh, level, n, inner }
    }

    fn fault(&self, t: usize, surface: &Surface) -> Option<String> {
        let fine = &surface.triangles[t << (2 * self.level)..(t + 1) << (2 * self.level)];
        let mut sides = Vec::with_capacity(3 * fine.len());
        let mut double_area = 0;
        for ids in fine {
            let Some([a, b, c]) = self.corners(t, *ids) else {
                return Some(format!("{ids:?} has a vertex of elsewhere"));
            };
            let own = (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
            if own <= 0 {
                return Some(format!("{ids:?} has {own} / 2 lattice cells"));
            }
            double_area += own;
            sides.extend([[a, b], [b, c], [c, a]]);
        }
        if double_area != self.n * self.n {
            return Some(format!("its triangles have {double_area} / 2 lattice cells, not {} / 2", self.n * self.n));
        }
        self.loose_side(&mut sides)
    }

    /// A side that neither cancels with another nor lies once on the border of the base triangle.
    fn loose_side(&self, sides: &mut [[Point; 2]]) -> Option<String> {
        let undirected = |&[a, b]: &[Point; 2]| [a.min(b), a.max(b)];
        sides.sort_unstable_by_key(undirected);
        let loose = |group: &&[[Point; 2]]| match group {
            [side] => !self.on_border(*side),
            [one, other] => one[0] != other[1],
            _ => true,
        };
        sides
            .chunk_by(|a, b| undirected(a) == undirected(b))
            .find(loose)
            .map(|group| format!("side {:?} is loose", group[0]))
    }

    /// On the border and running with it.
    fn on_border(&self, [a, b]: [Point; 2]) -> bool {
        let n = self.n;
        let sum = |p: Point| p[0] + p[1];
        a[1] == 0 && b[1] == 0 && a[0] < b[0]
            || sum(a) == n && sum(b) == n && a[1] < b[1]
            || a[0] == 0 && b[0] == 0 && a[1] > b[1]
    }

    fn corners(&self, t: usize, ids: [u32; 3]) -> Option<[Point; 3]> {
        let [a, b, c] = ids.map(|v| self.point(t, v as usize));
        Some([a?, b?, c?])
    }

    /// Where a fine vertex lies in base triangle `t`.
    fn point(&self, t: usize, vertex: usize) -> Option<Point> {
        let (triangle, n) = (&self.mesh.triangles[t], self.n);
        let corners = [[0, 0], [n, 0], [0, n]];
        let avs = self.mesh.av_gv.len();
        if vertex < avs {
            return triangle.av.iter().position(|&av| av as usize == vertex).map(|corner| corners[corner]);
        }
        let (inner, interior) = points(self.level);
        let in_edges = vertex - avs;
        if in_edges < self.mesh.ae_av.len() * inner {
            let (ae, k) = (in_edges / inner, (in_edges % inner) as i64 + 1);
            let side = triangle.ae.iter().position(|&own| own as usize == ae)?;
            let forward = self.mesh.ae_av[ae][0] == triangle.av[side];
            let along = if forward { k } else { n - k };
            let (from, to) = (corners[side], corners[(side + 1) % 3]);
            return Some([0, 1].map(|axis| (from[axis] * (n - along) + to[axis] * along) / n));
        }
        let in_triangles = in_edges - self.mesh.ae_av.len() * inner;
        (in_triangles / interior == t).then(|| self.inner[in_triangles % interior])
    }
}
