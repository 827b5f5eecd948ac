//! Upper bounds of what methods are off by, against what they are off by on random patches: the reprojection error of many
//! rays, by the f64 twins.

pub mod counts;
pub mod draw;
pub mod maps;
pub mod measure;
pub mod table;

use displace_server::domain::choose::{cost::fetches_per_pixel, predict::predict};
use rand::{SeedableRng, rngs::StdRng};

use draw::Case;
use maps::TestMap;
use measure::{Trial, trials};
use table::{Row, Rows};

/// Each patch is drawn by a generator of its own, so that any can be looked at alone.
#[must_use]
pub fn case(maps: &[TestMap], seed: u64) -> (Case<'_>, StdRng) {
    let mut random = StdRng::seed_from_u64(seed);
    loop {
        if let Some(case) = Case::draw(maps, &mut random) {
            return (case, random);
        }
    }
}

/// Of patches from `first` on, by so many rays each.
#[must_use]
pub fn measured(maps: &[TestMap], seeds: std::ops::Range<u64>, rays: usize) -> Rows {
    use rayon::prelude::*;
    let of = |seed: u64| {
        let (case, mut random) = case(maps, seed);
        let rays = case.feet(rays, &mut random);
        let mut row = |trial: &Trial| {
            let predicted = predict(trial.method, trial.setting, &case.view, &case.map.facts);
            let (measured_px, fetches) = measure::error_px(&case, trial, &rays, &mut random);
            let expected = fetches_per_pixel(trial.method, trial.setting, &case.view, &case.map.facts);
            let predicted_px = predicted.error_px;
            Row { seed, trial: *trial, predicted_px, measured_px, expected_fetches: expected, fetches }
        };
        trials().iter().map(&mut row).collect::<Vec<_>>()
    };
    Rows { rows: seeds.into_par_iter().flat_map_iter(of).collect() }
}
