//! The image oracle: against scenes whose images are known in closed form, against itself with more samples,
//! against the renderer, and through the command line.

mod agreement;
mod closed_forms;
mod light;
mod product;

use std::sync::Arc;

use displace_server::{
    domain::{
        cancel::{Cancel, NoProgress},
        image::{ImageSet, Lighting, RenderCamera, RenderInstance, RenderMaterial, Shading},
        projection::Projection,
        request::Aov,
    },
    oracle::image::{Exposure, OracleMesh, OracleScene, render},
};
use glam::{DVec2, DVec3};

pub(crate) const IDENTITY: [f32; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];
const AOVS: [Aov; 5] = [Aov::Depth, Aov::Normal, Aov::Position, Aov::Uv, Aov::Triangle];
/// The camera of these scenes stands here, looks along −z, and sees as far to each side as half the distance.
pub(crate) const EYE: DVec3 = DVec3::new(0.0, 0.0, 4.0);

/// Every number of it is exact in f32.
fn camera() -> RenderCamera {
    let mut view_from_world = IDENTITY;
    view_from_world[14] = -4.0;
    let clip_from_view = [2.0, 0.0, 0.0, 0.0, 0.0, 2.0, 0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 0.0, 0.0625, 0.0];
    RenderCamera { view_from_world, clip_from_view, eye_world: [0.0, 0.0, 4.0] }
}

/// Direction of what is seen at a place of a square image, with z = −1.
fn direction(at_px: DVec2, size_px: u32) -> DVec3 {
    let ndc = at_px * (2.0 / f64::from(size_px)) - 1.0;
    DVec3::new(0.5 * ndc.x, -0.5 * ndc.y, -1.0)
}

/// One mesh of one colour, seen from both sides.
fn scene(mesh: OracleMesh, color: [f32; 3], lighting: Lighting) -> OracleScene {
    let [r, g, b] = color;
    let material =
        RenderMaterial { base_color_factor: [r, g, b, 1.0], double_sided: true, ..RenderMaterial::default() };
    OracleScene {
        meshes: vec![mesh],
        instances: vec![RenderInstance { mesh: 0, world_from_mesh: IDENTITY, stands_for: None }],
        materials: vec![material],
        camera: camera(),
        lighting,
        shading: Shading::Phong,
        projection: Projection::Uv,
        bounces: 0,
        uv_channels: 1,
        aovs: AOVS.to_vec(),
    }
}

fn mesh(positions: Vec<DVec3>, normals: &[DVec3], triangles: Vec<[u32; 3]>) -> OracleMesh {
    OracleMesh {
        uvs: Arc::new(positions.iter().map(|p| p.truncate().as_vec2().to_array()).collect()),
        positions,
        normals: Arc::new(normals.iter().map(|n| n.as_vec3().to_array()).collect()),
        triangles: Arc::new(triangles),
        material_of_triangles: vec![(0, 0)],
        ..OracleMesh::default()
    }
}

fn image(scene: &OracleScene, size_px: u32, samples: u32, shadows: bool) -> ImageSet {
    let exposure = Exposure { width: size_px, height: size_px, samples, shadows };
    render(scene, &exposure, &Cancel::default(), &NoProgress).expect("renders")
}

/// Root of the mean square difference of all colours.
fn rmse(a: &ImageSet, b: &ImageSet) -> f64 {
    let squares = a.color.iter().zip(&b.color).flat_map(|(a, b)| (0..3).map(|k| f64::from(a[k] - b[k]).powi(2)));
    (squares.sum::<f64>() / (3.0 * a.color.len() as f64)).sqrt()
}

/// A torus before a background, with shadows on itself.
fn torus() -> OracleScene {
    let mesh_ = displace_tests::meshes::torus(96, 48);
    let wide = |p: &[f32; 3]| {
        let p = DVec3::from_array(p.map(f64::from));
        // Tilted towards the camera by an exact turn: 3-4-5.
        DVec3::new(p.x, 0.6 * p.y - 0.8 * p.z, 0.8 * p.y + 0.6 * p.z)
    };
    let normals: Vec<DVec3> = mesh_.normals.iter().map(wide).collect();
    let mesh = mesh(mesh_.positions.iter().map(wide).collect(), &normals, mesh_.triangles);
    scene(mesh, [0.8, 0.5, 0.3], Lighting::default())
}

#[test]
fn the_error_falls_as_samples_grow() {
    let scene = torus();
    let reference = image(&scene, 48, 1024, true);
    let errors = [1, 4, 16, 64, 256].map(|samples| rmse(&image(&scene, 48, samples, true), &reference));
    for pair in errors.windows(2) {
        // Random samples would halve it; these are better on edges, and far better where it is smooth.
        assert!(pair[1] < 0.5 * pair[0], "{errors:?}");
    }
    assert!(errors[3] < 2e-3, "{errors:?}");
}

#[test]
fn the_same_scene_gives_the_same_image() {
    let scene = torus();
    assert_eq!(image(&scene, 40, 8, true), image(&scene, 40, 8, true));
}

#[test]
fn further_outputs_are_those_of_the_centre_whatever_the_samples() {
    let scene = torus();
    let (few, many) = (image(&scene, 40, 1, false), image(&scene, 40, 16, true));
    assert_eq!((few.depth, few.normal, few.position), (many.depth, many.normal, many.position));
    assert_eq!((few.uv, few.triangle), (many.uv, many.triangle));
}

#[test]
fn a_cancelled_image_stops() {
    let cancel = Cancel::default();
    cancel.cancel();
    let exposure = Exposure { width: 8, height: 8, samples: 1, shadows: false };
    assert!(render(&torus(), &exposure, &cancel, &NoProgress).is_err());
}
