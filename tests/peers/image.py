"""Images by rays against Mitsuba 3: the same dense mesh, camera, light, filter and number of samples.

    image.py --displace BIN [--mesh FILE ...] [--out DIR] [--grid N] [--level N]

`displace apply` makes a GLB of each mesh (a displaced sphere, and what --mesh names); `displace render
--device reference --shadows ray` and Mitsuba make images of it, of N x N rays a pixel. Mean FLIP of each pair
must be at most 0.03, and points at pixel centres must agree; exits 1 otherwise. Needs the packages of
requirements.txt.

What is Mitsuba's own: the camera, the intersections, the `diffuse` reflection of a `directional` emitter with its
shadows, and the reading of base colour maps. Ambient light without occlusion and the highlight of Phong's model
it does not have: they are added to each of its samples from the sample's own place, normals and albedo (`aov`),
the highlight where Mitsuba's own light arrives. Mitsuba therefore renders one jittered sample in each cell of the
N x N grid of a pixel, and the box filter is their mean.

What differs for a reason: near outlines the interpolated normal can turn away from the viewer, and `diffuse` is
black there, where Phong's model as it is here is not.
"""

import argparse
import json
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

import flip_evaluator
import mitsuba as mi
import numpy as np
import trimesh
from PIL import Image

mi.set_variant("scalar_rgb")

MOST_FLIP = 0.03
# Of the scene's size: Mitsuba traces in f32.
MOST_APART = 1e-5
LIGHT, AMBIENT, BACKGROUND = np.array([2.0, 1.5, 0.5]), 0.2, 0.05
HIGHLIGHT, SHININESS = 0.2, 32


def show_both_sides(path: Path) -> None:
    """Mitsuba leaves no side out, so neither may we."""
    data = path.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    gltf, rest = json.loads(data[20 : 20 + length]), data[20 + length :]
    for material in gltf.get("materials", []):
        material["doubleSided"] = True
    text = json.dumps(gltf).encode()
    text += b" " * (-len(text) % 4)
    path.write_bytes(data[:8] + struct.pack("<III", 20 + len(text) + len(rest), len(text), 0x4E4F534A) + text + rest)


def read_glb(path: Path) -> list[dict]:
    """Triangles per primitive in world space: positions, normals, uvs, indices, base colour."""
    data = path.read_bytes()
    length = struct.unpack_from("<I", data, 12)[0]
    gltf, blob = json.loads(data[20 : 20 + length]), data[28 + length :]

    def accessor(index: int) -> np.ndarray:
        a = gltf["accessors"][index]
        view = gltf["bufferViews"][a["bufferView"]]
        kind = {5126: "<f4", 5125: "<u4", 5123: "<u2", 5121: "u1"}[a["componentType"]]
        width = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4}[a["type"]]
        start = view.get("byteOffset", 0) + a.get("byteOffset", 0)
        return np.frombuffer(blob, kind, a["count"] * width, start).reshape(-1, width)

    # Transforms by another program; the attributes as they are in the file.
    scene = trimesh.load_scene(path, process=False)
    parts = [p for mesh in gltf["meshes"] for p in mesh["primitives"]]
    nodes = list(scene.graph.nodes_geometry)
    assert len(parts) == len(nodes), "each primitive is used once"
    return [
        {
            "world_from_mesh": scene.graph[node][0],
            "positions": accessor(part["attributes"]["POSITION"]),
            "normals": accessor(part["attributes"]["NORMAL"]),
            "uvs": accessor(part["attributes"]["TEXCOORD_0"]) if "TEXCOORD_0" in part["attributes"] else None,
            "triangles": accessor(part["indices"]).reshape(-1, 3),
            "color": base_color(gltf, blob, part),
        }
        for part, node in zip(parts, nodes)
    ]


def base_color(gltf: dict, blob: bytes, part: dict) -> dict:
    """As a texture of Mitsuba."""
    material = gltf["materials"][part["material"]] if "material" in part else {}
    pbr = material.get("pbrMetallicRoughness", {})
    factor = pbr.get("baseColorFactor", [1, 1, 1, 1])[:3]
    if "baseColorTexture" not in pbr:
        return {"type": "rgb", "value": factor}
    assert factor == [1, 1, 1], "a factor and a map"
    image = gltf["images"][gltf["textures"][pbr["baseColorTexture"]["index"]]["source"]]
    view = gltf["bufferViews"][image["bufferView"]]
    start = view.get("byteOffset", 0)
    with tempfile.NamedTemporaryFile(suffix=".png") as file:
        file.write(blob[start : start + view["byteLength"]])
        file.flush()
        texels = np.array(Image.open(file.name).convert("RGB"))
    return {"type": "bitmap", "bitmap": mi.Bitmap(texels), "raw": False, "filter_type": "bilinear", "wrap_mode": "repeat"}


