//! Single passes of the rasteriser against their f64 twins.

use displace_glsl::{
    SHADERS,
    layout::raster::{Fragment, MipParams, Part, SurfaceParams, SurfacePoint},
    reference::{mip::Level, surface::barycentrics, transform::homogeneous},
};
use displace_server::{
    domain::cancel::{Cancel, NoProgress},
    vulkan::{Recorder, Stream},
};
use glam::{DVec2, DVec3};
use rand::{RngExt as _, SeedableRng, rngs::StdRng};

use super::device;

pub(super) fn run(record: impl FnOnce(&mut Recorder<'_>)) {
    let cancel = Cancel::default();
    let mut recorder = device().recorder(&cancel, &NoProgress);
    record(&mut recorder);
    recorder.finish().expect("runs");
}

#[test]
fn mip_levels_are_the_box_filter_of_the_level_above() {
    for (width, height) in [(8, 8), (7, 5), (1, 9), (13, 1), (6, 3), (257, 129)] {
        let mut random = StdRng::seed_from_u64(width as u64);
        let texels: Vec<[f64; 4]> =
            (0..width * height).map(|_| [0; 4].map(|_| f64::from(random.random_range(0.0f32..1.0)))).collect();
        let level = Level { width, height, texels, alpha_scale: 1.0 };
        let (found, expected) = (coarser(&level), level.coarser().texels);
        for (found, expected) in found.iter().zip(&expected) {
            for (found, expected) in found.iter().zip(expected) {
                // Nine products and sums of f32 below 1.
                assert!(
                    (found - expected).abs() <= 9.0 * f64::from(f32::EPSILON),
                    "{width} x {height}: {found} for {expected}"
                );
            }
        }
    }
}

fn coarser(level: &Level) -> Vec<[f64; 4]> {
    let target = [(level.width / 2).max(1), (level.height / 2).max(1)];
    let pairs = (level.texels.len()).div_ceil(2);
    let target_pairs = (target[0] * target[1]).div_ceil(2);
    let mut values: Vec<f32> = level.texels.iter().flatten().map(|&x| x as f32).collect();
    values.resize((pairs + target_pairs) * 8, 0.0);
    let words: Vec<[f32; 8]> = bytemuck::cast_slice(&values).to_vec();
    let texels = Stream::from_slice(device(), "texels", &words).expect("fits");
    let params = MipParams {
        count: target_pairs as u32,
        source_first: 0,
        target_first: pairs as u32 * 2,
        source_size: [level.width as u32, level.height as u32],
        target_size: target.map(|side| side as u32),
    };
    let bound = [("texels", &texels)];
    run(|recorder| recorder.dispatch(&SHADERS.mip, target_pairs as u64, &params, &bound).expect("records"));
    let values: Vec<f32> = texels.read_range(pairs as u64..(pairs + target_pairs) as u64).expect("reads");
    let texels = values.chunks(4).map(|t| std::array::from_fn(|k| f64::from(t[k])));
    texels.take(target[0] * target[1]).collect()
}

/// A perspective triangle in a 512 pixel image, its uvs, and points on it.
struct Probe {
    rows: Vec<[f32; 4]>,
    positions: [[f32; 3]; 3],
    uvs: [[f32; 2]; 3],
    at_px: Vec<[f32; 2]>,
}

impl Probe {
    fn new() -> Self {
        let mut rows = vec![[0f32; 4]; 10];
        // Pixels of a camera at the origin that looks along -z with a field of view of 90 degrees.
        rows[0] = [256.0, 0.0, -256.0, 0.0];
        rows[1] = [0.0, -256.0, -256.0, 0.0];
        rows[2] = [0.0, 0.0, 0.0, 0.01];
        rows[3] = [0.0, 0.0, -1.0, 0.0];
        for k in 0..3 {
            rows[4 + k][k] = 1.0;
            rows[7 + k][k] = 1.0;
        }
        let positions = [[-1.5, -1.0, -2.0], [2.5, -1.2, -4.0], [0.2, 3.0, -5.0]];
        let uvs = [[0.1, 0.2], [3.9, 0.4], [1.5, 2.7]];
        let at_px = (0..100).map(|k| [200.0 + (k % 10) as f32 * 9.3, 200.0 + (k / 10) as f32 * 9.7]).collect();
        Self { rows, positions, uvs, at_px }
    }

    /// uv at a point of the image, and whether the point is on the triangle.
    fn uv(&self, at: DVec2) -> (DVec2, bool) {
        let corners = self.positions.map(|p| {
            let h = homogeneous(&self.rows, p);
            DVec3::new(h.x - at.x * h.w, h.y - at.y * h.w, h.w)
        });
        let b = barycentrics(corners);
        let uv = (0..3).map(|k| DVec2::from_array(self.uvs[k].map(f64::from)) * b.at[k]).sum();
        (uv, b.at.min_element() > 0.0)
    }

    fn points(&self) -> Vec<SurfacePoint> {
        let stream = |name: &str, len: usize, bytes: u32| Stream::new(device(), name, bytes, len as u64).expect("fits");
        let count = self.at_px.len();
        let fragments: Vec<_> = self.at_px.iter().map(|&at_px| Fragment { id: 0, at_px, extra: 4 }).collect();
        let points = stream("points", count, size_of::<SurfacePoint>() as u32);
        let bound = [
            ("fragments", &Stream::from_slice(device(), "fragments", &fragments).expect("fits")),
            ("triangles", &Stream::from_slice(device(), "triangles", &[[0u32, 1, 2]]).expect("fits")),
            ("parts", &Stream::from_slice(device(), "parts", &[Part { faces: 1, ..Part::default() }]).expect("fits")),
            ("instance_rows", &Stream::from_slice(device(), "rows", &self.rows).expect("fits")),
            ("positions", &Stream::from_slice(device(), "positions", &self.positions).expect("fits")),
            ("normals", &Stream::from_slice(device(), "normals", &[[0f32, 0.0, 1.0]; 3]).expect("fits")),
            ("points", &points),
        ];
        let params = SurfaceParams { count: count as u32, part_last: 0 };
        run(|recorder| recorder.dispatch(&SHADERS.surface, count as u64, &params, &bound).expect("records"));
        points.read().expect("reads")
    }
}

#[test]
fn derivatives_on_the_device_agree_with_finite_differences() {
    let probe = Probe::new();
    let mut compared = 0;
    for (point, at) in probe.points().iter().zip(&probe.at_px) {
        let at = DVec2::from_array(at.map(f64::from));
        let step = 1e-4;
        let (uv, inside) = probe.uv(at);
        if !inside {
            continue;
        }
        compared += 1;
        let difference = |axis: DVec2| (probe.uv(at + axis * step).0 - probe.uv(at - axis * step).0) / (2.0 * step);
        let pairs = [(point.at, uv), (point.at_dx, difference(DVec2::X)), (point.at_dy, difference(DVec2::Y))];
        for (weights, expected) in pairs {
            let found: DVec2 =
                (0..3).map(|k| DVec2::from_array(probe.uvs[k].map(f64::from)) * f64::from(weights[k])).sum();
            let off = (found - expected).length();
            assert!(off <= 2e-5 * (1.0 + expected.length()), "at {at}: {found:?} for {expected}");
        }
    }
    assert!(compared > 30, "{compared} points lie on the triangle");
}
