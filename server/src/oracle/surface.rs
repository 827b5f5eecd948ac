//! The displaced surface itself, from its definition: any mesh, detail and seam rule, at any point, with
//! derivatives and with bounds over regions.
//!
//! Over a base triangle with barycentrics b, S(b) = P(b) + d(b) + Σ bᵢ δᵢ + Σ ramps, where
//! * P is the base; d the sum of the detail's layers: H D for heights, with D = Σ bᵢ Dᵢ / |Σ bᵢ nᵢ| of
//!   the welded directions Dᵢ and the corners' normals nᵢ over a flat base, and T x + B y + D z or (x, y, z) for
//!   vectors; a smooth base has positions, normals and directions of its own (`smooth.rs`);
//! * δᵢ is what corner i is short of the one displacement that its place gets by the seam rule;
//! * a ramp, along an edge whose sides differ, is what this side is short of the displacement all sides agree
//!   on there, times max(0, 1 − b_opposite / width).

mod layer;
mod seams;

use std::sync::Arc;

use displace_glsl::expression::{Dual, Number};
use glam::DVec3;

use super::{interval_jet::IntervalJet, parameter::Parameter, smooth::Bends};
use crate::domain::{
    detail::Detail,
    mesh::Mesh,
    request::{Geometry, SeamRule},
};
pub(super) use layer::Layer;
use layer::Site;
use seams::{Ramp, Seams};

/// The detailed surface over one base mesh, in the mesh's local space.
pub struct Surface<'m> {
    mesh: &'m Mesh,
    /// The layers of each primitive; none where it has no detail.
    layers: Vec<Arc<Vec<Layer>>>,
    /// The texture coordinates each attribute vertex is read at.
    uv: Vec<[f64; 2]>,
    seams: Seams,
    /// None where the base is flat.
    bends: Option<Bends<'m>>,
    /// What [`Surface::deviation`] leaves out at borders of texels, mesh-local units.
    slack: f64,
}

/// How the sides of seams become one, as [`Geometry`] has it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SeamChoice {
    pub rule: SeamRule,
    /// Width of the ramps in texels; 0 leaves the surface open at seams whose sides differ.
    pub feather_texels: f32,
}

impl From<&Geometry> for SeamChoice {
    fn from(geometry: &Geometry) -> Self {
        Self { rule: geometry.seams, feather_texels: geometry.feather_texels }
    }
}

impl<'m> Surface<'m> {
    /// `details[p]` is the detail of primitive p; what it reads of the mesh is there.
    #[must_use]
    pub fn new(mesh: &'m Mesh, details: &[Option<Arc<Detail>>], choice: SeamChoice) -> Self {
        let layers = layer::of_primitives(details);
        let uv = layer::texture_coordinates(mesh, details);
        let slack = layer::slack(mesh, &layers);
        let mut surface = Self { mesh, layers, uv, seams: Seams::default(), bends: Bends::of(mesh), slack };
        surface.seams = Seams::new(&surface, details, choice);
        surface
    }

