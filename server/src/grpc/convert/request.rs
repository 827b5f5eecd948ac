//! Requests.

use std::collections::HashSet;

use displace_glsl::methods::METHODS;
use displace_proto::v1;

use super::{
    details, digest, geometry, join, known, look, relief,
    view::{self, View},
};
use crate::{
    config::Config,
    domain::{
        Digest, Error, Result, lods,
        projection::Projection,
        request::{
            Allowed, Aov, CompareRequest, Compression, DisplaceRequest, EstimateRequest, Geometry, ImageFormat, Look,
            MeasureRequest, Method, Normals, RenderRequest,
        },
    },
};

const MAX_RESOURCES: usize = 1000;
/// What a still allows, pixels.
const AUTO_PX: f64 = 0.5;

/// The mesh, and external files by URI.
pub(crate) fn mesh_source(path: &str, mesh: Option<v1::MeshSource>) -> Result<(Digest, Vec<(String, Digest)>)> {
    let mesh = mesh.ok_or_else(|| Error::invalid(path, "is required; name the mesh by its digest"))?;
    let asset = digest(&join(path, "asset"), mesh.asset.as_ref())?;
    let count = mesh.resources.len();
    if count > MAX_RESOURCES {
        let message = format!("{count} entries; allowed are up to {MAX_RESOURCES}");
        return Err(Error::invalid(join(path, "resources"), message));
    }
    let mut resources = Vec::with_capacity(count);
    for (n, resource) in mesh.resources.into_iter().enumerate() {
        let asset = digest(&join(path, &format!("resources[{n}].asset")), resource.asset.as_ref())?;
        resources.push((resource.uri, asset));
    }
    // The order has no meaning, so it must not make another result key.
    resources.sort();
    Ok((asset, resources))
}

pub(crate) fn displace(path: &str, request: v1::DisplaceRequest) -> Result<DisplaceRequest> {
    let method = for_files(path, &request)?;
    let parsed = surface(path, v1::DisplaceRequest { method: method.into(), ..request })?;
    refuse_own_camera(path, &parsed.geometry)?;
    if parsed.geometry.is_exact() {
        let message =
            "the surface itself has no triangles to write: give a tolerance or uniform_level; exact is for Render";
        return Err(Error::invalid(join(path, "geometry.exact"), message));
    }
    if parsed.maps.projection != Projection::Uv {
        let message = "the file that Displace writes has its maps at texture coordinates alone: leave the projection for Render, or give the mesh coordinates";
        return Err(Error::unsupported(join(path, "look.projection"), message));
    }
    relief::refuse_in_files(path, &parsed)?;
    Ok(parsed)
}

/// A file of triangles holds displacement alone, so that there is nothing to choose but how fine it is.
fn for_files(path: &str, request: &v1::DisplaceRequest) -> Result<v1::Method> {
    use v1::{geometry::Refinement, tolerance::Allowed};
    let method: v1::Method = known(&join(path, "method"), request.method)?;
    if method != v1::Method::Auto {
        return Ok(method);
    }
    let refinement = request.geometry.as_ref().and_then(|geometry| geometry.refinement.as_ref());
    match refinement {
        Some(Refinement::Tolerance(v1::Tolerance { allowed: Some(Allowed::Pixels(_)), .. })) => {
            Ok(method_for(&request.details))
        }
        _ => {
            let message = "is auto, which chooses what is near enough in pixels of views: give geometry.tolerance.pixels with views (--tolerance-px and --view), or name a method";
            Err(Error::invalid(join(path, "method"), message))
        }
    }
}

/// A file is seen by no camera of its own.
fn refuse_own_camera(path: &str, geometry: &Geometry) -> Result<()> {
    let Some(Allowed::Pixels { views, .. }) = geometry.tolerance().map(|tolerance| &tolerance.allowed) else {
        return Ok(());
    };
    if !views.is_empty() {
        return Ok(());
    }
    let message = "has 0 entries; allowed are 1 to 64: a result that is not an image has no camera of its own";
    Err(Error::invalid(join(path, "geometry.tolerance.pixels.views"), message))
}

fn surface(path: &str, request: v1::DisplaceRequest) -> Result<DisplaceRequest> {
    let (mesh, resources) = mesh_source(&join(path, "mesh"), request.mesh)?;
    let method = method(&join(path, "method"), request.method)?;
    let details = details::parse(&join(path, "details"), request.details, method)?;
    let geometry = geometry::parse(&join(path, "geometry"), request.geometry)?;
    let maps = look::maps(&join(path, "look"), request.look)?;
    let compression = compression(&join(path, "compression"), request.compression)?;
    let lods = lods(&join(path, "lods"), request.lods, &geometry)?;
    Ok(DisplaceRequest { mesh, resources, details, method, geometry, maps, compression, lods })
}

