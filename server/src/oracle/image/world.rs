//! The scene in one piece: every instance's triangles in world space, and what is where a ray hits them.

use std::ops::Range;

use glam::{DMat3, DMat4, DVec2, DVec3};

use super::{
    super::{
        bvh::Segment,
        ray::{Hit, Tracer},
    },
    material::{Corners, Look, alpha, look},
    scene::{OracleMesh, OracleScene},
};
use crate::domain::{Error, Result, image::RenderMaterial};

/// Triangles of one instance and one material, numbered over all instances in order.
struct Part {
    first_triangle: u32,
    /// Number in its mesh of the part's first triangle.
    first_of_mesh: u32,
    mesh: usize,
    material: usize,
    world_from_mesh: DMat3,
    normal_from_mesh: DMat3,
    /// The instance turns the triangles' sense of rotation.
    mirrored: bool,
}

/// A scene that rays can be sent into.
pub(super) struct World<'s> {
    scene: &'s OracleScene,
    tracer: Tracer,
    parts: Vec<Part>,
    view_mirrored: bool,
    residual_world: f64,
    has_layers: bool,
}

/// What a ray sees.
#[derive(Clone, Copy, Debug)]
pub(super) struct Seen {
    pub(super) triangle: u32,
    pub(super) position: DVec3,
    /// Of the triangle itself, unit, towards where the ray comes from.
    pub(super) facing: DVec3,
    /// In the set of the base colour map.
    pub(super) uv: DVec2,
    pub(super) look: Look,
    /// Share of what is behind that it takes away.
    pub(super) alpha: f64,
    /// Positions and shading normals of the vertices, on the side that is seen.
    pub(super) vertices: [(DVec3, DVec3); 3],
    pub(super) weights: DVec3,
}

/// A shadow ray begins so many roundings of the largest coordinate off the surface.
const SHADOW_ROUNDINGS: f64 = 32.0 * f64::EPSILON;

impl<'s> World<'s> {
    /// `view_mirrored`: the camera turns the sense of rotation. Fails when there are too many triangles to number.
    pub(super) fn new(scene: &'s OracleScene, view_mirrored: bool) -> Result<Self> {
        let (mut positions, mut triangles, mut parts) = (Vec::new(), Vec::new(), Vec::new());
        for instance in &scene.instances {
            let mesh = &scene.meshes[instance.mesh];
            let world_from_mesh = DMat4::from_cols_array(&instance.world_from_mesh.map(f64::from));
            let linear = DMat3::from_mat4(world_from_mesh);
            let (first_vertex, first_triangle) = (positions.len(), triangles.len());
            check_count(first_vertex + mesh.positions.len(), first_triangle + mesh.triangles.len())?;
            parts.extend(runs(mesh).map(|(run, material)| Part {
                first_triangle: (first_triangle + run.start) as u32,
                first_of_mesh: run.start as u32,
                mesh: instance.mesh,
                material,
                world_from_mesh: linear,
                normal_from_mesh: cofactors(linear),
                mirrored: linear.determinant() < 0.0,
            }));
            positions.extend(mesh.positions.iter().map(|p| world_from_mesh.transform_point3(*p)));
            triangles.extend(mesh.triangles.iter().map(|t| t.map(|v| v + first_vertex as u32)));
        }
        let (tracer, residual_world) = (Tracer::new(positions, triangles), scene.residual_world());
        let has_layers = scene.materials.iter().any(|material| material.alpha.is_blended());
        Ok(Self { scene, tracer, parts, view_mirrored, residual_world, has_layers })
    }

    /// The nearest point that is there and turned to the ray.
    pub(super) fn seen(&self, ray: &Segment) -> Option<Seen> {
        let shows = |hit: &Hit| self.faces(hit) && self.is_opaque(self.part(hit.triangle), hit);
        self.tracer.first_hit_where(ray, shows).map(|hit| self.surface(ray, &hit))
    }

    /// Where that is, alone.
    pub(super) fn place(&self, ray: &Segment) -> Option<DVec3> {
        let shows = |hit: &Hit| self.faces(hit) && self.is_opaque(self.part(hit.triangle), hit);
        let place = |hit: Hit| blend(hit.barycentrics, self.tracer.corners(hit.triangle));
        self.tracer.first_hit_where(ray, shows).map(place)
    }

    /// All that is seen, one through the other, the nearest first: blended surfaces, and what is behind them.
    pub(super) fn layers(&self, ray: &Segment) -> Vec<Seen> {
        if !self.has_layers {
            return self.seen(ray).into_iter().collect();
        }
        let is_blended = |hit: &Hit| self.material(self.part(hit.triangle)).alpha.is_blended();
        let closes = |hit: &Hit| !is_blended(hit) && self.faces(hit) && self.is_opaque(self.part(hit.triangle), hit);
        let last = self.tracer.first_hit_where(ray, closes);
        let is_before = |hit: &Hit| last.is_none_or(|last| (hit.t, hit.triangle) < (last.t, last.triangle));
        let mut hits = self.tracer.hits(ray);
        hits.retain(|hit| is_blended(hit) && self.faces(hit) && is_before(hit));
        hits.sort_by(|a, b| a.t.total_cmp(&b.t).then(a.triangle.cmp(&b.triangle)));
        hits.iter().chain(&last).map(|hit| self.surface(ray, hit)).collect()
    }

    fn faces(&self, hit: &Hit) -> bool {
        let part = self.part(hit.triangle);
        self.material(part).double_sided || self.is_front(part, hit)
    }

