//! Images by the f64 oracle: the same tables, every triangle against every sample its box meets, no classes,
//! no slabs. Coverage is decided in 128-bit integers. A plan with rays is the image oracle's.

mod bump;
mod count;
mod layers;
mod light;
mod place;
mod preimage;
mod projected;
mod relief;
mod shading;
mod shadow_map;
mod textures;

use displace_glsl::{
    layout::raster::{
        INSTANCE_ROWS, MATERIAL_STOCHASTIC, PART_BLENDED, PART_DOUBLE_SIDED, PART_MASKED, PART_MIRRORED, PART_RELIEF,
        Part,
    },
    reference::{
        clip::clip,
        composite::Layered,
        downsample::downsample,
        masked::threshold,
        raster::{SAMPLES, ScreenTriangle},
        relief::March,
        transform::{Snapped, homogeneous, needs_clip, snapped},
    },
};
use glam::DVec3;
use rayon::prelude::{IntoParallelIterator, IntoParallelRefIterator, ParallelIterator};

use crate::{
    domain::{
        Result,
        image::{ImagePlan, ImageSet, MarchCounters, RenderMesh, RenderScene},
        report::PassTime,
        request::{Rays, Shadows},
    },
    oracle::{
        self,
        image::{Exposure, OracleScene},
    },
};

use super::{
    JobContext,
    image::{
        empty_images,
        tables::{self, Tables},
    },
    reflection::{Reflection, reflections},
};

use layers::{NOTHING, Samples, Seen};
use light::LightModel;
use place::Place;
pub use preimage::preimage;
use shading::{Hit, Shader};

/// Pixel rows whose triangles are listed together.
const BAND_ROWS: u32 = 16;

pub fn render(job: &JobContext<'_>, plan: &ImagePlan, scene: &RenderScene) -> Result<(ImageSet, Vec<PassTime>)> {
    let start = std::time::Instant::now();
    let images = match plan.rays {
        Some(rays) => traced(job, plan, rays, scene)?,
        None => rasterised(job, plan, scene)?,
    };
    let ms = start.elapsed().as_secs_f64() * 1e3;
    Ok((images, vec![PassTime { name: "image".into(), ms, bytes: 0 }]))
}

fn traced(job: &JobContext<'_>, plan: &ImagePlan, rays: Rays, scene: &RenderScene) -> Result<ImageSet> {
    tables::check(scene)?;
    let shadows = rays.shadows != Shadows::None;
    let exposure = Exposure { width: plan.width, height: plan.height, samples: rays.samples, shadows };
    oracle::image::render(&OracleScene::from(scene), &exposure, job.cancel, job.progress)
}

fn rasterised(job: &JobContext<'_>, plan: &ImagePlan, scene: &RenderScene) -> Result<ImageSet> {
    let (side, fine) = (plan.supersample, plan.fine());
    let reflections = reflections(scene, |plan, scene| rasterised(job, plan, scene))?;
    let oracle = Oracle::new(&fine, scene, &reflections)?;
    let triangles = oracle.screen_triangles();
    job.cancel.check()?;
    let bands = bands(&triangles, fine.height);
    let fine_row = |y: u32| oracle.row(y, &triangles, &bands[(y / BAND_ROWS) as usize]);
    let rows: Vec<Vec<Pixel>> = (0..plan.height)
        .into_par_iter()
        .map(|y| {
            job.cancel.check()?;
            let rows: Vec<Vec<Pixel>> = (y * side..(y + 1) * side).map(fine_row).collect();
            Ok(averaged(rows, side as usize))
        })
        .collect::<Result<_>>()?;
    let mut images = empty_images(plan, scene);
    images.counters = oracle.shader.relief.is_shown().then(MarchCounters::default);
    rows.into_iter().flatten().enumerate().for_each(|(i, pixel)| pixel.store(i, &mut images));
    job.progress.pass("image", 1, 1);
    Ok(images)
}

/// A row from the `side` rows of a finer image: mean colours, all that marches took, and what is seen right below the
/// middle of each square.
fn averaged(mut rows: Vec<Vec<Pixel>>, side: usize) -> Vec<Pixel> {
    let layers_left_out = rows.iter().flatten().any(|pixel| pixel.layers_left_out);
    let marches = count::of_squares(&rows, side);
    let colors: Vec<Vec<DVec3>> = rows.iter().map(|row| row.iter().map(|pixel| pixel.color).collect()).collect();
    let middle = rows.swap_remove(side / 2).into_iter().skip(side / 2).step_by(side);
    let averaged = middle.zip(downsample(&colors, side)).zip(marches);
    averaged.map(|((pixel, color), marches)| Pixel { color, marches, layers_left_out, ..pixel }).collect()
}

