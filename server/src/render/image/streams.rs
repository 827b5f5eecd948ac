//! What a render keeps on the device: the scene for all of it, and the working memory of one slab.

use std::sync::Arc;

use bytemuck::Pod;
use displace_glsl::{
    layout::{
        light::Surroundings,
        raster::{
            Appearance, Fragment, LISTS, MAP_NORMAL_MOMENTS, MAP_SLOTS, MAX_PIECES, SAMPLES, SMALL_SAMPLES, Spread,
            SurfacePoint, TILE_PX,
        },
    },
    reference::surroundings::Room,
};

use crate::{
    domain::{
        Error, Result,
        image::{ImagePlan, RenderMesh, RenderScene, Shading},
        request::{Aov, Shadows},
    },
    render::{lists::scan::Scan, occluders::Shade, reflection::Reflection},
    vulkan::{Device, Recorder, Stream},
};

use super::{
    bump::BumpStreams,
    charts,
    environment::{self, EnvironmentStreams},
    projected::ProjectedStreams,
    relief::{MarchStreams, ReliefStreams},
    silhouettes::SilhouetteStreams,
    tables::Tables,
    textures::Textures,
};

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
    /// Of corners; empty where no mesh has any.
    pub(crate) tangents: Stream,
    pub(crate) colors: Stream,
    pub(crate) triangles: Stream,
    pub(crate) silhouettes: SilhouetteStreams,
    pub(crate) parts: Stream,
    pub(crate) instance_rows: Stream,
    pub(crate) boxes: Stream,
    pub(crate) materials: Stream,
    pub(crate) texture_uses: Stream,
    pub(crate) bump: BumpStreams,
    pub(crate) relief: ReliefStreams,
    /// Of triangles; empty where rays do not keep to charts.
    pub(crate) chart_sides: Stream,
    pub(crate) lights: Stream,
    pub(crate) levels: Stream,
    pub(crate) texels: Stream,
    pub(crate) occluders: Option<OccluderStreams>,
    pub(crate) environment: Option<EnvironmentStreams>,
    /// What materials see in its place.
    pub(crate) reflections: Vec<ReflectionStreams>,
    /// What surfaces reflect; empty unless the shading needs it.
    pub(crate) brdf_table: Stream,
}

/// What the surfaces of a material see, and the room that it shows.
pub(crate) struct ReflectionStreams {
    pub(crate) material: u32,
    pub(crate) environment: EnvironmentStreams,
    pub(crate) room: Option<Room>,
}

impl ReflectionStreams {
    fn upload(device: &Arc<Device>, reflection: &Reflection) -> Result<Self> {
        let environment = EnvironmentStreams::upload(device, &reflection.environment)?;
        Ok(Self { material: reflection.material, environment, room: reflection.room })
    }
}

/// What shadow rays meet.
pub(crate) struct OccluderStreams {
    pub(crate) nodes: Stream,
    pub(crate) corners: Stream,
    pub(crate) items: Stream,
    pub(crate) offset_world: f32,
}

impl OccluderStreams {
    fn upload(device: &Arc<Device>, scene: &RenderScene, tables: &Tables) -> Result<Option<Self>> {
        if scene.shadows != Shadows::Ray || tables.lights.is_empty() {
            return Ok(None);
        }
        let Shade { occluders, offset_world } = Shade::new(scene, tables)?;
        Ok(Some(Self {
            nodes: Stream::from_slice(device, "nodes", &occluders.nodes)?,
            corners: Stream::from_slice(device, "occluder corners", &occluders.corners)?,
            items: Stream::from_slice(device, "occluders", &occluders.items)?,
            offset_world,
        }))
    }
}

impl SceneStreams {
    pub(crate) fn upload(
        device: &Arc<Device>,
        scene: &RenderScene,
        tables: &Tables,
        textures: &Textures,
        reflections: &[Reflection],
    ) -> Result<Self> {
        let (meshes, environment) = (&scene.meshes, &scene.lighting.environment);
        Ok(Self {
            positions: concatenated(device, "positions", meshes, |mesh| &mesh.positions)?,
            normals: concatenated(device, "normals", meshes, |mesh| &mesh.normals)?,
            uvs: concatenated(device, "uvs", meshes, |mesh| &mesh.uvs)?,
            tangents: tangents(device, scene, tables)?,
            colors: colors(device, scene, tables)?,
            triangles: triangles(device, scene, tables)?,
            silhouettes: SilhouetteStreams::upload(device, scene)?,
            parts: Stream::from_slice(device, "parts", &tables.parts)?,
            instance_rows: Stream::from_slice(device, "instance_rows", &tables.instance_rows)?,
            boxes: Stream::from_slice(device, "boxes", &tables.boxes)?,
            materials: Stream::from_slice(device, "materials", &tables.materials)?,
            texture_uses: Stream::from_slice(device, "texture uses", &tables.texture_uses)?,
            bump: BumpStreams::upload(device, &tables.bump)?,
            relief: ReliefStreams::upload(device, &tables.relief)?,
            chart_sides: Stream::from_slice(device, "chart sides", &charts::concatenated(scene))?,
            lights: Stream::from_slice(device, "lights", &tables.lights)?,
            levels: Stream::from_slice(device, "levels", &textures.levels)?,
            texels: textures.upload(device)?,
            occluders: OccluderStreams::upload(device, scene, tables)?,
            environment: environment.as_ref().map(|map| EnvironmentStreams::upload(device, map)).transpose()?,
            reflections: reflections.iter().map(|r| ReflectionStreams::upload(device, r)).collect::<Result<_>>()?,
            brdf_table: environment::table(device, scene.shading == Shading::Pbr)?,
        })
    }

