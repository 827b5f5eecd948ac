//! `cargo gallery [NAME ...]` draws the page `tests/gallery/index.html` with its pictures: all of them, or those whose
//! names begin with a NAME, by running the command line `displace` on meshes and maps made here.
//!
//! `table` has a row for each picture; `scenes` and `maps` make what they are drawn of, `page` puts them together.
//! `cargo gallery corpus [NAME ...]` draws it of the maps of `DISPLACE_CORPUS` into `target/gallery` instead.
//!
//! What a picture was measured by is kept in `figures.json`, so that one can be drawn again alone.

mod arrows;
mod bytes;
mod corpus;
mod displace;
mod draw;
mod maps;
mod page;
mod pixels;
mod scenes;
mod table;

use std::{
    collections::BTreeMap,
    env,
    error::Error,
    fs,
    path::{Path, PathBuf},
    process::ExitCode,
};

use displace_tests::data::{package, repository};

/// What went wrong, in words.
pub(crate) type Result<T> = std::result::Result<T, Box<dyn Error>>;

/// What is printed beside pictures, by name: mean FLIP, bytes.
pub(crate) type Figures = BTreeMap<String, f64>;

/// All files of the page together, and each picture.
const MOST_BYTES: u64 = 4 << 20;
const MOST_PICTURE_BYTES: u64 = 60_000;

fn main() -> ExitCode {
    let words: Vec<String> = env::args().skip(1).collect();
    // The pictures' commands run this program again, as `displace`.
    if words.first().is_some_and(|word| word == displace::NAME) {
        return ExitCode::from(displace_client::run(words, &mut std::io::stdout(), &mut std::io::stderr()));
    }
    match gallery(&words) {
        Ok(()) => ExitCode::SUCCESS,
        Err(error) => {
            eprintln!("gallery: {error}");
            ExitCode::FAILURE
        }
    }
}

fn gallery(wanted: &[String]) -> Result<()> {
    let mut folder = package().join("gallery");
    let scratch = tempfile::tempdir()?;
    scenes::write(scratch.path())?;
    maps::write(scratch.path())?;
    let mut wanted = wanted;
    if let [first, rest @ ..] = wanted
        && first == "corpus"
    {
        let corpus = env::var_os("DISPLACE_CORPUS").ok_or("`corpus` asks for maps that DISPLACE_CORPUS names")?;
        corpus::write(Path::new(&corpus), scratch.path())?;
        (folder, wanted) = (repository().join("target/gallery"), rest);
        fs::create_dir_all(&folder)?;
    }
    let displace = displace::Displace::new(scratch.path());
    let sections = table::sections();
    let record = folder.join("figures.json");
    let mut figures: Figures =
        fs::read(&record).ok().map_or(Ok(Figures::new()), |text| serde_json::from_slice(&text))?;
    let is_wanted = |name: &str| wanted.is_empty() || wanted.iter().any(|start| name.starts_with(start.as_str()));
    let mut drawing = draw::Drawing::new(&displace, &sections, &folder, &mut figures);
    for picture in sections.iter().flat_map(table::Section::pictures).filter(|picture| is_wanted(&picture.name)) {
        drawing.draw(picture)?;
    }
    if is_wanted("bytes") {
        bytes::measure(&displace, &mut figures)?;
    }
    fs::write(&record, serde_json::to_string_pretty(&figures)? + "\n")?;
    let (html, files) = page::html(&sections, &folder, &figures);
    fs::write(folder.join("index.html"), &html)?;
    weigh(html.len() as u64, &files)
}

/// Refuses a page that is too large to be kept in the repository.
fn weigh(page: u64, files: &[PathBuf]) -> Result<()> {
    let mut all = page;
    for file in files {
        let bytes = fs::metadata(file)?.len();
        all += bytes;
        if bytes > MOST_PICTURE_BYTES {
            return Err(format!("{} has {bytes} bytes, more than {MOST_PICTURE_BYTES}", file.display()).into());
        }
    }
    println!("{} pictures, {all} bytes", files.len());
    if all > MOST_BYTES { Err(format!("the page has {all} bytes, more than {MOST_BYTES}").into()) } else { Ok(()) }
}
