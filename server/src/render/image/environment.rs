//! An environment on the device: its map, the map's mips and its irradiance in one stream; and the
//! table of what surfaces reflect.

use std::sync::Arc;

use displace_glsl::{
    SHADERS,
    layout::{
        light::{BrdfAveragesParams, BrdfTableParams, TABLE_SAMPLES, TABLE_SIDE},
        raster::MipParams,
    },
    reference::environment::{IRRADIANCE_SIZE, irradiance_over_pi},
};

use crate::{
    domain::{Result, environment::Environment},
    vulkan::{Device, Recorder, Stream},
};

/// Streams that `surroundings` reads.
pub struct EnvironmentStreams {
    /// First texel, width, height, 0 of each level: the map, its mips, irradiance over pi.
    pub levels: Stream,
    /// Linear RGB, two texels to an element.
    pub texels: Stream,
    /// The map and its mips.
    pub mips: u32,
    layout: Layout,
}

impl EnvironmentStreams {
    /// The streams with the map in them; `record` makes the rest.
    pub fn upload(device: &Arc<Device>, environment: &Environment) -> Result<Self> {
        let layout = Layout::new(environment.width, environment.height);
        let irradiance = irradiance_over_pi(environment.width as usize, &environment.texels);
        let irradiance: Vec<[f32; 4]> = irradiance.texels.iter().map(|texel| texel.map(|x| x as f32)).collect();
        let map: Vec<[f32; 4]> = environment.texels.iter().map(|[r, g, b]| [*r, *g, *b, 1.0]).collect();
        let lists = [(map, 0), (irradiance, layout.levels[layout.mips as usize][0] as usize)];
        Ok(Self {
            levels: Stream::from_slice(device, "environment levels", &layout.levels)?,
            texels: Stream::build(device, "environment texels", layout.pairs, |first, pairs: &mut [[[f32; 4]; 2]]| {
                pairs.fill([[0.0; 4]; 2]);
                lists
                    .iter()
                    .for_each(|(list, start)| overlay(list, *start, first as usize * 2, pairs.as_flattened_mut()));
            })?,
            mips: layout.mips,
            layout,
        })
    }

    /// Makes the map's mips.
    pub fn record(&self, recorder: &mut Recorder<'_>) -> Result<()> {
        let levels = &self.layout.levels;
        for (source, target) in levels.iter().zip(&levels[1..self.mips as usize]) {
            let count = pairs(target);
            let params = MipParams {
                count: count as u32,
                source_first: source[0],
                target_first: target[0],
                source_size: [source[1], source[2]],
                target_size: [target[1], target[2]],
            };
            recorder.dispatch(&SHADERS.mip, count, &params, &[("texels", &self.texels)])?;
        }
        Ok(())
    }
}

/// Copies what of a list that starts at texel `start` falls into `texels`, which start at texel `first`.
fn overlay(list: &[[f32; 4]], start: usize, first: usize, texels: &mut [[f32; 4]]) {
    let (from, to) = (start.max(first), (start + list.len()).min(first + texels.len()));
    if from < to {
        texels[from - first..to - first].copy_from_slice(&list[from - start..to - start]);
    }
}

/// Where the levels lie.
struct Layout {
    levels: Vec<[u32; 4]>,
    mips: u32,
    /// Elements of the stream.
    pairs: u64,
}

impl Layout {
    fn new(width: u32, height: u32) -> Self {
        let mut this = Self { levels: Vec::new(), mips: 0, pairs: 0 };
        let mut size = [width, height];
        this.add(size);
        while size != [1, 1] {
            size = size.map(|side| (side / 2).max(1));
            this.add(size);
        }
        this.mips = this.levels.len() as u32;
        this.add(IRRADIANCE_SIZE.map(|side| side as u32));
        this
    }

    fn add(&mut self, [width, height]: [u32; 2]) {
        let level = [(self.pairs * 2) as u32, width, height, 0];
        self.pairs += pairs(&level);
        self.levels.push(level);
    }
}

fn pairs([_, width, height, _]: &[u32; 4]) -> u64 {
    (u64::from(*width) * u64::from(*height)).div_ceil(2)
}

/// The stream that `shade_pbr` reads as `brdf_table`, empty unless it is needed; `record_table` fills it.
pub fn table(device: &Arc<Device>, is_needed: bool) -> Result<Stream> {
    let side = u64::from(TABLE_SIDE);
    Ok(Stream::new(device, "brdf table", 12, if is_needed { side * side + side } else { 0 })?)
}

/// Fills the table of what surfaces reflect, and its averages.
pub fn record_table(recorder: &mut Recorder<'_>, table: &Stream) -> Result<()> {
    let cells = TABLE_SIDE * TABLE_SIDE;
    let params = BrdfTableParams { count: cells, side: TABLE_SIDE, samples: TABLE_SAMPLES };
    let bound = [("brdf_table", table)];
    recorder.dispatch(&SHADERS.brdf_table, u64::from(cells), &params, &bound)?;
    let params = BrdfAveragesParams { count: TABLE_SIDE };
    Ok(recorder.dispatch(&SHADERS.brdf_averages, u64::from(TABLE_SIDE), &params, &bound)?)
}
