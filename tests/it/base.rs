//! Smooth bases: what they are in closed form, that they never crack, and that the devices and the oracle agree on them.

mod closed_forms;
mod limits;
mod whole;

use displace_server::domain::{
    base::bend,
    cancel::Cancel,
    mesh::Mesh,
    request::{Base, Geometry},
};
use displace_tests::{meshes::TestMesh, surfaces::uniform};

const SMOOTH: [Base; 3] = [Base::Pn, Base::Phong, Base::Loop];

/// The mesh with its base, and tangents for details that read them.
fn bent(mesh: &TestMesh, base: Base) -> Mesh {
    let mut mesh = mesh.to_mesh();
    bend(&mut mesh, base, &Cancel::default()).expect("a test mesh is small");
    mesh
}

fn geometry(level: u32, base: Base) -> Geometry {
    Geometry { base, ..uniform(level) }
}
