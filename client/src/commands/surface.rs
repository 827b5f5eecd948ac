//! What `apply`, `render` and `demo` share: the request for a displaced surface, and its outputs on disk.

use std::path::PathBuf;

use displace_proto::v1::{DisplaceRequest, JobResult, Output, Report};

use super::{Session, blocking};
use crate::{
    args::{CompressArg, GeometryArgs, LookArgs, MethodArg},
    connection::Connection,
    error::{Error, Result},
    options::MaterialGroup,
    output::{Progress, Target, Terminal},
    report::{self, Written},
    request::{self, Parcel},
    transfer::download,
};

/// Everything that decides a displaced surface.
#[derive(Clone, Debug)]
pub(super) struct Surface {
    pub(super) mesh: PathBuf,
    pub(super) groups: Vec<MaterialGroup>,
    pub(super) geometry: GeometryArgs,
    pub(super) look: LookArgs,
    pub(super) method: MethodArg,
    pub(super) compress: CompressArg,
    pub(super) lods: u32,
}

/// What a job left behind.
#[derive(Clone, Debug)]
pub(super) struct Outcome {
    pub(super) report: Report,
    pub(super) written: Vec<Written>,
}

impl Outcome {
    pub(super) fn new(mut result: JobResult, notes: &[String], written: Vec<Written>) -> Self {
        let mut report = result.report.take().unwrap_or_default();
        report.warnings.extend(report::conversion_warnings(notes));
        Self { report, written }
    }

    pub(super) fn tell(&self, terminal: &mut Terminal<'_>) -> Result<()> {
        terminal.report(&report::json(&self.report, &self.written), &report::words(&self.report, &self.written))
    }
}

impl Surface {
    /// The request, and the blobs it names.
    pub(super) async fn request(self, session: &Session) -> Result<(DisplaceRequest, Parcel)> {
        let fresh = session.global.fresh;
        let (mut message, parcel) = blocking(move || self.hashed(fresh)).await?;
        message.linger_secs = Some(session.connection().await?.linger_secs);
        Ok((message, parcel))
    }

    fn hashed(self, fresh: bool) -> Result<(DisplaceRequest, Parcel)> {
        let mut parcel = Parcel::default();
        let message = DisplaceRequest {
            mesh: Some(parcel.mesh(&self.mesh)?),
            details: parcel.details(&self.groups)?,
            method: request::method(self.method).into(),
            geometry: Some(request::geometry(&self.geometry)),
            look: parcel.look(&self.look)?,
            fresh,
            linger_secs: None,
            compression: request::compression(self.compress).into(),
            lods: self.lods,
        };
        Ok((message, parcel))
    }
}

/// Downloads outputs to their files. All are on disk before any is named in a report.
pub(super) async fn save(
    connection: &Connection,
    outputs: &[(Output, Target)],
    progress: Progress,
) -> Result<Vec<Written>> {
    let mut written = Vec::with_capacity(outputs.len());
    for (output, target) in outputs {
        let digest = output.digest.as_ref().ok_or_else(|| unnamed(output))?;
        download(connection, digest, target, &progress).await?;
        written.push(Written {
            path: target.named().display().to_string(),
            digest: format!("{}/{}", digest.hash, digest.size_bytes),
            bytes: digest.size_bytes,
            media_type: output.media_type.clone(),
        });
    }
    Ok(written)
}

fn unnamed(output: &Output) -> Error {
    Error::internal(format!("the server gave no digest for its output '{}'", output.name))
}

/// The output of that name.
pub(super) fn output<'r>(result: &'r JobResult, name: &str) -> Result<&'r Output> {
    let found = result.outputs.iter().find(|output| output.name == name);
    found.ok_or_else(|| Error::internal(format!("the server's result holds no '{name}'")))
}