    /// Whether anything is between a point that is seen and a light so far in a unit direction. Both sides of a
    /// surface stop light, wherever it is opaque.
    pub(super) fn is_shadowed(&self, seen: &Seen, to_light: DVec3, distance: f64) -> bool {
        let ray = Segment { to: distance, ..self.leaving(seen, to_light) };
        self.tracer.any_hit_where(&ray, |hit| self.is_opaque(self.part(hit.triangle), hit))
    }

    /// A ray from a point that is seen, clear of its surface.
    pub(super) fn leaving(&self, seen: &Seen, direction: DVec3) -> Segment {
        let rounding = SHADOW_ROUNDINGS * seen.position.abs().max_element();
        let origin = seen.position + seen.facing * (rounding + self.residual_world);
        Segment { origin, direction, from: 0.0, to: f64::INFINITY }
    }

    fn part(&self, triangle: u32) -> &Part {
        &self.parts[self.parts.partition_point(|part| part.first_triangle <= triangle) - 1]
    }

    fn material(&self, part: &Part) -> &RenderMaterial {
        &self.scene.materials[part.material]
    }

    /// Front faces run counter-clockwise; in mirrored instances, clockwise (glTF 2.0, 3.7.4).
    fn is_front(&self, part: &Part, hit: &Hit) -> bool {
        hit.front != (part.mirrored != self.view_mirrored)
    }

    fn is_opaque(&self, part: &Part, hit: &Hit) -> bool {
        let material = self.material(part);
        let cutoff = f64::from(material.alpha.cutoff());
        cutoff == 0.0 || alpha(material, &self.corners(part, hit)) >= cutoff
    }

    fn vertices(&self, part: &Part, hit: &Hit) -> (&'s OracleMesh, [usize; 3]) {
        let mesh = &self.scene.meshes[part.mesh];
        let triangle = part.first_of_mesh + (hit.triangle - part.first_triangle);
        (mesh, mesh.triangles[triangle as usize].map(|v| v as usize))
    }

    fn surface(&self, ray: &Segment, hit: &Hit) -> Seen {
        let part = self.part(hit.triangle);
        let (mesh, v) = self.vertices(part, hit);
        let [a, b, c] = self.tracer.corners(hit.triangle);
        let side = if self.is_front(part, hit) { 1.0 } else { -1.0 };
        let vertex_normal = |v: usize| DVec3::from_array(mesh.normals[v].map(f64::from));
        let in_world = |normal: DVec3| side * (part.normal_from_mesh * normal).normalize_or_zero();
        let normal = in_world(blend(hit.barycentrics, v.map(vertex_normal)));
        let normals = v.map(|v| in_world(vertex_normal(v)));
        let facing = (b - a).cross(c - a).normalize_or_zero();
        let corners = self.corners(part, hit);
        let look = look(self.material(part), &corners, normal, side, part.world_from_mesh);
        Seen {
            triangle: hit.triangle,
            position: blend(hit.barycentrics, [a, b, c]),
            facing: if facing.dot(ray.direction) > 0.0 { -facing } else { facing },
            uv: corners.uv_of_base_color(self.material(part)),
            alpha: if self.material(part).alpha.is_blended() { look.base.w.clamp(0.0, 1.0) } else { 1.0 },
            look,
            vertices: [(a, normals[0]), (b, normals[1]), (c, normals[2])],
            weights: hit.barycentrics,
        }
    }

    fn corners(&self, part: &Part, hit: &Hit) -> Corners<'_> {
        let (mesh, vertices) = self.vertices(part, hit);
        Corners {
            mesh,
            vertices,
            triangle: (part.first_of_mesh + (hit.triangle - part.first_triangle)) as usize,
            weights: hit.barycentrics,
            uv_channels: self.scene.uv_channels as usize,
            projection: self.scene.projection,
        }
    }
}

pub(super) fn blend<T: std::ops::Mul<f64, Output = T> + std::ops::Add<Output = T>>(
    weights: DVec3,
    [a, b, c]: [T; 3],
) -> T {
    a * weights.x + b * weights.y + c * weights.z
}

/// The inverse transpose times the size of the determinant: also there when the matrix has no inverse.
fn cofactors(m: DMat3) -> DMat3 {
    let (x, y, z) = (m.x_axis, m.y_axis, m.z_axis);
    let sign = if m.determinant() < 0.0 { -1.0 } else { 1.0 };
    DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y)) * sign
}

/// Runs of triangles of one material, without empty ones.
fn runs(mesh: &OracleMesh) -> impl Iterator<Item = (Range<usize>, usize)> + '_ {
    let starts = &mesh.material_of_triangles;
    let end = |k: usize| starts.get(k + 1).map_or(mesh.triangles.len(), |next| next.0 as usize);
    let run = move |(k, &(first, material)): (usize, &(u32, u32))| (first as usize..end(k), material as usize);
    starts.iter().enumerate().map(run).filter(|(run, _)| !run.is_empty())
}

fn check_count(vertices: usize, triangles: usize) -> Result<()> {
    let most = u32::MAX as usize - 1;
    if vertices <= most && triangles <= most {
        return Ok(());
    }
    let message = format!("the scene's instances have more than {most} triangles or vertices: lower the level");
    Err(Error::too_large("geometry.uniform", message))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn normals_follow_the_inverse_transpose_under_mirrored_and_uneven_scale() {
        let m = DMat3::from_cols(DVec3::new(-2.0, 0.0, 0.0), DVec3::new(0.3, 5.0, 0.0), DVec3::new(0.0, 0.1, 0.25));
        for n in [DVec3::X, DVec3::Y, DVec3::new(0.2, -0.4, 0.7)] {
            let expected = (m.inverse().transpose() * n).normalize();
            assert!(((cofactors(m) * n).normalize() - expected).length() < 1e-15);
        }
    }
}
