//! The job that makes images: as `displace` up to the surface, then render and encode.

use super::{AssetReader, JobLimits, Work, WorkContext, WorkOutput, work::canonical};
use crate::domain::{Error, Result, report::Estimate, request::RenderRequest};

/// Host bytes of a pixel while it is resolved and encoded: linear RGBA f32, and AOVs of up to three f32.
const BYTES_PER_PIXEL: u64 = 16 + 5 * 12;

pub(super) struct RenderWork {
    pub(super) request: RenderRequest,
}

impl Work for RenderWork {
    fn kind(&self) -> &'static str {
        "render"
    }

    fn method(&self) -> &'static str {
        self.request.surface.method.name()
    }

    fn canonical(&self) -> Vec<u8> {
        canonical(&self.request)
    }

    fn host_bytes(&self) -> u64 {
        let inputs: u64 = self.request.surface.assets().iter().map(|asset| asset.size_bytes).sum();
        inputs + u64::from(self.request.width) * u64::from(self.request.height) * BYTES_PER_PIXEL
    }

    fn run(&self, _context: &WorkContext<'_>) -> Result<WorkOutput> {
        Err(Error::unsupported("render", "is not joined to the executors yet"))
    }
}

pub(super) fn estimate(_: &dyn AssetReader, _: &JobLimits, _: &RenderRequest) -> Result<Estimate> {
    Err(Error::unsupported("estimate", "is not joined to the loader yet"))
}
