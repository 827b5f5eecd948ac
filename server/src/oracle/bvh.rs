//! A hierarchy of boxes over any items. Built by `obvhs` in f32, rounded outwards; walked in f64.

use glam::{DVec3, Vec3A};
use obvhs::{
    BvhBuildParams,
    aabb::Aabb,
    bvh2::{Bvh2, builder::build_bvh2},
};

/// An axis-aligned box; `EMPTY` holds nothing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bounds {
    pub low: DVec3,
    pub high: DVec3,
}

impl Bounds {
    pub const EMPTY: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };

    #[must_use]
    pub fn of(points: &[DVec3]) -> Self {
        points.iter().fold(Self::EMPTY, |b, &p| Self { low: b.low.min(p), high: b.high.max(p) })
    }

    #[must_use]
    pub fn union(self, o: Self) -> Self {
        Self { low: self.low.min(o.low), high: self.high.max(o.high) }
    }

    /// Larger by `margin` on every side.
    #[must_use]
    pub fn inflated(self, margin: f64) -> Self {
        Self { low: self.low - margin, high: self.high + margin }
    }

    /// 0 for an empty box.
    #[must_use]
    pub fn diagonal(self) -> f64 {
        if self.low.cmple(self.high).all() { (self.high - self.low).length() } else { 0.0 }
    }
}

/// Points `origin + t direction` for t from `from` to `to`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    pub origin: DVec3,
    /// Any length but 0.
    pub direction: DVec3,
    pub from: f64,
    pub to: f64,
}

/// The hierarchy. Items are the indices of the boxes it was built from.
pub struct Bvh {
    tree: Bvh2,
}

/// A quotient of rounded differences is off by no more (Ize 2013).
const SLAB_SLACK: f64 = 1.0 + 4.0 * f64::EPSILON;
const STACK: usize = 64;

impl Bvh {
    /// `boxes` are finite and not empty.
    #[must_use]
    pub fn build(boxes: &[Bounds]) -> Self {
        let boxes: Vec<Aabb> = boxes.iter().map(|b| Aabb::new(rounded_down(b.low), rounded_up(b.high))).collect();
        let params = BvhBuildParams::fast_build();
        Self { tree: build_bvh2(&boxes, params, &mut std::time::Duration::default()) }
    }

    /// Visits items whose box may be nearer than the least value `visit` has returned, nearest boxes first.
    /// All distances are squared; returns the least.
    pub fn nearest(&self, point: DVec3, limit: f64, mut visit: impl FnMut(u32, f64) -> f64) -> f64 {
        let mut best = limit;
        let distance = |node: usize| self.square_distance(node, point);
        let mut stack = Vec::with_capacity(STACK);
        stack.extend(self.root().map(|root| (root, distance(root))));
        while let Some((node, near)) = stack.pop() {
            if near > best {
                continue;
            }
            match self.children(node) {
                Some([a, b]) => push_nearer_last(&mut stack, [(a, distance(a)), (b, distance(b))], best),
                None => self.items(node).for_each(|item| best = best.min(visit(item, best))),
            }
        }
        best
    }

    /// Visits items whose box the segment meets, nearest boxes first. `visit` gets the end of what is still of
    /// interest and returns a new one: the t of a hit, or −∞ to stop. Returns the last.
    pub fn along(&self, segment: &Segment, mut visit: impl FnMut(u32, f64) -> f64) -> f64 {
        let mut to = segment.to;
        let inverse = segment.direction.recip();
        let entry = |node: usize, to: f64| self.entry(node, segment, inverse, to);
        let mut stack = Vec::with_capacity(STACK);
        stack.extend(self.root().map(|root| (root, entry(root, to))));
        while let Some((node, near)) = stack.pop() {
            if near > to {
                continue;
            }
            match self.children(node) {
                Some([a, b]) => push_nearer_last(&mut stack, [(a, entry(a, to)), (b, entry(b, to))], to),
                None => self.items(node).for_each(|item| to = to.min(visit(item, to))),
            }
        }
        to
    }

    /// Visits items whose box touches `bounds`, in no order.
    pub fn touching(&self, bounds: Bounds, mut visit: impl FnMut(u32)) {
        let mut stack: Vec<usize> = self.root().into_iter().collect();
        while let Some(node) = stack.pop() {
            let (low, high) = self.corners(node);
            if low.cmpgt(bounds.high).any() || high.cmplt(bounds.low).any() {
                continue;
            }
            match self.children(node) {
                Some(children) => stack.extend(children),
                None => self.items(node).for_each(&mut visit),
            }
        }
    }

    fn root(&self) -> Option<usize> {
        (!self.tree.nodes.is_empty()).then_some(0)
    }

    #[inline]
    fn children(&self, node: usize) -> Option<[usize; 2]> {
        let node = &self.tree.nodes[node];
        (node.prim_count == 0).then_some([node.first_index as usize, node.first_index as usize + 1])
    }

