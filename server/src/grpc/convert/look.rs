//! Light, and how it becomes colour.

use displace_proto::v1;

use super::{at_most, digest, join, known, relief, vector, within};
use crate::domain::{
    Error, Result,
    environment::EnvironmentLayout,
    image::{AlphaMode, Filter, LightShape, RenderLight, Shading},
    projection::Projection,
    request::{Look, LookMaps, ReflectionRequest, Shadows},
};

/// Where no environment lights the scene.
const DEFAULT_AMBIENT: f32 = 0.2;
const MOST_LIGHTS: usize = 16;
const MOST_REFLECTIONS: usize = 8;
/// Of each image of a reflector's surroundings.
const REFLECTION_PX: u32 = 256;
const MOST_BOUNCES: u32 = 16;

pub(super) fn parse(path: &str, lighting: Option<v1::Lighting>) -> Result<Look> {
    let mut lighting = lighting.unwrap_or_default();
    let environment = lighting.environment.take();
    let reflections = reflections(&join(path, "reflections"), std::mem::take(&mut lighting.reflections))?;
    let bounces = at_most(&join(path, "bounces"), lighting.bounces, 0, MOST_BOUNCES)?;
    let layout = layout(&join(path, "environment_layout"), lighting.environment_layout, environment.is_some())?;
    let ambient = if environment.is_some() { 0.0 } else { DEFAULT_AMBIENT };
    let shading = shading(&join(path, "shading"), lighting.shading)?;
    Ok(Look {
        lights: lights(&join(path, "lights"), lighting.lights)?,
        ambient: within(&join(path, "ambient"), lighting.ambient.unwrap_or(ambient), 0.0, 1.0)?,
        environment: environment.map(|asset| digest(&join(path, "environment"), Some(&asset))).transpose()?,
        environment_layout: layout,
        reflections,
        bounces,
        relief: relief::parse(&join(path, "relief"), lighting.relief)?,
        shadows: match known::<v1::Shadows>(&join(path, "shadows"), lighting.shadows)? {
            v1::Shadows::Unspecified | v1::Shadows::None => Shadows::None,
            v1::Shadows::Ray => Shadows::Ray,
            v1::Shadows::Map => Shadows::Map,
        },
        shading,
        moments: moments(&join(path, "moments"), lighting.moments, shading)?,
        filter: match known::<v1::Filter>(&join(path, "filter"), lighting.filter)? {
            v1::Filter::Nearest => Filter::Nearest,
            v1::Filter::Bilinear => Filter::Bilinear,
            v1::Filter::Unspecified | v1::Filter::Trilinear => Filter::Trilinear,
            v1::Filter::Anisotropic => Filter::Anisotropic,
            v1::Filter::Ewa => Filter::Ewa,
        },
        alpha: match known::<v1::AlphaMode>(&join(path, "alpha"), lighting.alpha)? {
            v1::AlphaMode::Mask => AlphaMode::Mask,
            v1::AlphaMode::Unspecified | v1::AlphaMode::Blend => AlphaMode::Blend,
            v1::AlphaMode::Stochastic => AlphaMode::Stochastic,
        },
    })
}

fn layout(path: &str, layout: i32, has_environment: bool) -> Result<EnvironmentLayout> {
    let layout = match known::<v1::EnvironmentLayout>(path, layout)? {
        v1::EnvironmentLayout::Unspecified | v1::EnvironmentLayout::Equirect => EnvironmentLayout::Equirect,
        v1::EnvironmentLayout::Cube => EnvironmentLayout::Cube,
        v1::EnvironmentLayout::Sphere => EnvironmentLayout::Sphere,
    };
    if !has_environment && layout != EnvironmentLayout::Equirect {
        return Err(Error::invalid(path, "says how an environment is laid out, and there is none: give one (--env)"));
    }
    Ok(layout)
}

fn shading(path: &str, shading: i32) -> Result<Shading> {
    Ok(match known::<v1::Shading>(path, shading)? {
        v1::Shading::Flat => Shading::Flat,
        v1::Shading::Gouraud => Shading::Gouraud,
        v1::Shading::Unspecified | v1::Shading::Phong => Shading::Phong,
        v1::Shading::Pbr => Shading::Pbr,
    })
}

/// Phong's model has no roughness that normals could add to.
fn moments(path: &str, moments: i32, shading: Shading) -> Result<bool> {
    let is_on = known::<v1::Moments>(path, moments)? == v1::Moments::On;
    if is_on && shading != Shading::Pbr {
        let message = "is on, which the metallic-roughness model alone shows; take --shading pbr, or leave it off";
        return Err(Error::unsupported(path, message));
    }
    Ok(is_on)
}

