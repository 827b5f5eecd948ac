//! Scenes whose images are formulas.

use std::f64::consts::PI;

use displace_server::{
    domain::image::{Lighting, RenderLight},
    oracle::image::{Camera, Exposure},
};
use glam::{DVec2, DVec3};

use super::{EYE, OracleMesh, OracleScene, direction, image, mesh, scene};

/// Shows what is covered as 1 and the rest as 0.
fn silhouette() -> Lighting {
    Lighting { lights: Vec::new(), environment: None, ambient: 1.0, background: [0.0; 3] }
}

/// Radius 1.
fn sphere(centre: DVec3, level: u32) -> OracleMesh {
    let sphere = displace_tests::meshes::icosphere(level);
    // In f64: the vertices lie on the sphere.
    let normals: Vec<DVec3> =
        sphere.positions.iter().map(|p| DVec3::from_array(p.map(f64::from)).normalize()).collect();
    mesh(normals.iter().map(|n| centre + *n).collect(), &normals, sphere.triangles)
}

/// Area of the ellipse that a unit sphere covers on the plane at distance 1 before the eye: the section of the
/// cone around it.
fn ellipse_area(centre: DVec3) -> f64 {
    let to_centre = centre - EYE;
    let cos2 = 1.0 - 1.0 / to_centre.length_squared();
    let axis = to_centre.normalize();
    let (sine, cosine) = (axis.truncate().length(), axis.z.abs());
    // (x sine + cosine)² = cos2 (x² + y² + 1), brought to its centre.
    let across = cos2 - sine * sine;
    let level = cosine * cosine - cos2 + (sine * cosine).powi(2) / across;
    PI * level / (across * cos2).sqrt()
}

#[test]
fn a_sphere_covers_the_ellipse_it_should() {
    assert!((ellipse_area(DVec3::ZERO) - PI / 15.0).abs() < 1e-15, "a disc of the tangent's radius");
    for centre in [DVec3::ZERO, DVec3::new(0.5, 0.25, 0.0), DVec3::new(-0.75, 0.5, -0.5)] {
        let image = image(&scene(sphere(centre, 6), [1.0; 3], silhouette()), 64, 256, false);
        let covered: f64 = image.color.iter().map(|c| f64::from(c[0])).sum();
        // The image is 1 wide at distance 1.
        let expected = ellipse_area(centre) * 64.0 * 64.0;
        // The sphere's facets lie up to 8e-5 inside it.
        assert!((covered / expected - 1.0).abs() < 2e-4, "{covered} pixels of {expected} at {centre}");
    }
}

#[test]
fn towards_a_place_is_seen_what_its_ray_meets_first_before_or_behind_it() {
    let scene = scene(sphere(DVec3::ZERO, 6), [1.0; 3], silhouette());
    let exposure = Exposure { width: 64, height: 64, samples: 1, shadows: false };
    let camera = Camera::new(&scene, &exposure).expect("a camera");
    for [x, y] in [[0.0, 0.0], [0.11, -0.07], [0.2, 0.1]] {
        let along = DVec3::new(x, y, -1.0).normalize();
        // The nearer root of |EYE + t along| = 1.
        let half = EYE.dot(along);
        let met = EYE + (-half - (half * half - EYE.length_squared() + 1.0).sqrt()) * along;
        for t in [0.5, 3.0, 9.0] {
            let seen = camera.towards(EYE + t * along).expect("the sphere");
            // Its facets lie up to 8e-5 inside it.
            assert!(seen.distance(met) < 1.2e-4, "{seen} is not {met}");
            assert!((seen - EYE).cross(along).length() < 1e-9, "on the ray");
        }
    }
    assert_eq!(camera.towards(DVec3::new(2.0, 0.0, 0.0)), None);
}

/// Colour of base 0.5 under the default light: ambient 0.2, diffuse, highlight 0.2 cos³².
fn lit(normal: DVec3, to_eye: DVec3) -> f64 {
    let light = DVec3::ONE.normalize();
    let cosine = normal.dot(light);
    let mirrored = 2.0 * cosine * normal - light;
    let highlight = 0.2 * mirrored.dot(to_eye).max(0.0).powi(32);
    0.5 * 0.2 + if cosine > 0.0 { 0.5 * cosine + highlight } else { 0.0 }
}

/// Mean over a pixel of a function of the direction, by the midpoint rule.
fn mean_over_pixel(x: u32, y: u32, size_px: u32, value: impl Fn(DVec3) -> f64) -> f64 {
    let corner = DVec2::new(x.into(), y.into());
    let place = |k: u32| corner + DVec2::new(f64::from(k % 32) + 0.5, f64::from(k / 32) + 0.5) / 32.0;
    (0..1024).map(|k| value(direction(place(k), size_px))).sum::<f64>() / 1024.0
}

