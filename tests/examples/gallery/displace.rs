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
}

/// What a command line says of a method, flag or value that this build does not have.
const UNKNOWN: [&str; 3] = ["unexpected argument", "invalid value", "is not a method that this version has"];

impl Displace {
    /// Of a folder with the files that commands name.
    pub(crate) fn new(folder: &Path) -> Self {
        Self { folder: folder.to_owned() }
    }

    pub(crate) fn folder(&self) -> &Path {
        &self.folder
    }

    /// Runs a command; false, and a line on standard error, where this build lacks what it asks for.
    pub(crate) fn draws(&self, name: &str, words: &[String]) -> Result<bool> {
        let Err(error) = self.run(words) else { return Ok(true) };
        let told = error.to_string();
        match told.lines().find(|line| UNKNOWN.iter().any(|unknown| line.contains(unknown))) {
            Some(line) => eprintln!("{name} is left out: {line}"),
            None => return Err(error),
        }
        Ok(false)
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
