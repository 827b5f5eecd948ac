//! Every file of the corpus through the command line and a validated server: accepted files give finite,
//! watertight results and an image, refused ones exit with 2 and a sentence. What other programs say of the
//! results is in `tests/peers`.

use std::{collections::BTreeMap, fs, path::Path};

use bytes::Bytes;
use displace_server::{
    domain::{gltf, mesh::Mesh, scene::Scene},
    oracle::invariants::{boundary_edges, indices, not_finite},
};
use displace_tests::{
    cli::Run,
    corpus::{self, Expect, Model},
    data::sample,
    device,
    glb::{self, Part},
    server,
};

const EXPRESSION: &str = "0.5*sin(20*pi*x)";
/// Of `--uniform`: each edge becomes 2^LEVEL.
const LEVEL: u32 = 2;

#[test]
fn every_file_is_accepted_or_refused_as_it_should_be() {
    if device::without_gpu("the corpus") {
        return;
    }
    let Some(corpus) = corpus::corpus("every_file_is_accepted_or_refused_as_it_should_be") else { return };
    let models = corpus.models();
    assert!(models.len() > 40, "only {} models found", models.len());
    let faults: Vec<String> = models.iter().filter_map(|model| fault(model).err()).collect();
    assert!(faults.is_empty(), "{} of {} files:\n{}", faults.len(), models.len(), faults.join("\n"));
}

/// What is wrong with the answer to a model.
fn fault(model: &Model) -> Result<(), String> {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let name = model.path.display();
    let apply = run(&model.path, &["apply", "--expr", EXPRESSION, "--uniform", "2"], &folder.path().join("expr.glb"));
    match (model.expect, apply.code) {
        (Expect::Accept, Some(0)) => accepted(&model.path, folder.path()).map_err(|why| format!("{name}: {why}")),
        (Expect::AcceptOrReject, Some(0)) => Ok(()),
        (Expect::Reject | Expect::AcceptOrReject, Some(2)) => refusal(&apply).map_err(|why| format!("{name}: {why}")),
        (expect, code) => Err(format!("{name}: exit {code:?} where {expect:?} is right: {}", apply.stderr.trim())),
    }
}

fn run(mesh: &Path, args: &[&str], out: &Path) -> Run {
    let (mesh, out) = (mesh.to_string_lossy(), out.to_string_lossy());
    let (command, rest) = (args[0], &args[1..]);
    server::displace(&[&[command, &*mesh], rest, &["-o", &*out, "--quiet", "--server", server::validated()]].concat())
}

/// A refusal says what is wrong, and does not blame itself.
fn refusal(run: &Run) -> Result<(), String> {
    let said = run.stderr.trim();
    let is_sentence = said.len() > 20 && !said.contains("panicked") && !said.contains("internal");
    if is_sentence { Ok(()) } else { Err(format!("refused with '{said}', which names no fault")) }
}

fn accepted(mesh: &Path, folder: &Path) -> Result<(), String> {
    let open_edges = open_edges(mesh);
    check_glb(&folder.join("expr.glb"), &open_edges)?;
    let map = sample("maps/abstract_height.png");
    let map = map.to_string_lossy();
    let height = folder.join("height.glb");
    let by_map = run(mesh, &["apply", "--height", &*map, "--scale", "0.1", "--uniform", "2"], &height);
    match by_map.code {
        Some(0) => check_glb(&height, &open_edges)?,
        Some(2) if by_map.stderr.contains("TEXCOORD_0") && lacks_uvs(mesh) => {}
        code => return Err(format!("--height exits {code:?}: {}", by_map.stderr.trim())),
    }
    let image = folder.join("image.png");
    let rendered = run(mesh, &["render", "--expr", EXPRESSION, "--uniform", "1", "--size", "96x64"], &image);
    if rendered.code != Some(0) {
        return Err(format!("render exits {:?}: {}", rendered.code, rendered.stderr.trim()));
    }
    let size = image::image_dimensions(&image).map_err(|error| error.to_string())?;
    if size == (96, 64) { Ok(()) } else { Err(format!("the image is {size:?}")) }
}

fn load(mesh: &Path) -> Scene {
    let bytes = fs::read(mesh).expect("the corpus can be read");
    let beside = |uri: &str| fs::read(mesh.parent()?.join(uri.replace("%20", " "))).ok().map(Bytes::from);
    gltf::load(&bytes.into(), &beside, &gltf::Limits::default()).expect("an accepted file loads")
}

/// The boundary edges of each glTF mesh.
fn open_edges(mesh: &Path) -> BTreeMap<usize, u64> {
    load(mesh).meshes.iter().map(|m| (m.gltf_mesh, u64::from(m.mesh.health.boundary_edges))).collect()
}

fn lacks_uvs(mesh: &Path) -> bool {
    let has = |m: &Mesh| m.attribute("TEXCOORD_0").is_some_and(|a| a.primitives.iter().all(|has| *has));
    !load(mesh).meshes.iter().all(|m| has(&m.mesh))
}

/// Finite values, indices in range, and no boundary that the input does not have.
fn check_glb(path: &Path, open_edges: &BTreeMap<usize, u64>) -> Result<(), String> {
    let parts = glb::read(&fs::read(path).expect("the result was written"));
    for part in &parts {
        let broken = [
            not_finite("positions_finite", &part.positions),
            not_finite("normals_finite", &part.normals),
            indices(part.positions.len(), &part.triangles),
        ];
        assert_eq!(broken, [None, None, None], "{}", path.display());
    }
    for (&mesh, &open) in open_edges {
        let parts: Vec<Part> = parts.iter().filter(|part| part.mesh == mesh).cloned().collect();
        let whole = glb::joined(&parts);
        let (found, expected) = (boundary_edges(&whole.positions, &whole.triangles), open << LEVEL);
        if found != expected {
            return Err(format!("mesh {mesh} has {found} boundary edges where {expected} are right"));
        }
    }
    Ok(())
}