    fn items(&self, node: usize) -> impl Iterator<Item = u32> + '_ {
        let node = &self.tree.nodes[node];
        let range = node.first_index as usize..(node.first_index + node.prim_count) as usize;
        self.tree.primitive_indices[range].iter().copied()
    }

    #[inline]
    fn corners(&self, node: usize) -> (DVec3, DVec3) {
        let aabb = &self.tree.nodes[node].aabb;
        (aabb.min.as_dvec3(), aabb.max.as_dvec3())
    }

    #[inline]
    fn square_distance(&self, node: usize, point: DVec3) -> f64 {
        let (low, high) = self.corners(node);
        let beyond = |low: f64, x: f64, high: f64| (low - x).max(x - high).max(0.0);
        let x = beyond(low.x, point.x, high.x);
        let y = beyond(low.y, point.y, high.y);
        let z = beyond(low.z, point.z, high.z);
        x * x + y * y + z * z
    }

    /// Where the segment enters the box; ∞ where it misses.
    fn entry(&self, node: usize, segment: &Segment, inverse: DVec3, to: f64) -> f64 {
        let (low, high) = self.corners(node);
        let (a, b) = ((low - segment.origin) * inverse, (high - segment.origin) * inverse);
        let (mut enter, mut leave) = (segment.from, to);
        for k in 0..3 {
            // On a plane of the box, along it: 0 · ∞ bounds nothing, and min and max leave a NaN out.
            enter = enter.max(if a[k].is_nan() || b[k].is_nan() { enter } else { a[k].min(b[k]) });
            leave = leave.min(if a[k].is_nan() || b[k].is_nan() { leave } else { a[k].max(b[k]) });
        }
        if enter <= leave * SLAB_SLACK || enter <= leave { enter } else { f64::INFINITY }
    }
}

#[inline]
fn push_nearer_last(stack: &mut Vec<(usize, f64)>, [a, b]: [(usize, f64); 2], limit: f64) {
    let (near, far) = if a.1 < b.1 { (a, b) } else { (b, a) };
    // A box that is missed is endlessly far, also where the limit is.
    if far.1 <= limit && far.1 < f64::INFINITY {
        stack.push(far);
    }
    if near.1 <= limit && near.1 < f64::INFINITY {
        stack.push(near);
    }
}

fn rounded_down(p: DVec3) -> Vec3A {
    Vec3A::from_array(p.to_array().map(|x| if f64::from(x as f32) > x { (x as f32).next_down() } else { x as f32 }))
}

fn rounded_up(p: DVec3) -> Vec3A {
    Vec3A::from_array(p.to_array().map(|x| if f64::from(x as f32) < x { (x as f32).next_up() } else { x as f32 }))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A deterministic number in [0, 1).
    fn noise(k: u32) -> f64 {
        f64::from(k.wrapping_mul(0x9E37_79B1) ^ k.wrapping_mul(0x85EB_CA6B) >> 7) / f64::from(u32::MAX)
    }

    fn point(k: u32) -> DVec3 {
        DVec3::new(noise(3 * k), noise(3 * k + 1), noise(3 * k + 2))
    }

    fn boxes(count: u32) -> Vec<Bounds> {
        (0..count).map(|k| Bounds::of(&[point(k), point(k) + 0.1 * point(k + count)])).collect()
    }

    #[test]
    fn the_nearest_box_is_the_nearest_of_all() {
        let boxes = boxes(500);
        let bvh = Bvh::build(&boxes);
        let distance = |b: &Bounds, p: DVec3| (b.low - p).max(p - b.high).max(DVec3::ZERO).length_squared();
        for k in 0..200 {
            let p = 2.0 * point(k + 7000) - 0.5;
            let all = boxes.iter().map(|b| distance(b, p)).fold(f64::INFINITY, f64::min);
            assert_eq!(bvh.nearest(p, f64::INFINITY, |item, _| distance(&boxes[item as usize], p)), all);
        }
    }

    #[test]
    fn a_segment_visits_every_box_it_meets() {
        let boxes = boxes(300);
        let bvh = Bvh::build(&boxes);
        for k in 0..200 {
            let direction = if k % 4 == 0 { DVec3::X } else { point(k + 9000) - 0.5 };
            let segment = Segment { origin: point(k + 8000), direction, from: 0.0, to: 10.0 };
            let mut visited = vec![false; boxes.len()];
            bvh.along(&segment, |item, to| {
                visited[item as usize] = true;
                to
            });
            for (b, visited) in boxes.iter().zip(visited) {
                let inside = (0..2000).any(|i| {
                    let p = segment.origin + segment.direction * (f64::from(i) * 0.002);
                    b.low.cmple(p).all() && p.cmple(b.high).all()
                });
                assert!(visited || !inside);
            }
        }
    }

    #[test]
    fn an_endless_segment_leaves_out_what_it_misses() {
        let bvh = Bvh::build(&boxes(300));
        let segment = Segment { origin: point(1) + 5.0, direction: DVec3::X, from: 0.0, to: f64::INFINITY };
        let mut visited = 0;
        bvh.along(&segment, |_, to| {
            visited += 1;
            to
        });
        assert_eq!(visited, 0);
    }

    #[test]
    fn an_empty_hierarchy_has_nothing() {
        let bvh = Bvh::build(&[]);
        assert_eq!(bvh.nearest(DVec3::ZERO, 4.0, |_, _| 0.0), 4.0);
        bvh.touching(Bounds::of(&[DVec3::ZERO]), |_| panic!("there is nothing to touch"));
    }
}
