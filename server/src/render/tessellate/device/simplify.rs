//! Simplification on the device: rounds of collapses, then flips that let more vertices go. The tolerance is the same
//! everywhere.
//!
//! | file | passes |
//! |---|---|
//! | `simplify.rs` | star_counts, star_fill, simplify_places |
//! | `simplify/collapse.rs` | collapse_select, _apply, _pack |
//! | `simplify/moves.rs` | collapse_slots, _moves, _places, _candidate |
//! | `simplify/flip.rs` | flip_find, _places, _choose, _apply, _around |

mod collapse;
mod flip;
mod moves;

use std::sync::Arc;

use displace_glsl::{
    SHADERS,
    layout::{
        bound::FacetPlace,
        simplify::{Candidate, Facet, NOWHERE, Sheets, SimplifyPlacesParams, StarCountsParams, StarFillParams},
    },
    reference::{
        collapse::{self as twin, Simplified},
        place::Places,
        refine::Base,
    },
};

use super::bounds::Bounds;
use crate::{
    domain::Result,
    render::{JobContext, lists::scan::Scan},
    vulkan::{Device, Recorder, Stream},
};

const WORD: u32 = 4;
const PAIR: u32 = 8;

/// A mesh being simplified, in device memory.
pub struct Simplification<'s> {
    job: &'s JobContext<'s>,
    device: Arc<Device>,
    bounds: &'s Bounds,
    /// Largest distance allowed, local units.
    tolerance: f32,
    vertices: Stream,
    keys: Stream,
    bases: Stream,
    /// Displaced, by vertex.
    positions: Stream,
    facing: Stream,
    sheets: Stream,
    triangles: Stream,
    candidates: Stream,
}

/// Triangles around each vertex, in no order.
struct Stars {
    first: Stream,
    items: Stream,
}

/// Vertices, the first `count` of the stream.
struct List {
    vertices: Stream,
    count: u64,
}

impl<'s> Simplification<'s> {
    pub fn new(
        job: &'s JobContext<'s>,
        device: &Arc<Device>,
        bounds: &'s Bounds,
        places: &Places<'_>,
        mesh: &Simplified,
        tolerance: f64,
    ) -> Result<Self> {
        let positions: Vec<[f32; 3]> = mesh.positions.iter().map(|p| p.as_vec3().to_array()).collect();
        let triangles: Vec<Facet> = mesh.triangles.iter().map(|t| Facet { gv: t.gv, base: t.base }).collect();
        let none = Candidate { to: NOWHERE, error: 0.0 };
        Ok(Self {
            job,
            device: Arc::clone(device),
            bounds,
            tolerance: tolerance as f32,
            vertices: Stream::from_slice(device, "vertices", &mesh.vertices)?,
            keys: Stream::from_slice(device, "keys", &mesh.keys)?,
            bases: Stream::from_slice(device, "bases", &places.base.triangles)?,
            positions: Stream::from_slice(device, "positions", &positions)?,
            facing: Stream::from_slice(device, "facing", &places.tables.triangle_facing)?,
            sheets: Stream::from_slice(device, "sheets", &sheets(places.base))?,
            triangles: Stream::from_slice(device, "triangles", &triangles)?,
            candidates: Stream::from_slice(device, "candidates", &vec![none; mesh.vertices.len()])?,
        })
    }

    /// Collapses all that can be, then flips and collapses again `sweeps` times. Returns the rounds of collapses.
    pub fn run(&mut self, sweeps: u32) -> Result<u32> {
        let all: Vec<u32> = (0..self.vertices.len() as u32).collect();
        let vertices = Stream::from_slice(&self.device, "dirty", &all)?;
        let mut rounds = 0;
        self.collapse(List { vertices, count: all.len() as u64 }, &mut rounds)?;
        for _ in 0..sweeps {
            let Some(dirty) = self.flip()? else { break };
            self.collapse(dirty, &mut rounds)?;
        }
        Ok(rounds)
    }

    /// The triangles that are left.
    pub fn read(&self) -> Result<Vec<twin::Facet>> {
        let triangles: Vec<Facet> = self.triangles.read()?;
        Ok(triangles.into_iter().map(|t| twin::Facet { gv: t.gv, base: t.base }).collect())
    }

    fn recorder(&self) -> Recorder<'s> {
        self.device.recorder(self.job.cancel, self.job.progress)
    }

    fn stream(&self, name: &str, element_bytes: u32, len: u64) -> Result<Stream> {
        Ok(Stream::new(&self.device, name, element_bytes, len)?)
    }

    /// Records the triangles around each vertex.
    fn stars(&self, recorder: &mut Recorder<'_>) -> Result<Stars> {
        let (vertices, triangles) = (self.vertices.len(), self.triangles.len());
        let counts = self.stream("star_counts", WORD, vertices + 1)?;
        let filled = self.stream("star_filled", WORD, vertices)?;
        let stars = Stars {
            first: self.stream("star_first", WORD, vertices + 1)?,
            items: self.stream("star_items", WORD, 3 * triangles)?,
        };
        recorder.fill(&counts, 0)?;
        recorder.fill(&filled, 0)?;
        let params = StarCountsParams { count: triangles as u32 };
        let streams = [("triangles", &self.triangles), ("star_counts", &counts)];
        recorder.dispatch(&SHADERS.star_counts, triangles, &params, &streams)?;
        Scan::new(&self.device, vertices + 1)?.record(recorder, &counts, &stars.first, vertices + 1)?;
        let streams = [
            ("triangles", &self.triangles),
            ("star_first", &stars.first),
            ("star_filled", &filled),
            ("star_items", &stars.items),
        ];
        let params = StarFillParams { count: triangles as u32 };
        recorder.dispatch(&SHADERS.star_fill, triangles, &params, &streams)?;
        Ok(stars)
    }

    /// Records the bounds of all triangles, local units.
    fn errors(&self, mut recorder: Recorder<'s>) -> Result<(Recorder<'s>, Stream)> {
        let triangles = self.triangles.len();
        let facets = self.stream("facets", size_of::<FacetPlace>() as u32, triangles)?;
        let streams =
            [("triangles", &self.triangles), ("vertices", &self.vertices), ("bases", &self.bases), ("facets", &facets)];
        let params = SimplifyPlacesParams { count: triangles as u32 };
        recorder.dispatch(&SHADERS.simplify_places, triangles, &params, &streams)?;
        self.bounds.record(self.job, recorder, &facets, triangles, self.tolerance)
    }
}

fn sheets(base: &Base) -> Vec<Sheets> {
    let mut sheets: Vec<Sheets> = base.edges.iter().map(|gv| Sheets { gv: *gv, count: 0 }).collect();
    base.triangles.iter().flat_map(|t| t.ge).for_each(|ge| sheets[ge as usize].count += 1);
    sheets
}
