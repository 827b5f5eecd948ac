//! Heights that are shown per pixel: the twins of the courses, the method and `relieve` put together.

mod chart;
mod light;
mod maps;
#[cfg(test)]
mod tests;

use std::{ops::Range, sync::Arc};

use displace_glsl::{
    layout::relief::ChartSides,
    methods::Marcher,
    reference::{
        relief::{
            March, ReliefMap,
            bordered::Foot,
            flat, leaving,
            level::level,
            pixel_ray::{PixelRay, pixel_ray},
            relieve::{self, Struck},
        },
        surface::{Barycentrics, unit_or_zero},
    },
};
use glam::{DMat2, DVec2, DVec3};

use super::{
    place::{Place, blend, vec3},
    shading::Hit,
};
use crate::{
    domain::{
        Error, Result,
        image::{RenderScene, SelfShadow, Silhouettes},
        request::Shadows,
    },
    render::image::charts,
};
use chart::Chart;

pub(super) use light::{Shade, left};

/// Of a pixel's side: each of its samples is shaded by itself, and the four are averaged.
const SAMPLE_SIDE: f64 = 0.5;

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
    /// Of the triangles of meshes.
    sides: Vec<Arc<Vec<ChartSides>>>,
    mesh_of_instances: Vec<usize>,
    self_shadow: SelfShadow,
    /// Places are put on the heights above them.
    lifts: bool,
}

/// What relief makes of what is seen of a triangle.
pub(super) enum Found {
    /// There is no relief, or no ray goes down to it.
    Base,
    /// Nothing is seen; without a march where all of the way is beyond a border.
    Missed(Option<March>),
    /// Maps are read elsewhere; what is seen is where it is.
    Shifted(Spot, March),
    Struck(Box<OnHeights>),
}

/// Weights of a triangle of the mesh.
pub(super) struct Spot {
    pub(super) triangle: usize,
    pub(super) b: Barycentrics,
}

/// What was struck.
pub(super) struct OnHeights {
    struck: Struck,
    /// None where all of the way is beyond a border.
    march: Option<March>,
    /// Of the mesh.
    pub(super) triangle: usize,
    /// World, unit.
    pub(super) normal: DVec3,
    /// World.
    pub(super) position: DVec3,
    /// Towards the viewer's side, unit.
    pub(super) facing: DVec3,
    /// Of the displaced surface there, unit.
    pub(super) smooth: DVec3,
}

impl Relief {
    pub(super) fn new(scene: &RenderScene) -> Result<Self> {
        let heights = maps::heights(scene);
        let marcher = scene.marcher();
        if marcher.is_some() {
            check(scene)?;
        }
        let mesh_of_instances = scene.instances.iter().map(|instance| instance.mesh).collect();
        let sides = charts::sides(scene).into_iter().map(Arc::new).collect();
        let (self_shadow, lifts) = (scene.relief.self_shadow, scene.shadows == Shadows::Map);
        Ok(Self { marcher, heights, sides, mesh_of_instances, self_shadow, lifts })
    }

    pub(super) fn is_shown(&self) -> bool {
        self.marcher.is_some()
    }

    /// Whether it decides what is seen of a material.
    pub(super) fn finds_depth(&self, material: u32) -> bool {
        self.marcher.is_some_and(|marcher| marcher.finds_depth) && self.heights[material as usize].is_some()
    }

    /// Whether a ray from what is seen, along a direction, only leaves what heights of a base triangle lie in.
    pub(super) fn is_left(&self, place: &Place<'_>, weights: DVec3, (hit, direction): (&Hit, DVec3)) -> bool {
        let Some(heights) = &self.heights[place.part.material as usize] else { return false };
        let front = place.front();
        // What a height of 1 rises above the triangle.
        let column = |axis: DVec3| front.dot(place.world(4, axis.extend(0.0)));
        let unit = DVec3::new(column(DVec3::X), column(DVec3::Y), column(DVec3::Z)).length();
        let base = leaving::Base {
            corners: [DVec3::X, DVec3::Y, DVec3::Z].map(|corner| place.position(corner)),
            front,
            heights: heights.range.start * unit..heights.range.end * unit,
            is_own: hit.instance == place.part.instance && hit.material == place.part.material,
        };
        base.is_left(&leaving::Start { position: hit.position, direction, normal: hit.normal }, weights)
    }

