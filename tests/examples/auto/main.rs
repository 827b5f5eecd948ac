//! Whether `--method auto` keeps what it is asked for, and how far it is from the cheapest that does: scenes of the corpus, each
//! from several places, with several tolerances, measured against the surface itself.
//!
//! `cargo run -p displace-tests --example auto -- [--out FILE.csv] [NAME ...]` runs those scenes whose names begin with a
//! NAME, or all, and prints what they come to. It needs `DISPLACE_CORPUS` and takes about half an hour on two cores.
//! `-- --page FILE.csv` writes that beside a table, as `FILE.md`.

mod page;
mod scenes;
mod trials;

use std::{
    fmt::Write as _,
    path::{Path, PathBuf},
};

use displace_tests::corpus::corpus;
use trials::{Case, Trials};

const COLUMNS: &str = "scene,view,tolerance_px,method,setting,predicted_px,measured_px,outline_px,within,cost,front_cost,front,enough_cost,enough,displaced_cost,predicted_triangles,triangles,displaced_triangles,ms,displaced_ms";

fn main() {
    let mut words: Vec<String> = std::env::args().skip(1).collect();
    let mut file = |flag: &str| {
        words.iter().position(|word| word == flag).map(|at| {
            words.remove(at);
            PathBuf::from(words.remove(at))
        })
    };
    let (out, made) = (file("--out"), file("--page"));
    if let Some(made) = made {
        return write_page(&made);
    }
    let Some(corpus) = corpus("the run of auto") else { return };
    let folder = tempfile::tempdir().expect("a temporary folder");
    let mut cases = Vec::new();
    for scene in scenes::all(&corpus, folder.path()) {
        if !words.is_empty() && !words.iter().any(|word| scene.name.starts_with(word.as_str())) {
            continue;
        }
        let trials = Trials::new(&scene, folder.path());
        for (view, camera) in trials.cameras().into_iter().enumerate() {
            cases.extend(trials.run(view, &camera));
            let path = out.clone();
            if let Some(path) = path {
                std::fs::write(path, table(&cases)).expect("the table is written");
            }
        }
    }
    println!("{}", page::page(&table(&cases)));
}

fn write_page(table: &Path) {
    let csv = std::fs::read_to_string(table).expect("a table");
    std::fs::write(table.with_extension("md"), page::page(&csv)).expect("the page is written");
}

fn table(cases: &[Case]) -> String {
    let mut text = format!("{COLUMNS}\n");
    for case in cases {
        let _ = writeln!(text, "{}", case.row());
    }
    text
}
