"""Seconds of an image beside Cycles and Mitsuba, in one run, on two processors.

    shading_speed.py [--displace BIN] [--bpy PYTHON] [--device NAME] [--runs N] [--flip] [--scenes SCENE ...] [--out DIR]

At 1024 x 1024:

- matte: a sphere with a base colour and a normal map under a sun, 4 and 16 samples a pixel;
- environment: the sphere of `shading_scenes.py` under its environment, all its maps, 4 and 16 samples;
- displaced: a plane and a height map of 512 texels a side, to triangles of a pixel, 1 and 16 samples; Cycles dices it
  to 2.1 million.

Peers: seconds of a render of the loaded scene, the first one (which compiles, for Mitsuba) and the median of the others.
Ours: of the whole program, start, reading and writing included, the first and the median of the others, computed afresh each
time, and never with fewer than 4 samples. Wall seconds, and processor seconds of the median after them: other work on the
machine changes these less. The frame alone is told, too: passes of the report, without start, files and codecs. Mean FLIP, with
--flip, is that of each image to the same program's own with 256 samples. Prints a Markdown table with ratios of wall
seconds, theirs / ours; exits 0. Without --displace the peers alone.
"""

import argparse
import json
import os
import resource
import shutil
import statistics
import subprocess
import tempfile
import time
from pathlib import Path

import mitsuba as mi
import numpy as np

mi.set_variant("llvm_ad_rgb")

import shading_mitsuba  # noqa: E402
import shading_scenes  # noqa: E402
from gltf import Part, write_glb  # noqa: E402

SIZE = 1024
SCALE, MIDLEVEL, TEXELS = 0.1, 0.5, 512
# Of ours. A matte sphere has roughness 1 and no metal.
SUN = ["--light", "0.5,0.8,1", "--ambient", "0"]
LOOKS = {"matte": SUN, "environment": ["--shading", "pbr", "--ambient", "0"], "displaced": SUN}
# Passes of a report that are no rendering.
NOT_FRAME = {"read_gltf", "decode_maps", "decode_bumps", "decode_images", "compile", "encode"}
CONVERGED = 256
Seconds = dict[str, list[float]]


def plane(folder: Path) -> Path:
    """The square from -1 to 1, facing +Z, filling the image; its heights are smooth waves and repeat."""
    folder.mkdir(parents=True, exist_ok=True)
    corners = np.array([[-1, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]], np.float32)
    uvs = np.array([[0, 1], [1, 1], [1, 0], [0, 0]], np.float32)
    normals, triangles = np.tile(np.float32([0, 0, 1]), (4, 1)), np.array([[0, 1, 2], [0, 2, 3]])
    np.savez(folder / "mesh.npz", positions=corners, normals=normals, uvs=uvs, triangles=triangles)
    write_glb(folder / "scene.glb", Part(corners, normals, uvs, None, triangles, {}, np.eye(4)), {})
    u, v = np.meshgrid(*[(np.arange(TEXELS) + 0.5) / TEXELS] * 2)
    waves = [(1, 2, 0.2, 0.3), (3, -1, 0.12, 1.1), (5, 4, 0.08, 2.0), (11, 7, 0.06, 0.7), (16, -9, 0.04, 4.0)]
    heights = 0.5 + sum(a * np.sin(2 * np.pi * (f * u + g * v) + p) for f, g, a, p in waves)
    (folder / "height.png").write_bytes(shading_scenes.png(heights))
    camera = {"eye": (0.0, 0.0, 5.0), "target": (0.0, 0.0, 0.0), "yfov_degrees": float(np.degrees(2 * np.arctan(1 / 5)))}
    (folder / "camera.json").write_text(json.dumps(camera))
    return folder


def sphere(folder: Path) -> Path:
    shading_scenes.sphere().write(folder)
    mi.Bitmap(shading_scenes.environment(*shading_scenes.ENVIRONMENT_SIZE)).write(str(folder / "environment.exr"))
    return folder


def by_cycles(options, scene: str, folder: Path, samples: int) -> Seconds:
    here, ends = Path(__file__).parent, ["--repeat", str(options.runs)]
    common = [str(folder / "cycles.exr"), str(SIZE), str(samples)]
    if scene == "displaced":
        files = [str(folder / name) for name in ("mesh.npz", "height.png", "camera.json")]
        command = [here / "displaced_blender.py", *files, *common, str(SCALE), str(MIDLEVEL), *ends]
    else:
        command = [here / "shading_blender.py", str(folder), *common, *ends, *["--matte"] * (scene == "matte")]
    done = subprocess.run([options.bpy, *map(str, command)], capture_output=True, text=True, timeout=3000)
    if done.returncode != 0:
        raise SystemExit(done.stderr)
    return json.loads(done.stdout.splitlines()[-1])


def by_mitsuba(options, scene: str, folder: Path, samples: int) -> Seconds:
    loaded = shading_mitsuba.load(folder, SIZE, "diffuse" if scene == "matte" else "principled")
    counts = {"emitter_samples": 1, "bsdf_samples": int(scene != "matte")}
    integrator = mi.load_dict({"type": "direct", "hide_emitters": True, **counts})

    def once():
        mi.util.write_bitmap(str(folder / "mitsuba.exr"), mi.render(loaded, integrator=integrator, spp=samples), write_async=False)

    return timed(options.runs, once, resource.RUSAGE_SELF)


def by_displace(options, scene: str, folder: Path, samples: int) -> Seconds:
    frames: list[float] = []

    def once():
        done = subprocess.run(command(options, scene, folder, samples), check=True, timeout=500, capture_output=True, text=True)
        passes = json.loads(done.stdout)["passes"]
        frames.append(sum(row["ms"] for row in passes if row["name"] not in NOT_FRAME) / 1000)

    return timed(options.runs, once, resource.RUSAGE_CHILDREN) | {"frame_s": frames}


