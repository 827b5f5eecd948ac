//! A pixel on the map that it shows, drawn over the map's texels: the quadrilateral of its corners, and the ellipse that
//! elliptical filtering weighs texels in.

use std::sync::Arc;

use glam::{DMat2, DVec2};

use super::{
    Result,
    detail::Wrap,
    encode::{encode_rgb8, srgb_from_linear},
    image::ColorMap,
};

/// In units of the map: (0, 0) is its first corner, (1, 1) the other.
#[derive(Clone, Debug)]
pub struct Preimage {
    pub map: Arc<ColorMap>,
    pub wrap: [Wrap; 2],
    /// Of the pixel, around it.
    pub corners: [DVec2; 4],
    pub centre: DVec2,
    /// Derivatives by x and y of the image, per pixel.
    pub sides: [DVec2; 2],
}

/// Of the picture, pixels a side.
const SIDE: u32 = 480;
/// What is around the pixel, as a multiple of it; and at least so many texels to each side.
const MARGIN: f64 = 1.6;
const LEAST_TEXELS: f64 = 4.0;
/// Texels narrower than this in the picture have no lines between them.
const LINED_PX: f64 = 8.0;
const PIXEL: [f64; 3] = [255.0, 96.0, 0.0];
const ELLIPSE: [f64; 3] = [0.0, 170.0, 255.0];

impl Preimage {
    fn size(&self) -> DVec2 {
        DVec2::new(self.map.width.into(), self.map.height.into())
    }

    /// Squares of the half axes of the ellipse as a matrix, texels of the finest level. The Gaussian of `texture_ewa` has the
    /// variance of the pixel's box, J J^T / 12, and of bilinear interpolation, 1/6, and ends at twice its own deviation, the
    /// square of which is 1 / 0.5443 of the variance that this leaves (Heckbert 1989). What the filter widens beyond 16 to 1
    /// is not in it.
    #[must_use]
    pub fn ellipse(&self) -> DMat2 {
        let [a, b] = self.sides.map(|side| side * self.size());
        let j = DMat2::from_cols(a, b);
        (j * j.transpose() * (1.0 / 12.0) + DMat2::from_diagonal(DVec2::splat(1.0 / 6.0))) * (4.0 / 0.544_321_158_144)
    }

    /// As PNG, sRGB.
    pub fn draw(&self) -> Result<Vec<u8>> {
        let (centre, corners) = (self.centre * self.size(), self.corners.map(|c| c * self.size()));
        let ellipse = self.ellipse();
        let reach = corners.iter().map(|c| (*c - centre).abs().max_element()).fold(0.0, f64::max);
        let reach = reach.max(ellipse.x_axis.x.max(ellipse.y_axis.y).sqrt()).max(LEAST_TEXELS / MARGIN) * MARGIN;
        let texels_per_px = 2.0 * reach / f64::from(SIDE);
        let sketch = Sketch { preimage: self, centre, corners, inverse: ellipse.inverse(), texels_per_px };
        let place = |i: u32| {
            let px = DVec2::new(f64::from(i % SIDE) + 0.5, f64::from(i / SIDE) + 0.5);
            centre + (px - 0.5 * f64::from(SIDE)) * texels_per_px
        };
        let rgb: Vec<u8> = (0..SIDE * SIDE).flat_map(|i| sketch.color(place(i))).collect();
        encode_rgb8(SIDE, SIDE, &rgb)
    }

    fn texel(&self, at: DVec2) -> [f64; 3] {
        let [x, y] = [0, 1].map(|k| {
            let size = i64::from([self.map.width, self.map.height][k]);
            let i = at[k].floor() as i64;
            (match self.wrap[k] {
                Wrap::Repeat => i.rem_euclid(size),
                Wrap::Mirror => {
                    let i = i.rem_euclid(2 * size);
                    i.min(2 * size - 1 - i)
                }
                Wrap::Clamp => i.clamp(0, size - 1),
            }) as usize
        });
        let [r, g, b, _] = self.map.texels[y * self.map.width as usize + x];
        // Paler, so that lines show.
        [r, g, b].map(|c| 0.65 * f64::from(srgb_from_linear(c)) + 0.25 * 255.0)
    }
}

