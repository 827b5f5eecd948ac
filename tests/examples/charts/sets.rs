//! The sets: a mesh, a map and a view each.

use std::{env, fs, path::Path};

use displace_tests::{
    data::sample,
    maps::png16,
    meshes::{self, TestMesh},
};
use image::imageops::FilterType;

use crate::Result;

pub(crate) struct Set {
    pub(crate) name: &'static str,
    /// What is seen.
    pub(crate) text: &'static str,
    /// As typed where its files are, without the folder to write to.
    pub(crate) command: &'static str,
    mesh: fn() -> TestMesh,
    source: Source,
}

enum Source {
    /// Made for the gallery, under the set's map's own name.
    Gallery,
    /// Committed.
    Sample(&'static str),
    /// Of the corpus, no larger than this, texels.
    Corpus(&'static str, u32),
}

pub(crate) const SETS: [Set; 5] = [
    Set {
        name: "brick",
        text: "A plane of bricks, 256 x 256 texels made for the gallery: walls nearly upright around flat tops.",
        command: "displace chart brick.glb --height bricks.png --scale 0.05 --eye 0.3,0.8,1.25 --look-at 0,0,0.05 --fov 50 --light 1,0.9,-0.4 --ambient 0.3 --size 256x256 --sweep angle,distance,amplitude",
        mesh: plane,
        source: Source::Gallery,
    },
    Set {
        name: "rock",
        text: "A plane of rock, 512 x 512 texels by ambientCG (CC0): rough at every size.",
        command: "displace chart rock.glb --height rock_height.png --scale 0.1 --eye 0.3,0.8,1.25 --look-at 0,0,0.05 --fov 50 --light 1,0.9,-0.4 --ambient 0.3 --size 256x256 --sweep angle,distance,amplitude",
        mesh: plane,
        source: Source::Sample("maps/rock_height.png"),
    },
    Set {
        name: "tiles",
        text: "A plane of tiles, 256 x 256 texels made for the gallery: flat, with narrow joints.",
        command: "displace chart tiles.glb --height tiles.png --scale 0.03 --eye 0.3,0.8,1.25 --look-at 0,0,0.05 --fov 50 --light 1,0.9,-0.4 --ambient 0.3 --size 256x256 --sweep angle,distance,amplitude",
        mesh: plane,
        source: Source::Gallery,
    },
    Set {
        name: "earth",
        text: "A ball of 1024 triangles with the Earth's elevation (NASA Visible Earth), 1024 x 512 texels, its heights 50 times as high.",
        command: "displace chart earth.glb --height earth.png --scale 0.07 --orbit 75,20,2.6 --light 1,0.5,0.9 --ambient 0.2 --size 256x256 --sweep angle,distance,amplitude",
        mesh: ball,
        source: Source::Corpus("earth_three-globe/earth-topology.png", 1024),
    },
    Set {
        name: "terrain",
        text: "A plane with the terrain around Jacksboro, Tennessee (SRTM), 403 x 344 texels, its heights 5 times as high.",
        command: "displace chart terrain.glb --height terrain.png --scale 0.35 --midlevel 0.5 --eye 0.4,0.9,1.4 --look-at 0,-0.1,0.05 --fov 50 --light 1,0.5,-0.4 --ambient 0.2 --size 256x256 --wrap clamp --sweep angle,distance,amplitude",
        mesh: plane,
        source: Source::Corpus("dem_jacksboro/jacksboro_fault_dem_u16_metres.png", 512),
    },
];

fn plane() -> TestMesh {
    meshes::plane(8)
}

fn ball() -> TestMesh {
    meshes::uv_sphere(32, 17)
}

/// The mesh and the map, under the names that the command has for them.
pub(crate) fn write(set: &Set, folder: &Path) -> Result<()> {
    fs::write(folder.join(format!("{}.glb", set.name)), (set.mesh)().to_glb())?;
    match set.source {
        Source::Gallery => {}
        Source::Sample(path) => {
            fs::copy(sample(path), folder.join("rock_height.png"))?;
        }
        Source::Corpus(path, most) => fs::write(folder.join(format!("{}.png", set.name)), corpus(path, most)?)?,
    }
    Ok(())
}

/// Heights from 0 to 1 over the whole range of 16 bits.
fn corpus(path: &str, most: u32) -> Result<Vec<u8>> {
    let corpus =
        env::var("DISPLACE_CORPUS").map_err(|_| format!("DISPLACE_CORPUS has to name a folder with maps/{path}"))?;
    let image = image::open(Path::new(&corpus).join("maps").join(path))?;
    let image = if image.width() > most { image.resize(most, most, FilterType::Triangle) } else { image };
    let heights = image.to_luma16();
    let [low, high] = heights.pixels().fold([u16::MAX, 0], |[low, high], p| [low.min(p.0[0]), high.max(p.0[0])]);
    let value = |x, y| {
        let share = f64::from(heights.get_pixel(x, y).0[0] - low) / f64::from((high - low).max(1));
        (65535.0 * share).round() as u16
    };
    Ok(png16(heights.width(), heights.height(), value))
}
