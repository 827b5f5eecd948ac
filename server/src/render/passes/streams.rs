//! The streams of the geometry passes: tables of the base mesh, and what belongs to fine vertices.

use std::sync::Arc;

use displace_glsl::{
    ComputeShader,
    layout::geometry::{Sample, TrianglePlace, counter, kind},
    tables::Tables,
};

use crate::{
    domain::{Result, plan::SurfacePlan},
    vulkan::{Device, Stream},
};

/// Most samples evaluated at once.
pub const CHUNK: u64 = 1 << 20;
const VEC3: u32 = 12;
const VEC4: u32 = 16;
const MAT3: u32 = 36;

/// The tables on the device.
pub struct BaseStreams {
    pub av_position_u: Stream,
    pub av_direction_v: Stream,
    pub av_normal: Stream,
    pub av_tangent: Stream,
    pub base_edges: Stream,
    pub base_triangles: Stream,
    /// Of a smooth base; else empty, as `patch_points` is.
    pub patch_nodes: Stream,
    pub patch_points: Stream,
    pub triangle_facing: Stream,
    pub layers: Stream,
    pub texels: Stream,
    pub instructions: Stream,
    pub contribution_first: Stream,
    pub contributions: Stream,
    pub triangle_order: Stream,
    pub seam_vertices: Stream,
    pub seam_corners: Stream,
    pub seams: Stream,
    pub seam_sides: Stream,
    pub triangle_correction: Stream,
    pub corrections: Stream,
}

impl BaseStreams {
    pub fn new(device: &Arc<Device>, tables: &Tables) -> Result<Self> {
        let t = tables;
        let (nodes, points) = t.patches.as_deref().map_or((&[][..], &[][..]), |p| (&p.nodes, &p.points));
        Ok(Self {
            av_position_u: Stream::from_slice(device, "av_position_u", &t.av_position_u)?,
            av_direction_v: Stream::from_slice(device, "av_direction_v", &t.av_direction_v)?,
            av_normal: Stream::from_slice(device, "av_normal", &t.av_normal)?,
            av_tangent: Stream::from_slice(device, "av_tangent", &t.av_tangent)?,
            base_edges: Stream::from_slice(device, "base_edges", &t.base_edges)?,
            base_triangles: Stream::from_slice(device, "base_triangles", &t.base_triangles)?,
            patch_nodes: Stream::from_slice(device, "patch_nodes", nodes)?,
            patch_points: Stream::from_slice(device, "patch_points", points)?,
            triangle_facing: Stream::from_slice(device, "triangle_facing", &t.triangle_facing)?,
            layers: Stream::from_slice(device, "layers", &t.layers)?,
            texels: Stream::of_texels(device, &t.texels)?,
            instructions: Stream::from_slice(device, "instructions", &t.instructions)?,
            contribution_first: Stream::from_slice(device, "contribution_first", &t.contribution_first)?,
            contributions: Stream::from_slice(device, "contributions", &t.contributions)?,
            triangle_order: Stream::from_slice(device, "triangle_order", &t.triangle_order)?,
            seam_vertices: Stream::from_slice(device, "seam_vertices", &t.seam_vertices)?,
            seam_corners: Stream::from_slice(device, "seam_corners", &t.seam_corners)?,
            seams: Stream::from_slice(device, "seams", &t.seams)?,
            seam_sides: Stream::from_slice(device, "seam_sides", &t.seam_sides)?,
            triangle_correction: Stream::from_slice(device, "triangle_correction", &t.triangle_correction)?,
            corrections: Stream::from_slice(device, "corrections", &t.corrections)?,
        })
    }
}

/// What the passes write, one element per fine vertex or triangle.
pub struct FineStreams {
    pub base_position_u: Stream,
    pub base_direction_v: Stream,
    /// Empty unless a layer reads normals.
    pub base_normals: Stream,
    /// Empty unless a layer reads tangents.
    pub base_tangents: Stream,
    pub positions: Stream,
    pub normals: Stream,
    pub triangles: Stream,
    pub av_correction: Stream,
    pub counters: Stream,
}

