//! What a scenario says of itself.

use super::lab::Lab;
use crate::domain::{
    Result,
    stability::{Curve, Worse},
};

/// A row of the table.
pub(super) struct Row {
    /// Stem of its drawing.
    pub(super) name: &'static str,
    /// What of the failure matrix it is of.
    pub(super) family: &'static str,
    pub(super) title: &'static str,
    pub(super) story: &'static str,
    pub(super) asset: Asset,
    /// What it is, and in what it is measured.
    pub(super) parameter: [&'static str; 2],
    pub(super) metric: [&'static str; 2],
    /// What passes is no more.
    pub(super) line: f64,
    pub(super) worse: Worse,
    /// By the name of the curve; what is published of it.
    pub(super) literature: &'static [(&'static str, &'static str)],
    pub(super) run: fn(&Lab<'_>) -> Result<Vec<Curve>>,
}

/// What a scenario is measured on.
#[derive(Clone, Copy)]
pub(super) enum Asset {
    /// Made here.
    Made(&'static str),
    /// The heights of the request, in texels; hills where it has none.
    OwnHeights,
    /// Mesh and detail of the request.
    OwnSurface,
}

/// A curve whose breakdown and literature follow from its row.
pub(super) fn curve(method: impl Into<String>, values: Vec<[f64; 2]>) -> Curve {
    Curve { method: method.into(), values, ..Curve::default() }
}
