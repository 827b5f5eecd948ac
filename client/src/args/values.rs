//! Parsers of flag values. Each refusal says what was expected, so that clap's
//! `invalid value 'x' for '--flag'` ends in the fix.

use std::str::FromStr;

/// A finite number.
pub(crate) fn finite(text: &str) -> Result<f32, String> {
    let value = f32::from_str(text).map_err(|_| "expected a number such as 0.05".to_owned())?;
    if value.is_finite() { Ok(value) } else { Err("expected a finite number such as 0.05".to_owned()) }
}

/// A finite number of at least 0.
pub(crate) fn not_negative(text: &str) -> Result<f32, String> {
    match finite(text)? {
        value if value >= 0.0 => Ok(value),
        _ => Err("allowed are 0 and above".to_owned()),
    }
}

/// A share from 0 to 1.
pub(crate) fn unit_interval(text: &str) -> Result<f32, String> {
    match finite(text)? {
        value if (0.0..=1.0).contains(&value) => Ok(value),
        _ => Err("allowed are 0 to 1".to_owned()),
    }
}

/// A share of the diagonal that a distance can be known to.
pub(crate) fn share(text: &str) -> Result<f64, String> {
    match f64::from_str(text) {
        Ok(value) if (1e-7..=1.0).contains(&value) => Ok(value),
        _ => Err("expected a share of the diagonal, 1e-7 to 1, such as 1e-4".to_owned()),
    }
}

/// A share of the diagonal that a result can stay within.
pub(crate) fn tolerance_share(text: &str) -> Result<f64, String> {
    match f64::from_str(text) {
        Ok(value) if (1e-6..=1.0).contains(&value) => Ok(value),
        _ => Err("expected a share of the diagonal, 1e-6 to 1, such as 1e-3".to_owned()),
    }
}

/// A length in world units.
pub(crate) fn length(text: &str) -> Result<f64, String> {
    match f64::from_str(text) {
        Ok(value) if value > 0.0 && value.is_finite() => Ok(value),
        _ => Err("expected a length in world units above 0, such as 0.001".to_owned()),
    }
}

/// A distance in pixels.
pub(crate) fn pixels(text: &str) -> Result<f64, String> {
    match f64::from_str(text) {
        Ok(value) if (0.01..=1000.0).contains(&value) => Ok(value),
        _ => Err("expected pixels, 0.01 to 1000, such as 0.5".to_owned()),
    }
}

/// A vertical field of view in degrees.
pub(crate) fn field_of_view(text: &str) -> Result<f32, String> {
    match finite(text)? {
        value if (1.0..=170.0).contains(&value) => Ok(value),
        _ => Err("allowed are 1 to 170 degrees".to_owned()),
    }
}

/// `X,Y,Z`.
pub(crate) fn point(text: &str) -> Result<[f32; 3], String> {
    let expected = || "expected three numbers X,Y,Z such as 0,1.5,3".to_owned();
    let values = numbers(text).ok_or_else(expected)?;
    values.try_into().map_err(|_| expected())
}

/// A light: where from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum LightArg {
    /// Towards the light, and how large it looks, degrees.
    Sun([f32; 3], f32),
    /// And the radius of the ball, world units.
    Point([f32; 3], f32),
}

/// `X,Y,Z[@DEGREES]` or `point:X,Y,Z[,RADIUS]`.
pub(crate) fn light(text: &str) -> Result<LightArg, String> {
    match text.split_once(':') {
        Some(("point", place)) => ball(place),
        Some((kind, _)) => Err(format!(
            "'{kind}' is no kind of light; give X,Y,Z or X,Y,Z@DEGREES, or point:X,Y,Z or point:X,Y,Z,RADIUS"
        )),
        None => sun(text),
    }
}

fn ball(text: &str) -> Result<LightArg, String> {
    let expected = "expected point:X,Y,Z or point:X,Y,Z,RADIUS, world units, such as point:0,2,1,0.25";
    match numbers(text).ok_or(expected)?[..] {
        [x, y, z] => Ok(LightArg::Point([x, y, z], 0.0)),
        [x, y, z, radius] if (0.0..=1e6).contains(&radius) => Ok(LightArg::Point([x, y, z], radius)),
        [_, _, _, _] => Err("the radius must be 0 to 1e6 world units".to_owned()),
        _ => Err(expected.to_owned()),
    }
}

