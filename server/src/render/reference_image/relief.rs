//! Heights that are shown per pixel: the twins of the courses, the method and `relieve` put together.

mod light;
mod maps;
#[cfg(test)]
mod tests;

use std::{ops::Range, sync::Arc};

use displace_glsl::{
    methods::Marcher,
    reference::{
        relief::{
            March, ReliefMap, flat,
            level::level,
            pixel_ray::pixel_ray,
            relieve::{self, Struck},
        },
        surface::{Barycentrics, unit_or_zero},
    },
};
use glam::{DVec2, DVec3};

use super::place::{Place, blend, vec3};
use crate::domain::{
    Error, Result,
    image::{RenderScene, SelfShadow, Silhouettes},
};

pub(super) use light::{Shade, left};

/// The heights of a material.
struct Heights {
    /// The finest first.
    levels: Arc<[ReliefMap]>,
    range: Range<f64>,
    uv_channel: u32,
    map_from_uv: [[f32; 3]; 2],
}

/// How a scene shows heights.
pub(super) struct Relief {
    /// None where no material has any.
    marcher: Option<&'static Marcher>,
    /// Of materials.
    heights: Vec<Option<Heights>>,
    self_shadow: SelfShadow,
}

/// What relief makes of what is seen of a triangle.
pub(super) enum Found {
    /// There is no relief, or no ray goes down to it.
    Base,
    /// Nothing is seen.
    Missed(March),
    /// Maps are read elsewhere, at these weights; what is seen is where it is.
    Shifted(DVec3, March),
    Struck(Box<OnHeights>),
}

/// What was struck.
pub(super) struct OnHeights {
    struck: Struck,
    march: March,
    /// World.
    pub(super) position: DVec3,
    /// Towards the viewer's side, unit.
    pub(super) facing: DVec3,
}

impl Relief {
    pub(super) fn new(scene: &RenderScene) -> Result<Self> {
        let heights = maps::heights(scene);
        let marcher = scene.marcher();
        if marcher.is_some() {
            check(scene)?;
        }
        Ok(Self { marcher, heights, self_shadow: scene.relief.self_shadow })
    }

    pub(super) fn is_shown(&self) -> bool {
        self.marcher.is_some()
    }

    /// Whether it decides what is seen of a material.
    pub(super) fn finds_depth(&self, material: u32) -> bool {
        self.marcher.is_some_and(|marcher| marcher.finds_depth) && self.heights[material as usize].is_some()
    }

    fn shows(&self, material: u32) -> Option<(&'static Marcher, &Heights)> {
        self.marcher.zip(self.heights[material as usize].as_ref())
    }

    /// Which level is marched under a place of the image, by weights of the triangle there.
    pub(super) fn level(&self, place: &Place<'_>, weights: DVec3, at_px: [f64; 2]) -> usize {
        let Some((_, heights)) = self.shows(place.part.material) else { return 0 };
        let Some(base) = base(place, heights, 0, weights) else { return 0 };
        level(&base, place.rows, DVec2::from_array(at_px), weights, heights.levels.len())
    }

    /// Under a place of the image, by weights of the triangle there; -1 where its back is seen, which has none.
    pub(super) fn found(&self, place: &Place<'_>, (b, flip): (&Barycentrics, f64), at_px: [f64; 2]) -> Found {
        if flip < 0.0 {
            return Found::Base;
        }
        let Some((marcher, heights)) = self.shows(place.part.material) else { return Found::Base };
        let level = self.level(place, b.at, at_px);
        let Some(base) = base(place, heights, level, b.at) else { return Found::Base };
        let (at_px, corner) = (DVec2::from_array(at_px), vec3(place.mesh.positions[place.vertices()[0]]));
        let ray = pixel_ray(place.rows, at_px, corner);
        let Some(course) = flat::course(&base, &ray, heights.range.clone()) else { return Found::Base };
        let map = &heights.levels[level];
        let march = (marcher.twin)(map, &course, marcher.setting.into());
        if !marcher.finds_depth {
            return Found::Shifted(base.weights(march.place), march);
        }
        let Some(struck) = relieve::struck(&base, &map.level, place.rows, (at_px, &ray), (&course, &march)) else {
            return Found::Missed(march);
        };
        Found::Struck(Box::new(OnHeights {
            position: place.world(4, struck.point.extend(1.0)),
            facing: unit_or_zero(place.world(7, struck.facing.extend(0.0))),
            struck,
            march,
        }))
    }
}

impl OnHeights {
    /// Of the corners, where they were `base`.
    pub(super) fn weights(&self, base: &Barycentrics) -> Barycentrics {
        let [dx, dy] = self.struck.changes.unwrap_or([base.dx, base.dy]);
        Barycentrics { at: self.struck.at, dx, dy, clockwise: base.clockwise }
    }

    /// Reversed.
    pub(super) fn depth(&self) -> f64 {
        self.struck.depth
    }
}

impl Found {
    pub(super) fn march(&self) -> Option<March> {
        match self {
            Self::Base => None,
            Self::Missed(march) | Self::Shifted(_, march) => Some(*march),
            Self::Struck(on) => Some(on.march),
        }
    }
}

/// On a level of its map.
fn base(place: &Place<'_>, heights: &Heights, level: usize, at: DVec3) -> Option<flat::Base> {
    let vertices = place.vertices();
    let normal = unit_or_zero(blend(at, vertices.map(|v| vec3(place.mesh.normals[v]))));
    let size = heights.levels[level].level.size.map(f64::from);
    let rows = heights.map_from_uv.map(|row| row.map(f64::from));
    let texels = [DVec3::X, DVec3::Y, DVec3::Z].map(|corner| {
        let uv = place.uv(heights.uv_channel, corner).extend(1.0);
        DVec2::from_array([0, 1].map(|axis| DVec3::from_array(rows[axis]).dot(uv) * size[axis] - 0.5))
    });
    flat::Base::new(vertices.map(|v| vec3(place.mesh.positions[v])), normal, texels)
}

fn check(scene: &RenderScene) -> Result<()> {
    let name = match scene.relief.silhouettes {
        Silhouettes::None => return Ok(()),
        Silhouettes::Shell => "shell",
        Silhouettes::Quadric => "quadric",
    };
    let message = format!("is {name}, which device reference does not show: take another device, or silhouettes none");
    Err(Error::unsupported("lighting.relief.silhouettes", message))
}
