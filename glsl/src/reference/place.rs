//! The displaced surface at places of refined meshes: what `samples`, `jets_*` and `reconcile_*` make of a vertex,
//! values only.

use glam::DVec3;

use super::{
    bound::{self, Lattice, MapPlace, Pyramid},
    displace, displace_expression, displace_vector, reconcile_corners, reconcile_edges,
    refine::{self, barycentrics},
    samples::share,
    site::Site,
    subdivide,
};
use crate::{
    layout::{
        geometry::{Layer, NONE, Seam, SeamSide, kind},
        refine::{RefinedVertex, UNIT, kind as vertex_kind},
    },
    tables::Tables,
};

/// The tables of one base mesh, and what its corners are corrected by.
#[derive(Debug)]
pub struct Places<'t> {
    pub tables: &'t Tables,
    pub base: &'t refine::Base,
    /// What each av is short of its place's displacement; counts under feather alone.
    pub av_correction: Vec<DVec3>,
    /// Of each channel of each layer's map, for [`super::bound`].
    pub pyramids: Vec<Vec<Pyramid>>,
    /// Of base triangles over which nothing bends but a map: the length of their upright direction; not a number of others.
    pub(super) straight: Vec<f64>,
    /// Seam of each ge, or [`NONE`].
    pub seam_of_edge: Vec<u32>,
    /// Displaced corners, by gv.
    corners: Vec<DVec3>,
    /// Largest disagreement of a corner's sides.
    pub mismatch: f64,
}

impl<'t> Places<'t> {
    #[must_use]
    pub fn new(tables: &'t Tables, base: &'t refine::Base) -> Self {
        let seam_of_edge = seams_of_edges(tables, base);
        let mut places = Self {
            tables,
            base,
            av_correction: vec![DVec3::ZERO; tables.av_normal.len()],
            pyramids: tables.layers.iter().map(|layer| pyramids(tables, layer)).collect(),
            straight: Vec::new(),
            seam_of_edge,
            corners: vec![DVec3::ZERO; base.positions.len()],
            mismatch: 0.0,
        };
        places.place_corners();
        places.straight = (0..base.triangles.len()).map(|t| bound::direction(&places, t)).collect();
        places
    }

    fn place_corners(&mut self) {
        let tables = self.tables;
        for (triangle, base) in tables.base_triangles.iter().zip(&self.base.triangles) {
            for (av, gv) in triangle.av.into_iter().zip(base.gv) {
                let site = Site::at_vertex(av);
                self.corners[gv as usize] = site.position(tables) + self.own(&site, triangle.detail, true);
            }
        }
        let gv_of = gvs(tables, self.base);
        for seam in &tables.seam_vertices {
            let candidate = |k: u32| self.corner_candidate(tables.seam_corners[k as usize]);
            let reconciled = reconcile_corners::reconcile(tables, seam, candidate);
            let corrections: Vec<(u32, DVec3)> = (0..seam.count)
                .map(|rank| {
                    let av = tables.seam_corners[(seam.first + rank) as usize].id;
                    (av, reconcile_corners::correction(tables, seam, rank, reconciled.displacement, candidate))
                })
                .collect();
            self.mismatch = self.mismatch.max(reconciled.mismatch);
            for (av, correction) in corrections {
                self.av_correction[av as usize] = correction;
                let site = Site::at_vertex(av);
                self.corners[gv_of[av as usize] as usize] = site.position(tables) + reconciled.displacement;
            }
        }
    }

    fn corner_candidate(&self, side: SeamSide) -> DVec3 {
        self.own(&Site::at_vertex(side.id), side.detail, true)
    }

    /// A detail's layers at a site.
    #[must_use]
    pub fn own(&self, site: &Site, detail: u32, corner: bool) -> DVec3 {
        let base = subdivide::at(self.tables, site, corner);
        let one = |layer: &Layer| match layer.kind {
            kind::HEIGHT => displace::displacement(self.tables, layer, &base),
            kind::EXPRESSION => displace_expression::displacement(self.tables, layer, &base),
            _ => displace_vector::displacement(self.tables, layer, &base),
        };
        self.layers(detail).iter().map(one).sum()
    }

