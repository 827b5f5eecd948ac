//! Where the sides of a place displace differently, what they agree on, and the ramps that spread the
//! difference.

use std::{collections::HashMap, sync::Arc};

use glam::{DVec2, DVec3};

use super::{Layer, SeamChoice, Site, Surface};
use crate::domain::{
    detail::{Detail, LayerSource, Sampling, Wrap},
    request::SeamRule,
};

/// Narrowest and widest ramp, and that of details without a map; as shares of a triangle's height.
const NARROWEST: f64 = 1.0 / 16.0;
const WIDEST: f64 = 1.0;
const WITHOUT_MAP: f64 = 0.25;

/// All seams of a surface.
#[derive(Default)]
pub(super) struct Seams {
    /// The displacement of places whose sides differ.
    agreed: HashMap<usize, DVec3>,
    /// What each attribute vertex is short of it; empty where none is.
    corrections: Vec<DVec3>,
    /// Sides that count and their shares, of edges whose sides differ; by edge.
    sides: Vec<Vec<(u32, f64)>>,
    /// By base triangle; empty where there are none.
    ramps: Vec<Vec<Ramp>>,
}

/// The ramp along one side of a base triangle.
pub(super) struct Ramp {
    pub(super) ge: usize,
    /// This side.
    pub(super) ae: u32,
    /// Corners of the triangle where the edge starts and ends, and the one opposite it.
    pub(super) from: usize,
    pub(super) to: usize,
    pub(super) opposite: usize,
    pub(super) inverse_width: f64,
}

/// Equal exactly where two sides displace alike.
type Look = [u32; 12];

impl Seams {
    pub(super) fn new(surface: &Surface<'_>, details: &[Option<Arc<Detail>>], choice: SeamChoice) -> Self {
        let looks = Looks { surface, reads: details.iter().map(Reads::of_primitive).collect(), details };
        let feathered = choice.feather_texels > 0.0;
        let sides = edge_sides(surface, &looks, choice.rule);
        let (agreed, corrections) = corners(surface, &looks, choice.rule);
        let mut seams = Self { sides, agreed, ..Self::default() };
        if feathered {
            seams.corrections = corrections;
            seams.ramps = seams.all_ramps(surface, f64::from(choice.feather_texels));
        }
        seams
    }

    pub(super) fn correction(&self, av: u32) -> DVec3 {
        self.corrections.get(av as usize).copied().unwrap_or_default()
    }

    pub(super) fn agreed_at(&self, gv: usize) -> Option<DVec3> {
        self.agreed.get(&gv).copied()
    }

    pub(super) fn is_pulled(&self, av: [u32; 3]) -> bool {
        !self.corrections.is_empty() && av.iter().any(|&av| self.corrections[av as usize] != DVec3::ZERO)
    }

    pub(super) fn ramps(&self, t: usize) -> &[Ramp] {
        self.ramps.get(t).map_or(&[], Vec::as_slice)
    }

    pub(super) fn sides(&self, ge: usize) -> &[(u32, f64)] {
        self.sides.get(ge).map_or(&[], Vec::as_slice)
    }

    pub(super) fn is_seam(&self, ge: usize) -> bool {
        !self.sides(ge).is_empty()
    }

    pub(super) fn position(&self, surface: &Surface<'_>, ge: usize, t: f64) -> DVec3 {
        surface.edge_base(ge, t) + DVec3::from_array(surface.agreed::<f64>(ge, t))
    }

    fn all_ramps(&self, surface: &Surface<'_>, feather_texels: f64) -> Vec<Vec<Ramp>> {
        if self.sides.iter().all(Vec::is_empty) {
            return Vec::new();
        }
        let mut ramps: Vec<Vec<Ramp>> = Vec::new();
        ramps.resize_with(surface.mesh.triangles.len(), Vec::new);
        for (t, triangle) in surface.mesh.triangles.iter().enumerate() {
            for k in 0..3 {
                let ae = triangle.ae[k];
                let ge = surface.mesh.ae_ge[ae as usize] as usize;
                if !self.is_seam(ge) {
                    continue;
                }
                let forward = surface.mesh.ae_av[ae as usize][0] == triangle.av[k];
                let (first, second) = (k, (k + 1) % 3);
                let (from, to) = if forward { (first, second) } else { (second, first) };
                let inverse_width = 1.0 / width(surface, t, k, feather_texels);
                let ramp = Ramp { ge, ae, from, to, opposite: (k + 2) % 3, inverse_width };
                ramps[t].push(ramp);
            }
        }
        ramps
    }

