//! The constants of the cost model, measured once on a device: a plane with a rough map, shown plainly, marched, and displaced.

use std::collections::HashMap;

use base64::{Engine as _, engine::general_purpose::STANDARD};
use bytes::Bytes;
use serde_json::json;

use super::{AssetReader, WorkContext, bumps, images, inputs::Inputs, looks, render::planned};
use crate::{
    domain::{
        Digest, Error, Result,
        cancel::NoProgress,
        cost::CostModel,
        encode,
        image::{AlphaMode, Filter, Shading},
        report::PassTime,
        request::{
            Allowed, Base, CameraChoice, Channel, Compression, DisplaceRequest, ErrorAt, Geometry, ImageFormat,
            LayerRequest, Look, LookMaps, MapRequest, MaterialDetail, Method, Normals, Preset, Quality, Refinement,
            ReliefLook, RenderRequest, SeamRule, Shadows, SourceRequest, Tolerance,
        },
    },
    render::JobContext,
};

/// Texels of a side of the map.
const TEXELS: u32 = 64;
/// Pixels of a side of the image.
const PIXELS: u32 = 192;
/// Runs of each image, the fastest of which counts: the first may wait for what is compiled.
const RUNS: usize = 3;
/// Of the map, world units: one that rays hardly travel in, and one that they do.
const LOW: f32 = 0.01;
const HIGH: f32 = 0.6;
/// Of its triangles, world units.
const TOLERANCE: f64 = 0.01;
/// Passes that no method is charged with: they are made once, however many images follow.
const ONCE: [&str; 5] = ["compile", "mip", "cone_map", "brdf_table", "brdf_averages"];

/// The device's constants: those that it keeps, else measured now and kept from now on.
pub(super) fn of(context: &WorkContext<'_>) -> Result<CostModel> {
    if let Some(known) = context.executor.costs() {
        return Ok(known);
    }
    context.progress.pass("calibrate", 0, 1);
    let model = measured(context)?;
    // A clock that stood still must not choose.
    let model = if model.is_sound() { model } else { CostModel::default() };
    context.executor.keep_costs(model);
    Ok(model)
}

/// What one image took.
#[derive(Clone, Copy, Debug)]
struct Took {
    geometry_ms: f64,
    image_ms: f64,
    rays: f64,
    fetches: f64,
    vertices: f64,
    triangles: f64,
}

fn measured(context: &WorkContext<'_>) -> Result<CostModel> {
    let plane = Plane::new()?;
    let run = |method: Method, scale: f32, refinement: Refinement| plane.fastest(context, method, scale, &refinement);
    let flat = run(Method::Flat, HIGH, Refinement::Uniform(0))?;
    let [low, high] =
        [run(Method::Exact, LOW, Refinement::Uniform(0))?, run(Method::Exact, HIGH, Refinement::Uniform(0))?];
    let displaced = run(Method::Displacement, HIGH, within(TOLERANCE))?;
    let ns = |ms: f64, count: f64| 1e6 * ms / count.max(1.0);
    // The same rays, so that what the higher map takes more its lookups do.
    let fetch_ns = ns(high.image_ms - low.image_ms, high.fetches - low.fetches);
    let ray_ns = ns(high.image_ms - flat.image_ms - 1e-6 * fetch_ns * high.fetches, high.rays);
    let more_ms = (displaced.geometry_ms + displaced.image_ms - flat.image_ms).max(0.0);
    let made = displaced.vertices + displaced.triangles;
    let of_geometry = ns(more_ms, made);
    Ok(CostModel {
        pixel_ns: rounded(ns(flat.image_ms, f64::from(PIXELS * PIXELS))),
        ray_ns: rounded(ray_ns),
        fetch_ns: rounded(fetch_ns),
        vertex_ns: rounded(of_geometry),
        triangle_ns: rounded(of_geometry),
    })
}

/// To two digits: a clock tells no more.
fn rounded(ns: f64) -> f64 {
    let digit = 10f64.powf(ns.log10().floor() - 1.0);
    (ns / digit).round() * digit
}

/// World units.
fn within(tolerance: f64) -> Refinement {
    let (allowed, error_at, quality) = (Allowed::World(tolerance), ErrorAt::Surface, Quality::Normal);
    Refinement::Tolerance(Tolerance { allowed, error_at, quality })
}

/// Assets that are made here.
struct Plane {
    assets: HashMap<Digest, Bytes>,
    mesh: Digest,
    map: Digest,
}

impl AssetReader for Plane {
    fn read(&self, digest: &Digest) -> Result<Bytes> {
        self.assets.get(digest).cloned().ok_or_else(|| Error::internal("a calibration names what it does not have"))
    }
}

impl Plane {
    fn new() -> Result<Self> {
        let (mesh, map) = (Bytes::from(gltf()), Bytes::from(noise()?));
        let (mesh_name, map_name) = (Digest::of(&mesh), Digest::of(&map));
        Ok(Self { assets: [(mesh_name, mesh), (map_name, map)].into(), mesh: mesh_name, map: map_name })
    }

    fn fastest(&self, context: &WorkContext<'_>, method: Method, scale: f32, refinement: &Refinement) -> Result<Took> {
        let request = self.request(method, scale, refinement.clone());
        let runs: Vec<Took> = (0..RUNS).map(|_| self.run(context, &request)).collect::<Result<_>>()?;
        let all_ms = |took: &Took| took.geometry_ms + took.image_ms;
        let fastest = runs.into_iter().min_by(|a, b| all_ms(a).total_cmp(&all_ms(b)));
        fastest.ok_or_else(|| Error::internal("a calibration that was not run"))
    }

