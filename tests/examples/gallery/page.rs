//! The page: plain HTML beside its pictures, no script, nothing from the network.

use std::{
    fmt::Write as _,
    path::{Path, PathBuf},
};

use crate::{
    Figures, bytes,
    draw::difference_of,
    table::{Kind, Picture, Row, Section, Source},
};

const STYLE: &str = include_str!("style.css");

/// The page, and the pictures it shows that are there.
pub(crate) fn html(sections: &[Section], folder: &Path, figures: &Figures) -> (String, Vec<PathBuf>) {
    let mut page = Page { html: String::new(), folder, figures, files: Vec::new() };
    page.head(sections);
    for section in sections {
        page.section(section);
    }
    page.html += &bytes::table(figures);
    page.html += FOOTER;
    (page.html, page.files)
}

struct Page<'a> {
    html: String,
    folder: &'a Path,
    figures: &'a Figures,
    files: Vec<PathBuf>,
}

impl Page<'_> {
    fn head(&mut self, sections: &[Section]) {
        let _ = write!(
            self.html,
            "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n<meta name=\"viewport\" \
             content=\"width=device-width,initial-scale=1\">\n<title>Displace: gallery</title>\n<style>\n{STYLE}</style>\n\
             <main>\n<header>\n<h1>Surface mapping, drawn again</h1>\n{INTRODUCTION}<nav>"
        );
        for section in sections {
            let _ = write!(self.html, "<a href=\"#{}\">{}</a> ", section.id, escaped(&section.title));
        }
        self.html += "<a href=\"#bytes\">Bytes</a></nav>\n</header>\n";
    }

    fn section(&mut self, section: &Section) {
        let _ = writeln!(
            self.html,
            "<section id=\"{}\">\n<h2>{}</h2>\n<p class=\"lead\">{}</p>",
            section.id,
            escaped(&section.title),
            marked(&section.text)
        );
        if section.kind == Kind::Compared {
            self.compared(section)
        } else {
            section.rows.iter().for_each(|row| self.row(row))
        }
        self.html += "</section>\n";
    }

    /// A figure: pictures side by side over what is to be seen.
    fn row(&mut self, row: &Row) {
        if !row.pictures.iter().any(|picture| self.is_there(&picture.name, &picture.source)) {
            return;
        }
        let _ = writeln!(
            self.html,
            "<article>\n<h3>{}</h3>\n<p>{}</p>\n<div class=\"figures{}\">",
            marked(&row.title),
            marked(&row.text),
            if row.pictures.len() > 4 { " five" } else { "" }
        );
        for picture in &row.pictures {
            self.figure(picture);
        }
        self.html += "</div>\n</article>\n";
    }

    fn figure(&mut self, picture: &Picture) {
        let Some(image) = self.image(&picture.name, &picture.source, &picture.note) else { return };
        let _ = write!(self.html, "<figure>{image}");
        if let Some(difference) = picture.against.as_ref().and_then(|_| self.difference(picture)) {
            self.html += &difference;
        }
        let _ = writeln!(self.html, "<figcaption>{}{}</figcaption></figure>", marked(&picture.note), command(picture));
    }

    /// Rows of a table, the first of which is the truth of all; it stays in sight, and shows in place of what is touched.
    fn compared(&mut self, section: &Section) {
        self.html += "<div class=\"compared\">\n";
        for (at, row) in section.rows.iter().enumerate() {
            if !row.pictures.iter().any(|picture| self.is_there(&picture.name, &picture.source)) {
                continue;
            }
            let class = if at == 0 { " truth" } else { "" };
            let _ = writeln!(
                self.html,
                "<div class=\"line{class}\"><div class=\"told\"><h3>{}</h3><p>{}</p></div>",
                escaped(&row.title),
                marked(&row.text)
            );
            for picture in &row.pictures {
                self.cell(picture);
            }
            self.html += "</div>\n";
        }
        self.html += "</div>\n";
    }

    fn cell(&mut self, picture: &Picture) {
        let Some(image) = self.image(&picture.name, &picture.source, &picture.note) else { return };
        let truth = picture
            .against
            .as_ref()
            .map(|name| format!(" style=\"background-image:url({name}.png)\""))
            .unwrap_or_default();
        let _ = write!(self.html, "<figure><div class=\"blink\"{truth}>{image}</div>");
        if let Some(difference) = self.difference(picture) {
            self.html += &difference;
        }
        let _ = writeln!(self.html, "<figcaption>{}{}</figcaption></figure>", marked(&picture.note), command(picture));
    }

    fn difference(&mut self, picture: &Picture) -> Option<String> {
        picture.against.as_ref()?;
        let name = difference_of(&picture.name);
        let mean = self.figures.get(&format!("{} flip", picture.name))?;
        let image = self.image(&name, &Source::Map(""), "difference from the truth")?;
        Some(format!("<div class=\"difference\">{image}<span>mean FLIP {mean:.4}</span></div>"))
    }

    fn image(&mut self, name: &str, source: &Source, told: &str) -> Option<String> {
        if !self.is_there(name, source) {
            return None;
        }
        let file = file_of(name, source);
        let path = self.folder.join(&file);
        let (width, height) = image::image_dimensions(&path).ok()?;
        self.files.push(path);
        Some(format!(
            "<img src=\"{file}\" width=\"{width}\" height=\"{height}\" alt=\"{}\" loading=\"lazy\">",
            escaped(told)
        ))
    }

    fn is_there(&self, name: &str, source: &Source) -> bool {
        self.folder.join(file_of(name, source)).exists()
    }
}

fn file_of(name: &str, source: &Source) -> String {
    match source {
        Source::Kept { file, .. } => (*file).to_owned(),
        _ => format!("{name}.png"),
    }
}

/// What draws the picture, to be typed.
fn command(picture: &Picture) -> String {
    let line = match &picture.source {
        Source::Render(line) | Source::Beside(line, _) => format!("displace {line}"),
        Source::Kept { command, .. } => (*command).to_owned(),
        Source::Map(file) => format!("{file}, by tests/examples/gallery/maps.rs"),
    };
    format!("<details><summary>command</summary><code>{}</code></details>", escaped(&line))
}

/// Escaped text in which `code` is set as such.
fn marked(text: &str) -> String {
    let mut html = String::new();
    for (at, part) in escaped(text).split('`').enumerate() {
        let _ = if at % 2 == 1 { write!(html, "<code>{part}</code>") } else { write!(html, "{part}") };
    }
    html
}

pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

const INTRODUCTION: &str = "<p class=\"lead\">Three texts began this: West's report on surface mapping and non-linear \
displacement (2007), Everson's lecture on texture and bump mapping, and CySlice's page on displacement with normal maps. Their \
figures are drawn here anew, with what they left out, and with what they print wrong beside what is right. After them every \
method that shows depth stands beside the surface that it imitates.</p>\n\
<p>Every picture is one command line, shown under it, over meshes and maps that <code>cargo gallery</code> makes. \
FLIP (Andersson et al. 2020) is what the eye sees when two pictures alternate: 0 is the same, 1 is the most. Texture filters, \
opacity, shadows and reflections have <a href=\"README.md\">a page of their own</a>.</p>\n";

const FOOTER: &str = "<footer>Rock by ambientCG (CC0), abstract map by 3dtextures.me (CC0). Heads: Infinite, 3D Head Scan by Lee \
Perry-Smith, ir-ltd.net, based on a work at www.triplegangers.com, CC BY 3.0, displaced, coloured and lit. All else is made by \
<code>cargo gallery</code>. <a href=\"README.md\">The other pictures</a>.</footer>\n</main>\n</html>\n";
