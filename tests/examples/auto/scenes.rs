//! Meshes and the heights on them.

use std::path::{Path, PathBuf};

use displace_tests::{corpus::Corpus, meshes};

pub(crate) struct Scene {
    pub(crate) name: String,
    pub(crate) mesh: PathBuf,
    pub(crate) map: PathBuf,
    /// Of the map's range, as a share of the mesh's diagonal.
    pub(crate) share: f32,
}

/// (mesh, map, share of the diagonal); a mesh without a dot is made here.
const SCENES: [(&str, &str, f32); 18] = [
    ("plane", "godot_bricks/texture_bricks_depth.jpg", 0.02),
    ("plane", "ambientcg_Rock020/Rock020_1K_Displacement.jpg", 0.04),
    ("plane", "ambientcg_Tiles036/Tiles036_1K_Displacement.jpg", 0.004),
    ("plane", "dem_jacksboro/jacksboro_fault_dem_u16_metres.png", 0.1),
    ("plane", "babylon_hexMap/hexMap_height.png", 0.03),
    ("plane", "bevy_parallax_cube/cube_depth.png", 0.01),
    ("cube", "bevy_parallax_cube/cube_depth.png", 0.01),
    ("cube", "godot_bricks/texture_bricks_depth.jpg", 0.004),
    ("sphere", "earth_three-globe/earth-topology.png", 0.02),
    ("sphere", "3dtextures_Abstract_008/Abstract_008_height.png", 0.005),
    ("torus", "ambientcg_Rock020/Rock020_1K_Displacement.jpg", 0.02),
    ("torus", "ambientcg_Tiles036/Tiles036_1K_Displacement.jpg", 0.002),
    ("Suzanne/Suzanne.gltf", "3dtextures_Abstract_008/Abstract_008_height.png", 0.01),
    ("Avocado/Avocado.gltf", "ambientcg_Rock020/Rock020_1K_Displacement.jpg", 0.005),
    ("BoxTextured.glb", "ambientcg_Tiles036/Tiles036_1K_Displacement.jpg", 0.002),
    ("clothFolds.glb", "godot_bricks/texture_bricks_depth.jpg", 0.003),
    ("Fox.glb", "3dtextures_Abstract_008/Abstract_008_height.png", 0.002),
    ("TwoSidedPlane/TwoSidedPlane.gltf", "godot_bricks/texture_bricks_depth.jpg", 0.02),
];

pub(crate) fn all(corpus: &Corpus, folder: &Path) -> Vec<Scene> {
    let scene = |(mesh, map, share): &(&str, &str, f32)| {
        let stem = |path: &str| path.split(['/', '.']).next().unwrap_or_default().to_owned();
        let name = format!("{}-{}", stem(mesh), stem(map));
        Scene { name, mesh: mesh_file(corpus, folder, mesh), map: corpus.path(&format!("maps/{map}")), share: *share }
    };
    SCENES.iter().map(scene).collect()
}

fn mesh_file(corpus: &Corpus, folder: &Path, mesh: &str) -> PathBuf {
    let made = match mesh {
        "plane" => meshes::plane(1),
        "cube" => meshes::cube(),
        "sphere" => meshes::uv_sphere(48, 24),
        "torus" => meshes::torus(48, 24),
        file => return corpus.path(&format!("models/{file}")),
    };
    let path = folder.join(format!("{mesh}.glb"));
    std::fs::write(&path, made.to_glb()).expect("a mesh is written");
    path
}
