//! Maps of light from everywhere in other layouts than ours, resampled once in f64.

use displace_glsl::reference::environment::direction;
use glam::DVec3;
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

use super::{Environment, FIELD, MAX_TEXELS};
use crate::domain::{Error, Result};

/// How a file lays light out by direction.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum EnvironmentLayout {
    /// Longitude and latitude, as [`Environment`] has it.
    #[default]
    Equirect,
    /// Six squares as seen from inside, upright, -Z in front: a cross 4:3 or 3:4, or a row 6:1.
    Cube,
    /// What a mirror shows as OpenGL's sphere maps have it: a square, +Z in its middle, -Z all around.
    Sphere,
}

/// Texels are means of so many places each way.
const PLACES: usize = 3;

impl EnvironmentLayout {
    /// The same light by longitude and latitude. Fails where width and height are not those of the layout.
    pub(super) fn resampled(self, map: Environment) -> Result<Environment> {
        match self {
            Self::Equirect => Ok(map),
            Self::Cube => {
                let cube = Cube::new(&map)?;
                resampled(2 * cube.side as u32, |d| cube.radiance(d))
            }
            Self::Sphere if map.width == map.height => resampled(map.height, |d| mirrored(&map, d)),
            Self::Sphere => Err(wrong(&map, "a sphere map is square")),
        }
    }
}

fn wrong(map: &Environment, what: &str) -> Error {
    let message =
        format!("the map has {} x {} pixels; {what}: name its layout, or cut it to size", map.width, map.height);
    Error::invalid(FIELD, message)
}

fn resampled(height: u32, radiance: impl Fn(DVec3) -> DVec3 + Sync) -> Result<Environment> {
    let (width, texels) = (2 * height, 2 * u64::from(height).pow(2));
    if texels > MAX_TEXELS {
        let message = format!("the map comes to {width} x {height} texels; {MAX_TEXELS} are allowed: scale it down");
        return Err(Error::too_large(FIELD, message));
    }
    Ok(panorama(width, radiance))
}

/// Of `width` by half as many texels, each the mean of a few places.
pub(crate) fn panorama(width: u32, radiance: impl Fn(DVec3) -> DVec3 + Sync) -> Environment {
    let height = width / 2;
    let place =
        |texel: u32, k: usize, size: u32| (f64::from(texel) + (k as f64 + 0.5) / PLACES as f64) / f64::from(size);
    let texel = |i: u32| {
        let (x, y) = (i % width, i / width);
        let at = |k: usize| radiance(direction(place(x, k % PLACES, width), place(y, k / PLACES, height)));
        let sum: DVec3 = (0..PLACES * PLACES).map(at).sum();
        (sum / (PLACES * PLACES) as f64).as_vec3().to_array()
    };
    Environment { width, height, texels: (0..width * height).into_par_iter().map(texel).collect() }
}

/// Squares in the order +X, -X, +Y, -Y, +Z, -Z, by where they begin and how they lie.
struct Cube<'m> {
    map: &'m Environment,
    /// Texels.
    side: usize,
    squares: [Square; 6],
}

#[derive(Clone, Copy)]
struct Square {
    /// Squares from the left and from the top.
    at: [usize; 2],
    right: DVec3,
    down: DVec3,
}

impl<'m> Cube<'m> {
    fn new(map: &'m Environment) -> Result<Self> {
        let (width, height) = (map.width as usize, map.height as usize);
        let cells = [([4, 3], HORIZONTAL), ([3, 4], VERTICAL), ([6, 1], ROW)];
        let fits = |[x, y]: [usize; 2]| width.is_multiple_of(x) && height.is_multiple_of(y) && width / x == height / y;
        let (cells, places) = cells
            .into_iter()
            .find(|(cells, _)| fits(*cells))
            .ok_or_else(|| wrong(map, "a cube map is a cross of 4 x 3 or 3 x 4 squares, or a row of 6"))?;
        let mut squares = std::array::from_fn(|axis| {
            let [right, down] = AXES[axis];
            Square { at: places[axis], right, down }
        });
        if places == VERTICAL {
            // The back hangs below the bottom, upside down.
            let back: &mut Square = &mut squares[4];
            (back.right, back.down) = (-back.right, -back.down);
        }
        Ok(Self { map, side: width / cells[0], squares })
    }

