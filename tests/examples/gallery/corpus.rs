//! The maps of a corpus in place of those made here, for the page that is not committed.

use std::{fs, path::Path};

use displace_tests::maps::png16;
use image::imageops::FilterType;

use crate::Result;

/// (height, its colours, whether the height is a depth, and the names they take the place of)
const MAPS: [(&str, &str, bool, [&str; 2]); 4] = [
    ("godot_bricks/texture_bricks_depth.jpg", "godot_bricks/texture_bricks.jpg", true, ["bricks", "bricks_color"]),
    (
        "ambientcg_Rock020/Rock020_1K_Displacement.jpg",
        "ambientcg_Rock020/Rock020_1K_Color.jpg",
        false,
        ["rock_height", "rock_light"],
    ),
    (
        "ambientcg_Tiles036/Tiles036_1K_Displacement.jpg",
        "ambientcg_Tiles036/Tiles036_1K_Color.jpg",
        false,
        ["tiles", "tiles_color"],
    ),
    ("bevy_parallax_cube/cube_depth.png", "bevy_parallax_cube/cube_color.png", true, ["crate", "crate_color"]),
];
const SIDE: u32 = 512;

/// Writes them over those of the same names, all of one size.
pub(crate) fn write(corpus: &Path, folder: &Path) -> Result<()> {
    for (height, color, is_depth, names) in MAPS {
        let read = |file: &str| -> Result<image::DynamicImage> {
            let path = corpus.join("maps").join(file);
            Ok(image::open(&path).map_err(|error| format!("{}: {error}", path.display()))?)
        };
        let heights = read(height)?.resize_exact(SIDE, SIDE, FilterType::Triangle).to_luma16();
        let value = |x, y| if is_depth { 65535 - heights.get_pixel(x, y).0[0] } else { heights.get_pixel(x, y).0[0] };
        fs::write(folder.join(format!("{}.png", names[0])), png16(SIDE, SIDE, value))?;
        let colors = read(color)?.resize_exact(SIDE, SIDE, FilterType::Triangle).to_rgb8();
        colors.save(folder.join(format!("{}.png", names[1])))?;
    }
    Ok(())
}
