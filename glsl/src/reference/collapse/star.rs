//! The triangles around a vertex, with all that is asked of them.

use glam::DVec3;

use super::{Facet, Simplified};
use crate::{
    layout::refine::UNIT,
    reference::refine::{self, barycentrics},
};

/// Of a vertex in a base triangle: the second and third barycentric, in units.
pub(super) type Units = [i64; 2];

/// A corner of a triangle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Corner {
    pub(super) gv: u32,
    pub(super) units: Units,
    /// Displaced.
    pub(super) position: DVec3,
}

/// A triangle; in a star its first corner is the vertex in the middle.
#[derive(Clone, Copy, Debug)]
pub(super) struct Around {
    pub(super) corners: [Corner; 3],
    pub(super) base: u32,
}

impl Around {
    /// Corner `first` of the facet comes first.
    pub(super) fn new(base: &refine::Base, mesh: &Simplified, facet: &Facet, first: usize) -> Self {
        let triangle = &base.triangles[facet.base as usize];
        let corner = |k: usize| {
            let gv = facet.gv[(first + k) % 3];
            let [_, b, c] = barycentrics(&mesh.vertices[gv as usize], triangle);
            Corner { gv, units: [i64::from(b), i64::from(c)], position: mesh.positions[gv as usize] }
        };
        Self { corners: [corner(0), corner(1), corner(2)], base: facet.base }
    }

    pub(super) fn has(&self, gv: u32) -> bool {
        self.corners.iter().any(|corner| corner.gv == gv)
    }

    pub(super) fn positions(&self) -> [DVec3; 3] {
        self.corners.each_ref().map(|corner| corner.position)
    }

    /// In square units of the base triangle; above 0 where it runs the same way.
    pub(super) fn twice_area(&self) -> i64 {
        twice_area(self.corners.each_ref().map(|corner| corner.units))
    }

    pub(super) fn normal(&self) -> DVec3 {
        let [a, b, c] = self.positions();
        (b - a).cross(c - a)
    }

    /// Of its corners in the base triangle.
    pub(super) fn shares(&self) -> [DVec3; 3] {
        self.corners.each_ref().map(|corner| {
            let [b, c] = corner.units;
            DVec3::new((i64::from(UNIT) - b - c) as f64, b as f64, c as f64) / f64::from(UNIT)
        })
    }
}

pub(super) fn twice_area([a, b, c]: [Units; 3]) -> i64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

/// All triangles around a vertex.
pub(super) struct Star {
    pub(super) around: Vec<Around>,
    /// The other vertices, ascending.
    pub(super) neighbours: Vec<u32>,
}

impl Star {
    pub(super) fn new(base: &refine::Base, mesh: &Simplified, triangles: &[u32], vertex: u32) -> Self {
        let around = |t: &u32| {
            let facet = &mesh.triangles[*t as usize];
            let first = facet.gv.iter().position(|gv| *gv == vertex).unwrap_or(0);
            Around::new(base, mesh, facet, first)
        };
        let around: Vec<Around> = triangles.iter().map(around).collect();
        let mut neighbours: Vec<u32> = around.iter().flat_map(|a| [a.corners[1].gv, a.corners[2].gv]).collect();
        neighbours.sort_unstable();
        neighbours.dedup();
        Self { around, neighbours }
    }

    /// Base triangles around: as many as have a triangle in the star.
    pub(super) fn sheets(&self) -> usize {
        let is_first = |k: usize| !self.around[..k].iter().any(|other| other.base == self.around[k].base);
        (0..self.around.len()).filter(|k| is_first(*k)).count()
    }

    pub(super) fn shared_with(&self, gv: u32) -> usize {
        self.around.iter().filter(|around| around.has(gv)).count()
    }

    /// A neighbour as a corner in a base triangle; none where none of its triangles lies there.
    fn corner_in(&self, base: u32, gv: u32) -> Option<Corner> {
        let in_base = self.around.iter().filter(|around| around.base == base);
        in_base.flat_map(|around| around.corners).find(|corner| corner.gv == gv)
    }

    /// The triangles that stay when the vertex is drawn into `to`, each before and after.
    pub(super) fn after(&self, to: u32) -> impl Iterator<Item = (&Around, Around)> {
        let mut known: Option<(u32, Corner)> = None;
        self.around.iter().filter(move |around| !around.has(to)).filter_map(move |around| {
            let corner = match known {
                Some((base, corner)) if base == around.base => corner,
                _ => self.corner_in(around.base, to)?,
            };
            known = Some((around.base, corner));
            let [_, b, c] = around.corners;
            Some((around, Around { corners: [corner, b, c], base: around.base }))
        })
    }
}