fn sun(text: &str) -> Result<LightArg, String> {
    let Some((towards, degrees)) = text.split_once('@') else {
        return direction(text).map(|towards| LightArg::Sun(towards, 0.0));
    };
    match finite(degrees)? {
        degrees if (0.0..=170.0).contains(&degrees) => Ok(LightArg::Sun(direction(towards)?, degrees)),
        _ => Err("a sun looks 0 to 170 degrees large, such as 1,2,1@0.53".to_owned()),
    }
}

/// `X,Y,Z` with a length.
fn direction(text: &str) -> Result<[f32; 3], String> {
    let vector = point(text)?;
    let largest = vector.iter().fold(0.0f32, |m, c| m.max(c.abs()));
    if largest > 0.0 { Ok(vector) } else { Err("a direction needs a length; 0,0,0 has none".to_owned()) }
}

/// Azimuth and elevation in degrees, and perhaps a distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Orbit {
    pub(crate) azimuth_degrees: f32,
    pub(crate) elevation_degrees: f32,
    pub(crate) distance: Option<f32>,
}

/// `AZ,EL[,DIST]`.
pub(crate) fn orbit(text: &str) -> Result<Orbit, String> {
    let expected = "expected AZ,EL or AZ,EL,DIST, degrees and world units, such as 30,20 or 30,20,4";
    let values = numbers(text).ok_or(expected)?;
    let (azimuth_degrees, elevation_degrees, distance) = match values[..] {
        [azimuth, elevation] => (azimuth, elevation, None),
        [azimuth, elevation, distance] => (azimuth, elevation, Some(distance)),
        _ => return Err(expected.to_owned()),
    };
    if !(-90.0..=90.0).contains(&elevation_degrees) {
        return Err(format!("elevation {elevation_degrees} is out of range; allowed are -90 to 90 degrees"));
    }
    if distance.is_some_and(|d| d <= 0.0) {
        return Err("the distance must be above 0".to_owned());
    }
    Ok(Orbit { azimuth_degrees, elevation_degrees, distance })
}

fn numbers(text: &str) -> Option<Vec<f32>> {
    text.split(',').map(|part| finite(part.trim()).ok()).collect()
}

/// `WxH` in pixels.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Size {
    pub(crate) width: u32,
    pub(crate) height: u32,
}

/// `X,Y` of an image.
pub(crate) fn pixel(text: &str) -> Result<[u32; 2], String> {
    let expected = "expected X,Y, whole numbers from the left and from the top, from 0, such as 160,120";
    let (x, y) = text.split_once(',').ok_or(expected)?;
    let number = |text: &str| text.trim().parse::<u32>().map_err(|_| expected.to_owned());
    Ok([number(x)?, number(y)?])
}

pub(crate) fn size(text: &str) -> Result<Size, String> {
    let expected = "expected WIDTHxHEIGHT in pixels, each 1 to 16384, such as 1280x720";
    let (width, height) = text.split_once(['x', 'X']).ok_or(expected)?;
    let side = |text: &str| text.parse::<u32>().ok().filter(|side| (1..=16384).contains(side)).ok_or(expected);
    Ok(Size { width: side(width)?, height: side(height)? })
}

/// A perspective image by place and size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct View {
    pub(crate) eye: [f32; 3],
    pub(crate) look_at: [f32; 3],
    pub(crate) yfov_degrees: f32,
    pub(crate) size: Size,
}

/// `EYE;LOOK;FOV;WxH`.
pub(crate) fn view(text: &str) -> Result<View, String> {
    let parts: Vec<&str> = text.split(';').map(str::trim).collect();
    let [eye, look_at, fov, size] = parts[..] else {
        return Err("expected EYE;LOOK;FOV;WxH such as '0,1,3;0,0,0;40;1280x720'".to_owned());
    };
    let within = |part: &'static str| move |why: String| format!("{part}: {why}");
    let view = View {
        eye: point(eye).map_err(within("EYE"))?,
        look_at: point(look_at).map_err(within("LOOK"))?,
        yfov_degrees: field_of_view(fov).map_err(within("FOV"))?,
        size: self::size(size).map_err(within("WxH"))?,
    };
    if view.eye == view.look_at { Err("LOOK is where EYE is; choose another place".to_owned()) } else { Ok(view) }
}

/// Source of each component of a vector map: three of r, g, b, each once; upper case negates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Swizzle(pub(crate) [(u8, bool); 3]);

