//! Twin of `brdf.glsl`: the metallic-roughness model of glTF 2.0, appendix B (GGX: Walter et al. 2007; height-correlated
//! masking: Heitz 2014; Schlick 1994), and light that microfacets pass on to each other (Kulla and Conty 2017).

use std::f64::consts::{FRAC_1_PI, PI};

use glam::DVec3;

use super::brdf_table::Table;

/// Below it the lobe is narrower than f32 directions tell apart with a few digits: roughness 1/32.
pub const MIN_ALPHA: f64 = 1.0 / 1024.0;
/// Of the normal and the direction to the viewer; a normal that faces away is bent back to it.
pub const MIN_COSINE: f64 = 1e-4;
/// Reflectance of dielectrics seen head on: an index of refraction of 1.5.
pub const DIELECTRIC_F0: f64 = 0.04;

/// A surface as the model sees it: a dielectric and a metal, mixed. What facets reflect once is that of mixed f0, since
/// Schlick's Fresnel is linear in it; only the dielectric's keeps light from its matter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reflectance {
    /// Of both, seen head on, 0 to 1.
    pub f0: DVec3,
    /// f0 of the metal.
    pub metal: DVec3,
    /// Its share.
    pub metallic: f64,
    /// Albedo of matter below facets, times the dielectric's share.
    pub diffuse: DVec3,
    /// Perceptual, 0 to 1, no less than `MIN_ALPHA` allows.
    pub roughness: f64,
    /// Width of GGX.
    pub alpha: f64,
}

impl Reflectance {
    #[must_use]
    pub fn new(base: DVec3, metallic: f64, roughness: f64) -> Self {
        let (metallic, roughness) = (metallic.clamp(0.0, 1.0), roughness.clamp(MIN_ALPHA.sqrt(), 1.0));
        let base = base.clamp(DVec3::ZERO, DVec3::ONE);
        Self {
            f0: DVec3::splat(DIELECTRIC_F0).lerp(base, metallic),
            metal: base,
            metallic,
            diffuse: base * (1.0 - metallic),
            roughness,
            alpha: roughness * roughness,
        }
    }
}

/// GGX by the half vector's cosine and squared sine, which keeps its digits where the lobe is narrow.
#[must_use]
pub fn distribution(alpha: f64, cosine: f64, sine_squared: f64) -> f64 {
    let squared = alpha * alpha;
    squared / (PI * (squared * cosine * cosine + sine_squared).powi(2))
}

/// Masking and shadowing over 4 (n.l) (n.v).
#[must_use]
pub fn visibility(alpha: f64, nv: f64, nl: f64) -> f64 {
    let squared = alpha * alpha;
    let lambda = |c: f64| (squared + (1.0 - squared) * c * c).sqrt();
    0.5 / (nl * lambda(nv) + nv * lambda(nl))
}

/// (1 - cosine)^5.
#[must_use]
pub fn grazing(cosine: f64) -> f64 {
    (1.0 - cosine).clamp(0.0, 1.0).powi(5)
}

/// `n` as the viewer in direction `v` can see it: one that faces away is bent until it is seen from the side.
#[must_use]
pub fn visible_normal(n: DVec3, v: DVec3) -> DVec3 {
    let cosine = n.dot(v);
    if cosine >= MIN_COSINE {
        return n;
    }
    let side = n - cosine * v;
    let squared = side.length_squared();
    if squared < 1e-12 { v } else { (side / squared.sqrt() + MIN_COSINE * v).normalize() }
}

/// Shares of light that a surface reflects, seen under one angle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Albedo {
    /// At the first facet met.
    pub single: DVec3,
    /// Of it, what Fresnel adds at grazing angles whatever the surface.
    pub grazing: f64,
    /// After several facets: like diffuse light.
    pub multiple: DVec3,
    /// What a dielectric leaves for the matter below.
    pub below: f64,
}

impl Albedo {
    /// What is weighed by the light of all directions that the surface sees.
    #[must_use]
    pub fn around(&self, surface: &Reflectance) -> DVec3 {
        self.multiple + surface.diffuse * self.below
    }
}

/// Share of light that comes out of facets of one f0 after more than one, of what one facet has not let out.
fn passed_on(f0: f64, lost: f64) -> f64 {
    let mean_fresnel = f0 + (1.0 - f0) / 21.0;
    mean_fresnel * mean_fresnel * (1.0 - lost) / (1.0 - mean_fresnel * lost)
}

fn passed_on_both(surface: &Reflectance, lost: f64) -> DVec3 {
    let metal = surface.metal.map(|f0| passed_on(f0, lost));
    DVec3::splat(passed_on(DIELECTRIC_F0, lost)).lerp(metal, surface.metallic)
}

/// Of light from everywhere. Without `multiple` facets pass nothing on to each other, as appendix B has it.
#[must_use]
pub fn albedo(surface: &Reflectance, table: &Table, nv: f64, multiple: bool) -> Albedo {
    let [scale, bias, grazed] = table.at(surface.roughness, nv);
    let single = surface.f0 * scale + bias;
    if !multiple {
        return Albedo { single, grazing: bias, multiple: DVec3::ZERO, below: (1.0 - DIELECTRIC_F0) * (1.0 - grazed) };
    }
    let [_, _, lost] = table.average(surface.roughness);
    let left = (1.0 - scale - bias).max(0.0);
    let below = 1.0 - (DIELECTRIC_F0 * scale + bias) - passed_on(DIELECTRIC_F0, lost) * left;
    Albedo { single, grazing: bias, multiple: passed_on_both(surface, lost) * left, below }
}

/// Share of light from `l` that leaves towards `v`, per steradian; all unit, `n` as `visible_normal` has it. Black where
/// the light is behind the surface.
#[must_use]
pub fn brdf(surface: &Reflectance, table: &Table, n: DVec3, v: DVec3, l: DVec3, multiple: bool) -> DVec3 {
    let (nv, nl) = (n.dot(v).clamp(MIN_COSINE, 1.0), n.dot(l).min(1.0));
    if nl <= 0.0 {
        return DVec3::ZERO;
    }
    let h = (v + l).normalize();
    let lobe = distribution(surface.alpha, n.dot(h), n.cross(h).length_squared()) * visibility(surface.alpha, nv, nl);
    let grazed = grazing(v.dot(h));
    let fresnel = surface.f0 + (DVec3::ONE - surface.f0) * grazed;
    let single = fresnel * lobe;
    if !multiple {
        return single + surface.diffuse * ((1.0 - DIELECTRIC_F0) * (1.0 - grazed) * FRAC_1_PI);
    }
    single + around(surface, table, nv, nl)
}

/// What facets pass on to each other, and what comes from below them: both fall with what single facets reflect to
/// either side, so that directions can be exchanged.
pub(super) fn around(surface: &Reflectance, table: &Table, nv: f64, nl: f64) -> DVec3 {
    let (seen, lit) = (albedo(surface, table, nv, true), albedo(surface, table, nl, true));
    let [scale, bias, lost] = table.average(surface.roughness);
    // The means over directions of light of `lit.multiple` and `lit.below`.
    let passed = passed_on_both(surface, lost) * lost;
    let below = 1.0 - (DIELECTRIC_F0 * scale + bias) - passed_on(DIELECTRIC_F0, lost) * lost;
    let multiple = seen.multiple * lit.multiple / passed.max(DVec3::splat(1e-12));
    let diffuse = surface.diffuse * (seen.below * lit.below / below.max(1e-12));
    (multiple + diffuse) * FRAC_1_PI
}

#[cfg(test)]
mod tests;
