//! Twin of `appearance`: factors, vertex colours and the values of maps in one (glTF 2.0, 3.9).

use glam::{DVec3, DVec4};

use super::surface::unit_or_zero;
use crate::layout::raster::{
    MAP_BASE_COLOR, MAP_EMISSIVE, MAP_METALLIC_ROUGHNESS, MAP_NORMAL, MAP_OCCLUSION, MAP_SLOTS, MATERIAL_NORMAL_MAP,
    Material,
};

/// As in `appearance.glsl`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Appearance {
    /// Linear base colour and alpha.
    pub base: DVec4,
    /// Linear radiance.
    pub emissive: DVec3,
    pub metallic: f64,
    /// World, unit; zero where there is none.
    pub normal: DVec3,
    /// Perceptual: alpha of GGX is its square.
    pub roughness: f64,
    /// Share of light from everywhere that arrives.
    pub occlusion: f64,
    pub flags: u32,
}

/// The surface under a fragment.
#[derive(Clone, Copy, Debug)]
pub struct Under {
    /// Linear RGBA of the vertices, blended; white without.
    pub color: DVec4,
    /// World, unit, towards the viewer's side.
    pub normal: DVec3,
    /// -1 where the back is seen, 1 elsewhere.
    pub flip: f64,
    /// Tangent in world space, interpolated, of any length, and handedness; w is 0 where there is none.
    pub tangent: DVec4,
    /// Where normal maps are projected, what they say: minus the slope, in the world.
    pub tilt: Option<DVec3>,
}

/// `mapped`: what each map shows there; white where there is none.
#[must_use]
pub fn appearance(m: &Material, under: &Under, mapped: &[DVec4; MAP_SLOTS]) -> Appearance {
    let surface = mapped[MAP_METALLIC_ROUGHNESS];
    let normal = if m.flags & MATERIAL_NORMAL_MAP == 0 {
        under.normal
    } else {
        let scale = f64::from(m.normal_scale);
        match under.tilt {
            Some(tilt) => tilted_normal(under, scale * tilt),
            None => mapped_normal(under, mapped[MAP_NORMAL].truncate() * DVec3::new(scale, scale, 1.0)),
        }
    };
    Appearance {
        base: DVec4::from_array(m.base_color.map(f64::from)) * under.color * mapped[MAP_BASE_COLOR],
        emissive: DVec3::from_array(m.emissive.map(f64::from)) * mapped[MAP_EMISSIVE].truncate(),
        metallic: f64::from(m.metallic) * surface.z,
        normal,
        roughness: f64::from(m.roughness) * surface.y,
        occlusion: 1.0 + f64::from(m.occlusion_strength) * (mapped[MAP_OCCLUSION].x - 1.0),
        flags: m.flags,
    }
}

/// A normal of the tangent frame in the world, as MikkTSpace has it (Mikkelsen 2008): the bitangent is the cross product
/// of normal and tangent, and nothing is made orthogonal.
fn mapped_normal(under: &Under, n: DVec3) -> DVec3 {
    let tangent = unit_or_zero(under.tangent.truncate());
    if tangent == DVec3::ZERO || under.tangent.w == 0.0 {
        return under.normal;
    }
    let front = under.normal * under.flip;
    let bitangent = under.tangent.w.signum() * front.cross(tangent);
    let direction = under.flip * (n.x * tangent + n.y * bitangent + n.z * front);
    if direction.length_squared() > 1e-20 { direction.normalize() } else { under.normal }
}

/// Surface gradients (Mikkelsen 2020): what of the slope lies in the surface turns its normal.
fn tilted_normal(under: &Under, tilt: DVec3) -> DVec3 {
    let front = under.normal * under.flip;
    under.flip * (front + tilt - front * front.dot(tilt)).normalize_or_zero()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn under(handedness: f64, flip: f64) -> Under {
        Under {
            color: DVec4::ONE,
            normal: DVec3::Z * flip,
            flip,
            tangent: DVec4::new(2.0, 0.0, 0.0, handedness),
            tilt: None,
        }
    }

    #[test]
    fn handedness_mirrors_the_bitangent_and_the_back_mirrors_all() {
        let n = DVec3::new(0.6, 0.48, 0.64);
        assert!((mapped_normal(&under(1.0, 1.0), n) - n).length() < 1e-15);
        assert!((mapped_normal(&under(-1.0, 1.0), n) - n * DVec3::new(1.0, -1.0, 1.0)).length() < 1e-15);
        assert!((mapped_normal(&under(1.0, -1.0), n) + n).length() < 1e-15);
    }

    #[test]
    fn a_slope_turns_the_normal_as_the_frame_of_a_map_does() {
        let n = DVec3::new(0.6, 0.48, 0.64);
        for flip in [1.0, -1.0] {
            let framed = mapped_normal(&under(1.0, flip), n);
            let tilted = tilted_normal(&under(1.0, flip), DVec3::new(n.x, n.y, 7.0) / DVec3::new(n.z, n.z, 1.0));
            assert!((framed - tilted).length() < 1e-15, "{framed} {tilted}");
        }
    }

    #[test]
    fn without_a_tangent_the_normal_stays() {
        assert_eq!(mapped_normal(&under(0.0, 1.0), DVec3::X), DVec3::Z);
    }
}