    fn shows(&self, material: u32) -> Option<(&'static Marcher, &Heights)> {
        self.marcher.zip(self.heights[material as usize].as_ref())
    }

    fn chart(&self, place: &Place<'_>, heights: &Heights) -> Chart {
        let sides = &self.sides[self.mesh_of_instances[place.part.instance as usize]];
        Chart::new(place, heights, Arc::clone(sides))
    }

    /// Which level is marched under a place of the image, by weights of the triangle there.
    pub(super) fn level(&self, place: &Place<'_>, weights: DVec3, at_px: [f64; 2]) -> usize {
        let Some((_, heights)) = self.shows(place.part.material) else { return 0 };
        let Some(base) = base(place, heights, 0, weights) else { return 0 };
        level(&base, place.rows, DVec2::from_array(at_px), weights, heights.levels.len())
    }

    /// Under a place of the image, by weights of the triangle there; -1 where its back is seen, which has none. A surface
    /// that is known to be seen there goes on where it ends.
    pub(super) fn found(
        &self,
        place: &Place<'_>,
        (b, flip): (&Barycentrics, f64),
        at_px: [f64; 2],
        is_seen: bool,
    ) -> Found {
        if flip < 0.0 {
            return Found::Base;
        }
        let Some((marcher, heights)) = self.shows(place.part.material) else { return Found::Base };
        let level = self.level(place, b.at, at_px);
        let Some(base) = base(place, heights, level, b.at) else { return Found::Base };
        let (at_px, corner) = (DVec2::from_array(at_px), vec3(place.mesh.positions[place.vertices()[0]]));
        let ray = pixel_ray(place.rows, at_px, corner);
        let Some(range) = flat::range(&base, &ray, &heights.range) else { return Found::Base };
        self.chart(place, heights).with(|charts| {
            let foot = Foot::new(&base, &ray, charts, place.triangle, heights.size(level), b.at);
            let landing = Landing { place, heights, level, marcher, b, at_px, ray, is_seen, lifts: self.lifts };
            if marcher.finds_depth { landed(&landing, &foot, &range, &base) } else { shifted(&landing, &base, &foot) }
        })
    }
}

/// A ray over the heights of a triangle.
struct Landing<'a> {
    place: &'a Place<'a>,
    heights: &'a Heights,
    level: usize,
    marcher: &'static Marcher,
    b: &'a Barycentrics,
    at_px: DVec2,
    ray: PixelRay,
    is_seen: bool,
    lifts: bool,
}

fn landed(at: &Landing<'_>, foot: &Foot<'_>, range: &Range<f64>, base: &flat::Base) -> Found {
    let map = &at.heights.levels[at.level];
    let on = foot.course(range, at.ray.direction.dot(base.normal).abs());
    let march = (on.course.nodes.len() > 1).then(|| (at.marcher.twin)(map, &on.course, at.marcher.setting.into()));
    let Some(met) = foot.met(&map.level, &on, march.as_ref(), at.is_seen) else { return Found::Missed(march) };
    let way = foot.way_to(met.t);
    let there = Place { triangle: way.triangle, ..*at.place };
    let texels = at.heights.texels(&there, at.level, way.turns);
    let weights = weights_at(texels, met.place).unwrap_or(at.b.at);
    let inside = weights.max(DVec3::ZERO);
    let point = at.ray.origin + at.ray.direction * met.t;
    let Some(base) = base_on(&there, inside / inside.element_sum(), texels) else { return Found::Base };
    let struck = relieve::struck(&base, &map.level, there.rows, at.at_px, (&met, point));
    Found::Struck(Box::new(OnHeights {
        position: there.world(4, (struck.point + if at.lifts { struck.lift } else { DVec3::ZERO }).extend(1.0)),
        facing: unit_or_zero(there.world(7, struck.facing.extend(0.0))),
        smooth: unit_or_zero(there.world(7, struck.smooth.extend(0.0))),
        normal: unit_or_zero(there.world(7, base.normal.extend(0.0))),
        triangle: there.triangle,
        struck,
        march,
    }))
}

