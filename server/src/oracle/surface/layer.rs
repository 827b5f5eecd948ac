//! The displacement of one side by itself: the sum of its detail's layers.

use std::sync::Arc;

use displace_glsl::expression::{Instruction, evaluate};

use glam::DVec3;

use super::{Parameter, Surface, add, wide};
use crate::{
    domain::{
        detail::{Detail, Layer as DetailLayer, LayerSource},
        mesh::Mesh,
    },
    oracle::{field::Field, parameter::CELL_SLACK, smooth::Fields},
};

/// Shortest blended normal that a direction is divided by: opposite normals would send it to infinity.
const SHORTEST_NORMAL: f64 = 0.125;
/// Shortest blended normal that still has a direction.
const SHORTEST_UNIT: f64 = 1e-12;
/// Square of the length below which a tangent has no direction beside the normal.
const SHORTEST_TANGENT_SQUARE: f64 = 1e-8;

/// One layer, ready to be evaluated.
pub(in crate::oracle) struct Layer {
    source: Source,
    scale: f64,
    midlevel: f64,
    /// Rows of x = row · (u, v, 1): texel space for maps, the map's own (u, v) for expressions.
    rows: [[f64; 3]; 2],
}

enum Source {
    Height(Field),
    VectorTangent(Field),
    VectorObject(Field),
    Expression(Vec<Instruction>),
}

/// Where layers are evaluated.
pub(super) enum Site<'p, N: Parameter> {
    Triangle {
        t: usize,
        av: [u32; 3],
        place: &'p N::Place,
    },
    Edge {
        ae: u32,
        av: [u32; 2],
        along: N,
    },
    /// An attribute vertex.
    Corner {
        av: u32,
    },
}

impl<N: Parameter> Site<'_, N> {
    /// A quantity of attribute vertices, interpolated.
    fn blend(&self, value: impl Fn(usize) -> f64) -> N {
        match self {
            Self::Corner { av } => N::constant(value(*av as usize)),
            Self::Triangle { av, place, .. } => N::affine(place, av.map(|av| value(av as usize))),
            Self::Edge { av: [from, to], along, .. } => {
                let (from, to) = (value(*from as usize), value(*to as usize));
                N::constant(from).add(N::constant(to - from).mul(*along))
            }
        }
    }

    fn blend3(&self, value: impl Fn(usize) -> [f32; 3]) -> [N; 3] {
        std::array::from_fn(|k| self.blend(|av| f64::from(value(av)[k])))
    }
}

/// Layers per primitive; primitives that share a detail share them.
pub(super) fn of_primitives(details: &[Option<Arc<Detail>>]) -> Vec<Arc<Vec<Layer>>> {
    let mut known: Vec<(&Arc<Detail>, Arc<Vec<Layer>>)> = Vec::new();
    let mut of = |detail: &'_ Option<Arc<Detail>>| -> Option<Arc<Vec<Layer>>> {
        let index = details.iter().flatten().find(|d| detail.as_ref().is_some_and(|own| Arc::ptr_eq(own, d)))?;
        if let Some((_, layers)) = known.iter().find(|(other, _)| Arc::ptr_eq(other, index)) {
            return Some(Arc::clone(layers));
        }
        let layers = Arc::new(index.layers.iter().map(Layer::new).collect::<Vec<_>>());
        known.push((index, Arc::clone(&layers)));
        Some(layers)
    };
    details.iter().map(|detail| of(detail).unwrap_or_default()).collect()
}

/// The UV set each primitive's detail reads; (0, 0) where it reads none.
pub(super) fn texture_coordinates(mesh: &Mesh, details: &[Option<Arc<Detail>>]) -> Vec<[f64; 2]> {
    let mut uv = vec![[0.0; 2]; mesh.av_gv.len()];
    for (p, (primitive, detail)) in mesh.primitives.iter().zip(details).enumerate() {
        let set = detail.as_ref().map(|detail| format!("TEXCOORD_{}", detail.uv_set));
        let set = set.and_then(|semantic| mesh.attribute(&semantic));
        let Some(set) = set.filter(|a| a.components == 2 && a.primitives[p]) else { continue };
        let avs = primitive.avs.start as usize..primitive.avs.end as usize;
        for (uv, value) in uv[avs.clone()].iter_mut().zip(set.values[2 * avs.start..].chunks_exact(2)) {
            *uv = [value[0], value[1]].map(f64::from);
        }
    }
    uv
}

