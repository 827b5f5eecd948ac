//! Certified distances against closed forms.

use displace_server::{
    domain::cancel::{Cancel, NoProgress},
    oracle::{
        dicing::{Limits, Region, dice},
        hausdorff::{Directed, Settings, directed},
        sheet::{Sheet, SheetBuilder},
        surface::{SeamChoice, Surface},
    },
};
use displace_tests::{
    meshes::{self, TestMesh},
    surfaces::{detail, expression, uniform},
};
use glam::DVec3;

const IDENTITY: [f32; 16] = [1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1., 0., 0., 0., 0., 1.];

fn sheet(mesh: &TestMesh, world_from_mesh: [f32; 16]) -> Sheet<'static> {
    let mut builder = SheetBuilder::default();
    builder.mesh(&mesh.to_mesh_without_tangents(), &world_from_mesh);
    builder.build()
}

fn moved(x: f32, y: f32, z: f32) -> [f32; 16] {
    let mut m = IDENTITY;
    m[12..15].copy_from_slice(&[x, y, z]);
    m
}

fn scaled(s: f32) -> [f32; 16] {
    let mut m = IDENTITY;
    (m[0], m[5], m[10]) = (s, s, s);
    m
}

fn both(a: &Sheet<'_>, b: &Sheet<'_>, precision: f64) -> [Directed; 2] {
    let settings = Settings { precision, max_cuts: 10_000_000 };
    let one = |a, b| directed(a, b, &settings, &Cancel::default(), &NoProgress).unwrap().unwrap();
    [one(a, b), one(b, a)]
}

fn holds(name: &str, found: &Directed, truth: f64, precision: f64) {
    let Directed { lo, hi, cuts, .. } = found;
    eprintln!("{name}: [{lo}, {hi}] after {cuts} cuts; truth {truth}");
    assert!(*lo <= truth && truth <= *hi, "{name}: {truth} is not in [{lo}, {hi}]");
    assert!(hi - lo <= precision, "{name}: {} wide, {precision} asked", hi - lo);
}

#[test]
fn parallel_planes_are_as_far_apart_as_they_were_put() {
    let (a, b) = (sheet(&meshes::plane(3), IDENTITY), sheet(&meshes::plane(7), moved(0.0, 0.0, 0.25)));
    let (c, d) = (sheet(&meshes::plane(3), IDENTITY), sheet(&meshes::plane(7), moved(0.0, 0.25, 0.0)));
    for (a, b) in [(a, b), (c, d)] {
        for found in both(&a, &b, 1e-6) {
            holds("planes", &found, 0.25, 1e-6);
        }
    }
}

#[test]
fn shifted_cubes_with_sharp_corners_are_apart_by_the_shift() {
    let shift = DVec3::new(0.3, 0.1, 0.2);
    let (a, b) = (sheet(&meshes::cube(), IDENTITY), sheet(&meshes::cube(), moved(0.3, 0.1, 0.2)));
    let exact = DVec3::new(f64::from(0.3f32), f64::from(0.1f32), f64::from(0.2f32));
    assert!(exact.distance(shift) < 1e-6);
    for found in both(&a, &b, 1e-6) {
        holds("cubes", &found, exact.length(), 1e-6);
    }
}

#[test]
fn the_same_sphere_twice_as_large_is_apart_by_its_radius_but_for_its_facets() {
    let (a, b) = (sheet(&meshes::icosphere(3), IDENTITY), sheet(&meshes::icosphere(3), scaled(2.0)));
    // From each corner of the outer one the same corner of the inner one is nearest.
    let farthest = a.positions.iter().map(|p| p.length()).fold(0.0, f64::max);
    let [outwards, inwards] = both(&a, &b, 1e-5);
    holds("spheres, from outside", &inwards, farthest, 1e-5);
    assert!(outwards.lo <= farthest && outwards.lo >= 0.98 * farthest && outwards.hi - outwards.lo <= 1e-5);
}

