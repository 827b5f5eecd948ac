//! A plane with a map, seen in perspective: places, derivatives and the mean over each pixel.

use super::{Level, REPEAT, Random, bilinear};

/// Pixels along a side of the image.
pub(super) const SIDE_PX: usize = 32;
/// Samples along a side of a pixel.
const SAMPLES: usize = 32;

/// A square view from height 1 onto the plane z = 0.
pub(super) struct View {
    forward: [f64; 3],
    right: [f64; 3],
    up: [f64; 3],
    /// Rows that take x and y of the plane to the map.
    map: [[f64; 2]; 2],
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// Middle, side along x and side along y of a pixel on the map.
pub(super) struct Pixel {
    pub(super) uv: [f64; 2],
    pub(super) dx: [f64; 2],
    pub(super) dy: [f64; 2],
}

impl View {
    /// The middle of the image looks `degrees` off the normal; `half_width` is the tangent of half the angle of view. Camera
    /// and map are turned, so that no axis of a footprint lies along one of the map. The shorter side of the pixel
    /// in the middle is `texels` of `finest`.
    pub(super) fn new(degrees: f64, half_width: f64, texels: f64, finest: &Level) -> Self {
        let (sin, cos) = degrees.to_radians().sin_cos();
        let (roll_sin, roll_cos) = 0.2f64.sin_cos();
        let (side, rise) = ([0.0, 1.0, 0.0], [cos, 0.0, sin]);
        let turned = |a: f64, b: f64| [0, 1, 2].map(|k| (a * side[k] + b * rise[k]) * half_width);
        let distance = 1.0 / cos;
        let scale = texels / (distance * 2.0 * half_width / SIDE_PX as f64);
        let (map_sin, map_cos) = 0.4f64.sin_cos();
        let (u, v) = (scale / finest.width as f64, scale / finest.height as f64);
        Self {
            forward: [sin, 0.0, -cos],
            right: turned(roll_cos, roll_sin),
            up: turned(-roll_sin, roll_cos),
            map: [[u * map_cos, -u * map_sin], [v * map_sin, v * map_cos]],
        }
    }

    /// The place (x, y) of the image in pixels, y down, as a ray, and how that changes per pixel.
    fn ray(&self, x: f64, y: f64) -> [[f64; 3]; 3] {
        let per_px = 2.0 / SIDE_PX as f64;
        let (a, b) = (x * per_px - 1.0, 1.0 - y * per_px);
        let ray = [0, 1, 2].map(|k| self.forward[k] + a * self.right[k] + b * self.up[k]);
        [ray, self.right.map(|r| r * per_px), self.up.map(|u| -u * per_px)]
    }

    /// The plane is met where the ray has gone down by 1; derivatives by the quotient rule.
    pub(super) fn pixel(&self, x: f64, y: f64) -> Pixel {
        let [ray, ray_dx, ray_dy] = self.ray(x, y);
        let on_map = |d: [f64; 3]| self.map.map(|row| dot([row[0], row[1], 0.0], d));
        let uv = on_map(ray.map(|r| r / -ray[2]));
        let change = |d: [f64; 3]| on_map([0, 1, 2].map(|k| (ray[k] * d[2] - d[k] * ray[2]) / (ray[2] * ray[2])));
        Pixel { uv, dx: change(ray_dx), dy: change(ray_dy) }
    }

    /// The mean of the finest level over the pixel whose upper left corner is (x, y): a sample in each of 32 by 32 cells.
    pub(super) fn mean(&self, finest: &Level, x: f64, y: f64, random: &mut Random) -> f64 {
        let mut sum = 0.0;
        for cell in 0..SAMPLES * SAMPLES {
            let at = |cell: usize, jitter: f64| (cell as f64 + jitter) / SAMPLES as f64;
            let (across, down) = (at(cell % SAMPLES, random.next()), at(cell / SAMPLES, random.next()));
            sum += bilinear(finest, self.pixel(x + across, y + down).uv, REPEAT)[0];
        }
        sum / (SAMPLES * SAMPLES) as f64
    }
}

#[test]
fn derivatives_agree_with_finite_differences() {
    let finest = &super::grey(64, 32, |_, _| 0.0)[0];
    let view = View::new(60.0, 0.3, 1.5, finest);
    let (p, step) = (view.pixel(10.0, 20.0), 1e-4);
    for k in 0..2 {
        let dx = (view.pixel(10.0 + step, 20.0).uv[k] - view.pixel(10.0 - step, 20.0).uv[k]) / (2.0 * step);
        let dy = (view.pixel(10.0, 20.0 + step).uv[k] - view.pixel(10.0, 20.0 - step).uv[k]) / (2.0 * step);
        assert!((p.dx[k] - dx).abs() < 1e-8 && (p.dy[k] - dy).abs() < 1e-8);
    }
}
