//! How far from its place on the screen an image shows the places of a surface.
//!
//! A pixel shows some place of the base, which its texture coordinates name, at some place of the world. Where the displaced
//! surface has that place, as the camera sees it, is so many pixels away. Unlike the distance of what two images show at
//! one pixel it grows neither at grazing angles nor at rims, where a shift by a tenth of a pixel shows something else.

use glam::{DMat4, DVec2, DVec3, DVec4};
use rayon::prelude::*;

use super::surface::Surface;
use crate::domain::{image::ImageSet, mesh::Mesh, scene::Scene};

/// By so much may barycentrics be below 0: texture coordinates of images are f32.
const SLACK: f64 = 1e-3;
/// Cells of the table of texture coordinates along each side, at most.
const MOST_CELLS: usize = 512;

/// One pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reprojected {
    pub material: Option<usize>,
    /// Of the image; ∞ where the surface is behind the camera, or no base triangle has what is shown.
    pub error_px: f64,
}

/// Of every pixel that shows something, but of at most `most`, evenly spread. `images` needs depth, position, uv and its
/// camera, and is of the scene with these surfaces, one for each mesh; else there are none. Nor is there any of what
/// shows no texture coordinates.
#[must_use]
pub fn reprojected(scene: &Scene, surfaces: &[Surface<'_>], images: &ImageSet, most: usize) -> Vec<Reprojected> {
    let (Some(depth), Some(position), Some(uv), Some(clip)) =
        (&images.depth, &images.position, &images.uv, images.clip_from_world)
    else {
        return Vec::new();
    };
    let charts = Charts::new(scene);
    let screen = Screen::new(clip, [images.width, images.height]);
    let covered: Vec<usize> = (0..depth.len()).filter(|i| depth[*i].is_finite()).collect();
    let step = covered.len().div_ceil(most.max(1)).max(1);
    let of_pixel = |i: &usize| {
        let shown = Shown { uv: wide2(uv[*i]), world: DVec3::from_array(position[*i].map(f64::from)) };
        charts.reprojected(scene, surfaces, &screen, shown)
    };
    covered.par_iter().step_by(step).filter_map(of_pixel).collect()
}

/// What 99 of 100 of these pixels do not exceed; none of none.
#[must_use]
pub fn p99_px<'p>(pixels: impl IntoIterator<Item = &'p Reprojected>) -> Option<f64> {
    let mut errors: Vec<f64> = pixels.into_iter().map(|pixel| pixel.error_px).collect();
    errors.sort_by(f64::total_cmp);
    errors.get(errors.len().saturating_sub(1) * 99 / 100).copied()
}

/// What a pixel tells.
#[derive(Clone, Copy)]
struct Shown {
    uv: DVec2,
    world: DVec3,
}

struct Screen {
    clip_from_world: DMat4,
    half_px: DVec2,
}

impl Screen {
    fn new(clip_from_world: [f32; 16], [width, height]: [u32; 2]) -> Self {
        let half_px = 0.5 * DVec2::new(f64::from(width), f64::from(height));
        Self { clip_from_world: DMat4::from_cols_array(&clip_from_world.map(f64::from)), half_px }
    }

    /// Pixels from the middle; none of what is behind.
    fn at(&self, world: DVec3) -> Option<DVec2> {
        let DVec4 { x, y, w, .. } = self.clip_from_world * world.extend(1.0);
        (w > 0.0).then(|| self.half_px * DVec2::new(x, y) / w)
    }

    fn distance_px(&self, a: DVec3, b: DVec3) -> f64 {
        let (Some(a), Some(b)) = (self.at(a), self.at(b)) else { return f64::INFINITY };
        a.distance(b)
    }
}

/// A base triangle of a mesh, by its texture coordinates.
struct Corners {
    mesh: usize,
    triangle: usize,
    uv: [DVec2; 3],
}

/// Base triangles by where they lie in texture space.
struct Charts {
    triangles: Vec<Corners>,
    low: DVec2,
    cells_per_uv: DVec2,
    side: usize,
    /// Indices of `triangles`.
    cells: Vec<Vec<u32>>,
    /// Some primitive has no texture coordinates: what shows it shows (0, 0).
    has_bare: bool,
}

