//! Estimated and counted triangles on a square: what a tolerance in world units asks for of a map.

use std::{fmt::Write as _, path::Path};

use displace_server::domain::{
    choose::{
        cost::triangles_for,
        facts::HeightFacts,
        patch::{BaseTriangle, Patch, PatchView, View},
    },
    image::HeightMap,
};
use glam::{DVec2, DVec3, DVec4};

use crate::{
    corpus::corpus,
    meshes,
    server::{displace, validated},
};

/// Two triangles, 1 wide along X and Z, all of the map on them, each in 64 parts.
fn plane(size: DVec2) -> Vec<Patch> {
    let corner =
        |x: f64, z: f64| (DVec3::new(0.5 * x, 0.0, 0.5 * z), DVec2::new(0.5 + 0.5 * x, 0.5 + 0.5 * z) * size - 0.5);
    let [a, b, c, d] = [corner(-1.0, -1.0), corner(1.0, -1.0), corner(-1.0, 1.0), corner(1.0, 1.0)];
    let triangle = |all: [(DVec3, DVec2); 3]| {
        let (corners, texels, up) = (all.map(|c| c.0), all.map(|c| c.1), [DVec3::Y; 3]);
        let base = BaseTriangle::new(corners, up, up, texels);
        Patch { corners, normals: up, directions: up, texels, base, seam_distance: f64::INFINITY, is_rim: false }
    };
    let parts = |patch: Patch| patch.split().into_iter().flat_map(|p| p.split()).flat_map(|p| p.split());
    [triangle([a, c, b]), triangle([b, c, d])].into_iter().flat_map(parts).collect()
}

/// Of a tolerance in world units; heights are those of the map.
///
/// # Panics
/// Never: the plane has an area.
#[must_use]
pub fn estimated(map: &HeightMap, tolerance_world: f64) -> f64 {
    let facts = HeightFacts::new(map);
    // From above, a unit being a pixel.
    let view =
        View { pixel_from_local: [DVec4::X, DVec4::Z, DVec4::W], eye: DVec4::Y, size_px: DVec2::splat(2.0), near: 0.0 };
    let patches = plane(facts.size()).into_iter();
    let seen = patches.map(|patch| PatchView::new(patch, &view).expect("a patch with an area"));
    seen.map(|patch| triangles_for(tolerance_world, &patch, &facts)).sum()
}

/// Triangles of one map by one tolerance.
#[derive(Clone, Debug, PartialEq)]
pub struct Count {
    pub map: String,
    /// Of the map's values, world units.
    pub scale: f32,
    pub tolerance_world: f64,
    pub estimated: f64,
    pub made: u64,
}

impl Count {
    /// By `displace apply` on the square.
    ///
    /// # Panics
    /// Where the map cannot be read or displacing fails.
    #[must_use]
    pub fn of(map: &Path, scale: f32, tolerance_world: f64) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let file = |name: &str| folder.path().join(name).to_string_lossy().into_owned();
        std::fs::write(file("plane.glb"), meshes::plane(1).to_glb()).expect("written");
        let (mesh, out, path) = (file("plane.glb"), file("out.glb"), map.to_string_lossy().into_owned());
        let [scaled, tolerance] = [scale.to_string(), tolerance_world.to_string()];
        let words = ["--json", "--server", validated(), "apply", &mesh, "--height", &path, "--scale", &scaled];
        let words = words.into_iter().chain(["--tolerance-world", &tolerance, "-o", &out]).collect::<Vec<_>>();
        let report = displace(&words).expect_success().json();
        let made = report["triangles"].as_u64().expect("a count");
        let name = map.file_stem().map(|name| name.to_string_lossy().into_owned()).unwrap_or_default();
        let estimated = estimated(&read(map, scale), tolerance_world);
        Self { map: name, scale, tolerance_world, estimated, made }
    }

    #[must_use]
    pub fn ratio(&self) -> f64 {
        self.estimated / self.made as f64
    }
}

fn read(path: &Path, scale: f32) -> HeightMap {
    let image = image::open(path).unwrap_or_else(|error| panic!("{}: {error}", path.display())).to_luma32f();
    let (width, height) = image.dimensions();
    let heights = image.as_raw().iter().map(|value| scale * value).collect();
    HeightMap { width, height, heights, repeats: [true; 2], thinnest_texels: 1.0 }
}

/// Of three maps by three tolerances; none without the corpus.
#[must_use]
pub fn of_corpus() -> Vec<Count> {
    let Some(corpus) = corpus("the table of triangles") else { return Vec::new() };
    let maps = [
        ("maps/godot_bricks/texture_bricks_depth.jpg", 0.05, [0.002, 0.001, 0.0005]),
        ("maps/ambientcg_Rock020/Rock020_1K_Displacement.jpg", 0.05, [0.002, 0.001, 0.0005]),
        ("maps/dem_jacksboro/jacksboro_fault_dem_u16_metres.png", 5.0, [0.004, 0.002, 0.001]),
    ];
    let of = |(file, scale, tolerances): (&str, f32, [f64; 3])| {
        tolerances.map(|tolerance| Count::of(&corpus.path(file), scale, tolerance))
    };
    maps.into_iter().flat_map(of).collect()
}

#[must_use]
pub fn csv(counts: &[Count]) -> String {
    let mut text = String::from("map,scale,tolerance_world,triangles,estimated,ratio\n");
    for c in counts {
        let Count { map, scale, tolerance_world, made, estimated, .. } = c;
        let _ = writeln!(text, "{map},{scale},{tolerance_world},{made},{estimated:.0},{:.2}", c.ratio());
    }
    text
}
