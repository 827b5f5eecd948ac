"""decimate.py blender|meshlab VERTICES TRIANGLES SHARE OUT: a mesh simplified to a share of its triangles.

VERTICES: raw f32, three a vertex; TRIANGLES: raw i32, three a triangle. Writes OUT.vertices and OUT.triangles likewise, and
prints {triangles, cpu_s, version}: user and system seconds, all threads, of the simplification alone. Blender's Decimate
modifier (collapse) needs a Python with `bpy`; MeshLab's quadric edge collapse (defaults, border kept) one with `pymeshlab`.
"""

import json
import sys
import time
from pathlib import Path

import numpy as np


def blender(vertices: np.ndarray, triangles: np.ndarray, share: float):
    import bpy

    mesh = bpy.data.meshes.new("grid")
    mesh.from_pydata(vertices, [], triangles)
    holder = bpy.data.objects.new("grid", mesh)
    bpy.context.collection.objects.link(holder)
    modifier = holder.modifiers.new("decimate", "DECIMATE")
    modifier.ratio, modifier.use_collapse_triangulate = share, True
    start = time.process_time()
    made = holder.evaluated_get(bpy.context.evaluated_depsgraph_get()).to_mesh()
    seconds = time.process_time() - start
    made.calc_loop_triangles()
    corners, places = np.empty(3 * len(made.loop_triangles), np.int32), np.empty(3 * len(made.vertices), np.float32)
    made.loop_triangles.foreach_get("vertices", corners)
    made.vertices.foreach_get("co", places)
    return places, corners, seconds, f"Blender {bpy.app.version_string}"


def meshlab(vertices: np.ndarray, triangles: np.ndarray, share: float):
    import pymeshlab

    meshes = pymeshlab.MeshSet()
    meshes.add_mesh(pymeshlab.Mesh(vertices.astype(np.float64), triangles))
    start = time.process_time()
    meshes.meshing_decimation_quadric_edge_collapse(targetfacenum=round(share * len(triangles)), preserveboundary=True)
    seconds = time.process_time() - start
    made = meshes.current_mesh()
    return made.vertex_matrix(), made.face_matrix(), seconds, "MeshLab"


def main() -> int:
    tool, vertices, triangles, share, out = sys.argv[1:]
    mesh = np.fromfile(vertices, np.float32).reshape(-1, 3), np.fromfile(triangles, np.int32).reshape(-1, 3)
    places, corners, seconds, version = {"blender": blender, "meshlab": meshlab}[tool](*mesh, float(share))
    np.asarray(places, np.float32).tofile(Path(f"{out}.vertices"))
    np.asarray(corners, np.int32).tofile(Path(f"{out}.triangles"))
    print("\n" + json.dumps({"triangles": np.size(corners) // 3, "cpu_s": seconds, "version": version}))
    return 0


if __name__ == "__main__":
    sys.exit(main())