impl FineStreams {
    pub fn new(device: &Arc<Device>, plan: &SurfacePlan, tables: &Tables) -> Result<Self> {
        let vertices = plan.vertices;
        let reads_tangents = tables.layers.iter().any(|layer| layer.kind == kind::VECTOR_TANGENT);
        let reads_normals = reads_tangents || tables.layers.iter().any(|layer| layer.kind == kind::EXPRESSION);
        let only_if = |wanted: bool| if wanted { vertices } else { 0 };
        Ok(Self {
            base_position_u: Stream::new(device, "base_position_u", VEC4, vertices)?,
            base_direction_v: Stream::new(device, "base_direction_v", VEC4, vertices)?,
            base_normals: Stream::new(device, "base_normals", VEC3, only_if(reads_normals))?,
            base_tangents: Stream::new(device, "base_tangents", VEC4, only_if(reads_tangents))?,
            positions: Stream::new(device, "positions", VEC3, vertices)?,
            normals: Stream::new(device, "normals", VEC3, vertices)?,
            triangles: Stream::new(device, "triangles", VEC3, plan.triangles)?,
            av_correction: Stream::from_slice(device, "av_correction", &vec![[0.0f32; 3]; tables.av_normal.len()])?,
            counters: Stream::from_slice(device, "counters", &[0u32; counter::COUNT])?,
        })
    }

    /// For a surface whose positions and triangles are known: `vertices` normals, and what corners are
    /// reconciled with.
    pub fn for_normals(device: &Arc<Device>, vertices: u64, tables: &Tables) -> Result<Self> {
        let empty = |name: &str, bytes| Stream::new(device, name, bytes, 0);
        let corners = tables.av_normal.len();
        Ok(Self {
            base_position_u: empty("base_position_u", VEC4)?,
            base_direction_v: empty("base_direction_v", VEC4)?,
            base_normals: empty("base_normals", VEC3)?,
            base_tangents: empty("base_tangents", VEC4)?,
            positions: Stream::new(device, "positions", VEC3, corners as u64)?,
            normals: Stream::new(device, "normals", VEC3, vertices)?,
            triangles: empty("triangles", VEC3)?,
            av_correction: Stream::from_slice(device, "av_correction", &vec![[0.0f32; 3]; corners])?,
            counters: Stream::from_slice(device, "counters", &[0u32; counter::COUNT])?,
        })
    }

    /// Gives back what only the displacement passes read.
    pub fn release_base(&mut self, device: &Arc<Device>) -> Result<()> {
        self.base_position_u = Stream::new(device, "base_position_u", VEC4, 0)?;
        self.base_direction_v = Stream::new(device, "base_direction_v", VEC4, 0)?;
        self.base_normals = Stream::new(device, "base_normals", VEC3, 0)?;
        self.base_tangents = Stream::new(device, "base_tangents", VEC4, 0)?;
        Ok(())
    }
}

/// Samples and their jets, for one chunk after the other.
pub struct SampleStreams {
    pub samples: Stream,
    pub jets: Stream,
    /// Of a smooth base; else empty.
    pub fields: Stream,
    pub listed: ListedStreams,
}

impl SampleStreams {
    pub fn new(device: &Arc<Device>, tables: &Tables, len: u64) -> Result<Self> {
        let of_smooth = if tables.patches.is_some() { len } else { 0 };
        Ok(Self {
            samples: Stream::new(device, "samples", size_of::<Sample>() as u32, len)?,
            jets: Stream::new(device, "jets", MAT3, len)?,
            fields: Stream::new(device, "fields", 3 * MAT3, of_smooth)?,
            listed: ListedStreams::new(device, &Listed::default())?,
        })
    }
}

impl SampleStreams {
    /// The shader that fits the base; that of a smooth one reads `fields` too.
    pub fn variant<'s>(
        &'s self,
        streams: &mut Vec<(&'static str, &'s Stream)>,
        flat: &'static ComputeShader,
        smooth: &'static ComputeShader,
    ) -> &'static ComputeShader {
        if self.fields.is_empty() {
            return flat;
        }
        streams.push(("fields", &self.fields));
        smooth
    }
}

/// Vertices of a chunk and where each is looked at, for the block `PLACES`; empty for all others.
#[derive(Clone, Debug, Default)]
pub struct Listed {
    /// Fine numbers.
    pub vertices: Vec<u32>,
    /// The first place of each vertex, and the end.
    pub first: Vec<u32>,
    pub places: Vec<TrianglePlace>,
}

/// [`Listed`] on the device.
pub struct ListedStreams {
    pub place_vertices: Stream,
    pub place_first: Stream,
    pub places: Stream,
}

impl ListedStreams {
    pub fn new(device: &Arc<Device>, listed: &Listed) -> Result<Self> {
        Ok(Self {
            place_vertices: Stream::from_slice(device, "place_vertices", &listed.vertices)?,
            place_first: Stream::from_slice(device, "place_first", &listed.first)?,
            places: Stream::from_slice(device, "places", &listed.places)?,
        })
    }
}
