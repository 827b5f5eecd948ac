//! A map with the texels around it.

use displace_glsl::reference::relief::HeightLevel;
use glam::IVec2;

/// Texels before the first, and behind the last, along either axis.
const BEFORE: usize = 1;
const BEHIND: usize = 2;

/// What neighbours of texels are read from, where none has to be wrapped.
pub(super) struct Framed {
    pub(super) size: [usize; 2],
    width: usize,
    texels: Vec<f32>,
}

impl Framed {
    pub(super) fn new(map: &HeightLevel) -> Self {
        let size = map.size.map(|n| n as usize);
        let framed = |n: usize| -(BEFORE as i32)..(n + BEHIND) as i32;
        let row = |y: i32| framed(size[0]).map(move |x| map.heights[map.index(IVec2::new(x, y))]);
        let texels = framed(size[1]).flat_map(row).collect();
        Self { size, width: size[0] + BEFORE + BEHIND, texels }
    }

    /// From one before the first to two behind the last.
    #[inline]
    pub(super) fn texel(&self, at: IVec2) -> f64 {
        let [x, y] = [at.x, at.y].map(|i| (i + BEFORE as i32) as usize);
        f64::from(self.texels[y * self.width + x])
    }

    /// Three rows of three, from the last texel on at most.
    pub(super) fn nine(&self, first: IVec2) -> [f64; 9] {
        let [x, y] = [first.x, first.y].map(|i| (i + BEFORE as i32) as usize);
        let row = |k: usize| &self.texels[(y + k) * self.width + x..][..3];
        let rows = [row(0), row(1), row(2)];
        std::array::from_fn(|k| f64::from(rows[k / 3][k % 3]))
    }
}
