//! Twin of `relieve`: what a ray struck, from where on the map it did, and where it is.

use glam::{DMat2, DVec2, DVec3, DVec4};

use super::{HeightLevel, bordered::Met, flat::Base, parallax_iterative::slope};
use crate::reference::bump::surface_gradient;

/// What a ray struck.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Struck {
    /// Weights of the corners, also beside the triangle.
    pub at: DVec3,
    /// Of the weights, per pixel along x and y; none where the facet is seen from the side.
    pub changes: Option<[DVec3; 2]>,
    /// Mesh-local.
    pub point: DVec3,
    /// From there up to the heights, which a step may have gone below, mesh-local.
    pub lift: DVec3,
    /// Reversed.
    pub depth: f64,
    /// Mesh-local normal of the heights there, of any length.
    pub facing: DVec3,
    /// The same as displaced surfaces have it, from slopes averaged over a texel.
    pub smooth: DVec3,
}

/// At `point`, mesh-local, on the triangle that lies there, by the first four rows of an instance.
#[must_use]
pub fn struck(
    base: &Base,
    level: &HeightLevel,
    rows: &[[f32; 4]],
    at_px: DVec2,
    (met, point): (&Met, DVec3),
) -> Struck {
    let rises = base.texel_edges.transpose() * slope(level, met.place.floor().as_ivec2(), met.place);
    let seen = if met.is_level { DVec2::ZERO } else { rises };
    let along = [0, 1].map(|i| base.sides[i] + base.normal * seen[i]);
    let changes = changes(along, rows, at_px, point);
    let [z, w] = [2, 3].map(|row| row_of(rows, row).dot(point.extend(1.0)));
    let normal = |rises: DVec2| base.normal - surface_gradient(base.sides, base.normal, rises);
    let smooth = normal(base.texel_edges.transpose() * smooth_slope(level, met.place));
    let lift = base.normal * met.lift;
    Struck { at: base.weights(met.place), changes, point, lift, depth: z / w, facing: normal(rises), smooth }
}

/// Change of height for each texel, by central differences over one.
fn smooth_slope(level: &HeightLevel, place: DVec2) -> DVec2 {
    let rise = |way: DVec2| level.height(place + way * 0.5) - level.height(place - way * 0.5);
    DVec2::new(rise(DVec2::X), rise(DVec2::Y))
}

/// Of the weights, per pixel: the facet moves with them by `along`, and stays under the pixel or goes on to the next.
fn changes(along: [DVec3; 2], rows: &[[f32; 4]], at_px: DVec2, point: DVec3) -> Option<[DVec3; 2]> {
    let w = row_of(rows, 3);
    let planes = [0, 1].map(|axis| (row_of(rows, axis) - w * at_px[axis]).truncate());
    let pixels = along.map(|side| DVec2::new(planes[0].dot(side), planes[1].dot(side)));
    let shares = DMat2::from_cols(pixels[0], pixels[1]).inverse() * w.dot(point.extend(1.0));
    let weights = |b: DVec2| DVec3::new(-b.x - b.y, b.x, b.y);
    shares.is_finite().then(|| [weights(shares.x_axis), weights(shares.y_axis)])
}

fn row_of(rows: &[[f32; 4]], row: usize) -> DVec4 {
    DVec4::from_array(rows[row].map(f64::from))
}

#[cfg(test)]
mod tests {
    use glam::{DMat4, DQuat};

    use super::{
        super::{
            ReliefMap, exact,
            flat::{course, tests::quad},
            pixel_ray::pixel_ray,
            tests,
        },
        *,
    };

    /// A camera that looks at (1, 0.5, 0) from above at an angle, 100 x 80 pixels.
    fn rows() -> Vec<[f32; 4]> {
        let perspective = DMat4::from_cols(DVec4::X * 1.2, DVec4::Y * 1.8, -DVec4::W, DVec4::Z * 0.25);
        let view = DMat4::from_translation(DVec3::new(0.0, 0.0, -4.0))
            * DMat4::from_quat(DQuat::from_rotation_x(-0.7) * DQuat::from_rotation_z(0.4))
            * DMat4::from_translation(DVec3::new(-1.0, -0.5, 0.0));
        let viewport = DMat4::from_cols(DVec4::X * 50.0, DVec4::Y * -40.0, DVec4::Z, DVec4::new(50.0, 40.0, 0.0, 1.0));
        let all = viewport * perspective * view;
        (0..4).map(|row| all.row(row).as_vec4().to_array()).collect()
    }

    /// Heights rise by 1/128 for each texel along x: by a quarter along the side of 32 texels.
    fn seen(normal: DVec3, at_px: DVec2) -> Struck {
        let base = quad(normal);
        let mut map: ReliefMap = tests::slope(1.0 / 128.0);
        map.bounds = exact::bounds(&map.level);
        let ray = pixel_ray(&rows(), at_px, DVec3::ZERO);
        let course = course(&base, &ray, -0.25..0.25).expect("a course");
        let march = exact::marched(&map, &course, 12.0);
        assert!(march.is_hit());
        let t = course.place(march.s).w;
        let met = Met { t, place: march.place, is_level: false, lift: 0.0 };
        struck(&base, &map.level, &rows(), at_px, (&met, ray.origin + ray.direction * t))
    }

    /// Texel x of the ramp is at 1 + 32 b1, and 0 high where x is 32.
    #[test]
    fn what_is_struck_lies_on_the_ramp_and_is_seen_there() {
        for normal in [DVec3::Z, DVec3::new(0.3, -0.2, 1.0).normalize()] {
            let at_px = DVec2::new(45.5, 42.25);
            let found = seen(normal, at_px);
            let height = (1.0 + 32.0 * found.at.y - 32.0) / 128.0;
            let expected = DVec3::X * 2.0 * found.at.y + DVec3::Y * found.at.z + normal * height;
            assert!((found.point - expected).length() < 1e-9, "{} {expected}", found.point);
            let [x, y, z, w] = [0, 1, 2, 3].map(|row| row_of(&rows(), row).dot(found.point.extend(1.0)));
            assert!((DVec2::new(x, y) / w - at_px).length() < 1e-9);
            assert_eq!(found.depth, z / w);
        }
    }

    #[test]
    fn changes_agree_with_finite_differences() {
        for normal in [DVec3::Z, DVec3::new(0.3, -0.2, 1.0).normalize()] {
            let (at_px, step) = (DVec2::new(45.5, 42.25), 1e-4);
            let found = seen(normal, at_px);
            let across =
                |way: DVec2| (seen(normal, at_px + way * step).at - seen(normal, at_px - way * step).at) / (2.0 * step);
            let changes = found.changes.expect("a facet seen from above");
            for (change, way) in changes.into_iter().zip([DVec2::X, DVec2::Y]) {
                assert!((change - across(way)).length() < 1e-6 * change.length(), "{change} {}", across(way));
            }
        }
    }

    /// z = x/8 but for what is added: its normal is (-1/8, 0, 1).
    #[test]
    fn it_faces_as_the_ramp_does() {
        let facing = seen(DVec3::Z, DVec2::new(45.5, 42.25)).facing;
        assert!((facing - DVec3::new(-0.125, 0.0, 1.0)).length() < 1e-12, "{facing}");
    }
}
