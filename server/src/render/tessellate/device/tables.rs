//! What the bound reads of a base mesh, from its tables: texel space in parts that f32 holds exactly, and the sides of
//! seams by base triangle.

use std::ops::Range;

use displace_glsl::{
    layout::{
        bound::{BoundTriangle, BoundVertex, RampPart, Ramps, TexelPlace},
        geometry::{BaseTriangle, Correction, Layer, NONE, kind},
    },
    reference::{place::Places, samples::share, site::vector},
    tables::Tables,
};
use glam::DVec3;

/// Tables of the `bound_*` passes; names are those of the shaders' bindings.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct BoundTables {
    pub vertices: Vec<BoundVertex>,
    pub triangles: Vec<BoundTriangle>,
    pub ramps: Vec<Ramps>,
    pub ramp_parts: Vec<RampPart>,
    /// `stride` for each vertex: under the layers of its detail.
    pub texel_places: Vec<TexelPlace>,
    pub stride: u32,
}

/// Lattice coordinates stay where f32 counts them.
const FARTHEST_TEXEL: f64 = 4_194_303.0;

/// Whether the passes know all layers, and tell their texels apart.
#[must_use]
pub fn supports(tables: &Tables) -> bool {
    let heights = tables.layers.iter().all(|layer| layer.kind == kind::HEIGHT);
    tables.patches.is_none() && heights && tables.base_triangles.iter().all(|triangle| is_near(tables, triangle))
}

fn is_near(tables: &Tables, triangle: &BaseTriangle) -> bool {
    let [first, end] = layers_of(tables, triangle.detail);
    tables.layers[first as usize..end as usize].iter().all(|layer| {
        let at = triangle.av.map(|av| texel_space(tables, layer, av));
        at.iter().flatten().all(|x| x.abs() < FARTHEST_TEXEL)
    })
}

/// Texel space of an attribute vertex, not cut off.
fn texel_space(tables: &Tables, layer: &Layer, av: u32) -> [f64; 2] {
    let uv = [tables.av_position_u[av as usize][3], tables.av_direction_v[av as usize][3]].map(f64::from);
    [layer.texel_from_u, layer.texel_from_v].map(|row| {
        let [a, b, c] = row.map(f64::from);
        a * uv[0] + b * uv[1] + c
    })
}

impl BoundTables {
    /// Of a mesh that the passes support.
    #[must_use]
    pub fn new(places: &Places<'_>) -> Self {
        let tables = places.tables;
        let stride = tables.details.iter().map(|range| range.end - range.start).max().unwrap_or(0);
        let mut made = Self { vertices: vertices(places), stride, ..Self::default() };
        made.texel_places = vec![TexelPlace::default(); tables.av_normal.len() * stride as usize];
        for triangle in &tables.base_triangles {
            made.place(tables, triangle);
        }
        for (t, triangle) in (0..).zip(&tables.base_triangles) {
            let ramps = made.ramps(places, t);
            let layers = layers_of(tables, triangle.detail);
            let BaseTriangle { av, reversed, .. } = *triangle;
            made.triangles.push(BoundTriangle { av, layers, reversed, ramps, least: least(tables, av) });
        }
        made
    }

    /// About how many texels and crossings the largest triangle has under any of its layers: half its box, and its sides.
    #[must_use]
    pub fn largest_cost(&self) -> f64 {
        let layers = |t: &BoundTriangle| 0..t.layers[1] - t.layers[0];
        let all = self.triangles.iter().flat_map(|t| layers(t).map(move |number| self.cost(t.av, number)));
        all.fold(0.0, f64::max)
    }

    fn cost(&self, av: [u32; 3], number: u32) -> f64 {
        let at = av.map(|av| {
            let TexelPlace { whole, rest } = self.texel_places[(av * self.stride + number) as usize];
            [0, 1].map(|k| f64::from(whole[k]) + f64::from(rest[k]))
        });
        let [width, height] = [0, 1].map(|k| {
            let of = at.map(|p| p[k]);
            of[0].max(of[1]).max(of[2]) - of[0].min(of[1]).min(of[2])
        });
        0.5 * width * height + 8.0 * (width + height)
    }

