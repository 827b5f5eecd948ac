//! Where a method is used beyond what it is good for: by how much, and what would do.

use std::sync::Arc;

use displace_glsl::methods::{Method, Needs};

use super::{
    WorkContext,
    auto::{MOST_TEXELS, Seen},
    inputs::Inputs,
};
use crate::domain::{
    Result,
    chart::Setting,
    choose::kept,
    detail::Detail,
    image::{RenderCamera, Silhouettes},
    maps,
    projection::Projection,
    relief::Relief,
    report::Warning,
    request::{Base, Refinement, RenderRequest, Shadows},
};

/// What a method may be off by, pixels: a shift by more is seen where images stand side by side, and in motion.
const LIMIT_PX: f64 = 1.0;

/// One warning for each material that is shown by what may be off by more than [`LIMIT_PX`] in this image. None of maps
/// of more than [`MOST_TEXELS`] texels, whose facts would take more memory than they are worth.
pub(super) fn warnings(
    context: &WorkContext<'_>,
    inputs: &Inputs,
    request: &RenderRequest,
    camera: &RenderCamera,
) -> Result<Vec<Warning>> {
    let Some(setting) = setting(request) else { return Ok(Vec::new()) };
    // What casts no shadow is another question than where it is seen.
    let unlit = {
        let mut unlit = request.clone();
        unlit.look.shadows = Shadows::None;
        unlit
    };
    let mut warnings = Vec::new();
    for (material, relief) in reliefs(context, inputs, request)? {
        if relief.map.heights.len() > MOST_TEXELS {
            continue;
        }
        context.cancel.check()?;
        let seen = Seen::new(&inputs.scene, material, (&relief, kept::facts_of(&relief.map)), camera, &unlit);
        let [error_px, outline_px] = seen.predicted(&[(request.surface.method, setting)])[0];
        // Of a quadric's outline nothing is known.
        let outline_px = if request.look.relief.silhouettes == Silhouettes::Quadric { 0.0 } else { outline_px };
        if error_px.max(outline_px) > LIMIT_PX {
            let name = material.and_then(|m| inputs.scene.materials[m].name.clone()).unwrap_or_default();
            let better = better(&seen);
            warnings.push(warning(&name, (request.surface.method, setting), [error_px, outline_px], &better));
        }
    }
    Ok(warnings)
}

/// What predictions tell of; none where they do not, or where a tolerance decides.
fn setting(request: &RenderRequest) -> Option<Setting> {
    let (surface, relief) = (&request.surface, request.look.relief);
    if surface.geometry.base != Base::Flat || surface.maps.projection != Projection::Uv {
        return None;
    }
    match (surface.method, &surface.geometry.refinement) {
        (Method::Displacement, Refinement::Uniform(level)) => Some(Setting::Level(*level)),
        // Finer triangles show the same.
        (Method::Bump, _) => Some(Setting::None),
        (method, _) => match method.marcher()? {
            marcher if marcher.finds_depth && relief.silhouettes != Silhouettes::None => Some(Setting::Shell),
            marcher if marcher.finds_depth && marcher.needs != Needs::Bounds => Some(Setting::Steps(relief.steps)),
            _ => Some(Setting::None),
        },
    }
}

/// The heights of each material that has one height map and nothing else.
fn reliefs(
    context: &WorkContext<'_>,
    inputs: &Inputs,
    request: &RenderRequest,
) -> Result<Vec<(Option<usize>, Arc<Relief>)>> {
    let count = inputs.scene.materials.len();
    let all = || (0..count).map(Some).chain([None]);
    if !inputs.reliefs.is_empty() {
        return Ok(all().filter_map(|m| Some((m, Arc::clone(inputs.reliefs.of(m)?)))).collect());
    }
    let details = maps::resolve(&inputs.scene, &request.surface.details, &|digest| context.assets.read(digest))?;
    let of: Vec<Option<Arc<Detail>>> = all().map(|m| details.of(m).cloned()).collect();
    let reliefs = maps::marchable(&of)?;
    Ok(all().zip(reliefs).filter_map(|(m, relief)| Some((m, relief?))).collect())
}

/// In words, and always something.
fn better(seen: &Seen<'_>) -> String {
    let exact = [(Setting::None, "--method exact"), (Setting::Shell, "--method exact --silhouettes shell")];
    let kept = exact.into_iter().find_map(|(setting, words)| {
        let [error_px, outline_px] = seen.predicted(&[(Method::Exact, setting)])[0];
        let worst_px = error_px.max(outline_px);
        (worst_px <= LIMIT_PX).then(|| format!("{words} would be within {worst_px:.2} px, "))
    });
    format!("{}--method displacement --tolerance-px {LIMIT_PX} within that", kept.unwrap_or_default())
}

fn warning(
    name: &str,
    (method, setting): (Method, Setting),
    [error_px, outline_px]: [f64; 2],
    better: &str,
) -> Warning {
    let known = |px: f64| if px.is_finite() { format!("up to {px:.1} px") } else { "more than can be told".to_owned() };
    let setting = match setting {
        Setting::Level(level) => format!(" --uniform {level}"),
        Setting::Steps(steps) if steps > 0 => format!(" by {steps} steps"),
        _ => String::new(),
    };
    let message = format!(
        "material '{name}' by {}{setting} may be off by {} at one covered pixel in a hundred, and by {} at its outline; {LIMIT_PX} px is what it is good for: {better}",
        method.name(),
        known(error_px),
        known(outline_px),
    );
    Warning::new("beyond_breakdown", message)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_warning_has_figures_and_what_would_do() {
        let Warning { code, message } =
            warning("wall", (Method::Steep, Setting::Steps(8)), [12.34, f64::INFINITY], "--method exact would");
        assert_eq!(code, "beyond_breakdown");
        for part in
            ["'wall' by steep by 8 steps", "up to 12.3 px", "more than can be told at its outline", "exact would"]
        {
            assert!(message.contains(part), "{part}: {message}");
        }
    }
}
