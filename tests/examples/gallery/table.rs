//! What the page shows: sections of figures, each picture a command line and what to look for.

mod cyslice;
mod everson;
mod failures;
mod family;
mod printed;
mod west;

/// Where a picture comes from.
#[derive(Clone, Debug)]
pub(crate) enum Source {
    /// A command line.
    Render(String),
    /// A command line, and the name of what it writes beside its image: an AOV.
    Beside(String, &'static str),
    /// A map that is shown as it is.
    Map(&'static str),
    /// A picture that something else draws.
    Kept { file: &'static str, command: &'static str },
}

#[derive(Clone, Debug)]
pub(crate) struct Picture {
    /// Folder and stem of its file.
    pub(crate) name: String,
    pub(crate) source: Source,
    /// What it is, and what to look for.
    pub(crate) note: String,
    /// The picture that shows the truth.
    pub(crate) against: Option<String>,
}

/// Pictures that are seen side by side.
#[derive(Clone, Debug)]
pub(crate) struct Row {
    pub(crate) title: String,
    pub(crate) text: String,
    pub(crate) pictures: Vec<Picture>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Kind {
    Figures,
    /// Rows of three pictures, the first row the truth of the others.
    Compared,
}

#[derive(Clone, Debug)]
pub(crate) struct Section {
    pub(crate) id: &'static str,
    pub(crate) title: String,
    pub(crate) text: String,
    pub(crate) kind: Kind,
    pub(crate) rows: Vec<Row>,
}

impl Section {
    pub(crate) fn pictures(&self) -> impl Iterator<Item = &Picture> {
        self.rows.iter().flat_map(|row| &row.pictures)
    }
}

/// All of the page but its table of bytes.
pub(crate) fn sections() -> Vec<Section> {
    let mut sections = vec![west::section(), everson::section(), cyslice::section(), printed::section()];
    sections.extend(family::sections());
    sections.push(failures::section());
    sections
}

fn figures(id: &'static str, title: &str, text: &str, rows: Vec<Row>) -> Section {
    Section { id, title: title.to_owned(), text: text.to_owned(), kind: Kind::Figures, rows }
}

fn row<const N: usize>(title: &str, text: &str, pictures: [Picture; N]) -> Row {
    Row { title: title.to_owned(), text: text.to_owned(), pictures: pictures.to_vec() }
}

fn render(name: &str, line: impl AsRef<str>, note: &str) -> Picture {
    picture(name, Source::Render(format!("render {}", line.as_ref())), note)
}

fn picture(name: &str, source: Source, note: &str) -> Picture {
    Picture { name: name.to_owned(), source, note: note.to_owned(), against: None }
}

impl Picture {
    fn against(self, truth: &str) -> Self {
        Self { against: Some(truth.to_owned()), ..self }
    }
}
