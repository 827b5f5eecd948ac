//! Predicted beside measured errors of every method on 10 000 random patches, views and maps, and estimated beside counted
//! triangles on maps of the corpus. Writes `tests/charts/predicted.csv`, `predicted_triangles.csv` and `predicted.md`.
//!
//! `DISPLACE_CORPUS=... cargo bench --profile dev -p displace-tests --bench predicted`

use displace_tests::{
    data::repository,
    predicted::{case, counts, maps, measured, table},
};

const PATCHES: u64 = 10_000;
const RAYS: usize = 200;

fn main() {
    let maps = maps::all();
    let rows = measured(&maps, 0..PATCHES, RAYS);
    let worse = rows.violations();
    let worse = worse.iter().map(|row| format!("{row:?} on {}", case(&maps, row.seed).0.map.name)).collect::<Vec<_>>();
    let csv = table::csv(&rows.summaries());
    let triangles = counts::csv(&counts::of_corpus());
    print!("{csv}\n{triangles}\n{}\n", worse.join("\n"));
    write("predicted.csv", &csv);
    write("predicted_triangles.csv", &triangles);
    write("predicted.md", &table::page(&rows.by_method(), &worse, &triangles));
}

fn write(name: &str, text: &str) {
    std::fs::write(repository().join("tests/charts").join(name), text).expect("the chart can be written");
}
