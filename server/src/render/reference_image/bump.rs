//! How normals are bent: the twins of `bump` and `bump_expression` put together.

use displace_glsl::{
    layout::raster::{MAP_DETAIL, MAP_SLOTS},
    reference::{
        bump::{self, Shown},
        bump_expression::{Corners, rises},
        surface::unit_or_zero,
    },
};
use glam::{DMat2, DMat3, DVec2, DVec3, DVec4};

use super::place::{Place, blend, vec3};
use crate::{
    domain::image::{BumpKind, RenderBump, RenderMap, RenderMaterial},
    render::image::bump::BumpTables,
};

/// What is seen there: the material, what its maps show, and the normal before it is bent, unit, towards the viewer's side.
pub(super) struct Unbent<'a> {
    pub(super) source: &'a RenderMaterial,
    pub(super) mapped: &'a [DVec4; MAP_SLOTS],
    pub(super) normal: DVec3,
    /// Without its own normal map.
    pub(super) smooth: DVec3,
    pub(super) flip: f64,
}

/// The bent normal, unit, towards the viewer's side; as it was where there is nothing to bend it.
pub(super) fn bent(place: &Place<'_>, tables: &BumpTables, weights: DVec3, unbent: &Unbent<'_>) -> DVec3 {
    let bump = &unbent.source.bump;
    if bump.is_empty() {
        return unbent.normal;
    }
    let flip = unbent.flip;
    let front = if bump.faceted { place.front() } else { flip * unbent.smooth };
    let own = if bump.faceted { front } else { flip * unbent.normal };
    let at = place_of(place, weights, front, bump);
    let risen = tables.formulas_of(place.part.material as usize).map(|(formula, code)| {
        let uvs = corners_uv(place, formula.uv_channel);
        rises(formula, code, &corners(place, weights), uvs)
    });
    let bent = flip * bump::bent(&at, own, risen.sum(), &shown(place, unbent));
    if bent == DVec3::ZERO { unbent.normal } else { bent }
}

fn corners(place: &Place<'_>, at: DVec3) -> Corners {
    let vertices = place.vertices();
    let (positions, normals) = (&place.mesh.positions, &place.mesh.normals);
    Corners { positions: vertices.map(|v| vec3(positions[v])), normals: vertices.map(|v| vec3(normals[v])), at }
}

fn corners_uv(place: &Place<'_>, channel: u32) -> [DVec2; 3] {
    [DVec3::X, DVec3::Y, DVec3::Z].map(|corner| place.uv(channel, corner))
}

fn place_of(place: &Place<'_>, weights: DVec3, front: DVec3, bump: &RenderBump) -> bump::Place {
    let Corners { positions: [a, b, c], normals, at } = corners(place, weights);
    let sides = [b - a, c - a];
    let rows =
        |first: usize| DMat3::from_cols_array(&std::array::from_fn(|k| f64::from(place.rows[first + k % 3][k / 3])));
    bump::Place {
        sides,
        normal: unit_or_zero(if bump.faceted { sides[0].cross(sides[1]) } else { blend(at, normals) }),
        front,
        tangent: place.tangent(weights),
        world_from_mesh: rows(4),
        world_from_normal: rows(7),
    }
}

fn shown(place: &Place<'_>, unbent: &Unbent<'_>) -> Vec<Shown> {
    let Unbent { source, mapped, .. } = unbent;
    let uses = source.bump.uses.iter().zip(MAP_DETAIL..);
    let bending = uses.filter(|(used, _)| used.kind != BumpKind::None);
    let with_map = bending.filter_map(|(used, slot)| Some((used, slot, source.maps[slot].as_ref()?)));
    let one = |(used, slot, map): (&crate::domain::image::BumpUse, usize, &RenderMap)| {
        let [a, b, c] = corners_uv(place, map.uv_channel);
        let uv_changes = DMat2::from_cols(b - a, c - a);
        let [u, v] = map.map_from_uv.map(|row| row.map(f64::from));
        let map_changes = DMat2::from_cols_array(&[u[0], v[0], u[1], v[1]]) * uv_changes;
        let (kind, scale) = (used.kind.number(), used.scale.into());
        Shown { kind, scale, value: mapped[slot].truncate(), map_changes, uv_changes }
    };
    with_map.map(one).collect()
}
