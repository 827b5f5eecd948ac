"""Seconds of an image beside Cycles and Mitsuba, in one run, on two processors.

    shading_speed.py [--displace BIN] [--bpy PYTHON] [--device NAME] [--runs N] [--out DIR]

At 1024 x 1024:

- matte: a sphere with a base colour and a normal map under a sun, 4 and 16 samples a pixel;
- environment: the sphere of `shading_scenes.py` under its environment, all its maps, 4 and 16 samples;
- displaced: a plane and a height map of 512 texels a side, to triangles of a pixel, 1 and 16 samples; Cycles dices it
  to 2.1 million.

Peers: seconds of a render of the loaded scene, the first one (which compiles, for Mitsuba) and the median of the others.
Ours: of the whole program, start, reading and writing included, the first and the median of the others, computed afresh each
time, and never with fewer than 4 samples. Wall seconds, and processor seconds of the median after them: other work on the machine changes these less. Prints a
Markdown table with ratios of wall seconds, theirs / ours; exits 0. Without --displace the peers alone.
"""

import argparse
import json
import os
import resource
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
    command = [str(options.displace), "render", str(folder / "scene.glb"), *flags, "--fresh", "--quiet", "-o", str(folder / "ours.exr")]
    return timed(options.runs, lambda: subprocess.run(command, check=True, timeout=500), resource.RUSAGE_CHILDREN)


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
    print("| scene | samples | ours s | Cycles s | Mitsuba s | Cycles / ours | Mitsuba / ours |\n|---|---|---|---|---|---|---|")
    for scene, folder, counts in (("matte", ball, (4, 16)), ("environment", ball, (4, 16)), ("displaced", square, (1, 16))):
        for samples in counts:
            ours = by_displace(options, scene, folder, samples) if options.displace else None
            cycles = by_cycles(options, scene, folder, samples) if options.bpy else None
            mitsuba = by_mitsuba(options, scene, folder, samples) if scene != "displaced" else None
            cells = [cell(ours), cell(cycles), cell(mitsuba), ratio(cycles, ours), ratio(mitsuba, ours)]
            print(f"| {scene} | {samples} | {' | '.join(cells)} |", flush=True)
    print(f"\nwall seconds of the first and of the median of the others (processor seconds); Mitsuba {mi.__version__}")


if __name__ == "__main__":
    raise SystemExit(main())
