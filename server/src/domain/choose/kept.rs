//! Height maps that were used before, and what is known of them: whoever shows one again need not wait. All of it is a
//! function of the heights alone, so that the process has one store of it, whoever asks.

use std::sync::{Arc, Mutex, OnceLock, PoisonError};

use super::facts::HeightFacts;
use crate::domain::{Digest, image::HeightMap};

/// Of all maps that are kept; a larger one is not. With what is known of them about 55 bytes each, besides cones where a
/// device has made them.
const MOST_TEXELS: usize = 1 << 22;

static KEPT: KeptHeights = KeptHeights::new();

/// Those used last are last.
struct KeptHeights(Mutex<Vec<Arc<Kept>>>);

struct Kept {
    heights: Digest,
    map: Arc<HeightMap>,
    facts: OnceLock<Arc<HeightFacts>>,
}

/// The map of these heights as it was made before, or as it is made now; `repeats` and `width` tell it from others.
pub fn height_map(
    heights: Vec<f32>,
    width: usize,
    repeats: [bool; 2],
    make: impl FnOnce(Vec<f32>) -> HeightMap,
) -> Arc<HeightMap> {
    KEPT.map(heights, width, repeats, make)
}

/// What is known of a map.
#[must_use]
pub fn facts_of(map: &Arc<HeightMap>) -> Arc<HeightFacts> {
    KEPT.facts(map)
}

impl KeptHeights {
    const fn new() -> Self {
        Self(Mutex::new(Vec::new()))
    }

    fn map(
        &self,
        heights: Vec<f32>,
        width: usize,
        repeats: [bool; 2],
        make: impl FnOnce(Vec<f32>) -> HeightMap,
    ) -> Arc<HeightMap> {
        if heights.len() > MOST_TEXELS {
            return Arc::new(make(heights));
        }
        let digest = Digest::of(bytemuck::cast_slice(&heights));
        let is_same =
            |kept: &Kept| kept.heights == digest && kept.map.width as usize == width && kept.map.repeats == repeats;
        if let Some(kept) = self.used(is_same) {
            return Arc::clone(&kept.map);
        }
        let map = Arc::new(make(heights));
        // Another job may have made the same meanwhile.
        if let Some(kept) = self.used(is_same) {
            return Arc::clone(&kept.map);
        }
        self.keep(Kept { heights: digest, map: Arc::clone(&map), facts: OnceLock::new() });
        map
    }

    fn facts(&self, map: &Arc<HeightMap>) -> Arc<HeightFacts> {
        let make = || Arc::new(HeightFacts::new(map));
        match self.used(|kept| Arc::ptr_eq(&kept.map, map)) {
            Some(kept) => Arc::clone(kept.facts.get_or_init(make)),
            None => make(),
        }
    }

    fn used(&self, is_it: impl Fn(&Kept) -> bool) -> Option<Arc<Kept>> {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        let at = all.iter().position(|kept| is_it(kept))?;
        let kept = all.remove(at);
        all.push(Arc::clone(&kept));
        Some(kept)
    }

    /// In place of those that were not used for longest.
    fn keep(&self, kept: Kept) {
        let mut all = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        all.push(Arc::new(kept));
        let mut texels = 0;
        let is_over = |kept: &Arc<Kept>| {
            texels += kept.map.heights.len();
            texels > MOST_TEXELS
        };
        let beyond = all.iter().rev().position(is_over).map_or(0, |from_last| all.len() - from_last);
        all.drain(..beyond);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const REPEATS: [bool; 2] = [true; 2];

    fn made(kept: &KeptHeights, width: usize, of: f32, count: usize) -> (Arc<HeightMap>, bool) {
        let mut is_new = false;
        let map = kept.map(vec![of; count], width, REPEATS, |heights| {
            is_new = true;
            let (width, height) = (width as u32, (count / width) as u32);
            HeightMap { width, height, heights, repeats: REPEATS, thinnest_texels: 1.0 }
        });
        (map, is_new)
    }

    #[test]
    fn equal_heights_are_one_map_and_what_is_known_of_it_is_made_once() {
        let kept = KeptHeights::new();
        let (first, is_new) = made(&kept, 8, 1.0, 64);
        assert!(is_new);
        let (again, is_new) = made(&kept, 8, 1.0, 64);
        assert!(!is_new && Arc::ptr_eq(&first, &again));
        assert!(Arc::ptr_eq(&kept.facts(&first), &kept.facts(&again)));
        assert!(made(&kept, 16, 1.0, 64).1, "another shape is another map");
        assert!(made(&kept, 8, 2.0, 64).1, "other heights are another map");
    }

    #[test]
    fn what_was_not_used_for_longest_goes_first_and_nothing_grows_without_end() {
        let (kept, half) = (KeptHeights::new(), MOST_TEXELS / 2);
        made(&kept, 1024, 1.0, half);
        made(&kept, 1024, 2.0, half);
        assert!(!made(&kept, 1024, 1.0, half).1);
        assert!(made(&kept, 1024, 3.0, half).1);
        assert!(!made(&kept, 1024, 1.0, half).1, "it was used after the second");
        assert!(made(&kept, 1024, 2.0, half).1, "it had to go");
        assert!(made(&kept, 1024, 4.0, MOST_TEXELS + 1024).1);
        assert!(made(&kept, 1024, 4.0, MOST_TEXELS + 1024).1, "it is too large to be kept");
        assert_eq!(kept.0.lock().unwrap().len(), 2);
    }
}
