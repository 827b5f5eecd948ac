//! What one height layer does over regions: its heights at their corners, and how far it is at most from what is linear in
//! between. Regions over few texels are gone through texel by texel, large ones are listed and searched block by block.

use std::sync::Arc;

use displace_glsl::{
    SHADERS,
    layout::bound::{
        BoundLargeParams, BoundMapsParams, BoundPlacesParams, BoundSidesParams, BoundStartsParams, MapPlaces,
        MapSearch, MapUse,
    },
    reference::{bound::Asked, place::Places},
};

use super::{bounds::Regions, pyramids::Pyramids, tables::BoundTables};
use crate::{
    domain::Result,
    render::{JobContext, lists::compact::Compact},
    vulkan::{Device, Recorder, Stream},
};

const WORD: u32 = 4;
const VEC4: u32 = 16;
/// About so many texels and crossings has a region at most that is not large.
const FEW: f32 = 600.0;
/// Large regions that are searched at a time: more do not fit a stream.
const LOT: u64 = 1 << 20;

/// The maps of one mesh on a device.
pub(super) struct Maps {
    device: Arc<Device>,
    pyramids: Pyramids,
    texel_places: Stream,
    layers: Stream,
    texels: Stream,
    stride: u32,
    at_texels: u32,
    /// False where base triangles are so small that no region is large.
    may_be_large: bool,
}

/// Regions under one layer. What is bound to the passes that work on them.
pub(super) struct OnMap {
    places: Stream,
    uses: Stream,
    flags: Stream,
    /// Heights at the corners, and what is between.
    pub(super) bounds: Stream,
}

impl OnMap {
    pub(super) fn new(device: &Arc<Device>, count: u64) -> Result<Self> {
        Ok(Self {
            places: Stream::new(device, "map_places", size_of::<MapPlaces>() as u32, count)?,
            uses: Stream::new(device, "map_uses", size_of::<MapUse>() as u32, count)?,
            flags: Stream::new(device, "flags", WORD, count)?,
            bounds: Stream::new(device, "map_bounds", VEC4, count)?,
        })
    }
}

impl Maps {
    pub(super) fn new(
        job: &JobContext<'_>,
        device: &Arc<Device>,
        places: &Places<'_>,
        tables: &BoundTables,
        asked: Asked,
    ) -> Result<Self> {
        let layers = Stream::from_slice(device, "layers", &places.tables.layers)?;
        let texels = Stream::of_texels(device, &places.tables.texels)?;
        Ok(Self {
            device: Arc::clone(device),
            pyramids: Pyramids::new(job, device, places, &layers, &texels)?,
            texel_places: Stream::from_slice(device, "texel_places", &tables.texel_places)?,
            layers,
            texels,
            stride: tables.stride,
            at_texels: u32::from(asked.at_texels),
            may_be_large: tables.largest_cost() > f64::from(FEW),
        })
    }

    /// At most of a region.
    pub(super) fn layers(&self) -> u32 {
        self.stride
    }

    /// Records what the layer of this number among those of a region's detail does. Where regions may be large what was
    /// recorded has to run first: what follows goes into the recorder that comes back.
    pub(super) fn record<'r>(
        &self,
        job: &'r JobContext<'_>,
        mut recorder: Recorder<'r>,
        regions: &Regions<'_>,
        layer: u32,
        on: &OnMap,
    ) -> Result<Recorder<'r>> {
        self.record_places(&mut recorder, regions, layer, on)?;
        self.record_small(&mut recorder, regions, on)?;
        if !self.may_be_large {
            return Ok(recorder);
        }
        let compact = Compact::new(&self.device, regions.count)?;
        let large = Stream::new(&self.device, "large", WORD, regions.count)?;
        compact.record(&mut recorder, &on.flags, &large, regions.count)?;
        recorder.finish()?;
        let mut recorder = self.device.recorder(job.cancel, job.progress);
        let total = compact.total()?;
        for first in (0..total).step_by(LOT as usize) {
            self.record_large(&mut recorder, regions, on, &large, [first, LOT.min(total - first)])?;
        }
        Ok(recorder)
    }

    fn record_places(&self, recorder: &mut Recorder<'_>, regions: &Regions<'_>, layer: u32, on: &OnMap) -> Result<()> {
        let params = BoundPlacesParams {
            count: regions.count as u32,
            of_lines: u32::from(regions.of_lines),
            layer,
            stride: self.stride,
            cap: regions.cap,
            most_texels: if self.may_be_large { FEW } else { f32::MAX },
        };
        let streams = [
            ("facets", regions.facets),
            ("lines", regions.lines),
            ("bound_triangles", regions.triangles),
            ("layers", &self.layers),
            ("texel_places", &self.texel_places),
            ("texels", &self.texels),
            ("map_places", &on.places),
            ("map_uses", &on.uses),
            ("map_bounds", &on.bounds),
            ("flags", &on.flags),
        ];
        recorder.dispatch(&SHADERS.bound_places, regions.count, &params, &streams)?;
        Ok(())
    }

    fn record_small(&self, recorder: &mut Recorder<'_>, regions: &Regions<'_>, on: &OnMap) -> Result<()> {
        let (count, of_lines) = (regions.count as u32, u32::from(regions.of_lines));
        let params = BoundMapsParams { count, of_lines, at_texels: self.at_texels };
        let streams = [
            ("map_places", &on.places),
            ("map_uses", &on.uses),
            ("layers", &self.layers),
            ("texels", &self.texels),
            ("flags", &on.flags),
            ("map_bounds", &on.bounds),
        ];
        recorder.dispatch(&SHADERS.bound_maps, regions.count, &params, &streams)?;
        Ok(())
    }

    /// Of `count` large regions from `first` of the list on.
    fn record_large(
        &self,
        recorder: &mut Recorder<'_>,
        regions: &Regions<'_>,
        on: &OnMap,
        large: &Stream,
        [first, count]: [u64; 2],
    ) -> Result<()> {
        let side_bounds = Stream::new(&self.device, "side_bounds", WORD, count)?;
        let searches = Stream::new(&self.device, "searches", size_of::<MapSearch>() as u32, count)?;
        let (pyramids, blocks) = (("pyramids", &self.pyramids.pyramids), ("blocks", &self.pyramids.blocks));
        let (places, uses, bounds) = (("map_places", &on.places), ("map_uses", &on.uses), ("map_bounds", &on.bounds));
        let (layers, texels, large) = (("layers", &self.layers), ("texels", &self.texels), ("large", large));
        let (of_lines, at_texels, threads) = (u32::from(regions.of_lines), self.at_texels, count);
        let (first, count) = (first as u32, count as u32);
        recorder.fill(&side_bounds, 0)?;
        let side_bounds = ("side_bounds", &side_bounds);
        let params = BoundSidesParams { count: 3 * count, first, of_lines, at_texels };
        let streams = [places, uses, layers, large, bounds, texels, side_bounds];
        recorder.dispatch(&SHADERS.bound_sides, 3 * threads, &params, &streams)?;
        let params = BoundStartsParams { count, first, of_lines, cap: regions.cap, layers: self.stride };
        let searches = ("searches", &searches);
        let streams = [places, uses, layers, large, bounds, texels, pyramids, blocks, searches];
        recorder.dispatch(&SHADERS.bound_starts, threads, &params, &streams)?;
        let params = BoundLargeParams { count, first, of_lines, at_texels };
        let streams = [places, uses, layers, large, bounds, texels, side_bounds, pyramids, blocks, searches];
        recorder.dispatch(&SHADERS.bound_large, threads, &params, &streams)?;
        Ok(())
    }
}
