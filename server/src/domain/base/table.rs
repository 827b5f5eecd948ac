//! The patches of all triangles as one table, and how many there may be.

use std::sync::atomic::{AtomicUsize, Ordering};

use displace_glsl::{
    layout::geometry::NONE,
    patches::{PatchNode, Patches, on_edge},
};

use crate::domain::{Error, Result, cancel::Cancel, mesh::Mesh};

/// Parts of all triangles of a mesh: 250 MB.
const MOST_NODES: usize = 1 << 20;

/// What is left of the parts that a mesh may have, while threads make them.
pub(super) struct Budget<'b> {
    mesh: &'b str,
    made: AtomicUsize,
    most: usize,
    cancel: &'b Cancel,
}

impl<'b> Budget<'b> {
    /// Every triangle takes one part at least.
    pub(super) fn new(mesh: &'b Mesh, cancel: &'b Cancel) -> Result<Self> {
        Self::of(&mesh.name, mesh.triangles.len(), MOST_NODES, cancel)
    }

    fn of(mesh: &'b str, triangles: usize, most: usize, cancel: &'b Cancel) -> Result<Self> {
        let budget = Self { mesh, made: AtomicUsize::new(0), most, cancel };
        budget.take(triangles)?;
        Ok(budget)
    }

    /// Fails where more are made than there may be, or the job is cancelled.
    pub(super) fn take(&self, parts: usize) -> Result<()> {
        self.cancel.check()?;
        let made = self.made.fetch_add(parts, Ordering::Relaxed) + parts;
        if made <= self.most {
            return Ok(());
        }
        let message = format!(
            "loop makes more than the {} patches that are kept of mesh '{}': use base pn, or a mesh with fewer triangles or with six at most vertices",
            self.most, self.mesh
        );
        Err(Error::too_large("geometry.base", message))
    }
}

/// The parts of all triangles as one table: whole triangles first.
pub(super) fn joined(mesh: &Mesh, parts: Vec<Patches>) -> Patches {
    let mut all = Patches { edges: edges(mesh), ..Patches::default() };
    let mut next = parts.len() as u32;
    let (mut rest, mut summaries) = (Vec::new(), Vec::new());
    for part in parts {
        let points = all.points.len() as u32;
        let moved = |index: u32, by: u32| if index == NONE { NONE } else { index + by };
        // A whole triangle's parts start at 1 of its own table.
        let node = |node: &PatchNode| PatchNode {
            parts: if node.parts == NONE { NONE } else { node.parts - 1 + next },
            points: node.points + points,
            normals: moved(node.normals, points),
            given: moved(node.given, points),
            ..*node
        };
        all.nodes.push(node(&part.nodes[0]));
        rest.extend(part.nodes[1..].iter().map(node));
        next += part.nodes.len() as u32 - 1;
        all.points.extend(part.points);
        all.summaries.push(part.summaries[0]);
        summaries.extend_from_slice(&part.summaries[1..]);
    }
    all.nodes.extend(rest);
    all.summaries.extend(summaries);
    all
}

/// Where each ae lies: on the first triangle of its geometric edge, so that all sides are one place.
fn edges(mesh: &Mesh) -> Vec<u32> {
    let place = |ge: &u32| {
        let side = mesh.ge_side.list(*ge as usize)[0];
        let (t, k) = (side / 3, side % 3);
        let from = mesh.triangles[t as usize].av[k as usize];
        on_edge(t, k, mesh.ge_gv[*ge as usize][0] != mesh.av_gv[from as usize])
    };
    mesh.ae_ge.iter().map(place).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::domain::ErrorKind;

    #[test]
    fn parts_beyond_the_limit_are_refused_while_they_are_made() {
        let cancel = Cancel::default();
        let budget = Budget::of("wall", 2, 10, &cancel).unwrap();
        assert!(budget.take(4).is_ok() && budget.take(4).is_ok());
        let error = budget.take(4).unwrap_err();
        assert_eq!((error.kind, error.field.as_deref()), (ErrorKind::TooLarge, Some("geometry.base")));
        for part in ["more than the 10 patches", "'wall'", "base pn"] {
            assert!(error.message.contains(part), "{part}: {}", error.message);
        }
        assert!(Budget::of("wall", 11, 10, &cancel).is_err(), "before anything is made");
    }

    #[test]
    fn a_cancelled_job_makes_no_more_parts() {
        let cancel = Cancel::default();
        let budget = Budget::of("wall", 2, 10, &cancel).unwrap();
        cancel.cancel();
        assert_eq!(budget.take(0).unwrap_err().kind, ErrorKind::Cancelled);
    }
}
