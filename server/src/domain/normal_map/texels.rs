//! One normal for each texel, in the frame of the place it stands for.

use glam::{DVec3, Vec3};
use rayon::prelude::*;

use super::{GUTTER_TEXELS, MOST_APART_DEGREES};

/// A map as it is made: row-major from the top.
#[derive(Clone, Debug)]
pub struct Texels {
    pub size: [u32; 2],
    /// Unit vectors in the frame; zero where no place is.
    normals: Vec<Vec3>,
    /// Texels that a place is in.
    pub covered: u64,
    /// Of these, those whose normal points into the triangle that has them.
    pub clamped: u64,
    pub disagreement: Disagreement,
}

/// Where several places share a texel.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Disagreement {
    /// Texels with several places.
    pub shared: u64,
    /// Of these, those whose places want normals farther apart than [`MOST_APART_DEGREES`].
    pub texels: u64,
    /// The farthest.
    pub most_degrees: f64,
}

impl Texels {
    /// From the texel, the normal in the frame and whether that was clamped, of each place; the first place of a texel
    /// has it.
    #[must_use]
    pub fn of(size: [u32; 2], places: impl Iterator<Item = (u32, DVec3, bool)>) -> Self {
        let normals = vec![Vec3::ZERO; size[0] as usize * size[1] as usize];
        let mut texels = Self { size, normals, covered: 0, clamped: 0, disagreement: Disagreement::default() };
        let mut apart = std::collections::HashMap::new();
        for (texel, normal, clamped) in places {
            let known = &mut texels.normals[texel as usize];
            if *known == Vec3::ZERO {
                *known = normal.as_vec3();
                texels.covered += 1;
                texels.clamped += u64::from(clamped);
                continue;
            }
            let known = known.as_dvec3();
            let degrees = known.cross(normal).length().atan2(known.dot(normal)).to_degrees();
            let most: &mut f64 = apart.entry(texel).or_default();
            *most = most.max(degrees);
        }
        texels.disagreement = Disagreement {
            shared: apart.len() as u64,
            texels: apart.values().filter(|degrees| **degrees > MOST_APART_DEGREES).count() as u64,
            most_degrees: apart.into_values().fold(0.0, f64::max),
        };
        texels
    }

    /// Share of the texels that a place is in.
    #[must_use]
    pub fn coverage(&self) -> f64 {
        self.covered as f64 / self.normals.len() as f64
    }

    /// Continues islands by [`GUTTER_TEXELS`]: each texel beside them gets the mean of those it touches.
    pub fn continue_islands(&mut self) {
        let (width, all) = (self.size[0] as usize, self.normals.len());
        let mut empty: Vec<usize> =
            (0..all).into_par_iter().filter(|texel| self.normals[*texel] == Vec3::ZERO).collect();
        for _ in 0..GUTTER_TEXELS {
            let grown = |texel: &usize| (*texel, self.around(texel % width, texel / width));
            let grown: Vec<(usize, Vec3)> = empty.par_iter().map(grown).collect();
            grown.iter().for_each(|(texel, normal)| self.normals[*texel] = *normal);
            empty = grown.into_iter().filter(|(_, normal)| *normal == Vec3::ZERO).map(|(texel, _)| texel).collect();
        }
    }

    /// The mean of the texels that one touches, which repeat beyond the border.
    fn around(&self, x: usize, y: usize) -> Vec3 {
        let [width, height] = self.size.map(|side| side as usize);
        let mut sum = Vec3::ZERO;
        for row in [y + height - 1, y, y + 1] {
            for column in [x + width - 1, x, x + 1] {
                sum += self.normals[row % height * width + column % width];
            }
        }
        sum.normalize_or_zero()
    }

    /// RGB of 8 bits, 0 to 255 for -1 to 1; straight out where nothing is.
    #[must_use]
    pub fn rgb(&self) -> Vec<u8> {
        let byte = |x: f32| ((0.5 * x + 0.5) * 255.0 + 0.5) as u8;
        let mut rgb = vec![0; 3 * self.normals.len()];
        rgb.par_chunks_exact_mut(3).zip(&self.normals).for_each(|(rgb, normal)| {
            let normal = if *normal == Vec3::ZERO { Vec3::Z } else { *normal };
            rgb.copy_from_slice(&normal.to_array().map(byte));
        });
        rgb
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_that_want_other_normals_of_one_texel_are_counted() {
        let tilted = |degrees: f64| DVec3::new(degrees.to_radians().sin(), 0.0, degrees.to_radians().cos());
        let places = [(0, DVec3::Z, false), (0, tilted(1.0), false), (1, DVec3::Z, true), (1, tilted(30.0), false)];
        let texels = Texels::of([2, 2], places.into_iter());
        assert_eq!((texels.covered, texels.clamped, texels.coverage()), (2, 1, 0.5));
        let Disagreement { shared, texels, most_degrees } = texels.disagreement;
        assert!((shared, texels) == (2, 1) && (most_degrees - 30.0).abs() < 1e-4, "{most_degrees}");
    }

    #[test]
    fn an_island_is_continued_by_the_gutter_and_over_the_border() {
        let tilted = DVec3::new(0.6, 0.0, 0.8);
        let mut texels = Texels::of([64, 64], [(0, tilted, false)].into_iter());
        texels.continue_islands();
        let rgb = texels.rgb();
        let pixel = |x: usize, y: usize| [0, 1, 2].map(|k| rgb[3 * (64 * y + x) + k]);
        let [own, flat] = [[204, 128, 230], [128, 128, 255]];
        assert_eq!([pixel(0, 0), pixel(8, 8), pixel(56, 0), pixel(3, 60)], [own; 4]);
        assert_eq!([pixel(9, 0), pixel(30, 30), pixel(0, 55)], [flat; 3]);
    }
}
