//! The metallic-roughness model of glTF 2.0, appendix B, and light that facets pass on to each other (Kulla and Conty
//! 2017), towards one viewer.

use std::f64::consts::{FRAC_1_PI, TAU};

use glam::{DMat3, DVec2, DVec3};

use super::{albedo::Albedo, lobe::Lobe};

/// A dielectric's reflectance head on, at an index of refraction of 1.5.
const DIELECTRIC: f64 = 0.04;
/// The definition's least width of GGX, and the least cosine that a normal is seen under.
const LEAST_ALPHA: f64 = 1.0 / 1024.0;
const LEAST_COSINE: f64 = 1e-4;

/// The normal as a viewer in unit direction `v` can see it: one that faces away leans back until it is seen from the
/// side.
pub(super) fn visible(normal: DVec3, v: DVec3) -> DVec3 {
    if normal.dot(v) >= LEAST_COSINE {
        return normal;
    }
    let side = normal.reject_from_normalized(v);
    // Where the normal is the viewer's opposite, or there is none, no side is nearer than another.
    if side.length() < 1e-6 { v } else { (side.normalize() + LEAST_COSINE * v).normalize() }
}

/// A surface under one angle of view.
pub(super) struct Microfacets {
    albedo: &'static Albedo,
    /// Its third axis is the normal, as `visible` has it.
    world_from_frame: DMat3,
    /// Towards the viewer, in the frame.
    view: DVec3,
    /// Seen head on, of facets of metal.
    base: DVec3,
    /// Share of the metal; the rest is a dielectric.
    metallic: f64,
    roughness: f64,
    alpha: f64,
    seen: Shares,
    /// Cosine-weighted means of shares over all angles.
    mean: Shares,
    /// Of samples of light, those that one facet reflects.
    once: f64,
}

/// Of light from everywhere, under one angle.
#[derive(Clone, Copy, Debug)]
struct Shares {
    /// Reflected by one facet.
    once: DVec3,
    /// Reflected by more.
    more: DVec3,
    /// Left for the matter below a dielectric's facets.
    below: f64,
}

impl Microfacets {
    /// `base`: linear, clamped to 1. `roughness`: perceptual. Normal and viewer: unit, in the world.
    pub(super) fn new(base: DVec3, metallic: f64, roughness: f64, normal: DVec3, view: DVec3) -> Self {
        let (base, metallic) = (base.clamp(DVec3::ZERO, DVec3::ONE), metallic.clamp(0.0, 1.0));
        let roughness = roughness.clamp(LEAST_ALPHA.sqrt(), 1.0);
        let normal = visible(normal, view);
        let (tangent, bitangent) = normal.any_orthonormal_pair();
        let world_from_frame = DMat3::from_cols(tangent, bitangent, normal);
        let view = world_from_frame.transpose() * view;
        let none = Shares { once: DVec3::ZERO, more: DVec3::ZERO, below: 1.0 };
        let alpha = roughness * roughness;
        let albedo = Albedo::table();
        let mut surface = Self {
            albedo,
            world_from_frame,
            view,
            base,
            metallic,
            roughness,
            alpha,
            seen: none,
            mean: none,
            once: 1.0,
        };
        surface.mean = surface.shares(albedo.mean(roughness));
        surface.seen = surface.shares(albedo.at(roughness, view.z));
        let [once, around] = [surface.seen.once, surface.around()].map(DVec3::element_sum);
        surface.once = once / (once + around);
        surface
    }

    /// `cell`: of the table. Of what one facet does not let out, others reflect this much: each loses by the mean of
    /// Schlick's formula and keeps in the mean share, again and again.
    fn shares(&self, cell: DVec2) -> Shares {
        let kept_in = 1.0 - self.albedo.mean(self.roughness).element_sum();
        let of = |f0: DVec3| {
            let fresnel = f0 + (1.0 - f0) / 21.0;
            let let_out = fresnel * fresnel * (1.0 - kept_in) / (1.0 - fresnel * kept_in);
            (f0 * cell.x + cell.y, let_out * (1.0 - cell.element_sum()).max(0.0))
        };
        let ((once, more), metal) = (of(DVec3::splat(DIELECTRIC)), of(self.base));
        Shares { once: self.mixed(once, metal.0), more: self.mixed(more, metal.1), below: 1.0 - (once + more).x }
    }

    fn mixed(&self, dielectric: DVec3, metal: DVec3) -> DVec3 {
        (1.0 - self.metallic) * dielectric + self.metallic * metal
    }

