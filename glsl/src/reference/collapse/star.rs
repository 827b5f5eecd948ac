//! The triangles around a vertex, with all that is asked of them.

use glam::DVec3;
use smallvec::SmallVec;

use super::{Facet, Simplified};
use crate::{
    layout::refine::{UNIT, kind},
    reference::{bound::MapPlace, place::Places, refine::barycentrics},
};

/// Of a vertex in a base triangle: the second and third barycentric, in units.
pub(super) type Units = [i32; 2];

/// A vertex as a corner in one base triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub(super) gv: u32,
    pub(super) base: u32,
    pub(super) units: Units,
    /// Displaced.
    pub(super) position: DVec3,
    /// In the map, if it was asked for and there is one map alone.
    pub(super) map: MapPlace,
}

impl Corner {
    pub(super) fn new(places: &Places<'_>, mesh: &Simplified, gv: u32, base: u32) -> Self {
        let vertex = &mesh.vertices[gv as usize];
        let [_, b, c] = match vertex.kind {
            kind::INTERIOR => [0, vertex.param[0], vertex.param[1]],
            _ => barycentrics(vertex, &places.base.triangles[base as usize]),
        };
        let position = mesh.positions[gv as usize];
        Self { gv, base, units: [b as i32, c as i32], position, map: MapPlace::NONE }
    }

    pub(super) fn in_map(self, places: &Places<'_>, mesh: &Simplified) -> Self {
        let known = mesh.in_map.get(self.gv as usize).filter(|place| place.is_known());
        let map = known.copied().unwrap_or_else(|| places.in_map(self.base, self.share()));
        Self { map, ..self }
    }

    fn share(&self) -> DVec3 {
        let [b, c] = self.units;
        DVec3::new(f64::from(UNIT as i32 - b - c), f64::from(b), f64::from(c)) / f64::from(UNIT)
    }
}

/// A triangle within a base triangle; in a star its first corner is the vertex in the middle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Triangle<'c>(pub(super) [&'c Corner; 3]);

impl Triangle<'_> {
    pub(super) fn base(&self) -> u32 {
        self.0[0].base
    }

    pub(super) fn positions(&self) -> [DVec3; 3] {
        self.0.map(|corner| corner.position)
    }

    /// In square units of the base triangle; above 0 where it runs the same way.
    pub(super) fn twice_area(&self) -> i64 {
        twice_area(self.0.map(|corner| corner.units))
    }

    pub(super) fn normal(&self) -> DVec3 {
        let [a, b, c] = self.positions();
        (b - a).cross(c - a)
    }

    /// Of its corners in the base triangle.
    pub(super) fn shares(&self) -> [DVec3; 3] {
        self.0.map(Corner::share)
    }

    pub(super) fn in_map(&self) -> [MapPlace; 3] {
        self.0.map(|corner| corner.map)
    }
}

/// The corners of a facet.
pub(super) fn corners(places: &Places<'_>, mesh: &Simplified, facet: &Facet) -> [Corner; 3] {
    facet.gv.map(|gv| Corner::new(places, mesh, gv, facet.base))
}

pub(super) fn twice_area(units: [Units; 3]) -> i64 {
    let [a, b, c] = units.map(|units| units.map(i64::from));
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// All triangles around a vertex.
pub(super) struct Star {
    /// The vertex in the middle, in each base triangle around.
    middles: SmallVec<[Corner; 2]>,
    /// The other vertices, each in every base triangle that has a triangle with it here.
    rim: SmallVec<[Corner; 10]>,
    /// Of each corner on the rim, the triangles that have it: bit k is triangle k.
    shared: SmallVec<[u64; 10]>,
    /// Numbers of a middle and of the two corners on the rim that follow it.
    triangles: SmallVec<[[u8; 3]; 10]>,
}

impl Star {
    /// Of at most [`super::MOST_AROUND`] triangles.
    pub(super) fn new(places: &Places<'_>, mesh: &Simplified, triangles: &[u32], vertex: u32) -> Self {
        let (middles, rim, shared) = (SmallVec::new(), SmallVec::new(), SmallVec::new());
        let mut star = Self { middles, rim, shared, triangles: SmallVec::new() };
        for (t, bit) in triangles.iter().zip(0..) {
            let Facet { gv: [a, b, c], base } = mesh.triangles[*t as usize];
            let rim = match vertex {
                _ if vertex == a => [b, c],
                _ if vertex == b => [c, a],
                _ => [a, b],
            };
            let middle = number_of(&mut star.middles, vertex, base, places, mesh);
            let rim = rim.map(|gv| {
                let number = number_of(&mut star.rim, gv, base, places, mesh);
                star.shared.resize(star.rim.len(), 0);
                star.shared[number] |= 1 << bit;
                number as u8
            });
            star.triangles.push([middle as u8, rim[0], rim[1]]);
        }
        star
    }

    /// With the places of all corners in the map.
    pub(super) fn in_map(mut self, places: &Places<'_>, mesh: &Simplified) -> Self {
        self.rim.iter_mut().for_each(|corner| *corner = corner.in_map(places, mesh));
        self
    }

    /// The other vertices, each once.
    pub(super) fn neighbours(&self) -> impl Iterator<Item = u32> + '_ {
        let several = self.middles.len() > 1;
        let is_first = move |k: usize| !several || !self.rim[..k].iter().any(|other| other.gv == self.rim[k].gv);
        (0..self.rim.len()).filter(move |k| is_first(*k)).map(|k| self.rim[k].gv)
    }

    /// Base triangles around: as many as have a triangle in the star.
    pub(super) fn sheets(&self) -> usize {
        self.middles.len()
    }

    pub(super) fn shared_with(&self, gv: u32) -> usize {
        self.triangles_with(gv).count_ones() as usize
    }

    /// Bit k is triangle k.
    fn triangles_with(&self, gv: u32) -> u64 {
        let of = |(corner, shared): (&Corner, &u64)| if corner.gv == gv { *shared } else { 0 };
        self.rim.iter().zip(&self.shared).fold(0, |all, one| all | of(one))
    }

    /// A neighbour as a corner in a base triangle; none where none of its triangles lies there.
    fn corner_in(&self, base: u32, gv: u32) -> Option<&Corner> {
        self.rim.iter().find(|corner| corner.gv == gv && corner.base == base)
    }

    /// The triangles that stay when the vertex is drawn into `to`, each before and after.
    pub(super) fn after(&self, to: u32) -> impl Iterator<Item = (Triangle<'_>, Triangle<'_>)> {
        let mut known: Option<&Corner> = None;
        let gone = self.triangles_with(to);
        let stay = self.triangles.iter().zip(0..).filter(move |(_, bit)| gone >> bit & 1 == 0);
        stay.filter_map(move |([middle, b, c], _)| {
            let middle = &self.middles[usize::from(*middle)];
            if known.is_none_or(|corner| corner.base != middle.base) {
                known = self.corner_in(middle.base, to);
            }
            let [b, c] = [b, c].map(|k| &self.rim[usize::from(*k)]);
            known.map(|corner| (Triangle([middle, b, c]), Triangle([corner, b, c])))
        })
    }
}

/// Among corners that are known; one that is not becomes the last.
fn number_of<A: smallvec::Array<Item = Corner>>(
    known: &mut SmallVec<A>,
    gv: u32,
    base: u32,
    places: &Places<'_>,
    mesh: &Simplified,
) -> usize {
    let found = known.iter().position(|corner| corner.gv == gv && corner.base == base);
    found.unwrap_or_else(|| {
        known.push(Corner::new(places, mesh, gv, base));
        known.len() - 1
    })
}
