//! Plain marches in f32 on all cores, a ray after the other: what the device is held against.

use displace_glsl::reference::relief::ReliefMap;
use rayon::prelude::*;

/// x, y and z at either end.
pub(crate) type Ray = [[f32; 3]; 2];
type March = fn(&Native<'_>, Ray) -> Option<f32>;

pub(crate) struct Native<'m> {
    heights: &'m [f32],
    bounds: &'m [f32],
    size: [i32; 2],
    /// Where each level of bounds begins, and how many nodes it has across and down.
    levels: Vec<(usize, [i32; 2])>,
}

impl<'m> Native<'m> {
    pub(crate) fn new(map: &'m ReliefMap) -> Self {
        let size = map.level.size.map(|n| n as i32);
        let mut levels = vec![(0, size)];
        while let Some(&(first, below)) = levels.last().filter(|(_, size)| *size != [1; 2]) {
            levels.push((first + (below[0] * below[1]) as usize, below.map(|n| (n + 1) / 2)));
        }
        Self { heights: &map.level.heights, bounds: &map.bounds, size, levels }
    }

    /// t of all rays.
    pub(crate) fn run(&self, march: March, rays: &[Ray]) -> Vec<Option<f32>> {
        rays.par_iter().with_min_len(1024).map(|ray| march(self, *ray)).collect()
    }

    fn corners(&self, cell: [i32; 2]) -> [f32; 4] {
        let [x0, x1] = [cell[0], cell[0] + 1].map(|x| x.rem_euclid(self.size[0]));
        let [y0, y1] = [cell[1], cell[1] + 1].map(|y| y.rem_euclid(self.size[1]) * self.size[0]);
        [y0 + x0, y0 + x1, y1 + x0, y1 + x1].map(|k| self.heights[k as usize])
    }

    fn height(&self, x: f32, y: f32) -> f32 {
        let (i, j) = (x.floor(), y.floor());
        let [a, b, c, d] = self.corners([i as i32, j as i32]);
        let (u, v) = (x - i, y - j);
        (a + (b - a) * u) * (1.0 - v) + (c + (d - c) * u) * v
    }
}

fn at([from, to]: Ray, t: f32) -> [f32; 3] {
    std::array::from_fn(|k| from[k] + (to[k] - from[k]) * t)
}

/// 16 even steps and five bisections.
pub(crate) fn relief(map: &Native<'_>, ray: Ray) -> Option<f32> {
    let gap = |t: f32| {
        let [x, y, z] = at(ray, t);
        z - map.height(x, y)
    };
    let step = (1..=16).find(|k| gap(*k as f32 / 16.0) <= 0.0)?;
    let (mut above, mut below) = ((step - 1) as f32 / 16.0, step as f32 / 16.0);
    for _ in 0..5 {
        let middle = 0.5 * (above + below);
        *(if gap(middle) > 0.0 { &mut above } else { &mut below }) = middle;
    }
    Some(below)
}

/// Down the pyramid to the closed form in a cell.
pub(crate) fn exact(map: &Native<'_>, ray: Ray) -> Option<f32> {
    let [o, to] = ray;
    let d: [f32; 3] = std::array::from_fn(|k| to[k] - o[k]);
    let inverse = d.map(|d| if d == 0.0 { 1e30 } else { 1.0 / d });
    let forward = [0, 1].map(|k| i32::from(inverse[k] > 0.0));
    let crossing = |k: usize, line: i32| (line as f32 - o[k]) * inverse[k];
    let cell_at = |t: f32| {
        [0, 1].map(|k| {
            let guess = (o[k] + d[k] * t).floor() as i32;
            let (leaves, enters) = (crossing(k, guess + forward[k]), crossing(k, guess + 1 - forward[k]));
            guess + (2 * forward[k] - 1) * (i32::from(leaves <= t) - i32::from(enters > t))
        })
    };
    let travel = d[0].abs() + d[1].abs();
    let top = map.levels.len() - 1;
    let mut level = (travel.max(1.0).log2() as i32 - 3).clamp(0, top as i32) as usize;
    let (mut t, mut cell) = (0.0, cell_at(0.0));
    let slack = 1e-4;
    while t < 1.0 {
        let tile = [0, 1].map(|k| cell[k].div_euclid(map.size[k]) * map.size[k]);
        let node = [0, 1].map(|k| (cell[k] - tile[k]) >> level);
        let line = |k: usize| tile[k] + ((node[k] + forward[k]) << level).min(map.size[k]);
        let leaves = crossing(0, line(0)).min(crossing(1, line(1)));
        if level > 0 {
            let (first, size) = map.levels[level];
            let bound = map.bounds[first + (node[1] * size[0] + node[0]) as usize];
            let clear = (bound + slack - o[2]) * inverse[2];
            if clear < leaves {
                t = clear.max(t);
                cell = cell_at(t);
                level -= 1;
                continue;
            }
        } else if let Some(hit) = leaf(
            map,
            o,
            d,
            cell,
            [crossing(0, cell[0] + 1 - forward[0]), crossing(1, cell[1] + 1 - forward[1])],
            leaves,
        ) {
            return Some(hit);
        }
        let above = (tile, node.map(|n| n >> 1));
        t = leaves;
        cell = cell_at(t);
        let tile = [0, 1].map(|k| cell[k].div_euclid(map.size[k]) * map.size[k]);
        if level < top && (tile, [0, 1].map(|k| (cell[k] - tile[k]) >> (level + 1))) != above {
            level += 1;
        }
    }
    None
}

fn leaf(map: &Native<'_>, o: [f32; 3], d: [f32; 3], cell: [i32; 2], enters: [f32; 2], leaves: f32) -> Option<f32> {
    let (enters, leaves) = (enters[0].max(enters[1]).max(0.0), leaves.min(1.0));
    let [h, right, up, both] = map.corners(cell);
    let (sx, sy, twist) = (right - h, up - h, (h - right) + (both - up));
    let [px, py] = [0, 1].map(|k| (o[k] - cell[k] as f32) + d[k] * enters);
    let c = (o[2] + d[2] * enters) - (h + (sx + twist * py) * px + sy * py);
    let b = d[2] - ((sx + twist * py) * d[0] + (sy + twist * px) * d[1]);
    let a = -twist * d[0] * d[1];
    if c <= 0.0 {
        return Some(enters);
    }
    let discriminant = b * b - 4.0 * a * c;
    if discriminant < 0.0 || (b >= 0.0 && a >= 0.0) {
        return None;
    }
    let after = if b < 0.0 { 2.0 * c / (discriminant.sqrt() - b) } else { -0.5 * (b + discriminant.sqrt()) / a };
    (after <= leaves - enters).then_some(enters + after)
}