fn lods(field: &str, levels: u32, geometry: &Geometry) -> Result<u32> {
    if levels > lods::MOST {
        let message = format!("{levels} is out of range; allowed are 0 to {} levels of detail", lods::MOST);
        return Err(Error::invalid(field, message));
    }
    if levels > 1 && geometry.tolerance().is_none() {
        let message = format!(
            "{levels} levels of detail need a tolerance: without one, nothing tells from how far each is near enough; give a tolerance, or leave lods out"
        );
        return Err(Error::invalid(field, message));
    }
    Ok(levels.max(1))
}

fn compression(field: &str, compression: i32) -> Result<Compression> {
    Ok(match known(field, compression)? {
        v1::Compression::Unspecified | v1::Compression::None => Compression::None,
        v1::Compression::Quantize => Compression::Quantize,
        v1::Compression::Meshopt => Compression::Meshopt,
    })
}

pub(crate) fn render(path: &str, request: v1::RenderRequest, config: &Config) -> Result<RenderRequest> {
    if request.sequence.is_some() {
        let message = "is for Render: leave it out, and ask for one view";
        return Err(Error::unsupported(join(path, "sequence"), message));
    }
    let surface = request.surface.ok_or_else(|| Error::invalid(join(path, "surface"), "is required"))?;
    let surface = self::surface(&join(path, "surface"), with_tolerance(surface))?;
    if surface.compression != Compression::None {
        let message = "packs the file that Displace writes, and an image is none: leave it unspecified";
        return Err(Error::invalid(join(path, "surface.compression"), message));
    }
    if surface.lods > 1 {
        let message =
            format!("{} levels are for the file that Displace writes, and an image is none: leave it 0", surface.lods);
        return Err(Error::invalid(join(path, "surface.lods"), message));
    }
    if matches!(surface.geometry.normals, Normals::Map { .. }) {
        let message =
            "a normal map is for the file that Displace writes: take analytic normals, which an image shows anyhow";
        return Err(Error::invalid(join(path, "surface.geometry.normals"), message));
    }
    let view = view::parse(&join(path, "views"), request.views, config.max_image_pixels)?;
    let look = look::parse(&join(path, "lighting"), request.lighting)?;
    refuse_under_projection(path, &surface, &look)?;
    let aovs = aovs(&join(path, "aovs"), &request.aovs)?;
    let format = match known::<v1::ImageFormat>(&join(path, "format"), request.format)? {
        v1::ImageFormat::Unspecified | v1::ImageFormat::Png => ImageFormat::Png,
        v1::ImageFormat::Exr => ImageFormat::Exr,
    };
    let samples = view::samples(&join(path, "samples"), request.samples)?;
    let View { camera, width, height } = view;
    let preimage = preimage(&join(path, "preimage"), request.preimage, [width, height])?;
    let mut request = RenderRequest { surface, camera, width, height, look, aovs, format, preimage, samples };
    relief::check(path, &request)?;
    // What is left open is filled in, so that it does not make another result key.
    request.samples = request.rays().map(|rays| rays.samples);
    Ok(request)
}

/// What is to be chosen is by default within half a pixel.
fn with_tolerance(mut surface: v1::DisplaceRequest) -> v1::DisplaceRequest {
    if surface.method == i32::from(v1::Method::Auto) {
        let pixels = v1::PixelTolerance { tolerance_px: AUTO_PX, views: Vec::new() };
        let allowed = Some(v1::tolerance::Allowed::Pixels(pixels));
        let tolerance = v1::Tolerance { allowed, ..v1::Tolerance::default() };
        let geometry = surface.geometry.get_or_insert_default();
        geometry.refinement.get_or_insert(v1::geometry::Refinement::Tolerance(tolerance));
    }
    surface
}

/// What is tied to texture coordinates goes with no other projection.
pub(super) fn refuse_under_projection(path: &str, surface: &DisplaceRequest, look: &Look) -> Result<()> {
    if surface.maps.projection == Projection::Uv {
        return Ok(());
    }
    let field = join(path, "surface.look.projection");
    let normals = surface.details.iter().flat_map(|detail| &detail.layers).any(|layer| layer.source.is_normal());
    if normals || matches!(surface.method, Method::Bump | Method::Normal) {
        let message = "is not uv, and details bend normals where texture coordinates say: take --projection uv, or --method displacement";
        return Err(Error::unsupported(field, message));
    }
    if look.moments {
        let message = "is not uv, and moments are of normal maps read at texture coordinates: take --projection uv, or --moments off";
        return Err(Error::unsupported(field, message));
    }
    Ok(())
}

fn preimage(field: &str, pixel: Option<v1::Pixel>, size: [u32; 2]) -> Result<Option<[u32; 2]>> {
    let Some(v1::Pixel { x, y }) = pixel else { return Ok(None) };
    if x < size[0] && y < size[1] {
        return Ok(Some([x, y]));
    }
    let [width, height] = size;
    let message = format!("{x},{y} is out of range; allowed are 0,0 to {},{}", width - 1, height - 1);
    Err(Error::invalid(field, message))
}

/// Share of the diagonal.
const DEFAULT_PRECISION: f64 = 1e-4;
const PRECISION: std::ops::RangeInclusive<f64> = 1e-7..=1.0;

