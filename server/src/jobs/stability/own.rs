//! Mesh and heights of the request, as scenarios take them.

use displace_glsl::reference::relief::ReliefMap;
use glam::{DVec2, DVec3};

use super::rays;
use crate::{
    domain::{
        Result,
        detail::{LayerSource, Map},
        mesh::Mesh,
        request::{Base, DisplaceRequest, Refinement},
        scene::SceneMesh,
    },
    jobs::{WorkContext, inputs::Inputs},
};

/// Texels along either side that are marched over, at most.
const MOST_TEXELS: u32 = 128;
/// Heights of hills, texels, where the request has none of its own.
const HILLS: f64 = 8.0;

pub(super) struct Own {
    pub(super) inputs: Inputs,
    /// Its heights, or hills.
    pub(super) heights: ReliefMap,
    /// What they are.
    pub(super) heights_are: String,
    /// Of the meshes.
    pub(super) title: String,
}

impl Own {
    /// `request` is that of the chart's truth; its geometry does not matter.
    pub(super) fn load(context: &WorkContext<'_>, request: &DisplaceRequest) -> Result<Self> {
        let mut request = request.clone();
        request.geometry.refinement = Refinement::Uniform(0);
        request.geometry.base = Base::Flat;
        let inputs = Inputs::load(context.assets, context.limits, &context.job(), &request)?;
        let own = inputs.scene.meshes.iter().zip(&inputs.details).find_map(of_mesh);
        let (heights, heights_are) = own.unwrap_or_else(|| {
            (rays::hills(HILLS), format!("hills {HILLS} texels high, since the request has no height map"))
        });
        let names = || inputs.scene.meshes.iter().map(|m| m.mesh.name.as_str());
        let title = names().find(|name| !name.is_empty()).unwrap_or("mesh without a name").to_owned();
        Ok(Self { heights, heights_are, title, inputs })
    }
}

/// Of the first primitive that has a height map.
fn of_mesh(
    (m, details): (&SceneMesh, &Vec<Option<std::sync::Arc<crate::domain::detail::Detail>>>),
) -> Option<(ReliefMap, String)> {
    let found = details.iter().enumerate().find_map(|(p, detail)| {
        let detail = detail.as_ref()?;
        let layer = detail.layers.iter().find(|layer| matches!(layer.source, LayerSource::Height(_)))?;
        Some((p, detail.uv_set, layer))
    });
    let (p, uv_set, layer) = found?;
    let LayerSource::Height(map) = &layer.source else { return None };
    let texel = texel_local(&m.mesh, p, uv_set, map)?;
    let size = [map.width.min(MOST_TEXELS), map.height.min(MOST_TEXELS)];
    let height = |x: u32, y: u32| {
        let value = map.texels[(y * map.width + x) as usize];
        f64::from(layer.scale * (value - layer.midlevel)) / texel
    };
    let heights = rays::map(size, height);
    let [low, high] = rays::range(&heights);
    let told = format!(
        "{} x {} texels of the request's heights, repeated, {:.1} texels from lowest to highest",
        size[0],
        size[1],
        high - low
    );
    (high > low).then_some((heights, told))
}

/// Side of a texel on the mesh, local units: the root of its mean area.
fn texel_local(mesh: &Mesh, primitive: usize, uv_set: u32, map: &Map) -> Option<f64> {
    let uvs = &mesh.attribute(&format!("TEXCOORD_{uv_set}"))?.values;
    let range = &mesh.primitives[primitive].triangles;
    let sums =
        mesh.triangles[range.start as usize..range.end as usize].iter().fold([0.0; 2], |[local, map], triangle| {
            let place = |av: u32| DVec3::from_array(mesh.gv_position[mesh.av_gv[av as usize] as usize].map(f64::from));
            let uv = |av: u32| DVec2::new(uvs[2 * av as usize].into(), uvs[2 * av as usize + 1].into());
            let ([a, b, c], [p, q, r]) = (triangle.av.map(place), triangle.av.map(uv));
            [local + (b - a).cross(c - a).length(), map + (q - p).perp_dot(r - p).abs()]
        });
    let texels = sums[1] * f64::from(map.width) * f64::from(map.height);
    (texels > 0.0 && sums[0] > 0.0).then(|| (sums[0] / texels).sqrt())
}
