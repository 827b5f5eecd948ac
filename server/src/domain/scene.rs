//! A loaded glTF asset: base meshes, instances, materials and cameras, and the document to write back.

use bytes::Bytes;
use glam::{DMat3, DMat4};

use super::{mesh::Mesh, report::Warning};

/// A glTF asset ready for work. `document` and `buffers` keep everything, understood or not, so that
/// what is not touched passes through.
#[derive(Clone, Debug, Default)]
pub struct Scene {
    /// The whole glTF JSON.
    pub document: serde_json::Value,
    /// The bytes of each glTF buffer.
    pub buffers: Vec<Bytes>,
    /// One per glTF mesh that has triangles.
    pub meshes: Vec<SceneMesh>,
    /// Uses of `meshes` by nodes of the default scene.
    pub instances: Vec<Instance>,
    pub materials: Vec<Material>,
    pub images: Vec<SceneImage>,
    pub cameras: Vec<Camera>,
    pub lights: Vec<PunctualLight>,
    /// Diagonal of the undisplaced scene's box, world units.
    pub diagonal: f64,
    /// Box of the undisplaced scene, world units.
    pub bounds: [[f32; 3]; 2],
    /// What was wrong or repaired while loading.
    pub warnings: Vec<Warning>,
}

#[derive(Clone, Debug, Default)]
pub struct SceneMesh {
    pub gltf_mesh: usize,
    pub mesh: Mesh,
}

/// `world_from_mesh` is column-major, as in glTF.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Instance {
    pub mesh: usize,
    pub world_from_mesh: [f32; 16],
}

impl Instance {
    /// Jacobi's method settles quadratically: three or four sweeps do.
    const SWEEPS: usize = 12;

    /// A mesh that no node places: world space is its own.
    #[must_use]
    pub fn as_it_is(mesh: usize) -> Self {
        Self { mesh, world_from_mesh: glam::Mat4::IDENTITY.to_cols_array() }
    }

    /// `world_from_mesh` in f64.
    #[must_use]
    pub fn world(&self) -> DMat4 {
        DMat4::from_cols_array(&self.world_from_mesh.map(f64::from))
    }

    /// Least and most by which it enlarges a distance, world units for a local unit; the least is 0 where it
    /// flattens. By one-sided Jacobi rotations.
    #[must_use]
    pub fn singular_values(&self) -> [f64; 2] {
        let m = DMat3::from_mat4(self.world());
        let mut axes = [m.x_axis, m.y_axis, m.z_axis];
        for (p, q) in [(0, 1), (0, 2), (1, 2)].into_iter().cycle().take(3 * Self::SWEEPS) {
            let (a, b) = (axes[p], axes[q]);
            let across = a.dot(b);
            if across == 0.0 {
                continue;
            }
            let zeta = (b.length_squared() - a.length_squared()) / (2.0 * across);
            let tangent = zeta.signum() / (zeta.abs() + zeta.hypot(1.0));
            let cosine = 1.0 / tangent.hypot(1.0);
            axes[p] = cosine * (a - tangent * b);
            axes[q] = cosine * (tangent * a + b);
        }
        let lengths = axes.map(|axis| axis.length());
        [lengths.into_iter().fold(f64::MAX, f64::min), lengths.into_iter().fold(0.0, f64::max)]
    }
}

/// A material of glTF 2.0, 3.9; its default is that of the format.
#[derive(Clone, Debug)]
pub struct Material {
    pub name: Option<String>,
    /// Linear RGBA.
    pub base_color_factor: [f32; 4],
    pub base_color: Option<TextureUse>,
    pub metallic_factor: f32,
    /// Perceptual.
    pub roughness_factor: f32,
    /// Green is roughness, blue metallic.
    pub metallic_roughness: Option<TextureUse>,
    /// In the tangent frame of MikkTSpace.
    pub normal: Option<TextureUse>,
    pub normal_scale: f32,
    /// Also where the map is only in a format of an extension.
    pub has_normal_map: bool,
    /// TEXCOORD_n of the normal map.
    pub normal_uv_set: u32,
    /// Red is the share of light from everywhere that arrives.
    pub occlusion: Option<TextureUse>,
    pub occlusion_strength: f32,
    pub emissive: Option<TextureUse>,
    /// Linear radiance, KHR_materials_emissive_strength worked in.
    pub emissive_factor: [f32; 3],
    /// KHR_materials_unlit.
    pub unlit: bool,
    pub double_sided: bool,
    pub alpha: Alpha,
    /// KHR_materials_displacement(s): H = factor · red + offset.
    pub displacement: Option<MaterialDisplacement>,
}

