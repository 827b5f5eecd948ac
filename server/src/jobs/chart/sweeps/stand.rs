//! Where a chart is taken from: what is looked at, from which side, and how the surface faces.

use glam::{DMat4, DVec3};

use crate::{
    domain::{image::RenderCamera, request::CameraChoice},
    oracle::image::OracleScene,
};

/// Below this share of its area a surface faces no side in the mean: it is closed, or nearly.
const FACES: f64 = 0.2;
/// Of the view where the camera has none.
const YFOV_DEGREES: f64 = 40.0;

/// World space.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Stand {
    /// The place on the view's axis that is nearest to the middle of what is shown.
    pub(super) pivot: DVec3,
    /// From there to the eye, unit.
    pub(super) outward: DVec3,
    pub(super) distance: f64,
    /// Where the surface faces in the mean, on the eye's side; of a closed one, from the middle to the eye's height: +Y.
    pub(super) normal: DVec3,
    yfov_degrees: f64,
}

impl Stand {
    pub(in crate::jobs::chart) fn new(scene: &OracleScene) -> Self {
        let RenderCamera { eye_world, view_from_world, clip_from_view, .. } = scene.camera;
        let eye = DVec3::from_array(eye_world.map(f64::from));
        let outward = DMat4::from_cols_array(&view_from_world.map(f64::from)).row(2).truncate().normalize();
        let (middle, facing) = middle_and_facing(scene);
        let ahead = (eye - middle).dot(outward);
        let distance = if ahead > 0.0 { ahead } else { eye.distance(middle).max(f64::MIN_POSITIVE) };
        let has_perspective = clip_from_view[15] == 0.0;
        let of_camera = || 2.0 * (1.0 / f64::from(clip_from_view[5]).abs()).atan().to_degrees();
        Self {
            pivot: eye - distance * outward,
            outward,
            distance,
            normal: if facing.dot(outward) < 0.0 { -facing } else { facing },
            yfov_degrees: if has_perspective { of_camera() } else { YFOV_DEGREES },
        }
    }

    /// Towards the eye, within the surface, unit; any such direction where the eye is straight above.
    pub(super) fn along(&self) -> DVec3 {
        let along = self.outward - self.outward.dot(self.normal) * self.normal;
        along.try_normalize().unwrap_or_else(|| self.normal.any_orthonormal_vector())
    }

    /// From the pivot in a unit direction.
    pub(super) fn camera(&self, outward: DVec3, distance: f64) -> CameraChoice {
        CameraChoice::LookAt {
            eye: (self.pivot + distance * outward).as_vec3().to_array(),
            target: self.pivot.as_vec3().to_array(),
            yfov_degrees: self.yfov_degrees as f32,
        }
    }
}

/// Of the box around all triangles, and of their normals by area.
fn middle_and_facing(scene: &OracleScene) -> (DVec3, DVec3) {
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    let (mut normals, mut areas) = (DVec3::ZERO, 0.0);
    for instance in &scene.instances {
        let world = DMat4::from_cols_array(&instance.world_from_mesh.map(f64::from));
        let mesh = &scene.meshes[instance.mesh];
        let positions: Vec<DVec3> = mesh.positions.iter().map(|p| world.transform_point3(*p)).collect();
        for p in &positions {
            (low, high) = (low.min(*p), high.max(*p));
        }
        for triangle in mesh.triangles.iter() {
            let [a, b, c] = triangle.map(|v| positions[v as usize]);
            let normal = (b - a).cross(c - a);
            normals += normal;
            areas += normal.length();
        }
    }
    let middle = if low.is_finite() && high.is_finite() { 0.5 * (low + high) } else { DVec3::ZERO };
    let faces = normals.length() > FACES * areas;
    (middle, if faces { normals.normalize() } else { DVec3::Y })
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::{
        domain::{camera::render_camera, image::RenderInstance, scene::Scene},
        oracle::image::OracleMesh,
    };

    /// A wall that faces +Z, seen from its right.
    fn stand() -> Stand {
        let corners = [[-1.0, -1.0], [1.0, -1.0], [1.0, 1.0], [-1.0, 1.0]];
        let mesh = OracleMesh {
            positions: corners.map(|[x, y]| DVec3::new(x, y, 0.0)).into(),
            triangles: Arc::new(vec![[0, 1, 2], [0, 2, 3]]),
            ..OracleMesh::default()
        };
        let choice = CameraChoice::LookAt { eye: [3.0, 0.0, 4.0], target: [0.0; 3], yfov_degrees: 35.0 };
        let camera = render_camera(&choice, &Scene::default(), [[-1.0; 3], [1.0; 3]], 64, 64).unwrap();
        let instance =
            RenderInstance { mesh: 0, world_from_mesh: DMat4::IDENTITY.as_mat4().to_cols_array(), stands_for: None };
        Stand::new(&OracleScene { meshes: vec![mesh], instances: vec![instance], camera, ..OracleScene::default() })
    }

    #[test]
    fn a_wall_is_looked_at_in_its_middle_and_faces_the_eye() {
        let stand = stand();
        assert!(stand.pivot.length() < 1e-6 && (stand.distance - 5.0).abs() < 1e-6, "{stand:?}");
        assert!(stand.normal.distance(DVec3::Z) < 1e-12 && stand.along().distance(DVec3::X) < 1e-6, "{stand:?}");
        assert!((stand.yfov_degrees - 35.0).abs() < 1e-4, "{stand:?}");
    }

    #[test]
    fn angles_are_between_the_view_and_the_surface() {
        let stand = stand();
        let mut seen = Vec::new();
        for degrees in [30.0f64, 90.0] {
            let (sin, cos) = degrees.to_radians().sin_cos();
            let camera = stand.camera(cos * stand.along() + sin * stand.normal, 2.0);
            let CameraChoice::LookAt { eye, .. } = camera else { panic!("{camera:?}") };
            seen.push(eye);
        }
        let expected = [[3f32.sqrt(), 0.0, 1.0], [0.0, 0.0, 2.0]];
        let apart = seen.iter().flatten().zip(expected.iter().flatten()).map(|(a, b)| (a - b).abs());
        assert!(apart.fold(0.0, f32::max) < 1e-5, "{seen:?}");
    }
}
