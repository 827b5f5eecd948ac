//! Forward mapping beside inverse mapping: `cargo run -p displace-tests --example mapping -- OUT_FOLDER [TEXELS]` draws
//! `forward.png` and `inverse.png`, a checker on a floor, and says how many pixels forward mapping misses and hits often.

use std::{env, path::PathBuf};

use displace_tests::projective::{Projective, looked_up, splatted};
use glam::DVec2;
use image::{Rgb, RgbImage};

const WIDTH: u32 = 320;
const HEIGHT: u32 = 240;
const FLOOR: [DVec2; 4] =
    [DVec2::new(110.0, 40.0), DVec2::new(210.0, 40.0), DVec2::new(312.0, 232.0), DVec2::new(8.0, 232.0)];
const NOTHING: Rgb<u8> = Rgb([40, 40, 40]);
const HOLE: Rgb<u8> = Rgb([230, 0, 160]);

fn checker(uv: DVec2, dimmed: bool) -> Rgb<u8> {
    let is_light = ((uv.x * 16.0) as u32 + (uv.y * 16.0) as u32).is_multiple_of(2);
    let [light, dark] = if dimmed { [[120, 190, 120], [30, 80, 30]] } else { [[235, 230, 215], [70, 60, 60]] };
    Rgb(if is_light { light } else { dark })
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    let folder = PathBuf::from(env::args().nth(1).ok_or("name a folder for the pictures")?);
    let texels: u32 = env::args().nth(2).map_or(Ok(128), |text| text.parse())?;
    let map = Projective::from_corners(FLOOR).ok_or("the floor has no area")?;
    let hits = splatted(&map, texels, WIDTH, HEIGHT);
    let inverse = map.adjugate();
    let mut pictures = [RgbImage::from_pixel(WIDTH, HEIGHT, NOTHING), RgbImage::from_pixel(WIDTH, HEIGHT, NOTHING)];
    let (mut all, mut holes, mut overlaps, mut most) = (0, 0, 0, 0);
    for (x, y) in (0..HEIGHT).flat_map(|y| (0..WIDTH).map(move |x| (x, y))) {
        let Some(uv) = looked_up(&inverse, x, y) else { continue };
        let count = hits[(y * WIDTH + x) as usize];
        (all, most) = (all + 1, most.max(count));
        holes += u32::from(count == 0);
        overlaps += u32::from(count > 1);
        pictures[0].put_pixel(x, y, if count == 0 { HOLE } else { checker(uv, count > 1) });
        pictures[1].put_pixel(x, y, checker(uv, false));
    }
    std::fs::create_dir_all(&folder)?;
    for (picture, name) in pictures.iter().zip(["forward.png", "inverse.png"]) {
        picture.save(folder.join(name))?;
    }
    println!(
        "{texels} x {texels} texels onto {all} pixels: {holes} holes, {overlaps} hit more than once, up to {most} times"
    );
    Ok(())
}
