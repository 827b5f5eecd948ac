//! The base surface at a site, with derivatives: flat, or of Bézier patches. The twin of `smooth.glsl`.

use glam::{DMat3, DVec3};

use super::{
    frame::{Jet, MIN_BLENDED_NORMAL, inverse_length, jet, product},
    site::{Site, vector},
};
use crate::{
    bezier::{Net, SecondJet},
    patches::{AT_VERTEX, Leaf, Patches, ends, within_triangle},
    tables::Tables,
};

/// Of a flat base, normals are not unit, and directions are still to be divided by their length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Fields {
    pub position: Jet,
    pub normal: Jet,
    pub direction: Jet,
}

#[must_use]
pub fn fields(tables: &Tables, site: &Site) -> Fields {
    if let Some(patches) = tables.patches.as_deref().filter(|_| site.patch != AT_VERTEX) {
        return smooth(patches, site);
    }
    let of = |table: &[[f32; 4]]| jet(site.b, site.av.map(|av| vector(&table[av as usize])));
    Fields {
        position: of(&tables.av_position_u),
        normal: jet(site.b, site.av.map(|av| vector(&tables.av_normal[av as usize]))),
        direction: of(&tables.av_direction_v),
    }
}

fn smooth(patches: &Patches, site: &Site) -> Fields {
    let (t, b) = (site.patch / 8, within_triangle(site.patch, site.b));
    let leaf = patches.leaf(t, b);
    let position = patches.position(&leaf.node).second_jet(leaf.b);
    let [normal, direction] = match patches.normals(&leaf.node) {
        Some(nets) => blended(nets.map(|net| scaled(&net, &leaf))),
        None => [own_normal(&position, &leaf); 2],
    };
    let direction = match patches.given(t) {
        Some((mask, given)) => with_given(direction, b, mask, given),
        None => direction,
    };
    let place = patches.origin(&leaf.node) + position.value;
    let position = DMat3::from_cols(place, leaf.scale * position.first[0], leaf.scale * position.first[1]);
    let along = |jet: Jet| ends(site.patch).map_or(jet, |ends| along_edge(jet, ends));
    Fields { position: along(position), normal: along(normal), direction: along(direction) }
}

fn scaled(net: &Net, leaf: &Leaf) -> Jet {
    let jet = net.second_jet(leaf.b);
    DMat3::from_cols(jet.value, leaf.scale * jet.first[0], leaf.scale * jet.first[1])
}

fn blended([normal, direction]: [Jet; 2]) -> [Jet; 2] {
    let over = |least: f64, jet: Jet| product(inverse_length(normal, least), jet);
    [over(1e-12, normal), over(MIN_BLENDED_NORMAL, direction)]
}

/// Unit. Lengths of the derivatives do not matter: their scale goes before their product is made.
fn own_normal(p: &SecondJet, leaf: &Leaf) -> Jet {
    let size = p.first[0].length().max(p.first[1].length());
    let unit = f64::from(leaf.node.side) / (size * size).max(f64::MIN_POSITIVE);
    let ([u, v], [uu, uv, vv]) = (p.first, p.second);
    let normal = DMat3::from_cols(u.cross(v), uu.cross(v) + u.cross(uv), uv.cross(v) + u.cross(vv)) * unit;
    let unit = product(inverse_length(normal, 1e-12), normal);
    DMat3::from_cols(unit.x_axis, leaf.scale * unit.y_axis, leaf.scale * unit.z_axis)
}

/// Directions that corners are given take the place of what is there, by the corners' weights.
fn with_given(direction: Jet, b: DVec3, mask: DVec3, given: [DVec3; 3]) -> Jet {
    let left = DVec3::new(1.0 - b.dot(mask), mask.x - mask.y, mask.x - mask.z);
    let given: [DVec3; 3] = std::array::from_fn(|k| given[k] * mask[k]);
    product(left, direction) + jet(b, given)
}

/// Both derivatives become that from one end to the other.
fn along_edge(jet: Jet, [from, to]: [usize; 2]) -> Jet {
    let by = |k: usize| if k == 0 { DVec3::ZERO } else { jet.col(k) };
    let slope = by(to) - by(from);
    DMat3::from_cols(jet.x_axis, slope, slope)
}
