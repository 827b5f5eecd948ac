//! Requests from options: hashes the files that are named and fills in the messages of the API.

mod geometry;
mod relief;
mod sequence;

use std::path::{Path, PathBuf};

use displace_proto::v1::{self, layer, view};

use crate::{
    args::{
        AlphaArg, AovArg, CameraArgs, ChannelArg, CompressArg, FilterArg, LayoutArg, LightArg, LightArgs, LookArgs,
        MethodArg, MomentsArg, PresetArg, ProjectionArg, SamplingArg, ShadingArg, ShadowsArg, SpaceArg, WrapArg,
        values::Swizzle,
    },
    error::{Error, Result},
    mesh_files::{self, MeshFiles},
    options::{Layer, MaterialGroup, Modifiers, Source},
    transfer::Blob,
};

pub(crate) use geometry::{base, geometry, seams};
pub(crate) use relief::relief;
pub(crate) use sequence::sequence;

/// Blobs to upload, gathered while a request is made.
#[derive(Debug, Default)]
pub(crate) struct Parcel {
    pub(crate) blobs: Vec<Blob>,
    /// What the user should know of conversions.
    pub(crate) notes: Vec<String>,
}

impl Parcel {
    /// Adds a mesh and what it refers to. Blocks.
    pub(crate) fn mesh(&mut self, path: &Path) -> Result<v1::MeshSource> {
        let MeshFiles { mesh, resources, notes } = mesh_files::read(path)?;
        self.notes.extend(notes);
        let asset = Some(self.add(mesh));
        let resources =
            resources.into_iter().map(|(uri, blob)| v1::Resource { uri, asset: Some(self.add(blob)) }).collect();
        Ok(v1::MeshSource { asset, resources })
    }

    /// Adds a file as it is. Blocks.
    pub(crate) fn file(&mut self, path: &Path) -> Result<v1::Digest> {
        Ok(self.add(Blob::of_file(path)?))
    }

    fn add(&mut self, blob: Blob) -> v1::Digest {
        let digest = blob.digest.clone();
        self.blobs.push(blob);
        digest
    }

    fn map_file(&mut self, flag: &str, path: &Path) -> Result<v1::Digest> {
        let blob = Blob::of_file(path)
            .map_err(|e| Error { message: format!("{}: {}", path.display(), e.message), ..e }.with_field(flag))?;
        Ok(self.add(blob))
    }

    pub(crate) fn details(&mut self, groups: &[MaterialGroup]) -> Result<Vec<v1::MaterialDetail>> {
        groups.iter().map(|group| self.detail(group)).collect()
    }

    fn detail(&mut self, group: &MaterialGroup) -> Result<v1::MaterialDetail> {
        let layers = group.layers.iter().map(|layer| self.layer(layer)).collect::<Result<_>>()?;
        Ok(v1::MaterialDetail { material: group.material.clone().unwrap_or_default(), layers, uv_set: group.uv_set })
    }

    fn layer(&mut self, layer: &Layer) -> Result<v1::Layer> {
        let modifiers = &layer.modifiers;
        Ok(v1::Layer {
            source: Some(self.source(&layer.source, modifiers)?),
            scale: modifiers.scale,
            midlevel: modifiers.midlevel,
            invert_height: modifiers.invert_height.unwrap_or_default(),
            flip_v: modifiers.flip_v.unwrap_or_default(),
            preset: match modifiers.preset {
                None => v1::Preset::Unspecified,
                Some(PresetArg::AsPrinted) => v1::Preset::AsPrinted,
                Some(PresetArg::Cyslice) => v1::Preset::Cyslice,
            }
            .into(),
        })
    }

    fn source(&mut self, source: &Source, modifiers: &Modifiers) -> Result<layer::Source> {
        let space = space(modifiers.space).into();
        let swizzle = modifiers.swizzle.map(swizzle_text).unwrap_or_default();
        Ok(match source {
            Source::Height(path) => layer::Source::Height(v1::HeightMap {
                map: Some(self.map("--height", path, modifiers)?),
                channel: channel(modifiers.channel).into(),
            }),
            Source::Vector(path) => layer::Source::Vector(v1::VectorMap {
                map: Some(self.map("--vector", path, modifiers)?),
                space,
                swizzle,
            }),
            Source::DirectionMagnitude { direction, magnitude } => layer::Source::Direction(v1::DirectionMap {
                direction: Some(self.map("--direction", direction, modifiers)?),
                magnitude: Some(self.map("--magnitude", magnitude, modifiers)?),
                space,
                swizzle,
            }),
            Source::Normal(path) => layer::Source::Normal(v1::SurfaceNormalMap {
                map: Some(self.map("--normal", path, modifiers)?),
                space,
                swizzle,
                flip_green: modifiers.flip_green.unwrap_or_default(),
                exact_zero: modifiers.exact_zero.unwrap_or_default(),
            }),
            Source::Expression(source) => layer::Source::Expression(v1::Expression { source: source.clone() }),
        })
    }

