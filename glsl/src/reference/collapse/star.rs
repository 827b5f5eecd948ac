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

    /// Beginning with the corner of the lowest number.
    pub(super) fn lowest_first(&self) -> Self {
        let [a, b, c] = self.0;
        match a.gv.min(b.gv).min(c.gv) {
            lowest if lowest == a.gv => Self([a, b, c]),
            lowest if lowest == b.gv => Self([b, c, a]),
            _ => Self([c, a, b]),
        }
    }

    pub(super) fn facet(&self) -> Facet {
        Facet { gv: self.0.map(|corner| corner.gv), base: self.base() }
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
#[derive(Default)]
pub(super) struct Star {
    /// The vertex in the middle, in each base triangle around.
    middles: SmallVec<[Corner; 2]>,
    /// The other vertices, each in every base triangle that has a triangle with it here.
    rim: SmallVec<[Corner; 12]>,
    /// Of each corner on the rim, the triangles that have its vertex: bit k is triangle k.
    shared: SmallVec<[u64; 12]>,
    /// Numbers of a middle and of the two corners on the rim that follow it.
    triangles: SmallVec<[[u8; 3]; 12]>,
}

impl Star {
    /// At most [`super::MOST_AROUND`] triangles, into a star that is empty.
    pub(super) fn gather(&mut self, places: &Places<'_>, mesh: &Simplified, triangles: &[u32], vertex: u32) {
        for (t, bit) in triangles.iter().zip(0..) {
            let Facet { gv: [a, b, c], base } = mesh.triangles[*t as usize];
            let rim = match vertex {
                _ if vertex == a => [b, c],
                _ if vertex == b => [c, a],
                _ => [a, b],
            };
            let corner = |gv| Corner::new(places, mesh, gv, base);
            let middle = number_of(&mut self.middles, vertex, base, || corner(vertex));
            let rim = rim.map(|gv| {
                let number = number_of(&mut self.rim, gv, base, || corner(gv));
                if number == self.shared.len() {
                    self.shared.push(0);
                }
                self.shared[number] |= 1 << bit;
                number as u8
            });
            self.triangles.push([middle as u8, rim[0], rim[1]]);
        }
        if self.sheets() > 1 {
            self.share_between_sheets();
        }
    }

    fn share_between_sheets(&mut self) {
        let of = |gv: u32, (corner, shared): (&Corner, &u64)| if corner.gv == gv { *shared } else { 0 };
        let all = |gv: u32| self.rim.iter().zip(&self.shared).fold(0, |all, one| all | of(gv, one));
        self.shared = self.rim.iter().map(|corner| all(corner.gv)).collect();
    }

    /// Finds the places of all corners in the map.
    pub(super) fn find_in_map(&mut self, places: &Places<'_>, mesh: &Simplified) {
        self.rim.iter_mut().for_each(|corner| *corner = corner.in_map(places, mesh));
    }

    /// A corner of each of the other vertices, by number.
    pub(super) fn neighbours(&self) -> impl Iterator<Item = usize> + '_ {
        let several = self.sheets() > 1;
        let is_first = move |k: usize| !several || !self.rim[..k].iter().any(|other| other.gv == self.rim[k].gv);
        (0..self.rim.len()).filter(move |k| is_first(*k))
    }

    pub(super) fn neighbour(&self, number: usize) -> u32 {
        self.rim[number].gv
    }

    /// Base triangles around: as many as have a triangle in the star.
    pub(super) fn sheets(&self) -> usize {
        self.middles.len()
    }

    /// How many triangles have a neighbour.
    pub(super) fn shared_with(&self, number: usize) -> usize {
        self.shared[number].count_ones() as usize
    }

    /// The triangles that stay when the vertex is drawn into a neighbour, each before and after.
    #[inline]
    pub(super) fn after(&self, number: usize) -> impl Iterator<Item = (Triangle<'_>, Triangle<'_>)> {
        let (middles, rim, gone) = (&self.middles[..], &self.rim[..], self.shared[number]);
        let to = &rim[number];
        // None where none of the neighbour's triangles lies in this base triangle.
        let in_base = move |base: u32| {
            let is_there = |corner: &&Corner| corner.gv == to.gv && corner.base == base;
            if to.base == base { Some(to) } else { rim.iter().find(is_there) }
        };
        let stay = self.triangles.iter().zip(0..).filter(move |(_, bit)| gone >> bit & 1 == 0);
        stay.filter_map(move |([middle, b, c], _)| {
            let middle = &middles[usize::from(*middle)];
            let [b, c] = [b, c].map(|k| &rim[usize::from(*k)]);
            in_base(middle.base).map(|corner| (Triangle([middle, b, c]), Triangle([corner, b, c])))
        })
    }
}

/// Among corners that are known; one that is not becomes the last.
#[inline]
fn number_of<A: smallvec::Array<Item = Corner>>(
    known: &mut SmallVec<A>,
    gv: u32,
    base: u32,
    corner: impl FnOnce() -> Corner,
) -> usize {
    let found = known.iter().position(|corner| corner.gv == gv && corner.base == base);
    found.unwrap_or_else(|| {
        known.push(corner());
        known.len() - 1
    })
}