    pub(super) fn lines(&self, surface: &Surface<'_>, t: usize, most: usize) -> Vec<DVec3> {
        let mut lines = Vec::new();
        for ramp in self.ramps(t) {
            let end = 1.0 / ramp.inverse_width;
            if end < 1.0 {
                // b_opposite = end (b0 + b1 + b2).
                let mut line = DVec3::splat(-end);
                line[ramp.opposite] += 1.0;
                lines.push(line);
            }
            for s in self.kinks_along(surface, ramp, most) {
                // b_to (1 − s) = b_from s.
                let mut line = DVec3::ZERO;
                line[ramp.to] = 1.0 - s;
                line[ramp.from] = -s;
                lines.push(line);
            }
        }
        lines
    }

    /// Where along a seam its sides' maps have texel borders.
    fn kinks_along(&self, surface: &Surface<'_>, ramp: &Ramp, most: usize) -> Vec<f64> {
        let mut kinks = Vec::new();
        for (ae, _) in self.sides(ramp.ge).iter().filter(|(ae, _)| *ae != ramp.ae) {
            let uv = surface.mesh.ae_av[*ae as usize].map(|av| surface.uv[av as usize]);
            let layers = &surface.layers[surface.primitive_of_ae(*ae)];
            for layer in layers.iter().filter(|layer| layer.field().is_some()) {
                for axis in 0..2 {
                    let [a, b] = uv.map(|uv| layer.texel_space(axis, uv));
                    let (first, last) = (a.min(b).ceil(), a.max(b).floor());
                    if b != a && last - first < most as f64 {
                        kinks.extend((0..=(last - first) as i64).map(|i| (first + i as f64 - a) / (b - a)));
                    }
                }
            }
        }
        kinks.retain(|s| *s > 1e-9 && *s < 1.0 - 1e-9);
        kinks
    }
}

/// Width of the ramp along side k of base triangle t, as the barycentric opposite it.
fn width(surface: &Surface<'_>, t: usize, k: usize, feather_texels: f64) -> f64 {
    let triangle = &surface.mesh.triangles[t];
    let layers: &[Layer] = &surface.layers[triangle.primitive as usize];
    let Some(map) = layers.iter().find(|layer| layer.field().is_some()) else { return WITHOUT_MAP };
    let texel = triangle.av.map(|av| {
        let uv = surface.uv[av as usize];
        DVec2::new(map.texel_space(0, uv), map.texel_space(1, uv))
    });
    let twice_area = (texel[1] - texel[0]).perp_dot(texel[2] - texel[0]).abs();
    let height_texels = twice_area / texel[k].distance(texel[(k + 1) % 3]);
    let width = feather_texels / height_texels;
    // A triangle without area in the map has no texels: its ramp is as wide as it is.
    if width.is_nan() { WIDEST } else { width.clamp(NARROWEST, WIDEST) }
}

fn edge_sides(surface: &Surface<'_>, looks: &Looks<'_, '_>, rule: SeamRule) -> Vec<Vec<(u32, f64)>> {
    let mesh = surface.mesh;
    let of_edge = |ge: usize| {
        let aes = mesh.ge_ae.list(ge);
        if aes.len() < 2 {
            return Vec::new();
        }
        let look = |ae: u32| {
            let av = mesh.ae_av[ae as usize];
            av.map(|end| looks.of(end, av[0], true))
        };
        let sides = shares(aes, rule, look);
        if sides.distinct > 1 { sides.shares } else { Vec::new() }
    };
    (0..mesh.ge_gv.len()).map(of_edge).collect()
}

/// What the sides of each place agree on, and what each of them is short of it.
fn corners(surface: &Surface<'_>, looks: &Looks<'_, '_>, rule: SeamRule) -> (HashMap<usize, DVec3>, Vec<DVec3>) {
    let mesh = surface.mesh;
    let (mut all_agreed, mut corrections) = (HashMap::new(), Vec::new());
    for gv in 0..mesh.gv_position.len() {
        let avs = mesh.gv_av.list(gv);
        let sides = shares(avs, rule, |av| looks.of(av, av, false));
        if sides.distinct < 2 {
            continue;
        }
        let candidate = |av: u32| {
            let site: Site<'_, f64> = Site::Corner { av };
            DVec3::from_array(surface.displacement(surface.primitive_of_av(av), &site))
        };
        let agreed: DVec3 = sides.shares.iter().map(|(av, share)| candidate(*av) * *share).sum();
        all_agreed.insert(gv, agreed);
        corrections.resize(mesh.av_gv.len(), DVec3::ZERO);
        avs.iter().for_each(|&av| corrections[av as usize] = agreed - candidate(av));
    }
    (all_agreed, corrections)
}

