//! The tables both executors render from: parts of the scene, instance matrices, materials, and batches
//! that bound how much is on the screen at a time.

use std::ops::Range;

use displace_glsl::layout::raster::{
    INSTANCE_ROWS, LIGHT_POINT, LIGHT_SPOT, LIGHT_SUN, Light, MAP_NORMAL, MATERIAL_NORMAL_MAP, MATERIAL_STOCHASTIC,
    MATERIAL_UNLIT, Material, PART_BLENDED, PART_COLORED, PART_DOUBLE_SIDED, PART_MASKED, PART_MIRRORED, PART_RELIEF,
    PART_UNSEEN, Part, TextureUse,
};
use glam::{DMat3, DMat4, DVec3, DVec4};

use super::{bump::BumpTables, proxies, relief::ReliefTables};
use crate::domain::{
    Error, Result,
    detail::Wrap,
    image::{
        ImagePlan, LightShape, RenderAlpha, RenderCamera, RenderLight, RenderMap, RenderMaterial, RenderMesh,
        RenderScene,
    },
    projection::ProjectionBox,
};

/// Screen vertices of a batch, unless a single instance has more: 128 MiB.
const BATCH_VERTICES: u64 = 8 << 20;

#[derive(Debug)]
pub(crate) struct Tables {
    pub(crate) parts: Vec<Part>,
    /// `INSTANCE_ROWS` for each instance.
    pub(crate) instance_rows: Vec<[f32; 4]>,
    /// Of each instance, what its mesh is projected from: centre and side.
    pub(crate) boxes: Vec<[f32; 4]>,
    pub(crate) materials: Vec<Material>,
    /// `MAP_SLOTS` for each material, without their levels.
    pub(crate) texture_uses: Vec<TextureUse>,
    pub(crate) bump: BumpTables,
    pub(crate) relief: ReliefTables,
    pub(crate) lights: Vec<Light>,
    pub(crate) meshes: Vec<MeshPlace>,
    pub(crate) batches: Vec<Batch>,
    pub(crate) masked: bool,
    pub(crate) colored: bool,
    /// Some triangles are blended.
    pub(crate) has_layers: bool,
}

/// Where a mesh begins in the streams that hold all meshes.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct MeshPlace {
    pub(crate) vertex_base: u64,
    pub(crate) triangle_base: u64,
}

/// Vertices of an instance on the screen.
#[derive(Clone, Copy, Debug)]
pub(crate) struct OnScreen {
    pub(crate) instance: u32,
    pub(crate) vertex_first: u32,
    pub(crate) screen_first: u32,
    pub(crate) vertices: u64,
}

/// Consecutive instances whose vertices are on the screen together.
#[derive(Debug, Default)]
pub(crate) struct Batch {
    pub(crate) instances: Vec<OnScreen>,
    pub(crate) parts: Range<usize>,
    /// Triangle numbers over all instances.
    pub(crate) triangles: Range<u64>,
    /// From the first that is blended to behind the last; empty where none is.
    pub(crate) blended: Range<u64>,
    pub(crate) vertices: u64,
}

impl Tables {
    pub(crate) fn new(plan: &ImagePlan, scene: &RenderScene) -> Result<Self> {
        check(scene)?;
        let mut tables = Self {
            parts: Vec::new(),
            instance_rows: Vec::new(),
            boxes: Vec::new(),
            materials: scene.materials.iter().map(material).collect(),
            texture_uses: scene.materials.iter().flat_map(|m| &m.maps).map(texture_use).collect(),
            bump: BumpTables::new(scene)?,
            relief: ReliefTables::new(scene)?,
            lights: scene.lighting.lights.iter().map(light).collect(),
            meshes: places(&scene.meshes),
            batches: vec![Batch::default()],
            masked: false,
            has_layers: false,
            colored: scene.meshes.iter().any(|mesh| !mesh.colors.is_empty()),
        };
        let pixel_from_world = pixel_from_world(&scene.camera, [plan.width, plan.height]);
        let mut is_stood_for = vec![false; scene.instances.len()];
        scene.instances.iter().filter_map(|instance| instance.stands_for).for_each(|base| is_stood_for[base] = true);
        for (index, instance) in scene.instances.iter().enumerate() {
            let world_from_mesh = DMat4::from_cols_array(&instance.world_from_mesh.map(f64::from));
            tables.instance_rows.extend(instance_rows(pixel_from_world * world_from_mesh, world_from_mesh));
            let ProjectionBox { centre: [x, y, z], side } = scene.meshes[instance.mesh].projection_box;
            tables.boxes.push([x, y, z, side]);
            let mirrored = DMat3::from_mat4(world_from_mesh).determinant() < 0.0;
            let flags = if mirrored { PART_MIRRORED } else { 0 } | if is_stood_for[index] { PART_UNSEEN } else { 0 };
            tables.add_instance(scene, index, flags)?;
        }
        tables.has_layers = tables.batches.iter().any(|batch| !batch.blended.is_empty());
        tables.masked = tables.parts.iter().any(|part| part.flags & PART_MASKED != 0);
        Ok(tables)
    }