def command(options, scene: str, folder: Path, samples: int) -> list[str]:
    camera = json.loads((folder / "camera.json").read_text())
    view = [f"--{flag}={','.join(map(repr, camera[name]))}" for flag, name in (("eye", "eye"), ("look-at", "target"))]
    flags = [*LOOKS[scene], *view, "--fov", repr(camera["yfov_degrees"]), "--size", f"{SIZE}x{SIZE}", "--supersample", str(max(samples, 4))]
    if scene == "environment":
        flags += ["--env", str(folder / "environment.exr")]
    if scene == "displaced":
        flags += ["--height", str(folder / "height.png"), "--scale", str(SCALE), "--midlevel", str(MIDLEVEL)]
        places = [",".join(map(repr, camera[name])) for name in ("eye", "target")]
        flags += ["--tolerance-px", "1", "--view", ";".join([*places, repr(camera["yfov_degrees"]), f"{SIZE}x{SIZE}"])]
    flags += ["--device", options.device] if options.device else []
    return [str(options.displace), "render", str(folder / "scene.glb"), *flags, "--fresh", "--json", "-o", str(folder / "displace.exr")]


def flip(options, one: Path, other: Path) -> float:
    """Mean FLIP by our own `compare`."""
    done = subprocess.run([str(options.displace), "compare", str(one), str(other), "--json"], check=True, capture_output=True, text=True)
    return json.loads(done.stdout)["flip_mean"]


def errors(options, scene: str, folder: Path, count: int, renderers: dict) -> dict[str, float]:
    """Mean FLIP of the images that lie there to converged ones, which replace them."""
    found = {}
    for name, render in renderers.items():
        image, kept = folder / f"{name}.exr", folder / f"{name}.few.exr"
        shutil.copy(image, kept)
        render(options, scene, folder, count)
        found[name] = flip(options, image, kept)
    return found


def timed(runs: int, once, whose: int) -> Seconds:
    wall, cpu = [], []
    for _ in range(runs):
        start, busy = time.perf_counter(), processor_seconds(whose)
        once()
        wall.append(time.perf_counter() - start)
        cpu.append(processor_seconds(whose) - busy)
    return {"wall_s": wall, "cpu_s": cpu}


def processor_seconds(whose: int) -> float:
    usage = resource.getrusage(whose)
    return usage.ru_utime + usage.ru_stime


def median(seconds: list[float]) -> float:
    return statistics.median(seconds[1:] or seconds)


def cell(seconds: Seconds | None) -> str:
    if seconds is None:
        return "-"
    return f"{seconds['wall_s'][0]:.2f}, {median(seconds['wall_s']):.2f} ({median(seconds['cpu_s']):.2f})"


def ratio(theirs: Seconds | None, ours: Seconds | None) -> str:
    return f"{median(theirs['wall_s']) / median(ours['wall_s']):.2f}" if theirs and ours else "-"


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--displace", type=Path, help="the displace binary; without it the peers alone")
    parser.add_argument("--bpy", help="a Python that has bpy; without it no Cycles")
    parser.add_argument("--device", help="of displace")
    parser.add_argument("--runs", type=int, default=4, help="of each")
    parser.add_argument("--flip", action="store_true", help="measure errors, too: a converged image of each takes minutes")
    parser.add_argument("--scenes", nargs="+", choices=list(LOOKS), default=list(LOOKS))
    parser.add_argument("--out", type=Path, help="keeps the files here (default: a temporary folder)")
    options = parser.parse_args()
    options.displace = options.displace and options.displace.resolve()
    # For every child too.
    os.sched_setaffinity(0, sorted(os.sched_getaffinity(0))[:2])
    with tempfile.TemporaryDirectory() as scratch:
        out = (options.out or Path(scratch)).resolve()
        measure(options, sphere(out / "sphere"), plane(out / "plane"))
    return 0


def measure(options, ball: Path, square: Path) -> None:
    head = ["scene", "samples", "ours s", "frame s", "Cycles s", "Mitsuba s", "Cycles / ours", "Mitsuba / frame", "FLIP"]
    print(f"| {' | '.join(head)} |\n|{'---|' * len(head)}")
    for scene, folder, counts in (("matte", ball, (4, 16)), ("environment", ball, (4, 16)), ("displaced", square, (1, 16))):
        if scene not in options.scenes:
            continue
        renderers = {"displace": by_displace} if options.displace else {}
        renderers |= {"cycles": by_cycles} if options.bpy else {}
        renderers |= {"mitsuba": by_mitsuba} if scene != "displaced" else {}
        for samples in counts:
            took = {name: render(options, scene, folder, samples) for name, render in renderers.items()}
            ours, cycles, mitsuba = (took.get(name) for name in ("displace", "cycles", "mitsuba"))
            frame = ours and {"wall_s": ours["frame_s"]}
            cells = [cell(ours), f"{median(ours['frame_s']):.2f}" if ours else "-", cell(cycles), cell(mitsuba)]
            cells += [ratio(cycles, ours), ratio(mitsuba, frame)]
            found = errors(options, scene, folder, CONVERGED, renderers) if options.displace and options.flip else {}
            cells.append(", ".join(f"{name} {value:.4f}" for name, value in found.items()))
            print(f"| {scene} | {samples} | {' | '.join(cells)} |", flush=True)
    print(f"\nwall seconds of the first and of the median of the others (processor seconds); Mitsuba {mi.__version__}")


if __name__ == "__main__":
    raise SystemExit(main())
