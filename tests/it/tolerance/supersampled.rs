//! Small maps looked at many times as closely as they have texels: what lies between texels is kept too.

use displace_server::domain::{
    detail::{LayerSource, Sampling, Wrap},
    request::{Allowed, Quality},
    surface::Surface,
};
use displace_tests::{
    device,
    meshes::{self, TestMesh},
    surfaces::{detail, displace, uniform},
};

use super::{
    asked_local,
    cases::{Case, map},
    geometry,
    judge::farthest_at,
};

fn case(mesh: &TestMesh, size: u32, wrap: Wrap, sampling: Sampling, noise: Option<u32>) -> Case {
    let source = LayerSource::Height(map(size, 1, wrap, sampling, noise));
    Case {
        name: format!("{} with {size} texels, {wrap:?} {sampling:?} noise {noise:?}", mesh.name),
        mesh: mesh.to_mesh(),
        detail: detail(source, 0.05),
        geometry: uniform(0),
        allowed: Allowed::Diagonal(0.02),
    }
}

/// So many segments that there are `places` or more along a map's side.
fn along_side(case: &Case, surface: &Surface, places: u32, triangle: usize) -> u32 {
    let uvs = &case.mesh.attribute("TEXCOORD_0").expect("it has texture coordinates").values;
    let uv = |vertex: u32| {
        let (avs, weights) = surface.site(&case.mesh, vertex as usize);
        [0, 1].map(|k| (0..3).map(|n| weights[n] * f64::from(uvs[2 * avs[n] as usize + k])).sum::<f64>())
    };
    let corners = surface.triangles[triangle].map(uv);
    let longest = |k: usize| {
        let [a, b] = [corners[k], corners[(k + 1) % 3]];
        (a[0] - b[0]).hypot(a[1] - b[1])
    };
    let longest = longest(0).max(longest(1)).max(longest(2));
    ((f64::from(places) * longest).ceil() as u32).max(1)
}

#[test]
fn no_place_between_texels_is_farther_than_the_tolerance() {
    // Along each texel 16 places, and 4 of a large map.
    for (mesh, size, places, wrap, sampling, noise) in [
        (meshes::plane(1), 8, 16, Wrap::Clamp, Sampling::Node, Some(5)),
        (meshes::plane(2), 9, 16, Wrap::Mirror, Sampling::Center, None),
        (meshes::torus(6, 4), 8, 16, Wrap::Repeat, Sampling::Node, Some(2)),
        (meshes::plane(1), 32, 4, Wrap::Repeat, Sampling::Center, None),
    ] {
        let case = case(&mesh, size, wrap, sampling, noise);
        let geometry = geometry(&case, Quality::Normal);
        let surface = displace(&*device::reference(), &case.mesh, &case.detail, &geometry);
        let fit = surface.fit.expect("a tolerance was asked for");
        let found = farthest_at(&case, &surface, &|triangle| along_side(&case, &surface, size * places, triangle));
        let asked = asked_local(&case, &geometry);
        assert!(
            !fit.budget_reached && found <= fit.bound_local && found <= asked,
            "{case}: {found} of {asked}, {fit:?}"
        );
        assert!(found > 0.2 * asked, "{case}: {found} of {asked} is too good to be true");
    }
}