/// A region that reaches less than [`CELL_SLACK`] into a texel's neighbour is bounded as if the texel went on there.
/// Along either axis the two slopes differ by at most twice the map's range, at a place and at the corners it is
/// compared with; directions are longer than 1 where normals differ.
pub(super) fn slack(mesh: &Mesh, layers: &[Arc<Vec<Layer>>]) -> f64 {
    let longest = mesh.triangles.iter().map(|t| longest_direction(mesh, t.av)).fold(1.0, f64::max);
    let of_channel = |layer: &Layer, field: &Field, c: u32| {
        let [low, high] = field.range(c);
        8.0 * CELL_SLACK * layer.scale.abs() * (high - low)
    };
    let of_layer = |layer: &Layer| match layer.field() {
        Some(field) => (0..field.channels()).map(|c| of_channel(layer, field, c)).sum::<f64>() * longest,
        None => 0.0,
    };
    // On each side that is a seam, it is pulled from its own displacement to what all agree on; the three pulls weigh
    // no more than 2 together.
    5.0 * layers.iter().map(|layers| layers.iter().map(of_layer).sum()).fold(0.0, f64::max)
}

/// Over a triangle with these corners.
fn longest_direction(mesh: &Mesh, av: [u32; 3]) -> f64 {
    let normals = av.map(|av| wide(mesh.av_normal[av as usize]));
    let mean = normals.iter().sum::<DVec3>().normalize_or_zero();
    let shortest = normals.iter().map(|n| mean.dot(*n)).fold(f64::INFINITY, f64::min);
    let direction = |av: u32| wide(mesh.gv_direction[mesh.av_gv[av as usize] as usize]).length();
    av.map(direction).into_iter().fold(0.0, f64::max) / shortest.max(SHORTEST_NORMAL)
}

impl Layer {
    fn new(layer: &DetailLayer) -> Self {
        let plain = [[1.0, 0.0]; 2];
        let (source, texel_from_uv) = match &layer.source {
            LayerSource::Height(map) => with_texels(map, Source::Height),
            LayerSource::VectorTangent(map) => with_texels(map, Source::VectorTangent),
            LayerSource::VectorObject(map) => with_texels(map, Source::VectorObject),
            LayerSource::Expression(program) => (Source::Expression(program.code.clone()), plain),
        };
        let row = |axis: usize| {
            let [scale, offset] = texel_from_uv[axis];
            let [a, b, c] = layer.map_from_uv[axis].map(f64::from);
            [scale * a, scale * b, scale * c + offset]
        };
        let (scale, midlevel) = (f64::from(layer.scale), f64::from(layer.midlevel));
        Self { source, scale, midlevel, rows: [row(0), row(1)] }
    }

    fn reads_normal(&self) -> bool {
        matches!(self.source, Source::VectorTangent(_) | Source::Expression(_))
    }

    pub(super) fn field(&self) -> Option<&Field> {
        match &self.source {
            Source::Height(field) | Source::VectorTangent(field) | Source::VectorObject(field) => Some(field),
            Source::Expression(_) => None,
        }
    }

    pub(super) fn texel_space(&self, axis: usize, uv: [f64; 2]) -> f64 {
        let [a, b, c] = self.rows[axis];
        a * uv[0] + b * uv[1] + c
    }
}

fn with_texels(map: &Arc<crate::domain::detail::Map>, source: fn(Field) -> Source) -> (Source, [[f64; 2]; 2]) {
    let field = Field::new(map);
    let texel_from_uv = field.texel_from_uv();
    (source(field), texel_from_uv)
}

/// What layers read of the base.
struct Frame<N> {
    position: [N; 3],
    /// Unit, if a layer reads it.
    normal: [N; 3],
    direction: [N; 3],
}

