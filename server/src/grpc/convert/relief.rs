//! How heights are shown per pixel, and what does not go with it.

use displace_glsl::methods::{Marcher, Needs};
use displace_proto::v1;

use super::{at_most, join, known};
use crate::domain::{
    Error, Result,
    image::{SelfShadow, Silhouettes},
    projection::Projection,
    request::{Aov, Base, DisplaceRequest, Method, Refinement, ReliefLook, RenderRequest},
};

const MOST_STEPS: u32 = 512;

pub(super) fn parse(path: &str, relief: Option<v1::Relief>) -> Result<ReliefLook> {
    let relief = relief.unwrap_or_default();
    Ok(ReliefLook {
        steps: at_most(&join(path, "steps"), relief.steps, 0, MOST_STEPS)?,
        self_shadow: match known::<v1::SelfShadow>(&join(path, "self_shadow"), relief.self_shadow)? {
            v1::SelfShadow::Unspecified | v1::SelfShadow::None => SelfShadow::None,
            v1::SelfShadow::Hard => SelfShadow::Hard,
            v1::SelfShadow::Soft => SelfShadow::Soft,
        },
        silhouettes: match known::<v1::Silhouettes>(&join(path, "silhouettes"), relief.silhouettes)? {
            v1::Silhouettes::Unspecified | v1::Silhouettes::None => Silhouettes::None,
            v1::Silhouettes::Shell => Silhouettes::Shell,
            v1::Silhouettes::Quadric => Silhouettes::Quadric,
        },
    })
}

/// Files of triangles hold no heights that are marched.
pub(super) fn refuse_in_files(path: &str, request: &DisplaceRequest) -> Result<()> {
    let method = request.method;
    if method.marcher().is_none() {
        return Ok(());
    }
    let message = format!(
        "{} shows heights per pixel, which the file that Displace writes does not hold: choose displacement, or render it",
        method.name()
    );
    Err(Error::unsupported(join(path, "method"), message))
}

/// What of an image goes with its method, as far as the request tells.
pub(super) fn check(path: &str, request: &RenderRequest) -> Result<()> {
    let method = request.surface.method;
    check_look(&join(path, "lighting.relief"), request.look.relief, method)?;
    if method == Method::Auto {
        refuse_what_is_chosen(path, request)?;
    }
    let Some(marcher) = method.marcher() else { return refuse_cost(path, request) };
    refuse_geometry(&join(path, "surface"), request, marcher)?;
    if request.surface.maps.projection != Projection::Uv {
        let message = format!(
            "is not uv, and {} marches where texture coordinates say: take --projection uv, or --method displacement",
            method.name()
        );
        return Err(Error::unsupported(join(path, "surface.look.projection"), message));
    }
    if request.preimage.is_some() {
        let message = format!(
            "is of triangles, and {} shows other places than theirs: leave it out, or take --method displacement",
            method.name()
        );
        return Err(Error::unsupported(join(path, "preimage"), message));
    }
    Ok(())
}

/// What the choice decides, or what some that may be chosen do not go with.
fn refuse_what_is_chosen(path: &str, request: &RenderRequest) -> Result<()> {
    if request.preimage.is_some() {
        let message =
            "is of triangles, and auto may choose heights per pixel: leave it out, or take --method displacement";
        return Err(Error::unsupported(join(path, "preimage"), message));
    }
    if request.own_camera_px().is_some() {
        return Ok(());
    }
    let message = "is not in pixels of the image's own camera, and auto chooses by these: give geometry.tolerance.pixels without views (--tolerance-px without --view), or name a method";
    Err(Error::unsupported(join(path, "surface.geometry.refinement"), message))
}

fn refuse_geometry(path: &str, request: &RenderRequest, marcher: &Marcher) -> Result<()> {
    let (geometry, name) = (&request.surface.geometry, request.surface.method.name());
    let (field, message) = match &geometry.refinement {
        Refinement::Exact => (
            "geometry.exact",
            format!(
                "shows the displaced surface itself, and {name} shows it its own way: leave it out, or take --method displacement"
            ),
        ),
        Refinement::Tolerance(_) => (
            "geometry.tolerance",
            format!(
                "is kept by splitting triangles, and {name} moves none: leave it out, or split the mesh as it is (--uniform 0 to 12)"
            ),
        ),
        Refinement::Uniform(_)
            if marcher.finds_depth
                && request.look.relief.silhouettes == Silhouettes::Shell
                && geometry.base != Base::Flat =>
        {
            let base = geometry.base.name();
            let message = format!(
                "{base} is curved, and prisms of --silhouettes shell stand on flat triangles: take --base flat, or --silhouettes quadric"
            );
            ("geometry.base", message)
        }
        Refinement::Uniform(_) => return Ok(()),
    };
    Err(Error::unsupported(join(path, field), message))
}

/// Each setting of a march, with those methods alone that have a use for it.
fn check_look(path: &str, look: ReliefLook, method: Method) -> Result<()> {
    let finds_depth = method.marcher().is_some_and(|marcher| marcher.finds_depth);
    let takes_steps = method.marcher().is_some_and(|m| m.finds_depth && m.needs != Needs::Bounds);
    let name = method.name();
    if look.steps > 0 && !takes_steps {
        let message = format!(
            "{} is the steps of a march, and {name} takes none: leave it out (0), or take --method steep, occlusion, relief or cone with 1 to {MOST_STEPS}",
            look.steps
        );
        return Err(Error::unsupported(join(path, "steps"), message));
    }
    let fix = "leave it none, or take a method that finds depth: --method steep, occlusion, relief, cone or exact";
    if look.self_shadow != SelfShadow::None && !finds_depth {
        let how = format!("{:?}", look.self_shadow).to_lowercase();
        let message = format!("{how} marches from what is struck towards lights, and {name} strikes nothing: {fix}");
        return Err(Error::unsupported(join(path, "self_shadow"), message));
    }
    if look.silhouettes != Silhouettes::None && !finds_depth {
        let how = format!("{:?}", look.silhouettes).to_lowercase();
        let message =
            format!("{how} tells which rays miss the heights, and {name} finds no place that they strike: {fix}");
        return Err(Error::unsupported(join(path, "silhouettes"), message));
    }
    Ok(())
}

fn refuse_cost(path: &str, request: &RenderRequest) -> Result<()> {
    let Some(n) = request.aovs.iter().position(|aov| *aov == Aov::Cost) else { return Ok(()) };
    let does_not = if request.surface.method == Method::Auto { "may choose another" } else { "does not" };
    let message = format!(
        "cost is of methods that show heights per pixel, and {} {does_not}: leave it out, or take such a method, as --method exact",
        request.surface.method.name()
    );
    Err(Error::unsupported(join(path, &format!("aovs[{n}]")), message))
}

#[cfg(test)]
mod tests;
