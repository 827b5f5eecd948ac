//! Packed results read back by the server's own reader: the same triangles on the grid, nothing opened, and smaller.

use std::collections::{BTreeMap, HashMap};

use displace_server::{
    domain::{
        gltf::{Limits, Packing, Written, load, write},
        grid::Grid,
        mesh::Mesh,
        request::Compression,
        scene::Scene,
        surface::Surface,
    },
    oracle::invariants::boundary_edges,
};
use displace_tests::{
    data::sample,
    device,
    meshes::{self, TestMesh},
    subdivided::subdivided,
    surfaces::{detail, displace, noise_height, uniform},
};
use glam::{DVec3, Vec2, Vec3};
use serde_json::json;

const PACKED: [Compression; 2] = [Compression::Quantize, Compression::Meshopt];

fn loaded(bytes: &[u8]) -> Scene {
    load(&bytes.to_vec().into(), &|_| None, &Limits::default()).expect("the file loads")
}

fn packed(scene: &Scene, surfaces: &[Surface], compression: Compression) -> Written {
    write(scene, surfaces, &Packing::finest(scene, surfaces, compression)).expect("the result is written")
}

/// By white noise, at level 3.
fn displaced(mesh: &TestMesh) -> (Scene, Surface) {
    let mut scene = loaded(&mesh.to_glb());
    scene.meshes[0].mesh = mesh.to_mesh_without_tangents();
    let noise = detail(noise_height(64, 7), 0.07);
    let surface = displace(&*device::reference(), &scene.meshes[0].mesh, &noise, &uniform(3));
    (scene, surface)
}

/// How often each triangle is there, by its places from the least on.
type Triangles = BTreeMap<[[u16; 3]; 3], u32>;

fn counted(triangles: impl Iterator<Item = [[u16; 3]; 3]>) -> Triangles {
    let mut counted = Triangles::new();
    for mut triangle in triangles {
        let least = (0..3).min_by_key(|&k| triangle[k]).unwrap_or(0);
        triangle.rotate_left(least);
        *counted.entry(triangle).or_default() += 1;
    }
    counted
}

/// Of the surface, on the grid, without those that are none there.
fn expected(surface: &Surface, grid: &Grid) -> Triangles {
    let triangles = surface.triangles.iter().map(|t| t.map(|v| grid.place(surface.positions[v as usize])));
    counted(triangles.filter(|[a, b, c]| a != b && b != c && c != a))
}

fn found(mesh: &Mesh) -> Triangles {
    let place = |av: u32| mesh.gv_position[mesh.av_gv[av as usize] as usize].map(|x| x as u16);
    counted(mesh.triangles.iter().map(|t| t.av.map(place)))
}

fn corners(mesh: &Mesh) -> Vec<[u32; 3]> {
    mesh.triangles.iter().map(|t| t.av.map(|av| mesh.av_gv[av as usize])).collect()
}

#[test]
fn every_mesh_comes_back_on_its_grid_with_all_its_triangles_and_no_crack() {
    for mesh in meshes::all() {
        let (scene, surface) = displaced(&mesh);
        let grid = Grid::around(&surface.positions);
        for compression in PACKED {
            let back = loaded(&packed(&scene, std::slice::from_ref(&surface), compression).bytes);
            let what = format!("{} {compression:?}", mesh.name);
            let own = &back.meshes[0].mesh;
            assert_eq!(found(own), expected(&surface, &grid), "{what}");
            let borders = boundary_edges(&surface.positions, &surface.triangles);
            assert_eq!(boundary_edges(&own.gv_position, &corners(own)), borders, "{what}");
            assert_eq!(back.instances.len(), 1, "{what}");
        }
    }
}

