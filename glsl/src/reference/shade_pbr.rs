//! Twin of `shade_pbr`: light by the metallic-roughness model at a place.

use std::f64::consts::FRAC_1_PI;

use glam::{DVec3, DVec4};

use super::{
    appearance::Appearance,
    brdf::{DIELECTRIC_F0, MIN_COSINE, Reflectance, albedo, around, brdf, grazing, visible_normal},
    brdf_table::Table,
    lights::{arriving_of, incoming_of, samples, turn},
    lobe_of_normals::Scatter,
    moments::Spread,
    surroundings::Surroundings,
};
use crate::layout::raster::{Light, MATERIAL_UNLIT};

/// What lights a place, besides its surroundings.
#[derive(Clone, Copy, Debug)]
pub struct Lighting<'a> {
    pub table: &'a Table,
    pub lights: &'a [Light],
    /// What of each light arrives, as `arriving_of` reads it.
    pub shares: &'a [f64],
    /// Radiance of white surroundings.
    pub ambient: f64,
    /// Whether facets pass light on to each other.
    pub multiple_scattering: bool,
}

/// A place of a surface, and where it is seen from.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    pub position: DVec3,
    /// Of the vertices, unit; zero where there is none.
    pub normal: DVec3,
    /// Of the normals that it stands for, around the appearance's.
    pub spread: Spread,
    /// w = 1 a place, w = 0 the direction towards an orthographic camera.
    pub eye: DVec4,
    /// Where on the image it is seen.
    pub pixel: [u32; 2],
}

/// Linear radiance towards the eye, and alpha.
#[must_use]
pub fn radiance(a: &Appearance, place: &Place, lighting: &Lighting<'_>, sky: &Surroundings) -> DVec4 {
    let base = a.base.truncate();
    if a.flags & MATERIAL_UNLIT != 0 {
        return a.base;
    }
    let v = (place.eye.truncate() - place.eye.w * place.position).normalize();
    let n = visible_normal(a.normal, v);
    let surface = Reflectance::new(base, a.metallic, a.roughness);
    let mut color = a.emissive + a.occlusion * from_everywhere(&surface, lighting, sky, [n, v, place.normal]);
    let normals = Scatter::new(n, &place.spread);
    for (l, (light, share)) in lighting.lights.iter().zip(lighting.shares).enumerate() {
        for k in 0..samples(light) {
            let light = incoming_of(light, place.position, k, turn(place.pixel, l as u32));
            let reflected = reflected(&surface, lighting, &normals, v, light.direction);
            color += light.irradiance * reflected * arriving_of(*share, k);
        }
    }
    color.extend(a.base.w)
}

/// Share of light from `l` that leaves towards `v`, per steradian, times its cosine: of all normals.
#[must_use]
pub fn reflected(surface: &Reflectance, lighting: &Lighting<'_>, normals: &Scatter, v: DVec3, l: DVec3) -> DVec3 {
    let (n, multiple) = (normals.n, lighting.multiple_scattering);
    if normals.is_one_normal(surface.alpha) {
        return brdf(surface, lighting.table, n, v, l, multiple) * n.dot(l).max(0.0);
    }
    let cosine = normals.cosine(l);
    let grazed = grazing(v.dot((v + l).normalize()));
    let fresnel = surface.f0 + (DVec3::ONE - surface.f0) * grazed;
    let beside = if multiple {
        around(surface, lighting.table, n.dot(v).clamp(MIN_COSINE, 1.0), cosine.clamp(MIN_COSINE, 1.0))
    } else {
        surface.diffuse * ((1.0 - DIELECTRIC_F0) * (1.0 - grazed) * FRAC_1_PI)
    };
    fresnel * normals.lobe(surface.alpha, v, l) + beside * cosine
}

fn from_everywhere(
    surface: &Reflectance,
    lighting: &Lighting<'_>,
    sky: &Surroundings,
    [n, v, smooth_normal]: [DVec3; 3],
) -> DVec3 {
    let nv = n.dot(v);
    let seen = albedo(surface, lighting.table, nv.clamp(MIN_COSINE, 1.0), lighting.multiple_scattering);
    let share = above_horizon(2.0 * nv * n - v, smooth_normal);
    let facing = (seen.single - seen.grazing) * (sky.facing + lighting.ambient);
    let grazing = seen.grazing * (sky.grazing + lighting.ambient);
    (facing + grazing) * share + seen.around(surface) * (sky.diffuse + lighting.ambient)
}

/// Share of a reflection that leaves the real surface where its normals are bent by a map.
fn above_horizon(mirrored: DVec3, normal: DVec3) -> f64 {
    (1.0 + 1.3 * mirrored.dot(normal)).clamp(0.0, 1.0).powi(2)
}

