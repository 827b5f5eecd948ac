"""Images by rays against Mitsuba 3: the same dense mesh, camera, light, filter and number of samples.

    image.py --displace BIN [--mesh FILE ...] [--out DIR] [--samples N] [--level N]

`displace apply` makes a GLB of each mesh (a displaced sphere, and what --mesh names); `displace render
--device reference --supersample N --shadows ray` and Mitsuba make images of it. Mean FLIP of each pair must be
at most 0.03, and points at pixel centres must agree; exits 1 otherwise. Needs the packages of requirements.txt.

What is Mitsuba's own: the camera, the intersections, the box filter, the `diffuse` reflection of a `directional`
emitter with its shadows, and the reading of base colour maps. Ambient light without occlusion and the highlight
of Phong's model it does not have: a small integrator adds them, at Mitsuba's hits and shading normals, with
Mitsuba's shadow rays.
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

mi.set_variant("llvm_ad_rgb")
import drjit as dr  # noqa: E402  (needs the variant)

MOST_FLIP = 0.03
# Of the scene's size: Mitsuba traces in f32.
MOST_APART = 1e-5
LIGHT, AMBIENT, BACKGROUND = np.array([1.0, 2.0, 3.0]), 0.2, 0.05
HIGHLIGHT, SHININESS = 0.2, 32


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
        texels = np.asarray(Image.open(file.name).convert("RGB"))
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
        # Mitsuba's v points up.
        params["vertex_texcoords"] = (part["uvs"] * [1, -1] + [0, 1]).astype(np.float32).ravel()
    params["faces"] = part["triangles"].astype(np.uint32).ravel()
    params.update()
    return mesh


class AmbientAndHighlight(mi.SamplingIntegrator):
    """What Mitsuba has no model of, at Mitsuba's hits."""

    def sample(self, scene, sampler, ray, medium=None, active=True):
        si = scene.ray_intersect(ray, active)
        hit, light = si.is_valid(), mi.Vector3f(unit(LIGHT))
        base = si.bsdf().eval_diffuse_reflectance(si, active & hit)
        # On the side that is seen.
        normal = si.sh_frame.n * dr.sign(-dr.dot(si.n, ray.d))
        cosine = dr.dot(normal, light)
        mirrored = 2 * cosine * normal - light
        lit = hit & (cosine > 0) & ~scene.ray_test(si.spawn_ray(light), active & hit & (cosine > 0))
        highlight = dr.select(lit, HIGHLIGHT * dr.power(dr.maximum(dr.dot(mirrored, -ray.d), 0), SHININESS), 0)
        color = dr.select(hit, AMBIENT * base + highlight, mi.Color3f(BACKGROUND))
        return color, active, []


def unit(v: np.ndarray) -> list[float]:
    return (v / np.linalg.norm(v)).tolist()


class View:
    """Looks at the middle of a box from the front right above, from where all of it is seen."""

    def __init__(self, low: np.ndarray, high: np.ndarray, size: int):
        self.size, self.fov = size, 40
        self.target = 0.5 * (low + high)
        self.diagonal = float(np.linalg.norm(high - low))
        self.eye = self.target + 1.6 * self.diagonal * np.array(unit(np.array([0.5, 0.35, 1.0])))

    def flags(self) -> list[str]:
        place = lambda p: ",".join(repr(float(np.float32(x))) for x in p)  # noqa: E731
        return ["--eye", place(self.eye), "--look-at", place(self.target), "--fov", str(self.fov), "--size", f"{self.size}x{self.size}"]

    def sensor(self, samples: int) -> dict:
        to_world = mi.ScalarTransform4f().look_at(self.eye.tolist(), self.target.tolist(), [0, 1, 0])
        film = {"type": "hdrfilm", "width": self.size, "height": self.size, "rfilter": {"type": "box"}, "pixel_format": "rgb"}
        sampler = {"type": "multijitter", "sample_count": samples}
        near_far = {"near_clip": 1e-3 * self.diagonal, "far_clip": 1e3 * self.diagonal}
        return {"type": "perspective", "fov": self.fov, "fov_axis": "y", "to_world": to_world, "film": film, "sampler": sampler, **near_far}


def by_mitsuba(parts: list[dict], view: View, samples: int) -> tuple[np.ndarray, np.ndarray]:
    """Linear colours, and the points at pixel centres (NaN where nothing is)."""
    scene = mi.load_dict(
        {
            "type": "scene",
            "sensor": view.sensor(samples),
            # diffuse reflects base / pi of the irradiance.
            "sun": {"type": "directional", "direction": [-x for x in unit(LIGHT)], "irradiance": {"type": "rgb", "value": np.pi}},
            **{f"part_{k}": shape(f"part_{k}", part) for k, part in enumerate(parts)},
        }
    )
    mi.register_integrator("ambient_and_highlight", lambda props: AmbientAndHighlight(props))
    integrators = [{"type": "direct", "emitter_samples": 1, "bsdf_samples": 0}, {"type": "ambient_and_highlight"}]
    image = sum(np.array(mi.render(scene, integrator=mi.load_dict(i), spp=samples)) for i in integrators)
    rows, columns = np.divmod(np.arange(view.size**2), view.size)
    at = mi.Point2f(((columns + 0.5) / view.size).astype(np.float32), ((rows + 0.5) / view.size).astype(np.float32))
    ray, _ = scene.sensors()[0].sample_ray(0.0, 0.5, at, mi.Point2f(0.5))
    si = scene.ray_intersect(ray)
    points = np.where(np.array(si.is_valid())[:, None], np.array(si.p).T, np.nan)
    return image, points.reshape(view.size, view.size, 3)


def by_displace(options, glb: Path, view: View, path: Path) -> tuple[np.ndarray, np.ndarray]:
    light = ",".join(map(str, LIGHT))
    flags = ["--light", light, "--ambient", str(AMBIENT), "--shadows", "ray", "--supersample", str(options.samples)]
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
    theirs, their_points = by_mitsuba(parts, view, options.samples)
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
    path.write_text(trimesh.exchange.obj.export_obj(ball, include_normals=True))
    return path


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--displace", type=Path, required=True, help="the displace binary")
    parser.add_argument("--mesh", type=Path, nargs="*", default=[], help="models beside the sphere")
    parser.add_argument("--out", type=Path, help="keeps the images here (default: a temporary folder)")
    parser.add_argument("--samples", type=int, default=64)
    parser.add_argument("--size", type=int, default=256)
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
            good = compare(options, mesh.stem, glb) and good
    return 0 if good else 1


if __name__ == "__main__":
    sys.exit(main())