    #[must_use]
    pub fn layers(&self, detail: u32) -> &'t [Layer] {
        let range = self.tables.details[detail as usize].clone();
        &self.tables.layers[range.start as usize..range.end as usize]
    }

    /// Where barycentrics of base triangle t lie in its map; known of base triangles with one layer alone, of heights.
    #[must_use]
    pub fn in_map(&self, t: u32, b: DVec3) -> MapPlace {
        bound::in_map(self, t, b)
    }

    /// As [`Self::in_map`]; known of vertices within base triangles.
    #[must_use]
    pub fn vertex_in_map(&self, vertex: &RefinedVertex) -> MapPlace {
        let [b, c] = vertex.param;
        match vertex.kind {
            vertex_kind::INTERIOR => self.in_map(vertex.owner, share_of([UNIT - b - c, b, c])),
            _ => MapPlace::NONE,
        }
    }

    /// Whether what lies over base triangle t never faces away from it: all of it is displaced straight up.
    #[must_use]
    pub fn is_height_field(&self, t: u32) -> bool {
        self.straight[t as usize] >= 0.0
    }

    /// With the corner corrections, where there are any.
    #[must_use]
    pub fn hatted(&self, site: &Site, detail: u32) -> DVec3 {
        let own = self.own(site, detail, false);
        if self.tables.corrections.is_empty() {
            return own;
        }
        own + site.blend(site.av.map(|av| self.av_correction[av as usize]))
    }

    /// What one side of a seam asks for, `t` along it.
    #[must_use]
    pub fn candidate(&self, side: SeamSide, t: f64) -> DVec3 {
        self.hatted(&Site::on_edge(self.tables, side.id, t), side.detail)
    }

    /// What the sides of a seam agree on, less what the side of rank `own` asks for.
    #[must_use]
    pub fn shortfall(&self, seam: &Seam, own: u32, t: f64) -> DVec3 {
        let part = |rank: u32| {
            let own = f64::from(u8::from(rank == own));
            let part = share(seam.distinct, self.tables.rule, rank) - own;
            self.candidate(self.tables.seam_sides[(seam.first + rank) as usize], t) * part
        };
        self.distinct(seam).map(part).sum()
    }

    pub(super) fn distinct(&self, seam: &Seam) -> impl Iterator<Item = u32> + '_ {
        let (first, count) = (seam.first, seam.count);
        (0..count).filter(move |rank| self.tables.seam_sides[(first + rank) as usize].same_as == *rank)
    }

    /// The displaced place at barycentrics b of base triangle t.
    #[must_use]
    pub fn inside(&self, t: u32, b: DVec3) -> DVec3 {
        let triangle = &self.tables.base_triangles[t as usize];
        let site = Site::inside(self.tables, t, b);
        let position = site.position(self.tables);
        let Some(correction) = self.tables.correction(t) else {
            return position + self.own(&site, triangle.detail, false);
        };
        let mut sum = position + self.hatted(&site, triangle.detail);
        for side in 0..3 {
            let weight = 1.0 - b[(side + 2) % 3] * f64::from(correction.inverse_width[side]);
            if correction.seam[side] == NONE || weight <= 0.0 {
                continue;
            }
            let seam = self.tables.seams[correction.seam[side] as usize];
            let reversed = triangle.reversed >> side & 1 == 1;
            let (a, c) = (b[side], b[(side + 1) % 3]);
            let (to, from) = if reversed { (a, c) } else { (c, a) };
            sum += weight * self.shortfall(&seam, correction.rank[side], to / (to + from));
        }
        sum
    }

    /// The displaced place of a vertex, and how far its sides disagreed.
    #[must_use]
    pub fn vertex(&self, vertex: &RefinedVertex) -> (DVec3, f64) {
        match vertex.kind {
            vertex_kind::CORNER => (self.corners[vertex.owner as usize], 0.0),
            vertex_kind::EDGE => self.on_edge(vertex.owner, f64::from(vertex.param[0]) / f64::from(UNIT)),
            _ => {
                let b = barycentrics(vertex, &self.base.triangles[vertex.owner as usize]);
                (self.inside(vertex.owner, share_of(b)), 0.0)
            }
        }
    }

    fn on_edge(&self, ge: u32, t: f64) -> (DVec3, f64) {
        let [triangle, side] = self.base.edge_side[ge as usize];
        let base = &self.tables.base_triangles[triangle as usize];
        let seam = self.seam_of_edge[ge as usize];
        let ae = base.ae[side as usize];
        let site = Site::on_edge(self.tables, ae, t);
        if seam == NONE {
            return (site.position(self.tables) + self.own(&site, base.detail, false), 0.0);
        }
        let seam = self.tables.seams[seam as usize];
        let candidate = |k: u32| self.candidate(self.tables.seam_sides[k as usize], t);
        let reconciled = reconcile_edges::reconcile(self.tables, &seam, candidate);
        (site.position(self.tables) + reconciled.displacement, reconciled.mismatch)
    }
}

fn pyramids(tables: &Tables, layer: &Layer) -> Vec<Pyramid> {
    let channels = match layer.kind {
        kind::EXPRESSION => 0,
        kind::HEIGHT => 1,
        _ => 3,
    };
    (0..channels).map(|channel| Pyramid::new(&Lattice::new(tables, layer, channel))).collect()
}

/// Units as barycentrics.
#[must_use]
pub fn share_of(b: [u32; 3]) -> DVec3 {
    DVec3::from_array(b.map(f64::from)) / f64::from(UNIT)
}

fn gvs(tables: &Tables, base: &refine::Base) -> Vec<u32> {
    let mut gv_of = vec![0; tables.av_normal.len()];
    for (triangle, base) in tables.base_triangles.iter().zip(&base.triangles) {
        for (av, gv) in triangle.av.into_iter().zip(base.gv) {
            gv_of[av as usize] = gv;
        }
    }
    gv_of
}

fn seams_of_edges(tables: &Tables, base: &refine::Base) -> Vec<u32> {
    let mut ge_of = vec![0; tables.base_edges.len()];
    for (triangle, base) in tables.base_triangles.iter().zip(&base.triangles) {
        for (ae, ge) in triangle.ae.into_iter().zip(base.ge) {
            ge_of[ae as usize] = ge;
        }
    }
    let mut seam_of_edge = vec![NONE; base.edges.len()];
    for (number, seam) in (0..).zip(&tables.seams) {
        let ae = tables.seam_sides[seam.first as usize].id;
        seam_of_edge[ge_of[ae as usize] as usize] = number;
    }
    seam_of_edge
}
