//! The page of `cargo gallery` as it is committed.

use std::{collections::BTreeSet, fs, path::PathBuf};

use displace_tests::data::package;

fn folder() -> PathBuf {
    package().join("gallery")
}

fn page() -> String {
    fs::read_to_string(folder().join("index.html")).expect("the page is committed")
}

/// What attributes of a name hold, in the order of the page.
fn values(page: &str, attribute: &str) -> Vec<String> {
    let start = format!("{attribute}=\"");
    let parts = page.split(&start).skip(1);
    parts.map(|part| part.split('"').next().unwrap_or_default().to_owned()).collect()
}

#[test]
fn every_picture_of_the_page_is_there_small_and_described() {
    let page = page();
    let pictures: BTreeSet<String> = values(&page, "src").into_iter().collect();
    assert!(pictures.len() > 100, "{} pictures", pictures.len());
    let mut all = page.len() as u64;
    for picture in &pictures {
        let bytes = fs::metadata(folder().join(picture)).unwrap_or_else(|e| panic!("{picture}: {e}")).len();
        assert!(bytes <= 60_000, "{picture} has {bytes} bytes");
        all += bytes;
    }
    assert!(all <= 4 << 20, "{all} bytes");
    assert!(values(&page, "alt").iter().all(|told| !told.is_empty()));
}

#[test]
fn the_page_asks_nothing_of_a_network_and_all_its_links_lead_somewhere() {
    let page = page();
    let mut links = values(&page, "href");
    links.extend(values(&page, "src"));
    for link in links {
        let is_there = match link.strip_prefix('#') {
            Some(id) => page.contains(&format!("id=\"{id}\"")),
            None => folder().join(&link).exists(),
        };
        assert!(is_there, "{link}");
    }
    assert!(!page.contains("<script"));
    assert!(!page.contains("://"));
}