/// A triangle, or a piece of one, on the screen.
struct Piece {
    id: u32,
    triangle: ScreenTriangle,
}

/// Pieces whose boxes meet each band of rows.
fn bands(pieces: &[Piece], height: u32) -> Vec<Vec<u32>> {
    let mut bands = vec![Vec::new(); height.div_ceil(BAND_ROWS) as usize];
    let last = bands.len() as i64 - 1;
    for (index, piece) in pieces.iter().enumerate() {
        let [low, high] = piece.triangle.bounds().map(|corner| corner[1].div_euclid(256 * i64::from(BAND_ROWS)));
        for band in low.max(0)..=high.min(last) {
            bands[band as usize].push(index as u32);
        }
    }
    bands
}

/// What the images hold of one pixel.
struct Pixel {
    color: DVec3,
    hit: Option<(u32, Hit)>,
    depth: f64,
    /// How often its samples are covered, and how many triangles they show.
    counts: [u32; 2],
    marches: MarchCounters,
    layers_left_out: bool,
}

impl Pixel {
    fn store(self, i: usize, images: &mut ImageSet) {
        images.layers_left_out |= self.layers_left_out;
        set(&mut images.overdraw, i, self.counts[0]);
        set(&mut images.samples, i, self.counts[1]);
        set(&mut images.cost, i, count::cost(&self.marches));
        images.counters.iter_mut().for_each(|all| all.extend([self.marches]));
        images.color[i] = self.color.as_vec3().extend(1.0).to_array();
        let Some((id, hit)) = self.hit else { return };
        set(&mut images.depth, i, self.depth as f32);
        set(&mut images.normal, i, hit.look.normal.as_vec3().to_array());
        set(&mut images.position, i, hit.position.as_vec3().to_array());
        set(&mut images.uv, i, hit.uv.as_vec2().to_array());
        set(&mut images.triangle, i, id);
    }
}

fn set<T>(image: &mut Option<Vec<T>>, i: usize, value: T) {
    if let Some(image) = image {
        image[i] = value;
    }
}

struct Oracle<'a> {
    scene: &'a RenderScene,
    tables: Tables,
    width: u32,
    shader: Shader,
    light: LightModel,
}

impl<'a> Oracle<'a> {
    fn new(plan: &ImagePlan, scene: &'a RenderScene, reflections: &[Reflection]) -> Result<Self> {
        let tables = Tables::new(plan, scene)?;
        let light = LightModel::new(plan, scene, &tables, reflections)?;
        Ok(Self { scene, tables, width: plan.width, shader: Shader::new(scene)?, light })
    }

    fn rows(&self, part: &Part) -> &[[f32; 4]] {
        &self.tables.instance_rows[part.instance as usize * INSTANCE_ROWS..][..INSTANCE_ROWS]
    }

    fn mesh(&self, part: &Part) -> &RenderMesh {
        &self.scene.meshes[self.scene.instances[part.instance as usize].mesh]
    }

    /// Number of a triangle in its mesh.
    fn triangle(&self, part: &Part, id: u32) -> usize {
        let mesh = self.scene.instances[part.instance as usize].mesh;
        let base = self.tables.meshes[mesh].triangle_base as u32;
        (part.triangle_base - base + (id - part.first_triangle)) as usize
    }

    /// Vertices of a triangle, as its mesh numbers them.
    fn vertices(&self, part: &Part, id: u32) -> [usize; 3] {
        self.mesh(part).triangles[self.triangle(part, id)].map(|v| v as usize)
    }

    fn part(&self, id: u32) -> &Part {
        let parts = &self.tables.parts;
        &parts[parts.partition_point(|part| part.first_triangle <= id) - 1]
    }

    fn screen_triangles(&self) -> Vec<Piece> {
        let parts = &self.tables.parts;
        let total = self.tables.batches.last().map_or(0, |batch| batch.triangles.end) as u32;
        let end = |k: usize| parts.get(k + 1).map_or(total, |next| next.first_triangle);
        let ranges: Vec<_> = parts.iter().enumerate().map(|(k, part)| (part, part.first_triangle..end(k))).collect();
        let of_part = |(part, ids): &(&Part, std::ops::Range<u32>)| {
            ids.clone().into_par_iter().flat_map_iter(|id| self.pieces(part, id)).collect::<Vec<_>>()
        };
        ranges.par_iter().flat_map_iter(of_part).collect()
    }

