//! The bound of a detail's layers over a triangle of places between three attribute vertices.

use glam::DVec3;

use super::{
    Asked, expression,
    field::{Field, Scalar},
    lattice::Lattice,
    search, smooth,
    texels::MapPlace,
};
use crate::{
    layout::geometry::kind,
    reference::{
        frame::{MIN_BLENDED_NORMAL, MIN_TANGENT_SQUARE, any_perpendicular},
        place::Places,
        site::vector,
    },
    tables::Tables,
};

/// Texel space is cut off beyond this.
pub(super) const FARTHEST_TEXEL: f64 = 4_194_303.0;

/// Where the layers of `detail` are bounded: barycentrics among `av`. A side counted as a triangle has two equal corners.
#[derive(Clone, Copy)]
pub(super) struct Patch<'p> {
    pub(super) places: &'p Places<'p>,
    pub(super) asked: Asked,
    pub(super) av: [u32; 3],
    /// Where they are on a smooth base; see [`crate::patches`].
    pub(super) patch: u32,
    pub(super) detail: u32,
    pub(super) corners: [DVec3; 3],
    /// The corners in the one map that there is, where that is known.
    pub(super) in_map: [MapPlace; 3],
    /// Expressions are bounded no closer than this.
    pub(super) resolution: f64,
}

/// A frame of reference over the patch.
struct Frame {
    direction: Field,
    normal: Field,
}

