"""Square height fields as arrays, the plane they lie on, and how far a mesh is from one at its texels.

A field is an (n, n) f32 array; row j is v = j / (n - 1), column i is u = i / (n - 1): node sampling. A mesh over it is
vertices (x, y, height) in f64, x and y in texels, height in the field's unit, and triangles of three indices.
"""

import json
import struct
from dataclasses import dataclass
from pathlib import Path

import mitsuba as mi
import numpy as np
import trimesh
from PIL import Image

mi.set_variant("scalar_rgb")

# Texels: a place this close to an edge is on it. Far above the rounding of f64, far below half a texel.
ON_EDGE = 1e-9
# Corner-row pairs evaluated at once, so that memory stays below a gigabyte.
ROWS_AT_ONCE = 200_000


@dataclass
class Mesh:
    """`vertices` (v, 3) f64: x, y in texels, height; `triangles` (t, 3)."""

    vertices: np.ndarray
    triangles: np.ndarray


@dataclass
class Deviation:
    """`largest` of |mesh - field| over the texels that are covered, in the field's unit; `uncovered` texels; `folded`:
    triangles that are turned over; `area` of all triangles over that of the square, 1 where it is covered once."""

    largest: float
    uncovered: int
    folded: int
    area: float

    def faults(self) -> list[str]:
        named = [(self.uncovered, f"{self.uncovered} texels uncovered"), (self.folded, f"{self.folded} triangles turned over")]
        named.append((abs(self.area - 1) > 1e-6, f"covers {self.area:.6f} of the square"))
        return [name for is_so, name in named if is_so]


def read_field(path: Path) -> np.ndarray:
    """The first channel of an EXR, the floats of a TIFF, or the values of a PNG, v/255 or v/65535."""
    if path.suffix == ".exr":
        values = np.array(mi.Bitmap(str(path)), np.float32)
    else:
        values = np.asarray(Image.open(path))
        if not np.issubdtype(values.dtype, np.floating):
            values = (values / (255 if values.dtype == np.uint8 else 65535)).astype(np.float32)
    values = values[..., 0] if values.ndim == 3 else values
    cells = values.shape[0] - 1
    if values.shape[0] != values.shape[1] or cells < 2 or cells & (cells - 1):
        raise SystemExit(f"{path}: {values.shape[1]} x {values.shape[0]} texels; a field is square with 2^k + 1 a side: resample it")
    if values.min() == values.max():
        raise SystemExit(f"{path}: all texels are {values.min()}; a tolerance is a share of a range above 0")
    return np.ascontiguousarray(values)


def write_field(path: Path, field: np.ndarray) -> Path:
    """An EXR of one f32 channel, `Y`, or a TIFF of floats that are not packed."""
    if path.suffix == ".tiff":
        Image.fromarray(field).save(path)
    else:
        mi.Bitmap(field[..., None]).write(str(path))
    return path


def write_plane(path: Path) -> Path:
    """The unit square of the plane y = 0, normal +Y, u = x and v = z, as two triangles that share the diagonal u = v."""
    corners = np.array([(0, 0), (1, 0), (0, 1), (1, 1)], np.float32)
    positions = np.insert(corners, 1, 0, axis=1)
    normals = np.tile(np.array([0, 1, 0], np.float32), (4, 1))
    parts = [positions, normals, corners, np.array([0, 2, 3, 0, 3, 1], np.uint32)]
    binary, views = b"", []
    for part in parts:
        views.append({"buffer": 0, "byteOffset": len(binary), "byteLength": part.nbytes})
        binary += part.tobytes()
    kinds = [("VEC3", 5126), ("VEC3", 5126), ("VEC2", 5126), ("SCALAR", 5125)]
    accessors = [
        {"bufferView": n, "type": kind, "componentType": component, "count": len(part)}
        for n, (part, (kind, component)) in enumerate(zip(parts, kinds))
    ]
    accessors[0] |= {"min": [0, 0, 0], "max": [1, 0, 1]}
    primitive = {"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "indices": 3, "material": 0}
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [primitive]}], "materials": [{"name": "plane"}],
        "buffers": [{"byteLength": len(binary)}], "bufferViews": views, "accessors": accessors,
    }
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    size = 12 + 8 + len(text) + 8 + len(binary)
    header = struct.pack("<4sII", b"glTF", 2, size) + struct.pack("<I4s", len(text), b"JSON")
    path.write_bytes(header + text + struct.pack("<I4s", len(binary), b"BIN\0") + binary)
    return path


def read_displaced(path: Path, size: int, scale: float) -> Mesh:
    """A displaced plane, from its positions alone: x and z say the texel, y the height."""
    mesh = trimesh.load(path, force="mesh", process=False)
    x, y, z = np.asarray(mesh.vertices, np.float64).T
    return Mesh(np.stack([x * (size - 1), z * (size - 1), y / scale], axis=1), np.asarray(mesh.faces))


