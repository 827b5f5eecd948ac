//! The search for the fewest triangles: proposals whose faults are found and forbidden, until none is left.

use super::{
    patch::Patch,
    verdict::{PlacedSheet, Reference, Verdict, special_edges},
};
use crate::{
    domain::{Result, mesh::Mesh, surface::Surface},
    oracle::topology,
    render::JobContext,
};

/// Errors that meshoptimizer is asked for, as shares of the tolerance: its errors are means, and those of the largest
/// leave many places to mend.
const SHARES: [f64; 3] = [0.5, 0.8, 0.3];
/// Proposals for one error.
const ROUNDS: u32 = 12;

/// What stands for a mesh.
pub(super) struct Simpler {
    /// Of fine vertices of the surface.
    pub(super) triangles: Vec<[u32; 3]>,
    /// The distance to what it stands for is proven to be at most this, mesh-local units.
    pub(super) error_local: f64,
}

/// None where no proposal has fewer triangles than the surface, and no fault.
pub(super) fn fewest(
    job: &JobContext<'_>,
    mesh: &Mesh,
    surface: &Surface,
    tolerance_local: f64,
) -> Result<Option<Simpler>> {
    let (places, of_places) = topology::places(&surface.positions);
    let mut fixed = vec![false; of_places.len()];
    for (ends, ..) in special_edges(&places, &surface.triangles) {
        ends.into_iter().for_each(|place| fixed[place as usize] = true);
    }
    let sheet = PlacedSheet::new(surface, &places, &surface.triangles);
    let reference = Reference::new(surface, &places, &sheet, tolerance_local);
    let patch = Patch::new(mesh, surface, tolerance_local);
    let mut best: Option<Simpler> = None;
    for share in SHARES {
        let mut kept = fixed.clone();
        for round in 0..ROUNDS {
            job.cancel.check()?;
            job.progress.pass("simplify_across", u64::from(round), u64::from(ROUNDS));
            let t0 = std::time::Instant::now();
            let triangles = patch.proposal(share * tolerance_local, |v| kept[places[v as usize] as usize]);
            let t1 = t0.elapsed().as_millis();
            let fewest = best.as_ref().map_or(surface.triangles.len(), |best| best.triangles.len());
            if triangles.len() >= fewest {
                eprintln!("DBG share {share} round {round} {} no better", triangles.len());
                break;
            }
            match reference.verdict(&triangles, job.cancel)? {
                Verdict::Kept(error_local) => {
                    eprintln!("DBG share {share} round {round} -> {} KEPT propose {t1} all {}", triangles.len(), t0.elapsed().as_millis());
                    best = Some(Simpler { triangles, error_local });
                    break;
                }
                Verdict::Refused(faults) => {
                    eprintln!("DBG share {share} round {round} -> {} faults {} propose {t1} all {}", triangles.len(), faults.len(), t0.elapsed().as_millis());
                    faults.into_iter().for_each(|place| kept[place as usize] = true)
                }
            }
        }
    }
    Ok(best)
}
