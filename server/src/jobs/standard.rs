//! The jobs this version has.

use super::{AssetReader, JobLimits, Recipes, Work, chart, compare, displace, measure, render, sequence, stability};
use crate::domain::{
    Digest, Result,
    chart::ChartRequest,
    describe::Description,
    report::Estimate,
    request::{CompareRequest, DisplaceRequest, EstimateRequest, MeasureRequest, RenderRequest},
    sequence::SequenceRequest,
};

/// Requests become `displace`, `render`, `measure`, `compare`, `chart` and `sequence` jobs.
pub struct StandardRecipes;

impl Recipes for StandardRecipes {
    fn displace(&self, request: DisplaceRequest) -> Box<dyn Work> {
        Box::new(displace::DisplaceWork { request })
    }

    fn render(&self, request: RenderRequest) -> Box<dyn Work> {
        Box::new(render::RenderWork { request })
    }

    fn sequence(&self, request: SequenceRequest) -> Box<dyn Work> {
        Box::new(sequence::SequenceWork { request })
    }

    fn compare(&self, request: CompareRequest) -> Box<dyn Work> {
        Box::new(compare::CompareWork { request })
    }

    fn chart(&self, request: ChartRequest) -> Box<dyn Work> {
        if request.stability {
            return Box::new(stability::StabilityWork { request });
        }
        Box::new(chart::ChartWork { request })
    }

    fn measure(&self, request: MeasureRequest) -> Box<dyn Work> {
        Box::new(measure::MeasureWork { request })
    }

    fn describe(&self, assets: &dyn AssetReader, mesh: &Digest, resources: &[(String, Digest)]) -> Result<Description> {
        displace::describe(assets, mesh, resources)
    }

    fn estimate(&self, assets: &dyn AssetReader, limits: &JobLimits, request: &EstimateRequest) -> Result<Estimate> {
        match request {
            EstimateRequest::Displace(request) => displace::estimate(assets, limits, request),
            EstimateRequest::Render(request) => render::estimate(assets, limits, request),
        }
    }
}
