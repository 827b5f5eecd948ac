//! How near the result stays to the surface.

use std::ops::RangeInclusive;

use displace_proto::v1::{self, tolerance};

use super::{join, known, view::look_at};
use crate::domain::{
    Error, Result,
    request::{Allowed, ErrorAt, Quality, Tolerance, ToleranceView},
};

const DIAGONAL: RangeInclusive<f64> = 1e-6..=1.0;
const PIXELS: RangeInclusive<f64> = 0.01..=1000.0;
const SIDE_PIXELS: RangeInclusive<u32> = 1..=16384;
const MAX_VIEWS: usize = 64;

pub(super) fn parse(path: &str, tolerance: &v1::Tolerance) -> Result<Tolerance> {
    Ok(Tolerance {
        allowed: allowed(path, tolerance.allowed.as_ref())?,
        error_at: match known(&join(path, "error_at"), tolerance.error_at)? {
            v1::ErrorAt::Unspecified | v1::ErrorAt::Surface => ErrorAt::Surface,
            v1::ErrorAt::Texels => ErrorAt::Texels,
        },
        quality: match known(&join(path, "quality"), tolerance.quality)? {
            v1::Quality::Unspecified | v1::Quality::Normal => Quality::Normal,
            v1::Quality::High => Quality::High,
        },
    })
}

fn allowed(path: &str, allowed: Option<&tolerance::Allowed>) -> Result<Allowed> {
    match allowed {
        Some(tolerance::Allowed::Diagonal(share)) => {
            Ok(Allowed::Diagonal(within(&join(path, "diagonal"), *share, DIAGONAL, "of the diagonal")?))
        }
        Some(tolerance::Allowed::World(length)) if *length > 0.0 && length.is_finite() => Ok(Allowed::World(*length)),
        Some(tolerance::Allowed::World(length)) => Err(Error::invalid(
            join(path, "world"),
            format!("{length} is out of range; allowed are finite values above 0, world units"),
        )),
        Some(tolerance::Allowed::Pixels(pixels)) => self::pixels(&join(path, "pixels"), pixels),
        None => Err(Error::invalid(join(path, "allowed"), "is required; give diagonal, world or pixels")),
    }
}

fn pixels(path: &str, pixels: &v1::PixelTolerance) -> Result<Allowed> {
    let (count, field) = (pixels.views.len(), join(path, "views"));
    if count > MAX_VIEWS {
        return Err(Error::invalid(field, format!("has {count} entries; allowed are 1 to {MAX_VIEWS}")));
    }
    let views = pixels.views.iter().enumerate().map(|(n, view)| self::view(&format!("{field}[{n}]"), view));
    Ok(Allowed::Pixels {
        tolerance_px: within(&join(path, "tolerance_px"), pixels.tolerance_px, PIXELS, "pixels")?,
        views: views.collect::<Result<_>>()?,
    })
}

fn view(path: &str, view: &v1::ToleranceView) -> Result<ToleranceView> {
    let (eye, target) = (view.eye.clone(), view.target.clone());
    let (eye, target, yfov_degrees) = look_at(path, &v1::LookAt { eye, target, yfov_degrees: view.yfov_degrees })?;
    let side = |name: &str, pixels: u32| match pixels {
        pixels if SIDE_PIXELS.contains(&pixels) => Ok(pixels),
        _ => Err(out_of_range(&join(path, name), pixels, SIDE_PIXELS, "pixels")),
    };
    Ok(ToleranceView {
        eye,
        target,
        yfov_degrees,
        width: side("width", view.width)?,
        height: side("height", view.height)?,
    })
}

fn within(field: &str, value: f64, allowed: RangeInclusive<f64>, unit: &str) -> Result<f64> {
    if allowed.contains(&value) { Ok(value) } else { Err(out_of_range(field, value, allowed, unit)) }
}

