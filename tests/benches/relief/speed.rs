//! Rays a second on the device and by plain code on all cores.

use std::{fmt::Write as _, sync::Arc, time::Instant};

use displace_glsl::{
    SHADERS,
    reference::relief::{Course, ReliefMap},
};
use displace_server::vulkan::Device;
use displace_tests::march::Marches;

use crate::{
    DEGREES,
    native::{self, Native, Ray},
    rays,
};

const SIDE: u32 = 512;
/// The shortest of so many counts; other processes only add to it.
const ROUNDS: usize = 5;
/// Ways of fewer lattice lines are walked cell by cell.
const SETTINGS: [f32; 4] = [0.0, 16.0, 32.0, 1e30];

/// A row for each map and angle, in millions of rays a second.
pub(crate) fn of(device: &Arc<Device>, maps: &[(String, ReliefMap)]) -> String {
    let mut table = String::from(
        "map,degrees,nodes,cells_below_16,cells_below_32,cells,native,ratio,relief,native_relief,relief_ratio\n",
    );
    for (name, map) in maps {
        for degrees in DEGREES {
            let line = format!("{name},{degrees},{}", row(device, map, &rays::side_by_side(SIDE, degrees)));
            println!("{line}");
            let _ = writeln!(table, "{line}");
        }
    }
    table
}

fn row(device: &Arc<Device>, map: &ReliefMap, courses: &[Course]) -> String {
    let map = ReliefMap { steps: 16, ..map.clone() };
    let (marches, native) = (Marches::new(device, &map, courses), Native::new(&map));
    let ends = |course: &Course| [course.nodes[0], course.nodes[1]].map(|node| node.truncate().as_vec3().to_array());
    let rays: Vec<Ray> = courses.iter().map(ends).collect();
    let mut ms = [f64::INFINITY; SETTINGS.len() + 3];
    for _ in 0..ROUNDS {
        let exact = SETTINGS.map(|setting| marches.run(&SHADERS.exact, setting).1);
        let others = [
            timed(|| native.run(native::exact, &rays).len()),
            marches.run(&SHADERS.relief, 0.0).1,
            timed(|| native.run(native::relief, &rays).len()),
        ];
        ms.iter_mut().zip(exact.into_iter().chain(others)).for_each(|(least, ms)| *least = least.min(ms));
    }
    check(&marches, &native, &rays);
    let rate = ms.map(|ms| f64::from(SIDE * SIDE) / 1e3 / ms);
    let best = rate[..SETTINGS.len()].iter().copied().fold(0.0, f64::max);
    let mut text: Vec<String> = rate.iter().map(|rate| format!("{rate:.2}")).collect();
    text.insert(SETTINGS.len() + 1, format!("{:.2}", best / rate[SETTINGS.len()]));
    text.push(format!("{:.2}", rate[SETTINGS.len() + 1] / rate[SETTINGS.len() + 2]));
    text.join(",")
}

/// Both march the same: but for a few that rounding decides, to a thousandth of the way.
fn check(marches: &Marches, native: &Native<'_>, rays: &[Ray]) {
    let (device, plain) = (marches.run(&SHADERS.exact, 0.0).0, native.run(native::exact, rays));
    let apart = device.iter().zip(plain).filter(|(a, b)| b.is_none_or(|b| (a.s - b).abs() > 1e-3)).count();
    assert!(apart * 1000 < rays.len(), "{apart} of {} rays differ", rays.len());
}

fn timed(work: impl FnOnce() -> usize) -> f64 {
    let start = Instant::now();
    std::hint::black_box(work());
    start.elapsed().as_secs_f64() * 1e3
}
