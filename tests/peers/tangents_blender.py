"""tangents_blender.py MESH.npz OUT.npy: Blender's `calc_tangents` of a triangle mesh, for a Python that has `bpy`.

MESH.npz: f32 positions and normals (V, 3), uvs (V, 2), integer triangles (T, 3). OUT.npy: f32 (3 T, 4), tangent and the sign
of the bitangent of each corner, as Blender has them for these texture coordinates.
"""

import sys

import numpy as np

import blender_mesh


def main() -> int:
    source, out = sys.argv[1:]
    mesh = blender_mesh.made(np.load(source), np.eye(3, dtype=np.float32), v_up=False)
    mesh.calc_tangents(uvmap="uv")
    tangents, signs = np.empty(3 * len(mesh.loops), np.float32), np.empty(len(mesh.loops), np.float32)
    mesh.loops.foreach_get("tangent", tangents)
    mesh.loops.foreach_get("bitangent_sign", signs)
    np.save(out, np.column_stack([tangents.reshape(-1, 3), signs]))
    return 0


if __name__ == "__main__":
    sys.exit(main())
