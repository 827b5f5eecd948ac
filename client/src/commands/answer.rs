//! Jobs whose report is the answer: their files are written only where the user named one.

use std::path::Path;

use displace_proto::v1::Report;

use super::{
    Session,
    surface::{output, save},
};
use crate::{
    error::{Error, Result},
    jobs::{self, Job},
    output::{Progress, Target},
    request::Parcel,
};

/// A file asked for: the output of the job, and where it goes.
pub(super) type Wanted = (&'static str, Target);

/// Where `--output` puts that output of the job. Refuses, before any work, what does not end as the output does.
pub(super) fn wanted(name: &'static str, path: Option<&Path>) -> Result<Option<Wanted>> {
    let Some(path) = path else { return Ok(None) };
    let ending = Path::new(name).extension().unwrap_or_default();
    if !path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case(ending)) {
        let message = format!("{} is written as .{}; end the name so", path.display(), ending.display());
        return Err(Error::usage("--output", message));
    }
    Ok(Some((name, Target::new(path)?)))
}

/// Runs the job, writes what is wanted of it, and gives its report.
pub(super) async fn answer(
    session: &Session,
    job: &Job,
    parcel: &Parcel,
    wanted: Option<Wanted>,
    progress: Progress,
) -> Result<Report> {
    let connection = session.connection().await?;
    let result = jobs::run(connection, job, &parcel.blobs, progress).await?;
    if let Some((name, target)) = wanted {
        save(connection, &[(output(&result, name)?.clone(), target)], progress).await?;
    }
    result.report.ok_or_else(|| Error::internal("the server's result holds no report"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_file_ends_as_what_is_written_to_it() {
        assert!(wanted("difference.png", None).unwrap().is_none());
        assert!(wanted("difference.png", Some(Path::new("d.PNG"))).unwrap().is_some());
        let error = wanted("difference.png", Some(Path::new("d.exr"))).map(|_| ()).unwrap_err();
        assert_eq!(error.field.as_deref(), Some("--output"));
        assert!(error.message.contains("d.exr") && error.message.contains(".png"), "{error}");
    }
}
