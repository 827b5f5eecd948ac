//! The map from a square of texture to a quadrilateral of the screen: rational linear, as perspective has it, and bilinear,
//! for comparison (Everson, COM3404; Heckbert 1989).

use glam::{DMat3, DVec2, DVec3};

/// x = (a u + b v + c) / (g u + h v + i), y = (d u + e v + f) / (g u + h v + i).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Projective(pub DMat3);

impl Projective {
    /// That takes (0, 0), (1, 0), (1, 1), (0, 1) to these. `None` where three of them lie on a line.
    #[must_use]
    pub fn from_corners([p0, p1, p2, p3]: [DVec2; 4]) -> Option<Self> {
        let (d1, d2, s) = (p1 - p2, p3 - p2, p0 - p1 + p2 - p3);
        let determinant = d1.perp_dot(d2);
        if determinant == 0.0 {
            return None;
        }
        let (g, h) = (s.perp_dot(d2) / determinant, d1.perp_dot(s) / determinant);
        let (along_u, along_v) = (p1 - p0 + g * p1, p3 - p0 + h * p3);
        let matrix = DMat3::from_cols(along_u.extend(g), along_v.extend(h), p0.extend(1.0));
        (matrix.determinant() != 0.0).then_some(Self(matrix))
    }

    #[must_use]
    pub fn at(&self, uv: DVec2) -> DVec2 {
        let p = self.0 * uv.extend(1.0);
        p.truncate() / p.z
    }

    /// Back from the screen, up to a factor: the matrix that Everson prints.
    #[must_use]
    pub fn adjugate(&self) -> Self {
        let DMat3 { x_axis, y_axis, z_axis } = self.0;
        Self(DMat3::from_cols(y_axis.cross(z_axis), z_axis.cross(x_axis), x_axis.cross(y_axis)).transpose())
    }

    /// Determinant of the change of place: pixels to a unit of (u, v).
    #[must_use]
    pub fn enlargement(&self, uv: DVec2) -> f64 {
        let w = self.0.row(2).dot(uv.extend(1.0));
        self.0.determinant() / w.powi(3)
    }
}

/// The map with the same corners that is linear along u and along v: its inverse is a root of a quadratic.
#[must_use]
pub fn bilinear([p0, p1, p2, p3]: [DVec2; 4], uv: DVec2) -> DVec2 {
    p0.lerp(p1, uv.x).lerp(p3.lerp(p2, uv.x), uv.y)
}

/// How often each pixel is hit when every texel of `texels` by `texels` is put where its centre falls (forward mapping).
#[must_use]
pub fn splatted(map: &Projective, texels: u32, width: u32, height: u32) -> Vec<u32> {
    let mut hits = vec![0; (width * height) as usize];
    for i in 0..texels * texels {
        let uv = (DVec2::new(f64::from(i % texels), f64::from(i / texels)) + 0.5) / f64::from(texels);
        let p = map.at(uv).floor();
        if p.x >= 0.0 && p.y >= 0.0 && p.x < f64::from(width) && p.y < f64::from(height) {
            hits[p.y as usize * width as usize + p.x as usize] += 1;
        }
    }
    hits
}

