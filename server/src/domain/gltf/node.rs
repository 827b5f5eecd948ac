//! The node tree of the default scene: where meshes and cameras are.

use std::collections::{HashMap, hash_map::Entry};

use glam::{DMat4, DQuat, DVec3};
use rayon::prelude::*;

use super::{Limits, json::At, light, source::Source};
use crate::domain::{
    Error, Result,
    scene::{Camera, PunctualLight, Scene},
};

/// A use of a mesh by a node.
pub(super) struct Use {
    pub(super) gltf_mesh: usize,
    pub(super) world_from_mesh: [f32; 16],
}

#[derive(Default)]
pub(super) struct Graph {
    pub(super) uses: Vec<Use>,
    pub(super) cameras: Vec<Camera>,
    pub(super) lights: Vec<PunctualLight>,
}

pub(super) fn read(source: &Source<'_>, limits: &Limits) -> Result<Graph> {
    let nodes = source.root.list("nodes")?;
    let children = children(&nodes)?;
    let parents = parents(&nodes, &children)?;
    check_tree(&nodes, &children, &parents)?;
    let roots = scene_roots(source, &parents, nodes.len())?;
    let locals: Vec<DMat4> = nodes.iter().map(local).collect::<Result<_>>()?;
    let worlds = worlds(&roots, &children, &locals);
    check_skins(source, nodes.len())?;
    let mut graph = Graph::default();
    let mut skins: HashMap<usize, DMat4> = HashMap::new();
    for (i, at) in nodes.iter().enumerate() {
        let camera = at.index("camera", source.root.count("cameras")?, "cameras")?;
        let mesh = at.index("mesh", source.root.count("meshes")?, "meshes")?;
        let skin = at.index("skin", source.root.count("skins")?, "skins")?;
        let Some(world) = worlds[i] else { continue };
        if let Some(camera) = camera {
            graph.cameras.push(read_camera(source, at, camera, world)?);
        }
        graph.lights.extend(light::of_node(&source.root, at, &world)?);
        let Some(gltf_mesh) = mesh else { continue };
        warn_of_weights(source, at)?;
        let world = match skin {
            None => world,
            Some(skin) => match skins.entry(skin) {
                Entry::Occupied(known) => *known.get(),
                Entry::Vacant(place) => *place.insert(rest_pose(source, skin, &worlds)?),
            },
        };
        for world in instanced(source, at, world, limits.instances - graph.uses.len().min(limits.instances))? {
            let world_from_mesh = world.as_mat4().to_cols_array();
            if !world_from_mesh.iter().all(|x| x.is_finite()) {
                let message = "puts its mesh beyond what f32 holds, or has an instance that is not a number: mend translations and scales from the root to here";
                return Err(at.error(message));
            }
            graph.uses.push(Use { gltf_mesh, world_from_mesh });
        }
        if graph.uses.len() > limits.instances {
            return Err(too_many(at, limits.instances));
        }
    }
    Ok(graph)
}

/// Morph targets are kept and not applied.
pub(super) fn warn_of_weights(source: &Source<'_>, at: &At<'_>) -> Result<()> {
    if at.list("weights")?.iter().any(|weight| weight.value.as_f64() != Some(0.0)) {
        let message = format!("{}.weights are not 0; the mesh is displaced and rendered with all of them 0", at.path);
        source.warn("morph_weights", message);
    }
    Ok(())
}

fn too_many(at: &At<'_>, limit: usize) -> Error {
    Error::too_large(&at.path, format!("the scene uses meshes more than {limit} times: merge or split it"))
}

