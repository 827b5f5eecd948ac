//! Geometric and attribute edges by sorting keys, and what they say of the mesh's health.

use rayon::prelude::*;

use crate::domain::mesh::{Csr, Mesh, MeshHealth, Triangle};

/// Fills `triangles`, the edge tables and their counts; `corners[p]` are the avs of primitive p's triangles.
pub(super) fn build(mesh: &mut Mesh, corners: &[Vec<[u32; 3]>]) {
    let flat: Vec<(u32, [u32; 3])> =
        corners.iter().zip(0..).flat_map(|(list, primitive)| list.iter().map(move |&av| (primitive, av))).collect();
    let av_gv = &mesh.av_gv;
    let sides: Vec<[Side; 3]> = flat.par_iter().map(|&(p, av)| sides_of(p, av, av_gv)).collect();
    let ge_keys = distinct(sides.par_iter().flatten().map(|side| side.ge_key()).collect());
    let ge_of = |side: &Side| ge_keys.partition_point(|key| *key < side.ge_key()) as u32;
    let ae_key = |side: &Side| (u128::from(side.primitive) << 96) | (u128::from(ge_of(side)) << 64) | side.av_bits();
    let ae_keys = distinct(sides.par_iter().flatten().map(ae_key).collect());
    mesh.triangles = flat
        .par_iter()
        .zip(&sides)
        .map(|(&(primitive, av), sides)| {
            let ae = [0, 1, 2].map(|k| ae_keys.partition_point(|key| *key < ae_key(&sides[k])) as u32);
            Triangle { av, ae, primitive }
        })
        .collect();
    mesh.ge_gv = ge_keys.iter().map(|key| [(key >> 32) as u32, *key as u32]).collect();
    mesh.ae_av = ae_keys.iter().map(|key| [(key >> 32) as u32, *key as u32]).collect();
    mesh.ae_ge = ae_keys.iter().map(|key| (key >> 64) as u32).collect();
    let ge_of_side: Vec<u32> = mesh.triangles.iter().flat_map(|t| t.ae.map(|ae| mesh.ae_ge[ae as usize])).collect();
    mesh.ge_ae = Csr::from_pairs(mesh.ge_gv.len(), &super::numbered(mesh.ae_ge.iter().copied()));
    mesh.ge_side = Csr::from_pairs(mesh.ge_gv.len(), &super::numbered(ge_of_side.into_iter()));
    count(mesh);
}

fn distinct<T: Ord + Send>(mut keys: Vec<T>) -> Vec<T> {
    keys.par_sort_unstable();
    keys.dedup();
    keys
}

/// One side of a triangle, turned to run from the lower gv to the higher.
#[derive(Clone, Copy)]
struct Side {
    primitive: u32,
    gv: [u32; 2],
    av: [u32; 2],
}

impl Side {
    fn ge_key(&self) -> u64 {
        u64::from(self.gv[0]) << 32 | u64::from(self.gv[1])
    }

    fn av_bits(&self) -> u128 {
        u128::from(self.av[0]) << 32 | u128::from(self.av[1])
    }
}

fn sides_of(primitive: u32, av: [u32; 3], av_gv: &[u32]) -> [Side; 3] {
    [0, 1, 2].map(|k| {
        let mut av = [av[k], av[(k + 1) % 3]];
        let mut gv = av.map(|v| av_gv[v as usize]);
        if gv[0] > gv[1] {
            av.reverse();
            gv.reverse();
        }
        Side { primitive, gv, av }
    })
}

fn count(mesh: &mut Mesh) {
    let mut health = MeshHealth { ..mesh.health.clone() };
    for ge in 0..mesh.ge_gv.len() {
        match mesh.ge_side.list(ge) {
            [_] => health.boundary_edges += 1,
            [a, b] => {
                health.opposite_winding_edges += u32::from(ascends(mesh, *a) == ascends(mesh, *b));
                health.seam_edges += u32::from(mesh.ge_ae.list(ge).len() > 1);
            }
            _ => health.non_manifold_edges += 1,
        }
    }
    mesh.health = health;
}

/// Whether this side of its triangle runs from the lower gv to the higher.
fn ascends(mesh: &Mesh, side: u32) -> bool {
    let triangle = &mesh.triangles[side as usize / 3];
    let k = side as usize % 3;
    let gv = |k: usize| mesh.av_gv[triangle.av[k] as usize];
    gv(k) < gv((k + 1) % 3)
}
