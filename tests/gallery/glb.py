"""GLB files: their document and binary chunk, read and written. Needs numpy."""

import json
import struct
from pathlib import Path

import numpy as np


def read_glb(path: Path):
    """Document and binary chunk."""
    data = path.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    return json.loads(data[20 : 20 + length]), bytearray(data[28 + length :])


def accessor(document, blob, number):
    """A view of an accessor's numbers, one element a row; what is written to it is written to the chunk."""
    a = document["accessors"][number]
    view = document["bufferViews"][a["bufferView"]]
    kind = {5126: "<f4", 5125: "<u4", 5123: "<u2"}[a["componentType"]]
    width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3}[a["type"]]
    offset = view.get("byteOffset", 0) + a.get("byteOffset", 0)
    return np.frombuffer(blob, kind, a["count"] * width, offset).reshape(-1, width)


def write_glb(path: Path, document, blob: bytes) -> None:
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    body = bytes(blob) + bytes(-len(blob) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(body), 0x004E4942) + body
    path.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)


def with_map(document, blob, picture: bytes):
    """The first material with a normal map, a PNG."""
    start = len(blob) + -len(blob) % 4
    blob = bytes(blob).ljust(start, b"\0") + picture
    document["materials"][0]["normalTexture"] = {"index": 0}
    document["textures"], document["images"] = [{"source": 0}], [{"bufferView": len(document["bufferViews"]), "mimeType": "image/png"}]
    document["bufferViews"].append({"buffer": 0, "byteOffset": start, "byteLength": len(picture)})
    document["buffers"] = [{"byteLength": len(blob)}]
    return document, blob
