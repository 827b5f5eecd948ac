//! Maps that a request puts in place of those of the materials, and where on them a surface is read.

use serde::{Deserialize, Serialize};

use crate::domain::{Digest, projection::Projection};

/// In images and in the result; the projection in images alone.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct LookMaps {
    pub base_color: Option<Digest>,
    pub metallic_roughness: Option<Digest>,
    pub occlusion: Option<Digest>,
    pub emissive: Option<Digest>,
    /// Replaces the alpha of base colours.
    pub opacity: Option<Digest>,
    pub projection: Projection,
}

/// One of the maps that replace those of a material as they are.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum LookMap {
    BaseColor,
    MetallicRoughness,
    Occlusion,
    Emissive,
}

impl LookMaps {
    /// Every map named, in the order in which they are put in place.
    pub fn replaced(&self) -> impl Iterator<Item = (LookMap, Digest)> {
        [
            (LookMap::BaseColor, self.base_color),
            (LookMap::MetallicRoughness, self.metallic_roughness),
            (LookMap::Occlusion, self.occlusion),
            (LookMap::Emissive, self.emissive),
        ]
        .into_iter()
        .filter_map(|(map, asset)| asset.map(|asset| (map, asset)))
    }

    pub fn assets(&self) -> impl Iterator<Item = Digest> {
        self.replaced().map(|(_, asset)| asset).chain(self.opacity)
    }
}