    fn run(&self, context: &WorkContext<'_>, request: &RenderRequest) -> Result<Took> {
        let job = JobContext { cancel: context.cancel, progress: &NoProgress };
        let quiet = WorkContext { progress: &NoProgress, ..*context };
        let mut inputs = Inputs::load(self, context.limits, &job, &request.surface)?;
        inputs.take_passes();
        let (mut surfaces, mut times) = inputs.displaced(&quiet)?;
        for one in surfaces.iter_mut().enumerate() {
            bumps::keep_base_normals(&quiet, &inputs, &request.surface.geometry, one, &mut times)?;
        }
        let (vertices, triangles) = (inputs.plans.vertices() as f64, inputs.plans.triangles() as f64);
        planned(&inputs, context.limits, request)?;
        let environment = looks::environment(&request.look, self)?;
        let shown = (&inputs.bumps, &inputs.reliefs);
        let scene = images::render_scene(request, &mut inputs.scene, shown, surfaces, environment, false)?;
        let plan = crate::domain::image::ImagePlan::new(request.width, request.height, &scene.contents())?;
        let (images, passes) = context.executor.render(&job, &plan, &scene)?;
        Ok(Took {
            geometry_ms: sum(&times),
            image_ms: sum(&passes),
            rays: images.counters.map_or(0.0, |counters| counters.rays as f64),
            fetches: images.counters.map_or(0.0, |counters| counters.fetches as f64),
            vertices,
            triangles,
        })
    }

    fn request(&self, method: Method, scale: f32, refinement: Refinement) -> RenderRequest {
        let map = MapRequest { asset: self.map, wrap: None, sampling: crate::domain::detail::Sampling::Center };
        let layer = LayerRequest {
            source: SourceRequest::Height { map, channel: Channel::R },
            scale,
            midlevel: None,
            invert_height: false,
            flip_v: false,
            preset: Preset::Right,
        };
        let geometry = Geometry {
            refinement,
            max_triangles: None,
            normals: Normals::Analytic,
            seams: SeamRule::Mean,
            feather_texels: 0.0,
            base: Base::Flat,
        };
        let surface = DisplaceRequest {
            mesh: self.mesh,
            resources: Vec::new(),
            details: vec![MaterialDetail { material: None, layers: vec![layer], uv_set: 0 }],
            method,
            geometry,
            maps: LookMaps::default(),
            compression: Compression::None,
            lods: 1,
        };
        RenderRequest {
            surface,
            camera: CameraChoice::LookAt { eye: [0.0, 1.0, 0.6], target: [0.0; 3], yfov_degrees: 60.0 },
            width: PIXELS,
            height: PIXELS,
            look: plain(),
            aovs: Vec::new(),
            format: ImageFormat::Png,
            preimage: None,
            samples: None,
        }
    }
}

fn plain() -> Look {
    Look {
        lights: Vec::new(),
        ambient: 0.0,
        shading: Shading::default(),
        filter: Filter::default(),
        alpha: AlphaMode::default(),
        shadows: Shadows::None,
        environment: None,
        moments: false,
        environment_layout: crate::domain::environment::EnvironmentLayout::default(),
        reflections: Vec::new(),
        bounces: 0,
        relief: ReliefLook::default(),
    }
}

fn sum(passes: &[PassTime]) -> f64 {
    passes.iter().filter(|pass| !ONCE.contains(&pass.name.as_str())).map(|pass| pass.ms).sum()
}

/// Two triangles, 4 world units a side, facing up.
fn gltf() -> Vec<u8> {
    let floats: [f32; 20] = [-2., 0., -2., 2., 0., -2., -2., 0., 2., 2., 0., 2., 0., 0., 1., 0., 0., 1., 1., 1.];
    let indices: [u16; 6] = [0, 2, 1, 1, 2, 3];
    let bytes: Vec<u8> = floats
        .iter()
        .flat_map(|value| value.to_le_bytes())
        .chain(indices.iter().flat_map(|index| index.to_le_bytes()))
        .collect();
    let uri = format!("data:application/octet-stream;base64,{}", STANDARD.encode(&bytes));
    let view = |offset: usize, length: usize| json!({ "buffer": 0, "byteOffset": offset, "byteLength": length });
    let document = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": [0] }],
        "nodes": [{ "mesh": 0 }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0, "TEXCOORD_0": 1 }, "indices": 2 }] }],
        "buffers": [{ "byteLength": bytes.len(), "uri": uri }],
        "bufferViews": [view(0, 48), view(48, 32), view(80, 12)],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [-2, 0, -2], "max": [2, 0, 2] },
            { "bufferView": 1, "componentType": 5126, "count": 4, "type": "VEC2" },
            { "bufferView": 2, "componentType": 5123, "count": 6, "type": "SCALAR" },
        ],
    });
    document.to_string().into_bytes()
}

/// A few octaves of smooth bumps, 16 bits.
fn noise() -> Result<Vec<u8>> {
    let turn = |k: u32| f64::from(k) / f64::from(TEXELS) * std::f64::consts::TAU;
    let wave = |x: f64, y: f64| {
        (x.sin() * (y + 1.0).cos() + (3.0 * x + y).sin() * 0.5 + (7.0 * y - 2.0 * x).cos() * 0.25) / 3.5
    };
    let texel = |k: u32| ((0.5 + wave(turn(k % TEXELS), turn(k / TEXELS))) * 65535.0) as u16;
    let rgb: Vec<u16> = (0..TEXELS * TEXELS).flat_map(|k| [texel(k); 3]).collect();
    encode::encode_linear_rgb16(TEXELS, TEXELS, &rgb)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_digits_are_kept() {
        for (ns, kept) in [(123.4, 120.0), (0.0678, 0.068), (9.96, 10.0), (7.0, 7.0)] {
            assert!((rounded(ns) - kept).abs() < 1e-12 * kept, "{ns}: {}", rounded(ns));
        }
    }
}
