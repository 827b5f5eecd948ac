//! Maps of slopes and of their products, from which filtering tells how normals scatter.

use displace_glsl::reference::moments::{products, slopes};
use rayon::prelude::*;

use crate::domain::{detail::Wrap, image::ColorMap};

/// Slopes and, of the same size, means over each texel of their products.
#[derive(Clone, Debug)]
pub struct SlopeMaps {
    /// Along x and y, 1, 1: a normal of the tangent frame, not of unit length.
    pub slopes: ColorMap,
    /// xx, yy, xy, 1.
    pub moments: ColorMap,
}

impl SlopeMaps {
    /// Of a map of normals of the tangent frame.
    #[must_use]
    pub fn of_normals(normals: &ColorMap, wrap: [Wrap; 2]) -> Self {
        let of_texel = |[x, y, z, _]: &[f32; 4]| slopes([*x, *y, *z]);
        Self::new(normals.width, normals.height, &normals.texels.par_iter().map(of_texel).collect::<Vec<_>>(), wrap)
    }

    /// Of slopes in rows from the top.
    #[must_use]
    pub fn new(width: u32, height: u32, slopes: &[[f32; 2]], wrap: [Wrap; 2]) -> Self {
        let (columns, rows) = (width as usize, height as usize);
        let moments = |(row, target): (usize, &mut [[f32; 4]])| {
            let lines = neighbours(row, rows, wrap[1]).map(|row| &slopes[row * columns..][..columns]);
            for (x, texel) in target.iter_mut().enumerate() {
                let near = neighbours(x, columns, wrap[0]);
                let [xx, yy, xy] = products(&lines.map(|line| near.map(|x| line[x])));
                *texel = [xx, yy, xy, 1.0];
            }
        };
        let mut texels = vec![[0.0; 4]; slopes.len()];
        texels.par_chunks_exact_mut(columns.max(1)).enumerate().for_each(moments);
        Self {
            slopes: ColorMap { width, height, texels: slopes.iter().map(|[x, y]| [*x, *y, 1.0, 1.0]).collect() },
            moments: ColorMap { width, height, texels },
        }
    }
}

/// The texels before, at and behind number `i`.
fn neighbours(i: usize, size: usize, wrap: Wrap) -> [usize; 3] {
    let ends = match wrap {
        Wrap::Repeat => [size - 1, 0],
        Wrap::Mirror | Wrap::Clamp => [0, size - 1],
    };
    [if i == 0 { ends[0] } else { i - 1 }, i, if i + 1 == size { ends[1] } else { i + 1 }]
}