pub(crate) fn measure(request: v1::MeasureRequest) -> Result<MeasureRequest> {
    refuse_normal_maps(&request.details)?;
    let (mesh, resources) = mesh_source("result", request.result)?;
    let precision = request.precision.unwrap_or(DEFAULT_PRECISION);
    if !PRECISION.contains(&precision) {
        let (low, high) = PRECISION.into_inner();
        let message = format!("{precision} is out of range; allowed are {low:e} to {high} of the diagonal");
        return Err(Error::invalid("precision", message));
    }
    let geometry = v1::Geometry {
        refinement: Some(v1::geometry::Refinement::UniformLevel(0)),
        seams: request.seams,
        feather_texels: request.feather_texels,
        base: request.base,
        ..v1::Geometry::default()
    };
    let reference = v1::DisplaceRequest {
        mesh: request.mesh,
        method: method_for(&request.details).into(),
        details: request.details,
        geometry: Some(geometry),
        ..v1::DisplaceRequest::default()
    };
    // The geometry is ours; its fields are the request's own.
    let named = |mut error: Error| {
        error.field = error.field.map(|field| field.strip_prefix("geometry.").unwrap_or(&field).to_owned());
        error
    };
    Ok(MeasureRequest {
        reference: displace("", reference).map_err(named)?,
        mesh,
        resources,
        precision,
        colors: request.colors,
    })
}

/// Nothing moves by them, so they say nothing of distances.
fn refuse_normal_maps(details: &[v1::MaterialDetail]) -> Result<()> {
    let is_normal = |layer: &v1::Layer| matches!(layer.source, Some(v1::layer::Source::Normal(_)));
    let found = |(n, detail): (usize, &v1::MaterialDetail)| Some((n, detail.layers.iter().position(is_normal)?));
    let Some((n, k)) = details.iter().enumerate().find_map(found) else { return Ok(()) };
    let message = "moves nothing, and distances do not tell of it: leave it out";
    Err(Error::invalid(format!("details[{n}].layers[{k}].normal"), message))
}

/// The method that realises every layer.
fn method_for(details: &[v1::MaterialDetail]) -> v1::Method {
    use v1::layer::Source;
    let mut layers = details.iter().flat_map(|detail| &detail.layers);
    let vectors = |layer: &v1::Layer| matches!(layer.source, Some(Source::Vector(_) | Source::Direction(_)));
    match details {
        [] => v1::Method::Flat,
        _ if layers.any(vectors) => v1::Method::Vector,
        _ => v1::Method::Displacement,
    }
}

pub(crate) fn compare(request: &v1::CompareRequest) -> Result<CompareRequest> {
    Ok(CompareRequest { a: digest("a", request.a.as_ref())?, b: digest("b", request.b.as_ref())? })
}

pub(crate) fn estimate(request: v1::EstimateRequest, config: &Config) -> Result<EstimateRequest> {
    use v1::estimate_request::Request;
    match request.request {
        Some(Request::Displace(request)) => Ok(EstimateRequest::Displace(Box::new(displace("displace", request)?))),
        Some(Request::Render(request)) => Ok(EstimateRequest::Render(Box::new(render("render", request, config)?))),
        None => Err(Error::invalid("request", "is required; give displace or render")),
    }
}

/// The row of the table that has the value's name.
fn method(field: &str, method: i32) -> Result<Method> {
    let value: v1::Method = known(field, method)?;
    if value == v1::Method::Unspecified {
        return Ok(Method::Displacement);
    }
    let name = value.as_str_name().trim_start_matches("METHOD_").to_ascii_lowercase().replace('_', "-");
    let row = METHODS.iter().find(|row| row.name == name);
    row.map(|row| row.method).ok_or_else(|| {
        let known = METHODS.iter().map(|row| row.name).collect::<Vec<_>>().join(", ");
        Error::unsupported(field, format!("{name} is not a method that this version has; it has {known}"))
    })
}

fn aovs(path: &str, aovs: &[i32]) -> Result<Vec<Aov>> {
    let mut seen = HashSet::new();
    let parse = |(n, aov): (usize, &i32)| {
        let field = format!("{path}[{n}]");
        let aov = match known(&field, *aov)? {
            v1::Aov::Unspecified => return Err(Error::invalid(field, "is unspecified; name an output")),
            v1::Aov::Depth => Aov::Depth,
            v1::Aov::Normal => Aov::Normal,
            v1::Aov::Position => Aov::Position,
            v1::Aov::Uv => Aov::Uv,
            v1::Aov::Triangle => Aov::Triangle,
            v1::Aov::Overdraw => Aov::Overdraw,
            v1::Aov::Samples => Aov::Samples,
            v1::Aov::Cost => Aov::Cost,
        };
        if seen.insert(aov) { Ok(aov) } else { Err(Error::invalid(field, format!("{aov:?} is named twice"))) }
    };
    aovs.iter().enumerate().map(parse).collect()
}
