"""Makes a height map out of a normal map: `integrate_height.py MESH.glb NORMAL.png FOLDER [--size 256] [--flip-v] [--flip-red] [--flip-green]`.

A normal is a slope along the map's rows and columns. The heights whose differences fit these slopes best, in the sense of
least squares, solve Poisson's equation (Frankot and Chellappa 1988); here with weights, by conjugate gradients with a cosine
transform before them: texels that no chart covers have no slope and continue their neighbours, borders are free, and both
sides of a UV seam are asked for one height. A texel is as long as the root of the mesh's area over that of its charts, so
heights are in mesh units. What is written to FOLDER: `height.png`, N x N of 16 bits, `normal.png`, the map as glTF has it,
and MESH with V down as `plain.glb` and, with the map in its material, `mapped.glb`. `scale` and `midlevel` are printed, and
how far the normals of the heights are from those of the map. Needs numpy and Pillow.

The curl of the slopes tells whether one of red and green is turned round: a map of a surface has none. Both of them turned
round are a dent for each bump; that only the eye can tell.
"""

import argparse
from pathlib import Path

import numpy as np
from glb import accessor, read_glb, with_map, write_glb
from PIL import Image

LINK = 1e-3  # weight of differences that no slope is known of, against 1
SEAM = 0.1  # weight of a difference across a UV seam


def write_scenes(folder: Path, document, blob, picture: bytes) -> None:
    """The mesh with a plain material, and with the map in it."""
    document["scenes"], document["scene"] = [document["scenes"][document.get("scene", 0)]], 0
    skin = {"baseColorFactor": [0.6, 0.45, 0.38, 1], "metallicFactor": 0, "roughnessFactor": 0.55}
    document["materials"] = [{"pbrMetallicRoughness": skin}]
    write_glb(folder / "plain.glb", document, blob)
    write_glb(folder / "mapped.glb", *with_map(document, blob, picture))


def surface_slopes(pixels):
    """Rises of the surface per length along rows (right) and columns (down), of normals (r, g, b) = 2 c / 255 - 1, green up."""
    n = pixels[..., :3] / 127.5 - 1
    return np.stack([-n[..., 0], n[..., 1]], axis=-1) / np.maximum(n[..., 2:], 0.05)


def curl(slopes, covered, step: int = 4) -> float:
    """Root mean square of what one goes up on a way around, between means of `step` x `step` texels."""
    p = means(slopes, step)
    inside = means(covered[..., None].astype(float), step)[..., 0] == 1
    whole = inside[:-1, :-1] & inside[1:, :-1] & inside[:-1, 1:] & inside[1:, 1:]
    right, down = p[:, :-1, 0] + p[:, 1:, 0], p[:-1, :, 1] + p[1:, :, 1]
    around = right[:-1] + down[:, 1:] - right[1:] - down[:, :-1]
    return float(np.sqrt(np.mean(around[whole] ** 2)) / 2)


def means(values, step: int):
    rows, columns = values.shape[0] // step, values.shape[1] // step
    return values.reshape(rows, step, columns, step, -1).mean(axis=(1, 3))


def texel_length(places, uvs, size: int) -> float:
    """Mesh units: a texel's share of the mesh's area, charts alone."""
    e, f = places[:, 1:] - places[:, :1], uvs[:, 1:] - uvs[:, :1]
    area = np.linalg.norm(np.cross(e[:, 0], e[:, 1]), axis=1).sum()
    chart = np.abs(f[:, 0, 0] * f[:, 1, 1] - f[:, 0, 1] * f[:, 1, 0]).sum()
    return float(np.sqrt(area / chart) / size)


def charts(uvs, size: int):
    """The triangle that covers each texel's centre, or -1."""
    owner = np.full((size, size), -1)
    for number, corners in enumerate(uvs * size - 0.5):
        low = np.maximum(np.ceil(corners.min(0)).astype(int), 0)
        high = np.minimum(np.floor(corners.max(0)).astype(int), size - 1)
        x, y = np.meshgrid(np.arange(low[0], high[0] + 1), np.arange(low[1], high[1] + 1))
        sides = [cross(corners[k], corners[k - 2], x, y) for k in range(3)]
        inside = (np.min(sides, axis=0) >= 0) | (np.max(sides, axis=0) <= 0)
        owner[y[inside], x[inside]] = number
    return owner


