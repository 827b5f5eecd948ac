//! Heights that are shown per pixel, by material.

use std::sync::Arc;

use super::image::HeightMap;

/// The heights of one material.
#[derive(Clone, Debug)]
pub struct Relief {
    pub map: Arc<HeightMap>,
    /// Which TEXCOORD_n they are read at.
    pub uv_set: u32,
    /// Rows of the affine map from (u, v, 1) to where texel i of n is at (i + 1/2) / n.
    pub map_from_uv: [[f32; 3]; 2],
}

/// The heights of each material that has any.
#[derive(Clone, Debug, Default)]
pub struct Reliefs {
    /// Parallel to `Scene::materials`.
    pub of_material: Vec<Option<Arc<Relief>>>,
    /// Of primitives without a material.
    pub of_none: Option<Arc<Relief>>,
}

impl Reliefs {
    #[must_use]
    pub fn of(&self, material: Option<usize>) -> Option<&Arc<Relief>> {
        material.map_or(self.of_none.as_ref(), |m| self.of_material.get(m)?.as_ref())
    }

    /// Of all materials, then of none.
    pub fn all(&self) -> impl Iterator<Item = &Arc<Relief>> {
        self.of_material.iter().chain([&self.of_none]).flatten()
    }

    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.all().next().is_none()
    }

    /// Of all maps, each counted once.
    #[must_use]
    pub fn texels(&self) -> u64 {
        let mut maps: Vec<&Arc<HeightMap>> = self.all().map(|relief| &relief.map).collect();
        maps.sort_by_key(|map| Arc::as_ptr(map));
        maps.dedup_by_key(|map| Arc::as_ptr(map));
        maps.iter().map(|map| map.heights.len() as u64).sum()
    }
}
