//! The displaced surface itself as the image oracle shows it: triangles that are nowhere farther from it than a
//! small part of a pixel.

use std::sync::Arc;

use glam::{DMat4, DVec3};
use rayon::prelude::*;

use super::{
    WorkContext, bumps,
    images::tangent_uv_set,
    inputs::Inputs,
    looks::{self, UvSets},
};
use crate::{
    domain::{
        Result, camera,
        cancel::Cancel,
        image::{RenderCamera, RenderInstance},
        mesh::{Attribute, Mesh},
        projection::ProjectionBox,
        request::RenderRequest,
        scene::Scene,
        weld::mikk_tangents,
    },
    oracle::{
        dicing::{Dicing, Limits, Region, dice},
        image::{OracleMesh, OracleScene},
        sheet::enlargement,
        surface::{SeamChoice, Surface},
    },
};

/// How far what a render shows may be from the surface, pixels: a sixteenth of what a still allows.
pub(super) const RESIDUAL_PX: f64 = 1.0 / 32.0;
/// The same while the camera is not known yet, as a share of the diagonal.
const COARSE: f64 = 0.01;
/// Nearer than this share of the diagonal a pixel stays as large: what the eye is inside of has no end.
const NEAREST: f64 = 1e-3;
/// Over all meshes.
const MOST_TRIANGLES: usize = 6_000_000;

/// `residual_px`: how far what is shown may be from the surface.
pub(super) fn scene(
    context: &WorkContext<'_>,
    inputs: &mut Inputs,
    request: &RenderRequest,
    residual_px: f64,
) -> Result<OracleScene> {
    let sets = UvSets::of(&inputs.scene.materials, &inputs.bumps, &inputs.reliefs);
    let projection = request.surface.maps.projection;
    let shown = looks::Shown {
        alpha: request.look.alpha,
        projection,
        moments: false,
        reliefs: &inputs.reliefs,
        steps: request.look.relief.steps,
    };
    let materials = looks::materials(&mut inputs.scene, &sets, &inputs.bumps, shown)?;
    let scene = &inputs.scene;
    let choice = SeamChoice::from(&request.surface.geometry);
    let pairs = scene.meshes.iter().zip(&inputs.details);
    let surfaces: Vec<Surface<'_>> = pairs.map(|(m, details)| Surface::new(&m.mesh, details, choice)).collect();
    let bare: Vec<Vec<_>> = scene.meshes.iter().map(|m| vec![None; m.mesh.primitives.len()]).collect();
    let bases: Vec<Surface<'_>> =
        scene.meshes.iter().zip(&bare).map(|(m, bare)| Surface::new(&m.mesh, bare, choice)).collect();
    let camera = framed(context.cancel, scene, &surfaces, request)?;
    let lens = Lens::new(&camera, request.height, NEAREST * scene.diagonal);
    let finely = diced(context.cancel, scene, &surfaces, &|places, world| lens.pixels(places, world) > residual_px)?;
    let parts = surfaces.iter().zip(&bases).zip(&finely).enumerate();
    let meshes = parts
        .map(|(mesh, ((surface, base), dicing))| oracle_mesh(inputs, &sets, mesh, [surface, base], dicing))
        .collect::<Result<_>>()?;
    Ok(OracleScene {
        meshes,
        instances: scene
            .instances
            .iter()
            .map(|i| RenderInstance { mesh: i.mesh, world_from_mesh: i.world_from_mesh, stands_for: None })
            .collect(),
        materials,
        camera,
        lighting: looks::lighting(&request.look, scene, looks::environment(&request.look, context.assets)?),
        shading: request.look.shading,
        projection: request.surface.maps.projection,
        bounces: request.look.bounces,
        uv_channels: sets.count(),
        aovs: request.aovs.clone(),
    })
}

/// The camera of an image of the surface itself, whatever will stand for it.
pub(super) fn camera(cancel: &Cancel, inputs: &Inputs, request: &RenderRequest) -> Result<RenderCamera> {
    let choice = SeamChoice::from(&request.surface.geometry);
    let pairs = inputs.scene.meshes.iter().zip(&inputs.details);
    let surfaces: Vec<Surface<'_>> = pairs.map(|(m, details)| Surface::new(&m.mesh, details, choice)).collect();
    framed(cancel, &inputs.scene, &surfaces, request)
}

