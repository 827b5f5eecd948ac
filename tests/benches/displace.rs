//! The displace pass against a tuned native loop with the same taps, and both against memory bandwidth.
//!
//! 4 194 304 vertices, one 2048 x 2048 height map, four taps each, our own f32 filter. The two run in turn on
//! the same cores, so that a drifting clock meets both; the ratio of the medians is what counts.
//!
//! `cargo bench --profile dev --workspace --bench displace`

use std::{hint::black_box, sync::Arc, time::Instant};

use displace_glsl::{
    SHADERS,
    layout::geometry::{DisplaceParams, Layer, MapAxis},
};
use displace_server::{
    domain::cancel::{Cancel, NoProgress},
    vulkan::{Device, DeviceOptions, Stream},
};
use rayon::prelude::*;

const VERTICES: usize = 1 << 22;
const SIDE: usize = 2048;
const SCALE: f32 = 0.1;
const MIDLEVEL: f32 = 0.5;
const ROUNDS: usize = 9;

fn main() {
    let input = Input::new();
    let device = Device::open(&DeviceOptions::default()).expect("a Vulkan device");
    let mut native_out = vec![[0f32; 3]; VERTICES];
    let gpu = Gpu::new(&device, &input);
    let source = vec![1u8; VERTICES * 22];
    let mut copied = vec![0u8; VERTICES * 22];
    let (mut ours, mut native, mut copy) = (Vec::new(), Vec::new(), Vec::new());
    for _ in 0..ROUNDS {
        native.push(seconds(|| displace_native(&input, &mut native_out)));
        ours.push(seconds(|| gpu.run()));
        copy.push(seconds(|| memcpy(&source, &mut copied)));
    }
    let worst = worst_difference(&native_out, &gpu.positions.read().expect("reads"));
    let (ours, native, copy) = (median(ours), median(native), median(copy));
    println!("device                     {}", device.info().name);
    println!("vertices                   {VERTICES}");
    row("displace pass", ours);
    row("native loop, all cores", native);
    row("memcpy, all cores", copy);
    println!("throughput against native  {:8.2} x", native / ours);
    println!("share of memory bandwidth  {:8.2}", copy / ours);
    println!("largest difference         {worst:e}");
    assert!(worst < 1e-6, "the two loops compute different things");
}

/// Bytes read and written at least once: 16 + 16 in, 12 out; memcpy reads and writes 22 + 22.
fn row(name: &str, seconds: f64) {
    let gigabytes = (VERTICES * 44) as f64 / 1e9;
    let ns = seconds * 1e9 / VERTICES as f64;
    println!("{name:<26} {:8.2} ms  {ns:6.2} ns/vertex  {:6.2} GB/s", seconds * 1e3, gigabytes / seconds);
}

struct Input {
    position_u: Vec<[f32; 4]>,
    direction_v: Vec<[f32; 4]>,
    texels: Vec<f32>,
}

impl Input {
    fn new() -> Self {
        let side = VERTICES.isqrt();
        let uv = |i: usize| [(i % side) as f32 / side as f32, (i / side) as f32 / side as f32];
        let position_u = |i: usize| [uv(i)[0] * 2.0, uv(i)[1] * 2.0, 0.0, uv(i)[0]];
        let height = |i: usize| {
            let (x, y) = ((i % SIDE) as f32, (i / SIDE) as f32);
            let value = 0.5 + 0.25 * (x * 0.05).sin() + 0.25 * (y * 0.03).cos();
            f32::from((value * 65535.0) as u16) / 65535.0
        };
        Self {
            position_u: (0..VERTICES).into_par_iter().map(position_u).collect(),
            direction_v: (0..VERTICES).into_par_iter().map(|i| [0.0, 0.0, 1.0, uv(i)[1]]).collect(),
            texels: (0..SIDE * SIDE).into_par_iter().map(height).collect(),
        }
    }
}

struct Gpu {
    device: Arc<Device>,
    position_u: Stream,
    direction_v: Stream,
    texels: Stream,
    positions: Stream,
}

impl Gpu {
    fn new(device: &Arc<Device>, input: &Input) -> Self {
        let gpu = Self {
            device: device.clone(),
            position_u: Stream::from_slice(device, "base_position_u", &input.position_u).expect("fits"),
            direction_v: Stream::from_slice(device, "base_direction_v", &input.direction_v).expect("fits"),
            texels: Stream::of_texels(device, &input.texels).expect("fits"),
            positions: Stream::new(device, "positions", 12, VERTICES as u64).expect("fits"),
        };
        gpu.run();
        gpu
    }

    fn run(&self) {
        let params = DisplaceParams { count: VERTICES as u32, first: 0, accumulate: 0, layer: layer() };
        let streams = [
            ("base_position_u", &self.position_u),
            ("base_direction_v", &self.direction_v),
            ("texels", &self.texels),
            ("positions", &self.positions),
        ];
        let (cancel, progress) = (Cancel::default(), NoProgress);
        let mut recorder = self.device.recorder(&cancel, &progress);
        recorder.dispatch(&SHADERS.displace, VERTICES as u64, &params, &streams).expect("records");
        recorder.finish().expect("runs");
    }
}

