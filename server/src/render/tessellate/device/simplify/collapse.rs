//! Rounds of collapses. Every move of every dirty vertex is judged at once, then the best of each vertex is made where no
//! neighbour's is better.

use displace_glsl::{
    SHADERS,
    layout::{
        bound::FacetPlace,
        simplify::{
            CollapseApplyParams, CollapseCandidateParams, CollapseMovesParams, CollapsePackParams,
            CollapsePlacesParams, CollapseSelectParams, CollapseSlotsParams, Facet,
        },
    },
};

use super::{Dirty, PAIR, Simplification, Stars, WORD};
use crate::{
    domain::Result,
    render::{
        lists::{compact::Compact, expand, scan::Scan},
        tessellate::simplify::MOST_ROUNDS,
    },
    vulkan::Stream,
};

/// Dirty vertices whose moves are judged at once: each has some 24 triangles that may change.
const CHUNK: u64 = 1 << 16;

/// A run of dirty vertices.
struct Chunk<'c> {
    dirty: &'c Stream,
    first: u64,
    count: u64,
}

/// The neighbours that the vertices of a chunk may go to.
struct Moves {
    /// By vertex.
    slot_counts: Stream,
    slot_offsets: Stream,
    /// By slot.
    slots: Stream,
    to: Stream,
    counts: Stream,
    offsets: Stream,
    /// Triangles that change.
    total: u64,
}

