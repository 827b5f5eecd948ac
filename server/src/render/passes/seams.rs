//! Where the sides of a geometric vertex or edge may displace differently, and how wide the ramps are
//! that spread the difference. All lists are made here; the passes only follow them.

use std::collections::HashMap;

use displace_glsl::{
    layout::geometry::{Correction, NONE, Seam, SeamSide, kind},
    tables::Tables,
};

use super::layers::Numbering;
use crate::domain::{
    detail::{Detail, LayerSource, Sampling, Wrap},
    mesh::Mesh,
    plan::SurfacePlan,
};

/// Narrowest and widest ramp, as a barycentric.
const RAMP: [f64; 2] = [1.0 / 16.0, 1.0];
/// Ramp of details without a map, which have no texels to measure it in.
const RAMP_WITHOUT_MAP: f64 = 0.25;

/// Fills `seam_*`, `triangle_correction`, `corrections`, `triangle_order` and `max_rank`.
pub fn fill(tables: &mut Tables, plan: &SurfacePlan, mesh: &Mesh, numbering: &Numbering) {
    let looks = Looks::new(tables, mesh, numbering);
    let feathered = plan.feather_texels > 0.0;
    let (vertices, corrected_av) = seam_vertices(mesh, &looks);
    let (edges, seam_of_edge) = seam_edges(mesh, &looks, feathered, &corrected_av);
    (tables.seam_vertices, tables.seam_corners) = vertices;
    (tables.seams, tables.seam_sides) = edges;
    if feathered {
        fill_corrections(tables, plan, mesh, &corrected_av, &seam_of_edge);
    } else {
        tables.triangle_correction = vec![NONE; mesh.triangles.len()];
    }
    fill_order(tables);
    let distinct = tables.seams.iter().filter(|seam| seam.distinct > 1);
    tables.max_rank = distinct.map(|seam| seam.count).max().unwrap_or(0);
}

/// What of an attribute vertex decides its displacement.
struct Looks<'a> {
    u: &'a [[f32; 4]],
    v: &'a [[f32; 4]],
    mesh: &'a Mesh,
    detail_of_av: Vec<u32>,
    traits_of_detail: Vec<Traits>,
}

/// What the layers of a detail read.
#[derive(Clone, Copy, Default)]
struct Traits {
    /// Whole steps of u and v change nothing.
    periodic: bool,
    normal: bool,
    tangent: bool,
}

/// Bits that are equal exactly where candidates are.
type Key = [u32; 12];

impl<'a> Looks<'a> {
    fn new(tables: &'a Tables, mesh: &'a Mesh, numbering: &Numbering) -> Self {
        let mut detail_of_av = vec![0; mesh.av_gv.len()];
        for (primitive, detail) in mesh.primitives.iter().zip(&numbering.of_primitive) {
            detail_of_av[primitive.avs.start as usize..primitive.avs.end as usize].fill(*detail);
        }
        let none = std::iter::once(Traits::default());
        let traits_of_detail = none.chain(numbering.details.iter().map(|detail| traits(detail))).collect();
        Self { u: &tables.av_position_u, v: &tables.av_direction_v, mesh, detail_of_av, traits_of_detail }
    }

    fn uv(&self, av: u32) -> [f32; 2] {
        [self.u[av as usize][3], self.v[av as usize][3]]
    }

    /// uv less the whole steps that `origin` has, where they change nothing.
    fn uv_bits(&self, av: u32, origin: u32) -> [u32; 2] {
        let periodic = self.traits_of_detail[self.detail_of_av[origin as usize] as usize].periodic;
        let (uv, from) = (self.uv(av), self.uv(origin));
        std::array::from_fn(|k| (uv[k] - if periodic { from[k].floor() } else { 0.0 } + 0.0).to_bits())
    }