    fn pieces(&self, part: &Part, id: u32) -> Vec<Piece> {
        let (mesh, rows) = (self.mesh(part), self.rows(part));
        let corners = self.vertices(part, id).map(|v| homogeneous(rows, mesh.positions[v]));
        if corners.iter().any(|h| !h.is_finite()) {
            return Vec::new();
        }
        let whole = !corners.iter().any(|&h| needs_clip(h));
        let polygon = if whole { corners.to_vec() } else { clip(corners) };
        let outline: Vec<Snapped> = polygon.into_iter().map(snapped).collect();
        let fans = (2..outline.len()).filter_map(|k| ScreenTriangle::new(outline[0], outline[k - 1], outline[k]));
        fans.filter(|t| faces_viewer(t, part.flags)).map(|triangle| Piece { id, triangle }).collect()
    }

    fn row(&self, y: u32, pieces: &[Piece], band: &[u32]) -> Vec<Pixel> {
        let mut seen = vec![Samples::default(); self.width as usize];
        for &index in band {
            self.cover_row(y, &pieces[index as usize], &mut seen);
        }
        seen.iter().enumerate().map(|(x, samples)| self.pixel(x as u32, y, samples)).collect()
    }

    fn cover_row(&self, y: u32, piece: &Piece, seen: &mut [Samples]) {
        let is_blended = self.part(piece.id).flags & PART_BLENDED != 0;
        let [low, high] = piece.triangle.bounds();
        let first = low[0].div_euclid(256).max(0);
        let last = high[0].div_euclid(256).min(i64::from(self.width) - 1);
        for x in first..=last {
            for (s, offset) in SAMPLES.iter().enumerate() {
                let at = [x * 256 + offset[0], i64::from(y) * 256 + offset[1]];
                if !piece.triangle.covers(at) {
                    continue;
                }
                let (id, known) = (piece.id, &mut seen[x as usize]);
                known.covered += 1;
                let place = [x as u32, y];
                let (depth, march) = self.depth(id, place, s, piece.triangle.depth_at(at));
                known.marches.extend(march.as_ref().map(count::one));
                let Some(depth) = depth else { continue };
                let new = Seen { depth, id };
                if is_blended {
                    known.blended[s].push(new);
                } else if new.is_before(&known.solid[s]) && self.is_kept(id, place, s) {
                    known.solid[s] = new;
                }
            }
        }
    }

    /// What sample `s` of a pixel sees of a triangle; of relief what it strikes, if anything.
    fn depth(&self, id: u32, pixel: [u32; 2], s: usize, base: f64) -> (Option<f64>, Option<March>) {
        if !self.shader.relief.is_shown() {
            return (Some(base), None);
        }
        let part = self.part(id);
        self.shader.depth(&self.place(part, id), of_sample(pixel, s), base)
    }

    /// By sample `s` of a pixel, before depth is decided.
    fn is_kept(&self, id: u32, pixel: [u32; 2], s: usize) -> bool {
        let part = self.part(id);
        let material = &self.tables.materials[part.material as usize];
        if part.flags & PART_MASKED == 0 || material.alpha_cutoff <= 0.0 {
            return true;
        }
        let by_chance = material.flags & MATERIAL_STOCHASTIC != 0;
        let cutoff = if by_chance { threshold(pixel, s as u32, id) } else { f64::from(material.alpha_cutoff) };
        self.hit(id, of_sample(pixel, s)).look.base.w >= cutoff
    }

