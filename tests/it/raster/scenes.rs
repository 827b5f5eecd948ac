//! Scenes for the image tests.

use std::sync::Arc;

use displace_glsl::layout::raster::MAP_BASE_COLOR;
use displace_server::domain::{
    camera::render_camera,
    detail::Wrap,
    image::{
        ColorMap, Lighting, RenderAlpha, RenderCamera, RenderInstance, RenderMap, RenderMaterial, RenderMesh,
        RenderScene,
    },
    request::CameraChoice,
    scene::Scene,
};
use displace_tests::meshes::{self, TestMesh};

use super::ALL_AOVS;

/// Background that no lit surface has.
pub(crate) const LEAK: f32 = 4.0;
pub(crate) const IDENTITY: [f32; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0];

/// World x and y are pixels, y down; z is the reversed depth itself.
pub(crate) fn pixel_camera(width: u32, height: u32) -> RenderCamera {
    let (sx, sy) = (2.0 / width as f32, -2.0 / height as f32);
    let clip_from_view = [sx, 0.0, 0.0, 0.0, 0.0, sy, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, -1.0, 1.0, 0.0, 1.0];
    RenderCamera { view_from_world: IDENTITY, clip_from_view, eye_world: [0.0; 3] }
}

pub(crate) fn view_camera(eye: [f32; 3], target: [f32; 3], fov: f32, width: u32, height: u32) -> RenderCamera {
    let choice = CameraChoice::LookAt { eye, target, yfov_degrees: fov };
    render_camera(&choice, &Scene::default(), [[-1.0; 3], [1.0; 3]], width, height).expect("a good camera")
}

pub(crate) struct Builder {
    scene: RenderScene,
}

impl Builder {
    /// Colours come out as they go in.
    pub(crate) fn unlit(camera: RenderCamera) -> Self {
        let mut builder = Self::lit(camera);
        builder.scene.lighting =
            Lighting { lights: Vec::new(), environment: None, ambient: 1.0, background: [LEAK; 3] };
        builder
    }

    pub(crate) fn lit(camera: RenderCamera) -> Self {
        Self { scene: RenderScene { camera, uv_channels: 1, aovs: ALL_AOVS.to_vec(), ..Default::default() } }
    }

    pub(crate) fn flat_triangle(&mut self, corners: [[f32; 3]; 3], color: [f32; 3]) {
        let mesh = RenderMesh {
            positions: Arc::new(corners.to_vec()),
            normals: Arc::new(vec![[0.0, 0.0, 1.0]; 3]),
            uvs: Arc::new(vec![[0.0; 2]; 3]),
            triangles: Arc::new(vec![[0, 1, 2]]),
            ..RenderMesh::default()
        };
        self.add(mesh, material(color, None), IDENTITY);
    }

    pub(crate) fn mesh(&mut self, mesh: &TestMesh, color: [f32; 3]) {
        self.add(render_mesh(mesh), material(color, None), IDENTITY);
    }

    pub(crate) fn textured_mesh(&mut self, mesh: &TestMesh, map: &Arc<ColorMap>) {
        self.add(render_mesh(mesh), material([0.9, 0.8, 0.7], Some(map.clone())), IDENTITY);
    }

    pub(crate) fn add(&mut self, mut mesh: RenderMesh, material: RenderMaterial, world_from_mesh: [f32; 16]) {
        mesh.material_of_triangles = vec![(0, self.scene.materials.len() as u32)];
        self.scene.materials.push(material);
        let mesh_index = self.scene.meshes.len();
        self.scene.instances.push(RenderInstance { mesh: mesh_index, world_from_mesh, stands_for: None });
        self.scene.meshes.push(mesh);
    }

    pub(crate) fn finish(self) -> RenderScene {
        self.scene
    }
}

pub(crate) fn render_mesh(mesh: &TestMesh) -> RenderMesh {
    RenderMesh {
        positions: Arc::new(mesh.positions.clone()),
        normals: Arc::new(mesh.normals.clone()),
        uvs: Arc::new(mesh.uvs.clone()),
        triangles: Arc::new(mesh.triangles.clone()),
        material_of_triangles: vec![(0, 0)],
        ..RenderMesh::default()
    }
}

/// Double-sided, with a texture transform that tells its rows apart.
pub(crate) fn material([r, g, b]: [f32; 3], map: Option<Arc<ColorMap>>) -> RenderMaterial {
    let base_color = map.map(|map| RenderMap {
        map,
        uv_channel: 0,
        map_from_uv: [[3.0, 0.5, 0.1], [-0.25, 2.0, -0.3]],
        wrap: [Wrap::Repeat, Wrap::Mirror],
    });
    let mut material =
        RenderMaterial { base_color_factor: [r, g, b, 1.0], double_sided: true, ..RenderMaterial::default() };
    material.maps[MAP_BASE_COLOR] = base_color;
    material
}

/// Opaque and transparent squares in uneven colours.
pub(crate) fn checker(width: u32, height: u32) -> Arc<ColorMap> {
    let texel = |i: u32| {
        let (x, y) = (i % width, i / width);
        let light = if (x / 3 + y / 3) % 2 == 0 { 0.9 } else { 0.2 };
        [light, light * x as f32 / width as f32, light * y as f32 / height as f32, if light > 0.5 { 1.0 } else { 0.0 }]
    };
    Arc::new(ColorMap { width, height, texels: (0..width * height).map(texel).collect() })
}

/// A fence of small and large triangles with holes, before a plane of one colour.
pub(crate) fn masked_grid(size: u32) -> RenderScene {
    let mut builder = Builder::unlit(view_camera([0.0, 1.3, 0.4], [0.0; 3], 50.0, size, size));
    let mut fence = material([1.0; 3], Some(checker(16, 16)));
    fence.alpha = RenderAlpha::Mask { cutoff: 0.5 };
    builder.add(render_mesh(&meshes::plane(60)), fence.clone(), IDENTITY);
    let mut raised = IDENTITY;
    (raised[0], raised[10], raised[13]) = (0.4, 0.4, 0.3);
    builder.add(render_mesh(&meshes::plane(1)), fence, raised);
    let mut lowered = IDENTITY;
    (lowered[0], lowered[10], lowered[13]) = (9.0, 9.0, -0.5);
    builder.add(render_mesh(&meshes::plane(1)), material([0.0, 0.0, 1.0], None), lowered);
    builder.finish()
}

/// A single-sided plane that faces the camera, unless `flipped`.
pub(crate) fn one_sided(mirrored: bool, flipped: bool) -> RenderScene {
    let mut builder = Builder::lit(view_camera([0.0, 2.0, 0.5], [0.0; 3], 40.0, 32, 32));
    let mut mesh = meshes::plane(3);
    if flipped {
        mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    let mut world_from_mesh = IDENTITY;
    world_from_mesh[0] = if mirrored { -1.5 } else { 1.5 };
    let material = RenderMaterial { double_sided: false, ..material([0.5; 3], None) };
    builder.add(render_mesh(&mesh), material, world_from_mesh);
    builder.finish()
}