#[cfg(test)]
mod tests {
    use std::{f64::consts::PI, sync::LazyLock};

    use super::*;

    static TABLE: LazyLock<Table> = LazyLock::new(Table::new);

    fn white(metallic: f64, roughness: f64) -> Appearance {
        let normal = DVec3::Z;
        Appearance { base: DVec4::ONE, emissive: DVec3::ZERO, metallic, normal, roughness, occlusion: 1.0, flags: 0 }
    }

    fn lit(ambient: f64) -> Lighting<'static> {
        Lighting { table: &TABLE, lights: &[], shares: &[], ambient, multiple_scattering: true }
    }

    fn seen_under(cosine: f64) -> Place {
        let eye = DVec4::new((1.0 - cosine * cosine).sqrt(), 0.0, cosine, 0.0);
        Place { position: DVec3::ZERO, normal: DVec3::Z, spread: Spread::default(), eye, pixel: [0; 2] }
    }

    #[test]
    fn white_surfaces_vanish_in_a_white_furnace_whether_it_is_ambient_light_or_an_environment() {
        let furnace = Surroundings { diffuse: DVec3::ONE, facing: DVec3::ONE, grazing: DVec3::ONE };
        for (metallic, roughness) in [(0.0, 0.0), (0.0, 0.4), (0.0, 1.0), (1.0, 0.0), (1.0, 0.4), (1.0, 1.0)] {
            for cosine in [0.001, 0.01, 0.1, 0.5, 0.9, 1.0] {
                let shaded = |ambient: f64, sky: &Surroundings| {
                    radiance(&white(metallic, roughness), &seen_under(cosine), &lit(ambient), sky)
                };
                for found in [shaded(1.0, &Surroundings::default()), shaded(0.0, &furnace)] {
                    // The table goes on as lines beyond its outermost texels.
                    assert!((found - 1.0).abs().max_element() < 1e-9, "{metallic} {roughness} {cosine}: {found}");
                }
            }
        }
    }

    #[test]
    fn a_diffuse_surface_under_a_sun_is_its_share_over_pi() {
        // A black dielectric's highlight is small head on at full roughness; what is left is Lambert's law.
        let sun = [Light { direction: [0.0, 0.0, 1.0], color: [PI as f32; 3], ..Light::default() }];
        let lighting = Lighting { lights: &sun, shares: &[0.5], multiple_scattering: false, ..lit(0.0) };
        let shaded = |base: f64| {
            let a = Appearance { base: DVec3::splat(base).extend(1.0), ..white(0.0, 1.0) };
            radiance(&a, &seen_under(1.0), &lighting, &Surroundings::default()).x
        };
        let sun = f64::from(PI as f32) / PI;
        // F = 0.04, D = 1 / pi, V = 1 / 4.
        assert!((shaded(0.0) - 0.5 * sun * 0.04 / 4.0).abs() < 1e-12);
        assert!((shaded(1.0) - shaded(0.0) - 0.5 * sun * 0.96).abs() < 1e-12);
    }

    #[test]
    fn unlit_surfaces_are_their_colour_and_emissive_ones_shine() {
        let unlit = Appearance { flags: MATERIAL_UNLIT, base: DVec4::new(0.1, 0.2, 0.3, 0.4), ..white(0.0, 0.5) };
        let shaded = |a: &Appearance| radiance(a, &seen_under(0.5), &lit(0.0), &Surroundings::default());
        assert_eq!(shaded(&unlit), unlit.base);
        assert_eq!(
            shaded(&Appearance { emissive: DVec3::splat(3.0), ..white(1.0, 0.2) }),
            DVec4::new(3.0, 3.0, 3.0, 1.0)
        );
    }

    #[test]
    fn reflections_fade_where_a_mapped_normal_sends_them_into_the_surface() {
        let shaded = |normal: DVec3| {
            let a = Appearance { normal: normal.normalize(), ..white(1.0, 0.0) };
            radiance(&a, &seen_under(0.3), &lit(1.0), &Surroundings::default()).x
        };
        assert!((shaded(DVec3::Z) - 1.0).abs() < 1e-12);
        let (bent, far, away) = (DVec3::new(-0.4, 0.0, 1.0), DVec3::new(-1.5, 0.0, 1.0), DVec3::new(-1.0, 0.0, -1.0));
        assert!(shaded(bent) < 0.9 && shaded(far) < shaded(bent));
        assert!(shaded(away).is_finite() && shaded(away) >= 0.0);
    }
}