    fn radiance(&self, d: DVec3) -> DVec3 {
        let square = self.squares[displace_glsl::reference::shadow_map::side_of(d)];
        let ahead = d.abs().max_element();
        let place = |axis: DVec3| 0.5 * (1.0 + d.dot(axis) / ahead);
        // Between texels of this square alone.
        let texel = |axis: DVec3| (place(axis) * self.side as f64 - 0.5).clamp(0.0, (self.side - 1) as f64);
        let corner = square.at.map(|cells| (cells * self.side) as f64);
        between(self.map, [corner[0] + texel(square.right), corner[1] + texel(square.down)])
    }
}

const HORIZONTAL: [[usize; 2]; 6] = [[2, 1], [0, 1], [1, 0], [1, 2], [3, 1], [1, 1]];
const VERTICAL: [[usize; 2]; 6] = [[2, 1], [0, 1], [1, 0], [1, 2], [1, 3], [1, 1]];
const ROW: [[usize; 2]; 6] = [[0, 0], [1, 0], [2, 0], [3, 0], [4, 0], [5, 0]];

/// To the right and down, seen from inside, +X, -X, +Y, -Y, +Z, -Z; above and below as they fold on to -Z.
const AXES: [[DVec3; 2]; 6] = [
    [DVec3::Z, DVec3::NEG_Y],
    [DVec3::NEG_Z, DVec3::NEG_Y],
    [DVec3::X, DVec3::NEG_Z],
    [DVec3::X, DVec3::Z],
    [DVec3::NEG_X, DVec3::NEG_Y],
    [DVec3::X, DVec3::NEG_Y],
];

/// Bilinear, texels from the middle of the first.
fn between(map: &Environment, at: [f64; 2]) -> DVec3 {
    let (low, share) = (at.map(f64::floor), at.map(|x| x - x.floor()));
    let texel = |dx: usize, dy: usize| {
        let x = (low[0] as usize + dx).min(map.width as usize - 1);
        let y = (low[1] as usize + dy).min(map.height as usize - 1);
        DVec3::from_array(map.texels[y * map.width as usize + x].map(f64::from))
    };
    let row = |dy: usize| if share[0] > 0.0 { texel(0, dy).lerp(texel(1, dy), share[0]) } else { texel(0, dy) };
    if share[1] > 0.0 { row(0).lerp(row(1), share[1]) } else { row(0) }
}

