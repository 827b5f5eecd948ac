//! Which base triangles shade a vertex: those around it whose shading normals agree with its own. So hard
//! edges stay hard, and UV seams of a smooth surface stay smooth.

use displace_glsl::tables::Tables;
use rayon::prelude::*;

use crate::domain::{Error, Result, mesh::Mesh};

/// Normals within one degree are meant to be equal: the sides of a UV seam differ by quantisation only.
const CREASE_COSINE: f32 = 0.999_848;
/// Above this many pairs around one place, an attribute vertex is shaded by its own triangles alone.
const MAX_PAIRS: usize = 1 << 17;

/// Fills `contribution_first` and `contributions`: lists per av, then per ae.
pub fn fill(tables: &mut Tables, mesh: &Mesh) -> Result<()> {
    let avs = (0..mesh.av_gv.len() as u32).into_par_iter().map(|av| around_vertex(mesh, av));
    let aes = (0..mesh.ae_ge.len() as u32).into_par_iter().map(|ae| around_edge(mesh, ae));
    let lists: Vec<Vec<u32>> = avs.chain(aes).collect();
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

fn around_vertex(mesh: &Mesh, av: u32) -> Vec<u32> {
    let gv = mesh.av_gv[av as usize] as usize;
    let corners = mesh.gv_corner.list(gv);
    let crowded = corners.len() * mesh.gv_av.list(gv).len() > MAX_PAIRS;
    let shades = |item: &u32| {
        let other = mesh.triangles[(item / 3) as usize].av[(item % 3) as usize];
        other == av || !crowded && agree(mesh, av, other)
    };
    in_order(mesh, corners.iter().copied().filter(shades).collect())
}

fn around_edge(mesh: &Mesh, ae: u32) -> Vec<u32> {
    let [from, to] = mesh.ae_av[ae as usize];
    let sides = mesh.ge_side.list(mesh.ae_ge[ae as usize] as usize);
    let crowded = sides.len() * mesh.ge_ae.list(mesh.ae_ge[ae as usize] as usize).len() > MAX_PAIRS;
    let shades = |item: &u32| {
        let triangle = &mesh.triangles[(item / 3) as usize];
        let other = triangle.ae[(item % 3) as usize];
        let [a, b] = mesh.ae_av[other as usize];
        other == ae || !crowded && agree(mesh, from, a) && agree(mesh, to, b)
    };
    in_order(mesh, sides.iter().copied().filter(shades).collect())
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
