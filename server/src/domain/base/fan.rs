//! The triangles around a vertex, as far as they hang together by edges of two triangles.

use displace_glsl::layout::geometry::NONE;

use super::{
    ring::{Corner, Kind},
    wide,
};
use crate::domain::mesh::Mesh;

/// Anticlockwise as the first triangle sees it.
pub(super) struct Fan {
    centre: u32,
    /// Neighbours; all the way round where `closed`.
    pub(super) ring: Vec<u32>,
    pub(super) closed: bool,
    /// Where in the ring the first triangle's next corner is.
    at: usize,
    /// With whether they run the other way round than the first.
    pub(super) triangles: Vec<(u32, bool)>,
}

impl Fan {
    /// Of `triangle * 3 + corner`.
    pub(super) fn new(mesh: &Mesh, corner: u32) -> Self {
        let (t, k) = (corner / 3, corner as usize % 3);
        let [centre, next, last] = [0, 1, 2].map(|step| gvs(mesh, t)[(k + step) % 3]);
        let mut fan = Self { centre, ring: vec![next, last], closed: false, at: 0, triangles: vec![(t, false)] };
        fan.walk(mesh, last, true);
        if !fan.closed {
            let known = fan.ring.len();
            fan.ring.reverse();
            fan.walk(mesh, next, false);
            fan.ring.reverse();
            fan.at = fan.ring.len() - known;
        }
        fan
    }

    pub(super) fn first(&self) -> u32 {
        self.triangles[0].0
    }

    pub(super) fn corner(&self, mesh: &Mesh, kind: Kind) -> Corner {
        let place = |gv: &u32| wide(mesh.gv_position[*gv as usize]);
        let ring = self.ring.iter().map(place).collect();
        Corner { kind, closed: self.closed, centre: place(&self.centre), ring, at: self.at }
    }

    /// From the first triangle on over the edge to `to`, anticlockwise where `onwards`, until there is no more or the
    /// first comes again.
    fn walk(&mut self, mesh: &Mesh, mut to: u32, onwards: bool) {
        let mut t = self.first();
        loop {
            let over = across(mesh, t, self.centre, to);
            if over == self.first() {
                // The last in the ring is the first of it.
                self.ring.pop();
                self.closed = true;
                return;
            }
            if over == NONE || self.triangles.iter().any(|(known, _)| *known == over) {
                return;
            }
            let corners = gvs(mesh, over);
            let at = corners.iter().position(|gv| *gv == self.centre).unwrap_or(0);
            let (after, before) = (corners[(at + 1) % 3], corners[(at + 2) % 3]);
            self.triangles.push((over, (after == to) != onwards));
            (t, to) = (over, if after == to { before } else { after });
            self.ring.push(to);
        }
    }
}

fn gvs(mesh: &Mesh, t: u32) -> [u32; 3] {
    mesh.triangles[t as usize].av.map(|av| mesh.av_gv[av as usize])
}

/// The other triangle of the edge between two vertices of triangle t; none unless it has exactly two.
fn across(mesh: &Mesh, t: u32, a: u32, b: u32) -> u32 {
    let corners = gvs(mesh, t);
    let is_side =
        |k: &usize| [corners[*k], corners[(k + 1) % 3]] == [a, b] || [corners[*k], corners[(k + 1) % 3]] == [b, a];
    let Some(side) = (0..3).find(is_side) else { return NONE };
    let ge = mesh.ae_ge[mesh.triangles[t as usize].ae[side] as usize];
    match mesh.ge_side.list(ge as usize) {
        [one, other] if *one / 3 == t => *other / 3,
        [one, _] => *one / 3,
        _ => NONE,
    }
}
