//! Regions: halves of halves of a mesh, cut where as many triangles lie on either side. They nest, so what was
//! simplified apart can be simplified together, and they follow places, not the order of triangles.

use std::ops::Range;

use glam::DVec3;

/// Triangles in an order in which those of every region are contiguous.
pub(super) struct Regions {
    order: Vec<u32>,
}

impl Regions {
    /// Halves `depth` times along the longest side of the box of the triangles' centres, all finite.
    pub(super) fn new(centres: &[DVec3], depth: u32) -> Self {
        let mut order: Vec<u32> = (0..centres.len() as u32).collect();
        halve(centres, &mut order, depth);
        Self { order }
    }

    /// How often a mesh is halved until no region has more than `most` triangles.
    pub(super) fn depth(triangles: usize, most: usize) -> u32 {
        (0..).find(|depth| triangles.div_ceil(1 << depth) <= most).unwrap_or(0)
    }

    /// The triangles of each of the 2^`depth` regions.
    pub(super) fn at(&self, depth: u32) -> Vec<&[u32]> {
        let mut ranges = vec![0..self.order.len()];
        for _ in 0..depth {
            ranges = ranges.into_iter().flat_map(halves).collect();
        }
        ranges.into_iter().map(|range| &self.order[range]).collect()
    }
}

fn halves(range: Range<usize>) -> [Range<usize>; 2] {
    let middle = range.start + range.len() / 2;
    [range.start..middle, middle..range.end]
}

fn halve(centres: &[DVec3], order: &mut [u32], depth: u32) {
    if depth == 0 || order.len() < 2 {
        return;
    }
    let of = |t: &u32| centres[*t as usize];
    let low = order.iter().map(of).fold(DVec3::INFINITY, DVec3::min);
    let high = order.iter().map(of).fold(DVec3::NEG_INFINITY, DVec3::max);
    let axis = (high - low).max_position();
    // Centres on one plane across the axis are told apart by where they are on it.
    let key = |t: &u32| [0, 1, 2].map(|k| of(t)[(axis + k) % 3]);
    let compare = |a: &u32, b: &u32| {
        let (p, q) = (key(a), key(b));
        p[0].total_cmp(&q[0]).then(p[1].total_cmp(&q[1])).then(p[2].total_cmp(&q[2])).then(a.cmp(b))
    };
    let middle = order.len() / 2;
    order.select_nth_unstable_by(middle, compare);
    let (low, high) = order.split_at_mut(middle);
    rayon::join(|| halve(centres, low, depth - 1), || halve(centres, high, depth - 1));
}

#[cfg(test)]
mod tests {
    use super::*;

    fn centres(count: u32) -> Vec<DVec3> {
        (0..count).map(|i| DVec3::new(f64::from(i * 7 % 10), f64::from(i * 3 % 4), f64::from(i))).collect()
    }

    #[test]
    fn regions_nest_and_hold_every_triangle_once() {
        let centres = centres(1001);
        let regions = Regions::new(&centres, 4);
        for depth in 0..=4 {
            let mut all: Vec<u32> = regions.at(depth).concat();
            assert!(regions.at(depth).iter().all(|region| region.len().abs_diff(1001 >> depth) <= 1));
            assert!(depth == 0 || regions.at(depth)[..2].concat() == regions.at(depth - 1)[0]);
            all.sort_unstable();
            assert!(all.into_iter().eq(0..1001));
        }
    }

    #[test]
    fn the_order_of_the_triangles_does_not_show() {
        let (there, back) = (centres(500), centres(500).into_iter().rev().collect::<Vec<_>>());
        let regions = [Regions::new(&there, 3), Regions::new(&back, 3)];
        for (a, b) in regions[0].at(3).into_iter().zip(regions[1].at(3)) {
            let mut same: [Vec<u32>; 2] = [a.to_vec(), b.iter().map(|t| 499 - t).collect()];
            same.iter_mut().for_each(|list| list.sort_unstable());
            assert_eq!(same[0], same[1]);
        }
    }

    #[test]
    fn depths_leave_no_region_too_large() {
        assert_eq!([1, 4096, 4097, 100_000].map(|n| Regions::depth(n, 4096)), [0, 0, 1, 5]);
    }
}
