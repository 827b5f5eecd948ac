"""Draws the pictures of `bump/`: `draw_bump.py DISPLACE [PICTURE ...]`, all of them or those named.

As `draw.py`, whose scenes and writers it shares: each picture is one command line. What to look for stands in README.md.
"""

import math
import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

from draw import DATA, HERE, glb, grid, on_ball, png

SIZE = "--size 240x180"
BALL = f"{SIZE} --orbit 20,15,3.2 --light 1,1,1"
SINE = "--expr '0.02*sin(2*pi*10*u)'"
IMAGE = "--height maps/abstract_height.png --scale 0.15"
SHEET = f"{SIZE} --eye 0,1.2,2.2 --look-at 0,-0.1,0 --fov 35 --light -1,1,0.3"
DOMES = f"sheet.glb --size 200x150 --eye 0,2.4,0.8 --look-at 0,0,0 --fov 35 --light -1,1,-0.6"
MIRROR = f"mirror.glb --size 200x150 --eye 0,2.4,0.8 --look-at 0,0,0 --fov 35 --light -1,1,-0.6"
PICTURES = {
    # Rows 20 to 23 and 28 to 30.
    "procedural-bump": f"render fine.glb {BALL} {SINE} --method bump",
    "procedural-displaced": f"render fine.glb {BALL} {SINE} --uniform 3",
    "image-bump": f"render fine.glb {BALL} {IMAGE} --method bump",
    "image-displaced": f"render fine.glb {BALL} {IMAGE} --uniform 3",
    # E11 and E18, as printed.
    "printed-inwards": f"render fine.glb {BALL} {SINE} --preset as-printed --uniform 3",
    "facets-right": f"render coarse.glb {BALL} {SINE} --method bump",
    "facets-printed": f"render coarse.glb {BALL} {SINE} --method bump --preset as-printed",
    # Rows 24, 25 and 46.
    "tangent-at-rest": f"render sheet.glb {SHEET} --normal tangent.png",
    "object-at-rest": f"render sheet.glb {SHEET} --normal object.png --space object",
    "tangent-bent": f"render bent.glb {SHEET} --normal tangent.png",
    "object-bent": f"render bent.glb {SHEET} --normal object.png --space object",
    # Green.
    "green-up": f"render {DOMES} --normal tangent.png",
    "green-down": f"render {DOMES} --normal directx.png",
    "green-flipped": f"render {DOMES} --normal directx.png --flip-green",
    # E21 and E22.
    "cyslice-printed": f"render {MIRROR} --normal cyslice.png --preset cyslice",
    "cyslice-right": f"render {MIRROR} --normal cyslice.png --swizzle grb",
    # Row 41 with E12 and E21: darts along what is taken for the S tangent, on stripes of s and t.
    **{f"tangent-{name}": f"render {name}.glb --size 200x150 --eye 0,2.6,0.9 --look-at 0,0,0.05 --fov 42 --light 0,1,0 --ambient 0.2" for name in ("dpdu", "deriv", "printed", "signed")},
    # What adds, and what does not.
    "adds": f"render {DOMES} --normal tangent.png --expr '0.02*sin(12*x)*sin(12*z)' --method bump",
    "beside": f"render sheet.glb {SHEET} --height maps/abstract_height.png --scale 0.3 --uniform 6 --normal tangent.png",
}


def dome(x: int, y: int):
    """The normal of round domes, 4 in a row: along the tangent, up, and out."""
    dx, dy = (x % 32 - 15.5) / 14, (y % 32 - 15.5) / 14
    inside = dx * dx + dy * dy < 1
    nx, ny = (0.8 * dx, -0.8 * dy) if inside else (0, 0)
    return nx, ny, math.sqrt(1 - nx * nx - ny * ny)


def coded(order):
    return lambda x, y: (*(round(127.5 + 127.5 * c) for c in order(*dome(x, y))), 255)


def on_sheet(u: float, v: float):
    return (2 * u - 1, 0, 2 * v - 1), (0, 1, 0)


def on_bent(u: float, v: float):
    """The sheet bent round an axis along z, its length kept."""
    turn = 1.2 * (2 * u - 1)
    return (math.sin(turn) / 1.2, (math.cos(turn) - 1) / 1.2, 2 * v - 1), (math.sin(turn), math.cos(turn), 0)


def mirrored(u: float, v: float) -> tuple[float, float]:
    return 1 - abs(2 * u - 1), v