impl Simplification<'_> {
    pub(super) fn collapse(&mut self, mut dirty: Dirty, rounds: &mut u32) -> Result<()> {
        while *rounds < MOST_ROUNDS {
            self.job.cancel.check()?;
            self.job.progress.pass("collapse", u64::from(*rounds), u64::from(*rounds) + 1);
            let mut recorder = self.recorder();
            let stars = self.stars(&mut recorder)?;
            recorder.finish()?;
            for first in (0..dirty.count).step_by(CHUNK as usize) {
                let count = CHUNK.min(dirty.count - first);
                self.find_candidates(&stars, &Chunk { dirty: &dirty.list, first, count })?;
            }
            let Some(next) = self.apply(&stars, *rounds)? else { break };
            dirty = next;
            *rounds += 1;
        }
        Ok(())
    }

    fn find_candidates(&self, stars: &Stars, chunk: &Chunk<'_>) -> Result<()> {
        let moves = self.moves(stars, chunk)?;
        let facets = self.changed(stars, chunk, &moves)?;
        let bounds = self.bounds.find(self.job, &facets, moves.total, self.tolerance)?;
        let (count, first, tolerance) = (chunk.count as u32, chunk.first as u32, self.tolerance);
        let params = CollapseCandidateParams { count, first, tolerance };
        let streams = [
            ("dirty", chunk.dirty),
            ("slot_counts", &moves.slot_counts),
            ("slot_offsets", &moves.slot_offsets),
            ("move_to", &moves.to),
            ("move_counts", &moves.counts),
            ("move_offsets", &moves.offsets),
            ("bounds", &bounds),
            ("candidates", &self.candidates),
        ];
        let mut recorder = self.recorder();
        recorder.dispatch(&SHADERS.collapse_candidate, chunk.count, &params, &streams)?;
        recorder.finish()?;
        Ok(())
    }

    fn moves(&self, stars: &Stars, chunk: &Chunk<'_>) -> Result<Moves> {
        let (slot_counts, slot_offsets, total) = self.slots(stars, chunk)?;
        let slots = self.stream("slots", PAIR, total)?;
        let to = self.stream("move_to", WORD, total)?;
        let counts = self.stream("move_counts", WORD, total)?;
        let offsets = self.stream("move_offsets", WORD, total)?;
        let scan = Scan::new(&self.device, total)?;
        let mut recorder = self.recorder();
        expand::record(&mut recorder, &slot_offsets, &slots, chunk.count, total)?;
        let (count, first, tolerance) = (total as u32, chunk.first as u32, self.tolerance);
        let params = CollapseMovesParams { count, first, tolerance };
        let streams = [
            ("triangles", &self.triangles),
            ("star_first", &stars.first),
            ("star_items", &stars.items),
            ("vertices", &self.vertices),
            ("bases", &self.bases),
            ("positions", &self.positions),
            ("facing", &self.facing),
            ("sheets", &self.sheets),
            ("dirty", chunk.dirty),
            ("slots", &slots),
            ("move_to", &to),
            ("move_counts", &counts),
        ];
        recorder.dispatch(&SHADERS.collapse_moves, total, &params, &streams)?;
        scan.record(&mut recorder, &counts, &offsets, total)?;
        recorder.finish()?;
        let total = scan.total()?;
        Ok(Moves { slot_counts, slot_offsets, slots, to, counts, offsets, total })
    }

    /// Slots by vertex, their sums, and how many there are.
    fn slots(&self, stars: &Stars, chunk: &Chunk<'_>) -> Result<(Stream, Stream, u64)> {
        let counts = self.stream("slot_counts", WORD, chunk.count)?;
        let offsets = self.stream("slot_offsets", WORD, chunk.count)?;
        let scan = Scan::new(&self.device, chunk.count)?;
        let mut recorder = self.recorder();
        let params = CollapseSlotsParams { count: chunk.count as u32, first: chunk.first as u32 };
        let streams = [
            ("triangles", &self.triangles),
            ("star_first", &stars.first),
            ("star_items", &stars.items),
            ("vertices", &self.vertices),
            ("dirty", chunk.dirty),
            ("slot_counts", &counts),
        ];
        recorder.dispatch(&SHADERS.collapse_slots, chunk.count, &params, &streams)?;
        scan.record(&mut recorder, &counts, &offsets, chunk.count)?;
        recorder.finish()?;
        let total = scan.total()?;
        Ok((counts, offsets, total))
    }

    /// The triangles that moves change, as they would lie.
    fn changed(&self, stars: &Stars, chunk: &Chunk<'_>, moves: &Moves) -> Result<Stream> {
        let places = self.stream("places", PAIR, moves.total)?;
        let facets = self.stream("facets", size_of::<FacetPlace>() as u32, moves.total)?;
        let mut recorder = self.recorder();
        expand::record(&mut recorder, &moves.offsets, &places, moves.counts.len(), moves.total)?;
        let params = CollapsePlacesParams { count: moves.total as u32, first: chunk.first as u32 };
        let streams = [
            ("triangles", &self.triangles),
            ("star_first", &stars.first),
            ("star_items", &stars.items),
            ("vertices", &self.vertices),
            ("bases", &self.bases),
            ("dirty", chunk.dirty),
            ("slots", &moves.slots),
            ("move_to", &moves.to),
            ("places", &places),
            ("facets", &facets),
        ];
        recorder.dispatch(&SHADERS.collapse_places, moves.total, &params, &streams)?;
        recorder.finish()?;
        Ok(facets)
    }

    /// Makes the moves that come first among neighbours. Returns the vertices around; none where nothing moved.
    fn apply(&mut self, stars: &Stars, round: u32) -> Result<Option<Dirty>> {
        let (vertices, triangles) = (self.vertices.len(), self.triangles.len());
        let selected = self.stream("selected", WORD, vertices)?;
        let kept = self.stream("kept", WORD, triangles)?;
        let offsets = self.stream("offsets", WORD, triangles)?;
        let touched = self.stream("touched", WORD, vertices)?;
        let list = self.stream("dirty", WORD, vertices)?;
        let (scan, compact) = (Scan::new(&self.device, triangles)?, Compact::new(&self.device, vertices)?);
        let mut recorder = self.recorder();
        let streams = [
            ("triangles", &self.triangles),
            ("star_first", &stars.first),
            ("star_items", &stars.items),
            ("candidates", &self.candidates),
            ("selected", &selected),
        ];
        let params = CollapseSelectParams { count: vertices as u32, round };
        recorder.dispatch(&SHADERS.collapse_select, vertices, &params, &streams)?;
        recorder.fill(&touched, 0)?;
        let streams = [("selected", &selected), ("triangles", &self.triangles), ("kept", &kept), ("touched", &touched)];
        let params = CollapseApplyParams { count: triangles as u32 };
        recorder.dispatch(&SHADERS.collapse_apply, triangles, &params, &streams)?;
        scan.record(&mut recorder, &kept, &offsets, triangles)?;
        compact.record(&mut recorder, &touched, &list, vertices)?;
        recorder.finish()?;
        let left = scan.total()?;
        if left == triangles {
            return Ok(None);
        }
        self.pack(&kept, &offsets, left)?;
        Ok(Some(Dirty { list, count: compact.total()? }))
    }

    fn pack(&mut self, kept: &Stream, offsets: &Stream, left: u64) -> Result<()> {
        let next = self.stream("triangles", size_of::<Facet>() as u32, left)?;
        let triangles = self.triangles.len();
        let streams = [("triangles", &self.triangles), ("kept", kept), ("offsets", offsets), ("next_triangles", &next)];
        let mut recorder = self.recorder();
        let params = CollapsePackParams { count: triangles as u32 };
        recorder.dispatch(&SHADERS.collapse_pack, triangles, &params, &streams)?;
        recorder.finish()?;
        self.triangles = next;
        Ok(())
    }
}
