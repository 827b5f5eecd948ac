//! What moves of vertices cost, by the bounds of the triangles that come of them. Every move of every listed vertex is
//! judged at once: the twin finds out fewer, one after the other, where a device has threads to spare and waits for hosts.

use displace_glsl::{
    SHADERS,
    layout::{
        bound::FacetPlace,
        simplify::{CollapseCandidateParams, CollapseMovesParams, CollapsePlacesParams, CollapseSlotsParams},
    },
};

use super::{List, PAIR, Simplification, Stars, WORD};
use crate::{
    domain::Result,
    render::lists::{expand, scan::Scan},
    vulkan::{Recorder, Stream},
};

/// Vertices whose moves are judged at once: each has some 24 triangles that may change.
const CHUNK: u64 = 1 << 16;

/// A run of listed vertices.
#[derive(Clone, Copy)]
struct Chunk<'c> {
    stars: &'c Stars,
    list: &'c Stream,
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
    /// Triangles that change.
    counts: Stream,
}

impl<'s> Simplification<'s> {
    /// The moves of the listed vertices that cost least.
    pub(super) fn find_out(&self, stars: &Stars, list: &List) -> Result<()> {
        for chunk in chunks(stars, list) {
            let (recorder, moves) = self.record_moves(&chunk)?;
            self.find_out_moves(recorder, &chunk, &moves)?;
        }
        Ok(())
    }

    fn find_out_moves(&self, mut recorder: Recorder<'s>, chunk: &Chunk<'_>, moves: &Moves) -> Result<()> {
        let slots = moves.counts.len();
        let offsets = self.stream("move_offsets", WORD, slots)?;
        let scan = Scan::new(&self.device, slots)?;
        scan.record(&mut recorder, &moves.counts, &offsets, slots)?;
        recorder.finish()?;
        let total = scan.total()?;
        let mut recorder = self.recorder();
        let facets = self.record_changed(&mut recorder, chunk, moves, &offsets, total)?;
        let (mut recorder, bounds) = self.bounds.record(self.job, recorder, &facets, total, self.tolerance)?;
        let (count, first, tolerance) = (chunk.count as u32, chunk.first as u32, self.tolerance);
        let params = CollapseCandidateParams { count, first, tolerance };
        let streams = [
            ("list", chunk.list),
            ("slot_counts", &moves.slot_counts),
            ("slot_offsets", &moves.slot_offsets),
            ("move_to", &moves.to),
            ("move_counts", &moves.counts),
            ("move_offsets", &offsets),
            ("bounds", &bounds),
            ("keys", &self.keys),
            ("candidates", &self.candidates),
        ];
        recorder.dispatch(&SHADERS.collapse_candidate, chunk.count, &params, &streams)?;
        recorder.finish()?;
        Ok(())
    }

    fn record_moves(&self, chunk: &Chunk<'_>) -> Result<(Recorder<'s>, Moves)> {
        let (slot_counts, slot_offsets, total) = self.slots(chunk)?;
        let moves = Moves {
            slot_counts,
            slot_offsets,
            slots: self.stream("slots", PAIR, total)?,
            to: self.stream("move_to", WORD, total)?,
            counts: self.stream("move_counts", WORD, total)?,
        };
        let mut recorder = self.recorder();
        expand::record(&mut recorder, &moves.slot_offsets, &moves.slots, chunk.count, total)?;
        let (count, first, tolerance) = (total as u32, chunk.first as u32, self.tolerance);
        let params = CollapseMovesParams { count, first, tolerance };
        let streams = [
            ("triangles", &self.triangles),
            ("star_first", &chunk.stars.first),
            ("star_items", &chunk.stars.items),
            ("vertices", &self.vertices),
            ("bases", &self.bases),
            ("positions", &self.positions),
            ("facing", &self.facing),
            ("sheets", &self.sheets),
            ("list", chunk.list),
            ("slots", &moves.slots),
            ("move_to", &moves.to),
            ("move_counts", &moves.counts),
        ];
        recorder.dispatch(&SHADERS.collapse_moves, total, &params, &streams)?;
        Ok((recorder, moves))
    }

    /// Slots by vertex, their sums, and how many there are.
    fn slots(&self, chunk: &Chunk<'_>) -> Result<(Stream, Stream, u64)> {
        let counts = self.stream("slot_counts", WORD, chunk.count)?;
        let offsets = self.stream("slot_offsets", WORD, chunk.count)?;
        let scan = Scan::new(&self.device, chunk.count)?;
        let mut recorder = self.recorder();
        let params = CollapseSlotsParams { count: chunk.count as u32, first: chunk.first as u32 };
        let streams = [
            ("triangles", &self.triangles),
            ("star_first", &chunk.stars.first),
            ("star_items", &chunk.stars.items),
            ("vertices", &self.vertices),
            ("list", chunk.list),
            ("slot_counts", &counts),
        ];
        recorder.dispatch(&SHADERS.collapse_slots, chunk.count, &params, &streams)?;
        scan.record(&mut recorder, &counts, &offsets, chunk.count)?;
        recorder.finish()?;
        let total = scan.total()?;
        Ok((counts, offsets, total))
    }

    /// Records the triangles that moves change, as they would lie.
    fn record_changed(
        &self,
        recorder: &mut Recorder<'_>,
        chunk: &Chunk<'_>,
        moves: &Moves,
        offsets: &Stream,
        total: u64,
    ) -> Result<Stream> {
        let places = self.stream("places", PAIR, total)?;
        let facets = self.stream("facets", size_of::<FacetPlace>() as u32, total)?;
        expand::record(recorder, offsets, &places, moves.counts.len(), total)?;
        let params = CollapsePlacesParams { count: total as u32, first: chunk.first as u32 };
        let streams = [
            ("triangles", &self.triangles),
            ("star_first", &chunk.stars.first),
            ("star_items", &chunk.stars.items),
            ("vertices", &self.vertices),
            ("bases", &self.bases),
            ("list", chunk.list),
            ("slots", &moves.slots),
            ("move_to", &moves.to),
            ("places", &places),
            ("facets", &facets),
        ];
        recorder.dispatch(&SHADERS.collapse_places, total, &params, &streams)?;
        Ok(facets)
    }
}

fn chunks<'c>(stars: &'c Stars, list: &'c List) -> impl Iterator<Item = Chunk<'c>> {
    let firsts = (0..list.count).step_by(CHUNK as usize);
    firsts.map(|first| Chunk { stars, list: &list.vertices, first, count: CHUNK.min(list.count - first) })
}
