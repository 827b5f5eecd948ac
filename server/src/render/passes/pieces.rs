//! Normals and attributes of a surface whose places are listed: what is left to do once a mesh is tessellated.
//!
//! | file | what it does |
//! |---|---|
//! | `places.rs` | the places in base triangles that shade a fine vertex |
//! | `facets.rs` | normals of the triangles themselves |
//! | `bare.rs` | all of a surface but its normals |
//!
//! Both executors share these three; derivatives are taken by the passes `samples`, `jets_*` and
//! `normals_analytic` here, and by their twins in `reference/pieces.rs`.

pub mod bare;
pub mod facets;
pub mod places;

use std::{sync::Arc, time::Instant};

use displace_glsl::{
    layout::{
        geometry::{TrianglePlace, block, counter},
        refine::UNIT,
    },
    tables::Tables,
};
use rayon::prelude::*;

use self::places::{is_corrected, places};
use super::{
    jets::{Domain, Jets, all_details},
    normals::Part,
    reconcile,
    streams::{BaseStreams, CHUNK, FineStreams, Listed, ListedStreams, SampleStreams},
};
use crate::{
    domain::{
        Result,
        mesh::Mesh,
        plan::{NormalsPlan, SurfacePlan},
        surface::{Layout, Shape, Surface},
    },
    vulkan::{Device, PassTime, Recorder},
};

/// Makes a tessellated `shape` of `mesh` a whole surface. Of `plan` it reads the kind of normals; levels, there and in
/// `tables`, do not matter. `mismatch_max` is that of the base's vertices: whoever put vertices on seams between them
/// knows the rest.
pub fn finish(
    device: &Arc<Device>,
    mut recorder: Recorder<'_>,
    plan: &SurfacePlan,
    tables: &Tables,
    base: &BaseStreams,
    mesh: &Mesh,
    shape: Shape,
) -> Result<(Surface, Vec<PassTime>)> {
    let start = Instant::now();
    let mut surface = bare::surface(tables, mesh, shape)?;
    let attributes = on_host("attributes", start);
    let vertices = surface.positions.len() as u64;
    let listed = if plan.normals == NormalsPlan::Analytic { vertices } else { 0 };
    let fine = FineStreams::for_normals(device, listed, tables)?;
    reconcile::record_corners(device, &mut recorder, tables, base, &fine)?;
    if plan.normals == NormalsPlan::Analytic {
        let lots = Lots { tables, mesh, layout: &surface.layout };
        lots.record(device, &mut recorder, base, &fine)?;
    }
    let mut times = recorder.finish()?;
    times.push(attributes);
    surface.mismatch_max = f32::from_bits(fine.counters.read::<u32>()?[counter::MISMATCH]);
    surface.normals = match plan.normals {
        NormalsPlan::Analytic => fine.normals.read()?,
        NormalsPlan::Geometric => {
            let start = Instant::now();
            let normals = facets::normals(tables, mesh, &surface);
            times.push(on_host("normals_geometric", start));
            normals
        }
    };
    Ok((surface, times))
}

fn on_host(name: &'static str, start: Instant) -> PassTime {
    PassTime { name, ms: start.elapsed().as_secs_f64() * 1e3, bytes: 0 }
}

/// Vertices in lots of about `CHUNK` samples.
struct Lots<'a> {
    tables: &'a Tables,
    mesh: &'a Mesh,
    layout: &'a Layout,
}

impl Lots<'_> {
    fn record(
        &self,
        device: &Arc<Device>,
        recorder: &mut Recorder<'_>,
        base: &BaseStreams,
        fine: &FineStreams,
    ) -> Result<()> {
        let all = (0..self.layout.vertices(self.mesh) as u32).into_par_iter();
        // A corrected sample is evaluated once for each side of its seams, so the others are kept apart.
        let (corrected, plain): (Vec<u32>, Vec<u32>) =
            all.partition(|vertex| is_corrected(self.tables, self.layout.place(self.mesh, *vertex as usize)));
        let of_kind = |vertices, corrected| self.cut(vertices).into_iter().map(move |lot| (lot, corrected));
        let lots: Vec<_> = of_kind(&plain, false).chain(of_kind(&corrected, true)).collect();
        let most = lots.iter().map(|((_, samples), _)| *samples).max().unwrap_or(0);
        let mut chunk = SampleStreams::new(device, self.tables, most)?;
        for ((vertices, _), corrected) in lots {
            let listed = self.listed(vertices);
            chunk.listed = ListedStreams::new(device, &listed)?;
            let part = self.part(&listed, corrected);
            let jets = Jets { tables: self.tables, base, av_correction: &fine.av_correction, chunk: &chunk };
            jets.record(recorder, &part.domain)?;
            part.normals(recorder, self.tables, base, fine, &chunk)?;
        }
        Ok(())
    }

    /// Successive vertices, and the number of their samples.
    fn cut<'v>(&self, vertices: &'v [u32]) -> Vec<(&'v [u32], u64)> {
        let count = |vertex: &u32| places(self.tables, self.layout.place(self.mesh, *vertex as usize)).count() as u64;
        let counts: Vec<u64> = vertices.par_iter().map(count).collect();
        let (mut lots, mut start, mut samples) = (Vec::new(), 0, 0);
        for (k, more) in counts.iter().enumerate() {
            if samples > 0 && samples + more > CHUNK {
                lots.push((&vertices[start..k], samples));
                (start, samples) = (k, 0);
            }
            samples += more;
        }
        lots.push((&vertices[start..], samples));
        lots.retain(|(vertices, _)| !vertices.is_empty());
        lots
    }

    fn listed(&self, vertices: &[u32]) -> Listed {
        let of = |vertex: &u32| places(self.tables, self.layout.place(self.mesh, *vertex as usize));
        // Units are whole numbers up to 2^24 and a part of 2^24: exact in f32.
        let weight = |units: u32| units as f32 / UNIT as f32;
        let place = |(triangle, b): (u32, [u32; 2])| TrianglePlace { triangle, b: b.map(weight) };
        let mut first: Vec<u32> = vertices.par_iter().map(|vertex| of(vertex).count() as u32).collect();
        first.push(0);
        let mut sum = 0;
        first.iter_mut().for_each(|count| sum += std::mem::replace(count, sum));
        let places = vertices.par_iter().flat_map_iter(|vertex| of(vertex).map(place)).collect();
        Listed { vertices: vertices.to_vec(), first, places }
    }

    fn part(&self, listed: &Listed, corrected: bool) -> Part {
        let details = if corrected { all_details(self.tables) } else { self.details(&listed.places) };
        let domain = Domain {
            block: block::PLACES,
            start: 0,
            count: listed.places.len() as u64,
            details,
            hats: corrected,
            ramps: corrected,
        };
        Part { domain, vertices: 0..listed.vertices.len() as u64 }
    }

    /// Details of the base triangles of places, in rising number, without 0.
    fn details(&self, places: &[TrianglePlace]) -> Vec<u32> {
        let mut occurs = vec![false; self.tables.details.len()];
        for place in places {
            occurs[self.tables.base_triangles[place.triangle as usize].detail as usize] = true;
        }
        (1..occurs.len() as u32).filter(|detail| occurs[*detail as usize]).collect()
    }
}