/// Where the centre of a pixel lies on the map, if it does (inverse mapping).
#[must_use]
pub fn looked_up(inverse: &Projective, x: u32, y: u32) -> Option<DVec2> {
    let p = inverse.0 * DVec3::new(f64::from(x) + 0.5, f64::from(y) + 0.5, 1.0);
    let uv = p.truncate() / p.z;
    ((0.0..1.0).contains(&uv.x) && (0.0..1.0).contains(&uv.y)).then_some(uv)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A floor that runs away from the viewer.
    const FLOOR: [DVec2; 4] =
        [DVec2::new(120.0, 60.0), DVec2::new(200.0, 60.0), DVec2::new(310.0, 230.0), DVec2::new(10.0, 230.0)];
    const CORNERS: [DVec2; 4] = [DVec2::ZERO, DVec2::X, DVec2::ONE, DVec2::Y];

    #[test]
    fn corners_go_where_they_are_asked_to_in_both_maps() {
        let map = Projective::from_corners(FLOOR).expect("a quadrilateral");
        for (uv, corner) in CORNERS.into_iter().zip(FLOOR) {
            assert!((map.at(uv) - corner).length() < 1e-12);
            assert_eq!(bilinear(FLOOR, uv), corner);
        }
    }

    #[test]
    fn the_adjugate_leads_back() {
        let map = Projective::from_corners(FLOOR).expect("a quadrilateral");
        let product = map.adjugate().0 * map.0;
        let error = product * (1.0 / map.0.determinant()) - DMat3::IDENTITY;
        assert!(error.to_cols_array().iter().all(|e| e.abs() < 1e-12), "{error}");
        for (u, v) in [(0.2, 0.7), (0.9, 0.1), (0.5, 0.5)] {
            let uv = DVec2::new(u, v);
            assert!((map.adjugate().at(map.at(uv)) - uv).length() < 1e-12);
        }
    }

    /// Lines stay lines under perspective; the middle of a diagonal of the bilinear map lies off both diagonals.
    #[test]
    fn only_the_projective_map_keeps_lines() {
        let map = Projective::from_corners(FLOOR).expect("a quadrilateral");
        let off = |p: DVec2| (FLOOR[2] - FLOOR[0]).normalize().perp_dot(p - FLOOR[0]);
        for t in [0.1, 0.5, 0.8] {
            assert!(off(map.at(DVec2::splat(t))).abs() < 1e-10);
            assert!(off(bilinear(FLOOR, DVec2::splat(t))).abs() > 5.0);
        }
    }

    #[test]
    fn three_corners_on_a_line_have_no_projective_map() {
        let flat = [DVec2::ZERO, DVec2::X, DVec2::new(2.0, 0.0), DVec2::Y];
        assert_eq!(Projective::from_corners(flat), None);
    }

    #[test]
    fn the_enlargement_is_the_area_that_a_texel_takes() {
        let map = Projective::from_corners(FLOOR).expect("a quadrilateral");
        let (uv, h) = (DVec2::new(0.3, 0.6), 1e-5);
        let side = |d: DVec2| (map.at(uv + h * d) - map.at(uv - h * d)) / (2.0 * h);
        let expected = side(DVec2::X).perp_dot(side(DVec2::Y));
        assert!((map.enlargement(uv) / expected - 1.0).abs() < 1e-8);
    }

    /// Texels wider than a pixel leave pixels out, texels narrower than one hit some more than once; looking back from each
    /// pixel does neither.
    #[test]
    fn forward_mapping_leaves_holes_and_overlaps_and_inverse_mapping_does_not() {
        let map = Projective::from_corners(FLOOR).expect("a quadrilateral");
        let (inverse, [width, height]) = (map.adjugate(), [320, 240]);
        let hits = splatted(&map, 128, width, height);
        assert_eq!(hits.iter().sum::<u32>(), 128 * 128);
        let inside = |i: usize| looked_up(&inverse, i as u32 % width, i as u32 / width).is_some();
        let pixels: Vec<u32> = (0..hits.len()).filter(|&i| inside(i)).map(|i| hits[i]).collect();
        let (holes, overlaps) = (pixels.iter().filter(|n| **n == 0).count(), pixels.iter().filter(|n| **n > 1).count());
        // Near by a texel takes 2.3 by 2.6 pixels, far away 0.6 by 0.4.
        assert!(holes > pixels.len() / 2 && overlaps > 500, "{holes} and {overlaps} of {}", pixels.len());
        let area: f64 = (0..4).map(|k| FLOOR[k].perp_dot(FLOOR[(k + 1) % 4])).sum::<f64>() * 0.5;
        assert!((pixels.len() as f64 - area).abs() < 320.0, "{} pixels for {area}", pixels.len());
    }
}
