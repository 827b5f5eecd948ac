//! What a render keeps on the device: the scene for all of it, and the working memory of one slab.

use std::sync::Arc;

use bytemuck::Pod;
use displace_glsl::layout::raster::{Fragment, LISTS, MAX_PIECES, SAMPLES, SMALL_SAMPLES, SurfacePoint, TILE_PX};

use crate::{
    domain::{
        Result,
        image::{ImagePlan, RenderMesh, RenderScene},
        request::Aov,
    },
    render::lists::scan::Scan,
    vulkan::{Device, Stream},
};

use super::{tables::Tables, textures::Textures};

/// Triangles that `setup` sorts at a time.
pub(crate) const RANGE_TRIANGLES: u64 = 1 << 20;
/// Large triangles that become records at a time.
pub(crate) const LARGE_CHUNK: u64 = 1 << 15;
/// (record, tile) pairs drawn at a time.
pub(crate) const PAIR_CHUNK: u64 = 1 << 18;
/// Samples that one pair can cover.
const TILE_SAMPLES: u64 = (TILE_PX * TILE_PX * SAMPLES) as u64;
/// Fragments kept at least, so that alpha tests of small images do not run one by one.
const MIN_MASKED_FRAGMENTS: u64 = 1 << 16;

/// All meshes one after the other, and the tables.
pub(crate) struct SceneStreams {
    pub(crate) positions: Stream,
    pub(crate) normals: Stream,
    pub(crate) uvs: Stream,
    pub(crate) colors: Stream,
    pub(crate) triangles: Stream,
    pub(crate) parts: Stream,
    pub(crate) instance_rows: Stream,
    pub(crate) materials: Stream,
    pub(crate) levels: Stream,
    pub(crate) texels: Stream,
}

impl SceneStreams {
    pub(crate) fn upload(
        device: &Arc<Device>,
        scene: &RenderScene,
        tables: &Tables,
        textures: &Textures,
    ) -> Result<Self> {
        let meshes = &scene.meshes;
        Ok(Self {
            positions: concatenated(device, "positions", meshes, |mesh| &mesh.positions)?,
            normals: concatenated(device, "normals", meshes, |mesh| &mesh.normals)?,
            uvs: concatenated(device, "uvs", meshes, |mesh| &mesh.uvs)?,
            colors: colors(device, scene, tables)?,
            triangles: triangles(device, scene, tables)?,
            parts: Stream::from_slice(device, "parts", &tables.parts)?,
            instance_rows: Stream::from_slice(device, "instance_rows", &tables.instance_rows)?,
            materials: Stream::from_slice(device, "materials", &tables.materials)?,
            levels: Stream::from_slice(device, "levels", &textures.levels)?,
            texels: textures.upload(device)?,
        })
    }
}

/// Copies what of the lists falls into `target`, which starts at `first` of their concatenation.
fn copy_overlap<'a, T: Copy + 'a>(lists: impl Iterator<Item = &'a [T]>, first: u64, target: &mut [T]) {
    let (first, mut start) = (first as usize, 0);
    for list in lists {
        let (from, to) = (start.max(first), (start + list.len()).min(first + target.len()));
        if from < to {
            target[from - first..to - first].copy_from_slice(&list[from - start..to - start]);
        }
        start += list.len();
    }
}

fn concatenated<T: Pod>(
    device: &Arc<Device>,
    name: &str,
    meshes: &[RenderMesh],
    list: impl Fn(&RenderMesh) -> &[T],
) -> Result<Stream> {
    let len = meshes.iter().map(|mesh| list(mesh).len() as u64).sum();
    let write = |first, target: &mut [T]| copy_overlap(meshes.iter().map(&list), first, target);
    Ok(Stream::build(device, name, len, write)?)
}

/// Vertex colours of all meshes, white where a mesh has none; empty when no mesh has any.
fn colors(device: &Arc<Device>, scene: &RenderScene, tables: &Tables) -> Result<Stream> {
    if !tables.colored {
        return Ok(Stream::new(device, "colors", 16, 0)?);
    }
    let vertices = scene.meshes.iter().map(|mesh| mesh.positions.len() as u64).sum();
    let stream = Stream::build(device, "colors", vertices, |first, target: &mut [[f32; 4]]| {
        target.fill([1.0; 4]);
        let end = first + target.len() as u64;
        for (mesh, place) in scene.meshes.iter().zip(&tables.meshes) {
            let (from, to) = (place.vertex_base.max(first), (place.vertex_base + mesh.colors.len() as u64).min(end));
            if from < to {
                let source = &mesh.colors[(from - place.vertex_base) as usize..(to - place.vertex_base) as usize];
                target[(from - first) as usize..(to - first) as usize].copy_from_slice(source);
            }
        }
    })?;
    Ok(stream)
}