impl Surface<'_> {
    /// The sum of a primitive's layers at a site.
    pub(super) fn displacement<N: Parameter>(&self, primitive: usize, site: &Site<'_, N>) -> [N; 3] {
        let layers = &self.layers[primitive];
        let zero = [N::constant(0.0); 3];
        if layers.is_empty() {
            return zero;
        }
        let frame = self.frame(site, layers.iter().any(Layer::reads_normal));
        layers.iter().fold(zero, |sum, layer| add(sum, self.layer(layer, site, &frame)))
    }

    /// Of a smooth base, but for its corners, whose frames are the mesh's.
    fn bent<N: Parameter>(&self, site: &Site<'_, N>) -> Option<Fields<N>> {
        let bends = self.bends.as_ref()?;
        match site {
            Site::Triangle { t, place, .. } => Some(bends.fields::<N>(*t, place)),
            Site::Edge { ae, along, .. } => Some(bends.on_edge::<N>(*ae, *along)),
            Site::Corner { .. } => None,
        }
    }

    fn frame<N: Parameter>(&self, site: &Site<'_, N>, reads_normal: bool) -> Frame<N> {
        if let Some(Fields { position, normal, direction }) = self.bent(site) {
            return Frame { position, normal, direction };
        }
        let n = site.blend3(|av| self.mesh.av_normal[av]);
        let d = site.blend3(|av| self.mesh.gv_direction[self.mesh.av_gv[av] as usize]);
        let length = dot(n, n).sqrt();
        let over = |least: f64| N::constant(1.0).div(N::max(length, N::constant(least)));
        let normal = if reads_normal { times(n, over(SHORTEST_UNIT)) } else { n };
        let position = site.blend3(|av| self.mesh.gv_position[self.mesh.av_gv[av] as usize]);
        Frame { position, normal, direction: times(d, over(SHORTEST_NORMAL)) }
    }

    fn layer<N: Parameter>(&self, layer: &Layer, site: &Site<'_, N>, frame: &Frame<N>) -> [N; 3] {
        let [x, y] = [0, 1].map(|axis| site.blend(|av| layer.texel_space(axis, self.uv[av])));
        let scaled = |value: N| value.sub(N::constant(layer.midlevel)).mul(N::constant(layer.scale));
        let channel = |field: &Field, c: u32| scaled(N::field(field, c, x, y));
        match &layer.source {
            Source::Height(field) => times(frame.direction, channel(field, 0)),
            Source::VectorObject(field) => [0, 1, 2].map(|c| channel(field, c)),
            Source::VectorTangent(field) => {
                let (tangent, bitangent) = self.tangents(site, frame.normal);
                let in_plane = add(times(tangent, channel(field, 0)), times(bitangent, channel(field, 1)));
                add(in_plane, times(frame.direction, channel(field, 2)))
            }
            Source::Expression(code) => {
                let (p, n) = (frame.position, frame.normal);
                times(frame.direction, scaled(evaluate(code, &[x, y, p[0], p[1], p[2], n[0], n[1], n[2]])))
            }
        }
    }

    /// Unit tangent and bitangent at right angles to the normal; any where the mesh's tangent has no part there.
    fn tangents<N: Parameter>(&self, site: &Site<'_, N>, normal: [N; 3]) -> ([N; 3], [N; 3]) {
        let of = |av: usize| self.mesh.av_tangent.get(av).copied().unwrap_or_default();
        let raw = site.blend3(|av| [of(av)[0], of(av)[1], of(av)[2]]);
        let part = dot(normal, raw);
        let flat: [N; 3] = std::array::from_fn(|k| raw[k].sub(normal[k].mul(part)));
        let square = dot(flat, flat);
        let tangent = match square.extremes() {
            [least, _] if least > SHORTEST_TANGENT_SQUARE => {
                let length = square.sqrt();
                flat.map(|x| x.div(length))
            }
            [_, most] if most <= SHORTEST_TANGENT_SQUARE => perpendicular(normal),
            _ => [N::between(-1.0, 1.0); 3],
        };
        // −1 where the blended handedness is negative, else 1.
        let handedness = N::step(N::constant(0.0), site.blend(|av| f64::from(of(av)[3])));
        let handedness = handedness.mul(N::constant(2.0)).sub(N::constant(1.0));
        (tangent, times(cross(normal, tangent), handedness))
    }
}

fn perpendicular<N: Parameter>(n: [N; 3]) -> [N; 3] {
    let axis = match n[0].abs().extremes() {
        [_, most] if most < 0.6 => [1.0, 0.0, 0.0],
        [least, _] if least >= 0.6 => [0.0, 1.0, 0.0],
        _ => return [N::between(-1.0, 1.0); 3],
    };
    let part = dot(n, axis.map(N::constant));
    let flat: [N; 3] = std::array::from_fn(|k| N::constant(axis[k]).sub(n[k].mul(part)));
    let length = dot(flat, flat).sqrt();
    flat.map(|x| x.div(length))
}

fn times<N: Parameter>(v: [N; 3], s: N) -> [N; 3] {
    v.map(|x| x.mul(s))
}

fn dot<N: Parameter>(a: [N; 3], b: [N; 3]) -> N {
    a[0].mul(b[0]).add(a[1].mul(b[1])).add(a[2].mul(b[2]))
}

fn cross<N: Parameter>(a: [N; 3], b: [N; 3]) -> [N; 3] {
    std::array::from_fn(|k| {
        let (i, j) = ((k + 1) % 3, (k + 2) % 3);
        a[i].mul(b[j]).sub(a[j].mul(b[i]))
    })
}