def cross(a, b, x, y):
    return (b[0] - a[0]) * (y - a[1]) - (b[1] - a[1]) * (x - a[0])


def seam_pairs(uvs, triangles, size: int, samples: int = 16):
    """Texels that hold one place of a seam on its two sides: two arrays of flat indices."""
    sides = {}
    for t, corners in enumerate(triangles):
        for k in range(3):
            a, b = (k, (k + 1) % 3) if corners[k] < corners[(k + 1) % 3] else ((k + 1) % 3, k)
            sides.setdefault((corners[a], corners[b]), []).append((uvs[t, a], uvs[t, b]))
    pairs = [s for s in sides.values() if len(s) == 2 and np.abs(np.subtract(*s)).max() > 1e-6]
    share = (np.arange(samples) + 0.5)[:, None] / samples
    texels = [[np.clip((a + share * (b - a)) * size, 0, size - 1).astype(int) for a, b in pair] for pair in pairs]
    flat = lambda k: np.concatenate([t[k][:, 1] * size + t[k][:, 0] for t in texels]) if texels else np.zeros(0, int)  # noqa: E731
    return flat(0), flat(1)


def poisson(right):
    """Heights whose five-point Laplacian is -`right` with Neumann borders: a cosine transform, by FFT of the even extension."""
    n, m = right.shape
    even = np.fft.rfft2(np.pad(right, ((0, n), (0, m)), mode="symmetric"))
    rows, columns = np.arange(2 * n)[:, None] / (2 * n), np.arange(m + 1)[None, :] / (2 * m)
    scale = 4 - 2 * np.cos(2 * np.pi * rows) - 2 * np.cos(2 * np.pi * columns)
    scale[0, 0] = np.inf
    return np.fft.irfft2(even / scale, s=(2 * n, 2 * m))[:n, :m]


def integrate(slopes, covered, seams, steps: int):
    """Heights in texels of slopes to the right and down: least squares over covered texels."""
    links = [np.where(covered[:, 1:] & covered[:, :-1], 1.0, LINK), np.where(covered[1:] & covered[:-1], 1.0, LINK)]
    known = [(slopes[:, 1:, 0] + slopes[:, :-1, 0]) / 2, (slopes[1:, :, 1] + slopes[:-1, :, 1]) / 2]

    def gather(right, down, across):
        """Adjoint of the differences."""
        out = np.zeros(covered.shape)
        out[:, 1:] += right
        out[:, :-1] -= right
        out[1:] += down
        out[:-1] -= down
        np.add.at(out.reshape(-1), seams[0], across)
        np.add.at(out.reshape(-1), seams[1], -across)
        return out

    def normal_equations(h):
        across = SEAM * (h.reshape(-1)[seams[0]] - h.reshape(-1)[seams[1]])
        return gather(links[0] * np.diff(h, axis=1), links[1] * np.diff(h, axis=0), across)

    right = gather(*(k * (w == 1) for k, w in zip(known, links)), np.zeros(len(seams[0])))
    return conjugate_gradients(normal_equations, right, steps)


def conjugate_gradients(matrix, right, steps: int):
    h, rest = np.zeros_like(right), right.copy()
    ahead = direction = poisson(rest)
    gain = first = np.vdot(rest, ahead)
    for step in range(steps):
        moved = matrix(direction)
        length = gain / np.vdot(direction, moved)
        h, rest = h + length * direction, rest - length * moved
        ahead = poisson(rest)
        gain, before = np.vdot(rest, ahead), gain
        if gain < 1e-10 * first:
            break
        direction = ahead + gain / before * direction
    print(f"conjugate gradients: {step + 1} steps, energy of the rest {gain / first:.1e} of the first")
    return h


