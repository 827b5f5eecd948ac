//! The methods that realise a detail: one enum, one table.

use crate::{
    ComputeShader, SHADERS,
    reference::relief::{self, Marched},
};

/// How a detail is realised.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize)]
pub enum Method {
    Flat,
    #[default]
    Displacement,
    Vector,
    Bump,
    Normal,
    Steep,
    Occlusion,
    Relief,
    Parallax,
    ParallaxLimited,
    ParallaxIterative,
    Cone,
    Exact,
    Auto,
}

/// How a method finds per pixel what is seen of heights.
#[derive(Clone, Copy, Debug)]
pub struct Marcher {
    pub shader: &'static ComputeShader,
    pub twin: Marched,
    /// Whether it finds the surface; else maps are shifted, and what is seen stays as far away as it is.
    pub finds_depth: bool,
    /// What the map needs besides heights.
    pub needs: Needs,
    /// What the shader is told unless a measurement says else; the twin says what it means.
    pub setting: f32,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Needs {
    Heights,
    /// Greatest heights of cells and of what they add up to.
    Bounds,
    /// Cones of texels.
    Cones,
}

/// A row of the table.
#[derive(Clone, Copy, Debug)]
pub struct MethodRow {
    pub method: Method,
    pub name: &'static str,
    pub summary: &'static str,
    /// The kinds of detail it can show.
    pub represents: &'static [&'static str],
    /// Where the cost lies.
    pub cost: &'static str,
    /// Of those that work per pixel.
    pub marcher: Option<Marcher>,
}

/// Every method of this version.
pub const METHODS: &[MethodRow] = &[
    MethodRow {
        method: Method::Flat,
        name: "flat",
        summary: "The mesh as it is, subdivided, without its detail.",
        represents: &[],
        cost: "triangles",
        marcher: None,
    },
    MethodRow {
        method: Method::Displacement,
        name: "displacement",
        summary: "Moves vertices along the welded direction by heights (Cook 1984).",
        represents: &["height", "expression", "normal"],
        cost: "triangles; per vertex one map lookup a layer",
        marcher: None,
    },
    MethodRow {
        method: Method::Vector,
        name: "vector",
        summary: "Moves vertices by vectors, so that overhangs are possible.",
        represents: &["vector", "expression", "normal"],
        cost: "triangles; per vertex one map lookup a layer",
        marcher: None,
    },
    MethodRow {
        method: Method::Bump,
        name: "bump",
        summary: "Bends normals by the slopes of heights and by normal maps, which add (Blinn 1978, Mikkelsen 2010).",
        represents: &["height", "expression", "normal"],
        cost: "per pixel one filtered map lookup a layer",
        marcher: None,
    },
    MethodRow {
        method: Method::Normal,
        name: "normal",
        summary: "Bends normals by normal maps, in tangent or object space (Peercy et al. 1997).",
        represents: &["normal"],
        cost: "per pixel one filtered map lookup a layer",
        marcher: None,
    },
    MethodRow {
        method: Method::Steep,
        name: "steep",
        summary: "Walks along the view ray in even steps until it is below the heights (McGuire and McGuire 2005).",
        represents: &["height", "normal"],
        cost: "per pixel one map lookup a step, as many as the angle asks for",
        marcher: Some(Marcher {
            shader: &SHADERS.steep,
            twin: relief::steep::marched,
            finds_depth: true,
            needs: Needs::Heights,
            setting: 0.0,
        }),
    },
    MethodRow {
        method: Method::Occlusion,
        name: "occlusion",
        summary: "Walks in even steps and takes the surface as straight along the last (Tatarchuk 2006).",
        represents: &["height", "normal"],
        cost: "per pixel one map lookup a step, as many as the angle asks for",
        marcher: Some(Marcher {
            shader: &SHADERS.occlusion,
            twin: relief::occlusion::marched,
            finds_depth: true,
            needs: Needs::Heights,
            setting: 0.0,
        }),
    },
    MethodRow {
        method: Method::Relief,
        name: "relief",
        summary: "Walks in even steps and halves the last five times (Policarpo, Oliveira and Comba 2005).",
        represents: &["height", "normal"],
        cost: "per pixel one map lookup a step, as many as the angle asks for, and five",
        marcher: Some(Marcher {
            shader: &SHADERS.relief,
            twin: relief::relief::marched,
            finds_depth: true,
            needs: Needs::Heights,
            setting: 0.0,
        }),
    },
    MethodRow {
        method: Method::Parallax,
        name: "parallax",
        summary: "Reads maps where the view ray would meet a level surface (Kaneko et al. 2001).",
        represents: &["height", "normal"],
        cost: "per pixel one map lookup",
        marcher: Some(Marcher {
            shader: &SHADERS.parallax,
            twin: relief::parallax::marched,
            finds_depth: false,
            needs: Needs::Heights,
            setting: 0.0,
        }),
    },
    MethodRow {
        method: Method::ParallaxLimited,
        name: "parallax-limited",
        summary: "Shifts as parallax, at most by the height (Welsh 2004).",
        represents: &["height", "normal"],
        cost: "per pixel one map lookup",
        marcher: Some(Marcher {
            shader: &SHADERS.parallax_limited,
            twin: relief::parallax_limited::marched,
            finds_depth: false,
            needs: Needs::Heights,
            setting: 0.0,
        }),
    },
    MethodRow {
        method: Method::ParallaxIterative,
        name: "parallax-iterative",
        summary: "Goes on along the view ray by heights and slopes, four times (Premecz 2006).",
        represents: &["height", "normal"],
        cost: "per pixel four map lookups",
        marcher: Some(Marcher {
            shader: &SHADERS.parallax_iterative,
            twin: relief::parallax_iterative::marched,
            finds_depth: false,
            needs: Needs::Heights,
            setting: 0.0,
        }),
    },
    MethodRow {
        method: Method::Cone,
        name: "cone",
        summary: "Walks as far as relaxed cones reach and halves the last step (Policarpo and Oliveira 2007).",
        represents: &["height", "normal"],
        cost: "a map of cones; per pixel two map lookups a step, and some",
        marcher: Some(Marcher {
            shader: &SHADERS.cone,
            twin: relief::cone::marched,
            finds_depth: true,
            needs: Needs::Cones,
            setting: 0.0,
        }),
    },
    MethodRow {
        method: Method::Exact,
        name: "exact",
        summary: "Finds where the view ray meets the heights first, by greatest heights and closed form (Tevs et al. 2008).",
        represents: &["height", "normal"],
        cost: "per pixel 2 to 30 map lookups, as the angle and the heights ask for",
        marcher: Some(Marcher {
            shader: &SHADERS.exact,
            twin: relief::exact::marched,
            finds_depth: true,
            needs: Needs::Bounds,
            // Measured: cells are faster where 6 lattice lines are crossed, nodes where 19 are.
            setting: 12.0,
        }),
    },
    MethodRow {
        method: Method::Auto,
        name: "auto",
        summary: "For each material the cheapest that is predicted to be within a tolerance in pixels.",
        represents: &["height", "vector", "expression", "normal"],
        cost: "as that of what it chooses; before it, a pyramid of each map",
        marcher: None,
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

    /// How it finds per pixel what is seen of heights; none of those that do not.
    #[must_use]
    pub fn marcher(self) -> Option<&'static Marcher> {
        self.row().marcher.as_ref()
    }

    /// As the command line and the report write it.
    #[must_use]
    pub fn name(self) -> &'static str {
        self.row().name
    }
}
