//! What the flags mean: groups of details in the order typed, the method chosen, contradictions refused.
//! Nothing here reads a file or speaks to a server.

mod detail;
mod layer;

pub(crate) use detail::{MaterialGroup, groups};
pub(crate) use layer::{Layer, Modifiers, Source};

use crate::{
    args::{GeometryArgs, MethodArg},
    error::{Error, Result},
};

/// The method asked for, or the one that realises the details given.
pub(crate) fn method(asked: Option<MethodArg>, groups: &[MaterialGroup], when_plain: MethodArg) -> MethodArg {
    let sources = || groups.iter().flat_map(|group| &group.layers).map(|layer| &layer.source);
    match asked {
        Some(method) => method,
        None if groups.is_empty() => when_plain,
        None if sources().any(Source::is_vector) => MethodArg::Vector,
        None if sources().all(Source::is_normal) => MethodArg::Normal,
        None => MethodArg::Displacement,
    }
}

/// A render whose method moves vertices is told how finely.
pub(crate) fn require_refinement(geometry: &GeometryArgs, method: MethodArg) -> Result<()> {
    if geometry.is_refined() {
        return Ok(());
    }
    if let Some(flag) = geometry.tolerance_flag() {
        let message =
            format!("{flag} says how a tolerance is kept, and there is none; add for example --tolerance 1e-3");
        return Err(Error::usage(flag, message));
    }
    if !method.moves_vertices() {
        return Ok(());
    }
    let message = "--tolerance SHARE or --uniform LEVEL is missing: render with a method that moves vertices splits triangles, as few as stay within SHARE of the diagonal or each into 4^LEVEL; add for example --tolerance 1e-3 or --uniform 5";
    Err(Error::usage("--tolerance", message))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::args::QualityArg;

    fn group(source: Source) -> MaterialGroup {
        let layer = Layer { source, modifiers: Modifiers::default() };
        MaterialGroup { material: None, uv_set: 0, layers: vec![layer] }
    }

    #[test]
    fn the_method_follows_the_details() {
        let height = [group(Source::Height("h.png".into()))];
        let vector = [group(Source::Vector("v.exr".into()))];
        assert_eq!(method(None, &height, MethodArg::Flat), MethodArg::Displacement);
        assert_eq!(method(None, &vector, MethodArg::Flat), MethodArg::Vector);
        let normal = [group(Source::Normal("n.png".into()))];
        let beside = [group(Source::Normal("n.png".into())), group(Source::Height("h.png".into()))];
        assert_eq!(method(None, &normal, MethodArg::Flat), MethodArg::Normal);
        assert_eq!(method(None, &beside, MethodArg::Flat), MethodArg::Displacement);
        assert_eq!(method(None, &[], MethodArg::Flat), MethodArg::Flat);
        assert_eq!(method(Some(MethodArg::Flat), &height, MethodArg::Displacement), MethodArg::Flat);
    }

    #[test]
    fn a_render_that_moves_no_vertices_goes_without_refinement() {
        let none = GeometryArgs::default();
        for still in [MethodArg::Flat, MethodArg::Bump, MethodArg::Normal] {
            assert!(require_refinement(&none, still).is_ok());
        }
        let refused = require_refinement(&none, MethodArg::Displacement);
        assert_eq!(refused.err().and_then(|e| e.field).as_deref(), Some("--tolerance"));
        assert!(require_refinement(&none.clone().or_tolerance(), MethodArg::Displacement).is_ok());
        let idle = GeometryArgs { quality: Some(QualityArg::High), ..none };
        let refused = require_refinement(&idle, MethodArg::Flat);
        assert_eq!(refused.err().and_then(|e| e.field).as_deref(), Some("--quality"));
    }
}
