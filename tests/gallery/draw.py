"""Draws the pictures of the gallery: `draw.py DISPLACE [PICTURE ...]`, all of them or those named.

Each picture is one command line of `PICTURES`, run in a scratch folder that holds the files of `tests/data` and the small
scenes made here. What to look for stands in README.md beside this file. Needs Python 3 alone.
"""

import json
import math
import shlex
import shutil
import struct
import subprocess
import sys
import tempfile
import zlib
from pathlib import Path

HERE = Path(__file__).parent
DATA = HERE.parent / "data"
SIZE = "--size 320x240"
FLOOR = f"floor.glb {SIZE} --eye 0,0.5,4 --look-at 0,0,-2 --fov 50 --light 0,1,0 --ambient 0"
GLOBE = f"bare.glb {SIZE} --base-color letters.png --light 1,1,1 --filter ewa"
SEEN = f"knot.glb {SIZE} --orbit 20,40,10 --light 1,1,1"
KNOT = f"{SEEN} --base-color letters.png --filter ewa"
BALL = f"ball.glb {SIZE} --orbit 20,15,3.2 --light 1,1,1"
WAVES = "waves.glb --size 144x108 --fov 45 --look-at 0,0,0 --light 0,1,-1 --ambient 0.2 --shading pbr"
MOMENTS = {
    f"moments/{distance}-{name}": f"render {WAVES} --eye 0,{2 * distance},{2 * distance} {flags}"
    for distance in (1, 4, 16)
    for name, flags in (("off", ""), ("on", "--moments on"), ("supersampled", "--filter bilinear --supersample 1024"))
}
PIXEL = 8 * math.tan(math.radians(20)) / 80  # of RINGS's image, in world units
AHEAD = "--eye 0,0,4 --look-at 0,0,0 --fov 40 --light 0,0,1 --ambient 0 --shading pbr"
RINGS = f"rings.glb --size 228x80 {AHEAD}"
BUMPY = f"{SIZE} --orbit 25,10,3.9 --light 1,1,1"
# The height whose slopes are those of `bump`: a texel of its map is 2 pi / 256 long on the ball.
BUMPS = "0.4295 * (sqrt(max(0.36, 1 - 3.344 * ((fract(8*u) - 0.5) * (fract(8*u) - 0.5) + (fract(4*v) - 0.5) * (fract(4*v) - 0.5)))) - 0.6)"
PICTURES = {
    # Filters on a checker floor: rows 7 to 12.
    "filter-nearest": f"render {FLOOR} --filter nearest",
    "filter-bilinear": f"render {FLOOR} --filter bilinear",
    "filter-trilinear": f"render {FLOOR} --filter trilinear",
    "filter-anisotropic": f"render {FLOOR} --filter anisotropic",
    "filter-ewa": f"render {FLOOR} --filter ewa",
    "filter-supersampled": f"render {FLOOR} --filter bilinear --supersample 1024",
    # Rows 1, 7, 9 and 10.
    "coordinates": f"render painted.glb --size 160x120 --orbit 20,15,3.2 --light 1,1,1 --aov uv,position",
    "magnified-nearest": f"render magnified.glb {SIZE} {AHEAD} --filter nearest",
    "magnified-bilinear": f"render magnified.glb {SIZE} {AHEAD} --filter bilinear",
    "levels-nearest": f"render {RINGS} --filter nearest",
    "levels-bilinear": f"render {RINGS} --filter bilinear",
    "levels-trilinear": f"render {RINGS} --filter trilinear",
    "levels-supersampled": f"render {RINGS} --filter bilinear --supersample 1024",
    # Rows 17 to 19.
    "shading-flat": f"render {BALL} --shading flat",
    "shading-gouraud": f"render {BALL} --shading gouraud",
    "shading-phong": f"render {BALL} --shading phong",
    "shading-pbr": f"render {BALL} --shading pbr",
    # Row 24.
    "normal-map": f"render bumps.glb {SIZE} --orbit 25,10,3.2 --light 1,1,1 --shading pbr",
    "normal-map-sides": f"render TwoSidedPlane/TwoSidedPlane.gltf {SIZE} --orbit 30,25 --shading pbr",
    # Row 20.
    "silhouette-gouraud": f"render bumps.glb {BUMPY} --shading gouraud",
    "silhouette-phong": f"render bumps.glb {BUMPY} --shading phong",
    "silhouette-displaced": f"render fine.glb {BUMPY} --shading phong --expr '{BUMPS}' --uniform 3",
    # Row 15.
    "opacity-mask": f"render painted.glb --size 288x216 --orbit 20,15,3.2 --light 1,1,1 --opacity holes.png --alpha mask --shadows ray",
    "opacity-blend": f"render painted.glb --size 288x216 --orbit 20,15,3.2 --light 1,1,1 --opacity holes.png --alpha blend",
    "alpha-mask": f"render leaves.glb {SIZE} --orbit 25,25,3.6 --light 0.3,1,0.4 --alpha mask --shadows ray",
    "alpha-blend": f"render leaves.glb {SIZE} --orbit 25,25,3.6 --light 0.3,1,0.4 --alpha blend",
    "alpha-stochastic": f"render leaves.glb {SIZE} --orbit 25,25,3.6 --light 0.3,1,0.4 --alpha stochastic",
    # Row 16.
    "environment-phong": f"render ball.glb {SIZE} --orbit 20,15,3.2 --env sky.hdr",
    "environment-rough": f"render rough.glb {SIZE} --orbit 20,15,3.2 --env sky.hdr --shading pbr",
    "environment-mirror": f"render mirror.glb {SIZE} --orbit 20,15,3.2 --env sky.hdr --shading pbr",
    # Light and shadow.
    "shadows-none": f"render Suzanne/Suzanne.gltf {SIZE} --orbit 25,8,3.9 --light 1,1,0.4 --light point:-2,1,2 --shading pbr",
    "shadows-ray": f"render Suzanne/Suzanne.gltf {SIZE} --orbit 25,8,3.9 --light 1,1,0.4 --light point:-2,1,2 --shading pbr --shadows ray",
    "shadows-displaced": f"render ball.glb {SIZE} --height maps/abstract_height.png --scale 0.15 --uniform 4 --orbit 20,15,3.6 --light 1,0.4,0.2 --shading pbr --shadows ray",
    # Normal maps from afar.
    **MOMENTS,
    "texture-transform": f"render TextureTransformTest/TextureTransformTest.gltf {SIZE} --shading pbr --ambient 1 --light 0,0,1",
    # Row 2 with E2; projections.
    "texture/sphere-right": f"render {GLOBE} --orbit 30,15,3.2 --projection sphere",
    "texture/sphere-as-printed": f"render {GLOBE} --orbit 30,15,3.2 --projection sphere-as-printed",
    "texture/sphere-seam": f"render {GLOBE} --orbit 90,15,3.2 --projection sphere",
    "texture/sphere-pole": f"render {GLOBE} --orbit 30,75,3.2 --projection sphere",
    "texture/planar": f"render {KNOT} --projection planar",
    "texture/box": f"render {KNOT} --projection box",
    "texture/triplanar": f"render {KNOT} --projection triplanar",
    "texture/displaced": f"render bare.glb --size 288x216 --expr '0.06*sin(8*x)*sin(8*y)*sin(8*z)' --uniform 3 --base-color letters.png --projection triplanar --orbit 30,15,3.2 --light 1,1,1 --filter ewa",
    # Row 5.
    "texture/preimage-near": f"render {FLOOR} --preimage 160,200",
    "texture/preimage-far": f"render {FLOOR} --preimage 160,112",
    # What the rasteriser does.
    "texture/overdraw": f"render {SEEN} --aov overdraw",
    "texture/samples": f"render {SEEN} --aov samples",
}
# Pictures that are outputs beside the image: their names.
BESIDE = {
    "texture/preimage-near": "preimage",
    "texture/preimage-far": "preimage",
    "texture/overdraw": "overdraw",
    "texture/samples": "samples",
}


