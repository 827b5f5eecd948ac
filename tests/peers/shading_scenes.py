"""Scenes for `shading.py` and `shading_speed.py`: a mesh, its maps, an environment and a camera, the same for every renderer.

A scene is a folder that holds scene.glb (for `displace`), mesh.npz (the same arrays), base.png (sRGB), normal.png and
metallic_roughness.png (green and blue, as glTF has them), environment.exr and camera.json. World axes are glTF's.
"""

import io
import json
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from PIL import Image

from gltf import Gltf, Part, write_glb

MAPS = ("base", "metallic_roughness", "normal")
# Of environment.exr: texels, and where -Z lies in it, a share of its width; towards +X is to the right, +Y is up. So +X is in
# the middle, as three.js and Khronos' viewer have it.
ENVIRONMENT_SIZE = (512, 256)
FORWARD_U = 0.25
# Towards the middle, width in radians, radiance there: a soft sun, a red and a green lamp.
LAMPS = [((0.6, 0.6, 0.5), 0.12, (24.0, 20.0, 15.0)), ((-0.9, 0.1, 0.4), 0.2, (2.5, 0.4, 0.3)), ((0.3, -0.2, -0.9), 0.25, (0.3, 2.0, 0.6))]


@dataclass
class Scene:
    """`images` are PNG files by the names of `MAPS`; the camera's field of view is vertical, its image square."""

    name: str
    part: Part
    images: dict[str, bytes]
    eye: tuple[float, float, float]
    target: tuple[float, float, float]
    yfov_degrees: float

    def write(self, folder: Path) -> Path:
        folder.mkdir(parents=True, exist_ok=True)
        write_glb(folder / "scene.glb", self.part, self.images)
        baked = Gltf(folder / "scene.glb").parts()[0]
        streams = {"positions": baked.positions, "normals": baked.normals, "uvs": baked.uvs, "triangles": baked.triangles}
        np.savez(folder / "mesh.npz", **streams)
        for name, data in self.images.items():
            (folder / f"{name}.png").write_bytes(data)
        camera = {"eye": self.eye, "target": self.target, "yfov_degrees": self.yfov_degrees}
        (folder / "camera.json").write_text(json.dumps(camera))
        return folder


def sphere(columns: int = 128, rows: int = 64, width: int = 1024) -> Scene:
    """Of radius 1, in bands of paint, wood and metal, with bumps."""
    images = dict(zip(MAPS, map(png, (paint(width), metal_and_roughness(width), bumps(width)))))
    return Scene("sphere", uv_sphere(columns, rows), images, (1.2, 0.9, 3.4), (0.0, 0.0, 0.0), 34.0)


def avocado(corpus: Path) -> Scene:
    return of_model("Avocado", corpus / "models/Avocado/Avocado.gltf", (-0.55, 0.35, 1.0), 30.0)


def wicker(corpus: Path) -> Scene:
    """Without its coat and its occlusion, which the others do not have in the same sense."""
    return of_model("ClearcoatWicker", corpus / "models/ClearcoatWicker.glb", (0.6, 0.5, 1.0), 30.0)


def of_model(name: str, file: Path, towards_eye: tuple[float, float, float], yfov_degrees: float) -> Scene:
    """The one primitive of a model, framed by its sphere, with factors of one."""
    model = Gltf(file)
    (part,) = model.parts()
    pbr = part.material["pbrMetallicRoughness"]
    textures = pbr["baseColorTexture"], pbr["metallicRoughnessTexture"], part.material["normalTexture"]
    images = {key: model.image(texture) for key, texture in zip(MAPS, textures)}
    places = part.positions @ part.world_from_mesh[:3, :3].T + part.world_from_mesh[:3, 3]
    middle = 0.5 * (places.min(axis=0) + places.max(axis=0))
    radius = np.linalg.norm(places - middle, axis=1).max()
    away = np.array(towards_eye) / np.linalg.norm(towards_eye) * radius * 1.05 / np.sin(np.radians(yfov_degrees / 2))
    f32 = lambda place: tuple(float(np.float32(x)) for x in place)  # noqa: E731
    return Scene(name, part, images, f32(middle + away), f32(middle), yfov_degrees)


