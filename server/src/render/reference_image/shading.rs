//! What lies under a place of the image and what it looks like: the twins of the passes put together.

use std::sync::Arc;

use displace_glsl::{
    layout::raster::{MAP_BASE_COLOR, MAP_DETAIL, MAP_NORMAL, MAP_NORMAL_MOMENTS, MAP_SLOTS, Material, PART_MIRRORED},
    reference::{
        appearance::{self, Appearance, appearance},
        mip::Level,
        moments::{self, Spread},
        projection,
        relief::March,
        surface::{Barycentrics, barycentrics},
        surroundings::Change,
        texture,
        transform::homogeneous,
    },
};
use glam::{DVec2, DVec3, DVec4};

use super::{
    bump::{Unbent, bent},
    place::Place,
    projected,
    relief::{Found, Relief, Shade, Spot},
    textures::{filtered, map_levels, on_map, sides, still, twin},
};
use crate::{
    domain::{
        Result,
        image::{BumpKind, RenderMaterial, RenderScene},
    },
    render::image::{bump::BumpTables, tables::wrap_numbers},
};

pub(super) struct Hit {
    pub(super) position: DVec3,
    pub(super) uv: DVec2,
    pub(super) look: Appearance,
    /// Of its normals; none where moments are not asked for.
    pub(super) spread: Option<Spread>,
    /// Interpolated, towards the viewer's side.
    pub(super) normal: DVec3,
    pub(super) facing: DVec3,
    /// At the vertices, for Gouraud's light: positions and normals towards the viewer's side.
    pub(super) corners: [(DVec3, DVec3); 3],
    pub(super) weights: DVec3,
    pub(super) material: u32,
    pub(super) instance: u32,
    /// Where on the image.
    pub(super) pixel: [u32; 2],
    /// Of interpolated normal and position, by pixels.
    pub(super) change: Change,
    /// Of heights that take light from themselves.
    pub(super) shade: Option<Shade>,
    /// Over the heights there, met or missed.
    pub(super) march: Option<March>,
}

/// What lies under a place of the image.
struct Under {
    /// Of the mesh: relief may be struck beside what is seen.
    triangle: usize,
    b: Barycentrics,
    position: DVec3,
    /// Interpolated, towards the viewer's side.
    normal: DVec3,
    facing: DVec3,
    /// As displaced surfaces have it; where depth is found.
    struck: Option<DVec3>,
    flip: f64,
    shade: Option<Shade>,
    march: Option<March>,
}

/// The twins with what they need to know of the scene.
pub(super) struct Shader {
    /// Mip levels of each material's maps.
    maps: Vec<[Option<Arc<Vec<Level>>>; MAP_SLOTS]>,
    filter: texture::Filter,
    /// Some material's slopes have them.
    moments: bool,
    /// Of places onto maps, where these are not read at texture coordinates.
    projection: Option<projection::Kind>,
    pub(super) relief: Relief,
}

impl Shader {
    pub(super) fn new(scene: &RenderScene) -> Result<Self> {
        Ok(Self {
            maps: map_levels(scene),
            filter: twin(scene.filter),
            moments: scene.has_map(MAP_NORMAL_MOMENTS),
            projection: scene.projection.kind(),
            relief: Relief::new(scene)?,
        })
    }

    pub(super) fn hit(
        &self,
        place: &Place<'_>,
        source: &RenderMaterial,
        factors: &Material,
        bumps: &BumpTables,
        at_px: [f64; 2],
    ) -> Hit {
        let Under { triangle, b, position, normal, facing, struck, flip, shade, march } = self.under(place, at_px);
        let place = &Place { triangle, ..*place };
        let mapped = self.mapped(place, source, &b);
        let tilt = self.projection.map(|_| projected::in_world(place, mapped[MAP_NORMAL].truncate()));
        let under = appearance::Under { color: place.color(b.at), normal, flip, tangent: place.tangent(b.at), tilt };
        let mut look = appearance(factors, &under, &mapped);
        look.normal =
            bent(place, bumps, b.at, &Unbent { source, mapped: &mapped, normal: look.normal, smooth: normal, flip });
        if let Some(struck) = struck {
            look.normal = struck_normal(place, source, &b, [look.normal, struck]);
        }
        let normal_change = |weights: DVec3| flip * place.normal_change(b.at, weights);
        let position_change = |weights: DVec3| place.position_change(weights);
        let corner = |weights: DVec3| (place.position(weights), flip * place.normal(weights));
        let base_channel = source.maps[MAP_BASE_COLOR].as_ref().map_or(0, |map| map.uv_channel);
        Hit {
            position,
            uv: place.uv(base_channel, b.at),
            look,
            spread: self.spread(place, source, factors, &under, &mapped, &b),
            normal,
            facing,
            change: Change { normal: [b.dx, b.dy].map(normal_change), position: [b.dx, b.dy].map(position_change) },
            corners: [DVec3::X, DVec3::Y, DVec3::Z].map(corner),
            weights: b.at,
            material: place.part.material,
            instance: place.part.instance,
            pixel: at_px.map(|x| x as u32),
            shade,
            march,
        }
    }