struct Sketch<'a> {
    preimage: &'a Preimage,
    centre: DVec2,
    corners: [DVec2; 4],
    /// Of the ellipse's matrix.
    inverse: DMat2,
    texels_per_px: f64,
}

impl Sketch<'_> {
    fn color(&self, at: DVec2) -> [u8; 3] {
        let mut color = self.preimage.texel(at);
        if self.texels_per_px * LINED_PX < 1.0 {
            let line = (at - at.round()).abs().min_element() / self.texels_per_px;
            blend(&mut color, [64.0; 3], 0.4 * stroke(line, 0.5));
        }
        blend(&mut color, ELLIPSE, stroke(self.to_ellipse(at) / self.texels_per_px, 1.5));
        blend(&mut color, PIXEL, stroke(self.to_pixel(at) / self.texels_per_px, 1.5));
        blend(&mut color, PIXEL, stroke(at.distance(self.centre) / self.texels_per_px, 3.0));
        color.map(|c| (c + 0.5) as u8)
    }

    /// To the border of the pixel.
    fn to_pixel(&self, at: DVec2) -> f64 {
        let side = |k: usize| to_segment(at, self.corners[k], self.corners[(k + 1) % 4]);
        (0..4).map(side).fold(f64::INFINITY, f64::min)
    }

    /// To first order.
    fn to_ellipse(&self, at: DVec2) -> f64 {
        let d = at - self.centre;
        let gradient = 2.0 * (self.inverse * d);
        (d.dot(self.inverse * d) - 1.0).abs() / gradient.length().max(1e-12)
    }
}

fn to_segment(at: DVec2, a: DVec2, b: DVec2) -> f64 {
    let along = b - a;
    let t = ((at - a).dot(along) / along.length_squared().max(1e-300)).clamp(0.0, 1.0);
    at.distance(a + t * along)
}

/// Cover of a line of half this width, pixels.
fn stroke(distance: f64, half: f64) -> f64 {
    (half + 0.5 - distance).clamp(0.0, 1.0)
}

fn blend(color: &mut [f64; 3], other: [f64; 3], share: f64) {
    color.iter_mut().zip(other).for_each(|(c, o)| *c += (o - *c) * share);
}

#[cfg(test)]
mod tests {
    use super::*;

    fn square(side: f64) -> Preimage {
        let map = Arc::new(ColorMap { width: 8, height: 8, texels: vec![[0.0, 0.0, 0.0, 1.0]; 64] });
        let centre = DVec2::splat(0.5);
        let corner = |x: f64, y: f64| centre + 0.5 * side * DVec2::new(x, y);
        Preimage {
            map,
            wrap: [Wrap::Repeat; 2],
            corners: [corner(-1.0, -1.0), corner(1.0, -1.0), corner(1.0, 1.0), corner(-1.0, 1.0)],
            centre,
            sides: [DVec2::new(side, 0.0), DVec2::new(0.0, side)],
        }
    }

    /// A pixel of n texels has a variance of n^2 / 12, and half axes of twice the deviation over sqrt 0.5443.
    #[test]
    fn the_ellipse_of_a_square_is_a_circle() {
        let ellipse = square(1.0).ellipse();
        let expected = (64.0 / 12.0 + 1.0 / 6.0) * 4.0 / 0.544_321_158_144;
        assert!((ellipse - DMat2::from_diagonal(DVec2::splat(expected))).abs_diff_eq(DMat2::ZERO, 1e-12));
    }

    #[test]
    fn the_picture_shows_the_pixel_where_it_is() {
        let png = square(1.0).draw().expect("draws");
        let picture = image::load_from_memory(&png).expect("a PNG").into_rgb8();
        let red: Vec<_> = picture.enumerate_pixels().filter(|(.., p)| p.0 == PIXEL.map(|c| c as u8)).collect();
        // Half of the picture is `MARGIN` times what reaches farthest: the ellipse.
        let half = 240.0 * 4.0 / (square(1.0).ellipse().x_axis.x.sqrt() * MARGIN);
        let reach = |k: usize| red.iter().map(|(x, y, _)| ([*x, *y][k] as f64 - 239.5).abs()).fold(0.0, f64::max);
        assert!((reach(0) - half).abs() < 2.5 && (reach(1) - half).abs() < 2.5, "{} {half}", reach(0));
    }
}
