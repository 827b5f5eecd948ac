//! What a normal map saves in triangles: a coarse mesh with the map that `--normals map` makes for it, beside meshes that are
//! displaced alone until they look as much like the surface. Writes `tests/charts/split.csv` and `split.md`.
//!
//! `DISPLACE_CORPUS=... cargo run -p displace-tests --example split`

mod case;
mod page;

use displace_tests::{corpus::corpus, data::repository};

use case::{Case, Row};

/// Shares of the diagonal that the coarse meshes may be off by.
const SPLIT: [&str; 3] = ["1e-2", "5e-3", "2.5e-3"];
/// And meshes that are displaced alone.
const ALONE: [&str; 6] = ["1e-2", "5e-3", "2.5e-3", "1.25e-3", "6e-4", "3e-4"];

fn main() {
    let Some(corpus) = corpus("the table of splits") else { return };
    let mut models = Vec::new();
    for case in Case::all(&corpus) {
        let alone: Vec<Row> = ALONE.iter().map(|tolerance| case.row(tolerance, false)).collect();
        let split: Vec<Row> = SPLIT.iter().map(|tolerance| case.row(tolerance, true)).collect();
        models.push(page::Model { name: case.name, alone, split });
    }
    let folder = repository().join("tests/charts");
    std::fs::write(folder.join("split.csv"), page::csv(&models)).expect("the table can be written");
    std::fs::write(folder.join("split.md"), page::markdown(&models)).expect("the page can be written");
}