def shape(name: str, part: dict) -> mi.Mesh:
    props = mi.Properties()
    props["bsdf"] = mi.load_dict({"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": part["color"]}})
    count, has_uvs = len(part["positions"]), part["uvs"] is not None
    mesh = mi.Mesh(name, count, len(part["triangles"]), has_vertex_normals=True, has_vertex_texcoords=has_uvs, props=props)
    linear = part["world_from_mesh"][:3, :3]
    normals = part["normals"] @ np.linalg.inv(linear)
    params = mi.traverse(mesh)
    params["vertex_positions"] = (part["positions"] @ linear.T + part["world_from_mesh"][:3, 3]).astype(np.float32).ravel()
    params["vertex_normals"] = (normals / np.linalg.norm(normals, axis=1, keepdims=True)).astype(np.float32).ravel()
    if has_uvs:
        params["vertex_texcoords"] = part["uvs"].astype(np.float32).ravel()
    params["faces"] = part["triangles"].astype(np.uint32).ravel()
    params.update()
    return mesh


def unit(v: np.ndarray) -> list[float]:
    return (v / np.linalg.norm(v)).tolist()


class View:
    """Looks at the middle of a box from the front right above, from where all of it is seen."""

    def __init__(self, low: np.ndarray, high: np.ndarray, size: int):
        self.size, self.fov = size, 40
        self.target = 0.5 * (low + high)
        self.diagonal = float(np.linalg.norm(high - low))
        self.eye = self.target + 1.2 * self.diagonal * np.array(unit(np.array([0.5, 0.35, 1.0])))

    def flags(self) -> list[str]:
        place = lambda p: ",".join(repr(float(np.float32(x))) for x in p)  # noqa: E731
        return ["--eye", place(self.eye), "--look-at", place(self.target), "--fov", str(self.fov), "--size", f"{self.size}x{self.size}"]

    def sensor(self, grid: int) -> dict:
        to_world = mi.ScalarTransform4f().look_at(self.eye.tolist(), self.target.tolist(), [0, 1, 0])
        side = self.size * grid
        film = {"type": "hdrfilm", "width": side, "height": side, "rfilter": {"type": "box"}, "pixel_format": "rgb"}
        near_far = {"near_clip": 1e-3 * self.diagonal, "far_clip": 1e3 * self.diagonal}
        return {"type": "perspective", "fov": self.fov, "fov_axis": "y", "to_world": to_world, "film": film, **near_far}


AOVS = ["depth", "position", "sh_normal", "geo_normal", "albedo"]


def by_mitsuba(parts: list[dict], view: View, grid: int) -> tuple[np.ndarray, np.ndarray]:
    """Linear colours, and the points at pixel centres (NaN where nothing is)."""
    scene = mi.load_dict(
        {
            "type": "scene",
            "sensor": view.sensor(grid),
            # diffuse reflects base / pi of the irradiance.
            "sun": {"type": "directional", "direction": [-x for x in unit(LIGHT)], "irradiance": {"type": "rgb", "value": np.pi}},
            **{f"part_{k}": shape(f"part_{k}", part) for k, part in enumerate(parts)},
        }
    )
    direct = {"type": "direct", "emitter_samples": 1, "bsdf_samples": 0}
    integrator = mi.load_dict({"type": "aov", "aovs": ",".join(f"{aov}:{aov}" for aov in AOVS), "image": direct})
    samples = np.array(mi.render(scene, integrator=integrator, spp=1)).astype(np.float64)
    color = finished(samples[..., :3], samples[..., 3:4], *np.split(samples[..., 4:], 4, axis=-1), view.eye)
    cells = color.reshape(view.size, grid, view.size, grid, 3)
    return cells.mean(axis=(1, 3)), centre_points(scene, view.size)


def finished(diffuse, depth, position, normal, facing, albedo, eye) -> np.ndarray:
    """Adds to samples of Mitsuba what it has no model of."""
    light, to_eye = np.array(unit(LIGHT)), eye - position
    to_eye /= np.linalg.norm(to_eye, axis=-1, keepdims=True)
    dot = lambda a, b: np.sum(a * b, axis=-1, keepdims=True)  # noqa: E731
    # On the side that is seen.
    normal = normal * np.sign(dot(facing, to_eye))
    cosine = dot(normal, light)
    mirrored = 2 * cosine * normal - light
    lit = (diffuse.max(axis=-1, keepdims=True) > 0) & (cosine > 0)
    highlight = np.where(lit, HIGHLIGHT * np.maximum(dot(mirrored, to_eye), 0) ** SHININESS, 0)
    return np.where(depth > 0, diffuse + AMBIENT * albedo + highlight, BACKGROUND)


def centre_points(scene, size: int) -> np.ndarray:
    sensor, points = scene.sensors()[0], np.full((size, size, 3), np.nan)
    for y, x in np.ndindex(size, size):
        ray, _ = sensor.sample_ray(0.0, 0.5, mi.Point2f((x + 0.5) / size, (y + 0.5) / size), mi.Point2f(0.5))
        hit = scene.ray_intersect(ray)
        if hit.is_valid():
            points[y, x] = hit.p
    return points


