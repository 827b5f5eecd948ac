//! Twin of `course_flat` and `land` within charts: a course from border to border, and where a ray lands on it.

use std::ops::Range;

use glam::{DVec2, DVec3, DVec4};

use super::{
    Course, HeightLevel, March,
    charts::{Charts, End, MOST_BENDS, Way},
    flat::Base,
    pixel_ray::PixelRay,
};

/// Where a ray passes its triangle.
pub struct Foot<'a> {
    pub charts: &'a Charts<'a>,
    pub triangle: usize,
    /// Texels of the map.
    size: DVec2,
    /// On the map, which is 1 wide and high.
    place: DVec2,
    /// Of the place, by t.
    rate: DVec2,
    /// Along the ray.
    t: f64,
    /// Height by t; below 0.
    rise: f64,
}

/// A course within a chart. One node alone is all beyond a border.
#[derive(Clone, Debug, PartialEq)]
pub struct Bordered {
    pub course: Course,
    pub ends: [End; 2],
}

/// What a ray has met.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Met {
    /// Along the ray.
    pub t: f64,
    /// Texels.
    pub place: DVec2,
    /// At a border, beyond which heights count as what they are there.
    pub is_level: bool,
    /// From there up to the heights, which a step may have gone below.
    pub lift: f64,
}

impl<'a> Foot<'a> {
    /// `weights`: of the base's corners, where the ray passes it.
    #[must_use]
    pub fn new(
        base: &Base,
        ray: &PixelRay,
        charts: &'a Charts<'a>,
        triangle: usize,
        size: DVec2,
        weights: DVec3,
    ) -> Self {
        let (start, change) = (base.under(ray.origin), base.along(ray.direction));
        let place = (base.place(weights) + 0.5) / size;
        let rate = base.texel_edges * change.truncate() / size;
        Self { charts, triangle, size, place, rate, t: -start.z / change.z, rise: change.z }
    }

    fn way(&self, sense: f64) -> Way {
        Way::new(self.triangle, self.place, self.rate * sense)
    }

    fn node(&self, sense: f64, (place, t): (DVec2, f64)) -> DVec4 {
        let texel = place * self.size - 0.5;
        DVec4::new(texel.x, texel.y, self.rise * sense * t, self.t + sense * t)
    }

    fn end(&self, sense: f64, way: &Way) -> DVec4 {
        self.node(sense, (way.place(way.t), way.t))
    }

    /// Between two t, as far as the ray is over the chart from the foot on. Where the foot is beyond one of them, the way
    /// leads there first.
    #[must_use]
    pub fn course(&self, range: &Range<f64>, cosine: f64) -> Bordered {
        let (start, end) = (range.start - self.t, range.end - self.t);
        let lead = |way: Way, until: f64| way.followed(self.charts, until, MOST_BENDS);
        let mut back = if end < 0.0 { lead(self.way(-1.0), -end) } else { self.way(-1.0) };
        let mut forth = if start > 0.0 { lead(self.way(1.0), start) } else { self.way(1.0) };
        let (mut last, mut first) = (self.end(-1.0, &back), self.end(1.0, &forth));
        if back.end != End::Inside || forth.end != End::Inside {
            let nodes = vec![if back.t > 0.0 { last } else { first }];
            return Bordered {
                course: Course { nodes, cosine, is_open: [&back, &forth].map(|way| way.end == End::Open) },
                ends: [back.end, forth.end],
            };
        }
        (back.bends, forth.bends) = (Vec::new(), Vec::new());
        if start <= 0.0 {
            back = lead(back, -start);
            first = self.end(-1.0, &back);
        }
        if end >= 0.0 {
            forth = lead(forth, end);
            last = self.end(1.0, &forth);
        }
        let behind = back.bends.iter().rev().map(|bend| self.node(-1.0, *bend));
        let before = forth.bends.iter().map(|bend| self.node(1.0, *bend));
        let tail = (first.z > last.z).then_some(last);
        let nodes = [first].into_iter().chain(behind).chain(before).chain(tail).collect();
        Bordered {
            course: Course { nodes, cosine, is_open: [&back, &forth].map(|way| way.end == End::Open) },
            ends: [back.end, forth.end],
        }
    }

    /// Beyond a seam the surface goes on: a ray that comes from there below it has struck it, and one that leaves above it
    /// comes down to it. Where nothing is beyond, the same if `goes_on`. What is struck lies below the level that is marched
    /// or the finest, which lights may see, by its lift.
    #[must_use]
    pub fn met(
        &self,
        [level, finest]: [&HeightLevel; 2],
        on: &Bordered,
        march: Option<&March>,
        goes_on: bool,
    ) -> Option<Met> {
        let (near, far) = (on.course.nodes[0], on.course.nodes[on.course.nodes.len() - 1]);
        let above = |node: DVec4| node.z - level.height(node.truncate().truncate());
        let at = |node: DVec4, t: f64| Some(Met { t, place: node.truncate().truncate(), is_level: true, lift: 0.0 });
        if on.ends[0] == End::Seam && above(near) <= 0.0 {
            return at(near, near.w);
        }
        if let Some(march) = march.filter(|march| march.is_hit()) {
            let node = on.course.place(march.s);
            let finer = DVec2::from_array([0, 1].map(|k| f64::from(finest.size[k]) / f64::from(level.size[k])));
            let high = level.height(march.place).max(finest.height((march.place + 0.5) * finer - 0.5));
            let lift = (high - node.z).max(0.0);
            return Some(Met { t: node.w, place: march.place, is_level: false, lift });
        }
        let is_on = on.ends[1] == End::Seam || on.ends[1] == End::Open && goes_on;
        if is_on && above(far) >= 0.0 { at(far, far.w - above(far) / self.rise) } else { None }
    }

    /// From the foot to where a ray is at t.
    #[must_use]
    pub fn way_to(&self, t: f64) -> Way {
        let sense = if t < self.t { -1.0 } else { 1.0 };
        self.way(sense).followed(self.charts, (t - self.t).abs(), MOST_BENDS)
    }

    /// From the foot to a place, texels: to the border of the chart as it lies on the map.
    #[must_use]
    pub fn way_over(&self, place: DVec2) -> (Way, DVec2) {
        let rate = (place + 0.5) / self.size - self.place;
        let way = Way::new(self.triangle, self.place, rate).followed(self.charts, 1.0, 0);
        let end = if way.end == End::Inside { place } else { way.place(way.t) * self.size - 0.5 };
        (way, end)
    }
}
