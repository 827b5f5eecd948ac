//! Twin of `course_level`: which level of a height map is marched under a place of the image.

use glam::{DMat2, DVec2, DVec3, DVec4};

use super::flat::Base;

/// Of a pixel, each marched by itself.
const SAMPLES_ACROSS: f64 = 2.0;

/// The coarsest of `count` whose texels are no wider than a sample along the shorter axis of its footprint on the base, of
/// which `weights` are seen there; by the first four rows of an instance. The base's texels are those of the finest.
#[must_use]
pub fn level(base: &Base, rows: &[[f32; 4]], at_px: DVec2, weights: DVec3, count: usize) -> usize {
    let texels = texels_per_sample(base, rows, at_px, weights);
    if !texels.is_finite() {
        return 0;
    }
    (texels.max(1.0).log2().floor() as usize).min(count - 1)
}

/// Along the shorter axis: of pixels for each texel the greater singular value, which stands wherever the base is seen
/// from the side.
fn texels_per_sample(base: &Base, rows: &[[f32; 4]], at_px: DVec2, weights: DVec3) -> f64 {
    let [x, y, w] = [0, 1, 3].map(|row| DVec4::from_array(rows[row].map(f64::from)));
    let [across, down] = [x - w * at_px.x, y - w * at_px.y].map(DVec4::truncate);
    let pixels = base.sides.map(|side| DVec2::new(across.dot(side), down.dot(side)));
    let per_texel = DMat2::from_cols(pixels[0], pixels[1]) * base.texel_edges.inverse();
    let [p, q] = [per_texel.x_axis, per_texel.y_axis];
    let most = (DVec2::new(p.x + q.y, q.x - p.y).length() + DVec2::new(p.x - q.y, q.x + p.y).length()) / 2.0;
    let far = w.dot(base.point(weights).extend(1.0));
    if most > 0.0 { (far / most).abs() / SAMPLES_ACROSS } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::super::{
        Course, HeightLevel, ReliefMap,
        exact::{bounds, marched},
        tests::Random,
    };
    use super::*;

    const PIXELS_OF_NEAR: f64 = 100.0;

    /// From (0, 0, 1) along x and 45 degrees down, in perspective; a unit across at a distance of 1 is 100 pixels.
    fn rows() -> Vec<[f32; 4]> {
        let forward = DVec3::new(1.0, 0.0, -1.0).normalize();
        let (right, up) = (DVec3::NEG_Y * PIXELS_OF_NEAR, DVec3::new(1.0, 0.0, 1.0).normalize() * -PIXELS_OF_NEAR);
        let all = [right, up, DVec3::ZERO, forward].map(|axis| axis.extend(-axis.z));
        all.map(|row| row.as_vec4().to_array()).to_vec()
    }

    /// z = 0 from x = 0 to 64, of so many texels a unit along x and along y.
    fn floor(texels: DVec2) -> Base {
        let corners = [DVec3::new(0.0, -32.0, 0.0), DVec3::new(64.0, -32.0, 0.0), DVec3::new(0.0, 32.0, 0.0)];
        Base::new(corners, DVec3::Z, corners.map(|corner| corner.truncate() * texels)).expect("a triangle")
    }

    /// Where (x, 0, 0) is seen: its pixel, and the weights of it.
    fn seen(x: f64) -> (DVec2, DVec3) {
        let [px, py, _, w] =
            [0, 1, 2, 3].map(|row| DVec4::from_array(rows()[row].map(f64::from)).dot(DVec4::new(x, 0.0, 0.0, 1.0)));
        (DVec2::new(px, py) / w, DVec3::new(0.5 - x / 64.0, x / 64.0, 0.5))
    }

    /// Across the way a pixel is a hundredth as wide as it is deep in the view; along x it is longer.
    #[test]
    fn a_texel_is_half_a_sample_to_one_across_the_way_to_the_horizon() {
        let mut met = [false; 6];
        for step in 0..200 {
            let x = 0.5 + 0.3 * f64::from(step);
            let (at_px, weights) = seen(x);
            let level = level(&floor(DVec2::splat(2.0 * PIXELS_OF_NEAR)), &rows(), at_px, weights, 6);
            let width = 2f64.powi(level as i32) / ((x + 1.0) / 2f64.sqrt());
            assert!((0.5..=1.0).contains(&width), "{x}: {width}");
            met[level] = true;
        }
        assert_eq!(met, [true; 6]);
    }

    #[test]
    fn the_shorter_axis_decides_however_texels_are_stretched() {
        let (at_px, weights) = seen(31.0);
        let of = |texels| level(&floor(texels), &rows(), at_px, weights, 12);
        assert_eq!(of(DVec2::new(400.0, 400.0)), of(DVec2::new(40_000.0, 400.0)));
        assert_eq!(of(DVec2::new(400.0, 400.0)) + 1, of(DVec2::new(400.0, 800.0)));
        assert_eq!(of(DVec2::new(0.1, 400.0)), 0);
    }

    #[test]
    fn there_is_none_coarser_than_the_last() {
        let (at_px, weights) = seen(31.0);
        assert_eq!(level(&floor(DVec2::splat(1e6)), &rows(), at_px, weights, 3), 2);
    }

    /// Heights of no order, from 0 to 8, and their levels.
    fn noise() -> Vec<ReliefMap> {
        let mut random = Random(9);
        let heights = (0..128 * 128).map(|_| random.within(0.0, 8.0) as f32).collect();
        let finest = HeightLevel { size: [128; 2], heights, repeats: [true; 2] };
        let map =
            |level| ReliefMap { bounds: bounds(&level), level, cones: Vec::new(), thinnest_texels: 1.0, steps: 0 };
        finest.chain().into_iter().map(map).collect()
    }

    /// The height that a ray strikes which comes down 1 for 4 texels of the finest level from above such a place.
    fn struck(maps: &[ReliefMap], level: usize, place: DVec2) -> f64 {
        let node = |along: f64| {
            let at = (place + DVec2::new(along, 0.7 * along) + 0.5) / 2f64.powi(level as i32) - 0.5;
            at.extend(8.5 - along / 4.0).extend(along)
        };
        let course = Course { nodes: vec![node(0.0), node(36.0)], cosine: 0.2, is_open: [false; 2] };
        let march = marched(&maps[level], &course, 0.0);
        assert!(march.is_hit());
        course.place(march.s).z
    }

    /// Root of the mean square of what heights change by where a ray of samples of 8 texels moves by a tenth of one.
    fn shimmer(level: usize) -> f64 {
        let (maps, mut random) = (noise(), Random(4));
        let change = |place: DVec2| struck(&maps, level, place + DVec2::new(0.5, 0.6)) - struck(&maps, level, place);
        let places = (0..1000).map(|_| DVec2::new(random.within(0.0, 128.0), random.within(0.0, 128.0)));
        (places.map(|place| change(place).powi(2)).sum::<f64>() / 1000.0).sqrt()
    }

    #[test]
    fn what_rays_strike_changes_less_than_a_quarter_as_much_where_levels_are_those_of_samples() {
        let [finest, level] = [0, 3].map(shimmer);
        assert!(level < 0.25 * finest, "{level} {finest}");
    }
}
