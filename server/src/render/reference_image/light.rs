//! Light of a place by the model that the scene asks for: the twins put together.

use displace_glsl::{
    layout::raster::{LIGHT_SUN, Light, MATERIAL_UNLIT},
    reference::{
        backdrop::{Directions, backdrop},
        brdf::visible_normal,
        brdf_table::Table,
        environment::Environment,
        lights::{Incoming, arriving_of, distance, incoming, incoming_of, samples, turn},
        shade_pbr,
        shade_phong::{Reflected, from_surroundings, reflected},
        shadow_map::ShadowMaps,
        shadow_rays::Ray,
        surroundings::{Around, Change, Room, Surroundings, mirrored_footprint, seen, seen_by_normals},
    },
};
use glam::{DVec3, DVec4};

use super::{
    place::{blend, vec3},
    relief,
    shading::Hit,
    shadow_map,
};
use crate::{
    domain::{
        self, Result,
        image::{ImagePlan, REFLECTIVITY, RenderScene, Shading},
        request::Shadows,
    },
    render::{
        image::{light::directions, shading::eye_and_depth, tables::Tables},
        occluders::Shade,
        reflection::Reflection,
    },
};

pub(super) struct LightModel {
    shade: Option<Shade>,
    shadow_maps: Option<ShadowMaps>,
    environment: Option<Environment>,
    /// By material.
    reflections: Vec<(u32, Environment, Option<Room>)>,
    /// What surfaces reflect, where the shading needs it.
    table: Option<Table>,
    shading: Shading,
    ambient: f64,
    background: DVec3,
    directions: Directions,
    eye: DVec4,
    view_depth: DVec4,
}

impl LightModel {
    /// `reflections`: what reflectors see.
    pub(super) fn new(
        plan: &ImagePlan,
        scene: &RenderScene,
        tables: &Tables,
        reflections: &[Reflection],
    ) -> Result<Self> {
        let (eye, view_depth) = eye_and_depth(&scene.camera);
        let [eye, view_depth] = [eye, view_depth].map(|v| DVec4::from_array(v.map(f64::from)));
        let is_shaded = scene.shadows == Shadows::Ray && !tables.lights.is_empty();
        let shading = scene.shading;
        Ok(Self {
            shade: if is_shaded { Some(Shade::new(scene, tables)?) } else { None },
            shadow_maps: shadow_map::made(scene)?,
            environment: scene.lighting.environment.as_ref().map(|map| environment(map)),
            reflections: reflections.iter().map(|r| (r.material, environment(&r.environment), r.room)).collect(),
            table: (shading == Shading::Pbr).then(Table::new),
            shading,
            ambient: f64::from(scene.lighting.ambient),
            background: vec3(scene.lighting.background),
            directions: directions(&scene.camera, plan),
            eye,
            view_depth,
        })
    }

    pub(super) fn depth(&self, position: DVec3) -> f64 {
        self.view_depth.dot(position.extend(1.0))
    }

    /// What is behind pixel (x, y).
    pub(super) fn backdrop(&self, x: u32, y: u32) -> DVec3 {
        self.environment.as_ref().map_or(self.background, |environment| backdrop(environment, &self.directions, x, y))
    }

    /// `is_opaque` gets a triangle's number over all instances, weights of its corners, and along which direction a ray meets it.
    pub(super) fn radiance(&self, lights: &[Light], hit: &Hit, is_opaque: impl Fn(u32, DVec3, DVec3) -> bool) -> DVec3 {
        if hit.look.flags & MATERIAL_UNLIT != 0 {
            return hit.look.base.truncate();
        }
        let share = |(l, light)| self.share(l, light, hit, &is_opaque);
        let shares: Vec<f64> = lights.iter().enumerate().map(share).collect();
        let sky = self.around(hit).map(|around| self.sky(around, hit));
        match &self.table {
            Some(table) => {
                let place = shade_pbr::Place {
                    position: hit.position,
                    normal: hit.normal,
                    spread: hit.spread.unwrap_or_default(),
                    eye: self.eye,
                    pixel: hit.pixel,
                };
                let (shares, ambient) = (shares.as_slice(), self.ambient);
                let lighting = shade_pbr::Lighting { table, lights, shares, ambient, multiple_scattering: true };
                shade_pbr::radiance(&hit.look, &place, &lighting, &sky.unwrap_or_default()).truncate()
            }
            None => self.by_phong(lights, &shares, hit, sky.as_ref()),
        }
    }

    fn by_phong(&self, lights: &[Light], shares: &[f64], hit: &Hit, sky: Option<&Surroundings>) -> DVec3 {
        let (look, base) = (&hit.look, hit.look.base.truncate());
        let sample = |l: usize, k: u32| {
            let turn = turn(hit.pixel, l as u32);
            let at = |position: DVec3| incoming_of(&lights[l], position, k, turn);
            self.reflected(at, hit).of(base) * arriving_of(shares[l], k)
        };
        let of_light = |l: usize| (0..samples(&lights[l])).map(|k| sample(l, k)).sum::<DVec3>();
        let direct: DVec3 = (0..lights.len()).map(of_light).sum();
        let around = |sky: &Surroundings| from_surroundings(sky, base, look.occlusion, REFLECTIVITY.into());
        base * (self.ambient * look.occlusion) + look.emissive + direct + sky.map_or(DVec3::ZERO, around)
    }

