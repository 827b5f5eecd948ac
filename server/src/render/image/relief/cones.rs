//! Cones that were made once, kept as long as the height map that they are of: whoever shows it again need not wait.

use std::{
    ops::Range,
    sync::{Arc, Mutex, PoisonError, Weak},
};

use super::{ReliefStreams, ReliefTables};
use crate::domain::{Result, image::HeightMap};

/// Of one map; more are made again each time. Those of 8192 x 8192 texels fit.
const MOST_TEXELS: u32 = 1 << 27;

/// By map; of one device, since another may round otherwise.
#[derive(Debug, Default)]
pub struct KeptCones(Mutex<Vec<Kept>>);

#[derive(Debug)]
struct Kept {
    map: Weak<HeightMap>,
    /// Of all its levels, the finest first.
    cones: Arc<[f32]>,
}

/// A map of a render whose method needs cones.
#[derive(Debug)]
pub(super) struct Coned {
    pub(super) map: Arc<HeightMap>,
    /// Of the render's passes, one for each level.
    pub(super) passes: Range<usize>,
    /// Whether they were known, so that no pass makes them.
    known: bool,
}

impl Coned {
    pub(super) fn new(map: &Arc<HeightMap>, passes: Range<usize>) -> Self {
        Self { map: Arc::clone(map), passes, known: false }
    }
}

impl KeptCones {
    /// Puts what is known of the maps of a render where its passes would have put it, and leaves out those passes.
    pub(crate) fn put(&self, tables: &mut ReliefTables) {
        let mut kept = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        kept.retain(|kept| kept.map.strong_count() > 0);
        for coned in &mut tables.coned {
            let of = |kept: &&Kept| Weak::as_ptr(&kept.map) == Arc::as_ptr(&coned.map);
            let Some(Kept { cones, .. }) = kept.iter().find(of) else { continue };
            let mut rest = &cones[..];
            for params in &mut tables.cones[coned.passes.clone()] {
                let (level, others) = rest.split_at(params.count as usize);
                tables.texels[params.level.cone_first as usize..][..level.len()].copy_from_slice(level);
                params.count = 0;
                rest = others;
            }
            coned.known = true;
        }
    }

    /// Keeps what the passes of a render have made, once they have run.
    pub(crate) fn keep(&self, tables: &ReliefTables, streams: &ReliefStreams) -> Result<()> {
        for Coned { map, passes, .. } in tables.coned.iter().filter(|coned| !coned.known) {
            let passes = &tables.cones[passes.clone()];
            if passes.iter().map(|params| params.count).sum::<u32>() > MOST_TEXELS {
                continue;
            }
            let mut cones: Vec<f32> = Vec::new();
            for params in passes {
                let first = u64::from(params.level.cone_first);
                cones.extend(streams.texels.read_range::<f32>(first..first + u64::from(params.count))?);
            }
            let kept = Kept { map: Arc::downgrade(map), cones: cones.into() };
            self.0.lock().unwrap_or_else(PoisonError::into_inner).push(kept);
        }
        Ok(())
    }
}