    fn frame_bits(&self, av: u32, with_normal: bool) -> [u32; 7] {
        let traits = self.traits_of_detail[self.detail_of_av[av as usize] as usize];
        let normal = if with_normal || traits.normal { self.mesh.av_normal[av as usize] } else { [0.0; 3] };
        let tangent = if traits.tangent { self.mesh.av_tangent.get(av as usize).copied() } else { None };
        let t = tangent.unwrap_or_default();
        [normal[0], normal[1], normal[2], t[0], t[1], t[2], t[3]].map(|x| (x + 0.0).to_bits())
    }

    fn vertex_key(&self, av: u32) -> Key {
        self.key(av, av, false)
    }

    /// A blended direction depends on the normals of both ends.
    fn edge_key(&self, ae: u32) -> [Key; 2] {
        let [from, to] = self.mesh.ae_av[ae as usize];
        [self.key(from, from, true), self.key(to, from, true)]
    }

    fn key(&self, av: u32, origin: u32, with_normal: bool) -> Key {
        let detail = self.detail_of_av[av as usize];
        let mut key = [0; 12];
        if detail != 0 {
            key[0] = detail;
            key[1..3].copy_from_slice(&self.uv_bits(av, origin));
            key[3..10].copy_from_slice(&self.frame_bits(av, with_normal));
        }
        key
    }
}

fn traits(detail: &Detail) -> Traits {
    let mut traits = Traits { periodic: true, ..Traits::default() };
    for layer in &detail.layers {
        let whole_steps = layer.map_from_uv.iter().all(|row| row[0].fract() == 0.0 && row[1].fract() == 0.0);
        match &layer.source {
            LayerSource::Height(map) | LayerSource::VectorTangent(map) | LayerSource::VectorObject(map) => {
                let repeats = map.wrap == [Wrap::Repeat; 2] && map.sampling == Sampling::Center;
                traits.periodic &= repeats && whole_steps;
            }
            LayerSource::Expression(program) => {
                traits.periodic &= !program.reads_uv();
                traits.normal |= program.reads_normal();
            }
        }
        let in_tangent_frame = matches!(layer.source, LayerSource::VectorTangent(_));
        traits.normal |= in_tangent_frame;
        traits.tangent |= in_tangent_frame;
    }
    traits
}

type Lists = (Vec<Seam>, Vec<SeamSide>);

/// Appends the sides `ids`, ranked by first equal key.
fn push_seam<K: std::hash::Hash + Eq>(
    (seams, sides): &mut Lists,
    ids: &[u32],
    detail: impl Fn(u32) -> u32,
    key: impl Fn(u32) -> K,
) -> u32 {
    let first = sides.len() as u32;
    let mut ranks: HashMap<K, u32> = HashMap::new();
    for (rank, &id) in ids.iter().enumerate() {
        let same_as = *ranks.entry(key(id)).or_insert(rank as u32);
        sides.push(SeamSide { id, detail: detail(id), same_as });
    }
    let distinct = ranks.len() as u32;
    seams.push(Seam { first, count: ids.len() as u32, distinct });
    distinct
}

/// Lists geometric vertices with several avs. Returns which avs may need a correction.
fn seam_vertices(mesh: &Mesh, looks: &Looks<'_>) -> (Lists, Vec<bool>) {
    let mut corrected = vec![false; mesh.av_gv.len()];
    let mut lists = Lists::default();
    for gv in 0..mesh.gv_position.len() {
        let avs = mesh.gv_av.list(gv);
        let detail = |av: u32| looks.detail_of_av[av as usize];
        // Without detail all stay on the base, which is one place already.
        if avs.len() < 2 || avs.iter().all(|&av| detail(av) == 0) {
            continue;
        }
        if push_seam(&mut lists, avs, detail, |av| looks.vertex_key(av)) > 1 {
            avs.iter().for_each(|&av| corrected[av as usize] = true);
        }
    }
    (lists, corrected)
}