impl Default for Material {
    fn default() -> Self {
        Self {
            name: None,
            base_color_factor: [1.0; 4],
            base_color: None,
            metallic_factor: 1.0,
            roughness_factor: 1.0,
            metallic_roughness: None,
            normal: None,
            normal_scale: 1.0,
            has_normal_map: false,
            normal_uv_set: 0,
            occlusion: None,
            occlusion_strength: 1.0,
            emissive: None,
            emissive_factor: [0.0; 3],
            unlit: false,
            double_sided: false,
            alpha: Alpha::Opaque,
            displacement: None,
        }
    }
}

/// What the alpha of a base colour means.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Alpha {
    /// Nothing.
    #[default]
    Opaque,
    /// Below the cut-off there is no surface.
    Mask { cutoff: f32 },
    /// The share of what is behind that the surface takes away.
    Blend,
}

/// A light of KHR_lights_punctual where a node puts it.
#[derive(Clone, Debug, PartialEq)]
pub struct PunctualLight {
    pub kind: PunctualKind,
    /// Linear.
    pub color: [f32; 3],
    /// Lux of a directional light, candela of others.
    pub intensity: f32,
    /// World units, nothing arrives from farther; `None`: endless.
    pub range: Option<f32>,
    pub position_world: [f32; 3],
    /// Where it shines, unit, world space.
    pub direction_world: [f32; 3],
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub enum PunctualKind {
    Directional,
    Point,
    Spot { inner_cone_radians: f32, outer_cone_radians: f32 },
}

#[derive(Clone, Debug, PartialEq)]
pub struct MaterialDisplacement {
    pub texture: TextureUse,
    pub factor: f32,
    pub offset: f32,
}

/// A texture as a material uses it.
#[derive(Clone, Debug, PartialEq)]
pub struct TextureUse {
    /// Index into `Scene::images`.
    pub image: usize,
    pub uv_set: u32,
    pub wrap: [super::detail::Wrap; 2],
    /// KHR_texture_transform as rows of uv' = M (u, v, 1).
    pub map_from_uv: [[f32; 3]; 2],
}

/// Encoded bytes of an image of the file; `None` when the file names one that could not be found.
#[derive(Clone, Debug, Default)]
pub struct SceneImage {
    pub media_type: String,
    pub bytes: Option<Bytes>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct Camera {
    pub name: Option<String>,
    pub world_from_camera: [f32; 16],
    /// Vertical field of view in radians; `None` for orthographic.
    pub yfov_radians: Option<f32>,
    /// Half height of an orthographic view, world units.
    pub ymag: f32,
    pub znear: f32,
    pub zfar: Option<f32>,
}

#[cfg(test)]
mod tests {
    use glam::{DMat3, DMat4, DQuat, DVec3};

    use super::*;

    fn instance(m: DMat3) -> Instance {
        let world = DMat4::from_mat3(m) * DMat4::from_translation(DVec3::splat(7.0));
        Instance { mesh: 0, world_from_mesh: world.as_mat4().to_cols_array() }
    }

    #[test]
    fn singular_values_are_those_of_the_scales_between_two_rotations() {
        let (u, v) = (DQuat::from_rotation_x(0.7), DQuat::from_rotation_z(-1.3) * DQuat::from_rotation_y(0.4));
        for scales in [[1.0, 1.0, 1.0], [0.5, 2.0, 3.0], [-4.0, 1e-3, 0.2], [2.0, 2.0, 5.0], [0.0, 1.0, 3.0]] {
            let m = DMat3::from_quat(u) * DMat3::from_diagonal(DVec3::from_array(scales)) * DMat3::from_quat(v);
            let [least, most] = instance(m).singular_values();
            let lengths = scales.map(f64::abs);
            assert!((least - lengths.into_iter().fold(f64::MAX, f64::min)).abs() < 1e-6 * most, "{scales:?}: {least}");
            assert!((most - lengths.into_iter().fold(0.0, f64::max)).abs() < 1e-6 * most, "{scales:?}: {most}");
        }
    }

    #[test]
    fn a_shear_enlarges_more_than_its_axes() {
        let [least, most] = instance(DMat3::from_cols(DVec3::X, DVec3::new(1.0, 1.0, 0.0), DVec3::Z)).singular_values();
        let golden = 0.5 * (1.0 + 5f64.sqrt());
        assert!((most - golden).abs() < 1e-6 && (least - 1.0 / golden).abs() < 1e-6, "{least} {most}");
    }

    #[test]
    fn an_instance_of_no_size_has_no_singular_values() {
        assert_eq!(instance(DMat3::ZERO).singular_values(), [0.0, 0.0]);
    }
}
