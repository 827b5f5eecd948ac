//! Rounds of flips.

use displace_glsl::{
    SHADERS,
    layout::{
        bound::FacetPlace,
        simplify::{Flip, FlipApplyParams, FlipAroundParams, FlipChooseParams, FlipFindParams, FlipPlacesParams},
    },
};

use super::{List, PAIR, Simplification, Stars, WORD};
use crate::{
    domain::Result,
    render::{
        lists::{compact::Compact, expand, scan::Scan},
        tessellate::simplify::FLIP_ROUNDS,
    },
    vulkan::{Recorder, Stream},
};

/// Sides that may be turned: three of each triangle.
struct Sides {
    errors: Stream,
    flips: Stream,
    counts: Stream,
    offsets: Stream,
    /// Triangles that come of them.
    total: u64,
}

impl<'s> Simplification<'s> {
    /// Returns the vertices around which triangles changed; none where nothing did.
    pub(super) fn flip(&mut self) -> Result<Option<List>> {
        let touched = self.stream("touched", WORD, self.vertices.len())?;
        let mut recorder = self.recorder();
        recorder.fill(&touched, 0)?;
        recorder.finish()?;
        let mut any = false;
        for _ in 0..FLIP_ROUNDS {
            self.job.cancel.check()?;
            if !self.flip_once(&touched)? {
                break;
            }
            any = true;
        }
        if any { self.around(&touched).map(Some) } else { Ok(None) }
    }

    /// Whether any triangle changed.
    fn flip_once(&mut self, touched: &Stream) -> Result<bool> {
        let mut recorder = self.recorder();
        let stars = self.stars(&mut recorder)?;
        let sides = self.sides(recorder, &stars)?;
        let (mut recorder, bounds) = self.flipped(&sides)?;
        let triangles = self.triangles.len();
        let choices = self.stream("choices", WORD, triangles)?;
        let changed = Stream::from_slice(&self.device, "changed", &[0u32])?;
        let params = FlipChooseParams { count: triangles as u32, tolerance: self.tolerance };
        let streams = [
            ("triangles", &self.triangles),
            ("star_first", &stars.first),
            ("star_items", &stars.items),
            ("errors", &sides.errors),
            ("flips", &sides.flips),
            ("flip_counts", &sides.counts),
            ("flip_offsets", &sides.offsets),
            ("bounds", &bounds),
            ("choices", &choices),
        ];
        recorder.dispatch(&SHADERS.flip_choose, triangles, &params, &streams)?;
        let streams = [
            ("flips", &sides.flips),
            ("choices", &choices),
            ("triangles", &self.triangles),
            ("touched", touched),
            ("changed", &changed),
        ];
        recorder.dispatch(&SHADERS.flip_apply, triangles, &FlipApplyParams { count: triangles as u32 }, &streams)?;
        recorder.finish()?;
        Ok(changed.read::<u32>()? != [0])
    }

    fn sides(&self, recorder: Recorder<'s>, stars: &Stars) -> Result<Sides> {
        let (mut recorder, errors) = self.errors(recorder)?;
        let sides = 3 * self.triangles.len();
        let flips = self.stream("flips", size_of::<Flip>() as u32, sides)?;
        let counts = self.stream("flip_counts", WORD, sides)?;
        let offsets = self.stream("flip_offsets", WORD, sides)?;
        let scan = Scan::new(&self.device, sides)?;
        let params = FlipFindParams { count: sides as u32, tolerance: self.tolerance };
        let streams = [
            ("triangles", &self.triangles),
            ("star_first", &stars.first),
            ("star_items", &stars.items),
            ("vertices", &self.vertices),
            ("bases", &self.bases),
            ("positions", &self.positions),
            ("facing", &self.facing),
            ("errors", &errors),
            ("flips", &flips),
            ("flip_counts", &counts),
        ];
        recorder.dispatch(&SHADERS.flip_find, sides, &params, &streams)?;
        scan.record(&mut recorder, &counts, &offsets, sides)?;
        recorder.finish()?;
        let total = scan.total()?;
        Ok(Sides { errors, flips, counts, offsets, total })
    }

    /// Records the bounds of the triangles that come of flips.
    fn flipped(&self, sides: &Sides) -> Result<(Recorder<'s>, Stream)> {
        let places = self.stream("places", PAIR, sides.total)?;
        let facets = self.stream("facets", size_of::<FacetPlace>() as u32, sides.total)?;
        let mut recorder = self.recorder();
        expand::record(&mut recorder, &sides.offsets, &places, sides.counts.len(), sides.total)?;
        let streams = [
            ("triangles", &self.triangles),
            ("vertices", &self.vertices),
            ("bases", &self.bases),
            ("flips", &sides.flips),
            ("places", &places),
            ("facets", &facets),
        ];
        let params = FlipPlacesParams { count: sides.total as u32 };
        recorder.dispatch(&SHADERS.flip_places, sides.total, &params, &streams)?;
        self.bounds.record(self.job, recorder, &facets, sides.total, self.tolerance)
    }

    fn around(&self, touched: &Stream) -> Result<List> {
        let (vertices, triangles) = (self.vertices.len(), self.triangles.len());
        let around = self.stream("around", WORD, vertices)?;
        let list = self.stream("dirty", WORD, vertices)?;
        let compact = Compact::new(&self.device, vertices)?;
        let mut recorder = self.recorder();
        recorder.fill(&around, 0)?;
        let streams = [("triangles", &self.triangles), ("touched", touched), ("around", &around)];
        recorder.dispatch(&SHADERS.flip_around, triangles, &FlipAroundParams { count: triangles as u32 }, &streams)?;
        compact.record(&mut recorder, &around, &list, vertices)?;
        recorder.finish()?;
        Ok(List { vertices: list, count: compact.total()? })
    }
}