def uv_sphere(columns: int, rows: int) -> Part:
    """u once around from -Z by -X, v from the north pole down; a row of vertices at each pole, one for each of its triangles."""
    u, v = np.meshgrid(np.linspace(0, 1, columns + 1), np.linspace(0, 1, rows + 1))
    u[[0, -1]] += 0.5 / columns
    normals = direction(-u, v, forward_u=0.0)
    normals[[0, -1]] = [[[0, 1, 0]], [[0, -1, 0]]]
    k = (np.arange(rows)[:, None] * (columns + 1) + np.arange(columns)).ravel()
    below = k + columns + 1
    upper, lower = np.stack([k, below + 1, k + 1], 1), np.stack([k, below, below + 1], 1)
    triangles = np.concatenate([upper[columns:], lower[:-columns]])
    flat = [stream.reshape(-1, width).astype(np.float32) for stream, width in ((normals, 3), (np.stack([u, v], -1), 2))]
    return Part(flat[0], flat[0], flat[1], None, triangles, {}, np.eye(4))


def direction(u: np.ndarray, v: np.ndarray, forward_u: float = FORWARD_U) -> np.ndarray:
    """(..., 3) of places in an equirectangular image."""
    longitude, colatitude = 2 * np.pi * (u - forward_u), np.pi * v
    ring = np.sin(colatitude)
    return np.stack([np.sin(longitude) * ring, np.cos(colatitude), -np.cos(longitude) * ring], axis=-1)


def environment(width: int, height: int, rows_at_ends: bool = False) -> np.ndarray:
    """Linear radiance, f32 (height, width, 3): sky over ground, a soft sun, and two coloured lamps. Texels hold the value at
    their centre; with `rows_at_ends` the first and last rows lie on the poles."""
    steps = np.arange(height) / (height - 1) if rows_at_ends else (np.arange(height) + 0.5) / height
    u, v = np.meshgrid((np.arange(width) + 0.5) / width, steps)
    towards = direction(u, v)
    up = towards[..., 1:2]
    zenith, haze = np.array([0.4, 0.6, 0.95]), np.array([0.9, 0.95, 1.0])
    sky = zenith + (haze - zenith) * (1 - np.abs(up)) ** 3
    ground = np.array([0.25, 0.2, 0.16]) * (1 + 0.4 * up)
    horizon = 0.5 + 0.5 * np.tanh(up / 0.08)
    light = ground + (sky - ground) * horizon
    for middle, width_radians, radiance in LAMPS:
        cosine = towards @ (np.array(middle) / np.linalg.norm(middle))
        light += np.exp((cosine - 1) / width_radians**2)[..., None] * np.array(radiance)
    return light.astype(np.float32)


def texels(width: int) -> tuple[np.ndarray, np.ndarray]:
    """Angles around and down at the centres of a map twice as wide as high."""
    return np.meshgrid(2 * np.pi * (np.arange(width) + 0.5) / width, np.pi * (np.arange(width // 2) + 0.5) / (width // 2))


def paint(width: int) -> np.ndarray:
    x, y = texels(width)
    squares = np.sign(np.sin(12 * x) * np.sin(12 * y))
    grain = 0.5 + 0.5 * np.sin(3 * x + 4 * np.sin(2 * y) + 40 * y)
    colors = np.stack([0.6 + 0.25 * squares, 0.6 + 0.2 * np.cos(x) + 0.1 * squares, 0.45 + 0.2 * grain], axis=-1)
    return np.clip(colors, 0, 1)


def metal_and_roughness(width: int) -> np.ndarray:
    x, y = texels(width)
    rough = 0.55 + 0.3 * np.sin(4 * x) * np.sin(3 * y)
    metal = 0.5 + 0.5 * np.tanh(6 * np.sin(2 * x + 1) * np.sin(2 * y))
    return np.stack([np.zeros_like(x), rough, metal], axis=-1)


def bumps(width: int) -> np.ndarray:
    """Green is up the image, slopes at most about 15 degrees."""
    x, y = texels(width)
    right, down = 0.25 * np.cos(20 * x) * np.sin(16 * y), 0.25 * np.sin(20 * x) * np.cos(16 * y)
    normal = np.stack([-right, down, np.ones_like(x)], axis=-1)
    return 0.5 + 0.5 * normal / np.linalg.norm(normal, axis=-1, keepdims=True)


def png(values: np.ndarray) -> bytes:
    file = io.BytesIO()
    Image.fromarray((values * 255 + 0.5).astype(np.uint8)).save(file, "PNG")
    return file.getvalue()