    fn map(&mut self, flag: &str, path: &Path, modifiers: &Modifiers) -> Result<v1::MapSource> {
        Ok(v1::MapSource {
            asset: Some(self.map_file(flag, path)?),
            wrap: wrap(modifiers.wrap).into(),
            sampling: sampling(modifiers.sampling).into(),
        })
    }

    pub(crate) fn environment(&mut self, path: &Path) -> Result<v1::Digest> {
        self.map_file("--env", path)
    }

    pub(crate) fn look(&mut self, look: &LookArgs) -> Result<Option<v1::Look>> {
        let mut map =
            |flag: &str, path: &Option<PathBuf>| path.as_ref().map(|path| self.map_file(flag, path)).transpose();
        let message = v1::Look {
            base_color: map("--base-color", &look.base_color)?,
            metallic_roughness: map("--metallic-roughness", &look.metallic_roughness)?,
            occlusion: map("--occlusion", &look.occlusion)?,
            emissive: map("--emissive", &look.emissive)?,
            opacity: map("--opacity", &look.opacity)?,
            projection: projection(look.projection).into(),
        };
        Ok((message != v1::Look::default()).then_some(message))
    }
}

fn projection(projection: ProjectionArg) -> v1::Projection {
    match projection {
        ProjectionArg::Uv => v1::Projection::Unspecified,
        ProjectionArg::Sphere => v1::Projection::Sphere,
        ProjectionArg::SphereAsPrinted => v1::Projection::SphereAsPrinted,
        ProjectionArg::PlanarX => v1::Projection::PlanarX,
        ProjectionArg::PlanarY => v1::Projection::PlanarY,
        ProjectionArg::PlanarZ => v1::Projection::PlanarZ,
        ProjectionArg::Box => v1::Projection::Box,
        ProjectionArg::Triplanar => v1::Projection::Triplanar,
    }
}

fn space(space: Option<SpaceArg>) -> v1::Space {
    match space {
        None => v1::Space::Unspecified,
        Some(SpaceArg::Tangent) => v1::Space::Tangent,
        Some(SpaceArg::Object) => v1::Space::Object,
    }
}

fn channel(channel: Option<ChannelArg>) -> v1::Channel {
    match channel {
        None => v1::Channel::Unspecified,
        Some(ChannelArg::R) => v1::Channel::R,
        Some(ChannelArg::G) => v1::Channel::G,
        Some(ChannelArg::B) => v1::Channel::B,
        Some(ChannelArg::A) => v1::Channel::A,
    }
}

fn wrap(wrap: Option<WrapArg>) -> v1::Wrap {
    match wrap {
        None => v1::Wrap::Unspecified,
        Some(WrapArg::Repeat) => v1::Wrap::Repeat,
        Some(WrapArg::Mirror) => v1::Wrap::Mirror,
        Some(WrapArg::Clamp) => v1::Wrap::Clamp,
    }
}

fn sampling(sampling: Option<SamplingArg>) -> v1::Sampling {
    match sampling {
        None => v1::Sampling::Unspecified,
        Some(SamplingArg::Center) => v1::Sampling::Center,
        Some(SamplingArg::Node) => v1::Sampling::Node,
    }
}

fn swizzle_text(swizzle: Swizzle) -> String {
    let letter = |(source, negative): (u8, bool)| {
        let letter = ['r', 'g', 'b'][usize::from(source)];
        if negative { letter.to_ascii_uppercase() } else { letter }
    };
    swizzle.0.map(letter).iter().collect()
}

pub(crate) fn compression(compress: CompressArg) -> v1::Compression {
    match compress {
        CompressArg::None => v1::Compression::None,
        CompressArg::Quantize => v1::Compression::Quantize,
        CompressArg::Meshopt => v1::Compression::Meshopt,
    }
}

pub(crate) fn method(method: MethodArg) -> v1::Method {
    match method {
        MethodArg::Flat => v1::Method::Flat,
        MethodArg::Displacement => v1::Method::Displacement,
        MethodArg::Vector => v1::Method::Vector,
        MethodArg::Bump => v1::Method::Bump,
        MethodArg::Normal => v1::Method::Normal,
        MethodArg::Parallax => v1::Method::Parallax,
        MethodArg::ParallaxLimited => v1::Method::ParallaxLimited,
        MethodArg::ParallaxIterative => v1::Method::ParallaxIterative,
        MethodArg::Steep => v1::Method::Steep,
        MethodArg::Occlusion => v1::Method::Occlusion,
        MethodArg::Relief => v1::Method::Relief,
        MethodArg::Cone => v1::Method::Cone,
        MethodArg::Exact => v1::Method::Exact,
        MethodArg::Auto => v1::Method::Auto,
    }
}

