"""glTF files as arrays, and arrays as GLB, for scripts that hand the same mesh to several programs. NumPy alone.

Reads what exporters write: .glb and .gltf, buffers and images beside the file or as data URIs. Sparse and normalized
accessors, skins and morph targets are not read.
"""

import base64
import json
import struct
from dataclasses import dataclass
from pathlib import Path
from urllib.parse import unquote

import numpy as np

KINDS = {5120: "i1", 5121: "u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
WIDTHS = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}
TRIANGLES = 4


@dataclass
class Part:
    """One primitive in its mesh's space: (V, 3) positions and normals, (V, 2) uvs with v down, (V, 4) tangents, (T, 3)."""

    positions: np.ndarray
    normals: np.ndarray | None
    uvs: np.ndarray | None
    tangents: np.ndarray | None
    triangles: np.ndarray
    material: dict
    world_from_mesh: np.ndarray


class Gltf:
    """A document with all of its bytes in one buffer."""

    def __init__(self, path: Path):
        data = path.read_bytes()
        if data[:4] == b"glTF":
            length = struct.unpack_from("<I", data, 12)[0]
            self.json, binary = json.loads(data[20 : 20 + length]), data[28 + length :]
        else:
            self.json, binary = json.loads(data), b""
        self.folder, self.blob, starts = path.parent, b"", []
        for buffer in self.json.get("buffers", []):
            starts.append(len(self.blob))
            self.blob += (self.fetch(buffer["uri"]) if "uri" in buffer else binary)[: buffer["byteLength"]]
            self.blob += b"\0" * (-len(self.blob) % 4)
        for view in self.json.get("bufferViews", []):
            view["byteOffset"] = view.get("byteOffset", 0) + starts[view["buffer"]]
            view["buffer"] = 0

    def fetch(self, uri: str) -> bytes:
        if uri.startswith("data:"):
            return base64.b64decode(uri.split(",", 1)[1])
        return (self.folder / unquote(uri)).read_bytes()

    def view(self, index: int) -> bytes:
        view = self.json["bufferViews"][index]
        return self.blob[view["byteOffset"] : view["byteOffset"] + view["byteLength"]]

    def image(self, texture: dict) -> bytes:
        """The file of a textureInfo."""
        image = self.json["images"][self.json["textures"][texture["index"]]["source"]]
        return self.view(image["bufferView"]) if "bufferView" in image else self.fetch(image["uri"])

    def accessor(self, index: int) -> np.ndarray:
        accessor = self.json["accessors"][index]
        kind, width = np.dtype(KINDS[accessor["componentType"]]), WIDTHS[accessor["type"]]
        view = self.json["bufferViews"][accessor["bufferView"]]
        start, stride = view["byteOffset"] + accessor.get("byteOffset", 0), view.get("byteStride", kind.itemsize * width)
        shape, strides = (accessor["count"], width), (stride, kind.itemsize)
        return np.ndarray(shape, kind, self.blob, start, strides).copy()

    def parts(self) -> list[Part]:
        """Of every node that has a mesh, triangles alone."""
        found = []
        for node, world_from_mesh in self.nodes():
            for primitive in self.json["meshes"][node["mesh"]]["primitives"] if "mesh" in node else []:
                if primitive.get("mode", TRIANGLES) == TRIANGLES:
                    found.append(self.part(primitive, world_from_mesh))
        return found

    def part(self, primitive: dict, world_from_mesh: np.ndarray) -> Part:
        named = lambda name: self.accessor(primitive["attributes"][name]) if name in primitive["attributes"] else None  # noqa: E731
        positions = named("POSITION")
        order = self.accessor(primitive["indices"]) if "indices" in primitive else np.arange(len(positions))
        material = self.json["materials"][primitive["material"]] if "material" in primitive else {}
        streams = named("NORMAL"), named("TEXCOORD_0"), named("TANGENT")
        return Part(positions, *streams, order.reshape(-1, 3).astype(np.int64), material, world_from_mesh)

    def nodes(self):
        """(node, its transform to the world), the scene's or all roots."""
        nodes = self.json.get("nodes", [])
        children = {child for node in nodes for child in node.get("children", [])}
        roots = [k for k in range(len(nodes)) if k not in children]
        stack = [(k, np.eye(4)) for k in roots]
        while stack:
            k, parent = stack.pop()
            world = parent @ local(nodes[k])
            yield nodes[k], world
            stack += [(child, world) for child in nodes[k].get("children", [])]


def local(node: dict) -> np.ndarray:
    if "matrix" in node:
        return np.array(node["matrix"], float).reshape(4, 4).T
    x, y, z, w = node.get("rotation", (0, 0, 0, 1))
    turn = np.array(
        [
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ]
    )
    matrix = np.eye(4)
    matrix[:3, :3], matrix[:3, 3] = turn * node.get("scale", (1, 1, 1)), node.get("translation", (0, 0, 0))
    return matrix


def write_glb(path: Path, part: Part, images: dict[str, bytes]) -> None:
    """The part in the world, with PNG files by name: any of base, metallic_roughness, normal; its tangents are left out."""
    linear = part.world_from_mesh[:3, :3]
    assert np.linalg.det(linear) > 0, "a mirrored node turns its triangles"
    positions = (part.positions @ linear.T + part.world_from_mesh[:3, 3]).astype("<f4")
    normals = part.normals @ np.linalg.inv(linear)
    normals = (normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype("<f4")
    streams = [positions, normals, part.uvs.astype("<f4"), part.triangles.astype("<u4").ravel()]
    views, blob = [], b""
    for data in [stream.tobytes() for stream in streams] + list(images.values()):
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(data)})
        blob += data + b"\0" * (-len(data) % 4)
    accessors = [
        {"bufferView": k, "componentType": 5125 if k == 3 else 5126, "count": len(stream), "type": kind}
        for k, (stream, kind) in enumerate(zip(streams, ("VEC3", "VEC3", "VEC2", "SCALAR")))
    ]
    accessors[0] |= {"min": positions.min(axis=0).tolist(), "max": positions.max(axis=0).tolist()}
    texture = {name: {"index": k} for k, name in enumerate(images)}
    keys = {"base": "baseColorTexture", "metallic_roughness": "metallicRoughnessTexture"}
    material = {"pbrMetallicRoughness": {key: texture[name] for name, key in keys.items() if name in images}}
    if "metallic_roughness" not in images:
        material["pbrMetallicRoughness"]["metallicFactor"] = 0
    material |= {"normalTexture": texture["normal"]} if "normal" in images else {}
    attributes = {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": attributes, "indices": 3, "material": 0}]}],
        "materials": [material],
        "buffers": [{"byteLength": len(blob)}], "bufferViews": views, "accessors": accessors,
    }  # fmt: skip
    if images:
        document["textures"] = [{"source": k} for k in range(len(images))]
        document["images"] = [{"bufferView": 4 + k, "mimeType": "image/png"} for k in range(len(images))]
    save(path, document, blob)


def save(path: Path, document: dict, blob: bytes) -> None:
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    head = struct.pack("<4sIIII", b"glTF", 2, 28 + len(text) + len(blob), len(text), 0x4E4F534A)
    path.write_bytes(head + text + struct.pack("<II", len(blob), 0x004E4942) + blob)
