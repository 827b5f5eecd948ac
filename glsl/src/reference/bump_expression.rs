//! Twin of `bump_expression`: how much formulas rise along two sides of a triangle, by dual numbers.

use glam::{DVec2, DVec3};

use crate::{
    expression::{Dual, Instruction, evaluate},
    layout::bump::BumpFormula,
};

/// A place on a triangle, by the values at its corners.
#[derive(Clone, Copy, Debug)]
pub struct Corners {
    /// Mesh-local.
    pub positions: [DVec3; 3],
    /// Mesh-local, of any length.
    pub normals: [DVec3; 3],
    /// Weights of the corners.
    pub at: DVec3,
}

/// From the first corner to the second, and to the third, were the formula as steep all along as it is there.
#[must_use]
pub fn rises(formula: &BumpFormula, code: &[Instruction], corners: &Corners, uvs: [DVec2; 3]) -> DVec2 {
    let height: Dual<2> = evaluate(code, &corners.variables(formula, uvs));
    DVec2::from_array(height.derivative) * f64::from(formula.scale)
}

impl Corners {
    /// u, v, x, y, z and the unit normal.
    fn variables(&self, formula: &BumpFormula, uvs: [DVec2; 3]) -> [Dual<2>; 8] {
        let affine = |row: [f32; 3]| {
            let [a, b, c] = row.map(f64::from);
            self.along_sides(uvs.map(|uv| a * uv.x + b * uv.y + c))
        };
        let place = |k: usize| self.along_sides(self.positions.map(|p| p[k]));
        let (n, [by_1, by_2]) = self.unit_normal();
        let normal = |k: usize| Dual::new(n[k], [by_1[k], by_2[k]]);
        let (u, v) = (affine(formula.map_u), affine(formula.map_v));
        [u, v, place(0), place(1), place(2), normal(0), normal(1), normal(2)]
    }

    fn along_sides(&self, [a, b, c]: [f64; 3]) -> Dual<2> {
        Dual::new(DVec3::new(a, b, c).dot(self.at), [b - a, c - a])
    }

    /// And its changes along the two sides.
    fn unit_normal(&self) -> (DVec3, [DVec3; 2]) {
        let [a, b, c] = self.normals;
        let sum = a * self.at.x + b * self.at.y + c * self.at.z;
        let inverse = 1.0 / sum.length().max(1e-12);
        let n = sum * inverse;
        (n, [b - a, c - a].map(|by| (by - n * n.dot(by)) * inverse))
    }
}