impl Charts {
    fn new(scene: &Scene) -> Self {
        let mut triangles = Vec::new();
        let mut has_bare = false;
        for (index, m) in scene.meshes.iter().enumerate() {
            for t in 0..m.mesh.triangles.len() {
                match uvs(scene, &m.mesh, t) {
                    Some(uv) => triangles.push(Corners { mesh: index, triangle: t, uv }),
                    None => has_bare = true,
                }
            }
        }
        let corners = || triangles.iter().flat_map(|t| t.uv);
        let (low, high) =
            corners().fold((DVec2::INFINITY, DVec2::NEG_INFINITY), |(low, high), uv| (low.min(uv), high.max(uv)));
        let side = triangles.len().isqrt().clamp(1, MOST_CELLS);
        let cells_per_uv = side as f64 / (high - low).max(DVec2::splat(f64::MIN_POSITIVE));
        let mut charts = Self { low, cells_per_uv, side, cells: vec![Vec::new(); side * side], triangles, has_bare };
        for k in 0..charts.triangles.len() {
            let uv = charts.triangles[k].uv;
            let [from, to] = [uv[0].min(uv[1]).min(uv[2]), uv[0].max(uv[1]).max(uv[2])].map(|uv| charts.cell(uv));
            for y in from[1]..=to[1] {
                for x in from[0]..=to[0] {
                    charts.cells[y * side + x].push(k as u32);
                }
            }
        }
        charts
    }

    fn cell(&self, uv: DVec2) -> [usize; 2] {
        // What is no number or outside is at an end.
        let place = ((uv - self.low) * self.cells_per_uv).to_array();
        place.map(|x| (x.max(0.0) as usize).min(self.side - 1))
    }

    /// Of the base triangles that have these coordinates, the one whose place is nearest in the world.
    fn reprojected(
        &self,
        scene: &Scene,
        surfaces: &[Surface<'_>],
        screen: &Screen,
        shown: Shown,
    ) -> Option<Reprojected> {
        let [x, y] = self.cell(shown.uv);
        let mut nearest: Option<(f64, Reprojected)> = None;
        for k in &self.cells[y * self.side + x] {
            let Corners { mesh, triangle, uv } = &self.triangles[*k as usize];
            let Some(b) = barycentrics(uv, shown.uv) else { continue };
            let local = surfaces[*mesh].position(*triangle, b);
            for instance in scene.instances.iter().filter(|instance| instance.mesh == *mesh) {
                let world = instance.world().transform_point3(local);
                let distance = world.distance(shown.world);
                if nearest.is_none_or(|(least, _)| distance < least) {
                    let own = &scene.meshes[*mesh].mesh;
                    let material = own.primitives[own.triangles[*triangle].primitive as usize].material;
                    nearest =
                        Some((distance, Reprojected { material, error_px: screen.distance_px(world, shown.world) }));
                }
            }
        }
        if self.has_bare && shown.uv == DVec2::ZERO {
            return None;
        }
        Some(nearest.map_or(Reprojected { material: None, error_px: f64::INFINITY }, |(_, error)| error))
    }
}

/// As images show them: those of the base colour.
fn uvs(scene: &Scene, mesh: &Mesh, triangle: usize) -> Option<[DVec2; 3]> {
    let triangle = &mesh.triangles[triangle];
    let primitive = triangle.primitive as usize;
    let material = mesh.primitives[primitive].material.and_then(|m| scene.materials.get(m));
    let set = material.and_then(|material| material.base_color.as_ref()).map_or(0, |map| map.uv_set);
    let attribute = mesh.attribute(&format!("TEXCOORD_{set}")).filter(|a| a.primitives[primitive])?;
    Some(triangle.av.map(|av| {
        let at = av as usize * attribute.components;
        wide2([attribute.values[at], attribute.values[at + 1]])
    }))
}

/// None outside; what has no area in texture space has none.
fn barycentrics([a, b, c]: &[DVec2; 3], uv: DVec2) -> Option<DVec3> {
    let (ab, ac, at) = (*b - *a, *c - *a, uv - *a);
    let area = ab.perp_dot(ac);
    let (y, z) = (at.perp_dot(ac) / area, ab.perp_dot(at) / area);
    let weights = DVec3::new(1.0 - y - z, y, z);
    if weights.is_nan() || weights.min_element() < -SLACK {
        return None;
    }
    let inside = weights.max(DVec3::ZERO);
    Some(inside / inside.element_sum())
}

fn wide2(uv: [f32; 2]) -> DVec2 {
    DVec2::from_array(uv.map(f64::from))
}
