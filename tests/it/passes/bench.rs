//! Speed of the displacement pass beside a native loop with the same taps. Run it alone:
//! `cargo test -p displace-tests --test it passes::bench -- --ignored --nocapture`

use std::time::Instant;

use displace_tests::meshes;
use rayon::prelude::*;

use super::*;

#[test]
#[ignore = "a measurement, run by hand"]
fn displacing_a_plane_takes() {
    let options = DeviceOptions::default();
    let executor = VulkanExecutor::with_device(Device::open(&options).expect("a device"));
    let mesh = welded(&meshes::plane(1));
    let detail = height(noise([2048, 2048], 1), 0.1);
    for level in [9, 10] {
        for round in 0..3 {
            let start = Instant::now();
            let job = JobContext { cancel: &Cancel::default(), progress: &NoProgress };
            let (surface, times) =
                executor.displace(&job, &planned(&mesh, &geometry(level)), &mesh, &[Some(detail.clone())]).expect("runs");
            println!("level {level} round {round}: {} triangles in {:?}", surface.triangles.len(), start.elapsed());
            for time in times {
                println!("    {:20} {:8.2} ms", time.name, time.ms);
            }
        }
    }
}

/// The same arithmetic as `displace.comp` for a repeating map whose sides are powers of two.
pub(super) fn native(base_p: &[[f32; 4]], base_d: &[[f32; 4]], texels: &[f32], size: u32, out: &mut [[f32; 3]]) {
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
