"""Writes a displaced mesh that keeps the normals of its base: `keep_normals.py MOVED.glb BASE.glb MATERIAL.glb OUT.glb`.

A normal map tells the normals of the displaced surface in the frame of the base, so that beside it the base's normals stay,
where displacement alone makes new ones (CySlice: no `calculatenormal(P)` where there is a normal map). MOVED and BASE are
results of `displace apply` with one `--uniform`: with the detail, and with `--method flat`. The material, with its normal
map if it has one, is that of MATERIAL, a mesh of `integrate_height.py`.
"""

import sys
from pathlib import Path

import numpy as np
from glb import accessor, read_glb, with_map, write_glb


def attribute(document, blob, name: str):
    return accessor(document, blob, document["meshes"][0]["primitives"][0]["attributes"][name])


def main() -> None:
    moved, base, material, out = (Path(name) for name in sys.argv[1:])
    document, blob = read_glb(moved)
    still, source = read_glb(base), read_glb(material)
    assert np.array_equal(attribute(document, blob, "TEXCOORD_0"), attribute(*still, "TEXCOORD_0")), "other vertices"
    attribute(document, blob, "NORMAL")[:] = attribute(*still, "NORMAL")
    document["materials"] = source[0]["materials"]
    if "images" in source[0]:
        view = source[0]["bufferViews"][source[0]["images"][0]["bufferView"]]
        document, blob = with_map(document, blob, source[1][view["byteOffset"] : view["byteOffset"] + view["byteLength"]])
    write_glb(out, document, blob)


if __name__ == "__main__":
    main()
