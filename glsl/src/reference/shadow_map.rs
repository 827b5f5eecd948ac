//! Twin of `shadow_depths` and `shadow_map`: which share of a light reaches a place by the depths that the light sees
//! (percentage closer: Reeves, Salesin and Cook 1987; the receiver's plane: Isidoro 2006).

use glam::{DVec2, DVec3, DVec4};

use super::raster::SAMPLES;
use crate::layout::shadow::{SHADOW_FACES, ShadowFace};

/// Vertices are moved to a grid of so many steps a texel.
const SNAP_STEPS: f64 = 256.0;

/// What lights see: `SHADOW_FACES` sides for each, and the reversed depths of all sides' texels, four samples each.
#[derive(Clone, Debug, Default)]
pub struct ShadowMaps {
    pub faces: Vec<ShadowFace>,
    pub depths: Vec<[f64; 4]>,
}

impl ShadowMaps {
    /// 1: all of light number `light` is seen. `facing` and `direction` are unit, of the triangle and towards the light.
    #[must_use]
    pub fn share_seen(&self, light: usize, position: DVec3, facing: DVec3, direction: DVec3) -> f64 {
        if facing.dot(direction) <= 0.0 && facing != DVec3::ZERO {
            return 0.0;
        }
        let face = &self.faces[light * SHADOW_FACES + side_of(-direction)];
        let rows = [face.row_x, face.row_y, face.row_z, face.row_w].map(|row| DVec4::from_array(row.map(f64::from)));
        let h = DVec4::from_array(rows.map(|row| row.dot(position.extend(1.0))));
        if face.size == 0 || h.w <= 0.0 {
            return 1.0;
        }
        let at = h.truncate() / h.w;
        let change = |along: DVec3| {
            let moved = DVec4::from_array(rows.map(|row| row.truncate().dot(along)));
            (moved.truncate() - at * moved.w) / h.w
        };
        self.share_of_window(face, at, depth_slope(facing, change))
    }

    fn share_of_window(&self, face: &ShadowFace, at: DVec3, slope: DVec2) -> f64 {
        let bias = f64::from(face.bias) + f64::from(face.bias_share) * at.z + slope.abs().element_sum() / SNAP_STEPS;
        let corner = (at.truncate() - 1.5).floor();
        let (mut seen, mut all) = (0.0, 0.0);
        for k in 0..16 {
            let texel = corner + DVec2::new(f64::from(k & 3), f64::from(k >> 2));
            let nearest = self.nearest(face, texel);
            for (depth, offset) in nearest.iter().zip(SAMPLES) {
                let away = texel + DVec2::from_array(offset.map(|x| x as f64)) / 256.0 - at.truncate();
                let plane = f64::max(at.z + slope.dot(away), 0.0);
                let weight = (3.0 - 2.0 * away.abs()).clamp(DVec2::ZERO, DVec2::ONE).element_product();
                seen += if *depth > plane + bias { 0.0 } else { weight };
                all += weight;
            }
        }
        seen / all
    }

    /// Nothing beyond the map.
    fn nearest(&self, face: &ShadowFace, texel: DVec2) -> [f64; 4] {
        let inside = texel.min_element() >= 0.0 && texel.max_element() < f64::from(face.size);
        let index = || face.first as usize + texel.y as usize * face.size as usize + texel.x as usize;
        if inside { self.depths[index()] } else { [0.0; 4] }
    }
}

/// Change of depth per texel over the plane across `facing`.
fn depth_slope(facing: DVec3, change: impl Fn(DVec3) -> DVec3) -> DVec2 {
    let other = if facing.x.abs() < 0.7 { DVec3::X } else { DVec3::Y };
    let side = facing.cross(other).normalize_or_zero();
    let (a, b) = (change(side), change(facing.cross(side)));
    let area = a.x * b.y - a.y * b.x;
    if area == 0.0 {
        return DVec2::ZERO;
    }
    DVec2::new(a.z * b.y - b.z * a.y, a.x * b.z - b.x * a.z) / area
}

/// The side that looks along the direction from a light.
#[must_use]
pub fn side_of(away: DVec3) -> usize {
    let size = away.abs();
    let axis = if size.x >= size.y && size.x >= size.z { 0 } else { 1 + usize::from(size.y < size.z) };
    2 * axis + usize::from(away[axis] < 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// From above, 8 texels over 8 units; depth 1 at y = 1, 0 at y = -1. Where x > 4 something is at y = 0.5.
    fn from_above() -> ShadowMaps {
        let face = ShadowFace {
            row_x: [1.0, 0.0, 0.0, 0.0],
            row_y: [0.0, 0.0, 1.0, 0.0],
            row_z: [0.0, 0.5, 0.0, 0.5],
            row_w: [0.0, 0.0, 0.0, 1.0],
            size: 8,
            ..ShadowFace::default()
        };
        let depth = |i: u32| [if i % 8 >= 4 { 0.75 } else { 0.5 }; 4];
        ShadowMaps { faces: vec![face; SHADOW_FACES], depths: (0..64).map(depth).collect() }
    }

    fn seen(x: f64, y: f64, facing: DVec3) -> f64 {
        from_above().share_seen(0, DVec3::new(x, y, 4.0), facing, DVec3::Y)
    }

    #[test]
    fn what_is_beneath_something_is_dark_and_what_is_beside_it_is_lit() {
        assert_eq!((seen(2.4, 0.0, DVec3::Y), seen(5.6, 0.0, DVec3::Y)), (1.0, 0.0));
        // On what stops the light itself.
        assert_eq!(seen(5.6, 0.5, DVec3::Y), 1.0);
        assert_eq!(seen(2.4, 0.0, DVec3::NEG_Y), 0.0);
    }

    #[test]
    fn shadows_begin_over_three_texels_and_half_way_at_the_edge() {
        let shares: Vec<f64> = (0..=30).map(|k| seen(2.5 + 0.1 * f64::from(k), 0.0, DVec3::Y)).collect();
        assert!(shares.windows(2).all(|pair| pair[1] <= pair[0]));
        // Of ten by ten samples at most one column's weight is off.
        assert!((shares[15] - 0.5).abs() < 0.1, "{}", shares[15]);
        assert!(shares[0] == 1.0 && shares[30] == 0.0);
    }

    #[test]
    fn a_tilted_plane_does_not_shade_itself() {
        // y = (x - 4) / 8: what the light sees of it is its own depth at each sample.
        let mut maps = from_above();
        for (i, texel) in maps.depths.iter_mut().enumerate() {
            let depth = |s: usize| 0.5 + 0.0625 * ((i % 8) as f64 + SAMPLES[s][0] as f64 / 256.0 - 4.0);
            *texel = std::array::from_fn(depth);
        }
        let facing = DVec3::new(-0.125, 1.0, 0.0).normalize();
        for k in 20..60 {
            let x = 0.1 * f64::from(k);
            assert_eq!(maps.share_seen(0, DVec3::new(x, (x - 4.0) / 8.0, 4.0), facing, DVec3::Y), 1.0);
        }
    }

    #[test]
    fn sides_look_along_the_axes() {
        let axes = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y, DVec3::Z, DVec3::NEG_Z];
        assert_eq!(axes.map(|axis| side_of(axis + DVec3::splat(0.1))), [0, 1, 2, 3, 4, 5]);
    }
}