fn centre_of(x: u32, y: u32, size_px: u32) -> DVec3 {
    direction(DVec2::new(f64::from(x) + 0.5, f64::from(y) + 0.5), size_px)
}

fn wide(p: [f32; 3]) -> DVec3 {
    DVec3::from_array(p.map(f64::from))
}

#[test]
fn a_lit_sphere_has_the_colours_of_the_formula() {
    let image = image(&scene(sphere(DVec3::ZERO, 6), [0.5; 3], Lighting::default()), 64, 256, false);
    let hit = |d: DVec3| {
        let d = d.normalize();
        let half = d.dot(EYE);
        EYE - d * (half + (half * half - 15.0).sqrt())
    };
    let mut compared = 0;
    for (x, y) in (0..64).flat_map(|y| (0..64).map(move |x| (x, y))) {
        if centre_of(x, y, 64).truncate().length() > 0.23 {
            continue;
        }
        let i = (y * 64 + x) as usize;
        let at = hit(centre_of(x, y, 64));
        // Facets lie up to 8e-5 inside the sphere: along the ray that is more.
        let bound = 8e-5 / at.dot(-centre_of(x, y, 64).normalize());
        assert!((wide(image.position.as_ref().unwrap()[i]) - at).length() < bound, "({x}, {y})");
        assert!((wide(image.normal.as_ref().unwrap()[i]) - at).length() < bound, "({x}, {y})");
        let expected = mean_over_pixel(x, y, 64, |d| lit(hit(d), -d.normalize()));
        let found = f64::from(image.color[i][0]);
        assert!((found - expected).abs() < 2e-4, "({x}, {y}): {found} for {expected}");
        compared += 1;
    }
    assert!(compared > 600, "{compared} pixels lie on the sphere");
}

const WAVE: f64 = 0.1;

/// z = WAVE sin 2πx over [−1, 1]².
fn waves(columns: u32) -> OracleMesh {
    let x = |i: u32| 2.0 * f64::from(i) / f64::from(columns) - 1.0;
    let rim = (0..=columns).flat_map(|i| [-1.0, 1.0].map(|y| (x(i), y)));
    let places: Vec<DVec3> = rim.map(|(x, y)| DVec3::new(x, y, WAVE * (2.0 * PI * x).sin())).collect();
    let normals: Vec<DVec3> = places.iter().map(|p| wave_normal(p.x)).collect();
    let quad = |i: u32| [[2 * i, 2 * i + 2, 2 * i + 3], [2 * i, 2 * i + 3, 2 * i + 1]];
    mesh(places, &normals, (0..columns).flat_map(quad).collect())
}

fn wave_normal(x: f64) -> DVec3 {
    DVec3::new(-2.0 * PI * WAVE * (2.0 * PI * x).cos(), 0.0, 1.0).normalize()
}

/// Where a ray from the eye meets the waves (Newton).
fn on_waves(d: DVec3) -> DVec3 {
    let mut t = 4.0;
    for _ in 0..20 {
        let p = EYE + t * d;
        let slope = d.z - 2.0 * PI * WAVE * (2.0 * PI * p.x).cos() * d.x;
        t -= (p.z - WAVE * (2.0 * PI * p.x).sin()) / slope;
    }
    EYE + t * d
}

#[test]
fn waves_have_the_places_normals_and_colours_of_the_formula() {
    let image = image(&scene(waves(2048), [0.5; 3], Lighting::default()), 64, 256, false);
    let (position, normal, depth) = (image.position.unwrap(), image.normal.unwrap(), image.depth.unwrap());
    for (x, y) in (17..47).flat_map(|y| (17..47).map(move |x| (x, y))) {
        let i = (y * 64 + x) as usize;
        let at = on_waves(centre_of(x, y, 64));
        // A chord of 1/1024 is WAVE (2π)² / 8 / 1024² = 4.7e-7 off.
        assert!((wide(position[i]) - at).length() < 1e-6, "({x}, {y})");
        assert!((f64::from(depth[i]) - (4.0 - at.z)).abs() < 1e-6, "({x}, {y})");
        assert!((wide(normal[i]) - wave_normal(at.x)).length() < 2e-5, "({x}, {y})");
        let expected = mean_over_pixel(x, y, 64, |d| lit(wave_normal(on_waves(d).x), -d.normalize()));
        let found = f64::from(image.color[i][0]);
        assert!((found - expected).abs() < 5e-4, "({x}, {y}): {found} for {expected}");
    }
}

