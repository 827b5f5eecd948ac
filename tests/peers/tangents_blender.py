"""tangents_blender.py MESH.npz OUT.npy: Blender's `calc_tangents` of a triangle mesh, for a Python that has `bpy`.

MESH.npz: f32 positions and normals (V, 3), uvs (V, 2), integer triangles (T, 3). OUT.npy: f32 (3 T, 4), tangent and the sign
of the bitangent of each corner, as Blender has them for these texture coordinates.
"""

import sys

import bpy
import numpy as np


def main() -> int:
    source, out = sys.argv[1:]
    given = np.load(source)
    corners = given["triangles"].ravel()
    normals = np.ascontiguousarray(given["normals"][corners], np.float32)
    mesh = bpy.data.meshes.new("corners")
    # No welding: what is one vertex follows from equal values, as for us.
    mesh.vertices.add(len(corners))
    mesh.vertices.foreach_set("co", np.ascontiguousarray(given["positions"][corners], np.float32).ravel())
    mesh.loops.add(len(corners))
    mesh.loops.foreach_set("vertex_index", np.arange(len(corners), dtype=np.int32))
    mesh.polygons.add(len(corners) // 3)
    mesh.polygons.foreach_set("loop_start", np.arange(0, len(corners), 3, dtype=np.int32))
    mesh.polygons.foreach_set("use_smooth", np.ones(len(corners) // 3, bool))
    # Free normals; normals_split_custom_set packs them in 16 bits.
    mesh.attributes.new("custom_normal", "FLOAT_VECTOR", "CORNER").data.foreach_set("vector", normals.ravel())
    mesh.uv_layers.new(name="uv").uv.foreach_set("vector", np.ascontiguousarray(given["uvs"][corners], np.float32).ravel())
    mesh.update()
    kept = np.empty(3 * len(corners), np.float32)
    mesh.corner_normals.foreach_get("vector", kept)
    worst = np.abs(kept - normals.ravel()).max()
    assert worst < 1e-6, f"normals are off by {worst}"
    mesh.calc_tangents(uvmap="uv")
    tangents, signs = np.empty(3 * len(corners), np.float32), np.empty(len(corners), np.float32)
    mesh.loops.foreach_get("tangent", tangents)
    mesh.loops.foreach_get("bitangent_sign", signs)
    np.save(out, np.column_stack([tangents.reshape(-1, 3), signs]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