/// Lists geometric edges with several aes or, under feather, corrected ends. Returns the seam of each.
fn seam_edges(mesh: &Mesh, looks: &Looks<'_>, feathered: bool, corrected: &[bool]) -> (Lists, Vec<u32>) {
    let mut seam_of_edge = vec![NONE; mesh.ge_gv.len()];
    let mut lists = Lists::default();
    for (ge, seam) in seam_of_edge.iter_mut().enumerate() {
        let aes = mesh.ge_ae.list(ge);
        let ends = |ae: u32| mesh.ae_av[ae as usize];
        let detail = |ae: u32| looks.detail_of_av[ends(ae)[0] as usize];
        let plain = aes.iter().all(|&ae| detail(ae) == 0);
        let pulled = feathered && aes.iter().any(|&ae| ends(ae).iter().any(|&av| corrected[av as usize]));
        if pulled || aes.len() > 1 && !plain {
            *seam = lists.0.len() as u32;
            push_seam(&mut lists, aes, detail, |ae| looks.edge_key(ae));
        }
    }
    (lists, seam_of_edge)
}

fn fill_corrections(tables: &mut Tables, plan: &SurfacePlan, mesh: &Mesh, corrected: &[bool], seam_of_edge: &[u32]) {
    for (t, triangle) in mesh.triangles.iter().enumerate() {
        let seam = triangle.ae.map(|ae| {
            let seam = seam_of_edge[mesh.ae_ge[ae as usize] as usize];
            if seam != NONE && tables.seams[seam as usize].distinct > 1 { seam } else { NONE }
        });
        let pulled = triangle.av.iter().any(|&av| corrected[av as usize]) || seam.iter().any(|s| *s != NONE);
        if !pulled {
            tables.triangle_correction.push(NONE);
            continue;
        }
        let rank = std::array::from_fn(|k| own_rank(tables, seam[k], triangle.ae[k]));
        let inverse_width = ramps(tables, plan, t).map(|width| (1.0 / width) as f32);
        tables.triangle_correction.push(tables.corrections.len() as u32);
        tables.corrections.push(Correction { seam, rank, inverse_width });
    }
}

/// The rank whose candidates the ae has.
fn own_rank(tables: &Tables, seam: u32, ae: u32) -> u32 {
    let Some(seam) = tables.seams.get(seam as usize) else { return 0 };
    let sides = &tables.seam_sides[seam.first as usize..(seam.first + seam.count) as usize];
    sides.iter().find(|side| side.id == ae).map_or(0, |side| side.same_as)
}

/// Width of the ramp along each side of a base triangle, as the barycentric opposite it.
fn ramps(tables: &Tables, plan: &SurfacePlan, t: usize) -> [f64; 3] {
    let triangle = &tables.base_triangles[t];
    let layers = &tables.details[triangle.detail as usize];
    let layers = &tables.layers[layers.start as usize..layers.end as usize];
    let Some(map) = layers.iter().find(|layer| layer.kind != kind::EXPRESSION) else { return [RAMP_WITHOUT_MAP; 3] };
    let texel = triangle.av.map(|av| {
        let (u, v) = (tables.av_position_u[av as usize][3], tables.av_direction_v[av as usize][3]);
        displace_glsl::reference::map::texel_space(map, f64::from(u), f64::from(v))
    });
    let edge = |k: usize| [texel[(k + 1) % 3][0] - texel[k][0], texel[(k + 1) % 3][1] - texel[k][1]];
    let (a, b) = (edge(0), edge(1));
    let twice_area = (a[0] * b[1] - a[1] * b[0]).abs();
    std::array::from_fn(|k| {
        let height_texels = twice_area / edge(k)[0].hypot(edge(k)[1]);
        let width = f64::from(plan.feather_texels) / height_texels;
        // A triangle without area in the map has no texels: its ramp is as wide as it is.
        if width.is_nan() { RAMP[1] } else { width.clamp(RAMP[0], RAMP[1]) }
    })
}

/// Base triangles without corrections first, each half by detail.
fn fill_order(tables: &mut Tables) {
    let mut order: Vec<u32> = (0..tables.base_triangles.len() as u32).collect();
    let corrected = |t: u32| tables.triangle_correction[t as usize] != NONE;
    order.sort_by_key(|&t| (corrected(t), tables.base_triangles[t as usize].detail));
    tables.uncorrected_triangles = order.partition_point(|&t| !corrected(t)) as u32;
    tables.triangle_order = order;
}
