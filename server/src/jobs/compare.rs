//! The job that compares two images. It needs no device: all of it runs on the job's thread and its helpers.

use super::{JobLimits, Output, Work, WorkContext, WorkOutput, inputs::timed, work::canonical};
use crate::{
    domain::{Digest, Result, encode, report::Report, request::CompareRequest},
    oracle::metrics::{
        self,
        picture::{self, Picture},
    },
};

pub(super) struct CompareWork {
    pub(super) request: CompareRequest,
}

impl Work for CompareWork {
    fn kind(&self) -> &'static str {
        "compare"
    }

    fn method(&self) -> &'static str {
        "images"
    }

    fn canonical(&self) -> Vec<u8> {
        canonical(&self.request)
    }

    /// The files alone: the size of the images is in them.
    fn host_bytes(&self) -> u64 {
        self.request.a.size_bytes.saturating_add(self.request.b.size_bytes)
    }

    fn run(&self, context: &WorkContext<'_>) -> Result<WorkOutput> {
        let mut passes = Vec::new();
        let CompareRequest { a, b } = &self.request;
        let read = || Ok((picture(context, "a", a)?, picture(context, "b", b)?));
        let (a, b) = timed(context.progress, "read_images", &mut passes, read)?;
        let compare = || metrics::compare(&a, &b, context.cancel);
        let (comparison, errors) = timed(context.progress, "compare", &mut passes, compare)?;
        let encode = || encode::encode_rgb8(errors.width, errors.height, &errors.colors());
        let bytes = timed(context.progress, "encode", &mut passes, encode)?;
        let output = Output { name: "difference.png".into(), media_type: "image/png".into(), bytes: bytes.into() };
        let report = Report { comparison: Some(comparison), passes, ..Report::default() };
        Ok(WorkOutput { report, outputs: vec![output] })
    }
}

fn picture(context: &WorkContext<'_>, field: &str, digest: &Digest) -> Result<Picture> {
    context.cancel.check()?;
    picture::read(field, &context.assets.read(digest)?, limits(context.limits))
}

/// Each image may take half of what a job may.
fn limits(limits: &JobLimits) -> picture::Limits {
    picture::Limits { max_side: limits.max_image_pixels, max_bytes: limits.host_bytes / 2 }
}