/// Two planes that meet in the y axis, like an open book: z = −x on the left, z = x / 2 on the right.
fn book() -> OracleScene {
    let corner = |x: f64, y: f64| DVec3::new(x, y, if x < 0.0 { -x } else { 0.5 * x });
    let places = [(-2.0, -2.0), (0.0, -2.0), (2.0, -2.0), (-2.0, 2.0), (0.0, 2.0), (2.0, 2.0)];
    let places: Vec<DVec3> = places.map(|(x, y)| corner(x, y)).to_vec();
    let triangles = vec![[0, 1, 4], [0, 4, 3], [1, 2, 5], [1, 5, 4]];
    scene(mesh(places, &[DVec3::Z; 6], triangles), [1.0; 3], Lighting::default())
}

#[test]
fn two_planes_are_hit_where_they_are() {
    // An even size has rays neither through the spine nor through the diagonals' ends; an odd one has both.
    for size_px in [64, 65] {
        let image = image(&book(), size_px, 1, false);
        let (position, depth, triangle) = (image.position.unwrap(), image.depth.unwrap(), image.triangle.unwrap());
        let uv = image.uv.unwrap();
        for (x, y) in (0..size_px).flat_map(|y| (0..size_px).map(move |x| (x, y))) {
            let i = (y * size_px + x) as usize;
            let d = centre_of(x, y, size_px);
            let t = 4.0 / if d.x < 0.0 { 1.0 - d.x } else { 1.0 + 0.5 * d.x };
            let at = EYE + t * d;
            assert!((f64::from(depth[i]) - t).abs() < 3e-7, "({x}, {y}) at {size_px}");
            assert!((wide(position[i]) - at).length() < 3e-7, "({x}, {y}) at {size_px}");
            assert!((uv[i][0] - at.x as f32).abs() < 3e-7, "({x}, {y}) at {size_px}");
            let across = if at.x < 0.0 { at.x + 2.0 } else { at.x };
            let above_diagonal = (at.y + 2.0) - 2.0 * across;
            if at.x.abs() > 1e-9 && above_diagonal.abs() > 1e-9 {
                let expected = if at.x < 0.0 { 0 } else { 2 } + u32::from(above_diagonal > 0.0);
                assert_eq!(triangle[i], expected, "({x}, {y}) at {size_px}");
            }
        }
    }
}

/// A square of side 1 above a plane, and the light 0.75 to the side for each unit up.
fn square_over_plane() -> OracleScene {
    let square = |half: f64, z: f64| {
        [(-half, -half), (half, -half), (half, half), (-half, half)].map(|(x, y)| DVec3::new(x, y, z))
    };
    let places = [square(3.0, 0.0), square(0.5, 1.0)].concat();
    let triangles = vec![[0, 1, 2], [0, 2, 3], [4, 5, 6], [4, 6, 7]];
    let light = Lighting { lights: vec![RenderLight::sun([0.6, 0.0, 0.8])], ..Lighting::default() };
    scene(mesh(places, &[DVec3::Z; 8], triangles), [0.5; 3], light)
}

#[test]
fn a_shadow_ends_where_the_light_passes_its_occluder() {
    let scene = square_over_plane();
    let [lit, shadowed] = [false, true].map(|shadows| image(&scene, 60, 256, shadows));
    // 1 where the light is taken, 0 where it is not.
    let taken = |x: u32, y: u32| {
        let i = (y * 60 + x) as usize;
        (lit.color[i][0] - shadowed.color[i][0]) / (lit.color[i][0] - 0.1)
    };
    // The shadow begins at x = −0.5 − 0.75, in pixels 30 − 15 · 1.25; the square itself hides it from x = −2/3
    // on, at pixel 20.
    for y in 23..37 {
        let length: f32 = (0..60).map(|x| taken(x, y)).sum();
        assert!((length - 8.75).abs() < 2e-3, "row {y}: {length} pixels of shadow");
        assert!((taken(11, y) - 0.75).abs() < 2e-3, "row {y}: {} of a pixel", taken(11, y));
    }
    // It is as wide as the square, from y = −0.5 to 0.5: pixels 22.5 to 37.5.
    let width: f32 = (0..60).map(|y| taken(15, y)).sum();
    assert!((width - 15.0).abs() < 2e-3, "{width} pixels of shadow");
    // Nothing else lies in shadow: neither the square itself nor the plane elsewhere.
    let all: f32 = (0..3600).map(|i| taken(i % 60, i / 60)).sum();
    assert!((all - 8.75 * 15.0).abs() < 0.02, "{all} pixels of shadow");
}
