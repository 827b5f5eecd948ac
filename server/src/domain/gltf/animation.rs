//! Animations that move cameras: where a camera of the scene is, at any time.
//!
//! The nodes from the root down to the camera are moved by channels of translation, rotation and scale (glTF 2.0, 3.11). What
//! moves meshes is refused by name: surfaces are displaced once.

mod track;

use glam::{DMat4, DQuat, DVec3};

use super::{
    Limits,
    json::At,
    node::{self, Tree},
    source::Source,
};
use crate::domain::{Error, ErrorKind, Result, report::Warning, scene::Scene};
use track::Track;

/// Field of errors about the choice.
const FIELD: &str = "sequence.animation";

/// The way a camera goes.
#[derive(Clone, Debug)]
pub struct CameraWay {
    /// From the root to the camera.
    nodes: Vec<Moved>,
    /// Of the first and the last key of the animation, seconds.
    pub seconds: [f64; 2],
}

/// A node, and what moves it.
#[derive(Clone, Debug)]
struct Moved {
    rest: DMat4,
    /// Translation, rotation and scale of the node at rest; a matrix has none, and no channel may move it.
    parts: (DVec3, DQuat, DVec3),
    translation: Option<Track>,
    rotation: Option<Track>,
    scale: Option<Track>,
}

impl CameraWay {
    /// Column-major; the camera looks along its own -z.
    #[must_use]
    pub fn world_from_camera(&self, seconds: f64) -> [f32; 16] {
        let world = self.nodes.iter().fold(DMat4::IDENTITY, |world, node| world * node.local(seconds));
        world.as_mat4().to_cols_array()
    }
}

impl Moved {
    fn local(&self, seconds: f64) -> DMat4 {
        if self.translation.is_none() && self.rotation.is_none() && self.scale.is_none() {
            return self.rest;
        }
        let (translation, rotation, scale) = self.parts;
        let vector = |track: &Option<Track>, rest| track.as_ref().map_or(rest, |track| track.vector(seconds));
        let turn = self.rotation.as_ref().map_or(rotation, |track| track.rotation(seconds));
        DMat4::from_scale_rotation_translation(vector(&self.scale, scale), turn, vector(&self.translation, translation))
    }
}

/// The way of camera number `camera` of the scene under the animation of that name, or of that number in the file. Warns of
/// channels that move neither the camera nor a mesh.
pub fn camera_way(scene: &Scene, camera: usize, animation: &str) -> Result<(CameraWay, Option<Warning>)> {
    let root = At::root(&scene.document);
    let uris: Vec<Option<&str>> = root.list("buffers")?.iter().map(|at| at.text("uri")).collect::<Result<_>>()?;
    let resources = |uri: &str| scene.buffers.get(uris.iter().position(|own| *own == Some(uri))?).cloned();
    let source = Source::open(&root, scene.buffers.first().cloned(), &resources, &Limits::default())?;
    let tree = node::tree(&source)?;
    let Some(own) = tree.cameras.get(camera) else {
        return Err(Error::invalid(
            FIELD,
            "moves a camera of the file, and it has none: leave it out, and give an orbit",
        ));
    };
    let chosen = chosen(&root, animation)?;
    let way = Chain { source: &source, tree: &tree, nodes: tree.path(*own) };
    way.moved_by(&chosen, animation)
}

/// By name, else by number.
fn chosen<'a>(root: &At<'a>, animation: &str) -> Result<At<'a>> {
    let all = root.list("animations")?;
    let mut names = Vec::new();
    for (number, at) in all.iter().enumerate() {
        let name = at.text("name")?;
        if name == Some(animation) {
            return Ok(at.clone());
        }
        names.push(name.map_or_else(|| number.to_string(), |name| format!("'{name}'")));
    }
    let by_number = animation.parse().ok().and_then(|number: usize| all.get(number).cloned());
    by_number.ok_or_else(|| {
        let known = if names.is_empty() { "none".into() } else { names.join(", ") };
        let message = format!("the file has no animation '{animation}'; it has {known}");
        Error::new(ErrorKind::NotFound, message).with_field(FIELD)
    })
}

/// The nodes from the root to the camera.
struct Chain<'a> {
    source: &'a Source<'a>,
    tree: &'a Tree,
    nodes: Vec<usize>,
}

impl Chain<'_> {
    fn moved_by(&self, animation: &At<'_>, name: &str) -> Result<(CameraWay, Option<Warning>)> {
        let mut moved: Vec<Moved> = self.nodes.iter().map(|node| self.at_rest(*node)).collect::<Result<_>>()?;
        let (mut seconds, mut is_moved, mut others) = ([f64::INFINITY, f64::NEG_INFINITY], false, 0);
        for channel in animation.list("channels")? {
            let target = channel.need("target")?;
            // Without a node it is an extension's.
            let Some(node) = target.index("node", self.tree.parents.len(), "nodes")? else { continue };
            let path = target.need("path")?.text_here()?;
            self.refuse_meshes(&target, node, name)?;
            let Some(own) = self.nodes.iter().position(|known| *known == node) else {
                others += 1;
                continue;
            };
            let track = Track::read(self.source, animation, &channel, if path == "rotation" { 4 } else { 3 })?;
            seconds = [seconds[0].min(track.seconds()[0]), seconds[1].max(track.seconds()[1])];
            moved[own].take(path, track, &target)?;
            is_moved = true;
        }
        if !is_moved {
            let message = format!("animation '{name}' does not move the camera: choose another, or leave it out");
            return Err(Error::invalid(FIELD, message));
        }
        let warning = (others > 0).then(|| {
            let message =
                format!("{others} channels of animation '{name}' move neither the camera nor a mesh, and show nothing");
            Warning::new("animation_channels_ignored", message)
        });
        Ok((CameraWay { nodes: moved, seconds }, warning))
    }

    fn at_rest(&self, node: usize) -> Result<Moved> {
        let at = self.source.root.element("nodes", node)?;
        let (rest, parts) = (node::local(&at)?, node::parts(&at)?);
        Ok(Moved { rest, parts, translation: None, rotation: None, scale: None })
    }

    /// Nothing may move that has a mesh below it, nor a joint that bends one.
    fn refuse_meshes(&self, target: &At<'_>, node: usize, name: &str) -> Result<()> {
        let Some(mesh) = self.tree.moves_mesh(node) else { return Ok(()) };
        let at = self.source.root.element("nodes", mesh)?;
        let shown = at.text("name")?.map_or_else(|| format!("nodes[{mesh}]"), |name| format!("'{name}'"));
        let message = format!(
            "animation '{name}' moves the mesh of node {shown} ({}); only cameras move: choose an animation that moves cameras alone",
            target.path
        );
        Err(Error::unsupported(FIELD, message))
    }
}

impl Moved {
    fn take(&mut self, path: &str, track: Track, target: &At<'_>) -> Result<()> {
        let place = match path {
            "translation" => &mut self.translation,
            "rotation" => &mut self.rotation,
            "scale" => &mut self.scale,
            other => return Err(target.error(format!("has the path '{other}'; a camera has none such"))),
        };
        *place = Some(track);
        Ok(())
    }
}

#[cfg(test)]
mod tests;
