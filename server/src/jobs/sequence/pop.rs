//! How far a surface jumps from one frame to the next.

use glam::{DMat4, DVec3};
use rayon::prelude::*;

use crate::domain::{
    image::RenderCamera,
    scene::Scene,
    surface::{Common, Surface},
};

/// The largest distance on the image between what is shown of the same place of the base, pixels: `shares` of the way from
/// the first tessellation to the second. Corners of parts on which both are flat are looked at, which differ most wherever
/// a part is seen from afar; those that the image shows in neither place do not count.
pub(super) fn worst(
    scene: &Scene,
    (common, surfaces): (&[Common], [&[Surface]; 2]),
    shares: [f64; 2],
    camera: &RenderCamera,
    size: [u32; 2],
) -> f64 {
    let [clip, view] =
        [camera.clip_from_view, camera.view_from_world].map(|m| DMat4::from_cols_array(&m.map(f64::from)));
    let of_instance = |instance: &crate::domain::scene::Instance| {
        let (lens, mesh) = (Lens { clip: clip * view * instance.world(), size }, instance.mesh);
        let apart = |pair: [[f64; 3]; 2]| lens.apart(pair.map(DVec3::from_array), shares);
        common[mesh].pairs(surfaces.map(|made| &made[mesh])).map(apart).reduce(|| 0.0, f64::max)
    };
    scene.instances.iter().map(of_instance).fold(0.0, f64::max)
}

struct Lens {
    clip: DMat4,
    size: [u32; 2],
}

impl Lens {
    fn apart(&self, [a, b]: [DVec3; 2], shares: [f64; 2]) -> f64 {
        let [before, now] = shares.map(|share| self.seen(a.lerp(b, share)));
        match (before, now) {
            (Some((before, was_seen)), Some((now, is_seen))) if was_seen || is_seen => {
                (before[0] - now[0]).hypot(before[1] - now[1])
            }
            _ => 0.0,
        }
    }

    /// Pixels, and whether they are of the image; none behind the eye.
    fn seen(&self, place: DVec3) -> Option<([f64; 2], bool)> {
        let h = self.clip * place.extend(1.0);
        let is_seen = h.x.abs() <= h.w && h.y.abs() <= h.w;
        let pixel = |x: f64, pixels: u32| 0.5 * f64::from(pixels) * x / h.w;
        (h.w > 0.0).then(|| ([pixel(h.x, self.size[0]), pixel(h.y, self.size[1])], is_seen))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// 90 degrees both ways, along -z.
    const LENS: Lens = Lens {
        clip: DMat4::from_cols_array_2d(&[
            [1.0, 0.0, 0.0, 0.0],
            [0.0, 1.0, 0.0, 0.0],
            [0.0, 0.0, 0.0, -1.0],
            [0.0, 0.0, 1.0, 0.0],
        ]),
        size: [200, 200],
    };

    #[test]
    fn a_jump_is_as_long_as_it_is_seen() {
        let pair = [DVec3::new(0.0, 0.0, -2.0), DVec3::new(0.1, 0.0, -2.0)];
        assert!((LENS.apart(pair, [0.0, 1.0]) - 5.0).abs() < 1e-12, "100 pixels a unit at depth 1");
        assert!((LENS.apart(pair, [0.25, 0.5]) - 1.25).abs() < 1e-12);
        assert_eq!(LENS.apart([pair[0], DVec3::new(0.0, 0.0, -3.0)], [0.0, 1.0]), 0.0, "along the line of sight");
    }

    #[test]
    fn what_the_image_does_not_show_does_not_jump() {
        let beside = [DVec3::new(3.0, 0.0, -2.0), DVec3::new(3.1, 0.0, -2.0)];
        assert_eq!(LENS.apart(beside, [0.0, 1.0]), 0.0);
        assert_eq!(LENS.apart([DVec3::Z, 2.0 * DVec3::Z], [0.0, 1.0]), 0.0, "behind the eye");
    }
}