    /// `arriving`: at a place.
    fn reflected(&self, arriving: impl Fn(DVec3) -> Incoming, hit: &Hit) -> Reflected {
        match self.shading {
            Shading::Flat => {
                let centre = blend(DVec3::splat(1.0 / 3.0), hit.corners.map(|corner| corner.0));
                reflected(&arriving(centre), centre, hit.facing, self.eye)
            }
            Shading::Gouraud => {
                let corner = |(position, normal)| reflected(&arriving(position), position, normal, self.eye);
                let corners = hit.corners.map(corner);
                Reflected::blended(corners, hit.weights)
            }
            Shading::Phong | Shading::Pbr => {
                reflected(&arriving(hit.position), hit.position, hit.look.normal, self.eye)
            }
        }
    }

    /// What a place sees.
    fn around(&self, hit: &Hit) -> Option<Around<'_>> {
        let own = self.reflections.iter().find(|(material, ..)| *material == hit.material);
        let own = own.map(|(_, environment, room)| Around { environment, room: *room });
        own.or_else(|| self.environment.as_ref().map(|environment| Around { environment, room: None }))
    }

    fn sky(&self, around: Around<'_>, hit: &Hit) -> Surroundings {
        let is_flat = self.shading == Shading::Flat;
        let normal = if is_flat { hit.facing } else { hit.look.normal };
        let still = if is_flat { [DVec3::ZERO; 2] } else { hit.change.normal };
        let change = Change { normal: still, ..hit.change };
        let v = (self.eye.truncate() - self.eye.w * hit.position).normalize();
        let footprint = mirrored_footprint(&change, visible_normal(normal, v), hit.position, self.eye);
        let roughness = self.table.as_ref().map(|_| hit.look.roughness);
        if let (Some(spread), Some(roughness)) = (&hit.spread, roughness) {
            return seen_by_normals(around, hit.position, normal, spread, self.eye, roughness, footprint);
        }
        seen(around, hit.position, normal, self.eye, roughness, footprint)
    }

    /// Of light number `l`, as `arriving_of` reads it.
    fn share(&self, l: usize, light: &Light, hit: &Hit, is_opaque: impl Fn(u32, DVec3, DVec3) -> bool) -> f64 {
        let arrives = self.share_of_others(l, light, hit, is_opaque);
        let far = if light.kind == LIGHT_SUN { f64::INFINITY } else { hit.position.distance(vec3(light.position)) };
        let share = |own: &relief::Shade| own.share(incoming(light, hit.position).direction, far);
        hit.shade.as_ref().map_or(arrives, |own| relief::left(arrives, share(own)))
    }

    /// What hides light besides the heights that the place is on.
    fn share_of_others(
        &self,
        l: usize,
        light: &Light,
        hit: &Hit,
        is_opaque: impl Fn(u32, DVec3, DVec3) -> bool,
    ) -> f64 {
        let any_normal = matches!(self.shading, Shading::Flat | Shading::Gouraud) || hit.spread.is_some();
        let normal = hit.look.normal;
        let is_behind = |direction: DVec3| !any_normal && normal.dot(direction) <= 0.0 && normal != DVec3::ZERO;
        let towards = incoming(light, hit.position).direction;
        match (&self.shade, &self.shadow_maps) {
            (None, None) => 1.0,
            (Some(shade), _) => {
                let turn = turn(hit.pixel, l as u32);
                let seen = |k: u32| {
                    let towards = incoming_of(light, hit.position, k, turn).direction;
                    !is_behind(towards) && !is_stopped(shade, light, towards, hit, &is_opaque)
                };
                let bits = (0..samples(light)).filter(|k| seen(*k)).fold(0u32, |bits, k| bits | 1 << k);
                if samples(light) > 1 { -1.0 - f64::from(bits) } else { f64::from(bits) }
            }
            _ if is_behind(towards) => 0.0,
            (_, Some(maps)) => maps.share_seen(l, hit.position, hit.facing, towards),
        }
    }
}

fn is_stopped(
    shade: &Shade,
    light: &Light,
    direction: DVec3,
    hit: &Hit,
    is_opaque: impl Fn(u32, DVec3, DVec3) -> bool,
) -> bool {
    let origin = hit.position + hit.facing * f64::from(shade.offset_world);
    let end = distance(light, hit.position, direction);
    shade.occluders.stop(&Ray { origin, direction, end }, |id, weights| is_opaque(id, weights, direction))
}

fn environment(map: &domain::environment::Environment) -> Environment {
    Environment::new(map.width as usize, &map.texels)
}
