//! Where a base triangle's surface has kinks, and the straight cuts along them.

use glam::DVec3;

/// Whole numbers of a grid within this of a region's border do not cut it.
pub(super) const GRID_SLACK: f64 = 1e-9;
/// Texel borders of the other side of a seam that are followed into its ramp.
pub(super) const MOST_FAN_LINES: usize = 256;

/// A straight cut: `line · b = 0`, in texels or with a largest component of 1.
#[derive(Clone, Copy)]
pub(super) struct Cut {
    pub(super) line: DVec3,
}

/// Lines along which a base triangle's surface has kinks.
pub(super) struct Kinks {
    /// Functions over the corners whose whole numbers are kinks.
    pub(super) grids: Vec<[f64; 3]>,
    pub(super) lines: Vec<DVec3>,
}

impl Kinks {
    /// The cut that leaves the fewest further ones.
    pub(super) fn cut(&self, region: &[DVec3]) -> Option<Cut> {
        let mut best: Option<(f64, Cut)> = None;
        for grid in &self.grids {
            let grid = DVec3::from_array(*grid);
            let (low, high) = extremes(region, grid);
            let (first, last) = ((low + GRID_SLACK).floor() + 1.0, (high - GRID_SLACK).ceil() - 1.0);
            let count = last - first + 1.0;
            if count >= 1.0 && best.as_ref().is_none_or(|(most, _)| count > *most) {
                let middle = ((first + last) * 0.5).floor();
                best = Some((count, Cut { line: grid - middle }));
            }
        }
        best.map(|(_, cut)| cut).or_else(|| self.line_through(region))
    }

    fn line_through(&self, region: &[DVec3]) -> Option<Cut> {
        let crosses = |line: &&DVec3| {
            let (low, high) = extremes(region, **line);
            low < -GRID_SLACK && high > GRID_SLACK
        };
        self.lines.iter().find(crosses).map(|line| Cut { line: *line })
    }
}

fn extremes(region: &[DVec3], line: DVec3) -> (f64, f64) {
    region.iter().map(|b| line.dot(*b)).fold((f64::INFINITY, f64::NEG_INFINITY), |(lo, hi), x| (lo.min(x), hi.max(x)))
}

/// Across the middle of the longer side of the region's box: whatever its corners, its parts are smaller.
pub(super) fn halving(b: &[DVec3], lengths: [f64; 2]) -> Cut {
    let [w1, w2] = [DVec3::Y, DVec3::Z].map(|axis| extremes(b, axis));
    let longer = (w1.1 - w1.0) * lengths[0] >= (w2.1 - w2.0) * lengths[1];
    let (axis, (low, high)) = if longer { (DVec3::Y, w1) } else { (DVec3::Z, w2) };
    Cut { line: axis - 0.5 * (low + high) }
}
