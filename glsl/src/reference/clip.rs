//! Twin of `clip`: Sutherland and Hodgman 1974 in homogeneous pixels, against the near and far planes and
//! the guard band.

use glam::DVec4;

use super::transform::GUARD_PX;

const PLANES: usize = 6;

fn distance_to(plane: usize, h: DVec4) -> f64 {
    match plane {
        0 => h.w - h.z,
        1 => h.z,
        2 => GUARD_PX * h.w + h.x,
        3 => GUARD_PX * h.w - h.x,
        4 => GUARD_PX * h.w + h.y,
        _ => GUARD_PX * h.w - h.y,
    }
}

/// A cut edge is always cut from its inner end.
fn cut(inner: DVec4, outer: DVec4, plane: usize) -> DVec4 {
    let (a, b) = (distance_to(plane, inner), distance_to(plane, outer));
    inner + (outer - inner) * (a / (a - b))
}

fn cut_polygon(polygon: &[DVec4], plane: usize) -> Vec<DVec4> {
    let mut kept = Vec::with_capacity(polygon.len() + 1);
    for (i, &a) in polygon.iter().enumerate() {
        let b = polygon[(i + 1) % polygon.len()];
        let (a_inside, b_inside) = (distance_to(plane, a) >= 0.0, distance_to(plane, b) >= 0.0);
        if a_inside {
            kept.push(a);
        }
        if a_inside != b_inside {
            kept.push(if a_inside { cut(a, b, plane) } else { cut(b, a, plane) });
        }
    }
    kept
}

/// What is left of a triangle: at most nine corners, or none.
#[must_use]
pub fn clip(triangle: [DVec4; 3]) -> Vec<DVec4> {
    (0..PLANES).fold(triangle.to_vec(), |polygon, plane| cut_polygon(&polygon, plane))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_triangle_inside_is_left_alone() {
        let t = [DVec4::new(1.0, 2.0, 0.1, 1.0), DVec4::new(9.0, 2.0, 0.1, 1.0), DVec4::new(1.0, 8.0, 0.1, 1.0)];
        assert_eq!(clip(t), t);
    }

    #[test]
    fn a_corner_behind_the_camera_leaves_a_quadrilateral_before_it() {
        let t = [DVec4::new(0.0, 0.0, 0.1, -1.0), DVec4::new(9.0, 0.0, 0.1, 1.0), DVec4::new(0.0, 9.0, 0.1, 1.0)];
        let kept = clip(t);
        assert_eq!(kept.len(), 4);
        assert!(kept.iter().all(|h| h.w >= 0.1 - 1e-12));
    }
}
