//! Every file of the corpus through the command line and a validated server: accepted files give finite,
//! watertight results and an image, refused ones exit with 2 and a sentence. What other programs say of the
//! results is in `tests/peers`.

use std::{fs, path::Path};

use displace_tests::{
    cli::Run,
    corpus::{self, Expect, Model},
    data::sample,
    device, glb,
    invariants::assert_finite,
    server,
};

const EXPRESSION: &str = "0.5*sin(20*pi*x)";

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
    check_glb(&folder.join("expr.glb"));
    let map = sample("maps/abstract_height.png");
    let map = map.to_string_lossy();
    let height = folder.join("height.glb");
    let by_map = run(mesh, &["apply", "--height", &*map, "--scale", "0.1", "--uniform", "2"], &height);
    match by_map.code {
        Some(0) => check_glb(&height),
        Some(2) if by_map.stderr.contains("TEXCOORD_0") => {}
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

fn check_glb(path: &Path) {
    for part in glb::read(&fs::read(path).expect("the result was written")) {
        assert_finite(&path.display().to_string(), &part.positions);
        assert_finite(&path.display().to_string(), &part.normals);
        let vertices = part.positions.len();
        assert!(part.triangles.iter().flatten().all(|&vertex| (vertex as usize) < vertices), "{}", path.display());
    }
}
