//! Where a pixel lies on the base colour map of what it shows (Everson, COM3404: the pre-image of a pixel).

use displace_glsl::{
    layout::raster::{INSTANCE_ROWS, MAP_BASE_COLOR},
    reference::{
        projection::{Kind, Projected, projections},
        surface::{Barycentrics, barycentrics},
        transform::homogeneous,
    },
};
use glam::{DVec2, DVec3};

use super::{
    place::Place,
    projected,
    textures::{on_map, still},
};
use crate::{
    domain::{
        Error, Result,
        image::{ImagePlan, RenderMap, RenderScene},
        preimage::Preimage,
    },
    render::image::tables::Tables,
};

/// Of a pixel of the plan's image, all of it seen as on the plane of `triangle`, a number as images give it. Fails where that
/// has no map, or where a corner of the pixel looks past the plane's horizon.
pub fn preimage(plan: &ImagePlan, scene: &RenderScene, [x, y]: [u32; 2], triangle: u32) -> Result<Preimage> {
    let plan = ImagePlan { supersample: 1, ..plan.clone() };
    let tables = Tables::new(&plan, scene)?;
    let part = &tables.parts[tables.parts.partition_point(|part| part.first_triangle <= triangle) - 1];
    let mesh_index = scene.instances[part.instance as usize].mesh;
    let mesh = &scene.meshes[mesh_index];
    let base = tables.meshes[mesh_index].triangle_base as u32;
    let place = Place {
        part,
        mesh,
        rows: &tables.instance_rows[part.instance as usize * INSTANCE_ROWS..][..INSTANCE_ROWS],
        triangle: (part.triangle_base - base + (triangle - part.first_triangle)) as usize,
        uv_channels: scene.uv_channels as usize,
    };
    let Some(map) = &scene.materials[part.material as usize].maps[MAP_BASE_COLOR] else {
        let message =
            format!("pixel {x},{y} shows a material without a base colour map: choose another, or give --base-color");
        return Err(Error::invalid("preimage", message));
    };
    let [x, y] = [f64::from(x), f64::from(y)];
    let centre = DVec2::new(x + 0.5, y + 0.5);
    let corners = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]].map(|[u, v]| DVec2::new(x + u, y + v));
    let seen = Seen { place: &place, map, kind: scene.projection.kind() };
    let (at, middle) = (seen.weights(centre).ok_or_else(past_horizon)?, seen.derivatives(centre));
    let uv = seen.uv(at, at);
    let corners = corners.map(|corner| seen.weights(corner).map(|weights| seen.uv(weights, at)));
    let [Some(a), Some(b), Some(c), Some(d)] = corners else { return Err(past_horizon()) };
    Ok(Preimage { map: map.map.clone(), wrap: map.wrap, corners: [a, b, c, d], centre: uv, sides: seen.sides(&middle) })
}

fn past_horizon() -> Error {
    Error::invalid("preimage", "the pixel looks past the horizon of the triangle it shows: choose one farther from it")
}

struct Seen<'a> {
    place: &'a Place<'a>,
    map: &'a RenderMap,
    kind: Option<Kind>,
}

impl Seen<'_> {
    fn corners(&self, at_px: DVec2) -> [DVec3; 3] {
        self.place.vertices().map(|v| {
            let h = homogeneous(self.place.rows, self.place.mesh.positions[v]);
            DVec3::new(h.x - at_px.x * h.w, h.y - at_px.y * h.w, h.w)
        })
    }

    /// Of the vertices, in the triangle's plane, inside or not; `None` past its horizon.
    fn weights(&self, at_px: DVec2) -> Option<DVec3> {
        let [a, b, c] = self.corners(at_px);
        let rows = DVec3::new(b.cross(c).z, c.cross(a).z, a.cross(b).z);
        let weights = rows / rows.element_sum();
        let in_front = weights.dot(DVec3::new(a.z, b.z, c.z)) > 0.0;
        (in_front && weights.is_finite()).then_some(weights)
    }

    fn derivatives(&self, at_px: DVec2) -> Barycentrics {
        barycentrics(self.corners(at_px))
    }

    /// Of the projections of a kind, the one that most is seen of where the pixel's middle is.
    fn projected(&self, b: &Barycentrics, middle: DVec3) -> Option<Projected> {
        let kind = self.kind?;
        let normal = projected::at(self.place, &still(middle)).normal;
        let at = displace_glsl::reference::projection::Place { normal, ..projected::at(self.place, b) };
        projections(kind, at).max_by(|a, b| a.weight.total_cmp(&b.weight))
    }

    /// In units of the map; around a sphere, on the side of its seam where the middle is.
    fn uv(&self, weights: DVec3, middle: DVec3) -> DVec2 {
        let Some(mut found) = self.projected(&still(weights), middle) else {
            return DVec2::from_array(on_map(self.map, self.place.uv(self.map.uv_channel, weights), 1.0));
        };
        if let (Some(Kind::Sphere | Kind::SphereAsPrinted), Some(near)) =
            (self.kind, self.projected(&still(middle), middle))
        {
            found.uv.x -= (found.uv.x - near.uv.x).round();
        }
        DVec2::from_array(on_map(self.map, found.uv, 1.0))
    }

    fn sides(&self, b: &Barycentrics) -> [DVec2; 2] {
        let [dx, dy] = match self.projected(b, b.at) {
            Some(found) => [found.dx, found.dy],
            None => [b.dx, b.dy].map(|weights| self.place.uv(self.map.uv_channel, weights)),
        };
        [dx, dy].map(|side| DVec2::from_array(on_map(self.map, side, 0.0)))
    }
}
