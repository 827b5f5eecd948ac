//! How far the places that two images show at the same pixel lie apart, told in pixels of the first.
//!
//! Both places lie on the ray of their pixel, so that on the screen they are one: their distance in the world counts, as
//! long as it is seen face-on from the camera.

use glam::DVec3;

use super::{percentile, picture::Picture};

/// Distances in pixels over all pixels that both images cover.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HitError {
    pub mean: f64,
    pub p99: f64,
    pub max: f64,
}

/// For pictures of one size, whose pixels are square. `None` where a picture lacks positions or coverage, or `a` its
/// camera, or where no pixel is covered in both.
#[must_use]
pub fn hit_error(a: &Picture, b: &Picture) -> Option<HitError> {
    let scale = Scale::of(a)?;
    let covered = a.covered.as_ref()?.iter().zip(b.covered.as_ref()?);
    let places = a.positions.as_ref()?.iter().zip(b.positions.as_ref()?);
    let both = covered.zip(places).filter(|((a, b), _)| **a && **b);
    let distances: Vec<f32> = both.map(|(_, (a, b))| scale.distance_px(*a, *b)).collect();
    if distances.is_empty() {
        return None;
    }
    let mean = distances.iter().map(|d| f64::from(*d)).sum::<f64>() / distances.len() as f64;
    let max = distances.iter().copied().fold(0.0, f32::max).into();
    Some(HitError { mean, p99: percentile(distances, 0.99), max })
}

/// How many pixels a world unit is, face-on: `face_on_px` divided by the w of its place.
struct Scale {
    face_on_px: f64,
    w_row: DVec3,
    w_constant: f64,
}

impl Scale {
    fn of(picture: &Picture) -> Option<Self> {
        let m = picture.clip_from_world?.map(f64::from);
        let row = |k: usize| DVec3::new(m[k], m[k + 4], m[k + 8]);
        // Clip y goes from -1 to 1 over the height.
        let face_on_px = 0.5 * f64::from(picture.height) * row(1).length();
        Some(Self { face_on_px, w_row: row(3), w_constant: m[15] })
    }

    fn distance_px(&self, a_world: [f32; 3], b_world: [f32; 3]) -> f32 {
        let [a, b] = [a_world, b_world].map(|p| DVec3::from_array(p.map(f64::from)));
        // What a camera sees lies before it; a place of another file may not.
        let w = (self.w_row.dot(a) + self.w_constant).max(f64::MIN_POSITIVE);
        ((a - b).length() * self.face_on_px / w).min(f32::MAX.into()) as f32
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Clip space is the world, but w is world z: a camera at the origin that looks along +Z, 90 degrees wide.
    const PERSPECTIVE: [f32; 16] = [1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 0.0, 0.0, 0.0, 0.0];
    /// Clip space is a fifth of the world.
    const ORTHOGRAPHIC: [f32; 16] = [0.2, 0.0, 0.0, 0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 0.0, 0.2, 0.0, 0.0, 0.0, 0.0, 1.0];

    fn picture(places: &[[f32; 3]]) -> Picture {
        Picture {
            width: places.len() as u32,
            height: 40,
            covered: Some(vec![true; places.len()]),
            positions: Some(places.to_vec()),
            clip_from_world: Some(PERSPECTIVE),
            ..Picture::default()
        }
    }

    #[test]
    fn a_distance_along_the_ray_counts_as_if_it_were_seen_face_on() {
        // The view is 4 world units high at z = 2, so that 40 pixels make a unit 10.
        let a = picture(&[[0.0, 0.0, 2.0]; 4]);
        let b = picture(&[[0.0, 0.0, 2.3], [0.0, -0.1, 2.0], [0.0, 0.0, 2.0], [0.0, 0.0, 2.0]]);
        let error = hit_error(&a, &b).unwrap();
        assert!((error.mean - 1.0).abs() < 1e-6 && (error.max - 3.0).abs() < 1e-6, "{error:?}");
        assert!((error.p99 - 2.94).abs() < 1e-6, "between 1 and 3 at rank 2.97: {error:?}");
    }

    #[test]
    fn without_perspective_a_unit_is_the_same_everywhere() {
        let flat = |places| Picture { clip_from_world: Some(ORTHOGRAPHIC), ..picture(places) };
        let (a, b) = (flat(&[[0.0, 0.0, -9.0], [0.0; 3]]), flat(&[[0.0, 1.0, -9.0], [0.0, 0.0, 1.0]]));
        let error = hit_error(&a, &b).unwrap();
        assert!((error.mean - 4.0).abs() < 1e-6 && (error.max - 4.0).abs() < 1e-6, "{error:?}");
    }

    #[test]
    fn pixels_that_one_image_does_not_cover_do_not_count() {
        let a = picture(&[[0.0, 0.0, 2.0]; 2]);
        let mut b = picture(&[[9.0, 0.0, 2.0], [0.0, 0.0, 2.0]]);
        b.covered = Some(vec![false, true]);
        assert_eq!(hit_error(&a, &b).unwrap().max, 0.0);
        b.covered = Some(vec![false; 2]);
        assert_eq!(hit_error(&a, &b), None);
        b.covered = None;
        assert_eq!(hit_error(&a, &b), None);
    }

    #[test]
    fn a_place_that_the_camera_cannot_see_is_far_but_finite() {
        let (a, b) = (picture(&[[0.0, 0.0, -2.0]]), picture(&[[0.0, 0.0, 2.0]]));
        assert_eq!(hit_error(&a, &b).unwrap().max, f64::from(f32::MAX));
    }
}
