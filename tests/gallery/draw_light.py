"""Draws the pictures of reflection mapping and of shadows: `draw_light.py DISPLACE [PICTURE ...]`, as `draw.py` does."""

import base64
import json
import math
import shlex
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

from draw import grid, on_ball, png

HERE = Path(__file__).parent
ROOM = "render room.gltf --size 240x180 --eye 1.6,0.9,1.75 --look-at -0.25,-0.3,-0.2 --fov 62 --shading pbr --ambient 0 --light 0,1,0"
MAPPED = "--reflect left --reflect right"
TRACED = "--device reference --supersample 64"
STAGE = "render stage.gltf --size 320x240 --eye 2.4,2.2,3.6 --look-at 0,0.4,0 --fov 40 --ambient 0.15"
PICTURES = {
    "reflection/endless": f"{ROOM} {MAPPED}",
    "reflection/box": f"{ROOM} {MAPPED} --reflect-box",
    "reflection/traced-1": f"{ROOM} {TRACED} --bounces 1",
    "reflection/traced-8": f"{ROOM} {TRACED} --bounces 8",
    "shadows/none": f"{STAGE} --light point:-1.1,1.7,1.2",
    "shadows/map": f"{STAGE} --light point:-1.1,1.7,1.2 --shadows map",
    "shadows/ray": f"{STAGE} --light point:-1.1,1.7,1.2 --shadows ray",
    "shadows/area": f"{STAGE} --light point:-1.1,1.7,1.2,0.3 --shadows ray",
    "shadows/area-64": f"{STAGE} --light point:-1.1,1.7,1.2,0.3 --shadows ray --supersample 64",
    "shadows/sun": f"{STAGE} --light=-0.5,1,0.6@6 --shadows ray --supersample 64",
}


def gltf(file: Path, parts, images: list[bytes]) -> None:
    """Nodes of (mesh as `grid` makes it, material), each a mesh of its own."""
    blob, views, accessors, meshes = b"", [], [], []

    def view(body: bytes) -> int:
        nonlocal blob
        views.append({"buffer": 0, "byteOffset": len(blob), "byteLength": len(body)})
        blob += body + bytes(-len(body) % 4)
        return len(views) - 1

    def accessor(values, kind: str, form: str, component: int) -> int:
        body = b"".join(struct.pack(f"<{len(v)}{form}", *v) for v in values)
        one = {"bufferView": view(body), "componentType": component, "count": len(values), "type": kind}
        if kind == "VEC3":
            one |= {"min": [min(v[k] for v in values) for k in range(3)], "max": [max(v[k] for v in values) for k in range(3)]}
        if kind == "SCALAR":
            one["count"] = 3 * len(values)
        accessors.append(one)
        return len(accessors) - 1

    for number, ((positions, normals, uvs, triangles), _) in enumerate(parts):
        attributes = {
            "POSITION": accessor(positions, "VEC3", "f", 5126),
            "NORMAL": accessor(normals, "VEC3", "f", 5126),
            "TEXCOORD_0": accessor(uvs, "VEC2", "f", 5126),
        }
        indices = accessor(triangles, "SCALAR", "I", 5125)
        meshes.append({"primitives": [{"attributes": attributes, "indices": indices, "material": number}]})
    pictures = [{"bufferView": view(image), "mimeType": "image/png"} for image in images]
    document = {
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": list(range(len(parts)))}],
        "nodes": [{"mesh": k} for k in range(len(parts))], "meshes": meshes, "materials": [m for _, m in parts],
        "accessors": accessors, "bufferViews": views, "images": pictures,
        "textures": [{"source": k} for k in range(len(images))], "extensionsUsed": ["KHR_materials_unlit"],
        "buffers": [{"byteLength": len(blob), "uri": "data:application/octet-stream;base64," + base64.b64encode(blob).decode()}],
    }
    file.write_text(json.dumps(document))


def ball(radius: float, centre):
    def place(u: float, v: float):
        _, n = on_ball(u, v)
        return tuple(radius * a + c for a, c in zip(n, centre)), n

    return grid(64, 32, place)


def wall(corner, u_side, v_side):
    u, v = u_side, v_side
    n = (v[1] * u[2] - v[2] * u[1], v[2] * u[0] - v[0] * u[2], v[0] * u[1] - v[1] * u[0])
    length = math.sqrt(sum(a * a for a in n))
    n = tuple(a / length for a in n)
    return grid(1, 1, lambda s, t: (tuple(c + s * a + t * b for c, a, b in zip(corner, u, v)), n))


def plain(name: str, color, metal=0.0, rough=0.8, **more) -> dict:
    factors = {"baseColorFactor": [*color, 1], "metallicFactor": metal, "roughnessFactor": rough}
    return {"name": name, "pbrMetallicRoughness": factors, "doubleSided": True, **more}


def scenes(folder: Path) -> None:
    checker = png(64, 64, lambda x, y: ((255,) * 3 if (x // 8 + y // 8) % 2 else (150,) * 3) + (255,))
    holes = png(64, 64, lambda x, y: (200, 160, 90, 255 if (x % 16 < 5 or y % 16 < 5) else 0))

    def paper(name: str, color) -> dict:
        made = plain(name, color, extensions={"KHR_materials_unlit": {}})
        made["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
        return made

    low, high = (-2, -1, -2), (2, 1.5, 2)
    size = [b - a for a, b in zip(low, high)]
    x, y, z = (size[0], 0, 0), (0, size[1], 0), (0, 0, size[2])
    walls = [
        (wall(low, y, z), paper("west", (0.8, 0.25, 0.2))),
        (wall((high[0], low[1], low[2]), y, z), paper("east", (0.2, 0.6, 0.3))),
        (wall(low, x, z), paper("floor", (0.6, 0.5, 0.4))),
        (wall((low[0], high[1], low[2]), x, z), paper("ceiling", (0.9, 0.9, 0.85))),
        (wall(low, x, y), paper("north", (0.25, 0.4, 0.8))),
        (wall((low[0], low[1], high[2]), x, y), paper("south", (0.8, 0.7, 0.25))),
    ]
    balls = [
        (ball(0.6, (-0.95, -0.4, -0.2)), plain("left", (0.95, 0.95, 0.95), 1.0, 0.0)),
        (ball(0.6, (0.55, -0.4, -0.5)), plain("right", (1.0, 0.8, 0.5), 1.0, 0.0)),
    ]
    gltf(folder / "room.gltf", walls + balls, [checker])
    fence = plain("fence", (1, 1, 1), alphaMode="MASK")
    fence["pbrMetallicRoughness"]["baseColorTexture"] = {"index": 0}
    stage = [
        (wall((-4, 0, -4), (8, 0, 0), (0, 0, 8)), plain("ground", (0.9, 0.9, 0.9))),
        (ball(0.5, (-0.6, 0.5, 0.5)), plain("ball", (0.8, 0.35, 0.25))),
        (wall((0.5, 0, 0.9), (0.7, 0, 0.7), (0, 0.7, 0)), fence),
    ]
    gltf(folder / "stage.gltf", stage, [holes])


def main() -> int:
    displace, names = Path(sys.argv[1]).resolve(), sys.argv[2:] or list(PICTURES)
    with tempfile.TemporaryDirectory() as folder:
        scenes(Path(folder))
        for name in names:
            out = HERE / f"{name}.png"
            subprocess.run([displace, *shlex.split(PICTURES[name]), "--quiet", "-o", out], cwd=folder, check=True)
            print(out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