def texture_at(u: float, v: float) -> tuple[float, float]:
    """s and t, which the patch's own u and v do not follow: sheared and turned, and mirrored beyond the middle."""
    s, t = u + 0.5 * v, -0.35 * u + v
    return (s, t) if u < 0.5 else (1 - s, t + 0.7 * (u - 0.5))


def tangents(u: float, v: float) -> dict[str, tuple[float, float]]:
    """Along u and v of the patch: dPdu, Deriv(P, s) = Du(P)/Du(s) + Dv(P)/Dv(s), dPdu Dv(t) - dPdv Du(t), and that with
    the sign of the determinant."""
    e = 1e-4
    (s0, t0), (s1, t1), (s2, t2) = texture_at(u, v), texture_at(u + e, v), texture_at(u, v + e)
    su, tu, sv, tv = (s1 - s0) / e, (t1 - t0) / e, (s2 - s0) / e, (t2 - t0) / e
    sign = math.copysign(1, su * tv - sv * tu)
    return {"dpdu": (1, 0), "deriv": (1 / su, 1 / sv), "printed": (tv, -tu), "signed": (sign * tv, -sign * tu)}


def stripes(x: int, y: int):
    """Red along s, green along t, and rows that the patch does not reach, dark for the darts."""
    if 168 <= y < 204:
        return 25, 25, 30, 255
    red, green = x % 32 < 6, y % 32 < 6
    return (200, 60, 50, 255) if green else (70, 160, 70, 255) if red else (225, 220, 205, 255)


def finned(name: str):
    """The patch, and dark darts on it that point along a tangent."""
    positions, normals, uvs, triangles = grid(32, 32, on_sheet)
    uvs = [(0.5 * s, 0.5 * t) for s, t in (texture_at(*uv) for uv in uvs)]
    for i in range(8):
        for j in range(6):
            u, v = (i + 0.5) / 8, (j + 0.5) / 6
            a, b = tangents(u, v)[name]
            length = math.hypot(a, b)
            ends = [(2 * u - 1 + k * 0.2 * a / length, 2 * v - 1 + k * 0.2 * b / length) for k in (0, 1)]
            side = (-0.03 * b / length, 0.03 * a / length)
            first = len(positions)
            (x0, z0), (x1, z1) = ends
            positions += [(x0 - side[0], 0.02, z0 - side[1]), (x0 + side[0], 0.02, z0 + side[1]), (x1, 0.02, z1)]
            normals += [(0, 1, 0)] * 3
            uvs += [(0.5, 186 / 256)] * 3
            triangles += [(first, first + 1, first + 2)]
    return positions, normals, uvs, triangles


def scenes(folder: Path) -> None:
    clay = {"pbrMetallicRoughness": {"baseColorFactor": [0.85, 0.6, 0.3, 1], "metallicFactor": 0, "roughnessFactor": 0.4}, "doubleSided": True}
    glb(folder / "fine.glb", grid(64, 32, on_ball), clay, [])
    glb(folder / "coarse.glb", grid(24, 12, on_ball), clay, [])
    glb(folder / "sheet.glb", grid(8, 8, on_sheet), clay, [])
    glb(folder / "bent.glb", grid(32, 1, on_bent), clay, [])
    positions, normals, uvs, triangles = grid(8, 8, on_sheet)
    glb(folder / "mirror.glb", (positions, normals, [mirrored(*uv) for uv in uvs], triangles), clay, [])
    for name in ("dpdu", "deriv", "printed", "signed"):
        colored = {"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0}, "doubleSided": True}
        glb(folder / f"{name}.glb", finned(name), colored, [png(256, 256, stripes)])
    maps = {
        "tangent": lambda x, y, z: (x, y, z),
        "directx": lambda x, y, z: (x, -y, z),
        "cyslice": lambda x, y, z: (y, x, z),
        # Of the sheet at rest: the tangent is x, up in the map -z, and out y.
        "object": lambda x, y, z: (x, z, -y),
    }
    for name, order in maps.items():
        (folder / f"{name}.png").write_bytes(png(128, 128, coded(order)))
    (folder / "maps").symlink_to((DATA / "maps").resolve())


def main() -> int:
    displace, names = Path(sys.argv[1]).resolve(), sys.argv[2:] or list(PICTURES)
    (HERE / "bump").mkdir(exist_ok=True)
    with tempfile.TemporaryDirectory() as folder:
        scenes(Path(folder))
        for name in names:
            out = HERE / "bump" / f"{name}.png"
            subprocess.run([displace, *shlex.split(PICTURES[name]), "--quiet", "-o", out], cwd=folder, check=True)
            print(out)
    return 0


if __name__ == "__main__":
    sys.exit(main())