def png(width: int, height: int, pixel) -> bytes:
    """8-bit RGBA of pixel(x, y)."""
    rows = b"".join(b"\0" + bytes(c for x in range(width) for c in pixel(x, y)) for y in range(height))
    chunk = lambda kind, body: struct.pack(">I", len(body)) + kind + body + struct.pack(">I", zlib.crc32(kind + body))  # noqa: E731
    header = struct.pack(">IIBBBBB", width, height, 8, 6, 0, 0, 0)
    return b"\x89PNG\r\n\x1a\n" + chunk(b"IHDR", header) + chunk(b"IDAT", zlib.compress(rows, 9)) + chunk(b"IEND", b"")


def glb(file: Path, mesh, material: dict, images: list[bytes]) -> None:
    """A mesh of (positions, normals, uvs, triangles) with one material, whose textures are numbered as `images`.

    Without uvs it has no texture coordinates."""
    positions, normals, uvs, triangles = mesh
    parts = [b"".join(struct.pack("<%df" % len(v), *v) for v in values) for values in (positions, normals, uvs or [(0, 0)])]
    parts += [b"".join(struct.pack("<3I", *t) for t in triangles), *images]
    views, blob = [], b""
    for part in parts:
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(part)})
        blob += part + bytes(-len(part) % 4)
    count, corners = len(positions), 3 * len(triangles)
    bound = lambda pick: [pick(p[k] for p in positions) for k in range(3)]  # noqa: E731
    accessors = [
        {"bufferView": 0, "componentType": 5126, "count": count, "type": "VEC3", "min": bound(min), "max": bound(max)},
        {"bufferView": 1, "componentType": 5126, "count": count, "type": "VEC3"},
        {"bufferView": 2, "componentType": 5126, "count": count, "type": "VEC2"},
        {"bufferView": 3, "componentType": 5125, "count": corners, "type": "SCALAR"},
    ]
    primitive = {"attributes": {"POSITION": 0, "NORMAL": 1, "TEXCOORD_0": 2}, "indices": 3, "material": 0}
    if not uvs:
        del accessors[2], primitive["attributes"]["TEXCOORD_0"]
        primitive["indices"] = 2
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0]}], "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [primitive]}], "materials": [material], "accessors": accessors, "bufferViews": views,
        "buffers": [{"byteLength": len(blob)}],
    }
    if images:
        document["images"] = [{"bufferView": 4 + k, "mimeType": "image/png"} for k in range(len(images))]
        document["textures"] = [{"source": k} for k in range(len(images))]
    text = json.dumps(document).encode()
    text += b" " * (-len(text) % 4)
    chunks = struct.pack("<II", len(text), 0x4E4F534A) + text + struct.pack("<II", len(blob), 0x004E4942) + blob
    file.write_bytes(struct.pack("<III", 0x46546C67, 2, 12 + len(chunks)) + chunks)