fn shifted(at: &Landing<'_>, base: &flat::Base, foot: &Foot<'_>) -> Found {
    let Landing { place, heights, level, marcher, b, ray, .. } = at;
    let Some(course) = flat::course(base, ray, heights.range.clone()) else { return Found::Base };
    let march = (marcher.twin)(&heights.levels[*level], &course, marcher.setting.into());
    let (way, end) = foot.way_over(march.place);
    let there = Place { triangle: way.triangle, ..**place };
    let texels = heights.texels(&there, *level, way.turns);
    let along = |change: DVec3| {
        let [a, b, c] = heights.texels(place, *level, DVec2::ZERO);
        weights_along(texels, a * change.x + b * change.y + c * change.z)
    };
    let b = match weights_at(texels, end) {
        Some(at) if way.triangle == place.triangle => Barycentrics { at, ..**b },
        Some(at) => Barycentrics { at, dx: along(b.dx), dy: along(b.dy), clockwise: b.clockwise },
        None => Barycentrics { ..**b },
    };
    Found::Shifted(Spot { triangle: way.triangle, b }, march)
}

impl OnHeights {
    /// Of the corners, where they were `base`.
    pub(super) fn weights(&self, base: &Barycentrics) -> Barycentrics {
        let by_sample = |changes: [DVec3; 2]| changes.map(|change| change * SAMPLE_SIDE);
        let [dx, dy] = self.struck.changes.map_or([base.dx, base.dy], by_sample);
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
            Self::Missed(march) => *march,
            Self::Shifted(_, march) => Some(*march),
            Self::Struck(on) => on.march,
        }
    }
}

fn base(place: &Place<'_>, heights: &Heights, level: usize, at: DVec3) -> Option<flat::Base> {
    base_on(place, at, heights.texels(place, level, DVec2::ZERO))
}

/// With the normal that is seen at these weights.
fn base_on(place: &Place<'_>, at: DVec3, texels: [DVec2; 3]) -> Option<flat::Base> {
    let vertices = place.vertices();
    let normal = unit_or_zero(blend(at, vertices.map(|v| vec3(place.mesh.normals[v]))));
    flat::Base::new(vertices.map(|v| vec3(place.mesh.positions[v])), normal, texels)
}

/// Of corners at these texels; none where they have no area on the map.
fn weights_at(texels: [DVec2; 3], place: DVec2) -> Option<DVec3> {
    let weights = DVec3::X + weights_along(texels, place - texels[0]);
    weights.is_finite().then_some(weights)
}

fn weights_along(texels: [DVec2; 3], way: DVec2) -> DVec3 {
    let share = DMat2::from_cols(texels[1] - texels[0], texels[2] - texels[0]).inverse() * way;
    DVec3::new(-share.x - share.y, share.x, share.y)
}

impl Heights {
    /// Texels of a level.
    fn size(&self, level: usize) -> DVec2 {
        DVec2::from_array(self.levels[level].level.size.map(f64::from))
    }

    /// On the map, which is 1 wide and high.
    fn on_map(&self, uv: DVec2) -> DVec2 {
        chart::on_map(&self.map_from_uv, uv)
    }

    /// Of corners, with so much added to their places on the map.
    fn texels(&self, place: &Place<'_>, level: usize, turns: DVec2) -> [DVec2; 3] {
        let corners = [DVec3::X, DVec3::Y, DVec3::Z];
        corners.map(|corner| (self.on_map(place.uv(self.uv_channel, corner)) + turns) * self.size(level) - 0.5)
    }
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