    fn place(&mut self, tables: &Tables, triangle: &BaseTriangle) {
        let [first, end] = layers_of(tables, triangle.detail);
        for (av, number) in triangle.av.iter().flat_map(|av| (0..end - first).map(move |k| (*av, k))) {
            let at = texel_space(tables, &tables.layers[(first + number) as usize], av);
            let [x, y] = at.map(f64::floor);
            let rest = [(at[0] - x) as f32, (at[1] - y) as f32];
            self.texel_places[(av * self.stride + number) as usize] = TexelPlace { whole: [x as i32, y as i32], rest };
        }
    }

    /// The number of the ramps of base triangle t, or `NONE`.
    fn ramps(&mut self, places: &Places<'_>, t: u32) -> u32 {
        let Some(correction) = places.tables.correction(t) else { return NONE };
        let mut ramps = Ramps { inverse_width: correction.inverse_width, ..Ramps::default() };
        for side in 0..3 {
            ramps.first[side] = self.ramp_parts.len() as u32;
            self.push_parts(places.tables, correction, side);
            ramps.count[side] = self.ramp_parts.len() as u32 - ramps.first[side];
        }
        self.ramps.push(ramps);
        self.ramps.len() as u32 - 1
    }

    /// The sides of the seam along a side that count in what the triangle's own is short of.
    fn push_parts(&mut self, tables: &Tables, correction: &Correction, side: usize) {
        if correction.seam[side] == NONE {
            return;
        }
        let seam = tables.seams[correction.seam[side] as usize];
        for rank in 0..seam.count {
            let entry = tables.seam_sides[(seam.first + rank) as usize];
            let own = f64::from(u8::from(rank == correction.rank[side]));
            let share = share(seam.distinct, tables.rule, rank) - own;
            if entry.same_as == rank && share != 0.0 {
                let av = tables.base_edges[entry.id as usize].av;
                let layers = layers_of(tables, entry.detail);
                self.ramp_parts.push(RampPart { av, layers, share: share as f32 });
            }
        }
    }
}

fn vertices(places: &Places<'_>) -> Vec<BoundVertex> {
    let tables = places.tables;
    let vertex = |av: usize| {
        let [x, y, z, _] = tables.av_direction_v[av];
        let correction = places.av_correction[av].as_vec3().to_array();
        BoundVertex { direction: [x, y, z], normal: tables.av_normal[av], correction }
    };
    (0..tables.av_normal.len()).map(vertex).collect()
}

fn layers_of(tables: &Tables, detail: u32) -> [u32; 2] {
    let range = &tables.details[detail as usize];
    [range.start, range.end]
}

/// Least length of what is interpolated between the directions: blended normals only make it longer.
fn least(tables: &Tables, av: [u32; 3]) -> f32 {
    let directions = av.map(|av| vector(&tables.av_direction_v[av as usize]));
    let middle = directions.iter().sum::<DVec3>() / 3.0;
    let spread = directions.iter().fold(0.0, |most: f64, d| most.max(d.distance(middle)));
    (0.999 * (middle.length() - spread)).max(0.0) as f32
}

/// At most so far from the base does any detail go, local units.
#[must_use]
pub fn largest_height(tables: &Tables) -> f64 {
    let of_detail = |range: &Range<u32>| {
        let layers = &tables.layers[range.start as usize..range.end as usize];
        layers.iter().map(|layer| largest_of(tables, layer)).sum::<f64>()
    };
    tables.details.iter().map(of_detail).fold(0.0, f64::max)
}

fn largest_of(tables: &Tables, layer: &Layer) -> f64 {
    // Maps follow each other in the arena.
    let firsts = tables.layers.iter().map(|other| other.first as usize);
    let end = firsts.filter(|first| *first > layer.first as usize).min().unwrap_or(tables.texels.len());
    let values = tables.texels[layer.first as usize..end].iter();
    let most = values.map(|value| (value - layer.midlevel).abs().max(value.abs())).fold(0.0, f32::max);
    f64::from(most) * f64::from(layer.scale.abs())
}
