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
    let mut sources = groups.iter().flat_map(|group| &group.layers).map(|layer| &layer.source);
    match asked {
        Some(method) => method,
        None if groups.is_empty() => when_plain,
        None if sources.any(Source::is_vector) => MethodArg::Vector,
        None => MethodArg::Displacement,
    }
}

/// Until a tolerance can choose the triangles, a method that moves vertices needs `--uniform`.
pub(crate) fn require_level(geometry: &GeometryArgs, method: MethodArg, command: &str) -> Result<()> {
    let displaces = command == "apply" || method != MethodArg::Flat;
    if geometry.uniform.is_some() || !displaces {
        return Ok(());
    }
    let message = format!(
        "--uniform LEVEL is missing: {command} with a method that moves vertices splits every triangle into 4^LEVEL, LEVEL 0 to 12; add for example --uniform 5"
    );
    Err(Error::usage("--uniform", message))
}

#[cfg(test)]
mod tests {
    use super::*;

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
        assert_eq!(method(None, &[], MethodArg::Flat), MethodArg::Flat);
        assert_eq!(method(Some(MethodArg::Flat), &height, MethodArg::Displacement), MethodArg::Flat);
    }

    #[test]
    fn only_a_flat_render_goes_without_a_level() {
        let none = GeometryArgs::default();
        assert!(require_level(&none, MethodArg::Flat, "render").is_ok());
        for (method, command) in [(MethodArg::Displacement, "render"), (MethodArg::Flat, "apply")] {
            let refused = require_level(&none, method, command);
            assert_eq!(refused.err().and_then(|e| e.field).as_deref(), Some("--uniform"));
        }
    }
}
