"""Loads the GLBs named on the command line with trimesh.

One JSON line each: {file, triangles, error}.
"""

import json
import sys

import numpy
import trimesh


def triangles_of(file: str) -> int:
    """Number of triangles over the scene's instances; raises when a vertex is not finite."""
    scene = trimesh.load_scene(file, process=False)
    count = 0
    for node in scene.graph.nodes_geometry:
        geometry = scene.geometry[scene.graph[node][1]]
        if not numpy.isfinite(geometry.vertices).all():
            raise ValueError(f"{node}: a vertex is not finite")
        if isinstance(geometry, trimesh.Trimesh):
            if len(geometry.faces) and geometry.faces.max() >= len(geometry.vertices):
                raise ValueError(f"{node}: an index is outside the vertices")
            count += len(geometry.faces)
    return count


for file in sys.argv[1:]:
    try:
        print(json.dumps({"file": file, "triangles": triangles_of(file)}), flush=True)
    except Exception as error:  # whatever it is, it belongs into the table
        print(json.dumps({"file": file, "error": f"{type(error).__name__}: {error}"}), flush=True)