#[test]
fn nodes_take_positions_back_to_where_they_were() {
    let (mut scene, surface) = displaced(&meshes::torus(16, 8));
    scene.document["nodes"] = json!([
        { "children": [1], "translation": [1, 2, 3], "rotation": [0.0, 0.6, 0.0, 0.8] },
        { "name": "shown", "mesh": 0, "children": [2], "scale": [2, -1, 0.5] },
        { "mesh": 0 },
    ]);
    let scene = loaded_with(&scene);
    let grid = Grid::around(&surface.positions);
    let back = loaded(&packed(&scene, &[surface], Compression::Meshopt).bytes);
    let nodes = back.document["nodes"].as_array().expect("nodes");
    assert_eq!(nodes.len(), 5);
    assert_eq!((&nodes[1]["name"], nodes[1].get("mesh")), (&json!("shown"), None));
    assert_eq!(nodes[1]["children"], json!([2, 3]));
    let worlds = |scene: &Scene, to: &dyn Fn(&[f32; 3]) -> DVec3| -> Vec<DVec3> {
        let place = &back.meshes[0].mesh.gv_position[5];
        let mut worlds: Vec<DVec3> = scene.instances.iter().map(|i| i.world().transform_point3(to(place))).collect();
        worlds.sort_by(|a, b| a.x.total_cmp(&b.x));
        worlds
    };
    let before = worlds(&scene, &|p| DVec3::from_array(grid.position(p.map(|x| x as u16))));
    let after = worlds(&back, &|p| DVec3::from_array(p.map(f64::from)));
    assert_eq!(before.len(), 2);
    for (a, b) in before.iter().zip(&after) {
        assert!(a.distance(*b) < 1e-5, "{a} to {b}");
    }
}

/// The scene with its document, as if that had been loaded.
fn loaded_with(scene: &Scene) -> Scene {
    let level0 = subdivided(&scene.meshes[0].mesh, 0, |_| 0.0);
    loaded(&write(scene, &[level0], &Packing::default()).expect("it is written").bytes)
}

#[test]
fn normals_and_texture_coordinates_are_where_they_were() {
    let (scene, surface) = displaced(&meshes::uv_sphere(16, 8));
    let grid = Grid::around(&surface.positions);
    let uv = |values: &[f32], v: usize| Vec2::from_slice(&values[2 * v..]);
    let mut looks: HashMap<[u16; 3], Vec<(Vec3, Vec2)>> = HashMap::new();
    for (v, position) in surface.positions.iter().enumerate() {
        let look = (Vec3::from(surface.normals[v]), uv(&surface.attributes[0], v));
        looks.entry(grid.place(*position)).or_default().push(look);
    }
    for (compression, most_degrees) in [(Compression::Quantize, 0.002), (Compression::Meshopt, 0.06)] {
        let back = loaded(&packed(&scene, std::slice::from_ref(&surface), compression).bytes);
        let mesh = &back.meshes[0].mesh;
        let uvs = &mesh.attribute("TEXCOORD_0").expect("it has UVs").values;
        for (av, gv) in mesh.av_gv.iter().enumerate() {
            let normal = Vec3::from(mesh.av_normal[av]);
            let near = |(n, t): &(Vec3, Vec2)| {
                n.cross(normal).length().asin().to_degrees() < most_degrees && t.distance(uv(uvs, av)) < 1.1e-5
            };
            let place = mesh.gv_position[*gv as usize].map(|x| x as u16);
            assert!(looks[&place].iter().any(near), "{compression:?}: {normal} {}", uv(uvs, av));
        }
    }
}

#[test]
fn packing_is_smaller_each_time_and_gives_the_same_bytes_again() {
    let (scene, surface) = displaced(&meshes::torus(24, 12));
    let bytes = |compression| packed(&scene, std::slice::from_ref(&surface), compression).bytes;
    let [plain, quantized, packed] = [Compression::None, Compression::Quantize, Compression::Meshopt].map(bytes);
    assert!(quantized.len() * 4 < plain.len() * 3, "{} of {}", quantized.len(), plain.len());
    assert!(packed.len() * 2 < quantized.len(), "{} of {}", packed.len(), quantized.len());
    assert!(quantized == bytes(Compression::Quantize) && packed == bytes(Compression::Meshopt));
    for (bytes, names) in [
        (&quantized, json!(["KHR_mesh_quantization"])),
        (&packed, json!(["KHR_mesh_quantization", "EXT_meshopt_compression"])),
    ] {
        let document = gltf::Glb::from_slice(bytes).expect("a GLB").json;
        let document: serde_json::Value = serde_json::from_slice(&document).expect("JSON");
        assert_eq!((&document["extensionsRequired"], &document["extensionsUsed"]), (&names, &names));
    }
}

