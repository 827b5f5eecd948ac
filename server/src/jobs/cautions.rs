//! What a detail lets expect before any work: terraces, and tangents that had to be invented.

use glam::{DVec2, DVec3};

use crate::domain::{
    detail::{Detail, Layer, LayerSource, Map},
    mesh::{Mesh, Primitive},
    report::Warning,
};

/// Under light from the side, a slope changes the brightness by about its own size, and the eye sees 2 %.
const VISIBLE_SLOPE: f64 = 0.02;
/// Of the diagonal: a picture of the whole mesh has no more pixels across, and blurs what is finer.
const PIXEL: f64 = 1.0 / 2000.0;
/// Of the product of two sides in texture space: less area is the rounding of UVs.
const NO_UV_AREA: f64 = 1e-6;

/// An 8-bit height map has 256 levels. They show as terraces where the slope of one step, over a texel or a
/// pixel, whichever is wider, is above [`VISIBLE_SLOPE`]. One warning is enough.
pub(super) fn of_terraces(mesh: &Mesh, primitive: usize, detail: &Detail, warnings: &mut Vec<Warning>) {
    const CODE: &str = "terracing_8bit";
    if warnings.iter().any(|warning| warning.code == CODE) {
        return;
    }
    let eight_bit = |layer: &Layer| match &layer.source {
        LayerSource::Height(map) if map.source_bits == 8 => Some(terrace(mesh, primitive, detail, layer, map)),
        _ => None,
    };
    let steepest = detail.layers.iter().filter_map(eight_bit).max_by(|a, b| a.slope.total_cmp(&b.slope));
    if let Some(Terrace { step, spacing, slope }) = steepest.filter(|terrace| terrace.slope > VISIBLE_SLOPE) {
        let message = format!(
            "a height map of mesh '{}' has 8 bits: heights come in steps of {step:.3e} local units, over {spacing:.3e} a slope of {slope:.2}, and may show as terraces; give 16 bits or float, or lower the scale",
            mesh.name
        );
        warnings.push(Warning::new(CODE, message));
    }
}

/// One step of an 8-bit map, local units, and over what width it shows.
struct Terrace {
    step: f64,
    spacing: f64,
    slope: f64,
}

fn terrace(mesh: &Mesh, primitive: usize, detail: &Detail, layer: &Layer, map: &Map) -> Terrace {
    let step = f64::from(layer.scale.abs()) / 255.0;
    let [[a, b, _], [c, d, _]] = layer.map_from_uv.map(|row| row.map(f64::from));
    let texels_per_uv = (a * d - b * c).abs() * f64::from(map.width) * f64::from(map.height);
    let (area, uv_area) = areas(mesh, &mesh.primitives[primitive], detail.uv_set);
    let texel = (area / (uv_area * texels_per_uv)).sqrt();
    let pixel = PIXEL * super::seams::diagonal(mesh);
    let spacing = if texel.is_finite() { texel.max(pixel) } else { pixel };
    Terrace { step, spacing, slope: step / spacing }
}

/// Local and texture space, all triangles together.
fn areas(mesh: &Mesh, primitive: &Primitive, uv_set: u32) -> (f64, f64) {
    let add = |(area, uv_area): (f64, f64), (local, uv): ([DVec3; 2], [DVec2; 2])| {
        (area + local[0].cross(local[1]).length(), uv_area + uv[0].perp_dot(uv[1]).abs())
    };
    sides(mesh, primitive, uv_set).fold((0.0, 0.0), add)
}

/// Tangents made for a detail in the tangent frame say nothing on triangles without UV area.
pub(super) fn of_tangents(mesh: &Mesh, primitive: usize, detail: &Detail, warnings: &mut Vec<Warning>) {
    let primitive = &mesh.primitives[primitive];
    if !primitive.made_tangents {
        return;
    }
    let flat = |(_, [a, b]): &([DVec3; 2], [DVec2; 2])| a.perp_dot(*b).abs() <= NO_UV_AREA * a.length() * b.length();
    let mut invented = sides(mesh, primitive, detail.uv_set).enumerate().filter(|(_, sides)| flat(sides));
    if let Some((first, _)) = invented.next() {
        let message = format!(
            "{} of {} triangles of mesh '{}' primitive {} have no area in TEXCOORD_{}, the first is {first}: their tangents are borrowed or invented and vectors there point anywhere across the normal; unwrap them, or use a map in object space",
            1 + invented.count(),
            primitive.triangles.len(),
            mesh.name,
            primitive.gltf_primitive,
            detail.uv_set
        );
        warnings.push(Warning::new("degenerate_tangents", message));
    }
}

/// Two sides of each triangle of a primitive, local and in texture space; none without the UV set.
fn sides(mesh: &Mesh, primitive: &Primitive, uv_set: u32) -> impl Iterator<Item = ([DVec3; 2], [DVec2; 2])> {
    let range = primitive.triangles.start as usize..primitive.triangles.end as usize;
    let uvs = mesh.attribute(&format!("TEXCOORD_{uv_set}"));
    uvs.into_iter().flat_map(move |uvs| {
        mesh.triangles[range.clone()].iter().map(move |triangle| {
            let place = |av: u32| mesh.gv_position[mesh.av_gv[av as usize] as usize];
            let [p, q, r] = triangle.av.map(|av| DVec3::from_array(place(av).map(f64::from)));
            let uv = |av: u32| [0, 1].map(|k| f64::from(uvs.values[av as usize * 2 + k]));
            let [s, t, u] = triangle.av.map(|av| DVec2::from_array(uv(av)));
            ([q - p, r - p], [t - s, u - s])
        })
    })
}