pub(crate) fn swizzle(text: &str) -> Result<Swizzle, String> {
    let expected = "expected r, g and b in any order, upper case to negate, such as rgb or rbG";
    let mut axes = [(0, false); 3];
    if text.len() != 3 {
        return Err(expected.to_owned());
    }
    for (axis, letter) in axes.iter_mut().zip(text.chars()) {
        let source = "rgb".find(letter.to_ascii_lowercase()).ok_or(expected)?;
        *axis = (source as u8, letter.is_ascii_uppercase());
    }
    let mut sources = axes.map(|(source, _)| source);
    sources.sort_unstable();
    if sources == [0, 1, 2] { Ok(Swizzle(axes)) } else { Err(format!("{expected}: each once")) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_orbit_has_two_or_three_numbers_in_range() {
        assert_eq!(orbit("30,-20"), Ok(Orbit { azimuth_degrees: 30.0, elevation_degrees: -20.0, distance: None }));
        assert_eq!(orbit("30, 20, 4").map(|o| o.distance), Ok(Some(4.0)));
        for bad in ["30", "30,100", "30,20,0", "30,20,4,5", "a,b", "nan,0"] {
            assert!(orbit(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn a_size_is_two_positive_numbers() {
        assert_eq!(size("1280x720"), Ok(Size { width: 1280, height: 720 }));
        for bad in ["1280", "0x5", "5x0", "-1x5", "99999x1", "x"] {
            assert!(size(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn a_light_may_have_a_size() {
        assert_eq!(light("1,2,3"), Ok(LightArg::Sun([1.0, 2.0, 3.0], 0.0)));
        assert_eq!(light("1,2,3@0.5"), Ok(LightArg::Sun([1.0, 2.0, 3.0], 0.5)));
        assert_eq!(light("point:1,2,3"), Ok(LightArg::Point([1.0, 2.0, 3.0], 0.0)));
        assert_eq!(light("point:1,2,3,0.25"), Ok(LightArg::Point([1.0, 2.0, 3.0], 0.25)));
        for bad in ["0,0,0@1", "1,2,3@", "1,2,3@171", "point:1,2", "point:1,2,3,-1", "point:1,2,3,4,5", "ball:1,2,3"] {
            assert!(light(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn a_view_is_an_eye_a_target_an_angle_and_a_size() {
        let size = Size { width: 64, height: 48 };
        let expected = View { eye: [0.0, 1.0, -3.0], look_at: [0.0; 3], yfov_degrees: 40.0, size };
        assert_eq!(view("0,1,-3;0,0,0;40;64x48"), Ok(expected));
        assert_eq!(view("0,1,-3; 0,0,0; 40; 64x48"), Ok(expected));
        for (bad, part) in [
            ("0,1,3;0,0,0;40", "EYE;LOOK;FOV;WxH"),
            ("0,1;0,0,0;40;64x48", "EYE: expected three"),
            ("0,1,3;0,0;40;64x48", "LOOK: expected three"),
            ("0,1,3;0,0,0;200;64x48", "FOV: allowed are 1 to 170"),
            ("0,1,3;0,0,0;40;64", "WxH: expected WIDTHxHEIGHT"),
            ("1,1,1;1,1,1;40;64x48", "LOOK is where EYE is"),
        ] {
            assert!(view(bad).is_err_and(|why| why.contains(part)), "{bad}");
        }
    }

    #[test]
    fn a_tolerance_is_in_the_range_of_its_unit() {
        assert_eq!((tolerance_share("1e-6"), tolerance_share("1")), (Ok(1e-6), Ok(1.0)));
        assert_eq!((length("1e-9"), pixels("0.01"), pixels("1000")), (Ok(1e-9), Ok(0.01), Ok(1000.0)));
        for bad in ["0", "-1", "9e-7", "nan", "x"] {
            assert!(tolerance_share(bad).is_err() && pixels(bad).is_err(), "{bad}");
        }
        for bad in ["0", "-1", "inf", "nan", "x"] {
            assert!(length(bad).is_err(), "{bad}");
        }
        assert!(tolerance_share("1.1").is_err() && pixels("1001").is_err());
    }

    #[test]
    fn a_swizzle_is_a_signed_permutation() {
        assert_eq!(swizzle("rGb"), Ok(Swizzle([(0, false), (1, true), (2, false)])));
        assert_eq!(swizzle("bgr"), Ok(Swizzle([(2, false), (1, false), (0, false)])));
        for bad in ["rg", "rgbb", "rrb", "xyz", "ré"] {
            assert!(swizzle(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn numbers_that_are_none_are_refused() {
        assert!(finite("nan").is_err() && finite("inf").is_err() && finite("").is_err());
        assert!(direction("0,0,0").is_err() && point("1,2").is_err());
        assert_eq!(point("-1,2,3.5"), Ok([-1.0, 2.0, 3.5]));
    }
}