    /// Of relief what was struck; what is beneath it where nothing was.
    fn under(&self, place: &Place<'_>, at_px: [f64; 2]) -> Under {
        let (b, flip) = seen(place, at_px);
        let found = self.relief.found(place, (&b, flip), at_px, true);
        let march = found.march();
        let (position, normal) = (place.position(b.at), flip * place.normal(b.at));
        let triangle = place.triangle;
        let facing = flip * place.front();
        let base = Under { triangle, b, position, normal, facing, struck: None, flip, shade: None, march };
        let struck = match found {
            Found::Base | Found::Missed(_) => base,
            Found::Shifted(Spot { triangle, b }, _) => Under { triangle, b, ..base },
            Found::Struck(on) => Under {
                triangle: on.triangle,
                b: on.weights(&b),
                position: on.position,
                normal: on.normal,
                facing: on.facing,
                struck: Some(on.smooth),
                ..base
            },
        };
        let there = Place { triangle: struck.triangle, ..*place };
        let level = self.relief.level(place, b.at, at_px);
        let shade = if flip > 0.0 { self.relief.shade(&there, struck.b.at, level) } else { None };
        Under { shade, ..struck }
    }

    /// What a march finds of a triangle there, and the reversed depth of that, `base` without relief; none where it is
    /// missed.
    pub(super) fn depth(&self, place: &Place<'_>, at_px: [f64; 2], base: f64) -> (Option<f64>, Option<March>) {
        if !self.relief.finds_depth(place.part.material) {
            return (Some(base), None);
        }
        let (b, flip) = seen(place, at_px);
        let found = self.relief.found(place, (&b, flip), at_px, false);
        let depth = match &found {
            Found::Base | Found::Shifted(..) => Some(base),
            Found::Missed(_) => None,
            Found::Struck(on) => Some(on.depth().clamp(0.0, 1.0)),
        };
        (depth, found.march())
    }

    /// The alpha of a place, at the finest level of its map.
    pub(super) fn alpha(&self, place: &Place<'_>, source: &RenderMaterial, weights: DVec3) -> f64 {
        let alpha = f64::from(source.base_color_factor[3]) * place.color(weights).w;
        match (&source.maps[MAP_BASE_COLOR], &self.maps[place.part.material as usize][MAP_BASE_COLOR]) {
            (Some(map), Some(levels)) if let Some(kind) = self.projection => {
                alpha * projected::alpha(kind, projected::at(place, &still(weights)), map, &levels[0])
            }
            (Some(map), Some(levels)) => {
                let at = on_map(map, place.uv(map.uv_channel, weights), 1.0);
                alpha * texture::bilinear(&levels[0], at, wrap_numbers(map.wrap))[3]
            }
            _ => alpha,
        }
    }

    /// How the normals under a pixel scatter.
    fn spread(
        &self,
        place: &Place<'_>,
        source: &RenderMaterial,
        factors: &Material,
        under: &appearance::Under,
        mapped: &[DVec4; MAP_SLOTS],
        b: &Barycentrics,
    ) -> Option<Spread> {
        let Some(map) = &source.maps[MAP_NORMAL_MOMENTS] else { return self.moments.then(Spread::default) };
        let scale = f64::from(factors.normal_scale);
        let [dx, dy] = sides(place, map, b);
        let share = scale * scale * moments::covered(dx, dy);
        let mean = mapped[MAP_NORMAL].truncate().truncate();
        let sigma = moments::covariance(mean, mapped[MAP_NORMAL_MOMENTS].truncate().to_array()).map(|s| share * s);
        Some(moments::in_world(under, scale * mean, sigma))
    }

    /// What each map shows; white where there is none.
    fn mapped(&self, place: &Place<'_>, source: &RenderMaterial, b: &Barycentrics) -> [DVec4; MAP_SLOTS] {
        let levels = &self.maps[place.part.material as usize];
        let at = self.projection.map(|kind| (kind, projected::at(place, b)));
        std::array::from_fn(|slot| match (&source.maps[slot], &levels[slot]) {
            (Some(map), Some(levels)) => match at {
                Some((kind, at)) => projected::filtered(self.filter, kind, at, slot, map, levels),
                None => filtered(self.filter, place, map, levels, b),
            },
            _ => DVec4::ONE,
        })
    }
}

/// Weights of the corners, and -1 where the back is seen.
fn seen(place: &Place<'_>, at_px: [f64; 2]) -> (Barycentrics, f64) {
    let b = barycentrics(place.vertices().map(|v| {
        let h = homogeneous(place.rows, place.mesh.positions[v]);
        DVec3::new(h.x - at_px[0] * h.w, h.y - at_px[1] * h.w, h.w)
    }));
    let flip = if b.clockwise != (place.part.flags & PART_MIRRORED != 0) { -1.0 } else { 1.0 };
    (b, flip)
}

/// Of relief: of slopes as they are filtered, and that of the heights that were struck, which counts where the map is seen
/// larger than it is.
fn struck_normal(
    place: &Place<'_>,
    source: &RenderMaterial,
    b: &Barycentrics,
    [filtered, struck]: [DVec3; 2],
) -> DVec3 {
    let is_mapped = source.maps[MAP_NORMAL].is_some();
    let slot = source.bump.uses.iter().position(|used| used.kind == BumpKind::Height && !is_mapped);
    let Some(map) = slot.and_then(|slot| source.maps[MAP_DETAIL + slot].as_ref()) else { return filtered };
    let [dx, dy] = sides(place, map, b);
    let share = (2.0 - dx.perp_dot(dy).abs().sqrt()).clamp(0.0, 1.0);
    filtered.lerp(struck, share).try_normalize().unwrap_or(filtered)
}
