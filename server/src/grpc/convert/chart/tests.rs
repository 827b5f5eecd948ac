//! Which settings a request goes with, and what it may not say.

use super::*;
use crate::domain::chart::Setting;

fn digest(letter: char) -> Option<v1::Digest> {
    Some(v1::Digest { hash: letter.to_string().repeat(64), size_bytes: 1 })
}

fn map() -> Option<v1::MapSource> {
    Some(v1::MapSource { asset: digest('a'), ..v1::MapSource::default() })
}

fn height() -> Source {
    Source::Height(v1::HeightMap { map: map(), channel: 0 })
}

fn request(sources: Vec<Source>) -> v1::ChartRequest {
    let layers = sources.into_iter().map(|source| v1::Layer { source: Some(source), ..v1::Layer::default() });
    let surface = v1::DisplaceRequest {
        mesh: Some(v1::MeshSource { asset: digest('b'), resources: Vec::new() }),
        details: vec![v1::MaterialDetail { layers: layers.collect(), ..v1::MaterialDetail::default() }],
        ..v1::DisplaceRequest::default()
    };
    let render =
        v1::RenderRequest { surface: Some(surface), views: vec![v1::View::default()], ..v1::RenderRequest::default() };
    v1::ChartRequest { render: Some(render), ..v1::ChartRequest::default() }
}

fn parsed(request: v1::ChartRequest) -> Result<ChartRequest> {
    chart(request, &Config::default())
}

#[test]
fn heights_are_charted_by_every_method_but_normal_maps() {
    let chart = parsed(request(vec![height()])).unwrap();
    assert_eq!((chart.repeats, chart.truth.samples), (3, Some(64)));
    let count = |method: Method| chart.candidates.iter().filter(|candidate| candidate.method == method).count();
    assert_eq!((count(Method::Relief), count(Method::Exact), count(Method::Displacement)), (5, 2, 5));
    assert_eq!((count(Method::Normal), count(Method::Vector)), (0, 0));
    assert!(chart.left_out.iter().all(|left_out| left_out.candidate.method == Method::Normal), "{:?}", chart.left_out);
}

#[test]
fn under_a_projection_only_what_moves_vertices_is_left() {
    let mut asked = request(vec![height()]);
    let surface = asked.render.as_mut().unwrap().surface.as_mut().unwrap();
    surface.look = Some(v1::Look { projection: v1::Projection::Box.into(), ..v1::Look::default() });
    let chart = parsed(asked).unwrap();
    let methods = [Method::Flat, Method::Displacement];
    assert!(chart.candidates.iter().all(|candidate| methods.contains(&candidate.method)), "{:?}", chart.candidates);
    assert!(LeftOut::warnings(&chart.left_out).iter().any(|warning| {
        warning.message.starts_with("relief auto, 8, 16, 32, 64 is not charted")
            && warning.message.contains("--projection uv")
    }));
}

#[test]
fn prisms_stand_on_flat_triangles_alone() {
    let mut asked = request(vec![height()]);
    let surface = asked.render.as_mut().unwrap().surface.as_mut().unwrap();
    surface.geometry = Some(v1::Geometry { base: v1::Base::Pn.into(), ..v1::Geometry::default() });
    let chart = parsed(asked).unwrap();
    let of_exact = |c: &&Candidate| c.method == Method::Exact;
    let settings: Vec<Setting> = chart.candidates.iter().filter(of_exact).map(|c| c.setting).collect();
    assert_eq!(settings, [Setting::None]);
}

#[test]
fn what_a_chart_decides_itself_is_refused_by_name() {
    type Change = fn(&mut v1::ChartRequest);
    fn render(request: &mut v1::ChartRequest) -> &mut v1::RenderRequest {
        request.render.as_mut().unwrap()
    }
    fn surface(request: &mut v1::ChartRequest) -> &mut v1::DisplaceRequest {
        render(request).surface.as_mut().unwrap()
    }
    let changes: [(&str, Change); 11] = [
        ("render", |request| request.render = None),
        ("render.surface", |request| render(request).surface = None),
        ("render.surface.method", |request| surface(request).method = v1::Method::Relief.into()),
        ("render.surface.lods", |request| surface(request).lods = 2),
        ("render.surface.geometry.refinement", |request| {
            surface(request).geometry.get_or_insert_default().refinement = Some(Refinement::UniformLevel(3));
        }),
        ("render.lighting.relief", |request| {
            render(request).lighting.get_or_insert_default().relief = Some(v1::Relief::default());
        }),
        ("render.aovs", |request| render(request).aovs.push(v1::Aov::Uv.into())),
        ("render.format", |request| render(request).format = v1::ImageFormat::Exr.into()),
        ("render.samples", |request| render(request).samples = 16),
        ("repeats", |request| request.repeats = Some(0)),
        ("truth_samples", |request| request.truth_samples = Some(2000)),
    ];
    for (field, change) in changes {
        let mut asked = request(vec![height()]);
        change(&mut asked);
        let error = parsed(asked).unwrap_err();
        assert_eq!(error.field.as_deref(), Some(field), "{error}");
    }
}

#[test]
fn sweeps_are_asked_for_once_each() {
    use v1::ChartSweep::{Amplitude, Angle, Unspecified};
    let asked = |sweeps: &[v1::ChartSweep]| {
        let sweeps = sweeps.iter().map(|sweep| i32::from(*sweep)).collect();
        parsed(v1::ChartRequest { sweeps, ..request(vec![height()]) })
    };
    assert_eq!(asked(&[Amplitude, Angle]).unwrap().sweeps, [Sweep::Angle, Sweep::Amplitude]);
    for (bad, field) in [(&[Angle, Angle][..], "sweeps[1]"), (&[Unspecified], "sweeps[0]")] {
        assert_eq!(asked(bad).unwrap_err().field.as_deref(), Some(field));
    }
}
