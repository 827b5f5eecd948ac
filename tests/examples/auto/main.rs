//! Whether `--method auto` keeps what it is asked for, and how far it is from the cheapest that does: scenes of the corpus, each
//! from several places, with several tolerances, measured against the surface itself.
//!
//! `cargo run -p displace-tests --example auto -- [--out FILE.csv] [NAME ...]` runs those scenes whose names begin with a
//! NAME, or all, and prints a summary. It needs `DISPLACE_CORPUS` and takes about half an hour on two cores.

mod scenes;
mod trials;

use std::{fmt::Write as _, path::PathBuf};

use displace_tests::corpus::corpus;
use trials::{Case, Trials};

const COLUMNS: &str = "scene,view,tolerance_px,method,setting,predicted_px,measured_px,outline_px,within,cost,front_cost,front,enough_cost,enough,displaced_cost,predicted_triangles,triangles,displaced_triangles,ms,displaced_ms";

fn main() {
    let mut words: Vec<String> = std::env::args().skip(1).collect();
    let out = words.iter().position(|word| word == "--out").map(|at| {
        words.remove(at);
        PathBuf::from(words.remove(at))
    });
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
    println!("{}", summary(&cases));
}

fn table(cases: &[Case]) -> String {
    let mut text = format!("{COLUMNS}\n");
    for case in cases {
        let _ = writeln!(text, "{}", case.row());
    }
    text
}

fn summary(cases: &[Case]) -> String {
    let kept = cases.iter().filter(|case| case.is_kept()).count();
    let near = cases.iter().filter(|case| case.cost <= 1.1 * case.front_cost).count();
    let median = |mut values: Vec<f64>| {
        values.sort_by(f64::total_cmp);
        values.get(values.len() / 2).copied().unwrap_or_default()
    };
    let share = |of: fn(&Case) -> [f64; 2]| {
        median(cases.iter().map(|case| 1.0 - of(case)[0] / of(case)[1].max(f64::MIN_POSITIVE)).collect())
    };
    let mut methods: std::collections::BTreeMap<&str, usize> = std::collections::BTreeMap::new();
    for case in cases {
        *methods.entry(&case.method).or_default() += 1;
    }
    let mut text = format!(
        "{} cases: {kept} kept, {near} within 10 % of the cheapest that does\nmedian saving against displacement: {:.0} % of the cost, {:.0} % of the time, {:.0} % of the triangles\nchosen: {methods:?}\n",
        cases.len(),
        100.0 * share(|case| [case.cost, case.displaced_cost]),
        100.0 * share(|case| [case.ms, case.displaced_ms]),
        100.0 * share(|case| [case.triangles, case.displaced_triangles]),
    );
    for case in cases.iter().filter(|case| !case.is_kept()) {
        let _ = writeln!(text, "missed: {}", case.row());
    }
    text
}