    fn add_instance(&mut self, scene: &RenderScene, index: usize, flags: u32) -> Result<()> {
        let mesh_index = scene.instances[index].mesh;
        let (mesh, place) = (&scene.meshes[mesh_index], self.meshes[mesh_index]);
        let vertices = mesh.positions.len() as u64;
        let screen_first = self.reserve(vertices);
        let flags = flags | if mesh.colors.is_empty() { 0 } else { PART_COLORED };
        let mut unseen = scene.instances[index].stands_for.map(|base| self.unseen(base)).into_iter().flatten();
        for (run, material) in runs(mesh) {
            let batch = self.batches.last_mut().ok_or_else(|| Error::internal("no batch"))?;
            let flags = flags | material_flags(&scene.materials[material as usize], tests_relief(scene));
            let is_moved = proxies::is_moved(&scene.materials[material as usize]);
            let flags = if is_moved { flags } else { flags & !PART_UNSEEN };
            let stood_for = unseen.next();
            // Proxies close around what they stand for.
            let flags = if stood_for.is_some() { flags & !PART_DOUBLE_SIDED } else { flags };
            let first = batch.triangles.end;
            self.parts.push(Part {
                first_triangle: first as u32,
                triangle_base: (place.triangle_base + run.start as u64) as u32,
                screen_base: (screen_first as u32).wrapping_sub(place.vertex_base as u32),
                instance: index as u32,
                material,
                flags,
                stands_for: stood_for.unwrap_or(first as u32),
                faces: if stood_for.is_some() { proxies::faces(scene) } else { 1 },
            });
            batch.triangles.end += run.len() as u64;
            if flags & PART_BLENDED != 0 {
                let known = if batch.blended.is_empty() { first } else { batch.blended.start };
                batch.blended = known..batch.triangles.end;
            }
            batch.parts.end += 1;
        }
        let batch = self.batches.last_mut().ok_or_else(|| Error::internal("no batch"))?;
        batch.instances.push(OnScreen {
            instance: index as u32,
            vertex_first: place.vertex_base as u32,
            screen_first: screen_first as u32,
            vertices,
        });
        batch.vertices += vertices;
        if batch.triangles.end >= u64::from(u32::MAX) {
            let message = format!("the scene's instances have more than {} triangles: lower the level", u32::MAX - 1);
            return Err(Error::too_large("geometry.uniform", message));
        }
        Ok(())
    }

    /// First triangles of an instance's parts in whose place others are drawn.
    fn unseen(&self, instance: usize) -> Vec<u32> {
        let first = self.parts.partition_point(|part| (part.instance as usize) < instance);
        let of_it = self.parts[first..].iter().take_while(|part| part.instance as usize == instance);
        of_it.filter(|part| part.flags & PART_UNSEEN != 0).map(|part| part.first_triangle).collect()
    }

    /// First screen vertex of an instance, in a new batch if the last one is full.
    fn reserve(&mut self, vertices: u64) -> u64 {
        let last = &self.batches[self.batches.len() - 1];
        if last.vertices == 0 || last.vertices + vertices <= BATCH_VERTICES {
            return last.vertices;
        }
        let (part, triangle) = (last.parts.end, last.triangles.end);
        self.batches.push(Batch { parts: part..part, triangles: triangle..triangle, ..Batch::default() });
        0
    }
}

/// Runs of triangles of one material, without empty ones.
pub(super) fn runs(mesh: &RenderMesh) -> impl Iterator<Item = (Range<usize>, u32)> + '_ {
    let starts = &mesh.material_of_triangles;
    starts.iter().enumerate().filter_map(|(k, &(first, material))| {
        let end = starts.get(k + 1).map_or(mesh.triangles.len(), |next| next.0 as usize);
        (end > first as usize).then_some((first as usize..end, material))
    })
}

fn places(meshes: &[RenderMesh]) -> Vec<MeshPlace> {
    let next = |place: &mut MeshPlace, mesh: &RenderMesh| {
        let this = *place;
        place.vertex_base += mesh.positions.len() as u64;
        place.triangle_base += mesh.triangles.len() as u64;
        Some(this)
    };
    meshes.iter().scan(MeshPlace::default(), next).collect()
}