/// Triangles that name vertices of the concatenated streams.
fn triangles(device: &Arc<Device>, scene: &RenderScene, tables: &Tables) -> Result<Stream> {
    let len = scene.meshes.iter().map(|mesh| mesh.triangles.len() as u64).sum();
    let stream = Stream::build(device, "triangles", len, |first, target: &mut [[u32; 3]]| {
        copy_overlap(scene.meshes.iter().map(|mesh| mesh.triangles.as_slice()), first, target);
        let end = first + target.len() as u64;
        for (mesh, place) in scene.meshes.iter().zip(&tables.meshes) {
            let from = place.triangle_base.clamp(first, end);
            let to = (place.triangle_base + mesh.triangles.len() as u64).clamp(first, end);
            for triangle in &mut target[(from - first) as usize..(to - first) as usize] {
                *triangle = triangle.map(|vertex| vertex + place.vertex_base as u32);
            }
        }
    })?;
    Ok(stream)
}

/// Working memory of a slab.
pub(crate) struct WorkStreams {
    pub(crate) screen: Stream,
    pub(crate) visibility: Stream,
    pub(crate) counters: Stream,
    pub(crate) lists: Stream,
    /// Room in each of the lists.
    pub(crate) list_capacity: u64,
    pub(crate) records: Stream,
    pub(crate) tile_counts: Stream,
    pub(crate) tile_offsets: Stream,
    pub(crate) scan: Scan,
    pub(crate) pairs: Stream,
    pub(crate) fragment_count: Stream,
    pub(crate) fragments: Stream,
    pub(crate) points: Stream,
    pub(crate) point_colors: Stream,
    pub(crate) pixels: Stream,
    pub(crate) outputs: Outputs,
    /// Triangles, and pairs, whose samples are sure to fit `fragments`.
    pub(crate) masked_small_chunk: u64,
    pub(crate) masked_pair_chunk: u64,
}

/// Images of a slab; those nobody asked for are empty.
pub(crate) struct Outputs {
    pub(crate) color: Stream,
    pub(crate) depth: Stream,
    pub(crate) normal: Stream,
    pub(crate) position: Stream,
    pub(crate) uv: Stream,
    pub(crate) triangle: Stream,
}

impl WorkStreams {
    pub(crate) fn new(device: &Arc<Device>, plan: &ImagePlan, aovs: &[Aov], tables: &Tables) -> Result<Self> {
        let pixels = u64::from(plan.width.min(plan.slab_px)) * u64::from(plan.height.min(plan.slab_px));
        let samples = pixels * u64::from(SAMPLES);
        let fragments = if tables.masked { samples.max(MIN_MASKED_FRAGMENTS) } else { samples };
        let vertices = tables.batches.iter().map(|batch| batch.vertices).max().unwrap_or(0);
        let triangles = tables.batches.iter().map(|batch| batch.triangles.end - batch.triangles.start).max();
        let list_capacity = triangles.unwrap_or(0).min(RANGE_TRIANGLES);
        let records = list_capacity.min(LARGE_CHUNK) * u64::from(MAX_PIECES);
        let new = |name: &str, bytes: usize, len: u64| Stream::new(device, name, bytes as u32, len);
        Ok(Self {
            screen: new("screen", 16, vertices)?,
            visibility: new("visibility", 8, samples)?,
            counters: new("counters", 4, LISTS as u64)?,
            lists: new("lists", 4, list_capacity * LISTS as u64)?,
            list_capacity,
            records: new("records", 16, records * 3)?,
            tile_counts: new("tile counts", 4, records)?,
            tile_offsets: new("tile offsets", 4, records)?,
            scan: Scan::new(device, records)?,
            pairs: new("pairs", 8, if records > 0 { PAIR_CHUNK } else { 0 })?,
            fragment_count: new("fragment count", 4, 1)?,
            fragments: new("fragments", size_of::<Fragment>(), fragments)?,
            points: new("points", size_of::<SurfacePoint>(), fragments)?,
            point_colors: new("point colours", 16, fragments)?,
            pixels: new("pixels", 4, pixels)?,
            outputs: Outputs::new(device, pixels, aovs)?,
            masked_small_chunk: fragments / u64::from(SMALL_SAMPLES),
            masked_pair_chunk: fragments / TILE_SAMPLES,
        })
    }
}

impl Outputs {
    fn new(device: &Arc<Device>, pixels: u64, aovs: &[Aov]) -> Result<Self> {
        let stream = |name: &str, bytes: u32, aov: Aov| {
            Stream::new(device, name, bytes, if aovs.contains(&aov) { pixels } else { 0 })
        };
        Ok(Self {
            color: Stream::new(device, "color", 16, pixels)?,
            depth: stream("depth", 4, Aov::Depth)?,
            normal: stream("normal", 12, Aov::Normal)?,
            position: stream("position", 12, Aov::Position)?,
            uv: stream("uv", 8, Aov::Uv)?,
            triangle: stream("triangle", 4, Aov::Triangle)?,
        })
    }
}