    /// Makes what light needs: levels of the environment, and the table of what surfaces reflect.
    pub(crate) fn record_light(&self, recorder: &mut Recorder<'_>) -> Result<()> {
        if !self.brdf_table.is_empty() {
            environment::record_table(recorder, &self.brdf_table)?;
        }
        let reflections = self.reflections.iter().map(|reflection| &reflection.environment);
        self.environment.iter().chain(reflections).try_for_each(|environment| environment.record(recorder))
    }

    /// Whether any surface sees an environment.
    pub(crate) fn has_surroundings(&self) -> bool {
        self.environment.is_some() || !self.reflections.is_empty()
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

/// Tangents of all corners, 0 where a mesh has none; empty when no mesh has any.
fn tangents(device: &Arc<Device>, scene: &RenderScene, tables: &Tables) -> Result<Stream> {
    let meshes = scene.meshes.iter().zip(&tables.meshes);
    let places: Vec<_> = meshes.map(|(mesh, place)| (mesh.tangents.as_slice(), 3 * place.triangle_base)).collect();
    let corners = scene.meshes.iter().map(|mesh| 3 * mesh.triangles.len() as u64).sum();
    sparse(device, "tangents", corners, &places, [0.0; 4])
}

/// Vertex colours of all meshes, white where a mesh has none; empty when no mesh has any.
fn colors(device: &Arc<Device>, scene: &RenderScene, tables: &Tables) -> Result<Stream> {
    let meshes = scene.meshes.iter().zip(&tables.meshes);
    let places: Vec<_> = meshes.map(|(mesh, place)| (mesh.colors.as_slice(), place.vertex_base)).collect();
    let vertices = scene.meshes.iter().map(|mesh| mesh.positions.len() as u64).sum();
    sparse(device, "colors", vertices, &places, [1.0; 4])
}

/// A stream of `len` where lists begin at their places, and `other` is between them; empty when all lists are.
fn sparse(
    device: &Arc<Device>,
    name: &str,
    len: u64,
    places: &[(&[[f32; 4]], u64)],
    other: [f32; 4],
) -> Result<Stream> {
    if places.iter().all(|(list, _)| list.is_empty()) {
        return Ok(Stream::new(device, name, 16, 0)?);
    }
    let stream = Stream::build(device, name, len, |first, target: &mut [[f32; 4]]| {
        target.fill(other);
        let end = first + target.len() as u64;
        for (list, start) in places {
            let (from, to) = ((*start).max(first), (start + list.len() as u64).min(end));
            if from < to {
                let source = &list[(from - start) as usize..(to - start) as usize];
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
    /// What the maps of each kind show of each fragment; empty where no material has any.
    pub(crate) mapped: [Stream; MAP_SLOTS],
    /// Of formulas along two sides of each fragment's triangle; empty where none bends normals.
    pub(crate) rises: Stream,
    pub(crate) projected: ProjectedStreams,
    pub(crate) march: MarchStreams,
    pub(crate) appearances: Stream,
    /// How the normals of each fragment scatter; empty without moments.
    pub(crate) spreads: Stream,
    /// Where rays to lights go.
    pub(crate) aims: Stream,
    /// Share of each light that arrives at each fragment; empty without shadows.
    pub(crate) shadows: Stream,
    /// What each fragment sees of an environment; empty without one.
    pub(crate) surroundings: Stream,
    pub(crate) radiance: Stream,
    /// The environment behind each pixel; empty without one.
    pub(crate) backdrop: Stream,
    pub(crate) pixels: Stream,
    pub(crate) layers: LayerStreams,
    pub(crate) outputs: Outputs,
    /// Triangles, and pairs, whose samples are sure to fit `fragments`.
    pub(crate) masked_small_chunk: u64,
    pub(crate) masked_pair_chunk: u64,
}

/// What blended surfaces are added up in; empty where none is.
pub(crate) struct LayerStreams {
    /// Of a layer and of the one before it, in turn.
    pub(crate) keys: [Stream; 2],
    /// Keys of what the further outputs show.
    pub(crate) shown: Stream,
    /// Share of what is behind the layers that each sample sees.
    pub(crate) transmittance: Stream,
    /// What each pixel sees of them.
    pub(crate) layered: Stream,
}

impl LayerStreams {
    fn new(device: &Arc<Device>, pixels: u64) -> Result<Self> {
        let samples = pixels * u64::from(SAMPLES);
        let keys = || Stream::new(device, "layer keys", 8, samples);
        Ok(Self {
            keys: [keys()?, keys()?],
            shown: keys()?,
            transmittance: Stream::new(device, "transmittance", 4, samples)?,
            layered: Stream::new(device, "layered", 12, pixels)?,
        })
    }
}

/// Images of a slab; those nobody asked for are empty.
pub(crate) struct Outputs {
    pub(crate) color: Stream,
    /// Of squares of `color`; empty where it is not averaged.
    pub(crate) means: Stream,
    pub(crate) depth: Stream,
    pub(crate) normal: Stream,
    pub(crate) position: Stream,
    pub(crate) uv: Stream,
    pub(crate) triangle: Stream,
    pub(crate) overdraw: Stream,
    pub(crate) samples: Stream,
}

impl WorkStreams {
    pub(crate) fn new(
        device: &Arc<Device>,
        plan: &ImagePlan,
        side: u32,
        scene: &RenderScene,
        tables: &Tables,
    ) -> Result<Self> {
        let pixels = u64::from(plan.width.min(plan.slab_px)) * u64::from(plan.height.min(plan.slab_px));
        let samples = pixels * u64::from(SAMPLES);
        let fragments = if tables.masked { samples.max(MIN_MASKED_FRAGMENTS) } else { samples };
        let vertices = tables.batches.iter().map(|batch| batch.vertices).max().unwrap_or(0);
        let triangles = tables.batches.iter().map(|batch| batch.triangles.end - batch.triangles.start).max();
        let list_capacity = triangles.unwrap_or(0).min(RANGE_TRIANGLES);
        let records = list_capacity.min(LARGE_CHUNK) * u64::from(MAX_PIECES);
        let has_environment = scene.lighting.environment.is_some();
        let has_surroundings = has_environment || !scene.reflectors.is_empty();
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
            mapped: mapped(device, scene, fragments)?,
            rises: new("rises", 8, if tables.bump.formulas.is_empty() { 0 } else { fragments })?,
            projected: ProjectedStreams::new(device, scene, fragments)?,
            march: MarchStreams::new(device, &tables.relief, fragments, pixels)?,
            appearances: new("appearances", size_of::<Appearance>(), samples)?,
            spreads: new("spreads", size_of::<Spread>(), if scene.has_map(MAP_NORMAL_MOMENTS) { samples } else { 0 })?,
            shadows: new("shadows", 4, if scene.has_shadows() { samples * tables.lights.len() as u64 } else { 0 })?,
            aims: new(
                "aims",
                16,
                if scene.shadows == Shadows::Ray { samples * tables.lights.len() as u64 } else { 0 },
            )?,
            surroundings: new("surroundings", size_of::<Surroundings>(), if has_surroundings { samples } else { 0 })?,
            radiance: new("radiance", 16, samples)?,
            backdrop: new("backdrop", 12, if has_environment { pixels } else { 0 })?,
            pixels: new("pixels", 4, pixels)?,
            layers: LayerStreams::new(device, if tables.has_layers { pixels } else { 0 })?,
            outputs: Outputs::new(device, pixels, side, &scene.aovs)?,
            masked_small_chunk: fragments / u64::from(SMALL_SAMPLES),
            masked_pair_chunk: fragments / TILE_SAMPLES,
        })
    }
}

fn mapped(device: &Arc<Device>, scene: &RenderScene, fragments: u64) -> Result<[Stream; MAP_SLOTS]> {
    let slots = (0..MAP_SLOTS).map(|slot| {
        let len = if scene.has_map(slot) { fragments } else { 0 };
        Ok(Stream::new(device, "mapped", 16, len)?)
    });
    let slots: Vec<Stream> = slots.collect::<Result<_>>()?;
    slots.try_into().map_err(|_| Error::internal("not as many streams as kinds of maps"))
}

impl Outputs {
    fn new(device: &Arc<Device>, pixels: u64, side: u32, aovs: &[Aov]) -> Result<Self> {
        let stream = |name: &str, bytes: u32, aov: Aov| {
            Stream::new(device, name, bytes, if aovs.contains(&aov) { pixels } else { 0 })
        };
        Ok(Self {
            color: Stream::new(device, "color", 16, pixels)?,
            means: Stream::new(device, "means", 16, if side > 1 { pixels / u64::from(side * side) } else { 0 })?,
            depth: stream("depth", 4, Aov::Depth)?,
            normal: stream("normal", 12, Aov::Normal)?,
            position: stream("position", 12, Aov::Position)?,
            uv: stream("uv", 8, Aov::Uv)?,
            triangle: stream("triangle", 4, Aov::Triangle)?,
            overdraw: stream("overdraw", 4, Aov::Overdraw)?,
            samples: stream("samples", 4, Aov::Samples)?,
        })
    }
}
