//! The validated base mesh: geometric vertices (one per place), attribute vertices (one per place and
//! look), and the edges both own. Built once from a glTF mesh; every pass reads it.

use std::sync::Arc;

use displace_glsl::patches::Patches;

/// One base mesh in its own local space: all triangle primitives of one glTF mesh, welded together.
///
/// Words: `gv` geometric vertex, `av` attribute vertex, `ge` geometric edge, `ae` attribute edge.
///
/// Invariants
/// * A gv's id is its rank in the order of its three position bit patterns (−0 counts as +0).
/// * An av belongs to one gv and one primitive; avs are sorted by (primitive, gv, attribute bits), so a
///   primitive's avs are contiguous. `gv_av` lists the avs of a gv in ascending id.
/// * A ge joins two different gvs and runs from the lower id to the higher. An ae runs the same way as
///   its ge. aes are sorted by (primitive, ge, avs): a primitive's aes are contiguous.
/// * Triangles are sorted by primitive and otherwise keep the order of the file. None has two corners
///   on one gv: such triangles are removed and counted in `degenerate_triangles`.
/// * Positions are finite; normals are unit length.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    pub name: String,
    /// Local units.
    pub gv_position: Vec<[f32; 3]>,
    /// Mitred welded displacement direction of each gv: n·D = 1 for the wedge normals n where possible.
    pub gv_direction: Vec<[f32; 3]>,
    pub gv_av: Csr,
    /// Incident triangles of each gv as `triangle * 3 + corner`, ascending.
    pub gv_corner: Csr,
    pub av_gv: Vec<u32>,
    /// Unit normals; flat ones where the file has none.
    pub av_normal: Vec<[f32; 3]>,
    /// Unit tangent and handedness (+1 or −1), all 0 in primitives without; empty when no primitive has any.
    /// `weld::with_tangents` makes them for a detail that needs them.
    pub av_tangent: Vec<[f32; 4]>,
    /// Everything else that is interpolated, TEXCOORD_n and COLOR_n first.
    pub attributes: Vec<Attribute>,
    pub ge_gv: Vec<[u32; 2]>,
    pub ge_ae: Csr,
    /// Incident triangles of each ge as `triangle * 3 + side`, ascending; side k joins corners k and k+1.
    pub ge_side: Csr,
    pub ae_av: Vec<[u32; 2]>,
    pub ae_ge: Vec<u32>,
    /// Of a base that is not flat; see [`super::base`]. Loop's moves vertices, after their ids are given.
    pub patches: Option<Arc<Patches>>,
    pub triangles: Vec<Triangle>,
    pub primitives: Vec<Primitive>,
    pub health: MeshHealth,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Triangle {
    pub av: [u32; 3],
    /// `ae[k]` joins `av[k]` and `av[(k + 1) % 3]`.
    pub ae: [u32; 3],
    pub primitive: u32,
}

/// A triangle primitive of the glTF mesh and its contiguous ranges.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Primitive {
    /// Index of the primitive in the glTF mesh.
    pub gltf_primitive: usize,
    /// Index of the glTF material.
    pub material: Option<usize>,
    /// The tangents were made for a detail; the file has none.
    pub made_tangents: bool,
    pub avs: std::ops::Range<u32>,
    pub aes: std::ops::Range<u32>,
    pub triangles: std::ops::Range<u32>,
}

/// An interpolated attribute: `values.len() == components * avs`; avs of primitives that lack it hold 0.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute {
    /// glTF semantic such as `TEXCOORD_0`, `COLOR_0`, `JOINTS_0`, `WEIGHTS_0`, `_CUSTOM`, or a morph
    /// target's as `targets/2/POSITION`.
    pub semantic: String,
    pub components: usize,
    pub values: Vec<f32>,
    /// Which primitives of the mesh carry it.
    pub primitives: Vec<bool>,
}

/// Lists of lists: list `i` is `items[offsets[i]..offsets[i + 1]]`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Csr {
    pub offsets: Vec<u32>,
    pub items: Vec<u32>,
}

impl Csr {
    #[must_use]
    pub fn list(&self, i: usize) -> &[u32] {
        &self.items[self.offsets[i] as usize..self.offsets[i + 1] as usize]
    }

    /// Builds the lists from (list, item) pairs; items keep the order of the pairs.
    #[must_use]
    pub fn from_pairs(lists: usize, pairs: &[(u32, u32)]) -> Self {
        let mut offsets = vec![0u32; lists + 1];
        for &(list, _) in pairs {
            offsets[list as usize + 1] += 1;
        }
        for i in 0..lists {
            offsets[i + 1] += offsets[i];
        }
        let mut next = offsets.clone();
        let mut items = vec![0; pairs.len()];
        for &(list, item) in pairs {
            items[next[list as usize] as usize] = item;
            next[list as usize] += 1;
        }
        Self { offsets, items }
    }
}

/// What welding found, for `describe` and for warnings.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct MeshHealth {
    pub degenerate_triangles: u32,
    pub boundary_edges: u32,
    /// Edges with more than two triangles.
    pub non_manifold_edges: u32,
    /// Edges whose two triangles run the same way round.
    pub opposite_winding_edges: u32,
    /// Edges with two triangles and more than one ae: UV seams and hard edges.
    pub seam_edges: u32,
    pub normals_generated: bool,
    /// Normals of the file that were zero, not finite or not unit length.
    pub normals_repaired: u32,
}

impl Mesh {
    #[must_use]
    pub fn has_tangents(&self, primitive: &Primitive) -> bool {
        self.av_tangent.get(primitive.avs.start as usize).is_some_and(|t| t[3] != 0.0)
    }

    /// How far a smooth base reaches at most beyond the box of the vertices, along any axis; mesh-local units.
    #[must_use]
    pub fn bulge(&self) -> f64 {
        self.patches.as_ref().map_or(0.0, |patches| patches.bulge(&self.gv_position))
    }

    /// Whether a skin or morph targets may move it.
    #[must_use]
    pub fn is_deformed(&self) -> bool {
        self.attributes.iter().any(|a| a.semantic.starts_with("JOINTS_") || a.semantic.starts_with("targets/"))
    }

    #[must_use]
    pub fn attribute(&self, semantic: &str) -> Option<&Attribute> {
        self.attributes.iter().find(|a| a.semantic == semantic)
    }
}