def by_displace(options, glb: Path, view: View, path: Path) -> tuple[np.ndarray, np.ndarray]:
    light = ",".join(map(str, LIGHT))
    flags = ["--light", light, "--ambient", str(AMBIENT), "--shadows", "ray", "--supersample", str(options.grid**2)]
    run(options, ["render", str(glb), "--device", "reference", "--aov", "position,depth", *flags, *view.flags(), "-o", str(path)])
    bitmap = mi.Bitmap(str(path))
    names, values = [field.name for field in bitmap.struct_()], np.array(bitmap)
    channels = lambda wanted: np.stack([values[..., names.index(name)] for name in wanted], axis=-1)  # noqa: E731
    depth = channels("Z")
    points = np.where(np.isfinite(depth), channels([f"position.{axis}" for axis in "XYZ"]), np.nan)
    return channels("RGB"), points


def run(options, arguments: list[str]) -> None:
    subprocess.run([str(options.displace), *arguments, "--quiet"], check=True)


def srgb(linear: np.ndarray) -> np.ndarray:
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055).astype(np.float32)


def save(path: Path, image: np.ndarray) -> None:
    Image.fromarray((image * 255 + 0.5).astype(np.uint8)).save(path)


def compare(options, name: str, glb: Path) -> bool:
    parts = read_glb(glb)
    homogeneous = lambda p: p["positions"] @ p["world_from_mesh"][:3, :3].T + p["world_from_mesh"][:3, 3]  # noqa: E731
    places = np.concatenate([homogeneous(part) for part in parts])
    view = View(places.min(axis=0), places.max(axis=0), options.size)
    ours, our_points = by_displace(options, glb, view, options.out / f"{name}.exr")
    theirs, their_points = by_mitsuba(parts, view, options.grid)
    ours, theirs = srgb(ours), srgb(theirs)
    flips, mean, _ = flip_evaluator.evaluate(theirs, ours, "LDR", inputsRGB=True, applyMagma=True)
    for kind, image in (("displace", ours), ("mitsuba", theirs), ("flip", np.clip(flips, 0, 1))):
        save(options.out / f"{name}.{kind}.png", image)
    apart = np.linalg.norm(our_points - their_points, axis=-1) / view.diagonal
    one_sided = int(np.sum(np.isnan(our_points[..., 0]) != np.isnan(their_points[..., 0])))
    seen = apart[np.isfinite(apart)]
    near = float(np.mean(seen <= MOST_APART))
    triangles = sum(len(part["triangles"]) for part in parts)
    print(
        f"| {name} | {triangles} | {mean:.5f} | {np.sqrt(np.mean((ours - theirs) ** 2)):.5f} | {np.median(seen):.1e} "
        f"| {1 - near:.5f} | {one_sided} of {options.size**2} |",
        flush=True,
    )
    return mean <= MOST_FLIP and near >= 0.999 and one_sided <= options.size**2 / 1000


def sphere(path: Path) -> Path:
    ball = trimesh.creation.icosphere(subdivisions=1)
    # Unit vertices are their own normals.
    lines = [f"{kind} {x} {y} {z}" for kind in ("v", "vn") for x, y, z in ball.vertices]
    lines += [f"f {a}//{a} {b}//{b} {c}//{c}" for a, b, c in ball.faces + 1]
    path.with_suffix(".mtl").write_text("newmtl clay\nKd 0.6 0.45 0.3\n")
    path.write_text("\n".join(["mtllib sphere.mtl", "usemtl clay", *lines]) + "\n")
    return path


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--displace", type=Path, required=True, help="the displace binary")
    parser.add_argument("--mesh", type=Path, nargs="*", default=[], help="models beside the sphere")
    parser.add_argument("--out", type=Path, help="keeps the images here (default: a temporary folder)")
    parser.add_argument("--grid", type=int, default=8, help="rays a pixel each way")
    parser.add_argument("--size", type=int, default=256, help="pixels each way")
    parser.add_argument("--level", type=int, default=5, help="uniform level of subdivision")
    options = parser.parse_args()
    options.displace = options.displace.resolve()
    with tempfile.TemporaryDirectory() as scratch:
        options.out = (options.out or Path(scratch)).resolve()
        options.out.mkdir(parents=True, exist_ok=True)
        print("| mesh | triangles | mean FLIP | RMSE (sRGB) | median distance of points | points farther than 1e-5 | seen by one alone |")
        print("|---|---|---|---|---|---|---|")
        good = True
        for mesh in [sphere(options.out / "sphere.obj"), *options.mesh]:
            glb = options.out / f"{mesh.stem}.glb"
            detail = ["--expr", "0.05*sin(9*x)*sin(8*y)*sin(7*z)", "--uniform", str(options.level)]
            run(options, ["apply", str(mesh), "--device", "reference", *detail, "-o", str(glb)])
            show_both_sides(glb)
            good = compare(options, mesh.stem, glb) and good
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