fn framed(cancel: &Cancel, scene: &Scene, surfaces: &[Surface<'_>], request: &RenderRequest) -> Result<RenderCamera> {
    let coarse = COARSE * scene.diagonal;
    let coarsely = diced(cancel, scene, surfaces, &|_, world| world > coarse)?;
    camera::render_camera(&request.camera, scene, bounds(scene, &coarsely), request.width, request.height)
}

/// `is_coarse` gets the places of a region in world space and its deviation there.
fn diced(
    cancel: &Cancel,
    scene: &Scene,
    surfaces: &[Surface<'_>],
    is_coarse: &(dyn Fn(&[DVec3], f64) -> bool + Sync),
) -> Result<Vec<Dicing>> {
    let mut left = MOST_TRIANGLES;
    let mut all = Vec::with_capacity(surfaces.len());
    for (mesh, surface) in surfaces.iter().enumerate() {
        let worlds: Vec<(DMat4, f64)> = scene
            .instances
            .iter()
            .filter(|i| i.mesh == mesh)
            .map(|i| (world(&i.world_from_mesh), enlargement(&i.world_from_mesh)))
            .collect();
        let wants_more = |region: &Region<'_>| {
            worlds.iter().any(|(world, enlarged)| {
                let places: Vec<DVec3> = region.positions.iter().map(|p| world.transform_point3(*p)).collect();
                is_coarse(&places, region.deviation * enlarged)
            })
        };
        let limits = Limits { max_triangles: left, ..Limits::default() };
        let dicing = dice(surface, &limits, cancel, &wants_more)?;
        left = left.saturating_sub(dicing.triangles.len());
        all.push(dicing);
    }
    Ok(all)
}

fn world(world_from_mesh: &[f32; 16]) -> DMat4 {
    DMat4::from_cols_array(&world_from_mesh.map(f64::from))
}

fn bounds(scene: &Scene, dicings: &[Dicing]) -> [[f32; 3]; 2] {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for instance in &scene.instances {
        let world = world(&instance.world_from_mesh);
        for p in &dicings[instance.mesh].positions {
            let p = world.transform_point3(*p);
            (low, high) = (low.min(p), high.max(p));
        }
    }
    if low.is_finite() && high.is_finite() { [low, high].map(|p| p.as_vec3().to_array()) } else { scene.bounds }
}

/// How large the world looks.
struct Lens {
    eye: DVec3,
    /// Pixels of a world unit: at distance 1, or everywhere.
    pixels: f64,
    is_perspective: bool,
    nearest: f64,
}

impl Lens {
    fn new(camera: &RenderCamera, height: u32, nearest: f64) -> Self {
        Self {
            eye: DVec3::from_array(camera.eye_world.map(f64::from)),
            pixels: 0.5 * f64::from(height) * f64::from(camera.clip_from_view[5]).abs(),
            is_perspective: camera.clip_from_view[15] == 0.0,
            nearest,
        }
    }

    /// At most so many pixels does a length look like in a region.
    fn pixels(&self, places: &[DVec3], world: f64) -> f64 {
        if !self.is_perspective {
            return world * self.pixels;
        }
        let distance = |p: &DVec3| p.distance(self.eye);
        let extent = places.iter().map(|p| p.distance(places[0])).fold(0.0, f64::max);
        let nearest = places.iter().map(distance).fold(f64::INFINITY, f64::min) - world - extent;
        world * self.pixels / nearest.max(self.nearest)
    }
}

fn oracle_mesh(
    inputs: &Inputs,
    sets: &UvSets,
    mesh: usize,
    [surface, undisplaced]: [&Surface<'_>; 2],
    dicing: &Dicing,
) -> Result<OracleMesh> {
    let scene = &inputs.scene;
    let base = &scene.meshes[mesh].mesh;
    let keeps: Vec<bool> = (0..base.primitives.len()).map(|p| bumps::keeps_base_normals(inputs, mesh, p)).collect();
    let shaded = |t: usize| if keeps[base.triangles[t].primitive as usize] { undisplaced } else { surface };
    let colors = base.attribute("COLOR_0");
    let mut made = OracleMesh::default();
    for (k, &t) in dicing.base.iter().enumerate() {
        let material = base.primitives[base.triangles[t as usize].primitive as usize].material;
        made.material_of_triangles.push((k as u32, material.unwrap_or(scene.materials.len()) as u32));
    }
    made.material_of_triangles.dedup_by_key(|(_, material)| *material);
    let corner =
        |i: usize| (dicing.triangles[i / 3][i % 3] as usize, dicing.base[i / 3] as usize, dicing.at[i / 3][i % 3]);
    let corners = || (0..3 * dicing.triangles.len()).into_par_iter().map(corner);
    let normal = |(_, t, at)| shaded(t).position_and_normal(t, at).1.as_vec3().to_array();
    made.positions = corners().map(|(vertex, ..)| dicing.positions[vertex]).collect();
    made.normals = Arc::new(corners().map(normal).collect());
    made.uvs = Arc::new(corners().flat_map_iter(|(_, t, at)| uvs(base, sets, t, at)).collect());
    made.colors = Arc::new(colors.map_or(Vec::new(), |c| corners().map(|(_, t, at)| color(base, c, t, at)).collect()));
    made.triangles = Arc::new((0..dicing.triangles.len() as u32).map(|k| [3 * k, 3 * k + 1, 3 * k + 2]).collect());
    let enlarged = scene.instances.iter().filter(|i| i.mesh == mesh).map(|i| enlargement(&i.world_from_mesh));
    let residual = f64::from(dicing.residual.iter().copied().fold(0.0, f32::max));
    made.residual_world = residual * enlarged.fold(0.0, f64::max);
    made.tangents = Arc::new(tangents(inputs, sets, mesh, &made)?);
    made.projection_box = ProjectionBox::of(base.gv_position.iter().copied());
    Ok(made)
}

/// MikkTSpace's, of corners, where a material has a normal map and the mesh the UVs that it reads.
fn tangents(inputs: &Inputs, sets: &UvSets, mesh: usize, made: &OracleMesh) -> Result<Vec<[f32; 4]>> {
    let scene = &inputs.scene;
    let mut tangents = Vec::new();
    let starts = &made.material_of_triangles;
    for (k, &(first, material)) in starts.iter().enumerate() {
        let end = starts.get(k + 1).map_or(made.triangles.len(), |next| next.0 as usize);
        let material = Some(material as usize).filter(|m| *m < scene.materials.len());
        let Some(uv_set) = tangent_uv_set(&scene.materials, &inputs.bumps, material) else { continue };
        if scene.meshes[mesh].mesh.attribute(&format!("TEXCOORD_{uv_set}")).is_none() {
            continue;
        }
        let (count, channel) = (sets.count() as usize, sets.channel(uv_set) as usize);
        let corners = mikk_tangents(
            &made.triangles[first as usize..end],
            |v| made.positions[v as usize].as_vec3().to_array(),
            |v| made.normals[v as usize],
            |v| made.uvs[v as usize * count + channel],
        )?;
        tangents.resize(3 * made.triangles.len(), [0.0; 4]);
        tangents[3 * first as usize..3 * end].copy_from_slice(&corners);
    }
    Ok(tangents)
}

/// In each of the sets; (0, 0) where the mesh lacks one.
fn uvs(mesh: &Mesh, sets: &UvSets, t: usize, at: DVec3) -> Vec<[f32; 2]> {
    let of_set = |semantic: String| {
        mesh.attribute(&semantic).map_or([0.0; 2], |set| [0, 1].map(|k| blended(mesh, set, t, at, k)))
    };
    sets.semantics().map(of_set).collect()
}

/// RGBA, white where the primitive has none.
fn color(mesh: &Mesh, colors: &Attribute, t: usize, at: DVec3) -> [f32; 4] {
    if !colors.primitives[mesh.triangles[t].primitive as usize] {
        return [1.0; 4];
    }
    std::array::from_fn(|k| if k < colors.components { blended(mesh, colors, t, at, k) } else { 1.0 })
}

fn blended(mesh: &Mesh, attribute: &Attribute, t: usize, at: DVec3, k: usize) -> f32 {
    let value = |corner: usize| {
        let av = mesh.triangles[t].av[corner] as usize;
        f64::from(attribute.values[av * attribute.components + k])
    };
    (at.x * value(0) + at.y * value(1) + at.z * value(2)) as f32
}
