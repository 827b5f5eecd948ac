//! Light that heights take from themselves.

use std::{ops::Range, sync::Arc};

use displace_glsl::{
    methods::Marcher,
    reference::relief::{Course, ReliefMap, flat::Base, light, soft_shadow},
};
use glam::{DMat3, DVec2, DVec3};

use super::{Chart, Relief, base};
use crate::{domain::image::SelfShadow, render::reference_image::place::Place};

/// What is between a place of heights and lights.
pub(in crate::render::reference_image) struct Shade {
    base: Base,
    place: DVec2,
    chart: Chart,
    triangle: usize,
    levels: Arc<[ReliefMap]>,
    level: usize,
    heights: Range<f64>,
    mesh_from_world: DMat3,
    /// Whether a way is met, by this; else how much arrives over it.
    hard: Option<&'static Marcher>,
}

impl Relief {
    /// At weights of a triangle that is seen from the front, of the level that is marched there; none where heights take no
    /// light from themselves.
    pub(in crate::render::reference_image) fn shade(
        &self,
        at: &Place<'_>,
        weights: DVec3,
        level: usize,
    ) -> Option<Shade> {
        let (marcher, heights) = self.shows(at.part.material)?;
        let hard = match self.self_shadow {
            SelfShadow::None => return None,
            SelfShadow::Hard => Some(marcher),
            SelfShadow::Soft => None,
        };
        let base = base(at, heights, level, weights.max(DVec3::ZERO))?;
        let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| at.world(4, axis.extend(0.0)));
        let mesh_from_world = DMat3::from_cols(axes[0], axes[1], axes[2]).inverse();
        let (levels, range) = (Arc::clone(&heights.levels), heights.range.clone());
        let (chart, triangle, place) = (self.chart(at, heights), at.triangle, base.place(weights));
        Some(Shade { place, base, chart, triangle, levels, level, heights: range, mesh_from_world, hard })
    }
}

impl Shade {
    /// Of a light so far away along a unit direction in the world, how much arrives.
    pub(in crate::render::reference_image) fn share(&self, direction: DVec3, far: f64) -> f64 {
        let way = self.mesh_from_world * direction;
        let way = (way.normalize(), far * way.length());
        let course = light::course(&self.base, &self.map().level, self.place, way, &self.heights);
        let size = DVec2::from_array(self.map().level.size.map(f64::from));
        let within = |course| self.chart.with(|charts| light::bordered(course, charts, self.triangle, size));
        course.map(within).map_or(0.0, |course| if course.nodes.is_empty() { 1.0 } else { self.over(&course) })
    }

    fn map(&self) -> &ReliefMap {
        &self.levels[self.level]
    }

    fn over(&self, course: &Course) -> f64 {
        let Some(marcher) = self.hard else { return soft_shadow::share(self.map(), course) };
        let is_met = (marcher.twin)(self.map(), course, marcher.setting.into()).is_hit();
        if is_met { 0.0 } else { 1.0 }
    }
}

/// What is left of what arrives of a light, as `arriving_of` reads it: the twin of `self_shadow`.
pub(in crate::render::reference_image) fn left(stored: f64, share: f64) -> f64 {
    if stored >= 0.0 {
        return stored * share;
    }
    // Of a light's samples as many as the share is of all.
    let kept = (1u32 << (share * 16.0).round() as u32) - 1;
    -1.0 - f64::from((-1.0 - stored) as u32 & kept)
}
