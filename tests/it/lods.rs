//! Levels of detail, read back from the files: each near enough to the surface, named in order, and shown by nobody
//! who does not look for them.

use displace_server::domain::gltf::{Limits, load};
use displace_tests::{cli::Run, glb, maps, meshes, server};
use serde_json::{Value, json};

/// A wall of 32 triangles in a folder, under white noise.
struct Case {
    folder: tempfile::TempDir,
}

impl Case {
    fn new(edit: impl FnOnce(&mut Value)) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let (mut document, bin) = split(&meshes::plane(4).to_glb());
        edit(&mut document);
        std::fs::write(folder.path().join("wall.glb"), glb::pack(&document, &bin)).expect("it is written");
        std::fs::write(folder.path().join("noise.png"), maps::noise16(24, 3)).expect("it is written");
        Self { folder }
    }

    fn path(&self, name: &str) -> String {
        self.folder.path().join(name).to_str().expect("temporary folders are UTF-8").to_owned()
    }

    fn run(&self, args: &[&str]) -> Run {
        let words = args.iter().map(|arg| match *arg {
            "WALL" => self.path("wall.glb"),
            "NOISE" => self.path("noise.png"),
            name if name.ends_with(".glb") => self.path(name),
            other => other.to_owned(),
        });
        let words: Vec<String> =
            words.chain(["--json".into(), "--server".into(), server::reference().into()]).collect();
        server::displace(&words.iter().map(String::as_str).collect::<Vec<_>>())
    }

    /// The report, and the document of the file.
    fn apply(&self, flags: &[&str]) -> (Value, Value) {
        let args = ["apply", "WALL", "--height", "NOISE", "--scale", "0.06", "-o", "out.glb"];
        let report = self.run(&[&args, flags].concat()).expect_success().json();
        (report, self.document("out.glb"))
    }

    /// Of a file from the surface, as a share of the diagonal: at least this, and at most `precision` more.
    fn distance(&self, bytes: &[u8], precision: f64) -> f64 {
        std::fs::write(self.path("level.glb"), bytes).expect("it is written");
        let precision = precision.to_string();
        let args = ["measure", "WALL", "--height", "NOISE", "--scale", "0.06", "level.glb", "--precision", &precision];
        let report = self.run(&args).expect_success().json();
        let length = |of: &Value| of.as_f64().expect("a length");
        length(&report["hausdorff"]["lo"]) / length(&report["diagonal"])
    }

    fn document(&self, name: &str) -> Value {
        split(&std::fs::read(self.path(name)).expect("it is there")).0
    }
}

fn split(bytes: &[u8]) -> (Value, Vec<u8>) {
    let glb = gltf::Glb::from_slice(bytes).expect("a GLB");
    (serde_json::from_slice(&glb.json).expect("JSON"), glb.bin.unwrap_or_default().into_owned())
}

fn numbers(list: &Value) -> Vec<f64> {
    list.as_array().expect("a list").iter().map(|x| x.as_f64().expect("a number")).collect()
}

fn figures(report: &Value, of: &str) -> Vec<f64> {
    report["lods"].as_array().expect("levels").iter().map(|lod| lod[of].as_f64().expect("a number")).collect()
}

/// The nodes that have levels, with the nodes of these.
fn chains(document: &Value) -> Vec<(usize, Vec<usize>)> {
    let nodes = document["nodes"].as_array().expect("nodes").iter().enumerate();
    let ids =
        |node: &Value| Some(numbers(node.pointer("/extensions/MSFT_lod/ids")?).iter().map(|x| *x as usize).collect());
    nodes.filter_map(|(number, node)| Some((number, ids(node)?))).collect()
}

/// The file with its node `former` replaced by node `now` wherever it is a child.
fn showing(bytes: &[u8], former: usize, now: usize) -> Vec<u8> {
    let (mut document, bin) = split(bytes);
    for node in document["nodes"].as_array_mut().expect("nodes") {
        let children = node.get_mut("children").and_then(Value::as_array_mut).into_iter().flatten();
        children.filter(|child| **child == json!(former)).for_each(|child| *child = json!(now));
    }
    glb::pack(&document, &bin)
}

#[test]
fn every_level_keeps_its_own_tolerance_however_the_file_is_packed() {
    let case = Case::new(|_| ());
    for (compress, measured) in [("none", 0..0), ("quantize", 1..3), ("meshopt", 2..3)] {
        let (report, document) = case.apply(&["--tolerance", "4e-3", "--lods", "3", "--compress", compress]);
        assert_eq!(report["warnings"], json!([]), "{compress}");
        let (tolerances, bounds) = (figures(&report, "tolerance"), figures(&report, "bound"));
        let chain = &chains(&document)[0];
        assert_eq!((tolerances.len(), chain.1.len()), (3, 2), "{report}");
        let bytes = std::fs::read(case.path("out.glb")).expect("it is there");
        for level in 0..3 {
            let wanted = 4e-3 * 4f64.powi(level as i32);
            let (tolerance, bound) = (tolerances[level], bounds[level]);
            assert!((tolerance / wanted - 1.0).abs() < 1e-6 && bound <= wanted * 1.000_001, "{report}");
            if measured.contains(&level) {
                let node = if level == 0 { chain.0 } else { chain.1[level - 1] };
                let share = case.distance(&showing(&bytes, chain.0, node), 0.3 * bound);
                assert!(share <= bound && share > 0.2 * bound, "{compress} {level}: {share} {report}");
            }
        }
    }
}

