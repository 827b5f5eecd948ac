//! The pass `attributes`: texture coordinates, colours and all else that is interpolated. Joints and
//! weights are `skin`'s.

use std::sync::Arc;

use displace_glsl::{SHADERS, layout::geometry::AttributesParams, tables::Tables};

use super::{skin, streams::BaseStreams, subdivide::blocks};
use crate::{
    domain::{
        Error, Result,
        mesh::{Attribute, Mesh},
        plan::{MAX_PAGES, PAGE_ELEMENTS, SurfacePlan},
    },
    vulkan::{Device, Recorder, Stream},
};

/// The values of one attribute over fine vertices, in successive streams of whole vertices.
#[derive(Default)]
pub struct Values(Vec<Stream>);

impl Values {
    pub fn read(&self) -> Result<Vec<f32>> {
        let mut streams = self.0.iter();
        let mut values = streams.next().map_or(Ok(Vec::new()), Stream::read)?;
        for stream in streams {
            values.extend(stream.read::<f32>()?);
        }
        Ok(values)
    }
}

/// One entry per attribute of the mesh; those blended on the host stay empty.
pub fn record(
    device: &Arc<Device>,
    recorder: &mut Recorder<'_>,
    plan: &SurfacePlan,
    tables: &Tables,
    mesh: &Mesh,
    base: &BaseStreams,
) -> Result<Vec<Values>> {
    let one = |attribute: &Attribute| {
        if skin::is_skin(&attribute.semantic) {
            return Ok(Values::default());
        }
        interpolate(device, recorder, plan, tables, attribute, base)
    };
    mesh.attributes.iter().map(one).collect()
}

fn interpolate(
    device: &Arc<Device>,
    recorder: &mut Recorder<'_>,
    plan: &SurfacePlan,
    tables: &Tables,
    attribute: &Attribute,
    base: &BaseStreams,
) -> Result<Values> {
    let components = attribute.components as u64;
    let limit = PAGE_ELEMENTS * MAX_PAGES;
    if components == 0 || attribute.values.len() as u64 > limit {
        let semantic = &attribute.semantic;
        return Err(Error::too_large("mesh", format!("{semantic} holds more than {limit} values")));
    }
    let base_values = Stream::from_slice(device, &attribute.semantic, &attribute.values)?;
    let mut all = Values::default();
    let vertices_of_stream = limit / components;
    for first in (0..plan.vertices).step_by(vertices_of_stream as usize) {
        let end = (first + vertices_of_stream).min(plan.vertices);
        let values = Stream::new(device, &attribute.semantic, 4, (end - first) * components)?;
        for (block, block_first, count) in blocks(tables) {
            let start = first.clamp(block_first, block_first + count);
            let stop = end.clamp(block_first, block_first + count);
            let params = AttributesParams {
                count: (stop - start) as u32,
                start: (start - block_first) as u32,
                to: (start - first) as u32,
                block,
                components: components as u32,
                lattice: tables.lattice,
            };
            let streams = [
                ("base_edges", &base.base_edges),
                ("base_triangles", &base.base_triangles),
                ("base_values", &base_values),
                ("values", &values),
            ];
            recorder.dispatch(&SHADERS.attributes, stop - start, &params, &streams)?;
        }
        all.0.push(values);
    }
    Ok(all)
}
