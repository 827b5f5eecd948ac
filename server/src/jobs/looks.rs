//! Materials and lights of a scene and a request as the renderer takes them.

use std::{collections::HashMap, sync::Arc};

use displace_glsl::layout::raster::{
    MAP_BASE_COLOR, MAP_EMISSIVE, MAP_METALLIC_ROUGHNESS, MAP_NORMAL, MAP_NORMAL_MOMENTS, MAP_OCCLUSION, MAP_SLOTS,
};

use super::{AssetReader, bumps, reliefs};
use crate::domain::{
    Digest, Error, Result,
    bump::Bumps,
    detail::Wrap,
    environment::Environment,
    image::{
        AlphaMode, ColorMap, LightShape, Lighting, Reflector, RenderAlpha, RenderBump, RenderLight, RenderMap,
        RenderMaterial,
    },
    maps::{self, Encoding, SlopeMaps},
    projection::Projection,
    relief::Reliefs,
    report::Warning,
    request::{Look, ReflectionRequest},
    scene::{Material, PunctualKind, PunctualLight, Scene, TextureUse},
};

/// Of all maps together, 16 bytes each.
const MOST_TEXELS: usize = 1 << 27;

/// The UV sets that maps read, TEXCOORD_0 first; a set's place among them is its channel.
pub(super) struct UvSets(Vec<u32>);

impl UvSets {
    pub(super) fn of(materials: &[Material], bumps: &Bumps, reliefs: &Reliefs) -> Self {
        let used = materials.iter().flat_map(|material| textures(material).map(|(_, texture, _)| texture.uv_set));
        let of_bumps = bumps.all().filter_map(|shading| Some(shading.bump.as_ref()?.uv_set));
        let of_reliefs = reliefs.all().map(|relief| relief.uv_set);
        let mut sets: Vec<u32> = used.chain(of_bumps).chain(of_reliefs).chain([0]).collect();
        sets.sort_unstable();
        sets.dedup();
        Self(sets)
    }

    pub(super) fn count(&self) -> u32 {
        self.0.len() as u32
    }

    pub(super) fn semantics(&self) -> impl Iterator<Item = String> {
        self.0.iter().map(|set| format!("TEXCOORD_{set}"))
    }

    pub(super) fn channel(&self, set: u32) -> u32 {
        self.0.iter().position(|known| *known == set).unwrap_or(0) as u32
    }
}

/// The maps of a material: their place among a `RenderMaterial`'s, and what they hold.
fn textures(material: &Material) -> impl Iterator<Item = (usize, &TextureUse, Encoding)> {
    [
        (MAP_BASE_COLOR, &material.base_color, Encoding::Color),
        (MAP_NORMAL, &material.normal, Encoding::Vector),
        (MAP_METALLIC_ROUGHNESS, &material.metallic_roughness, Encoding::Linear),
        (MAP_OCCLUSION, &material.occlusion, Encoding::Linear),
        (MAP_EMISSIVE, &material.emissive, Encoding::Color),
    ]
    .into_iter()
    .filter_map(|(slot, texture, encoding)| texture.as_ref().map(|texture| (slot, texture, encoding)))
}

/// How materials are shown.
#[derive(Clone, Copy)]
pub(super) struct Shown<'r> {
    pub(super) alpha: AlphaMode,
    pub(super) projection: Projection,
    /// Slopes and their products take the place of normals.
    pub(super) moments: bool,
    /// What is shown per pixel, and by how many steps.
    pub(super) reliefs: &'r Reliefs,
    pub(super) steps: u32,
}

/// The scene's materials, then one for primitives without.
pub(super) fn materials(
    scene: &mut Scene,
    sets: &UvSets,
    bumps: &Bumps,
    shown: Shown<'_>,
) -> Result<Vec<RenderMaterial>> {
    let Shown { alpha, projection, moments, reliefs, steps } = shown;
    // Around a sphere a map goes on at its seam, and ends at the poles.
    let wrap = projection.is_sphere().then_some([Wrap::Repeat, Wrap::Clamp]);
    let mut images = Images { decoded: HashMap::new(), slopes: HashMap::new(), texels: 0 };
    let mut materials = Vec::new();
    for material in scene.materials.clone().iter().chain([&Material::default()]) {
        let mut maps: [Option<RenderMap>; MAP_SLOTS] = Default::default();
        for (slot, texture, encoding) in textures(material) {
            maps[slot] = images.read(scene, texture.image, encoding)?.map(|map| RenderMap {
                map,
                // A projection is all the coordinates there are.
                uv_channel: if projection == Projection::Uv { sets.channel(texture.uv_set) } else { 0 },
                map_from_uv: texture.map_from_uv,
                wrap: wrap.unwrap_or(texture.wrap),
            });
        }
        if moments && let (Some(texture), Some(normals)) = (&material.normal, maps[MAP_NORMAL].clone()) {
            let [slopes, moments] = images.slopes(texture.image, &normals)?;
            maps[MAP_NORMAL_MOMENTS] = Some(RenderMap { map: moments, ..normals.clone() });
            maps[MAP_NORMAL] = Some(RenderMap { map: slopes, ..normals });
        }
        materials.push(render_material(material, maps, alpha));
    }
    bumps::give(bumps, sets, &mut materials);
    reliefs::give((reliefs, steps), sets, scene, &mut materials)?;
    Ok(materials)
}

