//! What every job starts from: the loaded scene, the details, and a plan for each base mesh.

use std::{
    collections::{HashMap, HashSet},
    sync::Arc,
    time::Instant,
};

use bytes::Bytes;

use crate::{
    domain::{
        Digest, Error, Result, base,
        bump::Bumps,
        cancel::Progress,
        detail::{Detail, LayerSource},
        gltf, look, maps,
        mesh::Mesh,
        projection::Projection,
        relief::Reliefs,
        report::{Estimate, PassTime, Report},
        request::{Base, Compression, DisplaceRequest, Method},
        scene::Scene,
        surface::Surface,
        weld,
    },
    jobs::{AssetReader, JobLimits, WorkContext, bumps, cautions, levels, normal_maps, plans::Plans, reliefs},
    render::JobContext,
};

pub(super) struct Inputs {
    pub(super) scene: Scene,
    pub(super) plans: Plans,
    /// For each mesh, for each of its primitives.
    pub(super) details: Vec<Vec<Option<Arc<Detail>>>>,
    /// What bends normals.
    pub(super) bumps: Bumps,
    /// What is shown per pixel.
    pub(super) reliefs: Reliefs,
    /// Triangles of the base meshes, each counted once however often it is used.
    triangles_in: u64,
    passes: Vec<PassTime>,
}

impl Inputs {
    /// Loads, checks and plans; refuses what exceeds a limit before any device work.
    pub(super) fn load(
        assets: &dyn AssetReader,
        limits: &JobLimits,
        job: &JobContext<'_>,
        request: &DisplaceRequest,
    ) -> Result<Self> {
        let mut passes = Vec::new();
        let mut scene =
            timed(job.progress, "read_gltf", &mut passes, || scene(assets, &request.mesh, &request.resources))?;
        levels::check(&scene, request.lods)?;
        let reads_uvs = request.maps.projection == Projection::Uv;
        for (map, digest) in request.maps.replaced() {
            look::replace_map(&mut scene, map, assets.read(&digest)?, reads_uvs)?;
        }
        if let Some(digest) = &request.maps.opacity {
            look::replace_opacity(&mut scene, &assets.read(digest)?, reads_uvs)?;
        }
        job.cancel.check()?;
        let bumps = timed(job.progress, "decode_bumps", &mut passes, || bumps::load(assets, &mut scene, request))?;
        job.cancel.check()?;
        let reliefs = match request.method.marcher() {
            Some(_) => timed(job.progress, "decode_reliefs", &mut passes, || reliefs::load(assets, &scene, request))?,
            None => Reliefs::default(),
        };
        job.cancel.check()?;
        let details = timed(job.progress, "decode_maps", &mut passes, || details(assets, &scene, request))?;
        job.cancel.check()?;
        let details = fitted(&mut scene, &details)?;
        job.cancel.check()?;
        if request.geometry.base != Base::Flat {
            let smooth =
                || scene.meshes.iter_mut().try_for_each(|m| base::bend(&mut m.mesh, request.geometry.base, job.cancel));
            timed(job.progress, "base", &mut passes, smooth)?;
        }
        job.cancel.check()?;
        let mut plans = Plans::make(&mut scene, &request.geometry, limits)?;
        if request.compression != Compression::None {
            plans.keep_back(&scene, &details);
        }
        let triangles_in = scene.meshes.iter().map(|m| m.mesh.triangles.len() as u64).sum();
        let mut inputs = Self { scene, plans, details, bumps, reliefs, triangles_in, passes };
        normal_maps::check(&mut inputs, &request.geometry, request.lods, limits)?;
        Ok(inputs)
    }

    /// Displaces every base mesh, one after the other.
    pub(super) fn displaced(&mut self, context: &WorkContext<'_>) -> Result<(Vec<Surface>, Vec<PassTime>)> {
        let mut passes = std::mem::take(&mut self.passes);
        let mut surfaces = Vec::with_capacity(self.scene.meshes.len());
        for (index, (m, details)) in self.scene.meshes.iter().zip(&self.details).enumerate() {
            let plan = self.plans.next(index);
            let (surface, times) = context.executor.displace(&context.job(), plan, &m.mesh, details)?;
            self.plans.made(index, &surface);
            surfaces.push(surface);
            add_times(&mut passes, times);
        }
        Ok((surfaces, passes))
    }

    /// What loading took, told once.
    pub(super) fn take_passes(&mut self) -> Vec<PassTime> {
        std::mem::take(&mut self.passes)
    }

    /// The materials whose primitives have a detail.
    pub(super) fn displaced_materials(&self) -> HashSet<usize> {
        let of_mesh = |(m, details): (&crate::domain::scene::SceneMesh, &Vec<Option<Arc<Detail>>>)| {
            let pairs = m.mesh.primitives.iter().zip(details);
            pairs.filter(|(_, detail)| detail.is_some()).filter_map(|(p, _)| p.material).collect::<Vec<_>>()
        };
        self.scene.meshes.iter().zip(&self.details).flat_map(of_mesh).collect()
    }

    /// Counts and bytes as far as they are known before the work.
    pub(super) fn estimate(&self) -> Estimate {
        let known = |figure: u64| self.plans.are_counted().then_some(figure);
        Estimate {
            triangles_in: self.triangles_in,
            triangles: known(self.plans.triangles()),
            vertices: known(self.plans.vertices()),
            device_bytes: known(self.plans.device_bytes()),
            output_bytes: known(self.plans.output_bytes(&self.scene)),
            warnings: self.scene.warnings.clone(),
        }
    }