def angles(height, slopes, covered):
    """Degrees between the normals of heights in texels and those of slopes, at covered texels."""
    down, right = np.gradient(height)
    normals = [np.dstack([-p, -q, np.ones_like(p)]) for p, q in ((right, down), (slopes[..., 0], slopes[..., 1]))]
    a, b = (n / np.linalg.norm(n, axis=2, keepdims=True) for n in normals)
    return np.degrees(2 * np.arcsin(np.linalg.norm(a - b, axis=2)[covered] / 2))


def told(name: str, degrees) -> None:
    print(f"{name}: mean {degrees.mean():.2f}, median {np.median(degrees):.2f}, 99 % below {np.percentile(degrees, 99):.2f} degrees")


def quantised(height, step: int):
    """Means over step x step texels as 16-bit values, with the range (low, high) that they span."""
    small = means(height[..., None], step)[..., 0]
    low, high = small.min(), small.max()
    return np.round((small - low) / (high - low) * 65535).astype(np.uint16), low, high


def read_back(values, low: float, high: float, size: int):
    """Heights between 16-bit texels, bilinear, at the texels of a larger map."""
    heights = Image.fromarray((low + values / 65535 * (high - low)).astype(np.float32))
    return np.asarray(heights.resize((size, size), Image.BILINEAR), dtype=float)


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("mesh", type=Path)
    parser.add_argument("map", type=Path)
    parser.add_argument("folder", type=Path)
    parser.add_argument("--size", type=int, default=256, help="texels of a side; divides the map's")
    for name in ("v", "red", "green"):
        parser.add_argument(f"--flip-{name}", action="store_true")
    return parser.parse_args()


def read_map(options):
    """8-bit RGB of the map as glTF has it: red to the right, green up."""
    pixels = np.array(Image.open(options.map).convert("RGB"))
    for channel, flip in enumerate((options.flip_red, options.flip_green)):
        pixels[..., channel] = 255 - pixels[..., channel] if flip else pixels[..., channel]
    return pixels


def read_mesh(options):
    """Document, chunk, and of each corner of each triangle its place, texture coordinates with V down, and welded vertex."""
    document, blob = read_glb(options.mesh)
    primitive = document["meshes"][0]["primitives"][0]
    positions, uv = (accessor(document, blob, primitive["attributes"][name]) for name in ("POSITION", "TEXCOORD_0"))
    if options.flip_v:
        uv[:, 1] = 1 - uv[:, 1]
    corners = accessor(document, blob, primitive["indices"]).reshape(-1, 3)
    _, welded = np.unique(positions, axis=0, return_inverse=True)
    return document, blob, positions[corners].astype(float), uv[corners].astype(float), welded.reshape(-1)[corners]


def main() -> None:
    options = arguments()
    options.folder.mkdir(parents=True, exist_ok=True)
    pixels = read_map(options)
    Image.fromarray(pixels).save(options.folder / "normal.png")
    document, blob, places, uvs, welded = read_mesh(options)
    write_scenes(options.folder, document, blob, (options.folder / "normal.png").read_bytes())
    size = len(pixels)
    covered, slopes = charts(uvs, size) >= 0, surface_slopes(pixels)
    print(f"curl: {curl(slopes, covered):.3f}; with green turned round {curl(slopes * [1, -1], covered):.3f}")
    seams = seam_pairs(uvs, welded, size)
    height = integrate(slopes, covered, seams, 60)
    report(options, height, slopes, covered, seams, texel_length(places, uvs, size))


def report(options, height, slopes, covered, seams, texel: float) -> None:
    height -= height[covered].mean()
    gaps = np.abs(height.reshape(-1)[seams[0]] - height.reshape(-1)[seams[1]]) * texel
    values, low, high = quantised(height, len(height) // options.size)
    Image.fromarray(values).save(options.folder / "height.png")
    told("normals of heights of the map's size", angles(height, slopes, covered))
    told("normals of height.png", angles(read_back(values, low, high, len(height)), slopes, covered))
    told("normals of no heights", angles(0 * height, slopes, covered))
    print(f"gap at seams: mean {gaps.mean():.5f}, most {gaps.max():.5f} mesh units; a texel is {texel:.5f}")
    print(f"--scale {(high - low) * texel:.6f} --midlevel {-low / (high - low):.6f}")


if __name__ == "__main__":
    main()
