//! Base colour maps on the device: all mip levels of all maps in one stream of half floats, two texels to
//! an element, built in compute from level 0.

use std::sync::Arc;

use displace_glsl::{
    SHADERS,
    layout::raster::{Material, MipParams},
};
use half::{
    f16,
    slice::{HalfBitsSliceExt, HalfFloatSliceExt},
};

use crate::{
    domain::{
        Error, Result,
        image::{ColorMap, RenderScene},
    },
    vulkan::{Device, MAX_PAGES, PAGE_SHIFT, Recorder, Stream},
};

/// Largest value of a half float.
const HALF_MAX: f32 = 65504.0;

pub(crate) struct Textures {
    /// First texel, width, height of every level of every map.
    pub(crate) levels: Vec<[u32; 3]>,
    /// Range of `levels` of each map.
    ranges: Vec<(u32, u32)>,
    maps: Vec<Arc<ColorMap>>,
    /// Elements of the stream.
    pairs: u64,
}

impl Textures {
    /// Lays out the distinct maps of the scene and tells the materials where theirs is.
    pub(crate) fn new(scene: &RenderScene, materials: &mut [Material]) -> Result<Self> {
        let mut this = Self { levels: Vec::new(), ranges: Vec::new(), maps: Vec::new(), pairs: 0 };
        for (source, material) in scene.materials.iter().zip(materials) {
            if let Some(map) = &source.base_color {
                let known = this.maps.iter().position(|other| Arc::ptr_eq(other, map));
                let index = known.map_or_else(|| this.add(map), Ok)?;
                (material.level_first, material.level_count) = this.ranges[index];
            }
        }
        Ok(this)
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
            self.levels.push([(self.pairs * 2) as u32, width, height]);
            self.pairs += (u64::from(width) * u64::from(height)).div_ceil(2);
            if width * height == 1 {
                break;
            }
            (width, height) = ((width / 2).max(1), (height / 2).max(1));
        }
        let most = MAX_PAGES << PAGE_SHIFT;
        if self.pairs > most {
            let message =
                format!("the base colour maps and their mips have more than {} texels: use smaller maps", 2 * most);
            return Err(Error::too_large("look.base_color", message));
        }
        self.ranges.push((first_level, self.levels.len() as u32 - first_level));
        self.maps.push(map.clone());
        Ok(self.maps.len() - 1)
    }

    /// The stream with level 0 of every map in it.
    pub(crate) fn upload(&self, device: &Arc<Device>) -> Result<Stream> {
        let stream = Stream::build(device, "texels", self.pairs, |first, elements: &mut [[u32; 4]]| {
            elements.fill([0; 4]);
            let halves: &mut [u16] = bytemuck::cast_slice_mut(elements);
            self.write_level_0(first as usize * 8, halves.reinterpret_cast_mut());
        })?;
        Ok(stream)
    }

    /// Writes what of the maps falls into `halves`, which starts at `first`, counted in half floats.
    fn write_level_0(&self, first: usize, halves: &mut [f16]) {
        for (map, range) in self.maps.iter().zip(&self.ranges) {
            let start = self.levels[range.0 as usize][0] as usize * 4;
            let values: &[f32] = bytemuck::cast_slice(&map.texels);
            let (from, to) = (start.max(first), (start + values.len()).min(first + halves.len()));
            if from < to {
                convert(&values[from - start..to - start], &mut halves[from - first..to - first]);
            }
        }
    }

    /// Builds all coarser levels.
    pub(crate) fn record_mips(&self, recorder: &mut Recorder<'_>, texels: &Stream) -> Result<()> {
        for &(first, count) in &self.ranges {
            for level in first..first + count - 1 {
                let [source_first, source_width, source_height] = self.levels[level as usize];
                let [target_first, width, height] = self.levels[level as usize + 1];
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

/// Rounds to half floats, a block at a time.
fn convert(values: &[f32], halves: &mut [f16]) {
    let mut block = [0f32; 1024];
    for (values, halves) in values.chunks(block.len()).zip(halves.chunks_mut(block.len())) {
        let block = &mut block[..values.len()];
        block.iter_mut().zip(values).for_each(|(b, v)| *b = v.clamp(-HALF_MAX, HALF_MAX));
        halves.convert_from_f32_slice(block);
    }
}
