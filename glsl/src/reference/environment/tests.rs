//! Lookups and irradiance against light that is known in closed form.

use super::*;

fn map(width: usize, height: usize, light: impl Fn(DVec3) -> DVec3) -> Level {
    let at = |i: usize| [(i % width) as f64 + 0.5, (i / width) as f64 + 0.5];
    let shown = |[x, y]: [f64; 2]| light(direction(x / width as f64, y / height as f64));
    let texels = (0..width * height).map(|i| shown(at(i)).extend(1.0).to_array()).collect();
    Level { width, height, texels, alpha_scale: 1.0 }
}

fn irradiance(level: &Level) -> Level {
    let texels: Vec<[f32; 3]> = level.texels.iter().map(|t| [t[0] as f32, t[1] as f32, t[2] as f32]).collect();
    irradiance_over_pi(level.width, &texels)
}

fn directions() -> impl Iterator<Item = DVec3> {
    (0..500).map(|i| {
        let z = 1.0 - f64::from(i) / 250.0;
        let (sine, cosine) = (f64::from(i) * 2.399_963).sin_cos();
        DVec3::new((1.0 - z * z).sqrt() * cosine, z, (1.0 - z * z).sqrt() * sine)
    })
}

#[test]
fn the_middle_of_a_map_is_x_with_z_to_its_right_and_y_above() {
    let near = |found: [f64; 2], expected: [f64; 2]| (0..2).all(|k| (found[k] - expected[k]).abs() < 1e-12);
    assert!(near(place(DVec3::X), [0.5, 0.5]) && near(place(DVec3::Z * 3.0), [0.75, 0.5]));
    assert!(near(place(-DVec3::Z), [0.25, 0.5]) && place(DVec3::Y)[1] == 0.0 && place(-DVec3::Y)[1] == 1.0);
    for d in directions() {
        let [u, v] = place(d);
        assert!((direction(u, v) - d).length() < 1e-12, "{d}");
    }
}

#[test]
fn lookups_go_on_over_the_seam_and_over_the_poles() {
    for (width, height) in [(8, 4), (7, 5), (2, 1), (1, 1)] {
        // Texels that have nothing to do with each other.
        let texels = (0..width * height).map(|i| [f64::from(i as u32 * 37 % 11); 4]).collect();
        let level = Level { width, height, texels, alpha_scale: 1.0 };
        let at = |d: DVec3| lookup(&level, place(d));
        for i in 0..64 {
            let (sine, cosine) = (TAU * f64::from(i) / 64.0).sin_cos();
            let step = 1e-9;
            let over_seam = [DVec3::new(-1.0, sine, step), DVec3::new(-1.0, sine, -step)];
            let over_top = [DVec3::new(step * cosine, 1.0, step * sine), DVec3::new(-step * cosine, 1.0, -step * sine)];
            for [a, b] in [over_seam, over_top, over_top.map(|d| -d)] {
                assert!((at(a) - at(b)).length() < 1e-6, "{width} x {height}: {a} {b}: {} {}", at(a), at(b));
            }
        }
    }
}

#[test]
fn texels_are_seen_where_they_are() {
    let level = map(16, 8, |d| d);
    for i in 0..128 {
        let [u, v] = [(f64::from(i % 16) + 0.5) / 16.0, (f64::from(i / 16) + 0.5) / 8.0];
        assert!((lookup(&level, place(direction(u, v))) - direction(u, v)).length() < 1e-12);
    }
}

#[test]
fn irradiance_of_light_of_few_harmonics_is_what_a_cosine_keeps_of_them() {
    // Of 1, of a linear and of a quadratic harmonic: 1, 2/3, 1/4.
    let light =
        |d: DVec3| DVec3::new(1.0, 1.0 + 0.5 * d.y - 0.25 * d.x, 2.0 + d.x * d.z + 0.3 * (3.0 * d.y * d.y - 1.0));
    let expected = |n: DVec3| {
        let order_2 = n.x * n.z + 0.3 * (3.0 * n.y * n.y - 1.0);
        DVec3::new(1.0, 1.0 + (0.5 * n.y - 0.25 * n.x) * 2.0 / 3.0, 2.0 + order_2 / 4.0)
    };
    let found = irradiance(&map(512, 256, light));
    for n in directions() {
        let off = lookup(&found, place(n)) - expected(n);
        // Lines between texels of pi / 32: (pi / 32)^2 / 8 of second derivatives, both ways together up to 1.2.
        assert!(off.abs().max_element() < 1.5e-3, "{n}: {off}");
    }
}

#[test]
fn irradiance_of_half_a_white_sky_is_a_line_of_height() {
    let found = irradiance(&map(256, 128, |d| DVec3::splat(if d.y > 0.0 { 1.0 } else { 0.0 })));
    for n in directions() {
        let off = lookup(&found, place(n)).x - 0.5 * (1.0 + n.y);
        // As above, of second derivatives up to 1/2.
        assert!(off.abs() < 6.5e-4, "{n}: {off}");
    }
}

#[test]
fn a_mirror_sees_as_much_as_its_footprint() {
    // Stripes a texel wide: sharp by themselves, grey over many.
    let texels = (0..64 * 32).map(|i| [f64::from(i % 2); 4]).collect();
    let environment = Environment {
        mips: Level { width: 64, height: 32, texels, alpha_scale: 1.0 }.chain(),
        irradiance: Level { width: 1, height: 1, texels: vec![[0.0; 4]], alpha_scale: 1.0 },
    };
    let d = direction(8.5 / 64.0, 0.5);
    assert!(environment.mirror(d, 0.0).x < 1e-9);
    assert!((environment.mirror(d, PI / 16.0).x - 0.5).abs() < 1e-9);
}
