//! Triangles in world space that can tell how near they are: plain meshes, and displaced surfaces with what
//! they may deviate from their triangles.

mod closest;
mod nearest;
mod rounding;
mod stretch;

use glam::{DAffine3, DMat3, DVec3, Vec3};
use rayon::prelude::*;

use super::{
    bvh::{Bounds, Bvh},
    dicing::Dicing,
    surface::Surface,
};
use crate::domain::mesh::Mesh;
pub(crate) use closest::{closest_on_triangle, distance_to_triangle};
pub use nearest::Near;

/// A mesh or a displaced surface, all instances together, world units.
pub struct Sheet<'s> {
    pub positions: Vec<DVec3>,
    pub triangles: Vec<[u32; 3]>,
    /// Distance of each triangle to what it stands for; empty where triangles stand for themselves.
    residual: Vec<f32>,
    /// Shading normals of each triangle's corners; unit length.
    normals: Vec<[Vec3; 3]>,
    parts: Vec<Part<'s>>,
    largest_residual: f64,
    moved: f64,
    magnitude: f64,
    bvh: Bvh,
}

/// One instance of a displaced surface.
struct Part<'s> {
    surface: &'s Surface<'s>,
    first_triangle: usize,
    world_from_mesh: DAffine3,
    normal_from_mesh: DMat3,
    /// Most that the instance enlarges any distance.
    enlargement: f64,
    base: &'s [u32],
    at: &'s [[DVec3; 3]],
}

/// Gathers instances.
#[derive(Default)]
pub struct SheetBuilder<'s> {
    positions: Vec<DVec3>,
    triangles: Vec<[u32; 3]>,
    residual: Vec<f32>,
    normals: Vec<[Vec3; 3]>,
    parts: Vec<Part<'s>>,
    moved: f64,
    magnitude: f64,
}

impl<'s> SheetBuilder<'s> {
    /// Adds an instance of a mesh as it is; `world_from_mesh` is column-major.
    pub fn mesh(&mut self, mesh: &Mesh, world_from_mesh: &[f32; 16]) {
        let world = affine(world_from_mesh);
        let normal_from_mesh = normal_matrix(&world);
        let first = self.add_positions(mesh.gv_position.iter().map(|p| DVec3::from_array(p.map(f64::from))), &world);
        for triangle in &mesh.triangles {
            self.triangles.push(triangle.av.map(|av| first + mesh.av_gv[av as usize]));
            let normal = |av: u32| DVec3::from_array(mesh.av_normal[av as usize].map(f64::from));
            self.normals.push(triangle.av.map(|av| unit(normal_from_mesh * normal(av))));
        }
    }

    /// Adds an instance of a displaced surface and its dicing.
    pub fn surface(&mut self, surface: &'s Surface<'s>, dicing: &'s Dicing, world_from_mesh: &[f32; 16]) {
        let world = affine(world_from_mesh);
        let part = Part {
            surface,
            first_triangle: self.triangles.len(),
            world_from_mesh: world,
            normal_from_mesh: normal_matrix(&world),
            enlargement: largest_singular_value(&world.matrix3),
            base: &dicing.base,
            at: &dicing.at,
        };
        self.moved = self.moved.max(dicing.moved * part.enlargement);
        surface.mesh().gv_position.iter().for_each(|p| self.note(DVec3::from_array(p.map(f64::from)), &world));
        let first = self.add_positions(dicing.positions.iter().copied(), &world);
        self.triangles.extend(dicing.triangles.iter().map(|t| t.map(|v| first + v)));
        self.residual.extend(dicing.residual.iter().map(|r| ((f64::from(*r) * part.enlargement) as f32).next_up()));
        self.parts.push(part);
    }

    fn add_positions(&mut self, positions: impl Iterator<Item = DVec3>, world: &DAffine3) -> u32 {
        let first = self.positions.len() as u32;
        for p in positions {
            self.note(p, world);
            self.positions.push(world.transform_point3(p));
        }
        first
    }

    fn note(&mut self, place: DVec3, world: &DAffine3) {
        let sum = world.matrix3.abs() * place.abs() + world.translation.abs();
        self.magnitude = self.magnitude.max(sum.max_element());
    }

    /// Whether every place is a number that f32 holds too.
    #[must_use]
    pub fn is_finite(&self) -> bool {
        self.positions.par_iter().all(|p| p.as_vec3().is_finite())
    }

