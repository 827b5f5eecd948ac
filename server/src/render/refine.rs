//! The refinement of a mesh on the device, round by round: which sides of triangles are split is decided on edges
//! that all their triangles share, so no vertex ever hangs.

use std::sync::Arc;

use displace_glsl::{
    SHADERS,
    layout::refine::{
        RefineCountParams, RefineEdgesParams, RefineMarkParams, RefineTrianglesParams, RefineVerticesParams,
        RefinedEdge, RefinedTriangle, RefinedVertex,
    },
    reference::refine::{Base, Refined},
};

use super::{JobContext, lists::scan::Scan};
use crate::{
    domain::{Error, Result},
    vulkan::{Device, Recorder, Stream},
};

/// Closing sweeps between two looks at whether any changed anything: most rounds need no more.
const SWEEPS: usize = 4;
const WORD: u32 = 4;

/// A mesh being refined, in device memory.
pub struct Refinement {
    device: Arc<Device>,
    pub(super) bases: Stream,
    base_edges: Stream,
    base_positions: Stream,
    pub(super) vertices: Stream,
    edges: Stream,
    pub(super) triangles: Stream,
    /// 0 of triangles that the last round made.
    pub(super) states: Stream,
}

/// What a round did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Round {
    /// No triangle was wanted split.
    Done,
    /// So many triangles there are now.
    Split(u64),
    /// So many there would be, above the limit: nothing changed.
    OverBudget(u64),
    /// An edge is as short as can be told, 2^-24 of its base edge or triangle: nothing changed.
    TooFine,
}

/// What is split in a round.
struct Marks {
    marks: Stream,
    mark_offsets: Stream,
    split_offsets: Stream,
    marked: u64,
    split: u64,
}

impl Refinement {
    /// The base mesh itself.
    pub fn new(device: &Arc<Device>, base: &Base) -> Result<Self> {
        let start = Refined::of(base);
        Ok(Self {
            device: Arc::clone(device),
            bases: Stream::from_slice(device, "bases", &base.triangles)?,
            base_edges: Stream::from_slice(device, "base_edges", &base.edges)?,
            base_positions: Stream::from_slice(device, "base_positions", &base.positions)?,
            vertices: Stream::from_slice(device, "vertices", &start.vertices)?,
            edges: Stream::from_slice(device, "edges", &start.edges)?,
            triangles: Stream::from_slice(device, "triangles", &start.triangles)?,
            states: Stream::from_slice(device, "states", &start.states)?,
        })
    }

    #[must_use]
    pub fn triangles(&self) -> u64 {
        self.triangles.len()
    }

    /// Everything, as the twin has it.
    pub fn read(&self) -> Result<Refined> {
        Ok(Refined {
            vertices: self.vertices.read()?,
            edges: self.edges.read()?,
            triangles: self.triangles.read()?,
            states: self.states.read()?,
        })
    }

    /// Splits the triangles whose `wanted` is 1, and those they reach, unless more than `max_triangles` come out.
    pub fn round(&mut self, job: &JobContext<'_>, wanted: &Stream, max_triangles: u64) -> Result<Round> {
        if wanted.len() != self.triangles.len() {
            return Err(Error::internal("a round needs one word for each triangle"));
        }
        let marks = self.mark(job, wanted)?;
        let triangles = self.triangles.len() + marks.split;
        if marks.marked == 0 {
            return Ok(Round::Done);
        }
        if triangles > max_triangles {
            return Ok(Round::OverBudget(triangles));
        }
        let exact = self.split(job, &marks)?;
        Ok(if exact { Round::Split(triangles) } else { Round::TooFine })
    }

    fn mark(&self, job: &JobContext<'_>, wanted: &Stream) -> Result<Marks> {
        let (edges, triangles) = (self.edges.len(), self.triangles.len());
        let device = &self.device;
        let marks = Stream::new(device, "marks", WORD, edges)?;
        let changed = Stream::from_slice(device, "changed", &[0u32])?;
        let mut recorder = device.recorder(job.cancel, job.progress);
        recorder.fill(&marks, 0)?;
        self.record_mark(&mut recorder, wanted, &marks, &changed, false)?;
        recorder.finish()?;
        // Each sweep follows sides that grow longer, so there are no more than triangles.
        for _ in 0..=triangles {
            let mut recorder = device.recorder(job.cancel, job.progress);
            recorder.fill(&changed, 0)?;
            for _ in 0..SWEEPS {
                self.record_mark(&mut recorder, wanted, &marks, &changed, true)?;
            }
            recorder.finish()?;
            if changed.read::<u32>()? == [0] {
                return self.counted(job, marks);
            }
        }
        Err(Error::internal("the sides to split find no end"))
    }

    fn record_mark(
        &self,
        recorder: &mut Recorder<'_>,
        wanted: &Stream,
        marks: &Stream,
        changed: &Stream,
        closing: bool,
    ) -> Result<()> {
        let params = RefineMarkParams { count: self.triangles.len() as u32, closing: u32::from(closing) };
        let streams = [
            ("triangles", &self.triangles),
            ("edges", &self.edges),
            ("wanted", wanted),
            ("marks", marks),
            ("changed", changed),
        ];
        recorder.dispatch(&SHADERS.refine_mark, self.triangles.len(), &params, &streams)?;
        Ok(())
    }

