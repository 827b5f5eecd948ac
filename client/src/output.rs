//! What the user sees: data on stdout, progress on stderr, files replaced whole.

mod file;
mod human;
mod progress;

use std::io::{ErrorKind, Write};

pub(crate) use file::Target;
pub(crate) use human::{bytes, count, duration_ms};
pub(crate) use progress::{Bar, Progress};

use crate::error::{Error, Kind, Result};

/// Where a command writes.
pub(crate) struct Terminal<'t> {
    pub(crate) stdout: &'t mut (dyn Write + Send),
    pub(crate) stderr: &'t mut (dyn Write + Send),
    /// Whether stderr shows moving progress.
    pub(crate) interactive: bool,
    pub(crate) json: bool,
    pub(crate) quiet: bool,
}

impl Terminal<'_> {
    /// A report as JSON, or, unless quiet, in words.
    pub(crate) fn report(&mut self, json: &serde_json::Value, words: &str) -> Result<()> {
        if self.json {
            let text = serde_json::to_string_pretty(json).map_err(|e| Error::internal(e.to_string()))?;
            return self.data(format!("{text}\n").as_bytes());
        }
        if self.quiet { Ok(()) } else { self.data(words.as_bytes()) }
    }

    /// Bytes for stdout. A reader that has left is no fault: `displace assets ls | head` ends well.
    pub(crate) fn data(&mut self, data: &[u8]) -> Result<()> {
        match self.stdout.write_all(data).and_then(|()| self.stdout.flush()) {
            Err(e) if e.kind() == ErrorKind::BrokenPipe => Ok(()),
            Err(e) => Err(Error::new(Kind::Io, format!("stdout cannot be written: {e}"))),
            Ok(()) => Ok(()),
        }
    }

    /// The end of a command that failed.
    pub(crate) fn fail(&mut self, error: &Error) {
        if self.json {
            let _ = self.data(format!("{}\n", error.to_json()).as_bytes());
        }
        let _ = writeln!(self.stderr, "displace: {error}");
    }

    pub(crate) fn progress(&self) -> Progress {
        Progress::new(self.interactive && !self.quiet)
    }
}
