//! How heights are shown per pixel, from what was typed.

use displace_proto::v1;

use crate::args::{ReliefArgs, SelfShadowArg, SilhouettesArg};

/// None where nothing is said of it.
pub(crate) fn relief(args: &ReliefArgs) -> Option<v1::Relief> {
    let self_shadow = match args.self_shadow {
        SelfShadowArg::None => v1::SelfShadow::Unspecified,
        SelfShadowArg::Hard => v1::SelfShadow::Hard,
        SelfShadowArg::Soft => v1::SelfShadow::Soft,
    };
    let silhouettes = match args.silhouettes {
        SilhouettesArg::None => v1::Silhouettes::Unspecified,
        SilhouettesArg::Shell => v1::Silhouettes::Shell,
        SilhouettesArg::Quadric => v1::Silhouettes::Quadric,
    };
    let relief =
        v1::Relief { steps: args.steps.unwrap_or(0), self_shadow: self_shadow.into(), silhouettes: silhouettes.into() };
    (relief != v1::Relief::default()).then_some(relief)
}