    fn pixel(&self, x: u32, y: u32, samples: &Samples) -> Pixel {
        let (layers, layers_left_out) = samples.layers();
        let (mut seen, mut shown, mut marches) = (Layered::default(), [NOTHING; 4], samples.marches);
        for (ids, is_solid) in layers.iter().map(|ids| (ids, false)).chain([(&samples.solid(), true)]) {
            for (id, covered) in self.distinct(ids) {
                let hit = self.hit_of_samples(id, [x, y], &covered);
                marches.extend(hit.march.as_ref().map(count::one));
                let alpha = if is_solid { 1.0 } else { hit.look.base.w.clamp(0.0, 1.0) };
                seen.add(&covered, self.radiance(&hit), alpha);
                for s in covered {
                    if alpha >= 0.5 && shown[s] == NOTHING {
                        shown[s] = id;
                    }
                }
            }
        }
        let is_open = seen.transmittance.iter().any(|t| *t > 0.0);
        let color = seen.before(if is_open { self.light.backdrop(x, y) } else { DVec3::ZERO });
        let hit = self.shown(&shown, [x, y]);
        let depth = hit.as_ref().map_or(f64::INFINITY, |(_, hit)| self.light.depth(hit.position));
        let counts = [samples.covered, self.distinct(&shown).len() as u32];
        Pixel { color, hit, depth, counts, marches, layers_left_out }
    }

    /// What the further outputs show: the triangle of most samples, unless more see none.
    fn shown(&self, ids: &[u32; 4], pixel: [u32; 2]) -> Option<(u32, Hit)> {
        if self.scene.aovs.is_empty() {
            return None;
        }
        let empty = ids.iter().filter(|id| **id == NOTHING).count();
        let all = |id: u32| ids.iter().filter(|other| **other == id).count();
        let more = |best: Option<(u32, Vec<usize>)>, next: (u32, Vec<usize>)| {
            if best.as_ref().is_none_or(|best| all(next.0) > all(best.0)) { Some(next) } else { best }
        };
        let (id, covered) = self.distinct(ids).into_iter().fold(None, more).filter(|(id, _)| all(*id) >= empty)?;
        Some((id, self.hit_of_samples(id, pixel, &covered)))
    }

    fn distinct(&self, ids: &[u32; 4]) -> Vec<(u32, Vec<usize>)> {
        layers::distinct(ids, |id| self.part(id).flags & PART_RELIEF != 0)
    }

    fn radiance(&self, hit: &Hit) -> DVec3 {
        self.light.radiance(&self.tables.lights, hit, |id, weights, direction| {
            self.is_opaque_at(id, weights, (hit, direction))
        })
    }

    /// At the centroid of the samples of a pixel that the triangle covers.
    fn hit_of_samples(&self, id: u32, pixel: [u32; 2], covered: &[usize]) -> Hit {
        let centre = |axis: usize| covered.iter().map(|&s| SAMPLES[s][axis]).sum::<i64>() as f64;
        let scale = 1.0 / (256.0 * covered.len() as f64);
        self.hit(id, [0, 1].map(|axis| f64::from(pixel[axis]) + centre(axis) * scale))
    }

    fn hit(&self, id: u32, at_px: [f64; 2]) -> Hit {
        let part = self.part(id);
        let material = part.material as usize;
        let (source, factors) = (&self.scene.materials[material], &self.tables.materials[material]);
        self.shader.hit(&self.place(part, id), source, factors, &self.tables.bump, at_px)
    }

    fn place<'p>(&'p self, part: &'p Part, id: u32) -> Place<'p> {
        Place {
            part,
            mesh: self.mesh(part),
            rows: self.rows(part),
            triangle: self.triangle(part, id),
            uv_channels: self.scene.uv_channels as usize,
        }
    }

    /// Whether a triangle stops light there that a place would get along a direction.
    fn is_opaque_at(&self, id: u32, weights: DVec3, (hit, direction): (&Hit, DVec3)) -> bool {
        let part = self.part(id);
        if part.flags & PART_RELIEF != 0 && self.shader.relief.is_left(&self.place(part, id), weights, (hit, direction))
        {
            return false;
        }
        if part.flags & (PART_MASKED | PART_BLENDED) == 0 {
            return true;
        }
        let material = &self.scene.materials[part.material as usize];
        let cutoff = f64::from(self.tables.materials[part.material as usize].alpha_cutoff);
        self.shader.alpha(&self.place(part, id), material, weights) >= cutoff
    }
}

/// Where sample `s` of a pixel is on the image.
fn of_sample(pixel: [u32; 2], s: usize) -> [f64; 2] {
    [0, 1].map(|axis| f64::from(pixel[axis]) + SAMPLES[s][axis] as f64 / 256.0)
}

fn faces_viewer(triangle: &ScreenTriangle, flags: u32) -> bool {
    flags & PART_DOUBLE_SIDED != 0 || triangle.turned != (flags & PART_MIRRORED != 0)
}
