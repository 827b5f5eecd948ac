//! Details as numbered layers: the affine maps to texel space, the wrap rules, one arena of texels.

use std::{ops::Range, sync::Arc};

use displace_glsl::{
    layout::geometry::{Instruction, Layer, MapAxis, kind},
    tables::Tables,
};

use crate::domain::{
    Error, Result,
    detail::{Detail, Layer as DetailLayer, LayerSource, Map, Sampling, Wrap},
    plan::MAX_TEXELS,
};

/// Far outside every map, and exact in f32.
const FAR: i32 = 1 << 23;
/// Fold that changes nothing.
const NO_FOLD: i32 = 1 << 30;

/// The detail number of each primitive; 0 is no detail.
pub struct Numbering {
    pub of_primitive: Vec<u32>,
    /// By detail number, from 1.
    pub details: Vec<Arc<Detail>>,
}

impl Numbering {
    /// Details shared by several primitives get one number.
    #[must_use]
    pub fn new(details: &[Option<Arc<Detail>>]) -> Self {
        let mut distinct: Vec<Arc<Detail>> = Vec::new();
        let number = |detail: &Option<Arc<Detail>>| {
            let Some(detail) = detail.as_ref().filter(|d| !d.layers.is_empty()) else { return 0 };
            let known = distinct.iter().position(|other| Arc::ptr_eq(other, detail));
            let index = known.unwrap_or_else(|| {
                distinct.push(Arc::clone(detail));
                distinct.len() - 1
            });
            index as u32 + 1
        };
        Self { of_primitive: details.iter().map(number).collect(), details: distinct }
    }

    #[must_use]
    pub fn detail(&self, number: u32) -> Option<&Arc<Detail>> {
        self.details.get((number as usize).checked_sub(1)?)
    }
}

/// Fills `details`, `layers`, `texels` and `instructions`.
pub fn fill(tables: &mut Tables, numbering: &Numbering) -> Result<()> {
    let mut arena = Arena::default();
    tables.details.push(0..0);
    for detail in &numbering.details {
        let first = tables.layers.len() as u32;
        for layer in &detail.layers {
            let record = arena.layer(layer)?;
            tables.layers.push(record);
        }
        tables.details.push(Range { start: first, end: tables.layers.len() as u32 });
    }
    tables.texels = arena.texels();
    tables.instructions = arena.instructions;
    Ok(())
}

#[derive(Default)]
struct Arena {
    /// How many values the maps hold together.
    values: u64,
    instructions: Vec<Instruction>,
    /// Maps in the arena one after the other, and where each begins.
    maps: Vec<(Arc<Map>, u32)>,
}

impl Arena {
    fn layer(&mut self, layer: &DetailLayer) -> Result<Layer> {
        match &layer.source {
            LayerSource::Height(map) => self.map_layer(kind::HEIGHT, 1, layer, map),
            LayerSource::VectorTangent(map) => self.map_layer(kind::VECTOR_TANGENT, 3, layer, map),
            LayerSource::VectorObject(map) => self.map_layer(kind::VECTOR_OBJECT, 3, layer, map),
            LayerSource::Expression(program) => {
                let first = self.instructions.len() as u32;
                self.instructions.extend_from_slice(&program.code);
                Ok(Layer {
                    kind: kind::EXPRESSION,
                    first,
                    row: program.code.len() as u32,
                    scale: layer.scale,
                    midlevel: layer.midlevel,
                    texel_from_u: layer.map_from_uv[0],
                    texel_from_v: layer.map_from_uv[1],
                    ..Layer::default()
                })
            }
        }
    }

    fn map_layer(&mut self, which: u32, channels: u32, layer: &DetailLayer, map: &Arc<Map>) -> Result<Layer> {
        if map.channels != channels {
            return Err(Error::internal(format!("a map has {} channels where {channels} are read", map.channels)));
        }
        let (across, to_x) = axis(map.width, map.wrap[0], map.sampling);
        let (down, to_y) = axis(map.height, map.wrap[1], map.sampling);
        Ok(Layer {
            kind: which,
            first: self.place(map)?,
            row: map.width,
            scale: layer.scale,
            midlevel: layer.midlevel,
            texel_from_u: row(layer.map_from_uv[0], to_x),
            texel_from_v: row(layer.map_from_uv[1], to_y),
            across,
            down,
        })
    }

