//! The recipe of a render, and what it takes.

use serde::{Deserialize, Serialize};

use super::Silhouettes;
use crate::domain::{
    Error, Result,
    request::{Aov, Rays},
};

/// The pure-data recipe of a render.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ImagePlan {
    pub width: u32,
    pub height: u32,
    /// Visibility samples per pixel: 4.
    pub samples: u32,
    /// The image is made so many times as wide and high, a power of two up to 16, and averaged.
    pub supersample: u32,
    /// Traces the image instead: the image oracle's work, on the reference alone.
    pub rays: Option<Rays>,
    /// The image is made in slabs of at most so many pixels a side; a multiple of 16.
    pub slab_px: u32,
    pub device_bytes: u64,
}

/// How much a scene holds, known before any of it is made.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ImageContents {
    /// Of all meshes, each counted once.
    pub vertices: u64,
    pub triangles: u64,
    /// Of all instances, each counted as often as it is used.
    pub instance_vertices: u64,
    pub instance_triangles: u64,
    /// Texels of the distinct maps of all kinds.
    pub texels: u64,
    /// Triangles of all meshes, and of all instances, in whose place others are drawn, so that relief changes outlines as this
    /// says.
    pub outlined: [u64; 2],
    pub silhouettes: Silhouettes,
    /// Of the distinct maps of heights that are shown per pixel.
    pub relief_texels: u64,
    pub has_colors: bool,
    /// Of each vertex.
    pub uv_channels: u32,
    pub has_tangents: bool,
    /// Some material is blended.
    pub has_layers: bool,
    /// Places are projected onto maps.
    pub is_projected: bool,
    /// Width and height of its map.
    pub environment: Option<[u32; 2]>,
    /// Of the environments of reflectors.
    pub reflection_texels: u64,
    /// Lights that cast shadows.
    pub shadow_lights: u32,
    /// Some material's slopes are filtered with their moments.
    pub has_moments: bool,
    /// Of the maps of what lights see.
    pub shadow_map_texels: u64,
    /// Rays meet the triangles.
    pub has_occluders: bool,
    /// Kinds of maps that any material has.
    pub map_slots: u32,
    /// Some material's normals are bent by formulas.
    pub has_formulas: bool,
    pub aovs: Vec<Aov>,
}

impl ImagePlan {
    pub const MAX_SIDE: u32 = 16384;
    pub const MAX_SLAB: u32 = 512;
    /// What `with_samples` takes: 4 of each pixel of an image up to 16 times as wide and high.
    pub const SAMPLES: [u32; 5] = [4, 16, 64, 256, 1024];

    /// Plans an image. Fails when a side is out of range.
    pub fn new(width: u32, height: u32, contents: &ImageContents) -> Result<Self> {
        for (field, side) in [("size.width", width), ("size.height", height)] {
            if !(1..=Self::MAX_SIDE).contains(&side) {
                let message = format!("{side} is out of range; 1 to {} pixels are allowed", Self::MAX_SIDE);
                return Err(Error::invalid(field, message));
            }
        }
        let slab_px = Self::MAX_SLAB;
        // As if the image were large: samples may make it so.
        let slab_pixels = u64::from((16 * width).min(slab_px)) * u64::from((16 * height).min(slab_px));
        let device_bytes = contents.scene_bytes() + contents.work_bytes(slab_pixels);
        Ok(Self { width, height, samples: 4, supersample: 1, rays: None, slab_px, device_bytes })
    }

    /// With so many samples of visibility a pixel. Fails with numbers that it does not take, and where the finer image
    /// would be too large.
    pub fn with_samples(self, samples: u32) -> Result<Self> {
        if !Self::SAMPLES.contains(&samples) {
            let message = format!(
                "{samples} samples a pixel are out of range; 4, 16, 64, 256 and 1024 are allowed, and any number up to 1024 with --device reference"
            );
            return Err(Error::invalid("samples", message));
        }
        let side = (samples / self.samples).isqrt();
        let longest = self.width.max(self.height);
        if longest * side > Self::MAX_SIDE {
            let message = format!(
                "{samples} samples a pixel are for images of up to {} pixels a side, and this has {longest}: take fewer, or a smaller image",
                Self::MAX_SIDE / side
            );
            return Err(Error::too_large("samples", message));
        }
        Ok(Self { supersample: side, ..self })
    }

    /// Of the image that is averaged.
    #[must_use]
    pub fn fine(&self) -> Self {
        let side = self.supersample;
        Self { width: self.width * side, height: self.height * side, supersample: 1, ..self.clone() }
    }
}