pub(crate) fn view(args: &CameraArgs) -> v1::View {
    let camera = match (&args.camera, args.eye.zip(args.look_at), args.orbit) {
        (Some(name), ..) => Some(view::Camera::Named(name.clone())),
        (None, Some((eye, target)), _) => Some(view::Camera::LookAt(v1::LookAt {
            eye: eye.to_vec(),
            target: target.to_vec(),
            yfov_degrees: args.fov,
        })),
        (None, None, Some(orbit)) => Some(view::Camera::Orbit(v1::Orbit {
            azimuth_degrees: orbit.azimuth_degrees,
            elevation_degrees: orbit.elevation_degrees,
            distance: orbit.distance,
            yfov_degrees: args.fov,
        })),
        (None, None, None) => None,
    };
    v1::View { camera, width: args.size.width, height: args.size.height }
}

pub(crate) fn lighting(look: &LookArgs, args: &LightArgs, environment: Option<v1::Digest>) -> v1::Lighting {
    let shadows = match args.shadows {
        ShadowsArg::None => v1::Shadows::None,
        ShadowsArg::Ray => v1::Shadows::Ray,
        ShadowsArg::Map => v1::Shadows::Map,
    };
    let shading = match args.shading {
        ShadingArg::Flat => v1::Shading::Flat,
        ShadingArg::Gouraud => v1::Shading::Gouraud,
        ShadingArg::Phong => v1::Shading::Phong,
        ShadingArg::Pbr => v1::Shading::Pbr,
    };
    let filter = match args.filter {
        FilterArg::Nearest => v1::Filter::Nearest,
        FilterArg::Bilinear => v1::Filter::Bilinear,
        FilterArg::Trilinear => v1::Filter::Trilinear,
        FilterArg::Anisotropic => v1::Filter::Anisotropic,
        FilterArg::Ewa => v1::Filter::Ewa,
    };
    let alpha = match args.alpha {
        AlphaArg::Mask => v1::AlphaMode::Mask,
        AlphaArg::Blend => v1::AlphaMode::Blend,
        AlphaArg::Stochastic => v1::AlphaMode::Stochastic,
    };
    let moments = match args.moments {
        MomentsArg::Off => v1::Moments::Off,
        MomentsArg::On => v1::Moments::On,
    };
    let environment_layout = match args.env_layout {
        LayoutArg::Equirect => v1::EnvironmentLayout::Equirect,
        LayoutArg::Cube => v1::EnvironmentLayout::Cube,
        LayoutArg::Sphere => v1::EnvironmentLayout::Sphere,
    };
    let reflection = |material: &String| v1::Reflection {
        material: material.clone(),
        size: args.reflect_size,
        r#box: args.reflect_box,
    };
    v1::Lighting {
        lights: look.light.iter().map(light).collect(),
        ambient: look.ambient,
        shadows: shadows.into(),
        shading: shading.into(),
        filter: filter.into(),
        environment,
        alpha: alpha.into(),
        moments: moments.into(),
        environment_layout: environment_layout.into(),
        reflections: args.reflect.iter().map(reflection).collect(),
        bounces: args.bounces,
        relief: None,
    }
}

fn light(light: &LightArg) -> v1::Light {
    use v1::light::Shape;
    let shape = match light {
        LightArg::Sun(direction, angular_diameter_degrees) => {
            Shape::Sun(v1::Sun { direction: direction.to_vec(), angular_diameter_degrees: *angular_diameter_degrees })
        }
        LightArg::Point(position, radius) => {
            Shape::Point(v1::PointLight { position: position.to_vec(), radius: *radius })
        }
    };
    v1::Light { shape: Some(shape), intensity: None }
}

pub(crate) fn aov(aov: AovArg) -> v1::Aov {
    match aov {
        AovArg::Depth => v1::Aov::Depth,
        AovArg::Normal => v1::Aov::Normal,
        AovArg::Position => v1::Aov::Position,
        AovArg::Uv => v1::Aov::Uv,
        AovArg::Triangle => v1::Aov::Triangle,
        AovArg::Overdraw => v1::Aov::Overdraw,
        AovArg::Samples => v1::Aov::Samples,
        AovArg::Cost => v1::Aov::Cost,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_swizzle_travels_as_it_was_typed() {
        for text in ["rgb", "rGb", "BGR"] {
            assert_eq!(crate::args::values::swizzle(text).map(swizzle_text).as_deref(), Ok(text));
        }
    }

    #[test]
    fn a_missing_map_is_told_with_its_flag() {
        let error = Parcel::default().map_file("--height", Path::new("none.png")).unwrap_err();
        assert_eq!(error.field.as_deref(), Some("--height"));
        assert!(error.message.contains("none.png") && error.message.contains("no such file"), "{error}");
    }
}
