//! Reflection mapping: what a reflector sees is rendered from its place, without itself, and becomes the environment that
//! its surface mirrors. Both executors take the six images by the renderer they have.

use std::{ops::Range, sync::Arc};

use displace_glsl::reference::{shadow_map::side_of, surroundings::Room};
use glam::{DMat4, DVec3};

use super::{image::tables::pixel_from_world, shadow_map::sides};
use crate::domain::{
    Error, Result,
    environment::{Environment, panorama},
    image::{ImagePlan, ImageSet, Reflector, RenderCamera, RenderMesh, RenderScene},
};

/// What the surfaces of a material mirror.
pub(crate) struct Reflection {
    pub(crate) material: u32,
    pub(crate) environment: Arc<Environment>,
    pub(crate) room: Option<Room>,
}

/// What the scene's reflectors see, each without the others' reflections.
pub(crate) fn reflections(
    scene: &RenderScene,
    mut render: impl FnMut(&ImagePlan, &RenderScene) -> Result<ImageSet>,
) -> Result<Vec<Reflection>> {
    let one = |(k, reflector): (usize, &Reflector)| reflection(scene, k, *reflector, &mut render);
    scene.reflectors.iter().enumerate().map(one).collect()
}

fn reflection(
    scene: &RenderScene,
    k: usize,
    Reflector { material, size_px, in_room }: Reflector,
    render: &mut impl FnMut(&ImagePlan, &RenderScene) -> Result<ImageSet>,
) -> Result<Reflection> {
    let own = bounds(scene, |m| m == material);
    let (low, high) = own.ok_or_else(|| {
        let message = "names a material that no triangle that is shown has: name another";
        Error::invalid(format!("lighting.reflections[{k}].material"), message)
    })?;
    let (centre, reach) = (0.5 * (low + high), (high - low).length());
    let rest = without(scene, material);
    let around = bounds(&rest, |_| true);
    let reach = around.map_or(reach, |(low, high)| reach.max((high - low).length()));
    let mut views = Vec::new();
    for camera in sides(centre, reach, size_px) {
        let scene = RenderScene { camera, ..rest.clone() };
        let plan = ImagePlan::new(size_px, size_px, &scene.contents())?;
        views.push(View::new(&camera, size_px, render(&plan, &scene)?));
    }
    let environment = panorama(4 * size_px, |d| views[side_of(d)].radiance(centre, d));
    let room = around.filter(|_| in_room).map(|(low, high)| Room { centre, low, high });
    Ok(Reflection { material, environment: Arc::new(environment), room })
}

/// One of the six images.
struct View {
    pixel_from_world: DMat4,
    size: usize,
    color: Vec<[f32; 4]>,
}

impl View {
    fn new(camera: &RenderCamera, size: u32, images: ImageSet) -> Self {
        Self { pixel_from_world: pixel_from_world(camera, [size; 2]), size: size as usize, color: images.color }
    }

    /// Bilinear; images reach beyond what they are for.
    fn radiance(&self, centre: DVec3, d: DVec3) -> DVec3 {
        let h = self.pixel_from_world * (centre + d).extend(1.0);
        let at = [h.x, h.y].map(|x| (x / h.w - 0.5).clamp(0.0, (self.size - 2) as f64));
        let (x, y) = (at[0].floor() as usize, at[1].floor() as usize);
        let texel = |x: usize, y: usize| {
            let [r, g, b, _] = self.color[y * self.size + x].map(f64::from);
            DVec3::new(r, g, b)
        };
        let row = |y: usize| texel(x, y).lerp(texel(x + 1, y), at[0].fract());
        row(y).lerp(row(y + 1), at[1].fract())
    }
}

/// The scene without a material's triangles, as the one render from its place shows it.
fn without(scene: &RenderScene, material: u32) -> RenderScene {
    let meshes = scene.meshes.iter().map(|mesh| kept(mesh, |m| m != material)).collect();
    RenderScene { meshes, reflectors: Vec::new(), aovs: Vec::new(), ..scene.clone() }
}

fn kept(mesh: &RenderMesh, keeps: impl Fn(u32) -> bool) -> RenderMesh {
    let (mut triangles, mut tangents, mut runs) = (Vec::new(), Vec::new(), Vec::new());
    for (run, material) in self::runs(mesh).filter(|run| keeps(run.1)) {
        runs.push((triangles.len() as u32, material));
        tangents.extend(mesh.tangents.get(3 * run.start..3 * run.end).into_iter().flatten().copied());
        triangles.extend_from_slice(&mesh.triangles[run]);
    }
    RenderMesh {
        triangles: Arc::new(triangles),
        tangents: Arc::new(tangents),
        material_of_triangles: runs,
        ..mesh.clone()
    }
}

/// Triangles of one material after the other.
fn runs(mesh: &RenderMesh) -> impl Iterator<Item = (Range<usize>, u32)> {
    mesh.material_of_triangles.iter().enumerate().map(|(k, &(first, material))| {
        let end = mesh.material_of_triangles.get(k + 1).map_or(mesh.triangles.len(), |next| next.0 as usize);
        (first as usize..end, material)
    })
}

/// Box of the triangles of some materials, in the world; `None` without any.
fn bounds(scene: &RenderScene, of: impl Fn(u32) -> bool) -> Option<(DVec3, DVec3)> {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for instance in &scene.instances {
        let world_from_mesh = DMat4::from_cols_array(&instance.world_from_mesh.map(f64::from));
        let mesh = &scene.meshes[instance.mesh];
        for vertex in runs(mesh).filter(|run| of(run.1)).flat_map(|run| mesh.triangles[run.0].as_flattened()) {
            let place = DVec3::from_array(mesh.positions[*vertex as usize].map(f64::from));
            let place = world_from_mesh.transform_point3(place);
            (low, high) = (low.min(place), high.max(place));
        }
    }
    (low.is_finite() && high.is_finite()).then_some((low, high))
}