#[test]
fn a_sheet_is_at_no_distance_from_itself_however_it_is_cut() {
    for (a, b) in [(meshes::plane(5), meshes::plane(7)), (meshes::torus(12, 8), meshes::torus(12, 8))] {
        let (a, b) = (sheet(&a, IDENTITY), sheet(&b, IDENTITY));
        for found in both(&a, &b, 1e-4) {
            holds("itself", &found, 0.0, 1e-4);
        }
    }
}

/// The surface `expression` (scale 1) over a mesh, diced to `residual`, and its distance to a mesh, both ways.
fn surface_to_mesh(
    base: &TestMesh,
    source: &str,
    other: &TestMesh,
    move_by: [f32; 3],
    precision: f64,
) -> [Directed; 2] {
    let mesh = base.to_mesh();
    let details = vec![Some(detail(expression(source), 1.0)); mesh.primitives.len()];
    let surface = Surface::new(&mesh, &details, SeamChoice::from(&uniform(0)));
    let wants_more = |region: &Region<'_>| region.deviation > 4.0 * precision;
    let dicing = dice(&surface, &Limits::default(), &Cancel::default(), &wants_more).unwrap();
    let mut builder = SheetBuilder::default();
    builder.surface(&surface, &dicing, &IDENTITY);
    both(&builder.build(), &sheet(other, moved(move_by[0], move_by[1], move_by[2])), precision)
}

#[test]
fn a_sine_sheet_is_as_far_from_its_plane_as_it_is_high() {
    let [there, back] = surface_to_mesh(&meshes::plane(2), "0.125*sin(2*pi*u)", &meshes::plane(3), [0.0; 3], 1e-4);
    // Everywhere below or above the plane is the plane.
    holds("from the sine", &there, 0.125, 1e-4);
    // Its slope stays below 1, so from the plane below a crest nothing is nearer than the crest.
    holds("from the plane", &back, 0.125, 1e-4);
    let flat = surface_to_mesh(&meshes::plane(2), "0*u+0.125", &meshes::plane(5), [0.0, 0.0, 0.0], 1e-6);
    flat.iter().for_each(|found| holds("a raised plane", found, 0.125, 1e-6));
}

#[test]
fn rounding_carries_no_place_over_a_step_at_the_border() {
    // 0.9 u stays in [0, 0.9]: below 0, or at 1, the step would be 1 high.
    let found = surface_to_mesh(&meshes::plane(3), "floor(0.9*u)", &meshes::plane(7), [0.0; 3], 1e-4);
    found.iter().for_each(|found| holds("a step beyond the border", found, 0.0, 1e-4));
}

#[test]
fn spheres_raised_by_a_constant_are_apart_by_it() {
    // Directions are radial, so the raised surface is R + h along them: facets bend with the normals.
    let sphere = meshes::icosphere(3);
    let [there, back] = surface_to_mesh(&sphere, "0*x+0.25", &sphere, [0.0; 3], 1e-3);
    for found in [there, back] {
        assert!(found.lo > 0.249 && found.hi < 0.251 && found.hi - found.lo <= 1e-3, "{found:?}");
    }
}

#[test]
fn tori_of_different_tubes_are_apart_by_the_difference() {
    // Both directions, to what the facets of the finer meshes leave: (1 - cos(pi / n)) of each radius.
    let (a, b) = (sheet(&meshes::torus(192, 96), IDENTITY), sheet(&meshes::torus(256, 128), moved(0.0, 0.0, 0.0)));
    let [there, back] = both(&a, &b, 1e-5);
    let radius = a.positions.iter().map(|p| p.length()).fold(0.0, f64::max);
    let sag = radius * (1.0 - (std::f64::consts::PI / 96.0).cos()) * 2.0;
    for found in [there, back] {
        assert!(found.hi <= sag && found.lo > 0.0 && found.hi - found.lo <= 1e-5, "{found:?} against {sag}");
    }
}