def grid(columns: int, rows: int, place):
    """A mesh of place(u, v) -> (position, normal), u and v from 0 to 1, v down."""
    at = [(i / columns, j / rows) for j in range(rows + 1) for i in range(columns + 1)]
    number = lambda i, j: j * (columns + 1) + i  # noqa: E731
    triangles = []
    for j in range(rows):
        for i in range(columns):
            a, b, c, d = number(i, j), number(i, j + 1), number(i + 1, j + 1), number(i + 1, j)
            triangles += [(a, b, c), (a, c, d)]
    return [place(*uv)[0] for uv in at], [place(*uv)[1] for uv in at], at, triangles


def on_ball(u: float, v: float):
    turn, down = 2 * math.pi * u, math.pi * v
    n = (-math.cos(turn) * math.sin(down), math.cos(down), math.sin(turn) * math.sin(down))
    return n, n


def on_knot(u: float, v: float):
    """A tube of radius 0.5 around a trefoil."""
    curve = lambda t: [math.sin(t) + 2 * math.sin(2 * t), -math.sin(3 * t), math.cos(t) - 2 * math.cos(2 * t)]  # noqa: E731
    dot = lambda a, b: sum(x * y for x, y in zip(a, b))  # noqa: E731
    unit = lambda a: [x / math.sqrt(dot(a, a)) for x in a]  # noqa: E731
    cross = lambda a, b: [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]  # noqa: E731
    t, h = 2 * math.pi * u, 1e-3
    before, at, after = curve(t - h), curve(t), curve(t + h)
    along = unit([b - a for a, b in zip(before, after)])
    bend = [a - 2 * m + b for a, m, b in zip(before, at, after)]
    inwards = unit([b - dot(bend, along) * a for a, b in zip(along, bend)])
    across = cross(along, inwards)
    c, s = math.cos(2 * math.pi * v), -math.sin(2 * math.pi * v)
    n = tuple(c * i - s * a for i, a in zip(inwards, across))
    return tuple(p + 0.5 * k for p, k in zip(at, n)), n


