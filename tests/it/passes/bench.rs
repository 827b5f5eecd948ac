//! Speed of the displacement pass beside a native loop with the same taps. Run it alone:
//! `cargo test -p displace-tests --test it passes::bench -- --ignored --nocapture`

use std::time::Instant;

use displace_glsl::{SHADERS, layout::geometry::DisplaceParams};
use displace_server::{render::passes, vulkan::Stream};
use displace_tests::meshes;
use rayon::prelude::*;

use super::*;

/// Processor time of this process so far, all threads.
fn processor_seconds() -> f64 {
    let stat = std::fs::read_to_string("/proc/self/stat").expect("Linux");
    let fields: Vec<&str> = stat[stat.rfind(')').expect("a name") + 2..].split(' ').collect();
    (fields[11].parse::<f64>().expect("ticks") + fields[12].parse::<f64>().expect("ticks")) / 100.0
}

/// (wall, processor) seconds of the fastest of some runs.
fn fastest(rounds: u32, mut work: impl FnMut()) -> (f64, f64) {
    let one = |_| {
        let (start, before) = (Instant::now(), processor_seconds());
        work();
        (start.elapsed().as_secs_f64(), processor_seconds() - before)
    };
    (0..rounds).map(one).fold((f64::MAX, f64::MAX), |best, now| (best.0.min(now.0), best.1.min(now.1)))
}

fn device() -> VulkanExecutor {
    VulkanExecutor::with_device(Device::open(&DeviceOptions::default()).expect("a device"))
}

#[test]
#[ignore = "a measurement, run by hand"]
fn a_plane_displaced() {
    let executor = device();
    let mesh = welded(&meshes::plane(1));
    let detail = height(noise([2048, 2048], 1), 0.1);
    for level in [9, 10] {
        let mut last = Vec::new();
        let (wall, processor) = fastest(3, || {
            let job = JobContext { cancel: &Cancel::default(), progress: &NoProgress };
            let result = executor.displace(&job, &planned(&mesh, &geometry(level)), &mesh, &[Some(detail.clone())]);
            last = result.expect("runs").1;
        });
        println!("level {level}: wall {wall:.3} s, processor {processor:.3} s");
        last.iter().for_each(|time| println!("    {:20} {:8.2} ms", time.name, time.ms));
    }
}

/// The bar: 4 Mi vertices, a 2048^2 map, the same taps in native code.
#[test]
#[ignore = "a measurement, run by hand"]
fn displacement_against_a_native_loop() {
    const COUNT: usize = 1 << 22;
    let executor = device();
    let map = noise([2048, 2048], 1);
    let mesh = welded(&meshes::plane(1));
    let tables =
        passes::tables::build(&planned(&mesh, &geometry(0)), &mesh, &[Some(height(map.clone(), 0.1))]).expect("tables");
    // A sheet in row order, as subdivision makes it along its rows.
    let at = |i: usize| ((i % 2048) as f32 / 2047.0, (i / 2048) as f32 / 2047.0);
    let p: Vec<[f32; 4]> = (0..COUNT).map(|i| [at(i).0, 0.0, at(i).1, at(i).0]).collect();
    let d: Vec<[f32; 4]> = (0..COUNT).map(|i| [0.0, 1.0, 0.0, at(i).1]).collect();
    let mut out = vec![[0.0f32; 3]; COUNT];
    let upload = |name, data: &[[f32; 4]]| Stream::from_slice(executor.device(), name, data).expect("fits");
    let (position_u, direction_v) = (upload("p", &p), upload("d", &d));
    let texels = Stream::of_texels(executor.device(), &map.texels).expect("fits");
    let positions = Stream::new(executor.device(), "positions", 12, COUNT as u64).expect("fits");
    let params = DisplaceParams { count: COUNT as u32, first: 0, accumulate: 0, layer: tables.layers[0] };
    let dispatch = || {
        let (cancel, progress) = (Cancel::default(), NoProgress);
        let mut recorder = executor.device().recorder(&cancel, &progress);
        let streams = [
            ("base_position_u", &position_u),
            ("base_direction_v", &direction_v),
            ("texels", &texels),
            ("positions", &positions),
        ];
        for _ in 0..8 {
            recorder.dispatch(&SHADERS.displace, COUNT as u64, &params, &streams).expect("records");
        }
        recorder.finish().expect("runs");
    };
    dispatch();
    for _ in 0..3 {
        let ours = fastest(3, dispatch);
        let theirs = fastest(3, || (0..8).for_each(|_| native(&p, &d, &map.texels, 2048, &mut out)));
        println!(
            "device {:.1} ms ({:.1} ms of processor), native {:.1} ms ({:.1}): {:.2} of its throughput",
            ours.0 * 125.0,
            ours.1 * 125.0,
            theirs.0 * 125.0,
            theirs.1 * 125.0,
            theirs.1 / ours.1
        );
    }
    let device: Vec<[f32; 3]> = positions.read().expect("reads");
    assert!(worst(&device, &out) < 1e-5);
}

/// The same arithmetic as `displace.comp` for a repeating map whose sides are powers of two.
fn native(base_p: &[[f32; 4]], base_d: &[[f32; 4]], texels: &[f32], size: u32, out: &mut [[f32; 3]]) {
    let mask = size as i32 - 1;
    let chunk = 1 << 14;
    out.par_chunks_mut(chunk).zip(base_p.par_chunks(chunk)).zip(base_d.par_chunks(chunk)).for_each(|((out, p), d)| {
        for ((out, p), d) in out.iter_mut().zip(p).zip(d) {
            let (x, y) = (p[3] * size as f32 - 0.5, d[3] * size as f32 - 0.5);
            let (cx, cy) = (x.floor(), y.floor());
            let (fx, fy) = (x - cx, y - cy);
            let (x0, y0) = (cx as i32, cy as i32);
            let at = |dx: i32, dy: i32| texels[(((y0 + dy) & mask) * size as i32 + ((x0 + dx) & mask)) as usize];
            let above = at(0, 0) * (1.0 - fx) + at(1, 0) * fx;
            let below = at(0, 1) * (1.0 - fx) + at(1, 1) * fx;
            let h = (above * (1.0 - fy) + below * fy) * 0.1;
            *out = [p[0] + d[0] * h, p[1] + d[1] * h, p[2] + d[2] * h];
        }
    });
}
