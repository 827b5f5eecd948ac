//! Draws a picture of the table: runs its command, compares it with its truth, and writes it small.

use std::{
    fs,
    path::{Path, PathBuf},
};

use image::imageops;
use serde_json::Value;

use crate::{
    Figures, Result,
    displace::{Displace, words},
    pixels,
    table::{Picture, Section, Source},
};

pub(crate) struct Drawing<'a> {
    displace: &'a Displace,
    sections: &'a [Section],
    folder: &'a Path,
    figures: &'a mut Figures,
}

impl<'a> Drawing<'a> {
    pub(crate) fn new(
        displace: &'a Displace,
        sections: &'a [Section],
        folder: &'a Path,
        figures: &'a mut Figures,
    ) -> Self {
        Self { displace, sections, folder, figures }
    }

    /// Writes a picture and its difference. One that this build cannot draw is left out, and said to be.
    pub(crate) fn draw(&mut self, picture: &Picture) -> Result<()> {
        let Some(raw) = self.raw(picture)? else { return Ok(()) };
        let shown = pixels::read(&raw)?;
        let small = match &picture.source {
            Source::Map(_) => pixels::colored(&shown)?,
            _ => pixels::indexed(&shown, colors_of(&picture.name))?,
        };
        self.keep(&picture.name, small)?;
        if let Some(truth) = &picture.against {
            self.compare(picture, truth, &raw)?;
        }
        println!("{}", picture.name);
        Ok(())
    }

    /// The picture as its command draws it, in the scratch folder. None where there is nothing to draw.
    fn raw(&self, picture: &Picture) -> Result<Option<PathBuf>> {
        let (line, beside) = match &picture.source {
            Source::Render(line) => (line, None),
            Source::Beside(line, name) => (line, Some(*name)),
            Source::Map(file) => return Ok(Some(self.displace.folder().join(file))),
            Source::Kept { .. } => return Ok(None),
        };
        let mut words = words(line);
        let out = self.displace.folder().join(format!("{}.png", picture.name.replace('/', "-")));
        let result = beside.map_or_else(|| out.clone(), |name| out.with_extension(format!("{name}.png")));
        if !result.exists() {
            words.extend(["--quiet", "-o"].map(str::to_owned));
            words.push(out.display().to_string());
            if !self.displace.draws(&picture.name, &words)? {
                return Ok(None);
            }
        }
        Ok(Some(result))
    }

    /// FLIP of a picture against its truth: the mean is kept, and the picture of it at half the size.
    fn compare(&mut self, picture: &Picture, truth: &str, raw: &Path) -> Result<()> {
        let mut all = self.sections.iter().flat_map(Section::pictures);
        let truth = all.find(|picture| picture.name == *truth).ok_or_else(|| format!("there is no picture {truth}"))?;
        let Some(reference) = self.raw(truth)? else { return Ok(()) };
        let difference = raw.with_extension("flip.png");
        let files = [&reference, &raw.to_owned(), &difference].map(|path| path.display().to_string());
        let line = ["compare", &files[0], &files[1], "--json", "-o", &files[2]].map(str::to_owned);
        let report: Value = serde_json::from_str(&self.displace.run(&line)?)?;
        let mean = report["flip_mean"].as_f64().ok_or("the comparison has no mean")?;
        self.figures.insert(format!("{} flip", picture.name), (mean * 1e4).round() / 1e4);
        let shown = pixels::read(&difference)?;
        let half = imageops::resize(&shown, shown.width() / 2, shown.height() / 2, imageops::FilterType::Triangle);
        self.keep(&difference_of(&picture.name), pixels::indexed(&half, 20)?)
    }

    fn keep(&self, name: &str, bytes: Vec<u8>) -> Result<()> {
        let file = self.folder.join(format!("{name}.png"));
        fs::create_dir_all(file.parent().ok_or("a picture lies in a folder")?)?;
        fs::write(file, bytes)?;
        Ok(())
    }
}

/// Pictures that are compared are many, and of few hues.
fn colors_of(name: &str) -> usize {
    let topic = name.split('/').next().unwrap_or_default();
    match topic {
        "brick" | "rock" | "tiles" | "cube" => 44,
        "failures" => 80,
        _ => 128,
    }
}

/// The name of the picture that shows how far another is from its truth.
pub(crate) fn difference_of(name: &str) -> String {
    format!("{name}-flip")
}
