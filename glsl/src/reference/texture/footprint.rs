//! Twin of `texture_footprint.glsl`: the ellipse that a pixel covers on a map (Heckbert 1989).

use super::{super::mip::Level, MAX_ANISOTROPY};

/// J takes a pixel to texels of the finest level; the image of the unit circle is an ellipse with half axes of `major`
/// and `minor` texels, the singular values of J.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Footprint {
    /// xx, xy and yy of J J^T, its shorter axis widened to `minor`.
    pub(super) spread: [f64; 3],
    pub(super) major: f64,
    /// At least `major / MAX_ANISOTROPY`.
    pub(super) minor: f64,
    /// Unit, along the major axis in texels; any direction where there is no longer axis.
    pub(super) along: [f64; 2],
}

/// Nothing where a derivative is not a number or too large to be squared.
pub(super) fn footprint(finest: &Level, dx: [f64; 2], dy: [f64; 2]) -> Option<Footprint> {
    let texels = |d: [f64; 2]| [d[0] * finest.width as f64, d[1] * finest.height as f64];
    let (a, b) = (texels(dx), texels(dy));
    let spread = [a[0] * a[0] + b[0] * b[0], a[0] * a[1] + b[0] * b[1], a[1] * a[1] + b[1] * b[1]];
    let (mean, half) = (0.5 * (spread[0] + spread[2]), 0.5 * (spread[0] - spread[2]));
    let root = half.hypot(spread[1]);
    let major = (mean + root).sqrt();
    if !major.is_finite() {
        return None;
    }
    // The determinant is the product of the axes; the difference of mean and root would cancel.
    let narrow = if major > 0.0 { (a[0] * b[1] - a[1] * b[0]).abs() / major } else { 0.0 };
    let minor = narrow.max(major / MAX_ANISOTROPY);
    let wider = minor * minor - narrow * narrow;
    let spread = [spread[0] + wider, spread[1], spread[2] + wider];
    Some(Footprint { spread, major, minor, along: along(half, spread[1], root) })
}

/// The eigenvector of the larger eigenvalue, from the row of the matrix that does not cancel.
fn along(half: f64, xy: f64, root: f64) -> [f64; 2] {
    let v = if half >= 0.0 { [half + root, xy] } else { [xy, root - half] };
    let length = v[0].hypot(v[1]);
    if length > 0.0 { v.map(|v| v / length) } else { [1.0, 0.0] }
}
