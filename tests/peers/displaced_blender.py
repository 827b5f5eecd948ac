"""displaced_blender.py MESH.npz HEIGHT.png CAMERA.json OUT.exr SIZE SAMPLES SCALE MIDLEVEL [--repeat N]: Cycles' adaptive dicing.

For a Python that has `bpy`. The mesh is diced to edges of one pixel and displaced along its normals by SCALE times (map -
MIDLEVEL), under a sun, in grey. Prints {version, wall_s: [...], cpu_s: [...]} of N renders, dicing and writing included.
"""

import json
import sys
from pathlib import Path

import bpy
import numpy as np

import blender_mesh


def material(height: str, scale: float, midlevel: float):
    made = bpy.data.materials.new("surface")
    made.use_nodes, made.displacement_method = True, "DISPLACEMENT"
    tree, link = made.node_tree, made.node_tree.links.new
    tree.nodes.clear()
    out, bsdf, move = (tree.nodes.new(f"ShaderNode{kind}") for kind in ("OutputMaterial", "BsdfDiffuse", "Displacement"))
    texture = tree.nodes.new("ShaderNodeTexImage")
    texture.image = bpy.data.images.load(height)
    texture.image.colorspace_settings.name = "Non-Color"
    move.inputs["Scale"].default_value, move.inputs["Midlevel"].default_value = scale, midlevel
    link(texture.outputs["Color"], move.inputs["Height"])
    link(move.outputs["Displacement"], out.inputs["Displacement"])
    link(bsdf.outputs["BSDF"], out.inputs["Surface"])
    return made


def main() -> int:
    mesh, height, camera, out, size, samples, scale, midlevel, _, repeat = sys.argv[1:]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    shape = blender_mesh.made(np.load(mesh), blender_mesh.BLENDER_AXES, v_up=True)
    shape.materials.append(material(height, float(scale), float(midlevel)))
    holder = bpy.data.objects.new("mesh", shape)
    scene.collection.objects.link(holder)
    blender_mesh.look(scene, json.loads(Path(camera).read_text()))
    blender_mesh.sun(scene)
    blender_mesh.settle(scene, int(size), int(samples), Path(out).resolve())
    scene.cycles.dicing_rate, scene.cycles.max_subdivisions = 1.0, 14
    dice = holder.modifiers.new("dice", "SUBSURF")
    dice.subdivision_type, dice.levels, dice.render_levels, dice.uv_smooth = "SIMPLE", 0, 0, "NONE"
    dice.use_adaptive_subdivision, dice.adaptive_space, dice.adaptive_pixel_size = True, "PIXEL", 1.0
    print("\n" + json.dumps(blender_mesh.timed(int(repeat))))
    return 0


if __name__ == "__main__":
    sys.exit(main())
