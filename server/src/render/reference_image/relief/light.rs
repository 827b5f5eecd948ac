//! Light that heights take from themselves.

use std::sync::Arc;

use displace_glsl::{
    methods::Marcher,
    reference::relief::{
        ReliefMap,
        flat::Base,
        light::{Start, Way, way},
    },
};
use glam::{DMat3, DVec3};

use crate::render::reference_image::place::Place;

/// What is between what was struck and lights.
pub(in crate::render::reference_image) struct Shade {
    base: Base,
    start: Start,
    high: f64,
    mesh_from_world: DMat3,
    /// What marches; none where heights take no light from themselves.
    marched: Option<(&'static Marcher, Arc<ReliefMap>)>,
}

impl Shade {
    pub(super) fn new(
        place: &Place<'_>,
        base: Base,
        start: Start,
        high: f64,
        marched: Option<(&'static Marcher, Arc<ReliefMap>)>,
    ) -> Self {
        let axes = [DVec3::X, DVec3::Y, DVec3::Z].map(|axis| place.world(4, axis.extend(0.0)));
        let mesh_from_world = DMat3::from_cols(axes[0], axes[1], axes[2]).inverse();
        Self { base, start, high, mesh_from_world, marched }
    }

    /// By a march along a unit direction in the world, to a light so far away.
    pub(in crate::render::reference_image) fn stops(&self, direction: DVec3, end: f64) -> bool {
        let Some((marcher, map)) = &self.marched else { return false };
        match way(&self.base, &self.start, self.mesh_from_world * direction, self.high, end) {
            Way::Dark => true,
            Way::Clear => false,
            Way::Over(course) => (marcher.twin)(map, &course, marcher.setting.into()).is_hit(),
        }
    }

    /// How far along a unit direction in the world the base has been passed, which is no obstacle to what lies below it;
    /// none where it is not.
    pub(in crate::render::reference_image) fn passed(&self, direction: DVec3) -> Option<f64> {
        let rise = self.base.along(self.mesh_from_world * direction).z;
        if self.start.z >= 0.0 {
            return Some(0.0);
        }
        (rise > 0.0).then(|| -self.start.z / rise)
    }
}