/// Whether relief decides how far away is what samples see, so that they are tested.
fn tests_relief(scene: &RenderScene) -> bool {
    scene.marcher().is_some_and(|marcher| marcher.finds_depth)
}

fn material_flags(material: &RenderMaterial, tests_relief: bool) -> u32 {
    let double_sided = if material.double_sided { PART_DOUBLE_SIDED } else { 0 };
    let alpha = match material.alpha {
        RenderAlpha::Blend => PART_BLENDED,
        alpha if alpha.cutoff() > 0.0 => PART_MASKED,
        _ if tests_relief && material.relief.is_some() => PART_MASKED,
        _ => 0,
    };
    let alpha = if tests_relief && material.relief.is_some() { alpha | PART_RELIEF } else { alpha };
    double_sided | alpha
}

fn material(material: &RenderMaterial) -> Material {
    let unlit = if material.unlit { MATERIAL_UNLIT } else { 0 };
    let normal_map = if material.maps[MAP_NORMAL].is_some() { MATERIAL_NORMAL_MAP } else { 0 };
    let stochastic = if material.alpha == RenderAlpha::Stochastic { MATERIAL_STOCHASTIC } else { 0 };
    Material {
        base_color: material.base_color_factor,
        emissive: material.emissive_factor,
        metallic: material.metallic_factor,
        roughness: material.roughness_factor,
        normal_scale: material.normal_scale,
        occlusion_strength: material.occlusion_strength,
        alpha_cutoff: material.alpha.cutoff(),
        flags: unlit | normal_map | stochastic,
    }
}

fn texture_use(map: &Option<RenderMap>) -> TextureUse {
    let Some(map) = map else { return TextureUse::default() };
    let [wrap_u, wrap_v] = wrap_numbers(map.wrap);
    TextureUse {
        map_u: map.map_from_uv[0],
        map_v: map.map_from_uv[1],
        wrap: wrap_u | wrap_v << 2,
        uv_channel: map.uv_channel,
        level_first: 0,
        level_count: 0,
    }
}

fn light(light: &RenderLight) -> Light {
    let (color, radius) = (light.color, light.radius);
    match light.shape {
        LightShape::Sun { direction_world } => {
            Light { kind: LIGHT_SUN, direction: direction_world, color, radius, ..Light::default() }
        }
        LightShape::Point { position_world, range_world } => {
            let range = range_world.unwrap_or(0.0);
            Light { kind: LIGHT_POINT, position: position_world, range, color, radius, ..Light::default() }
        }
        LightShape::Spot { position_world, range_world, direction_world, cone_cosines: [inner, outer] } => {
            let cone_scale = 1.0 / (inner - outer).max(1e-3);
            Light {
                kind: LIGHT_SPOT,
                position: position_world,
                direction: direction_world,
                range: range_world.unwrap_or(0.0),
                color,
                cone_scale,
                cone_offset: -outer * cone_scale,
                ..Light::default()
            }
        }
    }
}

/// As in `texture.glsl`.
pub(crate) fn wrap_numbers(wrap: [Wrap; 2]) -> [u32; 2] {
    wrap.map(|wrap| match wrap {
        Wrap::Repeat => 0,
        Wrap::Mirror => 1,
        Wrap::Clamp => 2,
    })
}

/// Homogeneous pixels: x to the right and y down, from the top left corner.
pub(crate) fn pixel_from_world(camera: &RenderCamera, size_px: [u32; 2]) -> DMat4 {
    let [half_width, half_height] = size_px.map(|side| 0.5 * f64::from(side));
    let pixel_from_clip = DMat4::from_cols(
        DVec4::new(half_width, 0.0, 0.0, 0.0),
        DVec4::new(0.0, -half_height, 0.0, 0.0),
        DVec4::Z,
        DVec4::new(half_width, half_height, 0.0, 1.0),
    );
    let clip_from_view = DMat4::from_cols_array(&camera.clip_from_view.map(f64::from));
    pixel_from_clip * clip_from_view * DMat4::from_cols_array(&camera.view_from_world.map(f64::from))
}

fn instance_rows(pixel_from_mesh: DMat4, world_from_mesh: DMat4) -> [[f32; 4]; INSTANCE_ROWS] {
    let normal = normal_rows(DMat3::from_mat4(world_from_mesh));
    std::array::from_fn(|row| match row {
        0..4 => pixel_from_mesh.row(row),
        4..7 => world_from_mesh.row(row - 4),
        _ => normal[row - 7].extend(0.0),
    })
    .map(|row: DVec4| row.as_vec4().to_array())
}