struct Shares {
    /// The sides that count.
    shares: Vec<(u32, f64)>,
    distinct: usize,
}

/// Sides that look alike count once, as the first of them.
fn shares<K: std::hash::Hash + Eq>(ids: &[u32], rule: SeamRule, look: impl Fn(u32) -> K) -> Shares {
    let mut seen = std::collections::HashSet::new();
    let firsts: Vec<u32> = ids.iter().copied().filter(|&id| seen.insert(look(id))).collect();
    let distinct = firsts.len();
    let shares = match rule {
        SeamRule::Mean => firsts.into_iter().map(|id| (id, 1.0 / distinct as f64)).collect(),
        SeamRule::Dominant => firsts.into_iter().take(1).map(|id| (id, 1.0)).collect(),
    };
    Shares { shares, distinct }
}

/// What of an attribute vertex a detail reads.
#[derive(Clone, Copy, Default)]
struct Reads {
    /// Whole steps of u and v change nothing.
    periodic: bool,
    normal: bool,
    tangent: bool,
}

impl Reads {
    fn of_primitive(detail: &Option<Arc<Detail>>) -> Option<Self> {
        detail.as_deref().filter(|detail| !detail.layers.is_empty()).map(Self::of)
    }

    fn of(detail: &Detail) -> Self {
        let mut reads = Self { periodic: true, ..Self::default() };
        for layer in &detail.layers {
            let whole = layer.map_from_uv.iter().all(|row| row[0].fract() == 0.0 && row[1].fract() == 0.0);
            match &layer.source {
                LayerSource::Expression(program) => {
                    reads.periodic &= !program.reads_uv();
                    reads.normal |= program.reads_normal();
                }
                LayerSource::Height(map) | LayerSource::VectorTangent(map) | LayerSource::VectorObject(map) => {
                    reads.periodic &= whole && map.sampling == Sampling::Center && map.wrap == [Wrap::Repeat; 2];
                }
            }
            let tangent = matches!(layer.source, LayerSource::VectorTangent(_));
            reads.normal |= tangent;
            reads.tangent |= tangent;
        }
        reads
    }
}

struct Looks<'s, 'm> {
    surface: &'s Surface<'m>,
    details: &'s [Option<Arc<Detail>>],
    reads: Vec<Option<Reads>>,
}

impl Looks<'_, '_> {
    /// The look of an attribute vertex; `origin` gives the whole steps of u and v that do not count.
    fn of(&self, av: u32, origin: u32, with_normal: bool) -> Look {
        let primitive = self.surface.primitive_of_av(av);
        let (Some(reads), Some(detail)) = (self.reads[primitive], &self.details[primitive]) else { return [0; 12] };
        let mesh = self.surface.mesh;
        let first_with = |d: &Option<Arc<Detail>>| d.as_ref().is_some_and(|d| Arc::ptr_eq(d, detail));
        let number = self.details.iter().position(first_with).unwrap_or(primitive) as u32 + 1;
        let (uv, from) = (self.surface.uv[av as usize], self.surface.uv[origin as usize]);
        let step = |k: usize| if reads.periodic { from[k].floor() } else { 0.0 };
        let normal = if with_normal || reads.normal { mesh.av_normal[av as usize] } else { [0.0; 3] };
        let tangent = mesh.av_tangent.get(av as usize).filter(|_| reads.tangent).copied().unwrap_or_default();
        let bits = |x: f32| (x + 0.0).to_bits();
        let uv_bits = |k: usize| bits((uv[k] - step(k)) as f32);
        let [n, t] = [normal.map(bits), [tangent[0], tangent[1], tangent[2]].map(bits)];
        [number, uv_bits(0), uv_bits(1), n[0], n[1], n[2], t[0], t[1], t[2], bits(tangent[3]), 0, 0]
    }
}
