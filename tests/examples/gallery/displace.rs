//! Runs the command line, results always computed anew, with a store of its own.

use std::{
    fs,
    path::{Path, PathBuf},
    process::Command,
};

use crate::Result;

/// The word by which this program is told to be the command line.
pub(crate) const NAME: &str = "displace";

pub(crate) struct Displace {
    folder: PathBuf,
    help: String,
}

impl Displace {
    /// Of a folder with the files that commands name.
    pub(crate) fn new(folder: &Path) -> Result<Self> {
        let mut displace = Self { folder: folder.to_owned(), help: String::new() };
        displace.help = displace.run(&words("render --help"))?;
        Ok(displace)
    }

    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    /// The first method or flag of a command line that this build does not have.
    pub(crate) fn lacks(&self, words: &[String]) -> Option<String> {
        let method = words.iter().position(|word| word == "--method").and_then(|at| words.get(at + 1));
        let told = self.help.split("--method ").nth(1).and_then(|text| text.split("\n      --").next()).unwrap_or("");
        let has = |method: &str| told.split(|c: char| !c.is_alphanumeric() && c != '-').any(|word| word == method);
        if let Some(method) = method.filter(|method| !has(method)) {
            return Some(format!("--method {method}"));
        }
        let is_known = |flag: &str| self.help.split_whitespace().any(|word| word.trim_end_matches(',') == flag);
        words.iter().find(|word| word.starts_with("--") && !is_known(word)).cloned()
    }

    /// What a command prints.
    pub(crate) fn run(&self, words: &[String]) -> Result<String> {
        let mut command = Command::new(std::env::current_exe()?);
        for (variable, name) in [("XDG_DATA_HOME", "data"), ("XDG_CONFIG_HOME", "config")] {
            let folder = self.folder.join(name);
            fs::create_dir_all(&folder)?;
            command.env(variable, folder);
        }
        let done = command.env_remove("DISPLACE_SERVER").current_dir(&self.folder).arg(NAME).args(words).output()?;
        if done.status.success() {
            return Ok(String::from_utf8(done.stdout)?);
        }
        Err(format!("displace {}\n{}", words.join(" "), String::from_utf8_lossy(&done.stderr)).into())
    }
}

/// The words of a command line; single quotes hold one together.
pub(crate) fn words(line: &str) -> Vec<String> {
    let (mut words, mut quoted) = (Vec::new(), false);
    for part in line.split('\'') {
        if quoted {
            words.push(part.to_owned())
        } else {
            words.extend(part.split_whitespace().map(str::to_owned))
        }
        quoted = !quoted;
    }
    words
}
