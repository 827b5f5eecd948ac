//! The pyramids of height layers: planes near ever larger blocks of their maps, made on the device.

use std::sync::Arc;

use displace_glsl::{
    SHADERS,
    layout::bound::{MapBlock, MapPyramid, PyramidBlocksParams, PyramidLevelsParams},
    reference::{bound::Pyramid, place::Places},
};

use crate::{
    domain::Result,
    render::JobContext,
    vulkan::{Device, Recorder, Stream},
};

/// Those of all layers of a mesh; names are those of the shaders' bindings.
pub struct Pyramids {
    /// [`MapPyramid`], one for each layer.
    pub pyramids: Stream,
    /// [`MapBlock`]: of each layer, level by level, the finest first, row by row.
    pub blocks: Stream,
}

impl Pyramids {
    /// Of height layers and their texels on the device; `places` tells sizes alone.
    pub fn new(
        job: &JobContext<'_>,
        device: &Arc<Device>,
        places: &Places<'_>,
        layers: &Stream,
        texels: &Stream,
    ) -> Result<Self> {
        let mut first = 0;
        let tables: Vec<MapPyramid> = places.pyramids.iter().map(|of| table(of.first(), &mut first)).collect();
        let blocks = Stream::new(device, "blocks", size_of::<MapBlock>() as u32, u64::from(first))?;
        let made = Self { pyramids: Stream::from_slice(device, "pyramids", &tables)?, blocks };
        let mut recorder = device.recorder(job.cancel, job.progress);
        for (layer, pyramid) in (0..).zip(&places.pyramids) {
            if let Some(pyramid) = pyramid.first() {
                made.record(&mut recorder, layer, pyramid, [layers, texels])?;
            }
        }
        recorder.finish()?;
        Ok(made)
    }

    fn record(
        &self,
        recorder: &mut Recorder<'_>,
        layer: u32,
        of: &Pyramid,
        [layers, texels]: [&Stream; 2],
    ) -> Result<()> {
        let (pyramids, blocks) = (("pyramids", &self.pyramids), ("blocks", &self.blocks));
        for (level, size) in (0..).zip(of.sizes()) {
            let threads = count(size);
            if level == 0 {
                let streams = [("layers", layers), ("texels", texels), pyramids, blocks];
                let params = PyramidBlocksParams { count: threads, layer };
                recorder.dispatch(&SHADERS.pyramid_blocks, u64::from(threads), &params, &streams)?;
            } else {
                let params = PyramidLevelsParams { count: threads, layer, level };
                recorder.dispatch(&SHADERS.pyramid_levels, u64::from(threads), &params, &[pyramids, blocks])?;
            }
        }
        Ok(())
    }
}

fn count([across, down]: [i64; 2]) -> u32 {
    (across * down) as u32
}

/// Of a layer whose blocks begin at `first`, which then follows them.
fn table(of: Option<&Pyramid>, first: &mut u32) -> MapPyramid {
    let Some(of) = of else { return MapPyramid::default() };
    let top = of.sizes().count() as u32 - 1;
    let table = MapPyramid { cells: of.cells().map(|cells| cells as i32), first: *first, top };
    *first += of.sizes().map(count).sum::<u32>();
    table
}