    /// Where the map's texels start; each map is held once.
    fn place(&mut self, map: &Arc<Map>) -> Result<u32> {
        if let Some((_, first)) = self.maps.iter().find(|(known, _)| Arc::ptr_eq(known, map)) {
            return Ok(*first);
        }
        let first = self.values;
        self.values += map.texels.len() as u64;
        if self.values > MAX_TEXELS {
            return Err(Error::too_large(
                "details",
                format!("the maps of one mesh hold more than {MAX_TEXELS} values together: use smaller or fewer maps"),
            ));
        }
        self.maps.push((Arc::clone(map), first as u32));
        Ok(first as u32)
    }

    /// Of all maps; those of one alone are not copied: they may take a gigabyte.
    fn texels(&self) -> Arc<Vec<f32>> {
        match self.maps.as_slice() {
            [(only, _)] => Arc::clone(&only.texels),
            all => {
                let mut texels = Vec::with_capacity(self.values as usize);
                all.iter().for_each(|(map, _)| texels.extend_from_slice(&map.texels));
                Arc::new(texels)
            }
        }
    }
}

/// The wrap rule of one axis of n texels, and texel space = scale · u + offset.
fn axis(texels: u32, wrap: Wrap, sampling: Sampling) -> (MapAxis, [f64; 2]) {
    let n = texels as i32;
    let (step, scale_offset) = match sampling {
        Sampling::Center => (n, [f64::from(n), -0.5]),
        Sampling::Node => (n - 1, [f64::from(n - 1), 0.0]),
    };
    let (period, top, fold) = match wrap {
        // A node map in [0, 1] is read as it is up to its last texel, which its period leaves out.
        Wrap::Repeat => (step, n - 1, NO_FOLD),
        Wrap::Mirror if sampling == Sampling::Center => (2 * n, 2 * n - 1, 2 * n - 1),
        Wrap::Mirror => (2 * step, (2 * step - 1).max(0), if n > 1 { 2 * step } else { NO_FOLD }),
        Wrap::Clamp => (n, n - 1, NO_FOLD),
    };
    let (low, high) = if wrap == Wrap::Clamp { (0, n - 1) } else { (-FAR, FAR) };
    let period = period.max(1);
    (MapAxis { low, high, period, top, fold, inverse_period: 1.0 / period as f32 }, scale_offset)
}

/// scale · (row · (u, v, 1)) + offset, rounded once.
fn row(map_from_uv: [f32; 3], [scale, offset]: [f64; 2]) -> [f32; 3] {
    let [a, b, c] = map_from_uv.map(f64::from);
    [(scale * a) as f32, (scale * b) as f32, (scale * c + offset) as f32]
}

#[cfg(test)]
mod tests {
    use displace_glsl::reference::map::wrapped;

    use super::*;

    fn texels(n: u32, wrap: Wrap, sampling: Sampling, range: Range<i64>) -> Vec<u64> {
        range.map(|i| wrapped(&axis(n, wrap, sampling).0, i)).collect()
    }

    #[test]
    fn centre_maps_wrap_by_their_texels() {
        assert_eq!(texels(3, Wrap::Repeat, Sampling::Center, -4..5), [2, 0, 1, 2, 0, 1, 2, 0, 1]);
        assert_eq!(texels(3, Wrap::Mirror, Sampling::Center, -4..8), [2, 2, 1, 0, 0, 1, 2, 2, 1, 0, 0, 1]);
        assert_eq!(texels(3, Wrap::Clamp, Sampling::Center, -2..5), [0, 0, 0, 1, 2, 2, 2]);
    }

    #[test]
    fn node_maps_share_their_last_texel_with_the_first_of_the_next_period() {
        assert_eq!(texels(3, Wrap::Repeat, Sampling::Node, -2..6), [0, 1, 0, 1, 2, 1, 0, 1]);
        assert_eq!(texels(3, Wrap::Mirror, Sampling::Node, -2..6), [2, 1, 0, 1, 2, 1, 0, 1]);
    }

    #[test]
    fn a_single_texel_is_everywhere() {
        for wrap in [Wrap::Repeat, Wrap::Mirror, Wrap::Clamp] {
            for sampling in [Sampling::Center, Sampling::Node] {
                assert_eq!(texels(1, wrap, sampling, -3..4), [0; 7], "{wrap:?} {sampling:?}");
            }
        }
    }
}