def letters(x: int, y: int):
    """Columns of hue, rows of brightness, an F in each of 8 by 4 cells, and a red line around the map."""
    cell_x, cell_y = x % 64, y % 64
    is_letter = 16 <= cell_x < 26 and 10 <= cell_y < 54 or 26 <= cell_x < 48 and (10 <= cell_y < 20 or 27 <= cell_y < 36)
    hue = 2 * math.pi * (x // 64) / 8
    light = 0.75 - 0.12 * (y // 64)
    rgb = [255 * light * (0.72 + 0.28 * math.cos(hue - 2.1 * k)) for k in range(3)]
    if min(x, y, 511 - x, 255 - y) < 3:
        rgb = [200, 20, 20]
    return *(round(c * (0.25 if is_letter else 1)) for c in rgb), 255


def bump(x: int, y: int):
    """A normal map of round bumps, 8 in a row."""
    dx, dy = (x % 32 - 15.5) / 14, (y % 32 - 15.5) / 14
    inside = dx * dx + dy * dy < 1
    nx, ny = (0.8 * dx, -0.8 * dy) if inside else (0, 0)
    nz = math.sqrt(1 - nx * nx - ny * ny)
    return *(round(127.5 + 127.5 * c) for c in (nx, ny, nz)), 255


def wave_map(side: int):
    """A normal map of waves of every direction: slopes of 0.15 along either axis, nearly Gaussian."""
    waves = []
    for k in range(32):
        length, turn = 4 + 12 * (0.618 * k % 1), 2.4 * k
        waves.append((round(length * math.cos(turn)), round(length * math.sin(turn)), 0.755 * k % 1))

    def normal(x: int, y: int):
        a = b = 0.0
        for u, v, phase in waves:
            slope = 0.053 * math.sin(2 * math.pi * ((u * x + v * y) / side + phase)) / math.hypot(u, v)
            a, b = a + u * slope, b + v * slope
        size = math.sqrt(1 + a * a + b * b)
        return *(round(127.5 + 127.5 * c / size) for c in (a, b, 1)), 255

    return png(side, side, normal)


def leaf(x: int, y: int):
    dx, dy = (x % 32 - 15.5) / 16, (y % 32 - 15.5) / 16
    alpha = max(0.0, 1 - dx * dx - dy * dy) ** 0.5
    return 60, 200 - 3 * (x % 32), 70, round(255 * alpha)


def ring(x: int, y: int):
    """A zone plate of 256 x 256: rings that get finer from the middle, up to one black and one white texel at the borders."""
    value = round(127.5 + 127.5 * math.cos(math.pi * ((x - 127.5) ** 2 + (y - 127.5) ** 2) / 256))
    return value, value, value, 255


def smaller_and_smaller():
    """Quads of 64, 45, 32, 23 and 16 pixels in RINGS's image."""
    quads = ([], [], [], [])
    for left, side in ((8, 64), (80, 45), (133, 32), (173, 23), (204, 16)):
        place = lambda u, v: (((left + side * u - 114) * PIXEL, (32 - side * v) * PIXEL, 0), (0, 0, 1))  # noqa: E731
        for to, values in zip(quads, (*grid(1, 1, place)[:3], [tuple(i + len(quads[0]) for i in t) for t in ((0, 2, 3), (0, 3, 1))])):
            to.extend(values)
    return quads


def paint(x: int, y: int):
    """Continents of sorts, and a net of 30 degrees."""
    net = (x + 1) % 22 < 2 or (y + 1) % 21 < 2
    land = math.sin(x / 19) + math.sin(y / 11 + x / 27) + 0.6 * math.sin(x / 5 + y / 7) > 0.5
    return (235, 235, 225, 255) if net else (90, 150, 70, 255) if land else (50, 90, 170, 255)


def hole(x: int, y: int):
    """Round holes with soft rims."""
    near = math.hypot(x % 32 - 15.5, y % 32 - 15.5)
    return 255, 255, 255, max(0, min(255, round(127.5 + 22 * (near - 10))))


def sky(file: Path) -> None:
    """Radiance HDR, 128 x 64, uncompressed: a gradient, a horizon, a sun."""
    body = b""
    for y in range(64):
        for x in range(128):
            up = math.cos(math.pi * (y + 0.5) / 64)
            sun = 80 * math.exp(-((x - 90) ** 2 + (y - 18) ** 2) / 6)
            ground = 0.18 + 0.1 * ((x // 8 + y // 8) % 2)
            rgb = [0.35 + sun, 0.55 + sun, 1.0 + 0.8 * sun] if up > 0 else [ground, 0.8 * ground, 0.6 * ground]
            exponent = math.frexp(max(rgb))[1]
            body += bytes([*(min(255, int(c * 256 / 2**exponent)) for c in rgb), exponent + 128])
    file.write_bytes(b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 64 +X 128\n" + body)


def scenes(folder: Path) -> None:
    checker = png(256, 256, lambda x, y: ((230, 230, 225) if (x // 8 + y // 8) % 2 else (40, 50, 60)) + (255,))
    colored = {"baseColorTexture": {"index": 0}, "metallicFactor": 0, "roughnessFactor": 0.9}
    flat = lambda u, v: ((40 * (u - 0.5), 0, 40 * (v - 0.5)), (0, 1, 0))  # noqa: E731
    positions, normals, uvs, triangles = grid(1, 1, flat)
    glb(folder / "floor.glb", (positions, normals, [(8 * u, 8 * v) for u, v in uvs], triangles), {"pbrMetallicRoughness": colored}, [checker])
    plain = lambda metal, rough: {"pbrMetallicRoughness": {"baseColorFactor": [0.85, 0.6, 0.3, 1], "metallicFactor": metal, "roughnessFactor": rough}}  # noqa: E731
    glb(folder / "ball.glb", grid(20, 10, on_ball), plain(0, 0.4), [])
    glb(folder / "rough.glb", grid(64, 32, on_ball), plain(1, 0.4), [])
    glb(folder / "mirror.glb", grid(64, 32, on_ball), plain(1, 0), [])
    painted = {**plain(0, 0.5)["pbrMetallicRoughness"], "baseColorFactor": [1, 1, 1, 1], "baseColorTexture": {"index": 0}}
    glb(folder / "painted.glb", grid(48, 24, on_ball), {"pbrMetallicRoughness": painted, "doubleSided": True}, [png(256, 128, paint)])
    (folder / "holes.png").write_bytes(png(256, 128, hole))
    glb(folder / "rings.glb", smaller_and_smaller(), {"pbrMetallicRoughness": colored}, [png(256, 256, ring)])
    upright = grid(1, 1, lambda u, v: ((2 * u - 1, 1 - 2 * v, 0), (0, 0, 1)))
    glb(folder / "magnified.glb", upright, {"pbrMetallicRoughness": colored}, [png(16, 16, lambda x, y: paint(10 * x, 8 * y))])
    glb(folder / "fine.glb", grid(48, 24, on_ball), plain(0, 0.4), [])
    bumpy = {**plain(0, 0.4), "normalTexture": {"index": 0}}
    glb(folder / "bumps.glb", grid(48, 24, on_ball), bumpy, [png(256, 128, bump)])
    sea = lambda u, v: ((400 * (u - 0.5), 0, 400 * (v - 0.5)), (0, 1, 0))  # noqa: E731
    positions, normals, uvs, triangles = grid(1, 1, sea)
    dim = {"baseColorFactor": [0.1, 0.07, 0.04, 1], "metallicFactor": 1, "roughnessFactor": 0.25}
    wavy = {"pbrMetallicRoughness": dim, "normalTexture": {"index": 0}}
    glb(folder / "waves.glb", (positions, normals, [(400 * u, 400 * v) for u, v in uvs], triangles), wavy, [wave_map(128)])
    sheets = grid(1, 1, lambda u, v: ((2 * u - 1, 0, 2 * v - 1), (0, 1, 0)))
    levels = [[(x, 0.35 * k, z) for x, _, z in sheets[0]] for k in range(3)]
    stacked = sum(levels, []), sheets[1] * 3, sheets[2] * 3, [tuple(i + 4 * k for i in t) for k in range(3) for t in sheets[3]]
    leaves = {"pbrMetallicRoughness": colored, "alphaMode": "BLEND", "doubleSided": True}
    glb(folder / "leaves.glb", stacked, leaves, [png(128, 128, leaf)])
    sky(folder / "sky.hdr")
    (folder / "letters.png").write_bytes(png(512, 256, letters))
    white = {"pbrMetallicRoughness": {"metallicFactor": 0, "roughnessFactor": 0.9}}
    for name, mesh in (("bare", grid(64, 32, on_ball)), ("knot", grid(240, 32, on_knot))):
        glb(folder / f"{name}.glb", (mesh[0], mesh[1], None, mesh[3]), white, [])
    for name in ("models", "maps"):
        for path in (DATA / name).iterdir():
            target = folder / (path.name if name == "models" else "maps")
            if not target.exists():
                target.symlink_to(path.resolve() if name == "models" else path.parent.resolve())


def main() -> int:
    displace, names = Path(sys.argv[1]).resolve(), sys.argv[2:] or list(PICTURES)
    with tempfile.TemporaryDirectory() as folder:
        scenes(Path(folder))
        for name in names:
            out = HERE / f"{name if '/' in name else 'shading/' + name}.png"
            out.parent.mkdir(exist_ok=True)
            made = Path(folder) / "beside.png" if name in BESIDE else out
            subprocess.run([displace, *shlex.split(PICTURES[name]), "--quiet", "-o", made], cwd=folder, check=True)
            if name in BESIDE:
                shutil.copy(made.with_suffix(f".{BESIDE[name]}.png"), out)
            print(out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
