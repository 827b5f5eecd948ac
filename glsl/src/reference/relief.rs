//! Twins of what is shown of heights per pixel: the way of a ray over a height map, and the methods that march along it,
//! a file each, of the same stem as their shader.
//!
//! All lengths across are texels of one level: texel (i, j) is at x = i, y = j, heights are bilinear between. A ray
//! meets the surface where it goes from above it to on or below it; one that starts below is let out first.

pub mod bordered;
pub mod charts;
pub mod cone;
pub mod exact;
pub mod flat;
pub mod leaving;
pub mod level;
mod levels;
pub mod light;
pub mod occlusion;
#[cfg(test)]
mod outline;
pub mod parallax;
pub mod parallax_iterative;
pub mod parallax_limited;
pub mod pixel_ray;
pub mod quadric;
#[expect(clippy::module_inception, reason = "a twin is called as its pass")]
pub mod relief;
pub mod relieve;
pub mod search;
pub mod shell;
pub mod soft_shadow;
pub mod steep;
#[cfg(test)]
pub(crate) mod tests;

use glam::{DVec2, DVec4, IVec2};

use crate::layout::relief::MISSED;

/// A level of a height map, f32 as the device has it.
#[derive(Clone, Debug, PartialEq)]
pub struct HeightLevel {
    /// Texels along u and v.
    pub size: [u32; 2],
    /// Mesh-local units, row by row.
    pub heights: Vec<f32>,
    /// Along u and v; else the border's texel goes on.
    pub repeats: [bool; 2],
}

/// What a method knows of a map besides its heights.
#[derive(Clone, Debug, PartialEq)]
pub struct ReliefMap {
    pub level: HeightLevel,
    /// Greatest heights of cells and of 2 x 2 of those below, finest first; see [`ReliefLevel`](crate::layout::relief::ReliefLevel).
    /// Empty where the method needs none.
    pub bounds: Vec<f32>,
    /// Of texels; empty where the method needs none.
    pub cones: Vec<f32>,
    /// Width of the thinnest feature, texels of this level.
    pub thinnest_texels: f64,
    /// Linear steps of a march; 0: as many as the angle asks for.
    pub steps: u32,
}

/// The way of a ray: straight between nodes (x, y, z, t), t growing away from where it starts; at least two.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    pub nodes: Vec<DVec4>,
    /// Of the ray and the base's normal.
    pub cosine: f64,
    /// Nothing lies before its beginning, and beyond its end.
    pub is_open: [bool; 2],
}

/// What a method found.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct March {
    /// Counts nodes, fractions lie between two; [`MISSED`] where the surface is not met.
    pub s: f64,
    /// Where maps are read.
    pub place: DVec2,
    pub fetches: u32,
    pub steps: u32,
    /// It ended because it may take no more steps.
    pub capped: bool,
}

/// A method that marches; the setting is its own.
pub type Marched = fn(map: &ReliefMap, course: &Course, setting: f64) -> March;

/// As in `march.glsl`.
pub const LEAST_STEPS: u32 = 8;
pub const MOST_STEPS: u32 = 512;

impl March {
    #[must_use]
    pub fn missed(fetches: u32, steps: u32) -> Self {
        Self { s: f64::from(MISSED), place: DVec2::ZERO, fetches, steps, capped: false }
    }

    #[must_use]
    pub fn is_hit(&self) -> bool {
        self.s >= 0.0
    }
}

impl Course {
    /// At s, from 0 to the number of nodes less 1.
    #[must_use]
    pub fn place(&self, s: f64) -> DVec4 {
        let k = (s.max(0.0) as usize).min(self.nodes.len() - 2);
        self.nodes[k].lerp(self.nodes[k + 1], s - k as f64)
    }

    /// How many texels it leads over.
    #[must_use]
    pub fn travel(&self) -> f64 {
        let across = |pair: &[DVec4]| pair[1].truncate().truncate().distance(pair[0].truncate().truncate());
        self.nodes.windows(2).map(across).sum()
    }
}

impl ReliefMap {
    /// So many that none is longer than the thinnest feature, unless the map says how many.
    #[must_use]
    pub fn steps(&self, course: &Course) -> u32 {
        if self.steps != 0 {
            return self.steps.min(MOST_STEPS);
        }
        let least = course.travel() / self.thinnest_texels.max(1.0);
        least.ceil().clamp(f64::from(LEAST_STEPS), f64::from(MOST_STEPS)) as u32
    }
}

impl HeightLevel {
    /// Of an endless row of texels.
    #[must_use]
    pub fn texel(&self, at: IVec2) -> f64 {
        f64::from(self.heights[self.index(at)])
    }

    /// The number of the texel that stands for one of an endless row.
    #[must_use]
    pub fn index(&self, at: IVec2) -> usize {
        let tiled = |axis: usize| {
            let size = self.size[axis] as i32;
            if self.repeats[axis] { at[axis].rem_euclid(size) } else { at[axis].clamp(0, size - 1) }
        };
        tiled(1) as usize * self.size[0] as usize + tiled(0) as usize
    }

    /// Of a cell: (0, 0), (1, 0), (0, 1), (1, 1).
    #[must_use]
    pub fn corners(&self, cell: IVec2) -> [f64; 4] {
        [IVec2::ZERO, IVec2::X, IVec2::Y, IVec2::ONE].map(|corner| self.texel(cell + corner))
    }

    #[must_use]
    pub fn height(&self, place: DVec2) -> f64 {
        let corner = place.floor();
        let [a, b, c, d] = self.corners(corner.as_ivec2());
        let f = place - corner;
        let mix = |a: f64, b: f64, t: f64| a * (1.0 - t) + b * t;
        mix(mix(a, b, f.x), mix(c, d, f.x), f.y)
    }
}
