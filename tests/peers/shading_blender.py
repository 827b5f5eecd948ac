"""shading_blender.py FOLDER OUT.exr SIZE SAMPLES [--unshadowed] [--distribution GGX]: a `shading_scenes.py` scene by Cycles.

For a Python that has `bpy`. Writes linear colours over black and coverage as f32, the environment's light reflected once, by
a box filter of one pixel, on as many threads as there are processors. --unshadowed lets it through the mesh. Prints
{version, wall_s: [...], cpu_s: [...]} of --repeat N renders of the loaded scene, the file's writing included.

Blender's axes are x, -z, y of glTF's and its v runs up, so images lie as they do in glTF. Its environment has -Z at u = 1/4.
Principled's reflectance is the exact one of an index of 1.5; its highlights scatter more than once, unless --distribution
GGX says otherwise.
"""

import argparse
import json
from pathlib import Path

import bpy
import numpy as np

import blender_mesh
import shading_scenes


def image(file: Path, space: str):
    loaded = bpy.data.images.load(str(file))
    loaded.colorspace_settings.name = space
    return loaded


def pixels_of(loaded) -> np.ndarray:
    """As stored, (H, W, 4), the lowest row first."""
    values = np.empty(loaded.size[0] * loaded.size[1] * 4, np.float32)
    loaded.pixels.foreach_get(values)
    return values.reshape(loaded.size[1], loaded.size[0], 4)


def float_image(values: np.ndarray, file: Path):
    made = bpy.data.images.new(file.stem, values.shape[1], values.shape[0], float_buffer=True)
    made.colorspace_settings.name = "Non-Color"
    made.pixels.foreach_set(np.ascontiguousarray(values, np.float32).ravel())
    made.file_format, made.filepath_raw = "OPEN_EXR", str(file)
    made.save()
    return made


def linear(file: Path, scratch: Path):
    """A map of colours decoded texel by texel: Cycles would filter them as they are encoded."""
    values = pixels_of(image(file, "Non-Color"))
    encoded = values[..., :3]
    values[..., :3] = np.where(encoded <= 0.04045, encoded / 12.92, ((encoded + 0.055) / 1.055) ** 2.4)
    return float_image(values, scratch)


def texture(tree, loaded):
    node = tree.nodes.new("ShaderNodeTexImage")
    node.image, node.interpolation, node.extension = loaded, "Linear", "REPEAT"
    return node


def material(folder: Path, distribution: str, out: Path):
    made = bpy.data.materials.new("surface")
    made.use_nodes = True
    # Light comes from where it comes, however the normals are bent.
    made.cycles.use_bump_map_correction = False
    tree, link = made.node_tree, made.node_tree.links.new
    bsdf = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    bsdf.distribution = distribution
    bsdf.inputs["IOR"].default_value = 1.5
    link(texture(tree, linear(folder / "base.png", out.with_suffix(".base.exr"))).outputs["Color"], bsdf.inputs["Base Color"])
    channels = tree.nodes.new("ShaderNodeSeparateColor")
    link(texture(tree, image(folder / "metallic_roughness.png", "Non-Color")).outputs["Color"], channels.inputs["Color"])
    link(channels.outputs["Green"], bsdf.inputs["Roughness"])
    link(channels.outputs["Blue"], bsdf.inputs["Metallic"])
    bend = tree.nodes.new("ShaderNodeNormalMap")
    bend.uv_map = "uv"
    link(texture(tree, image(folder / "normal.png", "Non-Color")).outputs["Color"], bend.inputs["Color"])
    link(bend.outputs["Normal"], bsdf.inputs["Normal"])
    return made


def matte(tree) -> None:
    """The same without highlights."""
    bsdf = next(node for node in tree.nodes if node.type == "BSDF_PRINCIPLED")
    diffuse = tree.nodes.new("ShaderNodeBsdfDiffuse")
    for name, other in (("Base Color", "Color"), ("Normal", "Normal")):
        tree.links.new(bsdf.inputs[name].links[0].from_socket, diffuse.inputs[other])
    out = next(node for node in tree.nodes if node.type == "OUTPUT_MATERIAL")
    tree.links.new(diffuse.outputs["BSDF"], out.inputs["Surface"])


def world(file: Path, scratch: Path):
    values = pixels_of(image(file, "Non-Color"))
    turned = np.roll(values, round((0.25 - shading_scenes.FORWARD_U) * values.shape[1]), axis=1)
    made = bpy.data.worlds.new("sky")
    made.use_nodes = True
    node = made.node_tree.nodes.new("ShaderNodeTexEnvironment")
    node.image = float_image(turned, scratch)
    background = next(node for node in made.node_tree.nodes if node.type == "BACKGROUND")
    made.node_tree.links.new(node.outputs["Color"], background.inputs["Color"])
    return made


def compose(options) -> None:
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    shape = blender_mesh.made(np.load(options.folder / "mesh.npz"), blender_mesh.BLENDER_AXES, v_up=True)
    surface = material(options.folder, options.distribution, options.out)
    if options.matte:
        matte(surface.node_tree)
    shape.materials.append(surface)
    holder = bpy.data.objects.new("mesh", shape)
    scene.collection.objects.link(holder)
    if options.unshadowed:
        holder.visible_shadow = holder.visible_diffuse = holder.visible_glossy = False
    if options.matte:
        blender_mesh.sun(scene)
    else:
        scene.world = world(options.folder / "environment.exr", options.out.with_suffix(".sky.exr"))
    blender_mesh.look(scene, json.loads((options.folder / "camera.json").read_text()))
    blender_mesh.settle(scene, options.size, options.samples, options.out)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("folder", type=Path)
    parser.add_argument("out", type=Path)
    parser.add_argument("size", type=int)
    parser.add_argument("samples", type=int)
    parser.add_argument("--unshadowed", action="store_true")
    parser.add_argument("--matte", action="store_true", help="diffuse, under a sun in place of the environment")
    parser.add_argument("--distribution", choices=("GGX", "MULTI_GGX"), default="MULTI_GGX")
    parser.add_argument("--repeat", type=int, default=1)
    options = parser.parse_args()
    options.out = options.out.resolve()
    compose(options)
    print("\n" + json.dumps(blender_mesh.timed(options.repeat)))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