/// What has been decoded; an image that two encodings read is two maps.
struct Images {
    decoded: HashMap<(usize, Encoding), Option<Arc<ColorMap>>>,
    /// Slopes and their moments of normal maps.
    slopes: HashMap<(usize, [Wrap; 2]), [Arc<ColorMap>; 2]>,
    texels: usize,
}

impl Images {
    fn read(&mut self, scene: &mut Scene, image: usize, encoding: Encoding) -> Result<Option<Arc<ColorMap>>> {
        if let Some(known) = self.decoded.get(&(image, encoding)) {
            return Ok(known.clone());
        }
        let map = of_file(scene, image, encoding);
        self.count(map.as_ref().map_or(0, |map| map.texels.len()))?;
        self.decoded.insert((image, encoding), map.clone());
        Ok(map)
    }

    fn slopes(&mut self, image: usize, normals: &RenderMap) -> Result<[Arc<ColorMap>; 2]> {
        let key = (image, normals.wrap);
        if let Some(known) = self.slopes.get(&key) {
            return Ok(known.clone());
        }
        self.count(2 * normals.map.texels.len())?;
        let SlopeMaps { slopes, moments } = SlopeMaps::of_normals(&normals.map, normals.wrap);
        let maps = [slopes, moments].map(Arc::new);
        self.slopes.insert(key, maps.clone());
        Ok(maps)
    }

    fn count(&mut self, texels: usize) -> Result<()> {
        self.texels += texels;
        if self.texels > MOST_TEXELS {
            let message = format!("the materials' maps have more than {MOST_TEXELS} texels: use smaller maps");
            return Err(Error::too_large("images", message));
        }
        Ok(())
    }
}

/// An image of the file; one that cannot be had is left out with a warning, as viewers do.
fn of_file(scene: &mut Scene, image: usize, encoding: Encoding) -> Option<Arc<ColorMap>> {
    let bytes = scene.images.get(image)?.bytes.clone()?;
    match maps::texture_map(&format!("images[{image}]"), &bytes, encoding) {
        Ok(map) => Some(Arc::new(map)),
        Err(error) => {
            scene.warnings.push(Warning::new("image_unreadable", format!("{error}; the factor alone is used")));
            None
        }
    }
}

fn render_material(material: &Material, maps: [Option<RenderMap>; MAP_SLOTS], alpha: AlphaMode) -> RenderMaterial {
    RenderMaterial {
        base_color_factor: material.base_color_factor,
        metallic_factor: material.metallic_factor,
        roughness_factor: material.roughness_factor,
        emissive_factor: material.emissive_factor,
        normal_scale: material.normal_scale,
        occlusion_strength: material.occlusion_strength,
        maps,
        bump: RenderBump::default(),
        relief: None,
        double_sided: material.double_sided,
        alpha: RenderAlpha::new(material.alpha, alpha),
        unlit: material.unlit,
    }
}

pub(super) fn environment(look: &Look, assets: &dyn AssetReader) -> Result<Option<Arc<Environment>>> {
    let decode =
        |digest: &Digest| Ok(Arc::new(Environment::decode_as(&assets.read(digest)?, look.environment_layout)?));
    look.environment.as_ref().map(decode).transpose()
}

/// Which materials mirror what is around them.
pub(super) fn reflectors(look: &Look, scene: &Scene) -> Result<Vec<Reflector>> {
    let find = |(k, request): (usize, &ReflectionRequest)| {
        let known = scene.materials.iter().position(|m| m.name.as_deref() == Some(request.material.as_str()));
        let material = known.ok_or_else(|| {
            let names: Vec<&str> = scene.materials.iter().filter_map(|m| m.name.as_deref()).collect();
            let message = format!("the file has no material '{}'; it has: {}", request.material, names.join(", "));
            Error::invalid(format!("lighting.reflections[{k}].material"), message)
        })?;
        Ok(Reflector { material: material as u32, size_px: request.size_px, in_room: request.in_room })
    };
    look.reflections.iter().enumerate().map(find).collect()
}

/// The request's lights; without any, the file's; without any and without an environment, a sun.
pub(super) fn lighting(look: &Look, scene: &Scene, environment: Option<Arc<Environment>>) -> Lighting {
    let lights = match look.lights.as_slice() {
        [] if !scene.lights.is_empty() => scene.lights.iter().map(punctual).collect(),
        [] if environment.is_none() => Lighting::default().lights,
        lights => lights.to_vec(),
    };
    Lighting { lights, environment, ambient: look.ambient, ..Lighting::default() }
}

fn punctual(light: &PunctualLight) -> RenderLight {
    let (position_world, range_world) = (light.position_world, light.range);
    let shape = match light.kind {
        PunctualKind::Directional => LightShape::Sun { direction_world: light.direction_world.map(|x| -x) },
        PunctualKind::Point => LightShape::Point { position_world, range_world },
        PunctualKind::Spot { inner_cone_radians, outer_cone_radians } => LightShape::Spot {
            position_world,
            range_world,
            direction_world: light.direction_world,
            cone_cosines: [inner_cone_radians.cos(), outer_cone_radians.cos()],
        },
    };
    RenderLight { shape, color: light.color.map(|c| c * light.intensity), radius: 0.0 }
}
