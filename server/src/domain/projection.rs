//! Where on its maps a surface is read: at its texture coordinates, or where its place in its mesh is projected to.

use serde::{Deserialize, Serialize};

pub use displace_glsl::reference::projection::Kind;

/// How places of a surface become places of maps.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Projection {
    /// Texture coordinates of the file.
    #[default]
    Uv,
    /// From the centre of the box; the poles are at +Y (v = 0) and -Y.
    Sphere,
    /// As Everson (COM3404) prints it: half of the sphere is mirrored.
    SphereAsPrinted,
    PlanarX,
    PlanarY,
    PlanarZ,
    /// Along the axis nearest to the normal.
    Box,
    /// Along all three, blended by the normal.
    Triplanar,
}

impl Projection {
    /// What the passes call it; `None` where maps are read at texture coordinates.
    #[must_use]
    pub fn kind(self) -> Option<Kind> {
        match self {
            Self::Uv => None,
            Self::Sphere => Some(Kind::Sphere),
            Self::SphereAsPrinted => Some(Kind::SphereAsPrinted),
            Self::PlanarX => Some(Kind::PlanarX),
            Self::PlanarY => Some(Kind::PlanarY),
            Self::PlanarZ => Some(Kind::PlanarZ),
            Self::Box => Some(Kind::Box),
            Self::Triplanar => Some(Kind::Triplanar),
        }
    }

    /// As in `projection.glsl`.
    #[must_use]
    pub fn number(self) -> u32 {
        self.kind().map_or(0, |kind| kind as u32)
    }

    #[must_use]
    pub fn is_sphere(self) -> bool {
        matches!(self, Self::Sphere | Self::SphereAsPrinted)
    }
}

/// What places are projected from: the box of a mesh before it is displaced.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct ProjectionBox {
    /// Of the box, in the mesh's space.
    pub centre: [f32; 3],
    /// Its longest side: as much of a plane as a map covers once.
    pub side: f32,
}

impl Default for ProjectionBox {
    fn default() -> Self {
        Self { centre: [0.0; 3], side: 1.0 }
    }
}

impl ProjectionBox {
    /// Of finite positions; that of nothing, or of one place, has a side of 1.
    #[must_use]
    pub fn of(positions: impl Iterator<Item = [f32; 3]>) -> Self {
        let nothing = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
        let (low, high) = positions.fold(nothing, |(low, high), p| {
            (std::array::from_fn(|k| low[k].min(p[k])), std::array::from_fn(|k| high[k].max(p[k])))
        });
        let side = (0..3).map(|k| high[k] - low[k]).fold(0.0, f32::max);
        if !(side.is_finite() && low[0].is_finite()) {
            return Self::default();
        }
        let centre = std::array::from_fn(|k| low[k] + 0.5 * (high[k] - low[k]));
        Self { centre, side: if side > 0.0 { side } else { 1.0 } }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_box_has_the_longest_side_and_the_centre_of_all_places() {
        let found = ProjectionBox::of([[-1.0, 0.0, 2.0], [3.0, 1.0, 0.0]].into_iter());
        assert_eq!(found, ProjectionBox { centre: [1.0, 0.5, 1.0], side: 4.0 });
    }

    #[test]
    fn one_place_and_none_have_a_box_that_nothing_divides_by_zero_for() {
        assert_eq!(ProjectionBox::of([[2.0; 3]].into_iter()), ProjectionBox { centre: [2.0; 3], side: 1.0 });
        assert_eq!(ProjectionBox::of(std::iter::empty()), ProjectionBox::default());
    }
}
