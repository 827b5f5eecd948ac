//! Maps of materials on the device: all mip levels of all maps in one stream, two texels to an element, built in compute
//! from level 0.

use std::sync::Arc;

use displace_glsl::{
    SHADERS,
    layout::raster::{MAP_BASE_COLOR, MAP_SLOTS, MipParams, TextureUse},
};

use crate::{
    domain::{
        Error, Result,
        image::{ColorMap, RenderScene},
    },
    vulkan::{Device, MAX_PAGES, PAGE_SHIFT, Recorder, Stream},
};

use super::coverage;

pub(crate) struct Textures {
    /// First texel, width, height, and the bits of alpha's scale, of every level of every map.
    pub(crate) levels: Vec<[u32; 4]>,
    /// Range of `levels` of each map.
    ranges: Vec<(u32, u32)>,
    maps: Vec<Arc<ColorMap>>,
    /// Elements of the stream.
    pairs: u64,
}

impl Textures {
    /// Lays out the distinct maps of the scene and tells their uses where they are.
    pub(crate) fn new(scene: &RenderScene, uses: &mut [TextureUse]) -> Result<Self> {
        let mut this = Self { levels: Vec::new(), ranges: Vec::new(), maps: Vec::new(), pairs: 0 };
        for (material, uses) in scene.materials.iter().zip(uses.chunks_mut(MAP_SLOTS)) {
            for (source, place) in material.maps.iter().zip(uses.iter_mut()) {
                if let Some(source) = source {
                    let known = this.maps.iter().position(|other| Arc::ptr_eq(other, &source.map));
                    let index = known.map_or_else(|| this.add(&source.map), Ok)?;
                    (place.level_first, place.level_count) = this.ranges[index];
                }
            }
            if let Some(scales) = coverage::alpha_scales(material) {
                this.scale_alpha(&mut uses[MAP_BASE_COLOR], &scales);
            }
        }
        Ok(this)
    }

    /// Gives a use levels of its own, over the same texels.
    fn scale_alpha(&mut self, place: &mut TextureUse, scales: &[f32]) {
        let first = place.level_first as usize;
        let levels = self.levels[first..first + place.level_count as usize].to_vec();
        place.level_first = self.levels.len() as u32;
        self.levels
            .extend(levels.iter().zip(scales).map(|(&[at, width, height, _], s)| [at, width, height, s.to_bits()]));
    }

    fn add(&mut self, map: &Arc<ColorMap>) -> Result<usize> {
        let texels = u64::from(map.width) * u64::from(map.height);
        if texels == 0 || texels != map.texels.len() as u64 {
            return Err(Error::internal(format!(
                "a map of {} x {} has {} texels",
                map.width,
                map.height,
                map.texels.len()
            )));
        }
        let first_level = self.levels.len() as u32;
        let (mut width, mut height) = (map.width, map.height);
        loop {
            self.levels.push([(self.pairs * 2) as u32, width, height, 1f32.to_bits()]);
            self.pairs += (u64::from(width) * u64::from(height)).div_ceil(2);
            if width * height == 1 {
                break;
            }
            (width, height) = ((width / 2).max(1), (height / 2).max(1));
        }
        let most = MAX_PAGES << PAGE_SHIFT;
        if self.pairs > most {
            let message = format!("the maps and their mips have more than {} texels: use smaller maps", 2 * most);
            return Err(Error::too_large("images", message));
        }
        self.ranges.push((first_level, self.levels.len() as u32 - first_level));
        self.maps.push(map.clone());
        Ok(self.maps.len() - 1)
    }

    /// The stream with level 0 of every map in it.
    pub(crate) fn upload(&self, device: &Arc<Device>) -> Result<Stream> {
        let stream = Stream::build(device, "texels", self.pairs, |first, elements: &mut [[f32; 8]]| {
            elements.fill([0.0; 8]);
            self.write_level_0(first as usize * 2, bytemuck::cast_slice_mut(elements));
        })?;
        Ok(stream)
    }

    /// Writes what of the maps falls into `texels`, which starts at texel `first`.
    fn write_level_0(&self, first: usize, texels: &mut [[f32; 4]]) {
        for (map, range) in self.maps.iter().zip(&self.ranges) {
            let start = self.levels[range.0 as usize][0] as usize;
            let (from, to) = (start.max(first), (start + map.texels.len()).min(first + texels.len()));
            if from < to {
                texels[from - first..to - first].copy_from_slice(&map.texels[from - start..to - start]);
            }
        }
    }

    /// Builds all coarser levels.
    pub(crate) fn record_mips(&self, recorder: &mut Recorder<'_>, texels: &Stream) -> Result<()> {
        for &(first, count) in &self.ranges {
            for level in first..first + count - 1 {
                let [source_first, source_width, source_height, _] = self.levels[level as usize];
                let [target_first, width, height, _] = self.levels[level as usize + 1];
                let count = (u64::from(width) * u64::from(height)).div_ceil(2);
                let params = MipParams {
                    count: count as u32,
                    source_first,
                    target_first,
                    source_size: [source_width, source_height],
                    target_size: [width, height],
                };
                recorder.dispatch(&SHADERS.mip, count, &params, &[("texels", texels)])?;
            }
        }
        Ok(())
    }
}