/// OpenGL's sphere map: m = 2 sqrt(x^2 + y^2 + (z + 1)^2), at (x / m + 1/2, y / m + 1/2), y up.
fn mirrored(map: &Environment, d: DVec3) -> DVec3 {
    let m = 2.0 * (d + DVec3::Z).length().max(1e-9);
    let size = f64::from(map.width);
    // No texel beyond the rim: those that are read are up to a diagonal away.
    let (x, y) = (d.x / m, d.y / m);
    let inside = (0.5 - 1.5 / size).max(0.0) / x.hypot(y).max(1e-12);
    let shrink = inside.min(1.0);
    let at = |x: f64| ((0.5 + x * shrink) * size - 0.5).clamp(0.0, size - 1.0);
    between(map, [at(x), at(-y)])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Smooth, and different every way.
    fn light(d: DVec3) -> DVec3 {
        DVec3::new(1.0 + d.x, 1.0 + d.y * d.z, 1.0 + 0.5 * d.z)
    }

    fn drawn(width: u32, height: u32, direction: impl Fn(f64, f64) -> Option<DVec3>) -> Environment {
        let texel = |i: u32| {
            let at = direction(f64::from(i % width) + 0.5, f64::from(i / width) + 0.5);
            at.map_or([1e3; 3], |d| light(d.normalize()).as_vec3().to_array())
        };
        Environment { width, height, texels: (0..width * height).map(texel).collect() }
    }

    fn assert_is_light(map: &Environment, bound: f64) {
        for (i, texel) in map.texels.iter().enumerate() {
            let (x, y) = (i % map.width as usize, i / map.width as usize);
            let d = direction((x as f64 + 0.5) / f64::from(map.width), (y as f64 + 0.5) / f64::from(map.height));
            let off = (DVec3::from_array(texel.map(f64::from)) - light(d)).abs().max_element();
            assert!(off < bound, "{d}: {texel:?} for {}", light(d));
        }
    }

    /// By hand: which way each square of a cross looks, and what is to its right and below.
    fn cross(cells: [[Option<usize>; 4]; 4], columns: u32, rows: u32, turned: Option<usize>) -> Environment {
        let side = 32.0;
        drawn(columns * 32, rows * 32, |x, y| {
            let face = cells[(y / side) as usize][(x / side) as usize]?;
            let forward = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z][face];
            // Upright is up; above and below, up is backward and forward.
            let up = [DVec3::Y, DVec3::Y, DVec3::Z, DVec3::NEG_Z, DVec3::Y, DVec3::Y][face];
            let sign = if turned == Some(face) { -1.0 } else { 1.0 };
            let right = sign * forward.cross(up);
            let (s, t) = ((x / side).fract() * 2.0 - 1.0, (y / side).fract() * 2.0 - 1.0);
            Some(forward + s * right - t * sign * up)
        })
    }

    #[test]
    fn crosses_and_rows_of_a_cube_are_the_same_light() {
        let n = None;
        let [px, nx, py, ny, pz, nz] = [0, 1, 2, 3, 4, 5].map(Some);
        let across = cross([[n, py, n, n], [nx, nz, px, pz], [n, ny, n, n], [n; 4]], 4, 3, None);
        let upright = cross([[n, py, n, n], [nx, nz, px, n], [n, ny, n, n], [n, pz, n, n]], 3, 4, Some(4));
        for map in [across, upright] {
            // A quarter turn of a smooth function over 32 texels: half a texel off at edges of squares.
            assert_is_light(&EnvironmentLayout::Cube.resampled(map).expect("fits"), 0.05);
        }
    }

    #[test]
    fn a_sphere_map_is_what_a_mirror_shows() {
        let map = drawn(256, 256, |x, y| {
            // The ball's normal there, and what it mirrors towards +Z.
            let (x, y) = (x / 128.0 - 1.0, 1.0 - y / 128.0);
            let n = DVec3::new(x, y, (1.0 - x * x - y * y).max(0.0).sqrt());
            (x * x + y * y <= 1.0).then(|| 2.0 * n.z * n - DVec3::Z)
        });
        let found = EnvironmentLayout::Sphere.resampled(map).expect("fits");
        // Within a texel and a half of the rim lies all that is within 2 sqrt(3 / 128) of -Z, where light changes by as much.
        assert_is_light(&found, 0.4);
        let front = &found.texels[128 * 512 + 384];
        let off = (DVec3::from_array(front.map(f64::from)) - light(DVec3::Z)).abs().max_element();
        assert!(off < 0.02, "{front:?}");
    }

    #[test]
    fn other_shapes_are_refused_with_those_that_fit() {
        let map = |width, height| Environment { width, height, texels: vec![[0.0; 3]; (width * height) as usize] };
        for (layout, what) in [(EnvironmentLayout::Cube, "4 x 3 or 3 x 4"), (EnvironmentLayout::Sphere, "square")] {
            let error = layout.resampled(map(8, 4)).expect_err("refused").to_string();
            assert!(error.contains("8 x 4") && error.contains(what), "{error}");
        }
    }
}