/// The inverse transpose up to a positive factor: the cofactors, with the determinant's sign.
fn normal_rows(m: DMat3) -> [DVec3; 3] {
    let (x, y, z) = (m.x_axis, m.y_axis, m.z_axis);
    let cofactors = DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y));
    let columns = cofactors.to_cols_array();
    let largest = columns.iter().fold(0f64, |largest, c| largest.max(c.abs()));
    let sign = if m.determinant() < 0.0 { -1.0 } else { 1.0 };
    let scale = if largest > 0.0 { sign / largest } else { 0.0 };
    let cofactors = cofactors * scale;
    [cofactors.row(0), cofactors.row(1), cofactors.row(2)]
}

/// The device must never see an index that leads out of a table.
pub(crate) fn check(scene: &RenderScene) -> Result<()> {
    for (index, mesh) in scene.meshes.iter().enumerate() {
        let vertices = mesh.positions.len();
        let uvs_fit = mesh.uvs.len() == vertices * scene.uv_channels as usize;
        let colors_fit = mesh.colors.is_empty() || mesh.colors.len() == vertices;
        let tangents_fit = mesh.tangents.is_empty() || mesh.tangents.len() == 3 * mesh.triangles.len();
        let directions_fit = mesh.directions.is_empty() || mesh.directions.len() == vertices;
        if mesh.normals.len() != vertices || !directions_fit || !uvs_fit || !colors_fit || !tangents_fit {
            return Err(Error::internal(format!("mesh {index}: its {vertices} vertices lack attributes")));
        }
        if mesh.triangles.iter().flatten().any(|&vertex| vertex as usize >= vertices) {
            return Err(Error::internal(format!("mesh {index}: a triangle names a vertex beyond {vertices}")));
        }
        check_runs(index, mesh, scene.materials.len())?;
    }
    let maps = scene.materials.iter().flat_map(|material| &material.maps).flatten();
    if scene.uv_channels == 0 || maps.clone().any(|map| map.uv_channel >= scene.uv_channels) {
        return Err(Error::internal(format!("a map reads a UV channel beyond {}", scene.uv_channels)));
    }
    let formulas = scene.materials.iter().flat_map(|material| &material.bump.formulas);
    if formulas.clone().any(|formula| formula.uv_channel >= scene.uv_channels) {
        return Err(Error::internal(format!("a formula reads a UV channel beyond {}", scene.uv_channels)));
    }
    let mut reliefs = scene.materials.iter().filter_map(|material| material.relief.as_ref());
    if reliefs.any(|relief| relief.uv_channel >= scene.uv_channels) {
        return Err(Error::internal(format!("heights are read at a UV channel beyond {}", scene.uv_channels)));
    }
    let meshes = scene.meshes.len();
    if scene.instances.iter().any(|instance| instance.mesh >= meshes) {
        return Err(Error::internal(format!("an instance names a mesh beyond {meshes}")));
    }
    let mut bases =
        scene.instances.iter().enumerate().filter_map(|(index, instance)| Some((index, instance.stands_for?)));
    if bases.any(|(index, base)| base >= index) {
        return Err(Error::internal("an instance stands for one behind it"));
    }
    Ok(())
}

fn check_runs(index: usize, mesh: &RenderMesh, materials: usize) -> Result<()> {
    let runs = &mesh.material_of_triangles;
    let ascending = runs.windows(2).all(|pair| pair[0].0 <= pair[1].0);
    let inside = runs.iter().all(|run| run.0 as usize <= mesh.triangles.len() && (run.1 as usize) < materials);
    let covers = mesh.triangles.is_empty() || runs.first().is_some_and(|run| run.0 == 0);
    if ascending && inside && covers {
        return Ok(());
    }
    Err(Error::internal(format!("mesh {index}: its materials do not cover its triangles in order")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_follow_the_inverse_transpose_under_mirrored_and_uneven_scale() {
        let m = DMat3::from_cols(DVec3::new(-2.0, 0.0, 0.0), DVec3::new(0.3, 5.0, 0.0), DVec3::new(0.0, 0.1, 0.25));
        let expected = m.inverse().transpose();
        let rows = normal_rows(m);
        for n in [DVec3::X, DVec3::Y, DVec3::new(0.2, -0.4, 0.7)] {
            let got = DVec3::new(rows[0].dot(n), rows[1].dot(n), rows[2].dot(n)).normalize();
            assert!((got - (expected * n).normalize()).length() < 1e-12);
        }
    }
}