impl ImageContents {
    /// Vertices (place, normal, uvs, perhaps a colour), triangles and their corners' tangents, maps with their mips.
    #[must_use]
    pub fn scene_bytes(&self) -> u64 {
        let per_vertex = 12 + 12 + 8 * u64::from(self.uv_channels) + if self.has_colors { 16 } else { 0 };
        let per_triangle = 12
            + if self.has_tangents { 48 } else { 0 }
            // What is beyond their sides.
            + if self.relief_texels > 0 { 24 } else { 0 };
        // Corners, number, and two nodes.
        let per_occluder = if self.has_occluders { 36 + 4 + 2 * 32 } else { 0 };
        let occluders = self.instance_triangles * per_occluder;
        // The map with its mips, and its irradiance.
        let environment = self.environment.map_or(0, |[w, h]| u64::from(w) * u64::from(h) * 16 * 4 / 3 + (1 << 16))
            + self.reflection_texels * 16 * 4 / 3;
        // Levels of heights (4/3, twice where a map is a line), of each its bounds (the same), or its cones.
        let relief = self.relief_texels * 24;
        let maps = self.texels * 16 * 4 / 3 + relief + environment;
        let [vertices, triangles] = self.drawn(self.vertices, self.triangles, self.outlined[0]);
        vertices * (per_vertex + self.outline_bytes())
            + triangles * per_triangle
            + occluders
            + maps
            + self.shadow_map_texels * 16
    }

    /// Vertices and triangles with what is drawn in the place of so many: a hull of six corners and eight faces, or the
    /// triangle raised.
    fn drawn(&self, vertices: u64, triangles: u64, outlined: u64) -> [u64; 2] {
        let [corners, faces] = match self.silhouettes {
            Silhouettes::None => [0, 0],
            Silhouettes::Shell => [6, 8],
            Silhouettes::Quadric => [3, 1],
        };
        [vertices + outlined * corners, triangles + outlined * faces]
    }

    /// Of each vertex: along which heights are, and how the mesh bends.
    fn outline_bytes(&self) -> u64 {
        match self.silhouettes {
            _ if self.outlined[0] == 0 => 0,
            Silhouettes::None => 0,
            Silhouettes::Shell => 12,
            Silhouettes::Quadric => 12 + 24,
        }
    }

    /// Screen vertices, lists, records and pairs of large triangles, and what each sample and pixel takes.
    fn work_bytes(&self, slab_pixels: u64) -> u64 {
        let [vertices, triangles] = self.drawn(self.instance_vertices, self.instance_triangles, self.outlined[1]);
        let screen = 16 * vertices;
        let listed = triangles.min(1 << 20);
        let records = triangles.min(1 << 15) * 7 * (48 + 8) + (8 << 18);
        // Visibility, fragment, point, appearance, radiance, and a value of each kind of map.
        let per_sample = 8
            + 16
            + 112
            + 56
            + 16
            + 16 * u64::from(self.map_slots)
            + if self.has_formulas { 8 } else { 0 }
            + 4 * u64::from(self.shadow_lights)
            + if self.has_occluders { 16 * u64::from(self.shadow_lights) } else { 0 }
            // A point to read maps at, its frame, and what one projection shows.
            + if self.is_projected { 112 + 24 + 28 + 16 } else { 0 }
            + if self.environment.is_some() || self.reflection_texels > 0 { 36 } else { 0 }
            + if self.has_moments { 24 } else { 0 }
            // A course, its nodes, its march and where it lands.
            + if self.relief_texels > 0 { 20 + 9 * 16 + 24 + 36 } else { 0 };
        // Keys of two layers and of what is shown, transmittance; and what a pixel sees of them.
        let layers = if self.has_layers { 4 * (3 * 8 + 4) + 12 } else { 0 };
        // Of relief, what marches took.
        let outputs =
            self.aovs.iter().map(|aov| aov.bytes()).sum::<u64>() + if self.relief_texels > 0 { 16 } else { 0 };
        screen + listed * 20 + records + slab_pixels * (4 * per_sample + layers + 4 + 16 + outputs)
    }
}

impl Aov {
    /// Per pixel.
    fn bytes(self) -> u64 {
        match self {
            Self::Depth | Self::Triangle | Self::Overdraw | Self::Samples => 4,
            Self::Uv => 8,
            Self::Normal | Self::Position | Self::Cost => 12,
        }
    }
}
