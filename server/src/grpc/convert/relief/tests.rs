//! Which settings go with which method.

use displace_glsl::methods::METHODS;

use super::*;
use crate::{config::Config, grpc::convert};

/// A render by this method, with what `change` does to it.
fn render(method: v1::Method, change: impl FnOnce(&mut v1::RenderRequest)) -> Result<RenderRequest> {
    let asset = Some(v1::Digest { hash: "0".repeat(64), size_bytes: 1 });
    let geometry =
        v1::Geometry { refinement: Some(v1::geometry::Refinement::UniformLevel(0)), ..v1::Geometry::default() };
    let surface = v1::DisplaceRequest {
        mesh: Some(v1::MeshSource { asset, resources: vec![] }),
        method: method.into(),
        geometry: Some(geometry),
        ..v1::DisplaceRequest::default()
    };
    let mut request =
        v1::RenderRequest { surface: Some(surface), views: vec![v1::View::default()], ..v1::RenderRequest::default() };
    change(&mut request);
    convert::render("", request, &Config::default())
}

fn with_relief(method: v1::Method, relief: v1::Relief) -> Result<RenderRequest> {
    render(method, |request| {
        request.lighting = Some(v1::Lighting { relief: Some(relief), ..v1::Lighting::default() });
    })
}

fn refused(result: Result<RenderRequest>, field: &str, parts: &[&str]) {
    let error = result.expect_err(field);
    assert_eq!(error.field.as_deref(), Some(field), "{error}");
    for part in parts {
        assert!(error.message.contains(part), "{part}: {error}");
    }
}

fn steps(steps: u32) -> v1::Relief {
    v1::Relief { steps, ..v1::Relief::default() }
}

fn shadow(self_shadow: v1::SelfShadow) -> v1::Relief {
    v1::Relief { self_shadow: self_shadow.into(), ..v1::Relief::default() }
}

fn outline(silhouettes: v1::Silhouettes) -> v1::Relief {
    v1::Relief { silhouettes: silhouettes.into(), ..v1::Relief::default() }
}

/// What auto chooses is also how fine triangles are.
fn leave_open(method: v1::Method, request: &mut v1::RenderRequest) {
    if method == v1::Method::Auto {
        request.surface.as_mut().and_then(|surface| surface.geometry.as_mut()).expect("one").refinement = None;
    }
}

#[test]
fn every_method_of_the_table_has_a_value_of_its_name() {
    for row in METHODS {
        let name = format!("METHOD_{}", row.name.to_ascii_uppercase().replace('-', "_"));
        let value = v1::Method::from_str_name(&name).unwrap_or_else(|| panic!("{name} is no value"));
        let parsed =
            render(value, |request| leave_open(value, request)).unwrap_or_else(|error| panic!("{name}: {error}"));
        assert_eq!(parsed.surface.method, row.method, "{name}");
    }
}

#[test]
fn what_is_not_said_is_none_and_by_angle() {
    let look = render(v1::Method::Steep, |_| {}).expect("a request").look.relief;
    assert_eq!(look, ReliefLook { steps: 0, self_shadow: SelfShadow::None, silhouettes: Silhouettes::None });
    let relief = v1::Relief {
        steps: 512,
        self_shadow: v1::SelfShadow::Soft.into(),
        silhouettes: v1::Silhouettes::Quadric.into(),
    };
    let look = with_relief(v1::Method::Steep, relief).expect("a request").look.relief;
    assert_eq!(look, ReliefLook { steps: 512, self_shadow: SelfShadow::Soft, silhouettes: Silhouettes::Quadric });
    refused(with_relief(v1::Method::Steep, steps(513)), "lighting.relief.steps", &["513", "0 to 512"]);
}

#[test]
fn settings_of_a_march_are_refused_where_nothing_marches() {
    for method in [v1::Method::Displacement, v1::Method::Bump, v1::Method::Flat] {
        refused(with_relief(method, steps(8)), "lighting.relief.steps", &["8 is", "takes none", "--method steep"]);
        let hard = shadow(v1::SelfShadow::Hard);
        refused(with_relief(method, hard), "lighting.relief.self_shadow", &["hard", "leave it none", "exact"]);
        let shell = outline(v1::Silhouettes::Shell);
        refused(with_relief(method, shell), "lighting.relief.silhouettes", &["shell", "leave it none", "exact"]);
        let cost = render(method, |request| request.aovs = vec![v1::Aov::Depth.into(), v1::Aov::Cost.into()]);
        refused(cost, "aovs[1]", &["cost", "per pixel", "--method exact"]);
    }
    assert!(render(v1::Method::Steep, |request| request.aovs = vec![v1::Aov::Cost.into()]).is_ok());
}

