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
        None if are_normals(groups) => MethodArg::Normal,
        None => MethodArg::Displacement,
    }
}

/// Whether there is something, and nothing but normal maps.
pub(crate) fn are_normals(groups: &[MaterialGroup]) -> bool {
    let mut sources = groups.iter().flat_map(|group| &group.layers).map(|layer| &layer.source);
    !groups.is_empty() && sources.all(Source::is_normal)
}

/// What says how a tolerance is kept is for methods that keep one.
pub(crate) fn refuse_idle(geometry: &GeometryArgs, method: MethodArg) -> Result<()> {
    if geometry.is_refined() || method.keeps_tolerance() {
        return Ok(());
    }
    let Some(flag) = geometry.tolerance_flag() else { return Ok(()) };
    let message = format!("{flag} says how a tolerance is kept, and there is none; add for example --tolerance 1e-3");
    Err(Error::usage(flag, message))
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
    fn what_says_how_a_tolerance_is_kept_needs_one() {
        let none = GeometryArgs::default();
        for method in [MethodArg::Flat, MethodArg::Bump, MethodArg::Exact, MethodArg::Displacement] {
            assert!(refuse_idle(&none, method).is_ok());
        }
        let idle = GeometryArgs { quality: Some(QualityArg::High), ..none };
        let refused = refuse_idle(&idle, MethodArg::Flat);
        assert_eq!(refused.err().and_then(|e| e.field).as_deref(), Some("--quality"));
        for method in [MethodArg::Displacement, MethodArg::Auto] {
            assert!(refuse_idle(&idle, method).is_ok(), "within pixels of the image by default");
        }
    }
}
