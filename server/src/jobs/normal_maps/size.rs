//! How large normal maps are, and what all of them take.

use std::sync::Arc;

use crate::{
    domain::{
        Error, Result,
        detail::Detail,
        mesh::Mesh,
        normal_map,
        request::{Geometry, Normals},
    },
    jobs::inputs::Inputs,
};

/// Host memory that a texel takes while its map is made: all maps of one mesh are made together.
const BYTES_WHILE_MADE: u64 = 64;
/// Host memory that a texel takes from then on: 3 bytes as PNG has it at worst, in the map and in the file written.
const BYTES_KEPT: u64 = 6;
/// Coarser levels of detail do not go below this.
const LEAST_OF_LEVELS: u32 = 64;

/// Texels along u and v at a level of detail: as asked for or as many as the largest map of the detail has, and half as
/// many with each level.
pub(super) fn of_level(asked: Option<u32>, detail: &Detail, level: u32) -> [u32; 2] {
    let largest = detail.layers.iter().filter_map(|layer| layer.source.size()).max_by_key(|[w, h]| w * h);
    let [least, most] = [*normal_map::SIZES.start(), *normal_map::SIZES.end()];
    let of_detail = largest.map_or([normal_map::DEFAULT_SIZE; 2], |size| size.map(|side| side.clamp(least, most)));
    let size = asked.map_or(of_detail, |side| [side; 2]);
    size.map(|side| (side >> level).max(LEAST_OF_LEVELS.min(side)))
}

/// What all maps of a job take.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Needed {
    maps: u64,
    /// Of all maps together.
    texels: u64,
    /// Of the maps that the mesh with the most of them has at level 0.
    texels_at_once: u64,
    lods: u32,
    /// Of the surfaces that they lie on, as far as they are counted.
    surface_bytes: u64,
}

impl Needed {
    pub(super) fn of(inputs: &Inputs, geometry: &Geometry, lods: u32) -> Self {
        let Normals::Map { size } = geometry.normals else { return Self::default() };
        let surface_bytes = inputs.plans.output_bytes(&inputs.scene);
        let mut needed = Self { lods, surface_bytes, ..Self::default() };
        for (m, details) in inputs.scene.meshes.iter().zip(&inputs.details) {
            needed.add(&m.mesh, details, size);
        }
        needed
    }

    fn add(&mut self, mesh: &Mesh, details: &[Option<Arc<Detail>>], size: Option<u32>) {
        let mut at_once = 0;
        for detail in mapped(mesh, details) {
            let texels = |level: u32| of_level(size, detail, level).map(u64::from).iter().product::<u64>();
            at_once += texels(0);
            self.texels += (0..self.lods).map(texels).sum::<u64>();
            self.maps += u64::from(self.lods);
        }
        self.texels_at_once = self.texels_at_once.max(at_once);
    }

    pub(super) fn check(self, allowed: u64) -> Result<()> {
        let bytes = self.bytes();
        if bytes <= allowed {
            return Ok(());
        }
        let Self { maps, texels, texels_at_once, lods, surface_bytes } = self;
        let message = format!(
            "{maps} normal maps for {lods} levels of detail have {texels} texels, {texels_at_once} of them made at once: that takes {bytes} bytes of host memory with {surface_bytes} of surfaces, and this server gives a job {allowed}: give a smaller normal_map_size, ask for fewer levels, or detail fewer primitives"
        );
        Err(Error::too_large("geometry.normal_map_size", message))
    }

    /// Of host memory, with the surfaces.
    fn bytes(self) -> u64 {
        self.surface_bytes + self.texels_at_once * BYTES_WHILE_MADE + self.kept_bytes()
    }

    /// Of the maps once they are made.
    pub(super) fn kept_bytes(self) -> u64 {
        self.texels * BYTES_KEPT
    }
}

/// The details of the primitives that get a map.
fn mapped<'d>(mesh: &'d Mesh, details: &'d [Option<Arc<Detail>>]) -> impl Iterator<Item = &'d Detail> {
    let primitives = mesh.primitives.iter().zip(details);
    primitives.filter(|(p, _)| !p.triangles.is_empty()).filter_map(|(_, detail)| detail.as_deref())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::mesh::Primitive;

    #[test]
    fn sides_halve_from_level_to_level_down_to_64_or_what_was_asked_for() {
        let detail = Detail { layers: Vec::new(), uv_set: 0 };
        let sides = |asked| [0, 1, 2, 5].map(|level| of_level(asked, &detail, level)[0]);
        assert_eq!(sides(None), [1024, 512, 256, 64]);
        assert_eq!(sides(Some(16)), [16; 4]);
    }

    #[test]
    fn every_primitive_with_a_detail_counts_at_every_level() {
        let detail = Some(Arc::new(Detail { layers: Vec::new(), uv_set: 0 }));
        let primitive = |triangles| Primitive { triangles, ..Primitive::default() };
        let primitives = vec![primitive(0..1), primitive(1..2), primitive(2..2), primitive(2..3)];
        let mesh = Mesh { primitives, ..Mesh::default() };
        let mut needed = Needed { lods: 2, ..Needed::default() };
        needed.add(&mesh, &[detail.clone(), detail.clone(), detail.clone(), None], Some(512));
        needed.add(&mesh, &[detail, None, None, None], Some(512));
        let expected = Needed { maps: 6, texels: 15 << 16, texels_at_once: 2 << 18, ..needed };
        assert_eq!(needed, expected);
    }

    #[test]
    fn all_maps_count_and_what_is_too_much_is_told_with_figures_and_remedy() {
        let thirty = Needed { maps: 30, texels: 30 << 24, texels_at_once: 30 << 24, lods: 1, surface_bytes: 0 };
        assert_eq!(thirty.bytes(), (30 << 24) * 70);
        assert!(thirty.check(thirty.bytes()).is_ok());
        let error = thirty.check(16 << 30).unwrap_err();
        assert_eq!(error.field.as_deref(), Some("geometry.normal_map_size"));
        for part in ["30 normal maps", "503316480 texels", "35232153600 bytes", "17179869184", "smaller"] {
            assert!(error.message.contains(part), "{part}: {}", error.message);
        }
    }
}