#[test]
fn the_samples_keep_their_borders_and_their_primitives_together() {
    for name in ["Suzanne/Suzanne.gltf", "craft_speederD/craft_speederD.gltf", "BoxVertexColors.glb"] {
        let path = sample(&format!("models/{name}"));
        let bytes = std::fs::read(&path).expect("the sample can be read");
        let beside = |uri: &str| std::fs::read(path.parent()?.join(uri)).ok().map(Into::into);
        let scene = load(&bytes.into(), &beside, &Limits::default()).expect("the sample loads");
        let surfaces: Vec<Surface> = scene.meshes.iter().map(|m| subdivided(&m.mesh, 2, |_| 0.0)).collect();
        for compression in PACKED {
            let back = loaded(&packed(&scene, &surfaces, compression).bytes);
            assert_eq!(back.meshes.len(), scene.meshes.len(), "{name}");
            for ((own, surface), was) in back.meshes.iter().zip(&surfaces).zip(&scene.meshes) {
                assert_eq!(found(&own.mesh), expected(surface, &Grid::around(&surface.positions)), "{name}");
                assert_eq!(own.mesh.primitives.len(), was.mesh.primitives.len(), "{name}");
            }
        }
    }
}

#[test]
fn a_mesh_that_morphs_keeps_f32_positions_and_is_packed_all_the_same() {
    let bytes = std::fs::read(sample("models/AnimatedMorphCube.glb")).expect("the sample can be read");
    let scene = loaded(&bytes);
    let surface = subdivided(&scene.meshes[0].mesh, 4, |_| 0.0);
    let packing = Packing::finest(&scene, std::slice::from_ref(&surface), Compression::Meshopt);
    assert_eq!(packing.grids, [None]);
    let packed = write(&scene, std::slice::from_ref(&surface), &packing).expect("it is written").bytes;
    let plain = write(&scene, std::slice::from_ref(&surface), &Packing::default()).expect("it is written").bytes;
    assert!(packed.len() * 2 < plain.len());
    let (own, other) = (loaded(&packed), loaded(&plain));
    assert_eq!(own.meshes[0].mesh.gv_position, other.meshes[0].mesh.gv_position);
    let targets = |scene: &Scene| scene.meshes[0].mesh.attributes.iter().filter(|a| a.semantic.contains('/')).count();
    assert_eq!(targets(&own), targets(&other));
}

/// A wall of two triangles, and beside its edge a strip that is narrower than a step of the grid.
fn with_strip(width: f32) -> TestMesh {
    let positions = vec![[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0], [-width, 0.5, 0.0]];
    let triangles = vec![[0, 1, 2], [0, 2, 3], [0, 3, 4]];
    let normals = vec![[0.0, 0.0, 1.0]; 5];
    let uvs = positions.iter().map(|p| [p[0].max(0.0), p[1]]).collect();
    TestMesh { name: "strip", positions, normals, uvs, triangles }
}

#[test]
fn what_collapses_goes_only_where_others_cover_it() {
    let counts = |mesh: &TestMesh| {
        let scene = loaded(&mesh.to_glb());
        let surface = subdivided(&scene.meshes[0].mesh, 0, |_| 0.0);
        let back = loaded(&packed(&scene, &[surface], Compression::Quantize).bytes);
        let health = &back.meshes[0].mesh.health;
        (back.meshes[0].mesh.triangles.len(), health.degenerate_triangles)
    };
    // Narrower than a step, but with a place of its own.
    assert_eq!(counts(&with_strip(1e-6)), (3, 0));
    // Two of its corners become one, and the wall's side covers what is left.
    let mut mesh = with_strip(1e-6);
    mesh.positions[4][1] = 1e-6;
    assert_eq!(counts(&mesh), (2, 0));
    // The same far from the wall: nothing covers it.
    mesh.triangles[2] = [4, 5, 6];
    mesh.positions.extend([[-1e-6, 0.0, 0.0], [-1.0, 0.5, 0.0]]);
    mesh.normals.extend([[0.0, 0.0, 1.0]; 2]);
    mesh.uvs.extend([[0.0; 2]; 2]);
    assert_eq!(counts(&mesh), (2, 1));
}
