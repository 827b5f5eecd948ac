//! The limit surface of Loop's subdivision, exactly: quartics where the mesh is regular, and ever smaller ones towards
//! vertices that are not, down to where no f32 tells the rest from a quadratic (Stam 1998 without the eigenvectors).
//!
//! Borders and edges of three or more triangles are creases, whose curves are cubic B-splines. A vertex where more than
//! two of them or several sheets meet stays where it is, and keeps the mesh's direction there: it has no one normal.
//! Hard edges of the mesh's normals are no creases.

use std::collections::HashSet;

use displace_glsl::{
    bezier::Net,
    layout::geometry::NONE,
    patches::{PatchNode, Patches},
    reference::bound::summaries,
};
use glam::DVec3;
use rayon::prelude::*;

use super::{
    fan::Fan,
    narrow, quadratic,
    ring::{Around, Corner, Kind},
    table::{Budget, joined},
    wide,
};
use crate::domain::{Error, Result, cancel::Cancel, mesh::Mesh};

/// Splits towards an irregular vertex.
const MOST_SPLITS: u32 = 16;
/// What is left may bend so little, as a share of the mesh's largest coordinate.
const RESOLUTION: f64 = 1.0 / (1 << 24) as f64;
/// Triangles around a vertex: what is made of them grows with the cube of their number.
const MOST_AROUND: usize = 512;

/// Moves the vertices of the mesh to the limit, and returns its patches.
pub(super) fn bend(mesh: &mut Mesh, cancel: &Cancel) -> Result<Patches> {
    check_valence(mesh)?;
    let budget = Budget::new(mesh, cancel)?;
    let vertices = (0..mesh.gv_position.len()).into_par_iter();
    let vertices: Vec<Vertex> = vertices.map(|gv| vertex(mesh, gv, cancel)).collect::<Result<_>>()?;
    let largest = mesh.gv_position.as_flattened().iter().fold(0.0, |most: f32, x| most.max(x.abs()));
    let smallest = f64::from(largest) * RESOLUTION;
    let parts = (0..mesh.triangles.len()).into_par_iter().map(|t| whole(mesh, &vertices, t, smallest, &budget));
    let patches = joined(mesh, parts.collect::<Result<_>>()?);
    for (gv, vertex) in vertices.iter().enumerate() {
        let Some(limit) = vertex.limit else { continue };
        mesh.gv_position[gv] = narrow(limit);
        let Some(normal) = vertex.normal else { continue };
        mesh.gv_direction[gv] = narrow(normal);
        let avs = mesh.gv_av.offsets[gv] as usize..mesh.gv_av.offsets[gv + 1] as usize;
        mesh.gv_av.items[avs].iter().for_each(|av| mesh.av_normal[*av as usize] = narrow(normal));
    }
    Ok(patches)
}

/// A geometric vertex under Loop's rules.
struct Vertex {
    kind: Kind,
    /// None where no triangle has it.
    limit: Option<DVec3>,
    /// Unit; none where sheets meet, and where they turn over.
    normal: Option<DVec3>,
}

/// Around one of many triangles this is long work: fails where the job is cancelled.
fn vertex(mesh: &Mesh, gv: usize, cancel: &Cancel) -> Result<Vertex> {
    cancel.check()?;
    let corners = mesh.gv_corner.list(gv);
    let Some(first) = corners.first() else { return Ok(Vertex { kind: Kind::Fixed, limit: None, normal: None }) };
    let fan = Fan::new(mesh, *first);
    let kind = kind(mesh, corners, &fan);
    let corner = fan.corner(mesh, kind);
    let whole = fan.triangles.len() == corners.len();
    let turns = fan
        .triangles
        .iter()
        .any(|(t, turned)| facing(mesh, *t) != facing(mesh, fan.first()) * if *turned { -1.0 } else { 1.0 });
    let normal = (corner.normal() * facing(mesh, fan.first())).try_normalize().filter(|_| whole && !turns);
    Ok(Vertex { kind, limit: Some(corner.limit()), normal })
}

/// Creases end at a vertex that has not just two.
fn kind(mesh: &Mesh, corners: &[u32], fan: &Fan) -> Kind {
    if fan.closed {
        return if fan.triangles.len() == corners.len() { Kind::Inside } else { Kind::Fixed };
    }
    let (mut creases, mut seen) = (HashSet::new(), HashSet::new());
    for corner in corners {
        if seen.contains(&(*corner / 3)) {
            continue;
        }
        let other = Fan::new(mesh, *corner);
        if other.closed {
            return Kind::Fixed;
        }
        seen.extend(other.triangles.iter().map(|(t, _)| *t));
        creases.extend([other.ring[0], other.ring[other.ring.len() - 1]]);
    }
    if creases.len() == 2 { Kind::Border } else { Kind::Fixed }
}

