//! The job that makes displaced geometry: load, plan, execute, write.

use super::{AssetReader, JobLimits, Work, WorkContext, WorkOutput, work::canonical};
use crate::domain::{Digest, Error, Result, describe::Description, report::Estimate, request::DisplaceRequest};

pub(super) struct DisplaceWork {
    pub(super) request: DisplaceRequest,
}

impl Work for DisplaceWork {
    fn kind(&self) -> &'static str {
        "displace"
    }

    fn method(&self) -> &'static str {
        self.request.method.name()
    }

    fn canonical(&self) -> Vec<u8> {
        canonical(&self.request)
    }

    fn host_bytes(&self) -> u64 {
        self.request.assets().iter().map(|asset| asset.size_bytes).sum()
    }

    fn run(&self, _context: &WorkContext<'_>) -> Result<WorkOutput> {
        Err(Error::unsupported("displace", "is not joined to the executors yet"))
    }
}

pub(super) fn describe(_: &dyn AssetReader, _: &Digest, _: &[(String, Digest)]) -> Result<Description> {
    Err(Error::unsupported("describe", "is not joined to the loader yet"))
}

pub(super) fn estimate(_: &dyn AssetReader, _: &JobLimits, _: &DisplaceRequest) -> Result<Estimate> {
    Err(Error::unsupported("estimate", "is not joined to the loader yet"))
}
