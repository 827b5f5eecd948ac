//! Which base triangles shade a vertex: those around it whose shading normals agree with its own. So hard
//! edges stay hard, and UV seams of a smooth surface stay smooth.

use std::collections::HashMap;

use displace_glsl::tables::Tables;
use rayon::prelude::*;

use crate::domain::{Error, Result, mesh::Mesh};

/// Normals within one degree are meant to be equal: the sides of a UV seam differ by quantisation only.
const CREASE_COSINE: f32 = 0.999_848;
/// Above this many pairs around one place, an attribute vertex is shaded by its own triangles alone.
const MAX_PAIRS: usize = 1 << 17;

/// Fills `contribution_first` and `contributions`: lists per av, then per ae.
pub fn fill(tables: &mut Tables, mesh: &Mesh) -> Result<()> {
    let vertices = (0..mesh.gv_position.len()).into_par_iter().flat_map_iter(|gv| around_vertex(mesh, gv));
    let edges = (0..mesh.ge_gv.len()).into_par_iter().flat_map_iter(|ge| around_edge(mesh, ge));
    let mut lists = vec![Vec::new(); mesh.av_gv.len() + mesh.ae_ge.len()];
    for (av, list) in vertices.collect::<Vec<_>>() {
        lists[av as usize] = list;
    }
    for (ae, list) in edges.collect::<Vec<_>>() {
        lists[mesh.av_gv.len() + ae as usize] = list;
    }
    let total: usize = lists.iter().map(Vec::len).sum();
    let points = u64::from(tables.segments().max(2) - 1);
    if total as u64 * points > u64::from(u32::MAX) {
        return Err(Error::too_large(
            "geometry.uniform",
            format!("mesh '{}' is too large at this level: lower the level", mesh.name),
        ));
    }
    tables.contribution_first.reserve(lists.len() + 1);
    tables.contributions.reserve(total);
    tables.contribution_first.push(0);
    for list in lists {
        tables.contributions.extend(list);
        tables.contribution_first.push(tables.contributions.len() as u32);
    }
    Ok(())
}

fn agree(mesh: &Mesh, a: u32, b: u32) -> bool {
    let (x, y) = (mesh.av_normal[a as usize], mesh.av_normal[b as usize]);
    a == b || x[0] * y[0] + x[1] * y[1] + x[2] * y[2] >= CREASE_COSINE
}

/// The list of each attribute vertex of a geometric vertex.
fn around_vertex(mesh: &Mesh, gv: usize) -> Vec<(u32, Vec<u32>)> {
    let av_of = |item: u32| mesh.triangles[(item / 3) as usize].av[(item % 3) as usize];
    lists(mesh, mesh.gv_av.list(gv), mesh.gv_corner.list(gv), av_of, |av, other| agree(mesh, av, other))
}

/// The list of each attribute edge of a geometric edge.
fn around_edge(mesh: &Mesh, ge: usize) -> Vec<(u32, Vec<u32>)> {
    let ae_of = |item: u32| mesh.triangles[(item / 3) as usize].ae[(item % 3) as usize];
    let ends_agree = |ae: u32, other: u32| {
        let ([from, to], [a, b]) = (mesh.ae_av[ae as usize], mesh.ae_av[other as usize]);
        agree(mesh, from, a) && agree(mesh, to, b)
    };
    lists(mesh, mesh.ge_ae.list(ge), mesh.ge_side.list(ge), ae_of, ends_agree)
}

/// For each of `ids`, those of `items` that shade it.
fn lists(
    mesh: &Mesh,
    ids: &[u32],
    items: &[u32],
    id_of: impl Fn(u32) -> u32,
    agree: impl Fn(u32, u32) -> bool,
) -> Vec<(u32, Vec<u32>)> {
    let mut own: HashMap<u32, Vec<u32>> = HashMap::new();
    if items.len() * ids.len() > MAX_PAIRS {
        items.iter().for_each(|&item| own.entry(id_of(item)).or_default().push(item));
    } else {
        for &id in ids {
            let shades = |item: &u32| id_of(*item) == id || agree(id, id_of(*item));
            own.insert(id, items.iter().copied().filter(shades).collect());
        }
    }
    ids.iter().map(|id| (*id, in_order(mesh, own.remove(id).unwrap_or_default()))).collect()
}

/// Sums are taken in the order of what the triangles join, not of their numbers: av ids depend on the
/// geometry alone, so permuted input gives the same bits.
fn in_order(mesh: &Mesh, mut items: Vec<u32>) -> Vec<u32> {
    items.sort_unstable_by_key(|item| {
        let (av, corner) = (mesh.triangles[(item / 3) as usize].av, (item % 3) as usize);
        [av[corner], av[(corner + 1) % 3], av[(corner + 2) % 3], *item]
    });
    items
}