    /// All instances are of meshes, or all of surfaces.
    #[must_use]
    pub fn build(self) -> Sheet<'s> {
        let Self { positions, triangles, residual, normals, parts, moved, magnitude } = self;
        let corners = |t: &[u32; 3]| t.map(|v| positions[v as usize]);
        let margin = |k: usize| residual.get(k).map_or(0.0, |r| f64::from(*r));
        let boxes: Vec<Bounds> =
            triangles.iter().enumerate().map(|(k, t)| Bounds::of(&corners(t)).inflated(margin(k))).collect();
        let bvh = Bvh::build(&boxes);
        let largest_residual = residual.iter().copied().fold(0.0, f32::max).into();
        Sheet { positions, triangles, residual, normals, parts, largest_residual, moved, magnitude, bvh }
    }
}

impl Sheet<'static> {
    /// Triangles that stand for themselves, with their own normals; indices are in range.
    #[must_use]
    pub fn of_triangles(positions: Vec<DVec3>, triangles: Vec<[u32; 3]>) -> Self {
        let normal = |[a, b, c]: [DVec3; 3]| [unit((b - a).cross(c - a)); 3];
        let normals = triangles.iter().map(|t| normal(t.map(|v| positions[v as usize]))).collect();
        let magnitude = positions.iter().fold(0.0, |most: f64, p| most.max(p.abs().max_element()));
        SheetBuilder { positions, triangles, normals, magnitude, ..SheetBuilder::default() }.build()
    }
}

impl Sheet<'_> {
    #[must_use]
    pub fn corners(&self, triangle: u32) -> [DVec3; 3] {
        self.triangles[triangle as usize].map(|v| self.positions[v as usize])
    }

    /// How far the triangle is at most from what it stands for.
    #[must_use]
    pub fn residual(&self, triangle: u32) -> f64 {
        self.residual.get(triangle as usize).map_or(0.0, |r| f64::from(*r))
    }

    /// The most by which a vertex lies beside the places that [`Self::point`] gives around it: at open seams.
    #[must_use]
    pub fn moved(&self) -> f64 {
        self.moved
    }

    /// The largest of what coordinates were added up from, bases and translations: what rounding goes by.
    #[must_use]
    pub fn magnitude(&self) -> f64 {
        self.magnitude
    }

    /// By how much distances to its thinnest triangles may be found too large. Within a triangle of height h on a
    /// longest side l, the foot of a point is known to l² ε / h along h, and to h.
    #[must_use]
    pub fn sliver_rounding(&self) -> f64 {
        let of = |t: u32| {
            let [a, b, c] = self.corners(t);
            let longest = a.distance(b).max(b.distance(c)).max(c.distance(a));
            let height = (b - a).cross(c - a).length() / longest;
            if longest > 0.0 { 4.0 * height.min(longest * longest * f64::EPSILON / height) } else { 0.0 }
        };
        (0..self.triangles.len() as u32).into_par_iter().map(of).reduce(|| 0.0, f64::max)
    }

    #[must_use]
    pub fn largest_residual(&self) -> f64 {
        self.largest_residual
    }

    /// Triangles that face against their own shading normals; `None` of a surface, whose normals are its own.
    #[must_use]
    pub fn facing_back(&self) -> Option<u64> {
        if !self.parts.is_empty() {
            return None;
        }
        let back = |t: u32| {
            let [a, b, c] = self.corners(t);
            let third = DVec3::splat(1.0 / 3.0);
            (b - a).cross(c - a).dot(self.normal(t, third)) < 0.0
        };
        Some((0..self.triangles.len() as u32).into_par_iter().filter(|&t| back(t)).count() as u64)
    }

    #[must_use]
    pub fn bounds(&self) -> Bounds {
        let margin = self.largest_residual();
        Bounds::of(&self.positions).inflated(margin)
    }

    /// The exact place at barycentrics `at` of a triangle.
    #[must_use]
    pub fn point(&self, triangle: u32, at: DVec3) -> DVec3 {
        match self.part(triangle) {
            Some((part, k)) => part
                .world_from_mesh
                .transform_point3(part.surface.position(part.base[k] as usize, blend(part.at[k], at))),
            None => blend(self.corners(triangle), at),
        }
    }

    /// Unit shading normal there.
    #[must_use]
    pub fn normal(&self, triangle: u32, at: DVec3) -> DVec3 {
        match self.part(triangle) {
            Some((part, k)) => {
                let (_, normal) = part.surface.position_and_normal(part.base[k] as usize, blend(part.at[k], at));
                (part.normal_from_mesh * normal).normalize_or_zero()
            }
            None => blend(self.normals[triangle as usize].map(Vec3::as_dvec3), at).normalize_or_zero(),
        }
    }

    /// How far the exact sheet is at most from the triangle between three of its places.
    #[must_use]
    pub fn deviation(&self, triangle: u32, corners: [DVec3; 3]) -> f64 {
        let Some((part, k)) = self.part(triangle) else { return 0.0 };
        let region = corners.map(|at| blend(part.at[k], at));
        part.surface.deviation(part.base[k] as usize, &region) * part.enlargement
    }

    /// As [`Self::deviation`], between places found on any triangles of one base triangle; `None` where they are not,
    /// and where it is plainly more than `at_most`.
    #[must_use]
    pub fn deviation_between(&self, places: &[Near; 3], at_most: f64) -> Option<f64> {
        let found = places.each_ref().map(|near| self.part(near.triangle));
        let [Some((a, i)), Some((b, j)), Some((c, k))] = found else { return None };
        let same = a.first_triangle == b.first_triangle && a.first_triangle == c.first_triangle;
        if !same || a.base[i] != a.base[j] || a.base[i] != a.base[k] {
            return None;
        }
        let region = [(i, 0), (j, 1), (k, 2)].map(|(k, p)| blend(a.at[k], places[p].at));
        // One place shows most of what deviates too far, without bounds.
        let third = DVec3::splat(1.0 / 3.0);
        let middle = a.world_from_mesh.transform_point3(a.surface.position(a.base[i] as usize, blend(region, third)));
        if at_most.is_nan() || middle.distance(blend(places.each_ref().map(|near| near.place), third)) > at_most {
            return None;
        }
        Some(a.surface.deviation(a.base[i] as usize, &region) * a.enlargement)
    }

    fn part(&self, triangle: u32) -> Option<(&Part<'_>, usize)> {
        let triangle = triangle as usize;
        let part = &self.parts[self.parts.partition_point(|p| p.first_triangle <= triangle).checked_sub(1)?];
        Some((part, triangle - part.first_triangle))
    }
}

