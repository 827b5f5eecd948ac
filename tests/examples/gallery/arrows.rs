//! What is taken for the S tangent, as darts on stripes of s and t: the pictures of CySlice's page.

use displace_tests::meshes::TestMesh;

use crate::scenes::{lying, sheet};

/// `normal` stands up; the others lie on the sheet.
pub(crate) const KINDS: [&str; 5] = ["normal", "dpdu", "deriv", "printed", "right"];

/// s and t at a place of the patch, whose own u and v they do not follow: sheared and turned, and mirrored beyond the
/// middle.
fn texture_at(u: f64, v: f64) -> [f64; 2] {
    let (s, t) = (u + 0.5 * v, v - 0.35 * u);
    if u < 0.5 { [s, t] } else { [1.0 - s, t + 0.7 * (u - 0.5)] }
}

/// Direction of a dart along u and v of the patch.
///
/// `deriv` is `Deriv(P, s) = Du(P) / Du(s) + Dv(P) / Dv(s)`, `printed` is `dPdu Dv(t) - dPdv Du(t)`, and `right` is that
/// with the sign of the texture's determinant.
fn direction(kind: &str, u: f64, v: f64) -> [f64; 2] {
    const STEP: f64 = 1e-4;
    let ([s, t], [s1, t1], [s2, t2]) = (texture_at(u, v), texture_at(u + STEP, v), texture_at(u, v + STEP));
    let [su, tu, sv, tv] = [s1 - s, t1 - t, s2 - s, t2 - t].map(|x| x / STEP);
    let sign = (su * tv - sv * tu).signum();
    let [a, b] = match kind {
        "dpdu" => [1.0, 0.0],
        "deriv" => [1.0 / su, 1.0 / sv],
        "printed" => [tv, -tu],
        _ => [sign * tv, -sign * tu],
    };
    [a / a.hypot(b), b / a.hypot(b)]
}

/// The patch with 8 x 6 darts, dark by the rows of the map that the patch does not reach.
pub(crate) fn mesh(kind: &str) -> TestMesh {
    let mut mesh = sheet(32, 32, lying, |u, v| texture_at(u, v).map(|x| 0.5 * x));
    for (i, j) in (0..8).flat_map(|i| (0..6).map(move |j| (i, j))) {
        let (u, v) = ((f64::from(i) + 0.5) / 8.0, (f64::from(j) + 0.5) / 6.0);
        dart(&mut mesh, kind, [u, v]);
    }
    mesh
}

fn dart(mesh: &mut TestMesh, kind: &str, [u, v]: [f64; 2]) {
    let (x, z) = (2.0 * u - 1.0, 2.0 * v - 1.0);
    let ([a, b], up) = if kind == "normal" { ([0.0, 0.0], 0.3) } else { (direction(kind, u, v), 0.0) };
    let side = if kind == "normal" { [0.035, 0.0] } else { [-0.035 * b, 0.035 * a] };
    let first = mesh.positions.len() as u32;
    for (along, across) in [(0.0, -1.0), (0.0, 1.0), (0.22, 0.0)] {
        let lift = 0.02 + up * along / 0.22;
        let place = [x + along * a + across * side[0], lift, z + along * b + across * side[1]];
        mesh.positions.push(place.map(|x| x as f32));
        mesh.normals.push([0.0, 1.0, 0.0]);
        mesh.uvs.push([0.5, 186.0 / 256.0]);
    }
    mesh.triangles.push([first, first + 1, first + 2]);
}
