//! The search for the fewest triangles: proposals whose faults are found and forbidden, until none is left.

use super::{
    patch::Patch,
    verdict::{Known, PlacedSheet, Reference, Verdict, special_edges},
};
use crate::{
    domain::{Result, mesh::Mesh, request::Quality, surface::Surface},
    oracle::topology,
    render::JobContext,
};

/// Errors that meshoptimizer is asked for at each quality, as shares of the tolerance, until one leads to an end: its errors
/// are means, so that of the first some places are too far, and kept in the next proposal. Small ones end soon.
const SHARES: [&[f64]; 2] = [&[0.3], &[0.8, 0.5, 0.3]];
/// Proposals for one error.
const ROUNDS: u32 = 40;
/// Proposals until what the last one kept stays kept: what is kept in one place changes what goes in others, and single
/// faults would turn up without end.
const PATIENCE: u32 = 8;

/// What stands for a mesh.
pub(super) struct Simpler {
    /// Of fine vertices of the surface.
    pub(super) triangles: Vec<[u32; 3]>,
    /// The distance to what it stands for is proven to be at most this, mesh-local units.
    pub(super) error_local: f64,
}

/// None where no proposal has fewer than `most` triangles and no fault.
pub(super) fn fewest(
    job: &JobContext<'_>,
    mesh: &Mesh,
    surface: &Surface,
    (tolerance_local, quality): (f64, Quality),
    most: usize,
) -> Result<Option<Simpler>> {
    let (places, of_places) = topology::places(&surface.positions);
    let sheet = PlacedSheet::new(surface, &places, &surface.triangles);
    let search = Search {
        job,
        places: &places,
        fixed: fixed(surface, &places, of_places.len()),
        reference: Reference::new(surface, &places, &sheet, tolerance_local),
        patch: Patch::new(mesh, surface, tolerance_local),
        tolerance_local,
        most,
    };
    for share in SHARES[quality as usize] {
        if let Some(simpler) = search.within(*share)? {
            return Ok(Some(simpler));
        }
    }
    Ok(None)
}

/// Places where sheets meet, end or turn over: a simplifier might join or part them.
fn fixed(surface: &Surface, places: &[u32], count: usize) -> Vec<bool> {
    let mut fixed = vec![false; count];
    let ends = special_edges(places, &surface.triangles).into_iter().flat_map(|(ends, ..)| ends);
    ends.for_each(|place| fixed[place as usize] = true);
    fixed
}

struct Search<'a> {
    job: &'a JobContext<'a>,
    /// Of every fine vertex.
    places: &'a [u32],
    fixed: Vec<bool>,
    reference: Reference<'a>,
    patch: Patch,
    tolerance_local: f64,
    most: usize,
}

impl Search<'_> {
    /// Proposals for one error, until one has no fault: none where it takes too many triangles or rounds.
    fn within(&self, share: f64) -> Result<Option<Simpler>> {
        let (mut kept, mut known) = (self.fixed.clone(), Known::default());
        for round in 0..ROUNDS {
            self.job.cancel.check()?;
            self.job.progress.pass("simplify_across", u64::from(round), u64::from(ROUNDS));
            let is_kept = |vertex: u32| kept[self.places[vertex as usize] as usize];
            let triangles = self.patch.proposal(share * self.tolerance_local, is_kept);
            if triangles.len() >= self.most {
                return Ok(None);
            }
            match self.reference.verdict(&triangles, &mut known, self.job.cancel)? {
                Verdict::Kept(error_local) => return Ok(Some(Simpler { triangles, error_local })),
                Verdict::Refused(faults) => {
                    if round >= PATIENCE {
                        let corners = triangles.as_flattened();
                        corners.iter().for_each(|v| kept[self.places[*v as usize] as usize] = true);
                    }
                    if !self.keep(&mut kept, faults) {
                        return Ok(None);
                    }
                }
            }
        }
        Ok(None)
    }

    /// Keeps the places of faults, or those around them where they were kept before. Whether there were any to keep.
    fn keep(&self, kept: &mut [bool], mut faults: Vec<u32>) -> bool {
        while faults.iter().all(|place| kept[*place as usize]) {
            faults.sort_unstable();
            faults.dedup();
            let before = faults.len();
            if self.widen(&mut faults) == before {
                return false;
            }
        }
        faults.into_iter().for_each(|place| kept[place as usize] = true);
        true
    }

    /// Adds the places around, and tells how many there are.
    fn widen(&self, places: &mut Vec<u32>) -> usize {
        places.extend(places.clone().into_iter().flat_map(|place| self.reference.around(place)));
        places.sort_unstable();
        places.dedup();
        places.len()
    }
}
