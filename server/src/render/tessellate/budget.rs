//! The least tolerance that a budget of triangles can hold.

use super::Tessellated;
use crate::domain::Result;

/// What a tolerance leads to.
pub(super) enum Attempt {
    Done(Tessellated),
    /// More triangles than the budget: loosen the tolerance by this factor.
    TooMany {
        most_likely: f64,
    },
}

/// A tolerance that cannot be kept within the budget is loosened so often at most: each time by a tenth and more.
const MOST_ATTEMPTS: u32 = 64;
/// Once it can be kept, tolerances in between are tried so often at most.
const MOST_BETWEEN: u32 = 2;
/// A result with so much of the budget is good enough, and so is a tolerance this much above one that cannot be kept.
const ENOUGH: f64 = 0.9;

/// The result of the least factor of the tolerance that is found to fit `budget`; none where no factor does.
pub(super) fn fitting(budget: u64, attempt: impl Fn(f64) -> Result<Attempt>) -> Result<Option<Tessellated>> {
    let (mut fails, mut fits) = (0.0, 1.0);
    let mut best = None;
    for _ in 0..MOST_ATTEMPTS {
        match attempt(fits)? {
            Attempt::Done(result) => {
                best = Some(result);
                break;
            }
            Attempt::TooMany { most_likely } => (fails, fits) = (fits, fits * most_likely.max(1.1)),
        }
    }
    let Some(best) = best else { return Ok(None) };
    if fails == 0.0 { Ok(Some(best)) } else { closer(budget, attempt, best, fails, fits).map(Some) }
}

/// Between a factor that fails and one that fits: triangles grow fewer about as the tolerance grows.
fn closer(
    budget: u64,
    attempt: impl Fn(f64) -> Result<Attempt>,
    mut best: Tessellated,
    mut fails: f64,
    mut fits: f64,
) -> Result<Tessellated> {
    for _ in 0..MOST_BETWEEN {
        let share = best.mesh.triangles.len() as f64 / budget as f64;
        if share > ENOUGH || fails / fits > ENOUGH {
            break;
        }
        let factor = f64::max(fits * share, (fails * fits).sqrt());
        match attempt(factor)? {
            Attempt::Done(result) => (best, fits) = (result, factor),
            Attempt::TooMany { .. } => fails = factor,
        }
    }
    Ok(best)
}
