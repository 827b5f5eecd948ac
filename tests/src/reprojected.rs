//! What an EXR of a mesh with one height map is off by, by the surface's definition: apart from whatever made it.

use std::{collections::HashMap, path::Path, sync::Arc};

use bytes::Bytes;
use displace_server::{
    domain::{
        Digest,
        detail::{Detail, Sampling},
        gltf,
        image::ImageSet,
        maps,
        request::{Channel, LayerRequest, MapRequest, MaterialDetail, Preset, SeamRule, SourceRequest},
        scene::Scene,
    },
    oracle::{
        metrics::picture,
        reprojection::{Reprojected, p99_px, reprojected},
        surface::{SeamChoice, Surface},
    },
};
use exr::prelude::{FlatSamples, read_first_flat_layer_from_file};

/// A mesh and the heights on all of it, as `displace render MESH --height MAP --scale S` has them.
pub struct Displaced {
    scene: Scene,
    details: Vec<Vec<Option<Arc<Detail>>>>,
}

impl Displaced {
    /// # Panics
    /// When a file cannot be read.
    #[must_use]
    pub fn load(mesh: &Path, map: &Path, scale: f32) -> Self {
        let read = |path: &Path| Bytes::from(std::fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display())));
        let folder = mesh.parent().expect("a folder").to_owned();
        let resource = |uri: &str| std::fs::read(folder.join(uri)).ok().map(Bytes::from);
        let scene = gltf::load(&read(mesh), &resource, &gltf::Limits::default()).expect("a mesh");
        let height = read(map);
        let assets: HashMap<Digest, Bytes> = [(Digest::of(&height), height.clone())].into();
        let requests = [MaterialDetail { material: None, layers: vec![layer(Digest::of(&height), scale)], uv_set: 0 }];
        let details = maps::resolve(&scene, &requests, &|digest| Ok(assets[digest].clone())).expect("a detail");
        let of_mesh = |m: &displace_server::domain::scene::SceneMesh| {
            m.mesh.primitives.iter().map(|p| details.of(p.material).cloned()).collect()
        };
        let details = scene.meshes.iter().map(of_mesh).collect();
        Self { scene, details }
    }

    /// World units.
    #[must_use]
    pub fn diagonal(&self) -> f64 {
        self.scene.diagonal
    }

    /// Middle of the mesh as it is.
    #[must_use]
    pub fn centre(&self) -> [f32; 3] {
        let [low, high] = self.scene.bounds;
        [0, 1, 2].map(|k| 0.5 * (low[k] + high[k]))
    }

    /// Of every pixel that shows something.
    #[must_use]
    pub fn errors(&self, images: &ImageSet) -> Vec<Reprojected> {
        let choice = SeamChoice { rule: SeamRule::Mean, feather_texels: 3.0 };
        let pairs = self.scene.meshes.iter().zip(&self.details);
        let surfaces: Vec<Surface<'_>> = pairs.map(|(m, details)| Surface::new(&m.mesh, details, choice)).collect();
        reprojected(&self.scene, &surfaces, images, usize::MAX)
    }

    /// Pixels that 99 of 100 do not exceed; none where nothing is shown.
    #[must_use]
    pub fn p99_px(&self, images: &ImageSet) -> Option<f64> {
        p99_px(&self.errors(images))
    }
}

fn layer(asset: Digest, scale: f32) -> LayerRequest {
    let map = MapRequest { asset, wrap: None, sampling: Sampling::Center };
    LayerRequest {
        source: SourceRequest::Height { map, channel: Channel::R },
        scale,
        midlevel: None,
        invert_height: false,
        flip_v: false,
        preset: Preset::Right,
    }
}

/// An EXR with `--aov depth,position,uv`.
///
/// # Panics
/// When it is none.
#[must_use]
pub fn layers(path: &Path) -> ImageSet {
    let bytes = std::fs::read(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let limits = picture::Limits { max_side: 16384, max_bytes: 1 << 32 };
    let clip_from_world = picture::read("image", &bytes, limits).expect("an EXR").clip_from_world;
    let image = read_first_flat_layer_from_file(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let size = image.layer_data.size;
    let channel = |name: &str| -> Option<Vec<f32>> {
        let channel = image.layer_data.channel_data.list.iter().find(|channel| channel.name.eq(name))?;
        let FlatSamples::F32(values) = &channel.sample_data else { panic!("{name} is not f32") };
        Some(values.clone())
    };
    let zipped = |names: [&str; 3]| -> Option<Vec<[f32; 3]>> {
        let [x, y, z] = names.map(channel);
        Some(x?.into_iter().zip(y?).zip(z?).map(|((x, y), z)| [x, y, z]).collect())
    };
    let uv = channel("uv.U").zip(channel("uv.V")).map(|(u, v)| u.into_iter().zip(v).map(|(u, v)| [u, v]).collect());
    ImageSet {
        width: size.x() as u32,
        height: size.y() as u32,
        depth: channel("Z"),
        position: zipped(["position.X", "position.Y", "position.Z"]),
        uv,
        clip_from_world,
        ..ImageSet::default()
    }
}

/// Pixels that one of two images shows something in and the other nothing, and the length of the first's outline. Both have
/// as many samples a pixel, any of which shows something.
///
/// # Panics
/// Without depth.
#[must_use]
pub fn outline_px(truth: &ImageSet, image: &ImageSet) -> (u64, u64) {
    let covered = |images: &ImageSet| -> Vec<bool> {
        images.depth.as_ref().expect("depth").iter().map(|depth| depth.is_finite()).collect()
    };
    let (truth_covers, image_covers, width) = (covered(truth), covered(image), truth.width as usize);
    let apart = truth_covers.iter().zip(&image_covers).filter(|(a, b)| a != b).count();
    let is_edge = |i: usize, j: usize| j < truth_covers.len() && truth_covers[i] != truth_covers[j];
    let edges =
        |i: usize| u64::from(!(i + 1).is_multiple_of(width) && is_edge(i, i + 1)) + u64::from(is_edge(i, i + width));
    (apart as u64, (0..truth_covers.len()).map(edges).sum())
}