/// A repeating map, sampled at texel centres.
fn layer() -> Layer {
    let n = SIDE as i32;
    let limit = 1 << 23;
    let inverse_period = 1.0 / n as f32;
    let axis = MapAxis { low: -limit, high: limit, period: n, top: n - 1, fold: i32::MAX, inverse_period };
    Layer {
        kind: 0,
        first: 0,
        row: SIDE as u32,
        scale: SCALE,
        midlevel: MIDLEVEL,
        texel_from_u: [SIDE as f32, 0.0, -0.5],
        texel_from_v: [0.0, SIDE as f32, -0.5],
        across: axis,
        down: axis,
    }
}

fn displace_native(input: &Input, out: &mut [[f32; 3]]) {
    const LOT: usize = 1 << 14;
    let lots = out.par_chunks_mut(LOT).zip(input.position_u.par_chunks(LOT)).zip(input.direction_v.par_chunks(LOT));
    let arch = pulp::Arch::new();
    lots.for_each(|((out, position_u), direction_v)| {
        arch.dispatch(Lot { position_u, direction_v, texels: &input.texels, out });
    });
}

struct Lot<'a> {
    position_u: &'a [[f32; 4]],
    direction_v: &'a [[f32; 4]],
    texels: &'a [f32],
    out: &'a mut [[f32; 3]],
}

impl pulp::WithSimd for Lot<'_> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: pulp::Simd>(self, _: S) {
        lot(self.position_u, self.direction_v, self.texels, self.out);
    }
}

/// Blocks of 16 vertices in arrays: where the processor has AVX2 and FMA, everything but the gathers becomes 8-wide.
/// No conversion saturates, no sum is checked and no index can be out of range, so nothing stands in the way.
#[inline(always)]
fn lot(position_u: &[[f32; 4]], direction_v: &[[f32; 4]], texels: &[f32], out: &mut [[f32; 3]]) {
    const WIDE: usize = 16;
    const MASK: u32 = SIDE as u32 - 1;
    let texels: &[f32; SIDE * SIDE] = texels.try_into().expect("the whole map");
    let integer = |whole: f32| (whole + 12_582_912.0).to_bits().wrapping_sub(0x4b40_0000);
    let blocks = out.chunks_exact_mut(WIDE).zip(position_u.chunks_exact(WIDE)).zip(direction_v.chunks_exact(WIDE));
    for ((out, p), d) in blocks {
        let (mut fx, mut fy) = ([0f32; WIDE], [0f32; WIDE]);
        let (mut i00, mut i10, mut i01, mut i11) = ([0u32; WIDE], [0u32; WIDE], [0u32; WIDE], [0u32; WIDE]);
        for k in 0..WIDE {
            let (x, y) = (p[k][3] * SIDE as f32 - 0.5, d[k][3] * SIDE as f32 - 0.5);
            let (x0, y0) = (x.floor(), y.floor());
            fx[k] = x - x0;
            fy[k] = y - y0;
            let (x0, y0) = (integer(x0), integer(y0));
            let (left, right) = (x0 & MASK, x0.wrapping_add(1) & MASK);
            let (top, bottom) = ((y0 & MASK) << SIDE.ilog2(), (y0.wrapping_add(1) & MASK) << SIDE.ilog2());
            i00[k] = top | left;
            i10[k] = top | right;
            i01[k] = bottom | left;
            i11[k] = bottom | right;
        }
        let mut height = [0f32; WIDE];
        for k in 0..WIDE {
            let texel = |i: u32| texels[i as usize & (SIDE * SIDE - 1)];
            let above = texel(i00[k]) * (1.0 - fx[k]) + texel(i10[k]) * fx[k];
            let below = texel(i01[k]) * (1.0 - fx[k]) + texel(i11[k]) * fx[k];
            height[k] = (above * (1.0 - fy[k]) + below * fy[k] - MIDLEVEL) * SCALE;
        }
        for k in 0..WIDE {
            out[k] = [p[k][0] + d[k][0] * height[k], p[k][1] + d[k][1] * height[k], p[k][2] + d[k][2] * height[k]];
        }
    }
}

fn memcpy(source: &[u8], target: &mut [u8]) {
    const LOT: usize = 1 << 20;
    target.par_chunks_mut(LOT).zip(source.par_chunks(LOT)).for_each(|(t, s)| t.copy_from_slice(s));
    black_box(target);
}

fn seconds(work: impl FnOnce()) -> f64 {
    let start = Instant::now();
    work();
    start.elapsed().as_secs_f64()
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

fn worst_difference(a: &[[f32; 3]], b: &[[f32; 3]]) -> f32 {
    let difference = |(a, b): (&[f32; 3], &[f32; 3])| (0..3).map(|k| (a[k] - b[k]).abs()).fold(0.0, f32::max);
    a.par_iter().zip(b).map(difference).reduce(|| 0.0, f32::max)
}
