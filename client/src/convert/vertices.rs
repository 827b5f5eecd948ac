//! The one form OBJ and PLY are read into: indexed triangles with optional attributes.

/// Triangles of one material. Attributes that are present have one entry for each position.
#[derive(Clone, Debug, Default, PartialEq)]
pub(crate) struct Primitive {
    pub(crate) positions: Vec<[f32; 3]>,
    /// Unit length.
    pub(crate) normals: Option<Vec<[f32; 3]>>,
    /// V down, as in glTF.
    pub(crate) uvs: Option<Vec<[f32; 2]>>,
    /// Linear RGBA.
    pub(crate) colors: Option<Vec<[f32; 4]>>,
    pub(crate) triangles: Vec<[u32; 3]>,
    /// Index into the file's materials.
    pub(crate) material: Option<usize>,
}

/// The corners of a convex polygon as triangles about its first corner.
pub(super) fn fan(corners: &[u32]) -> impl Iterator<Item = [u32; 3]> + '_ {
    corners.windows(2).skip(1).map(move |pair| [corners[0], pair[0], pair[1]])
}

/// The vector at unit length; `None` where it has no direction.
pub(super) fn unit(v: [f32; 3]) -> Option<[f32; 3]> {
    let length = v.iter().map(|&c| f64::from(c) * f64::from(c)).sum::<f64>().sqrt();
    (length.is_finite() && length > 0.0).then(|| v.map(|c| (f64::from(c) / length) as f32))
}

/// Files of these formats hold colours as monitors show them; glTF wants them linear.
pub(super) fn linear_from_srgb(value: f32) -> f32 {
    let value = value.clamp(0.0, 1.0);
    if value <= 0.040_45 { value / 12.92 } else { ((value + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_polygon_of_n_corners_is_n_minus_2_triangles() {
        assert_eq!(fan(&[7, 8, 9]).collect::<Vec<_>>(), [[7, 8, 9]]);
        assert_eq!(fan(&[0, 1, 2, 3, 4]).collect::<Vec<_>>(), [[0, 1, 2], [0, 2, 3], [0, 3, 4]]);
        assert_eq!(fan(&[0, 1]).count(), 0);
        assert_eq!(fan(&[]).count(), 0);
    }

    #[test]
    fn a_vector_without_direction_has_no_unit() {
        assert_eq!(unit([0.0, 3.0, 4.0]), Some([0.0, 0.6, 0.8]));
        assert_eq!(unit([0.0; 3]), None);
        assert_eq!(unit([f32::NAN, 0.0, 1.0]), None);
        assert_eq!(unit([1e-30, 0.0, 0.0]), Some([1.0, 0.0, 0.0]));
    }
}
