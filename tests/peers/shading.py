"""Shading beside Mitsuba's and Cycles': the same mesh, maps, environment, camera and filter.

    shading.py [--displace BIN] --corpus DIR [--bpy PYTHON] [--scenes sphere,Avocado,ClearcoatWicker] [--size N] [--out DIR]

Scenes: `shading_scenes.py`. Nothing is displaced, lights are the environment alone, reflected once. Each row compares two
images where both show the object alone, clipped and sRGB-encoded: mean FLIP of the picture, its mean on the object, and RMSE of linear values. Beside
each pair its images lie in DIR as one PNG: the two, FLIP times 3, and the difference times 5 about grey. What differs for a
reason, and by how much, stands in rows of the peers alone:

- noise: Mitsuba beside itself with other random numbers;
- no shadows: Mitsuba with and without the mesh in the environment's way; we have none of these shadows;
- Burley: Mitsuba's `principled` beside glTF's BRDF (appendix B) in Mitsuba; its diffuse part is not Lambert's;
- scattered more than once: Cycles, and ours, beside glTF's BRDF, which loses that light; `GGX` is Cycles without it.

Exits 1 where ours is further than `MOST_FLIP` from Cycles without shadows, or Cycles without that light from Mitsuba. Without --displace the peers alone. Mitsuba compiles with LLVM 19: see README.md.
"""

import argparse
import json
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import flip_evaluator
import mitsuba as mi
import numpy as np
from PIL import Image

mi.set_variant("llvm_ad_rgb")

import shading_mitsuba  # noqa: E402
import shading_scenes  # noqa: E402

MOST_FLIP = 0.05
LOOK = ["--shading", "pbr", "--filter", "ewa", "--supersample", "16"]
SCENES = {"sphere": lambda corpus: shading_scenes.sphere(), "Avocado": shading_scenes.avocado, "ClearcoatWicker": shading_scenes.wicker}


def by_displace(options, folder: Path) -> np.ndarray:
    camera = json.loads((folder / "camera.json").read_text())
    place = lambda name: ",".join(map(repr, camera[name]))  # noqa: E731
    view = ["--eye", place("eye"), "--look-at", place("target"), "--fov", repr(camera["yfov_degrees"])]
    size, file = ["--size", f"{options.size}x{options.size}"], folder / "displace.exr"
    light = ["--env", str(folder / "environment.exr"), *LOOK]
    command = [str(options.displace), "render", str(folder / "scene.glb"), *light, *view, *size, "--quiet", "-o", str(file)]
    subprocess.run(command + (["--device", options.device] if options.device else []), check=True, timeout=500)
    return read(file)


def by_cycles(options, folder: Path, flags: list[str]) -> np.ndarray:
    script, file = Path(__file__).with_name("shading_blender.py"), folder / "cycles.exr"
    command = [options.bpy, str(script), str(folder), str(file), str(options.size), str(options.samples), *flags]
    done = subprocess.run(command, capture_output=True, text=True, timeout=3000)
    if done.returncode != 0:
        sys.exit(done.stderr)
    return read(file)


def read(file: Path) -> np.ndarray:
    bitmap = mi.Bitmap(str(file))
    names, values = [field.name for field in bitmap.struct_()], np.array(bitmap, np.float64)
    return np.stack([values[..., names.index(name)] for name in "RGBA"], axis=-1)


class Images:
    """Of one scene, made when first asked for."""

    def __init__(self, options, scene: shading_scenes.Scene):
        self.options, self.folder, self.made = options, scene.write(options.out / scene.name), {}
        mi.Bitmap(shading_scenes.environment(*shading_scenes.ENVIRONMENT_SIZE)).write(str(self.folder / "environment.exr"))

    def __getitem__(self, name: str) -> np.ndarray:
        if name not in self.made:
            self.made[name] = self.make(*name.split(", "))
        return self.made[name]

    def make(self, renderer: str, *ways: str) -> np.ndarray:
        if renderer == "displace":
            return by_displace(self.options, self.folder)
        unshadowed = "no shadows" in ways
        if renderer == "Cycles":
            flags = ["--unshadowed"] * unshadowed + ["--distribution", "GGX"] * ("GGX" in ways)
            return by_cycles(self.options, self.folder, flags)
        scene = shading_mitsuba.load(self.folder, self.options.size, "principled" if "Burley" in ways else "gltf")
        return shading_mitsuba.render(scene, 4 * self.options.samples, not unshadowed, first_seed=1000 * ("noise" in ways))


