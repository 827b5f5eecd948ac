//! How far a detail moves a surface at most.

use displace_glsl::expression::{Interval, VARIABLES, evaluate};

use super::{Detail, Layer, LayerSource, Map};
use crate::domain::{expression::Program, mesh::Mesh};

impl Detail {
    /// No place of `mesh` is moved farther, mesh-local units. An expression is taken over the mesh's box; infinite where
    /// it has no bound there.
    #[must_use]
    pub fn reach(&self, mesh: &Mesh) -> f64 {
        let length = |d: &[f32; 3]| d.iter().map(|x| f64::from(*x).powi(2)).sum::<f64>().sqrt();
        let longest = mesh.gv_direction.iter().map(length).fold(1.0, f64::max);
        longest * self.layers.iter().map(|layer| self.value(layer, mesh)).sum::<f64>()
    }

    /// Largest sum of the components of what a layer moves by.
    fn value(&self, layer: &Layer, mesh: &Mesh) -> f64 {
        let value = match &layer.source {
            LayerSource::Height(map) | LayerSource::VectorTangent(map) | LayerSource::VectorObject(map) => {
                of_map(map, layer.midlevel)
            }
            LayerSource::Expression(program) => of_expression(program, layer.midlevel, &self.variables(mesh)),
        };
        value * f64::from(layer.scale.abs())
    }

    /// u, v, x, y, z and the normal, all over the mesh.
    fn variables(&self, mesh: &Mesh) -> [Interval; VARIABLES] {
        let uvs = mesh.attribute(&format!("TEXCOORD_{}", self.uv_set)).map_or(&[][..], |uvs| &uvs.values);
        let over = |values: &[f32], size: usize, k: usize| over(values.iter().skip(k).step_by(size));
        let [u, v] = [0, 1].map(|k| over(uvs, 2, k));
        let bulge = mesh.bulge();
        let widened = |i: Interval| Interval::new(i.lo - bulge, i.hi + bulge);
        let [x, y, z] = [0, 1, 2].map(|k| widened(over(mesh.gv_position.as_flattened(), 3, k)));
        let n = Interval::new(-1.0, 1.0);
        [u, v, x, y, z, n, n, n]
    }
}

fn of_map(map: &Map, midlevel: f32) -> f64 {
    let texel = |texel: &[f32]| texel.iter().map(|value| f64::from((value - midlevel).abs())).sum();
    map.texels.chunks_exact(map.channels.max(1) as usize).map(texel).fold(0.0, f64::max)
}

fn of_expression(program: &Program, midlevel: f32, variables: &[Interval; VARIABLES]) -> f64 {
    let heights = evaluate(&program.code, variables);
    let midlevel = f64::from(midlevel);
    (heights.lo - midlevel).abs().max((heights.hi - midlevel).abs())
}

fn over<'a>(values: impl Iterator<Item = &'a f32>) -> Interval {
    let each = values.map(|value| f64::from(*value)).map(|value| (value, value));
    let (low, high) = each.reduce(|(low, high), (value, _)| (low.min(value), high.max(value))).unwrap_or_default();
    Interval::new(low, high)
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::domain::detail::{Sampling, Wrap};

    fn mesh() -> Mesh {
        Mesh { gv_position: vec![[0.0; 3], [2.0, 1.0, 0.0]], gv_direction: vec![[0.0, 0.0, 1.5]; 2], ..Mesh::default() }
    }

    fn reach(source: LayerSource, scale: f32, midlevel: f32) -> f64 {
        let map_from_uv = [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0]];
        Detail { layers: vec![Layer { source, scale, midlevel, map_from_uv }], uv_set: 0 }.reach(&mesh())
    }

    fn map(channels: u32, texels: Vec<f32>) -> Arc<Map> {
        let wrap = [Wrap::Repeat; 2];
        Arc::new(Map {
            width: 2,
            height: 1,
            channels,
            texels: texels.into(),
            wrap,
            sampling: Sampling::Center,
            source_bits: 32,
        })
    }

    #[test]
    fn a_height_reaches_as_far_as_its_farthest_texel_along_the_longest_direction() {
        assert_eq!(reach(LayerSource::Height(map(1, vec![0.25, 1.0])), -2.0, 0.5), 1.5);
    }

    #[test]
    fn a_vector_reaches_no_farther_than_the_sum_of_its_components() {
        assert_eq!(reach(LayerSource::VectorObject(map(3, vec![1.0, -2.0, 0.0, 0.0, 0.0, 2.5])), 1.0, 0.0), 4.5);
    }

    #[test]
    fn an_expression_reaches_what_it_is_over_the_box() {
        let found = reach(LayerSource::Expression(Arc::new(Program::parse("x * y - 3").unwrap())), 1.0, 0.0);
        assert!((4.5..4.5001).contains(&found), "{found}");
        let endless = reach(LayerSource::Expression(Arc::new(Program::parse("1 / x").unwrap())), 1.0, 0.0);
        assert_eq!(endless, f64::INFINITY);
    }
}