fn out_of_range<T: std::fmt::Display>(field: &str, value: T, allowed: RangeInclusive<T>, unit: &str) -> Error {
    let (low, high) = allowed.into_inner();
    Error::invalid(field, format!("{value} is out of range; allowed are {low} to {high} {unit}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parsed(allowed: tolerance::Allowed) -> Result<Allowed> {
        let message = v1::Tolerance { allowed: Some(allowed), ..v1::Tolerance::default() };
        parse("geometry.tolerance", &message).map(|tolerance| tolerance.allowed)
    }

    fn view() -> v1::ToleranceView {
        let (eye, target) = (vec![0.0, 0.0, 3.0], vec![0.0; 3]);
        v1::ToleranceView { eye, target, yfov_degrees: None, width: 640, height: 480 }
    }

    fn pixels(tolerance_px: f64, views: Vec<v1::ToleranceView>) -> Result<Allowed> {
        parsed(tolerance::Allowed::Pixels(v1::PixelTolerance { tolerance_px, views }))
    }

    fn refused(result: Result<Allowed>, field: &str, part: &str) {
        let error = result.unwrap_err();
        assert_eq!(error.field.as_deref(), Some(field));
        assert!(error.message.contains(part), "{error}");
    }

    #[test]
    fn a_share_of_the_diagonal_has_both_ends() {
        for share in [1e-6, 1e-3, 1.0] {
            assert_eq!(parsed(tolerance::Allowed::Diagonal(share)).unwrap(), Allowed::Diagonal(share));
        }
        for share in [0.0, 9e-7, 1.1, -1.0, f64::NAN] {
            refused(parsed(tolerance::Allowed::Diagonal(share)), "geometry.tolerance.diagonal", "0.000001 to 1 of");
        }
    }

    #[test]
    fn a_length_is_above_zero_and_finite() {
        assert_eq!(parsed(tolerance::Allowed::World(1e-30)).unwrap(), Allowed::World(1e-30));
        for length in [0.0, -1.0, f64::INFINITY, f64::NAN] {
            refused(parsed(tolerance::Allowed::World(length)), "geometry.tolerance.world", "above 0");
        }
    }

    #[test]
    fn pixels_come_with_at_most_64_views() {
        assert!(pixels(0.01, vec![view(); 64]).is_ok() && pixels(1000.0, vec![view()]).is_ok());
        let field = "geometry.tolerance.pixels.views";
        refused(pixels(1.0, vec![view(); 65]), field, "has 65 entries; allowed are 1 to 64");
        for px in [0.0, 0.009, 1001.0, f64::NAN] {
            refused(pixels(px, vec![view()]), "geometry.tolerance.pixels.tolerance_px", "0.01 to 1000 pixels");
        }
    }

    #[test]
    fn a_view_has_a_place_a_target_and_a_size() {
        let Allowed::Pixels { views, .. } = pixels(1.0, vec![view()]).unwrap() else { panic!("pixels") };
        assert_eq!((views[0].yfov_degrees, views[0].eye), (40.0, [0.0, 0.0, 3.0]));
        let field = |name: &str| format!("geometry.tolerance.pixels.views[1].{name}");
        let with = |bad: v1::ToleranceView| pixels(1.0, vec![view(), bad]);
        refused(with(v1::ToleranceView { width: 0, ..view() }), &field("width"), "1 to 16384");
        refused(with(v1::ToleranceView { height: 16385, ..view() }), &field("height"), "1 to 16384");
        refused(with(v1::ToleranceView { eye: vec![], ..view() }), &field("eye"), "has 0 components");
        refused(with(v1::ToleranceView { yfov_degrees: Some(180.0), ..view() }), &field("yfov_degrees"), "0.1 to 179");
        refused(with(v1::ToleranceView { target: view().eye, ..view() }), &field("target"), "is where the camera is");
    }

    #[test]
    fn a_tolerance_says_of_what() {
        let error = parse("geometry.tolerance", &v1::Tolerance::default()).unwrap_err();
        assert_eq!(error.field.as_deref(), Some("geometry.tolerance.allowed"));
        let message = v1::Tolerance {
            allowed: Some(tolerance::Allowed::World(1.0)),
            error_at: v1::ErrorAt::Texels.into(),
            quality: v1::Quality::High.into(),
        };
        let tolerance = parse("", &message).unwrap();
        assert_eq!((tolerance.error_at, tolerance.quality), (ErrorAt::Texels, Quality::High));
        let unknown = parse("", &v1::Tolerance { quality: 9, ..message }).unwrap_err();
        assert_eq!(unknown.field.as_deref(), Some("quality"));
    }
}