/// The parts of triangle t; indices count from the first.
fn whole(mesh: &Mesh, vertices: &[Vertex], t: usize, smallest: f64, budget: &Budget<'_>) -> Result<Patches> {
    // The fans around its corners are long work.
    budget.take(0)?;
    let gvs = mesh.triangles[t].av.map(|av| mesh.av_gv[av as usize] as usize);
    let corner = |k: usize| Fan::new(mesh, (3 * t + k) as u32).corner(mesh, vertices[gvs[k]].kind);
    let side = facing(mesh, t as u32) as f32;
    let mut parts = Parts { made: Patches::default(), smallest, side, budget };
    let none = PatchNode { parts: NONE, points: 0, degree: 0, normals: NONE, given: NONE, side };
    parts.made.nodes.push(none);
    parts.fill(0, &Around([corner(0), corner(1), corner(2)]), MOST_SPLITS)?;
    if gvs.iter().any(|gv| vertices[*gv].normal.is_none()) {
        let mask = gvs.map(|gv| f32::from(u8::from(vertices[gv].normal.is_none())));
        let directions = gvs.map(|gv| mesh.gv_direction[gv]);
        parts.made.nodes[0].given = parts.add([mask, directions[0], directions[1], directions[2]]);
    }
    parts.made.summaries = summaries(&parts.made);
    Ok(parts.made)
}

/// Parts of one triangle as they are made.
struct Parts<'b> {
    made: Patches,
    smallest: f64,
    side: f32,
    budget: &'b Budget<'b>,
}

impl Parts<'_> {
    fn fill(&mut self, node: usize, around: &Around, splits: u32) -> Result<()> {
        if let Some(net) = around.quartic() {
            let points = self.add_net(&net);
            self.made.nodes[node] = PatchNode { points, degree: 4, ..self.made.nodes[node] };
            return Ok(());
        }
        let limits = around.0.each_ref().map(Corner::limit);
        let middles = [0, 1, 2].map(|k| around.middle(k));
        let bend = |k: usize| middles[k].limit().distance(0.5 * (limits[k] + limits[(k + 1) % 3]));
        if splits == 0 || (0..3).all(|k| bend(k) <= self.smallest) {
            self.end(node, around, &middles);
            return Ok(());
        }
        self.budget.take(4)?;
        let first = self.made.nodes.len();
        self.made.nodes[node].parts = first as u32;
        let none = PatchNode { parts: NONE, given: NONE, ..self.made.nodes[node] };
        self.made.nodes.extend([none; 4]);
        for (k, part) in around.parts().iter().enumerate() {
            self.fill(first + k, part, splits - 1)?;
        }
        Ok(())
    }

    /// Quadratics through the limits at corners and middles of sides, and through the normals there.
    fn end(&mut self, node: usize, around: &Around, middles: &[Corner; 3]) {
        let between = |corners: [DVec3; 3], middles: [DVec3; 3]| {
            let control = |k: usize| 2.0 * middles[k] - 0.5 * (corners[k] + corners[(k + 1) % 3]);
            quadratic(corners, [control(0), control(1), control(2)])
        };
        let [a, b, c] = around.0.each_ref().map(Corner::limit);
        let flat = (b - a).cross(c - a).normalize_or_zero();
        let normal = |corner: &Corner| f64::from(self.side) * corner.normal().try_normalize().unwrap_or(flat);
        let normals = between(around.0.each_ref().map(normal), middles.each_ref().map(normal));
        let places = between([a, b, c], middles.each_ref().map(Corner::limit));
        let points = self.add_net(&Net::new(2, |j, k| places[displace_glsl::bezier::index(2, j, k)]));
        let normals = self.add([normals, normals].concat().into_iter().map(narrow));
        self.made.nodes[node] = PatchNode { points, degree: 2, normals, ..self.made.nodes[node] };
    }

    /// The first point, and all less it: small patches keep their digits.
    fn add_net(&mut self, net: &Net) -> u32 {
        let origin = narrow(net.point(0, 0));
        let first = self.add([origin]);
        self.add(net.points().iter().map(|p| narrow(*p - wide(origin))));
        first
    }

    fn add(&mut self, points: impl IntoIterator<Item = [f32; 3]>) -> u32 {
        let first = self.made.points.len() as u32;
        self.made.points.extend(points);
        first
    }
}

fn check_valence(mesh: &Mesh) -> Result<()> {
    let around = (0..mesh.gv_position.len()).map(|gv| mesh.gv_corner.list(gv).len()).max().unwrap_or(0);
    if around <= MOST_AROUND {
        return Ok(());
    }
    let message = format!(
        "a vertex of mesh '{}' has {around} triangles around it; base loop takes {MOST_AROUND} at most: use base pn, or split the fan",
        mesh.name
    );
    Err(Error::too_large("geometry.base", message))
}

/// The side of the triangle's winding on which its normals are.
fn facing(mesh: &Mesh, t: u32) -> f64 {
    let av = mesh.triangles[t as usize].av;
    let [a, b, c] = av.map(|av| super::place(mesh, av));
    let normals: DVec3 = av.iter().map(|av| wide(mesh.av_normal[*av as usize])).sum();
    if (b - a).cross(c - a).dot(normals) < 0.0 { -1.0 } else { 1.0 }
}