    fn counted(&self, job: &JobContext<'_>, marks: Stream) -> Result<Marks> {
        let (edges, triangles) = (self.edges.len(), self.triangles.len());
        let device = &self.device;
        let splits = Stream::new(device, "splits", WORD, triangles)?;
        let mark_offsets = Stream::new(device, "mark_offsets", WORD, edges)?;
        let split_offsets = Stream::new(device, "split_offsets", WORD, triangles)?;
        let (of_marks, of_splits) = (Scan::new(device, edges)?, Scan::new(device, triangles)?);
        let mut recorder = device.recorder(job.cancel, job.progress);
        let params = RefineCountParams { count: triangles as u32 };
        let streams = [("triangles", &self.triangles), ("marks", &marks), ("splits", &splits)];
        recorder.dispatch(&SHADERS.refine_count, triangles, &params, &streams)?;
        of_marks.record(&mut recorder, &marks, &mark_offsets, edges)?;
        of_splits.record(&mut recorder, &splits, &split_offsets, triangles)?;
        recorder.finish()?;
        let (marked, split) = (of_marks.total()?, of_splits.total()?);
        Ok(Marks { marks, mark_offsets, split_offsets, marked, split })
    }

    /// Whether all middles are whole numbers of units; else nothing changed.
    fn split(&mut self, job: &JobContext<'_>, marks: &Marks) -> Result<bool> {
        let (vertices, edges, triangles) = (self.vertices.len(), self.edges.len(), self.triangles.len());
        let device = &self.device;
        let size = |bytes: usize| bytes as u32;
        let next_vertices = Stream::new(device, "vertices", size(size_of::<RefinedVertex>()), vertices + marks.marked)?;
        let next_edges =
            Stream::new(device, "edges", size(size_of::<RefinedEdge>()), edges + marks.marked + marks.split)?;
        let next_triangles =
            Stream::new(device, "triangles", size(size_of::<RefinedTriangle>()), triangles + marks.split)?;
        let next_states = Stream::new(device, "states", WORD, triangles + marks.split)?;
        let inexact = Stream::from_slice(device, "inexact", &[0u32])?;
        let mut recorder = device.recorder(job.cancel, job.progress);
        let carried = [("vertices", &self.vertices), ("next_vertices", &next_vertices)];
        let params = RefineVerticesParams { count: vertices as u32 };
        recorder.dispatch(&SHADERS.refine_vertices, vertices, &params, &carried)?;
        let (marked, vertices) = (marks.marked as u32, vertices as u32);
        let params = RefineEdgesParams { count: edges as u32, marked, vertices };
        recorder.dispatch(
            &SHADERS.refine_edges,
            edges,
            &params,
            &[
                ("edges", &self.edges),
                ("marks", &marks.marks),
                ("mark_offsets", &marks.mark_offsets),
                ("bases", &self.bases),
                ("base_edges", &self.base_edges),
                ("vertices", &self.vertices),
                ("next_vertices", &next_vertices),
                ("next_edges", &next_edges),
                ("inexact", &inexact),
            ],
        )?;
        let params = RefineTrianglesParams { count: triangles as u32, edges: edges as u32, marked, vertices };
        recorder.dispatch(
            &SHADERS.refine_triangles,
            triangles,
            &params,
            &[
                ("triangles", &self.triangles),
                ("edges", &self.edges),
                ("marks", &marks.marks),
                ("mark_offsets", &marks.mark_offsets),
                ("split_offsets", &marks.split_offsets),
                ("bases", &self.bases),
                ("base_positions", &self.base_positions),
                ("vertices", &next_vertices),
                ("states", &self.states),
                ("next_edges", &next_edges),
                ("next_triangles", &next_triangles),
                ("next_states", &next_states),
            ],
        )?;
        recorder.finish()?;
        if inexact.read::<u32>()? != [0] {
            return Ok(false);
        }
        (self.vertices, self.edges) = (next_vertices, next_edges);
        (self.triangles, self.states) = (next_triangles, next_states);
        Ok(true)
    }
}

/// The base mesh as refinement sees it.
#[must_use]
pub fn base(mesh: &crate::domain::mesh::Mesh) -> Base {
    let triangle = |triangle: &crate::domain::mesh::Triangle| {
        let gv = triangle.av.map(|av| mesh.av_gv[av as usize]);
        let ge = triangle.ae.map(|ae| mesh.ae_ge[ae as usize]);
        let reversed = (0..3).filter(|&k| mesh.ge_gv[ge[k] as usize][0] != gv[k]).map(|k| 1 << k).sum();
        displace_glsl::layout::refine::RefineBase { gv, ge, reversed }
    };
    Base::new(mesh.triangles.iter().map(triangle).collect(), mesh.ge_gv.clone(), mesh.gv_position.clone())
}