impl Patch<'_> {
    /// As [`super::bound`], without seams.
    pub(super) fn bound(&self, cap: f64) -> f64 {
        let numbers = self.places.tables.details[self.detail as usize].clone();
        if numbers.is_empty() {
            return 0.0;
        }
        let frame = self.frame();
        let mut sum = 0.0;
        for number in numbers {
            sum += self.layer(number as usize, &frame, cap - sum);
            if sum > cap {
                break;
            }
        }
        sum
    }

    pub(super) fn blend(&self, values: [DVec3; 3]) -> Field {
        Field::linear(self.corners.map(|b| values[0] * b.x + values[1] * b.y + values[2] * b.z))
    }

    pub(super) fn uv(&self) -> [[f64; 2]; 3] {
        uv(self.places.tables, self.av, self.corners)
    }

    fn frame(&self) -> Frame {
        if let Some([normal, direction]) = smooth::frame(self) {
            return Frame { direction, normal };
        }
        let tables = self.places.tables;
        let normal = self.blend(self.av.map(|av| vector(&tables.av_normal[av as usize])));
        let direction = self.blend(self.av.map(|av| vector(&tables.av_direction_v[av as usize])));
        let flat = self.av.iter().all(|av| tables.av_normal[*av as usize] == tables.av_normal[self.av[0] as usize]);
        // The normals of a flat triangle are unit, and so are their blends.
        Frame { direction: if flat { direction } else { direction.over(normal, MIN_BLENDED_NORMAL) }, normal }
    }

    /// Of layer `number` among all.
    fn layer(&self, number: usize, frame: &Frame, cap: f64) -> f64 {
        let layer = &self.places.tables.layers[number];
        match layer.kind {
            kind::HEIGHT => along(frame.direction, |cap| self.channel(number, 0, cap), cap),
            kind::EXPRESSION => {
                let resolution = self.resolution / frame.direction.most().max(f64::MIN_POSITIVE);
                along(frame.direction, |cap| expression::height(self, layer, cap, resolution), cap)
            }
            kind::VECTOR_OBJECT => {
                let one = |k: u64| self.channel(number, k, cap).curvature;
                DVec3::new(one(0), one(1), one(2)).length()
            }
            _ => self.in_tangent_frame(number, frame, cap),
        }
    }

    fn in_tangent_frame(&self, number: usize, frame: &Frame, cap: f64) -> f64 {
        let normal = frame.normal.unit();
        let (tangent, bitangent) = self.tangents(normal);
        let axes = [tangent, bitangent, frame.direction];
        (0..3).map(|k| along(axes[k as usize], |cap| self.channel(number, k, cap), cap)).sum()
    }

    fn tangents(&self, normal: Field) -> (Field, Field) {
        let tables = self.places.tables;
        let raw = self.av.map(|av| tables.av_tangent[av as usize]);
        let blended = self.blend(raw.map(|t| vector(&t)));
        let along = normal.times(normal.dot(blended));
        let back = Field { corners: along.corners.map(|c| -c), ..along };
        let across = blended.add(back);
        let least = across.corners.iter().fold(f64::INFINITY, |low, c| low.min(c.length_squared()));
        let tangent = if least > MIN_TANGENT_SQUARE {
            across.unit()
        } else {
            Field { corners: normal.corners.map(any_perpendicular), curvature: 2.0 }
        };
        let handed = self.corners.map(|b| b.dot(DVec3::from_array(raw.map(|t| f64::from(t[3])))));
        let mut bitangent = normal.cross(tangent);
        for (axis, handed) in bitangent.corners.iter_mut().zip(handed) {
            *axis *= if handed < 0.0 { -1.0 } else { 1.0 };
        }
        // Handedness changes at once.
        let mixed = handed.iter().any(|h| *h < 0.0) && handed.iter().any(|h| *h >= 0.0);
        (tangent, Field { curvature: if mixed { 2.0 } else { bitangent.curvature }, ..bitangent })
    }

    /// One channel of the map of layer `number`, scaled; `cap` is what its own bound may reach.
    fn channel(&self, number: usize, channel: u64, cap: f64) -> Scalar {
        let tables = self.places.tables;
        let layer = &tables.layers[number];
        let scale = f64::from(layer.scale);
        let is_known = self.in_map.iter().all(MapPlace::is_known);
        let found = || self.uv().map(|uv| MapPlace::of(tables, layer, channel, uv));
        let corners = if is_known { self.in_map } else { found() };
        let values = corners.map(|c| scale * (c.value - f64::from(layer.midlevel)));
        let cut = |x: [f64; 3]| x.iter().any(|x| x.abs() >= FARTHEST_TEXEL) && x.iter().any(|other| *other != x[0]);
        if cut(corners.map(|c| c.x)) || cut(corners.map(|c| c.y)) {
            return Scalar { corners: values, curvature: f64::INFINITY };
        }
        let cap = if scale == 0.0 { f64::INFINITY } else { cap / scale.abs() };
        let lattice = Lattice::new(tables, layer, channel);
        let pyramid = &self.places.pyramids[number][channel as usize];
        let found = search::greatest(&lattice, pyramid, corners, self.asked.at_texels, cap);
        Scalar { corners: values, curvature: found * scale.abs() }
    }
}

/// Texture coordinates of places among three attribute vertices.
fn uv<const N: usize>(tables: &Tables, av: [u32; 3], places: [DVec3; N]) -> [[f64; 2]; N] {
    let uv = av.map(|av| (tables.av_position_u[av as usize][3], tables.av_direction_v[av as usize][3]));
    let u = DVec3::from_array(uv.map(|uv| f64::from(uv.0)));
    let v = DVec3::from_array(uv.map(|uv| f64::from(uv.1)));
    places.map(|b| [b.dot(u), b.dot(v)])
}

/// Where barycentrics of base triangle t lie in its map of heights, if that is its only layer.
pub(in crate::reference) fn in_map(places: &Places<'_>, t: u32, b: DVec3) -> MapPlace {
    let triangle = &places.tables.base_triangles[t as usize];
    match places.layers(triangle.detail) {
        [layer] if layer.kind == kind::HEIGHT => {
            let [uv] = uv(places.tables, triangle.av, [b]);
            MapPlace::of(places.tables, layer, 0, uv)
        }
        _ => MapPlace::NONE,
    }
}

/// A height along a direction that bends.
fn along(direction: Field, height: impl Fn(f64) -> Scalar, cap: f64) -> f64 {
    let most = direction.most();
    if most == 0.0 {
        return 0.0;
    }
    direction.times(height(cap / most)).curvature
}