    #[must_use]
    pub fn mesh(&self) -> &'m Mesh {
        self.mesh
    }

    /// The place of the surface at barycentrics b of base triangle t.
    #[must_use]
    pub fn position(&self, t: usize, b: DVec3) -> DVec3 {
        DVec3::from_array(self.evaluate::<f64>(t, &b))
    }

    /// The place, and the unit normal that shading sees: of the surface whose base is bent to its interpolated
    /// normals, by central differences of maps over one texel.
    #[must_use]
    pub fn position_and_normal(&self, t: usize, b: DVec3) -> (DVec3, DVec3) {
        let moved = self.evaluate::<Dual<2>>(t, &b);
        let base = self.base::<Dual<2>>(t, &b);
        let column = |s: &[Dual<2>; 3], k: usize| DVec3::from_array([0, 1, 2].map(|c| s[c].derivative[k]));
        let n = self.base_normal(t, b);
        let [p1, p2] = [column(&base, 0), column(&base, 1)];
        let along = |k: usize, p: DVec3| column(&moved, k) - n * n.dot(p);
        let side = p1.cross(p2).dot(n);
        let normal = along(0, p1).cross(along(1, p2)).normalize_or_zero();
        let normal = if side == 0.0 || normal == DVec3::ZERO { n } else { normal * side.signum() };
        (DVec3::from_array(moved.map(|c| c.value)), normal)
    }

    /// Unit, of the base.
    fn base_normal(&self, t: usize, b: DVec3) -> DVec3 {
        let bent = self.bends.as_ref().map(|bends| DVec3::from_array(bends.fields::<f64>(t, &b).normal));
        bent.and_then(DVec3::try_normalize).unwrap_or_else(|| self.blended_normal(t, b))
    }

    /// The base `t` along a geometric edge.
    fn edge_base(&self, ge: usize, t: f64) -> DVec3 {
        if let Some(bends) = &self.bends {
            return DVec3::from_array(bends.on_edge::<f64>(self.mesh.ge_ae.list(ge)[0], t).position);
        }
        let [from, to] = self.mesh.ge_gv[ge].map(|gv| wide(self.mesh.gv_position[gv as usize]));
        from + (to - from) * t
    }

    /// Unit, of the mesh as it is.
    #[must_use]
    pub fn blended_normal(&self, t: usize, b: DVec3) -> DVec3 {
        let [a, c, d] = self.mesh.triangles[t].av.map(|av| wide(self.mesh.av_normal[av as usize]));
        (a * b.x + c * b.y + d * b.z).try_normalize().unwrap_or(a)
    }

    /// How far the surface is at most from any triangle with corners on it, all within the convex region that
    /// `corners` (barycentrics of base triangle t) span. ∞ where it jumps without bound.
    ///
    /// With slopes in [g − r, g + r], f − L = Σ λᵢ (∇f(ξᵢ) − g)·(b − bᵢ), and Σ λᵢ |b − bᵢ| is at most half
    /// the region's width along each axis.
    #[must_use]
    pub fn deviation(&self, t: usize, corners: &[DVec3]) -> f64 {
        let bounds = self.evaluate::<IntervalJet>(t, corners);
        let width = |axis: usize| {
            let (lo, hi) = corners.iter().map(|b| b[axis]).fold((1.0, 0.0), |(lo, hi), x: f64| (lo.min(x), hi.max(x)));
            (hi - lo).max(0.0)
        };
        let (w1, w2) = (width(1), width(2));
        let radius = |i: displace_glsl::expression::Interval| 0.5 * (i.hi - i.lo);
        let component = |f: &IntervalJet| {
            let by_slopes = 0.5 * (radius(f.slope[0]) * w1 + radius(f.slope[1]) * w2);
            let by_values = f.value.hi - f.value.lo;
            if by_slopes < by_values { by_slopes } else { by_values }
        };
        let bound = DVec3::from_array([0, 1, 2].map(|k| component(&bounds[k]))).length();
        let bound = bound + self.slack;
        if bound.is_nan() { f64::INFINITY } else { bound }
    }

    /// By how much rounding may have moved [`Self::position`] there.
    #[must_use]
    pub fn rounding(&self, t: usize, b: DVec3) -> f64 {
        let bounds = self.evaluate::<IntervalJet>(t, &[b][..]);
        DVec3::from_array(bounds.map(|f| f.value.hi - f.value.lo)).length()
    }

    /// The texel-space coordinates, over the base triangle's corners, whose whole numbers are kinks of the
    /// surface inside it.
    #[must_use]
    pub fn grids(&self, t: usize) -> Vec<[f64; 3]> {
        let triangle = &self.mesh.triangles[t];
        let maps = self.layers[triangle.primitive as usize].iter().filter(|layer| layer.field().is_some());
        let mut grids: Vec<[f64; 3]> = Vec::new();
        for layer in maps {
            for axis in 0..2 {
                let grid = triangle.av.map(|av| layer.texel_space(axis, self.uv[av as usize]));
                if !grids.contains(&grid) {
                    grids.push(grid);
                }
            }
        }
        grids
    }

    /// Lines b·n = 0 along which the surface has kinks from its seams: the ends of ramps, and where a ramp
    /// meets the texels of another side. At most `most` of the latter for each side.
    #[must_use]
    pub fn seam_lines(&self, t: usize, most: usize) -> Vec<DVec3> {
        self.seams.lines(self, t, most)
    }

    /// Whether the sides of this edge displace differently.
    #[must_use]
    pub fn is_seam(&self, ge: usize) -> bool {
        self.seams.is_seam(ge)
    }

    /// The place on a seam, `t` along the edge, that all its sides agree on.
    #[must_use]
    pub fn seam_position(&self, ge: usize, t: f64) -> DVec3 {
        self.seams.position(self, ge, t)
    }

    /// The place of a geometric vertex that all its sides agree on; `single` where it has but one look.
    #[must_use]
    pub fn corner_position(&self, gv: usize, single: DVec3) -> DVec3 {
        self.seams.agreed_at(gv).map_or(single, |d| wide(self.mesh.gv_position[gv]) + d)
    }

    fn base<N: Parameter>(&self, t: usize, place: &N::Place) -> [N; 3] {
        if let Some(bends) = &self.bends {
            return bends.position::<N>(t, place);
        }
        let corners = self.mesh.triangles[t].av.map(|av| self.base_position(av));
        std::array::from_fn(|k| N::affine(place, corners.map(|c| c[k])))
    }

    fn base_position(&self, av: u32) -> DVec3 {
        wide(self.mesh.gv_position[self.mesh.av_gv[av as usize] as usize])
    }

    fn evaluate<N: Parameter>(&self, t: usize, place: &N::Place) -> [N; 3] {
        let triangle = &self.mesh.triangles[t];
        let site = Site::Triangle { t, av: triangle.av, place };
        let own = self.displacement::<N>(triangle.primitive as usize, &site);
        let mut sum = add(self.base::<N>(t, place), own);
        if self.seams.is_pulled(triangle.av) {
            let corners = triangle.av.map(|av| self.seams.correction(av));
            sum = add(sum, std::array::from_fn(|k| N::affine(place, corners.map(|c| c[k]))));
        }
        for ramp in self.seams.ramps(t) {
            sum = add(sum, self.ramp::<N>(ramp, place));
        }
        sum
    }

    fn ramp<N: Parameter>(&self, ramp: &Ramp, place: &N::Place) -> [N; 3] {
        let mut opposite = [0.0; 3];
        opposite[ramp.opposite] = ramp.inverse_width;
        let weight = N::max(N::constant(0.0), N::constant(1.0).sub(N::affine(place, opposite)));
        if weight.extremes()[1] <= 0.0 {
            return [N::constant(0.0); 3];
        }
        let along = N::along(place, ramp.to, ramp.from);
        let own = self.edge_candidate(ramp.ae, along);
        let agreed = self.agreed(ramp.ge, along);
        std::array::from_fn(|k| weight.mul(agreed[k].sub(own[k])))
    }

    /// What the sides of a seam agree on, `along` it.
    fn agreed<N: Parameter>(&self, ge: usize, along: N) -> [N; 3] {
        let mut sum = [N::constant(0.0); 3];
        for (ae, share) in self.seams.sides(ge) {
            let candidate = self.edge_candidate(*ae, along);
            sum = add(sum, candidate.map(|c| c.mul(N::constant(*share))));
        }
        sum
    }

    /// The displacement one side has there by itself, its corners corrected.
    fn edge_candidate<N: Parameter>(&self, ae: u32, along: N) -> [N; 3] {
        let av = self.mesh.ae_av[ae as usize];
        let site: Site<'_, N> = Site::Edge { ae, av, along };
        let own = self.displacement(self.primitive_of_ae(ae), &site);
        let ends = av.map(|av| self.seams.correction(av));
        let lerp = |k: usize| N::constant(ends[0][k]).add(N::constant(ends[1][k] - ends[0][k]).mul(along));
        add(own, std::array::from_fn(lerp))
    }

    fn primitive_of_ae(&self, ae: u32) -> usize {
        self.mesh.primitives.partition_point(|p| p.aes.end <= ae)
    }

    fn primitive_of_av(&self, av: u32) -> usize {
        self.mesh.primitives.partition_point(|p| p.avs.end <= av)
    }
}

fn add<N: Number>(a: [N; 3], b: [N; 3]) -> [N; 3] {
    std::array::from_fn(|k| a[k].add(b[k]))
}

fn wide(v: [f32; 3]) -> DVec3 {
    DVec3::from_array(v.map(f64::from))
}