    /// What a report says of the surfaces once they are made; of those that a plan counts, before as well.
    pub(super) fn count(&self, report: &mut Report) {
        report.triangles_in = self.triangles_in;
        report.triangles = self.plans.triangles();
        report.vertices = self.plans.vertices();
    }
}

/// Runs one host step, tells of it, and notes its time beside the passes.
pub(super) fn timed<T>(
    progress: &dyn Progress,
    name: &str,
    passes: &mut Vec<PassTime>,
    step: impl FnOnce() -> Result<T>,
) -> Result<T> {
    progress.pass(name, 0, 1);
    let start = Instant::now();
    let result = tracing::debug_span!("pass", name).in_scope(step)?;
    passes.push(PassTime { name: name.into(), ms: start.elapsed().as_secs_f64() * 1e3, bytes: 0 });
    Ok(result)
}

/// Adds times pass by pass, in the order in which passes first ran.
pub(super) fn add_times(passes: &mut Vec<PassTime>, times: Vec<PassTime>) {
    for time in times {
        match passes.iter_mut().find(|p| p.name == time.name) {
            Some(known) => {
                known.ms += time.ms;
                known.bytes += time.bytes;
            }
            None => passes.push(time),
        }
    }
}

pub(super) fn scene(assets: &dyn AssetReader, mesh: &Digest, resources: &[(String, Digest)]) -> Result<Scene> {
    let bytes = assets.read(mesh)?;
    let mut files: HashMap<&str, Bytes> = HashMap::new();
    for (uri, digest) in resources {
        files.insert(uri, assets.read(digest)?);
    }
    gltf::load(&bytes, &|uri| files.get(uri).cloned(), &gltf::Limits::default())
}

fn details(assets: &dyn AssetReader, scene: &Scene, request: &DisplaceRequest) -> Result<maps::Details> {
    let chooses = request.method == Method::Auto;
    if !request.method.moves_vertices() && !chooses {
        return Ok(maps::Details::default());
    }
    let details = maps::resolve(scene, &request.details, &|digest| assets.read(digest))?;
    if details.is_empty() && !chooses {
        return Err(Error::invalid(
            "details",
            "neither the request nor the mesh's materials have a detail: give a height map, a vector map or an expression, or choose method flat",
        ));
    }
    if request.method == Method::Displacement {
        refuse_vectors(&details)?;
    }
    Ok(details)
}

fn refuse_vectors(details: &maps::Details) -> Result<()> {
    let all = details.of_material.iter().chain([&details.of_none]).flatten();
    let vectors = |layer: &crate::domain::detail::Layer| {
        matches!(layer.source, LayerSource::VectorTangent(_) | LayerSource::VectorObject(_))
    };
    if all.flat_map(|detail| &detail.layers).any(vectors) {
        return Err(Error::invalid(
            "method",
            "displacement moves along the normal and the detail has a vector map: choose method vector",
        ));
    }
    Ok(())
}

/// The detail of every primitive, checked against what the primitive has; meshes get tangents where a detail
/// in the tangent frame needs them.
fn fitted(scene: &mut Scene, details: &maps::Details) -> Result<Vec<Vec<Option<Arc<Detail>>>>> {
    let mut all = Vec::new();
    let Scene { meshes, warnings, .. } = scene;
    for scene_mesh in meshes {
        let of_primitive: Vec<Option<Arc<Detail>>> =
            scene_mesh.mesh.primitives.iter().map(|p| details.of(p.material).cloned()).collect();
        for (p, detail) in of_primitive.iter().enumerate() {
            let Some(detail) = detail else { continue };
            require_uvs(&scene_mesh.mesh, p, detail)?;
        }
        let tangent_uv_set = |p: usize| of_primitive[p].as_deref().filter(|d| in_tangent_space(d)).map(|d| d.uv_set);
        if (0..of_primitive.len()).any(|p| tangent_uv_set(p).is_some()) {
            scene_mesh.mesh = weld::with_tangents(&scene_mesh.mesh, tangent_uv_set)?;
        }
        for (p, detail) in of_primitive.iter().enumerate() {
            let Some(detail) = detail else { continue };
            cautions::of_terraces(&scene_mesh.mesh, p, detail, warnings);
            cautions::of_tangents(&scene_mesh.mesh, p, detail, warnings);
        }
        all.push(of_primitive);
    }
    Ok(all)
}

fn in_tangent_space(detail: &Detail) -> bool {
    detail.layers.iter().any(|layer| matches!(layer.source, LayerSource::VectorTangent(_)))
}

fn require_uvs(mesh: &Mesh, primitive: usize, detail: &Detail) -> Result<()> {
    let reads_uv = |source: &LayerSource| match source {
        LayerSource::Expression(program) => program.reads_uv(),
        _ => true,
    };
    if detail.layers.iter().any(|layer| reads_uv(&layer.source)) {
        return require_uv_set(mesh, primitive, detail.uv_set);
    }
    Ok(())
}

pub(super) fn require_uv_set(mesh: &Mesh, primitive: usize, uv_set: u32) -> Result<()> {
    let semantic = format!("TEXCOORD_{uv_set}");
    if mesh.attribute(&semantic).is_some_and(|a| a.primitives[primitive]) {
        return Ok(());
    }
    Err(Error::invalid(
        "details",
        format!(
            "mesh '{}' primitive {} has no {semantic}, which the detail reads: unwrap the mesh, choose another UV set, or use an expression over x, y, z",
            mesh.name, mesh.primitives[primitive].gltf_primitive
        ),
    ))
}