#[test]
fn triangles_and_thresholds_fall_from_level_to_level_and_the_scene_shows_the_first() {
    let case = Case::new(|_| ());
    let (report, document) = case.apply(&["--tolerance", "1e-3", "--lods", "4"]);
    let triangles = figures(&report, "triangles");
    assert!(triangles.windows(2).all(|pair| pair[1] < 0.7 * pair[0]), "{triangles:?}");
    assert_eq!(report["triangles"].as_f64(), Some(triangles[0]));
    assert_eq!(document["extensionsUsed"], json!(["MSFT_lod"]));
    let shares = numbers(&document["nodes"][chains(&document)[0].0]["extras"]["MSFT_screencoverage"]);
    assert!(shares.len() == 4 && shares.windows(2).all(|pair| pair[1] < pair[0]) && shares[3] == 0.0, "{shares:?}");
    let bytes = std::fs::read(case.path("out.glb")).expect("it is there");
    let scene = load(&bytes.into(), &|_| None, &Limits::default()).expect("it loads");
    assert_eq!((scene.meshes.len(), scene.instances.len(), scene.instances[0].mesh), (4, 1, 0));
    for (level, own) in scene.meshes.iter().enumerate() {
        assert_eq!(own.mesh.triangles.len() as f64, triangles[level]);
    }
}

#[test]
fn every_node_of_a_mesh_has_the_same_levels_at_its_own_place() {
    let case = Case::new(|document| {
        document["nodes"] = json!([{ "mesh": 0, "translation": [5, 0, 0] }, { "mesh": 0, "scale": [2, 2, 2] }]);
        document["scenes"] = json!([{ "nodes": [0, 1] }]);
    });
    let (report, document) = case.apply(&["--tolerance-world", "0.01", "--lods", "3", "--compress", "quantize"]);
    let chains = chains(&document);
    assert_eq!((chains.len(), document["meshes"].as_array().map(Vec::len)), (2, Some(3)), "{report}");
    let bytes = std::fs::read(case.path("out.glb")).expect("it is there");
    let [first, lower] = [chains[0].0, chains[0].1[1]];
    let places = |bytes: &[u8]| {
        let scene = load(&bytes.to_vec().into(), &|_| None, &Limits::default()).expect("it loads");
        scene.bounds
    };
    let (fine, coarse) = (places(&bytes), places(&showing(&bytes, first, lower)));
    for (a, b) in fine.as_flattened().iter().zip(coarse.as_flattened()) {
        assert!((a - b).abs() < 0.2, "{fine:?} {coarse:?}");
    }
}

#[test]
fn a_budget_is_for_level_0_and_the_others_are_coarser_than_what_it_reached() {
    let case = Case::new(|_| ());
    let (report, _) = case.apply(&["--tolerance", "1e-4", "--max-triangles", "500", "--lods", "3"]);
    let (triangles, tolerances) = (figures(&report, "triangles"), figures(&report, "tolerance"));
    assert!(triangles[0] <= 500.0 && tolerances[0] > 1e-4, "{report}");
    assert!(tolerances.windows(2).all(|pair| (pair[1] / pair[0] / 4.0 - 1.0).abs() < 1e-6), "{report}");
}

#[test]
fn pixels_of_views_are_multiplied_too() {
    let case = Case::new(|_| ());
    let view = ["--tolerance-px", "0.25", "--view", "0,0,6;0,0,0;40;320x240", "--lods", "3"];
    let (report, _) = case.apply(&view);
    assert_eq!(report["accuracy"]["unit"], "px");
    assert!((figures(&report, "tolerance")[2] - 4.0).abs() < 1e-6, "{report}");
}

#[test]
fn a_chain_ends_with_the_mesh_itself() {
    let case = Case::new(|_| ());
    let (report, document) = case.apply(&["--tolerance", "2e-2", "--lods", "8"]);
    let triangles = figures(&report, "triangles");
    assert!(triangles.len() < 8 && triangles.last() == Some(&32.0), "{report}");
    assert_eq!(report["warnings"][0]["code"], "lods_ended");
    assert_eq!(chains(&document)[0].1.len() + 1, triangles.len());
}

#[test]
fn levels_without_a_tolerance_and_levels_of_levels_are_refused() {
    let own = |document: &mut Value| {
        document["nodes"] = json!([{ "mesh": 0, "extensions": { "MSFT_lod": { "ids": [1] } } }, { "mesh": 0 }]);
        document["extensionsUsed"] = json!(["MSFT_lod"]);
    };
    let case = Case::new(own);
    let run = case.run(&["apply", "WALL", "--expr", "0.1*u", "-o", "o.glb", "--lods", "2"]);
    assert_eq!((run.code, run.json()["error"]["field"].as_str()), (Some(2), Some("lods")));
    assert!(run.json()["error"]["message"].as_str().is_some_and(|m| m.contains("nodes[0]") && m.contains("MSFT_lod")));
    let (_, document) = case.apply(&["--tolerance", "1e-2"]);
    assert_eq!(chains(&document), [(0, vec![1])]);
    let run = case.run(&["apply", "WALL", "--expr", "u", "-o", "o.glb", "--uniform", "1", "--lods", "2"]);
    assert_eq!(run.code, Some(2));
}
