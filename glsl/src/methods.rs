//! The methods that realise a detail: one enum, one table.

/// How a detail is realised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Method {
    Flat,
    #[default]
    Displacement,
    Vector,
}

/// A row of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MethodRow {
    pub method: Method,
    pub name: &'static str,
    pub summary: &'static str,
    /// What of the detail can be seen.
    pub represents: &'static [&'static str],
    /// Where the cost lies.
    pub cost: &'static str,
}

/// Every method of this version.
pub const METHODS: &[MethodRow] = &[
    MethodRow {
        method: Method::Flat,
        name: "flat",
        summary: "the base mesh as it is; the detail is not shown",
        represents: &[],
        cost: "nothing beyond the base mesh",
    },
    MethodRow {
        method: Method::Displacement,
        name: "displacement",
        summary: "moves vertices along the welded normal by a height (Cook 1984)",
        represents: &["silhouette", "self-occlusion", "self-shadow", "parallax", "shading"],
        cost: "triangles",
    },
    MethodRow {
        method: Method::Vector,
        name: "vector",
        summary: "moves vertices by a vector, so that overhangs and concave shapes are possible",
        represents: &["silhouette", "self-occlusion", "self-shadow", "parallax", "shading", "overhangs"],
        cost: "triangles",
    },
];

impl Method {
    #[must_use]
    pub fn row(self) -> &'static MethodRow {
        METHODS.iter().find(|row| row.method == self).unwrap_or(&METHODS[0])
    }

    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        METHODS.iter().find(|row| row.name == name).map(|row| row.method)
    }
}
