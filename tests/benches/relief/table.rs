//! What methods get wrong and what they read.

use std::{fmt::Write as _, sync::Arc};

use displace_glsl::{
    methods::{METHODS, Marcher, Needs},
    reference::relief::ReliefMap,
};
use displace_server::vulkan::Device;
use displace_tests::march::{Marches, cones, place};

use crate::{DEGREES, rays};

const RAYS: u32 = 20_000;
const SIDE: u32 = 512;
/// Even steps, and as many as the angle asks for.
const STEPS: [u32; 2] = [16, 0];
const ROUNDS: usize = 3;

/// A row for each map, angle, method and number of steps, where it takes even ones.
pub(crate) fn of(device: &Arc<Device>, maps: &[(String, ReliefMap)]) -> String {
    let mut table = String::from("map,degrees,method,steps_asked,off_percent,fetches,steps,capped,ms_per_million\n");
    for (name, map) in maps {
        let map = ReliefMap { cones: cones(device, &map.level), ..map.clone() };
        for degrees in DEGREES {
            for row in METHODS {
                let Some(marcher) = &row.marcher else { continue };
                let stepping = marcher.finds_depth && marcher.needs != Needs::Bounds;
                for steps in STEPS.into_iter().take(if stepping { 2 } else { 1 }) {
                    let found = measured(device, &ReliefMap { steps, ..map.clone() }, marcher, degrees);
                    let asked = if stepping { steps.to_string() } else { String::new() };
                    let line = format!("{name},{degrees},{},{asked},{found}", row.name);
                    println!("{line}");
                    let _ = writeln!(table, "{line}");
                }
            }
        }
    }
    table
}

fn measured(device: &Arc<Device>, map: &ReliefMap, marcher: &Marcher, degrees: f64) -> String {
    let courses = rays::random(RAYS, degrees);
    let met = rays::met(&map.level, &courses);
    let (found, _) = Marches::new(device, map, &courses).run(marcher.shader, marcher.setting);
    let off = found.iter().zip(&met).filter(|(found, met)| found.s < 0.0 || place(found).distance(**met) > 0.5).count();
    let mean = |of: fn(&displace_glsl::layout::relief::March) -> u32| {
        found.iter().map(|found| f64::from(of(found))).sum::<f64>() / f64::from(RAYS)
    };
    let capped: u32 = found.iter().map(|found| found.capped).sum();
    let marches = Marches::new(device, map, &rays::side_by_side(SIDE, degrees));
    let ms = (0..ROUNDS).map(|_| marches.run(marcher.shader, marcher.setting).1).fold(f64::INFINITY, f64::min);
    let share = 100.0 * off as f64 / f64::from(RAYS);
    let per_million = ms * 1e6 / f64::from(SIDE * SIDE);
    format!("{share:.2},{:.1},{:.1},{capped},{per_million:.0}", mean(|m| m.fetches), mean(|m| m.steps))
}