/// What the maps of materials are, and where they are read.
pub(super) fn maps(path: &str, look: Option<v1::Look>) -> Result<LookMaps> {
    let look = look.unwrap_or_default();
    let map =
        |name: &str, asset: Option<v1::Digest>| asset.map(|asset| digest(&join(path, name), Some(&asset))).transpose();
    Ok(LookMaps {
        base_color: map("base_color", look.base_color)?,
        metallic_roughness: map("metallic_roughness", look.metallic_roughness)?,
        occlusion: map("occlusion", look.occlusion)?,
        emissive: map("emissive", look.emissive)?,
        opacity: map("opacity", look.opacity)?,
        projection: match known::<v1::Projection>(&join(path, "projection"), look.projection)? {
            v1::Projection::Unspecified | v1::Projection::Uv => Projection::Uv,
            v1::Projection::Sphere => Projection::Sphere,
            v1::Projection::SphereAsPrinted => Projection::SphereAsPrinted,
            v1::Projection::PlanarX => Projection::PlanarX,
            v1::Projection::PlanarY => Projection::PlanarY,
            v1::Projection::PlanarZ => Projection::PlanarZ,
            v1::Projection::Box => Projection::Box,
            v1::Projection::Triplanar => Projection::Triplanar,
        },
    })
}

fn reflections(path: &str, reflections: Vec<v1::Reflection>) -> Result<Vec<ReflectionRequest>> {
    if reflections.len() > MOST_REFLECTIONS {
        let message =
            format!("has {} entries; allowed are up to {MOST_REFLECTIONS}: leave some out", reflections.len());
        return Err(Error::invalid(path, message));
    }
    let parse = |(k, one): (usize, &v1::Reflection)| {
        let path = format!("{path}[{k}]");
        let is_new = reflections[..k].iter().all(|other| other.material != one.material);
        if one.material.is_empty() || !is_new {
            let message = match one.material.as_str() {
                "" => "is empty: name a material of the file".to_owned(),
                name => format!("'{name}' is named by an entry before it, too: leave one out"),
            };
            return Err(Error::invalid(join(&path, "material"), message));
        }
        let size_px = if one.size == 0 { REFLECTION_PX } else { at_most(&join(&path, "size"), one.size, 16, 1024)? };
        Ok(ReflectionRequest { material: one.material.clone(), size_px, in_room: one.r#box })
    };
    reflections.iter().enumerate().map(parse).collect()
}

fn lights(path: &str, lights: Vec<v1::Light>) -> Result<Vec<RenderLight>> {
    if lights.len() > MOST_LIGHTS {
        let message = format!("has {} entries; allowed are up to {MOST_LIGHTS}: leave some out", lights.len());
        return Err(Error::invalid(path, message));
    }
    lights.into_iter().enumerate().map(|(k, one)| light(&format!("{path}[{k}]"), one)).collect()
}

fn light(path: &str, light: v1::Light) -> Result<RenderLight> {
    use v1::light::Shape;
    let (shape, radius) = match light.shape {
        Some(Shape::Sun(sun)) => {
            let field = join(path, "sun.direction");
            let direction_world = unit(&field, vector(&field, &sun.direction)?)?;
            let degrees =
                within(&join(path, "sun.angular_diameter_degrees"), sun.angular_diameter_degrees, 0.0, 170.0)?;
            (LightShape::Sun { direction_world }, (0.5 * f64::from(degrees)).to_radians().sin() as f32)
        }
        Some(Shape::Point(point)) => {
            let position_world = vector(&join(path, "point.position"), &point.position)?;
            let radius = within(&join(path, "point.radius"), point.radius, 0.0, 1e6)?;
            (LightShape::Point { position_world, range_world: None }, radius)
        }
        None => return Err(Error::invalid(path, "has no shape; give a sun or a point")),
    };
    let intensity = within(&join(path, "intensity"), light.intensity.unwrap_or(1.0), 0.0, 1e6)?;
    Ok(RenderLight { shape, color: [std::f32::consts::PI * intensity; 3], radius })
}

/// In f64, so that neither huge nor tiny vectors lose their direction.
fn unit(field: &str, vector: [f32; 3]) -> Result<[f32; 3]> {
    let length = vector.iter().map(|value| f64::from(*value).powi(2)).sum::<f64>().sqrt();
    if length == 0.0 {
        return Err(Error::invalid(field, "has no length; give the direction towards the light"));
    }
    Ok(vector.map(|value| (f64::from(value) / length) as f32))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_are_off_unless_asked_for_and_refused_where_no_roughness_shows_them() {
        let parsed = |shading: v1::Shading, moments: v1::Moments| {
            let asked = v1::Lighting { shading: shading.into(), moments: moments.into(), ..v1::Lighting::default() };
            parse("lighting", Some(asked)).map(|look| look.moments)
        };
        assert!(parsed(v1::Shading::Pbr, v1::Moments::On).is_ok_and(|is_on| is_on));
        for moments in [v1::Moments::Unspecified, v1::Moments::Off] {
            assert!(parsed(v1::Shading::Phong, moments).is_ok_and(|is_on| !is_on));
        }
        for shading in [v1::Shading::Unspecified, v1::Shading::Flat, v1::Shading::Gouraud, v1::Shading::Phong] {
            let error = parsed(shading, v1::Moments::On).expect_err("is refused").to_string();
            assert!(error.contains("lighting.moments") && error.contains("--shading pbr"), "{error}");
        }
    }
}