/// Each row by what it says of itself.
#[test]
fn every_method_takes_the_settings_that_it_has_a_use_for() {
    for row in METHODS {
        let name = format!("METHOD_{}", row.name.to_ascii_uppercase().replace('-', "_"));
        let value = v1::Method::from_str_name(&name).expect("a value");
        let finds_depth = row.marcher.is_some_and(|marcher| marcher.finds_depth);
        let walks_cells = row.marcher.is_some_and(|marcher| marcher.needs == Needs::Bounds);
        assert_eq!(with_relief(value, steps(4)).is_ok(), finds_depth && !walks_cells, "{name} and steps");
        assert_eq!(with_relief(value, shadow(v1::SelfShadow::Hard)).is_ok(), finds_depth, "{name} and shadows");
        assert_eq!(with_relief(value, outline(v1::Silhouettes::Quadric)).is_ok(), finds_depth, "{name} and outlines");
    }
}

#[test]
fn what_is_per_pixel_is_of_images_of_the_mesh_as_it_is() {
    let surface = |change: fn(&mut v1::DisplaceRequest)| {
        render(v1::Method::Steep, |request| change(request.surface.as_mut().expect("one")))
    };
    let geometry = |change: fn(&mut v1::Geometry)| {
        render(v1::Method::Steep, |request| {
            change(request.surface.as_mut().and_then(|s| s.geometry.as_mut()).expect("one"));
        })
    };
    let tolerance = v1::Tolerance { allowed: Some(v1::tolerance::Allowed::Diagonal(1e-3)), ..v1::Tolerance::default() };
    let with = |refinement| {
        render(v1::Method::Steep, |request| {
            request.surface.as_mut().and_then(|s| s.geometry.as_mut()).expect("one").refinement = Some(refinement);
        })
    };
    refused(
        with(v1::geometry::Refinement::Tolerance(tolerance)),
        "surface.geometry.tolerance",
        &["steep moves none", "--uniform"],
    );
    refused(with(v1::geometry::Refinement::Exact(true)), "surface.geometry.exact", &["--method displacement"]);
    let projected = |surface: &mut v1::DisplaceRequest| {
        surface.look = Some(v1::Look { projection: v1::Projection::Box.into(), ..v1::Look::default() });
    };
    refused(surface(projected), "surface.look.projection", &["--projection uv"]);
    let preimage = render(v1::Method::Steep, |request| request.preimage = Some(v1::Pixel { x: 0, y: 0 }));
    refused(preimage, "preimage", &["leave it out"]);
    assert!(geometry(|geometry| geometry.base = v1::Base::Pn.into()).is_ok());
}

#[test]
fn a_shell_stands_on_flat_triangles() {
    let on = |base: v1::Base, silhouettes: v1::Silhouettes| {
        render(v1::Method::Steep, |request| {
            request.lighting = Some(v1::Lighting { relief: Some(outline(silhouettes)), ..v1::Lighting::default() });
            request.surface.as_mut().and_then(|s| s.geometry.as_mut()).expect("one").base = base.into();
        })
    };
    let shell = on(v1::Base::Loop, v1::Silhouettes::Shell);
    refused(shell, "surface.geometry.base", &["loop", "--base flat", "--silhouettes quadric"]);
    assert!(on(v1::Base::Flat, v1::Silhouettes::Shell).is_ok() && on(v1::Base::Loop, v1::Silhouettes::Quadric).is_ok());
}

#[test]
fn files_hold_nothing_that_is_per_pixel() {
    let asset = Some(v1::Digest { hash: "0".repeat(64), size_bytes: 1 });
    let geometry =
        v1::Geometry { refinement: Some(v1::geometry::Refinement::UniformLevel(0)), ..v1::Geometry::default() };
    let request = v1::DisplaceRequest {
        mesh: Some(v1::MeshSource { asset, resources: vec![] }),
        method: v1::Method::Steep.into(),
        geometry: Some(geometry),
        ..v1::DisplaceRequest::default()
    };
    let error = convert::displace("", request).expect_err("a file");
    assert_eq!(error.field.as_deref(), Some("method"));
    assert!(error.message.contains("steep") && error.message.contains("choose displacement, or render it"), "{error}");
}