def deviation(mesh: Mesh, field: np.ndarray) -> Deviation:
    """How far the mesh is from the field, vertically, at all texels."""
    corners = mesh.vertices[mesh.triangles]
    (ax, ay), (bx, by) = ((corners[:, k, :2] - corners[:, 0, :2]).T for k in (1, 2))
    doubled = ax * by - ay * bx
    area = doubled.sum() / (2 * (field.shape[0] - 1) ** 2)
    folded = int((doubled * np.sign(area) < -ON_EDGE).sum())
    covered, largest = np.zeros(field.size, bool), 0.0
    for texel, height in readings(corners, field.shape[0]):
        covered[texel] = True
        largest = max(largest, float(np.abs(height - field.reshape(-1)[texel]).max(initial=0.0)))
    return Deviation(largest, int((~covered).sum()), folded, float(abs(area)))


def heights_of(mesh: Mesh, size: int) -> np.ndarray:
    """The heights of the mesh at size x size places, x and y from 0 to size - 1; not a number where it has none."""
    heights = np.full(size * size, np.nan)
    for place, height in readings(mesh.vertices[mesh.triangles], size):
        heights[place] = height
    return heights.reshape(size, size)


def readings(corners: np.ndarray, size: int):
    """(places y * size + x, heights) of the triangles (t, 3, 3), part by part.

    Each triangle is cut by the rows of texels into spans, and each span is read at its texels, ends included: a texel on
    an edge is read from both sides, and slivers need no division by their area.
    """
    last = size - 1
    first = np.clip(np.ceil(corners[..., 1].min(1) - ON_EDGE), 0, last).astype(np.int64)
    rows = np.clip(np.floor(corners[..., 1].max(1) + ON_EDGE), -1, last).astype(np.int64) - first + 1
    for part in parts_of(np.maximum(rows, 0)):
        owner, y = expand(first[part], np.maximum(rows[part], 0))
        yield read_spans(row_spans(corners[part][owner], y), y, size)


def parts_of(rows: np.ndarray):
    """Runs of triangles with about ROWS_AT_ONCE rows each."""
    ends = np.cumsum(rows)
    cuts = np.searchsorted(ends, np.arange(ROWS_AT_ONCE, ends[-1] + ROWS_AT_ONCE, ROWS_AT_ONCE))
    start = 0
    for cut in np.minimum(cuts + 1, len(rows)):
        if cut > start:
            yield slice(start, cut)
        start = cut


def expand(first: np.ndarray, counts: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """(owner, value) for the `counts[owner]` integers from `first[owner]` on."""
    owner = np.repeat(np.arange(len(counts)), counts)
    within = np.arange(len(owner)) - np.repeat(np.cumsum(counts) - counts, counts)
    return owner, first[owner] + within


def row_spans(corners: np.ndarray, y: np.ndarray):
    """Where row `y` cuts each triangle: (left x, right x, left height, right height)."""
    crossings = []
    for k in range(3):
        a, b = corners[:, k], corners[:, (k + 1) % 3]
        rise = b[:, 1] - a[:, 1]
        is_level = np.abs(rise) <= ON_EDGE
        place = np.clip(np.where(is_level, 0, (y - a[:, 1]) / np.where(is_level, 1, rise)), 0, 1)
        is_cut = (np.minimum(a[:, 1], b[:, 1]) - ON_EDGE <= y) & (y <= np.maximum(a[:, 1], b[:, 1]) + ON_EDGE)
        # An edge along the row is cut at both of its ends; its other end is the first of the next edge.
        x = np.where(is_cut, a[:, 0] + place * (b[:, 0] - a[:, 0]), np.nan)
        crossings.append((x, a[:, 2] + place * (b[:, 2] - a[:, 2])))
    x, height = (np.stack(column, axis=1) for column in zip(*crossings))
    left, right = np.nanargmin(x, axis=1)[:, None], np.nanargmax(x, axis=1)[:, None]
    return tuple(np.take_along_axis(of, at, axis=1)[:, 0] for of, at in [(x, left), (x, right), (height, left), (height, right)])


def read_spans(spans, y: np.ndarray, size: int) -> tuple[np.ndarray, np.ndarray]:
    """(places, heights) of the texels of the spans."""
    left, right, at_left, at_right = spans
    last = size - 1
    first = np.clip(np.ceil(left - ON_EDGE), 0, last).astype(np.int64)
    counts = np.maximum(np.clip(np.floor(right + ON_EDGE), -1, last).astype(np.int64) - first + 1, 0)
    owner, x = expand(first, counts)
    width = (right - left)[owner]
    place = np.clip(np.where(width > 0, (x - left[owner]) / np.where(width > 0, width, 1), 0), 0, 1)
    return y[owner] * size + x, at_left[owner] + place * (at_right[owner] - at_left[owner])
