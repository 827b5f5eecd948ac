//! How far results are from the surface, by brute force: the oracle evaluates it, no bound is asked.

use displace_server::{
    domain::{
        mesh::Mesh,
        surface::{Place, Surface},
    },
    oracle::surface as oracle,
};
use glam::DVec3;
use rayon::prelude::*;

use super::cases::Case;

/// Places along a side of every triangle of the result.
const ALONG_SIDE: u32 = 8;
const UNIT: f64 = (1 << 24) as f64;

/// The greatest distance found between places of the surface and of the triangle above them, mesh-local units.
pub(super) fn farthest(case: &Case, surface: &Surface) -> f64 {
    let details = vec![Some(case.detail.clone()); case.mesh.primitives.len()];
    let truth = oracle::Surface::new(&case.mesh, &details, oracle::SeamChoice::from(&case.geometry));
    let of_base = |t: usize| {
        let fine = surface.triangles_of(t);
        let each = surface.triangles[fine].iter().map(|ids| of_triangle(&case.mesh, &truth, surface, t, *ids));
        each.fold(0.0, f64::max)
    };
    (0..case.mesh.triangles.len()).into_par_iter().map(of_base).reduce(|| 0.0, f64::max)
}

fn of_triangle(mesh: &Mesh, truth: &oracle::Surface<'_>, surface: &Surface, t: usize, ids: [u32; 3]) -> f64 {
    let places = ids.map(|id| barycentrics(mesh, t, surface.layout.place(mesh, id as usize)));
    let corners = ids.map(|id| DVec3::from_array(surface.positions[id as usize].map(f64::from)));
    let mut worst: f64 = 0.0;
    for i in 0..=ALONG_SIDE {
        for j in 0..=ALONG_SIDE - i {
            let share = DVec3::new(f64::from(i), f64::from(j), f64::from(ALONG_SIDE - i - j)) / f64::from(ALONG_SIDE);
            let blend = |of: [DVec3; 3]| of[0] * share.x + of[1] * share.y + of[2] * share.z;
            worst = worst.max(truth.position(t, blend(places)).distance(blend(corners)));
        }
    }
    worst
}

/// Where a fine vertex lies in a base triangle that has it.
fn barycentrics(mesh: &Mesh, t: usize, place: Place) -> DVec3 {
    let triangle = &mesh.triangles[t];
    let corner = |av: u32| triangle.av.iter().position(|own| *own == av).expect("a corner of its base triangle");
    let mut b = [0.0; 3];
    match place {
        Place::Corner { av } => b[corner(av)] = 1.0,
        Place::Edge { ae, along } => {
            let [from, to] = mesh.ae_av[ae as usize].map(corner);
            let along = f64::from(along) / UNIT;
            (b[from], b[to]) = (1.0 - along, along);
        }
        Place::Inside { b: [b1, b2], .. } => {
            let [b1, b2] = [b1, b2].map(|b| f64::from(b) / UNIT);
            b = [1.0 - b1 - b2, b1, b2];
        }
    }
    DVec3::from_array(b)
}
