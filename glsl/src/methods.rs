//! The methods that realise a detail: one enum, one table.

/// How a detail is realised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize)]
pub enum Method {
    Flat,
    #[default]
    Displacement,
    Vector,
    Bump,
    Normal,
}

/// A row of the table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MethodRow {
    pub method: Method,
    pub name: &'static str,
    pub summary: &'static str,
    /// The kinds of detail it can show.
    pub represents: &'static [&'static str],
    /// Where the cost lies.
    pub cost: &'static str,
}

/// Every method of this version.
pub const METHODS: &[MethodRow] = &[
    MethodRow {
        method: Method::Flat,
        name: "flat",
        summary: "The mesh as it is, subdivided, without its detail.",
        represents: &[],
        cost: "triangles",
    },
    MethodRow {
        method: Method::Displacement,
        name: "displacement",
        summary: "Moves vertices along the welded direction by heights (Cook 1984).",
        represents: &["height", "expression", "normal"],
        cost: "triangles; per vertex one map lookup a layer",
    },
    MethodRow {
        method: Method::Vector,
        name: "vector",
        summary: "Moves vertices by vectors, so that overhangs are possible.",
        represents: &["vector", "expression", "normal"],
        cost: "triangles; per vertex one map lookup a layer",
    },
    MethodRow {
        method: Method::Bump,
        name: "bump",
        summary: "Bends normals by the slopes of heights and by normal maps, which add (Blinn 1978, Mikkelsen 2010).",
        represents: &["height", "expression", "normal"],
        cost: "per pixel one filtered map lookup a layer",
    },
    MethodRow {
        method: Method::Normal,
        name: "normal",
        summary: "Bends normals by normal maps, in tangent or object space (Peercy et al. 1997).",
        represents: &["normal"],
        cost: "per pixel one filtered map lookup a layer",
    },
];

impl Method {
    #[must_use]
    pub fn row(self) -> &'static MethodRow {
        METHODS.iter().find(|row| row.method == self).unwrap_or(&METHODS[0])
    }

    /// Whether vertices move.
    #[must_use]
    pub fn moves_vertices(self) -> bool {
        matches!(self, Self::Displacement | Self::Vector)
    }

    /// As the command line and the report write it.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().name
    }
}