def pairs(options):
    """(the two images, whether they must agree)."""
    plain, bare = "Mitsuba", "Mitsuba, no shadows"
    yield plain, "Mitsuba, noise", True
    yield plain, bare, False
    yield plain, "Mitsuba, Burley", False
    if options.bpy:
        yield "Cycles, GGX", plain, True
        yield "Cycles", plain, False
    if options.displace:
        yield "displace", bare, False
        yield "displace", plain, False
        if options.bpy:
            yield "displace", "Cycles, no shadows", True
            yield "displace", "Cycles", False


def compare(a: np.ndarray, b: np.ndarray, file: Path) -> tuple[float, float, float]:
    """Mean FLIP, mean FLIP on the object, RMSE there; writes the sheet."""
    # Ours shows the environment behind the object: what the peer does not cover whole is left out of both.
    whole = np.minimum(a[..., 3:], b[..., 3:]) >= 1
    a, b = a * whole, b * whole
    left, right = srgb(a[..., :3]), srgb(b[..., :3])
    flips = np.asarray(flip_evaluator.evaluate(right, left, "LDR", inputsRGB=True, applyMagma=False)[0]).squeeze()
    apart, on = a[..., :3] - b[..., :3], (a[..., 3] > 0) | (b[..., 3] > 0)
    grey = np.repeat(np.minimum(3 * flips, 1)[..., None], 3, axis=2)
    sheet = np.concatenate([left, right, grey, np.clip(0.5 + 5 * apart, 0, 1)], axis=1)
    Image.fromarray((sheet * 255 + 0.5).astype(np.uint8)).save(file)
    return float(flips.mean(dtype=np.float64)), float(flips[on].mean(dtype=np.float64)), float(np.sqrt((apart[on] ** 2).mean()))


def srgb(linear: np.ndarray) -> np.ndarray:
    linear = np.clip(linear, 0, 1)
    return np.where(linear <= 0.0031308, 12.92 * linear, 1.055 * linear ** (1 / 2.4) - 0.055).astype(np.float32)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--displace", type=Path, help="the displace binary; without it the peers alone")
    parser.add_argument("--corpus", type=Path, default=os.environ.get("DISPLACE_CORPUS"), help="default: DISPLACE_CORPUS")
    parser.add_argument("--bpy", help="a Python that has bpy; without it no Cycles")
    parser.add_argument("--device", help="of displace")
    parser.add_argument("--scenes", default=",".join(SCENES))
    parser.add_argument("--size", type=int, default=320, help="pixels each way")
    parser.add_argument("--samples", type=int, default=256, help="of Cycles a pixel; Mitsuba takes four times as many")
    parser.add_argument("--out", type=Path, help="keeps the files here (default: a temporary folder)")
    options = parser.parse_args()
    if options.corpus is None:
        parser.error("models are in the corpus: give --corpus or set DISPLACE_CORPUS")
    if unknown := set(options.scenes.split(",")) - set(SCENES):
        parser.error(f"no scene is named {', '.join(sorted(unknown))}: choose from {', '.join(SCENES)}")
    options.displace = options.displace and options.displace.resolve()
    with tempfile.TemporaryDirectory() as scratch:
        options.out = (options.out or Path(scratch)).resolve()
        return check(options)


def check(options) -> int:
    bad = 0
    print("| scene | images | mean FLIP | on the object | RMSE | verdict |\n|---|---|---|---|---|---|")
    for name in options.scenes.split(","):
        images = Images(options, SCENES[name](Path(options.corpus)))
        for a, b, judged in pairs(options):
            file = images.folder / f"{a} beside {b}.png".replace(", ", "-").replace(" ", "-")
            flip, on_object, rmse = compare(images[a], images[b], file)
            bad += judged and flip > MOST_FLIP
            verdict = ("ok" if flip <= MOST_FLIP else "differs") if judged else "explains"
            print(f"| {name} | {a} / {b} | {flip:.4f} | {on_object:.4f} | {rmse:.4f} | {verdict} |", flush=True)
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