fn children(nodes: &[At<'_>]) -> Result<Vec<Vec<usize>>> {
    let of_node =
        |at: &At<'_>| at.list("children")?.iter().map(|child| child.index_here(nodes.len(), "nodes")).collect();
    nodes.iter().map(of_node).collect()
}

fn parents(nodes: &[At<'_>], children: &[Vec<usize>]) -> Result<Vec<Option<usize>>> {
    let mut parents = vec![None; nodes.len()];
    for (parent, list) in children.iter().enumerate() {
        for &child in list {
            if let Some(other) = parents[child].replace(parent) {
                return Err(nodes[child]
                    .error(format!("is a child of nodes[{other}] and of nodes[{parent}]; a node has one parent")));
            }
        }
    }
    Ok(parents)
}

/// With one parent each, whatever the roots do not reach goes round in a circle.
fn check_tree(nodes: &[At<'_>], children: &[Vec<usize>], parents: &[Option<usize>]) -> Result<()> {
    let mut reached = vec![false; nodes.len()];
    let mut stack: Vec<usize> = (0..nodes.len()).filter(|&i| parents[i].is_none()).collect();
    while let Some(i) = stack.pop() {
        reached[i] = true;
        stack.extend(&children[i]);
    }
    match reached.iter().position(|r| !r) {
        Some(i) => Err(nodes[i].error("is its own ancestor: nodes must form a tree")),
        None => Ok(()),
    }
}

/// Root nodes of the default scene; every node without a parent where the file has no scene.
fn scene_roots(source: &Source<'_>, parents: &[Option<usize>], nodes: usize) -> Result<Vec<usize>> {
    let scenes = source.root.count("scenes")?;
    let chosen = source.root.index("scene", scenes, "scenes")?;
    for i in 0..scenes {
        source
            .root
            .element("scenes", i)?
            .list("nodes")?
            .iter()
            .try_for_each(|at| at.index_here(nodes, "nodes").map(|_| ()))?;
    }
    if scenes == 0 {
        return Ok((0..nodes).filter(|&i| parents[i].is_none()).collect());
    }
    let scene = source.root.element("scenes", chosen.unwrap_or(0))?;
    let mut roots: Vec<usize> =
        scene.list("nodes")?.iter().map(|at| at.index_here(nodes, "nodes")).collect::<Result<_>>()?;
    roots.sort_unstable();
    roots.dedup();
    // A listed node that another listed node already reaches is not shown twice.
    let shown = below(&roots, parents);
    roots.retain(|&root| !shown[root]);
    Ok(roots)
}

/// Which nodes have one of `listed` among their ancestors. Every node is looked at once or twice.
pub(super) fn below(listed: &[usize], parents: &[Option<usize>]) -> Vec<bool> {
    let mut is_listed = vec![false; parents.len()];
    listed.iter().for_each(|&i| is_listed[i] = true);
    let mut known: Vec<Option<bool>> = vec![None; parents.len()];
    for node in 0..parents.len() {
        let mut path = Vec::new();
        let mut next = Some(node);
        while let Some(i) = next.filter(|&i| known[i].is_none()) {
            path.push(i);
            next = parents[i];
        }
        for i in path.into_iter().rev() {
            known[i] = Some(parents[i].is_some_and(|p| is_listed[p] || known[p] == Some(true)));
        }
    }
    known.into_iter().map(|k| k == Some(true)).collect()
}

pub(super) fn local(at: &At<'_>) -> Result<DMat4> {
    if let Some(matrix) = at.numbers::<16>("matrix")? {
        return Ok(DMat4::from_cols_array(&matrix));
    }
    let (translation, rotation, scale) = parts(at)?;
    Ok(DMat4::from_scale_rotation_translation(scale, rotation, translation))
}

/// Translation, rotation and scale, those of a node without a matrix.
pub(super) fn parts(at: &At<'_>) -> Result<(DVec3, DQuat, DVec3)> {
    let translation = at.numbers("translation")?.map_or(DVec3::ZERO, DVec3::from_array);
    let rotation = at.numbers("rotation")?.map_or(DQuat::IDENTITY, DQuat::from_array);
    let scale = at.numbers("scale")?.map_or(DVec3::ONE, DVec3::from_array);
    Ok((translation, unit(rotation), scale))
}

/// Which nodes are whose children, what they hold, and which of them the default scene shows.
pub(super) struct Tree {
    pub(super) parents: Vec<Option<usize>>,
    /// Nodes of the scene's cameras, as `Graph::cameras` has them.
    pub(super) cameras: Vec<usize>,
    /// Nodes that show a mesh, or are joints of one.
    meshes: Vec<usize>,
}

/// Of a document that `read` has found sound.
pub(super) fn tree(source: &Source<'_>) -> Result<Tree> {
    let nodes = source.root.list("nodes")?;
    let children = children(&nodes)?;
    let parents = parents(&nodes, &children)?;
    let roots = scene_roots(source, &parents, nodes.len())?;
    let below = below(&roots, &parents);
    let is_shown = |i: &usize| below[*i] || roots.contains(i);
    let has = |key: &'static str| (0..nodes.len()).filter(move |i| source.has_in_node(*i, key));
    let mut meshes: Vec<usize> = has("mesh").collect();
    for skin in source.root.list("skins")? {
        for joint in skin.list("joints")? {
            meshes.push(joint.index_here(nodes.len(), "nodes")?);
        }
    }
    let cameras = has("camera").filter(is_shown).collect();
    Ok(Tree { parents, cameras, meshes })
}

impl Tree {
    /// From the root to a node.
    pub(super) fn path(&self, node: usize) -> Vec<usize> {
        let mut path: Vec<usize> = std::iter::successors(Some(node), |node| self.parents[*node]).collect();
        path.reverse();
        path
    }

    /// A node with a mesh that moves when this one does.
    pub(super) fn moves_mesh(&self, node: usize) -> Option<usize> {
        self.meshes.iter().copied().find(|mesh| self.path(*mesh).contains(&node))
    }
}

fn unit(rotation: DQuat) -> DQuat {
    let length = rotation.length();
    if length > 1e-9 { rotation / length } else { DQuat::IDENTITY }
}

fn worlds(roots: &[usize], children: &[Vec<usize>], locals: &[DMat4]) -> Vec<Option<DMat4>> {
    let mut worlds = vec![None; locals.len()];
    let mut stack: Vec<(usize, DMat4)> = roots.iter().map(|&i| (i, DMat4::IDENTITY)).collect();
    while let Some((i, parent)) = stack.pop() {
        let world = parent * locals[i];
        worlds[i] = Some(world);
        stack.extend(children[i].iter().map(|&child| (child, world)));
    }
    worlds
}

fn check_skins(source: &Source<'_>, nodes: usize) -> Result<()> {
    for skin in source.root.list("skins")? {
        let joints = skin.need("joints")?;
        joints.items()?.iter().try_for_each(|joint| joint.index_here(nodes, "nodes").map(|_| ()))?;
        let Some(at) = skin.get("inverseBindMatrices") else { continue };
        let matrices = source.accessor(&at)?;
        let count = joints.items()?.len();
        if matrices.count < count || matrices.components() != 16 || !matrices.is_matrix() {
            return Err(at.error(format!(
                "has {} matrices and the skin {count} joints; one MAT4 each is needed",
                matrices.count
            )));
        }
    }
    Ok(())
}

/// A skinned mesh stands where its first joint puts it; its own node does not count. Exact where the rest
/// pose is the bind pose.
fn rest_pose(source: &Source<'_>, skin: usize, worlds: &[Option<DMat4>]) -> Result<DMat4> {
    let skin = source.root.element("skins", skin)?;
    let matrices = skin.get("inverseBindMatrices").map(|at| source.accessor(&at)?.floats(source)).transpose()?;
    let binds = matrices.as_deref().unwrap_or_default().as_chunks::<16>().0;
    let mut places = Vec::new();
    for (k, joint) in skin.list("joints")?.iter().enumerate() {
        let joint = worlds[joint.index_here(worlds.len(), "nodes")?].unwrap_or(DMat4::IDENTITY);
        places.push(joint * binds.get(k).map_or(DMat4::IDENTITY, |m| DMat4::from_cols_array(&m.map(f64::from))));
    }
    let place = places.first().copied().unwrap_or(DMat4::IDENTITY);
    let size = place.to_cols_array().iter().fold(1.0, |size: f64, entry| size.max(entry.abs()));
    if !places.iter().all(|other| other.abs_diff_eq(place, 1e-3 * size)) {
        let message = "at rest its joints stand otherwise than when they were bound; the mesh is displaced and rendered as it was bound, where its first joint puts it";
        source.warn("posed_skin", format!("{}: {message}", skin.path));
    }
    Ok(place)
}

/// The node's instances by EXT_mesh_gpu_instancing, or the node itself.
fn instanced(source: &Source<'_>, at: &At<'_>, world: DMat4, room: usize) -> Result<Vec<DMat4>> {
    let Some(attributes) = at.extension("EXT_mesh_gpu_instancing").and_then(|e| e.get("attributes")) else {
        return Ok(vec![world]);
    };
    let read = |key: &str, components: usize| -> Result<Option<Vec<f32>>> {
        let Some(at) = attributes.get(key) else { return Ok(None) };
        let accessor = source.accessor(&at)?;
        if accessor.components() != components {
            return Err(at.error(format!("has {} components; {components} are needed", accessor.components())));
        }
        if accessor.count > room {
            return Err(too_many(&at, room));
        }
        accessor.floats(source).map(Some)
    };
    let (translation, rotation, scale) = (read("TRANSLATION", 3)?, read("ROTATION", 4)?, read("SCALE", 3)?);
    let counts = [(&translation, 3), (&rotation, 4), (&scale, 3)];
    let counts: Vec<usize> = counts.iter().filter_map(|(values, n)| values.as_ref().map(|v| v.len() / n)).collect();
    let Some(&count) = counts.first() else { return Ok(vec![world]) };
    if counts.iter().any(|c| *c != count) {
        return Err(attributes.error("have different numbers of instances"));
    }
    let pick = |values: &Option<Vec<f32>>, i: usize, default: DVec3| {
        values.as_ref().map_or(default, |v| DVec3::new(v[3 * i].into(), v[3 * i + 1].into(), v[3 * i + 2].into()))
    };
    let turn = |i: usize| {
        rotation
            .as_ref()
            .map_or(DQuat::IDENTITY, |r| unit(DQuat::from_array([0, 1, 2, 3].map(|k| r[4 * i + k].into()))))
    };
    let one = |i: usize| {
        let (scale, translation) = (pick(&scale, i, DVec3::ONE), pick(&translation, i, DVec3::ZERO));
        world * DMat4::from_scale_rotation_translation(scale, turn(i), translation)
    };
    Ok((0..count).map(one).collect())
}

fn read_camera(source: &Source<'_>, node: &At<'_>, camera: usize, world: DMat4) -> Result<Camera> {
    let at = source.root.element("cameras", camera)?;
    let name = at.text("name")?.map_or_else(|| node.text("name"), |name| Ok(Some(name)))?.map(str::to_owned);
    let world_from_camera = world.as_mat4().to_cols_array();
    let positive = |at: &At<'_>, key: &str| {
        let value = at.need(key)?.number_here()?;
        if value > 0.0 { Ok(value as f32) } else { Err(at.error(format!("{key} is {value}; it must be positive"))) }
    };
    if let Some(lens) = at.get("perspective") {
        let zfar = lens.get("zfar").map(|_| positive(&lens, "zfar")).transpose()?;
        let (yfov, znear) = (positive(&lens, "yfov")?, positive(&lens, "znear")?);
        return Ok(Camera { name, world_from_camera, yfov_radians: Some(yfov), ymag: 0.0, znear, zfar });
    }
    let lens = at.get("orthographic").ok_or_else(|| at.error("has neither perspective nor orthographic"))?;
    let znear = lens.number("znear")?.unwrap_or(0.0).max(0.0) as f32;
    let zfar = Some(positive(&lens, "zfar")?);
    Ok(Camera { name, world_from_camera, yfov_radians: None, ymag: positive(&lens, "ymag")?, znear, zfar })
}

/// Largest number of vertices placed one by one to measure the scene; above it, boxes are placed.
const MEASURED_VERTICES: usize = 1 << 26;

/// Fills `bounds` and `diagonal`: of the instances, or of the meshes where no scene shows them.
pub(super) fn measure(scene: &mut Scene) {
    let identity = DMat4::IDENTITY;
    let mut placed: Vec<(usize, DMat4)> =
        scene.instances.iter().map(|i| (i.mesh, DMat4::from_cols_array(&i.world_from_mesh.map(f64::from)))).collect();
    if placed.is_empty() {
        placed = (0..scene.meshes.len()).map(|mesh| (mesh, identity)).collect();
    }
    let vertices: usize = placed.iter().map(|(mesh, _)| scene.meshes[*mesh].mesh.gv_position.len()).sum();
    let boxes: Vec<Vec<[f32; 3]>> = scene.meshes.iter().map(|m| box_corners(&m.mesh.gv_position)).collect();
    let places =
        |mesh: usize| if vertices > MEASURED_VERTICES { &boxes[mesh] } else { &scene.meshes[mesh].mesh.gv_position };
    let bounds = placed.par_iter().map(|(mesh, world)| bounds(places(*mesh), world)).reduce(|| EMPTY, join);
    if bounds.0.cmple(bounds.1).all() {
        scene.bounds = [bounds.0.as_vec3().to_array(), bounds.1.as_vec3().to_array()];
        scene.diagonal = bounds.0.distance(bounds.1);
    }
}

const EMPTY: (DVec3, DVec3) = (DVec3::INFINITY, DVec3::NEG_INFINITY);

fn join(a: (DVec3, DVec3), b: (DVec3, DVec3)) -> (DVec3, DVec3) {
    (a.0.min(b.0), a.1.max(b.1))
}

fn bounds(positions: &[[f32; 3]], world: &DMat4) -> (DVec3, DVec3) {
    let place = |p: &[f32; 3]| world.transform_point3(DVec3::from_array(p.map(f64::from)));
    positions.par_iter().map(|p| (place(p), place(p))).reduce(|| EMPTY, join)
}

fn box_corners(positions: &[[f32; 3]]) -> Vec<[f32; 3]> {
    let (low, high) = bounds(positions, &DMat4::IDENTITY);
    let ends = [low.as_vec3(), high.as_vec3()];
    (0..8).map(|i| [ends[i & 1].x, ends[i >> 1 & 1].y, ends[i >> 2].z]).collect()
}
