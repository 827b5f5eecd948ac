//! Rounds of collapses: where no neighbour's move costs less, a vertex goes.

use displace_glsl::{
    SHADERS,
    layout::simplify::{CollapseApplyParams, CollapsePackParams, CollapseSelectParams, Facet},
};

use super::{List, Simplification, Stars, WORD};
use crate::{
    domain::Result,
    render::{
        lists::{compact::Compact, scan::Scan},
        tessellate::simplify::MOST_ROUNDS,
    },
    vulkan::Stream,
};

impl Simplification<'_> {
    /// Rounds until nothing moves; `dirty` are the vertices whose candidates are to be found anew.
    pub(super) fn collapse(&mut self, mut dirty: List, rounds: &mut u32) -> Result<()> {
        while *rounds < MOST_ROUNDS {
            self.job.cancel.check()?;
            self.job.progress.pass("collapse", u64::from(*rounds), u64::from(*rounds) + 1);
            let mut recorder = self.recorder();
            let stars = self.stars(&mut recorder)?;
            recorder.finish()?;
            self.find_out(&stars, &dirty)?;
            let Some(next) = self.apply(&stars, *rounds)? else { break };
            dirty = next;
            *rounds += 1;
        }
        Ok(())
    }

    /// Makes the moves that come first among neighbours. Returns the vertices around; none where nothing moved.
    fn apply(&mut self, stars: &Stars, round: u32) -> Result<Option<List>> {
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
            ("keys", &self.keys),
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
        Ok(Some(List { vertices: list, count: compact.total()? }))
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