    /// Albedo of what lies below facets, by the dielectric's share.
    fn matter(&self) -> DVec3 {
        self.mixed(self.base, DVec3::ZERO)
    }

    /// What is reflected evenly.
    fn around(&self) -> DVec3 {
        self.seen.more + self.matter() * self.seen.below
    }

    /// Share of light that leaves towards the viewer where it comes from everywhere alike.
    pub(super) fn share_of_everywhere(&self) -> DVec3 {
        self.seen.once + self.around()
    }

    /// GGX over facets' normals, by one in the frame.
    fn distribution(&self, facet: DVec3) -> f64 {
        let squared = self.alpha * self.alpha;
        let spread = facet.truncate().length_squared() + squared * facet.z * facet.z;
        squared * FRAC_1_PI / (spread * spread)
    }

    /// The root in Smith's masking.
    fn masked(&self, cosine: f64) -> f64 {
        (self.alpha * self.alpha * (1.0 - cosine * cosine) + cosine * cosine).sqrt()
    }

    /// `light`: in the frame, above the horizon.
    fn by_one_facet(&self, light: DVec3) -> DVec3 {
        let facet = (self.view + light).normalize();
        let visibility = 0.5 / (light.z * self.masked(self.view.z) + self.view.z * self.masked(light.z));
        let grazed = (1.0 - self.view.dot(facet)).max(0.0).powi(5);
        let of = |f0: DVec3| f0 + (1.0 - f0) * grazed;
        let fresnel = self.mixed(of(DVec3::splat(DIELECTRIC)), of(self.base));
        fresnel * self.distribution(facet) * visibility
    }

    /// Both fall with what one facet reflects to either side, so that directions can be exchanged.
    fn by_the_rest(&self, cosine: f64) -> DVec3 {
        let lit = self.shares(self.albedo.at(self.roughness, cosine));
        let more = self.seen.more * lit.more / self.mean.more.max(DVec3::splat(1e-12));
        let below = self.seen.below * lit.below / self.mean.below.max(1e-12);
        FRAC_1_PI * (more + self.matter() * below)
    }

    /// A facet's normal as the viewer sees them (Heitz 2018).
    fn facet(&self, [u, v]: [f64; 2]) -> DVec3 {
        let stretched = DVec3::new(self.alpha * self.view.x, self.alpha * self.view.y, self.view.z).normalize();
        let (across, along) = if stretched.z > 1.0 - 1e-12 {
            (DVec3::X, DVec3::Y)
        } else {
            let across = DVec3::new(-stretched.y, stretched.x, 0.0).normalize();
            (across, stretched.cross(across))
        };
        let (sine, cosine) = (TAU * v).sin_cos();
        let x = u.sqrt() * cosine;
        let half = 0.5 * (1.0 + stretched.z);
        let y = (1.0 - half) * (1.0 - x * x).max(0.0).sqrt() + half * u.sqrt() * sine;
        let facet = x * across + y * along + (1.0 - x * x - y * y).max(0.0).sqrt() * stretched;
        DVec3::new(self.alpha * facet.x, self.alpha * facet.y, facet.z.max(0.0)).normalize()
    }
}

impl Lobe for Microfacets {
    fn value(&self, light: DVec3) -> DVec3 {
        let light = self.world_from_frame.transpose() * light;
        if light.z <= 0.0 {
            return DVec3::ZERO;
        }
        light.z * (self.by_one_facet(light) + self.by_the_rest(light.z.min(1.0)))
    }

    /// Off a facet, or by the cosine, as often as light is reflected so.
    fn sample(&self, [u, v]: [f64; 2]) -> DVec3 {
        let light = if u < self.once {
            let facet = self.facet([u / self.once, v]);
            2.0 * self.view.dot(facet) * facet - self.view
        } else {
            by_cosine([(u - self.once) / (1.0 - self.once), v])
        };
        self.world_from_frame * light
    }

    fn density(&self, light: DVec3) -> f64 {
        let light = self.world_from_frame.transpose() * light;
        let facet = (self.view + light).normalize();
        let off_facet = 0.5 * self.distribution(facet) / (self.view.z + self.masked(self.view.z));
        self.once * off_facet + (1.0 - self.once) * light.z.max(0.0) * FRAC_1_PI
    }
}

/// A unit direction around +z, as densely as its cosine over pi.
pub(super) fn by_cosine([u, v]: [f64; 2]) -> DVec3 {
    let (sine, cosine) = (TAU * v).sin_cos();
    DVec3::new(u.sqrt() * cosine, u.sqrt() * sine, (1.0 - u).max(0.0).sqrt())
}

#[cfg(test)]
mod tests;
