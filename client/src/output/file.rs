//! An output file that is replaced whole or not at all: bytes go to a temporary file in the same folder,
//! which takes the name at the end.

use std::{
    fs::{File, Metadata},
    io::{self, BufWriter, Write},
    path::{Path, PathBuf},
};

use tempfile::NamedTempFile;

use crate::error::{Error, Kind, Result};

/// Where an output goes; checked before any work is done.
#[derive(Clone, Debug)]
pub(crate) struct Target {
    /// As the user named it.
    named: PathBuf,
    /// The file itself, behind links.
    path: PathBuf,
    /// A pipe or a device is written to directly: it cannot be replaced.
    direct: bool,
}

impl Target {
    pub(crate) fn new(named: &Path) -> Result<Self> {
        let refuse = |message: String| Error::usage("--output", format!("{} {message}", named.display()));
        if named.as_os_str().is_empty() || named == Path::new("-") {
            return Err(refuse("is no file name; results are files: name one, such as out.glb".to_owned()));
        }
        // Through a link, the file it points to is replaced, not the link.
        let path = named.canonicalize().unwrap_or_else(|_| named.to_owned());
        let target = |direct| Self { named: named.to_owned(), path: path.clone(), direct };
        match path.metadata() {
            Ok(found) if found.is_dir() => Err(refuse("is a folder; name a file in it".to_owned())),
            Ok(found) => Ok(target(!found.is_file())),
            Err(_) if !folder(&path).is_dir() => {
                Err(refuse(format!("cannot be written: there is no folder {}; make it first", folder(&path).display())))
            }
            Err(_) => Ok(target(false)),
        }
    }

    /// As the user named it.
    pub(crate) fn named(&self) -> &Path {
        &self.named
    }

    /// Opens the place where bytes wait for `Pending::finish`.
    pub(crate) fn begin(&self) -> Result<Pending> {
        let failed = |e: io::Error| self.failed(&e);
        if self.direct {
            let file = File::options().write(true).open(&self.path).map_err(failed)?;
            return Ok(Pending { target: self.clone(), sink: Sink::Direct(BufWriter::with_capacity(1 << 20, file)) });
        }
        let file = self.temporary().map_err(failed)?;
        Ok(Pending { target: self.clone(), sink: Sink::Temporary(BufWriter::with_capacity(1 << 20, file)) })
    }

    /// Writes bytes that are in memory.
    pub(crate) fn write(&self, bytes: &[u8]) -> Result<()> {
        let mut pending = self.begin()?;
        pending.write_all(bytes).map_err(|e| self.failed(&e))?;
        pending.finish()
    }

    fn temporary(&self) -> io::Result<NamedTempFile> {
        let mut builder = tempfile::Builder::new();
        builder.prefix(".displace-").suffix(".part");
        #[cfg(unix)]
        {
            use std::os::unix::fs::PermissionsExt;
            // What a new file gets (less the umask), not what a secret one gets.
            builder.permissions(std::fs::Permissions::from_mode(0o666));
        }
        builder.tempfile_in(folder(&self.path))
    }

    fn failed(&self, cause: &io::Error) -> Error {
        Error::new(Kind::Io, format!("{} cannot be written: {cause}", self.named.display())).with_field("--output")
    }
}

fn folder(path: &Path) -> &Path {
    match path.parent() {
        Some(parent) if !parent.as_os_str().is_empty() => parent,
        _ => Path::new("."),
    }
}

/// An output under way; dropped unfinished it leaves no trace.
pub(crate) struct Pending {
    target: Target,
    sink: Sink,
}

enum Sink {
    Temporary(BufWriter<NamedTempFile>),
    Direct(BufWriter<File>),
}

impl Pending {
    /// Gives the bytes their name.
    pub(crate) fn finish(self) -> Result<()> {
        let target = self.target;
        let failed = |e: io::Error| target.failed(&e);
        match self.sink {
            Sink::Direct(mut file) => file.flush().map_err(failed),
            Sink::Temporary(writer) => {
                let file = writer.into_inner().map_err(|e| target.failed(e.error()))?;
                if let Ok(old) = target.path.metadata() {
                    keep_permissions(&file, &old);
                }
                file.persist(&target.path).map(drop).map_err(|e| target.failed(&e.error))
            }
        }
    }
}

/// A replaced file keeps its mode; where that is not allowed the new one has the usual.
fn keep_permissions(file: &NamedTempFile, old: &Metadata) {
    let _ = file.as_file().set_permissions(old.permissions());
}

impl Write for Pending {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match &mut self.sink {
            Sink::Temporary(writer) => writer.write(bytes),
            Sink::Direct(writer) => writer.write(bytes),
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        match &mut self.sink {
            Sink::Temporary(writer) => writer.flush(),
            Sink::Direct(writer) => writer.flush(),
        }
    }
}

#[cfg(test)]
mod tests {
    use std::fs;

    use super::*;

    fn names(folder: &Path) -> Vec<String> {
        let mut names: Vec<_> =
            fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
        names.sort();
        names
    }

    #[test]
    fn an_unfinished_output_leaves_the_old_file_and_nothing_else() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.glb");
        fs::write(&path, "old").unwrap();
        let mut pending = Target::new(&path).unwrap().begin().unwrap();
        pending.write_all(b"new").unwrap();
        drop(pending);
        assert_eq!(fs::read_to_string(&path).unwrap(), "old");
        assert_eq!(names(folder.path()), ["out.glb"]);
    }

    #[test]
    fn a_finished_output_replaces_the_old_file() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("out.glb");
        fs::write(&path, "old and longer").unwrap();
        Target::new(&path).unwrap().write(b"new").unwrap();
        assert_eq!(fs::read_to_string(&path).unwrap(), "new");
        assert_eq!(names(folder.path()), ["out.glb"]);
    }

    #[test]
    fn folders_and_missing_folders_are_refused() {
        let folder = tempfile::tempdir().unwrap();
        for bad in [folder.path().to_owned(), folder.path().join("none/out.glb"), "-".into(), "".into()] {
            let error = Target::new(&bad).expect_err("no file");
            assert_eq!((error.kind, error.field.as_deref()), (Kind::Usage, Some("--output")), "{error}");
        }
    }

    #[cfg(unix)]
    #[test]
    fn links_and_modes_are_kept() {
        use std::os::unix::fs::{PermissionsExt, symlink};
        let folder = tempfile::tempdir().unwrap();
        let (real, link) = (folder.path().join("real"), folder.path().join("link"));
        fs::write(&real, "old").unwrap();
        fs::set_permissions(&real, fs::Permissions::from_mode(0o640)).unwrap();
        symlink(&real, &link).unwrap();
        Target::new(&link).unwrap().write(b"new").unwrap();
        assert!(link.symlink_metadata().unwrap().is_symlink());
        assert_eq!(fs::read_to_string(&real).unwrap(), "new");
        assert_eq!(real.metadata().unwrap().permissions().mode() & 0o777, 0o640);
        Target::new(Path::new("/dev/null")).unwrap().write(b"gone").unwrap();
    }
}