pub(crate) fn blend(corners: [DVec3; 3], at: DVec3) -> DVec3 {
    corners[0] * at.x + corners[1] * at.y + corners[2] * at.z
}

fn unit(v: DVec3) -> Vec3 {
    v.normalize_or_zero().as_vec3()
}

fn affine(columns: &[f32; 16]) -> DAffine3 {
    DAffine3::from_mat4(glam::DMat4::from_cols_array(&columns.map(f64::from)))
}

/// Of normals: the cofactors, which are right for mirrored and flattened instances too.
fn normal_matrix(world: &DAffine3) -> DMat3 {
    let DMat3 { x_axis: x, y_axis: y, z_axis: z } = world.matrix3;
    DMat3::from_cols(y.cross(z), z.cross(x), x.cross(y))
}

/// The most by which an instance enlarges any distance, rounded up; `world_from_mesh` is column-major.
#[must_use]
pub fn enlargement(world_from_mesh: &[f32; 16]) -> f64 {
    largest_singular_value(&affine(world_from_mesh).matrix3)
}

/// Rounded up: the Frobenius norm where the iteration has not settled.
fn largest_singular_value(m: &DMat3) -> f64 {
    let square = m.transpose() * *m;
    let mut power = square;
    for _ in 0..6 {
        let scale = power.x_axis.abs().max(power.y_axis.abs()).max(power.z_axis.abs()).max_element();
        if scale <= 0.0 {
            return 0.0;
        }
        power *= 1.0 / scale;
        power *= power;
    }
    // tr(Aⁿ⁺¹) / tr(Aⁿ) is at most the largest eigenvalue; their difference is below 3^(1/64).
    let trace = |m: &DMat3| m.x_axis.x + m.y_axis.y + m.z_axis.z;
    let estimate = trace(&(power * square)) / trace(&power);
    let bound = (estimate.max(0.0) * 3f64.powf(1.0 / 64.0)).sqrt();
    let frobenius = trace(&square).sqrt();
    bound.min(frobenius) * (1.0 + 1e-12)
}
