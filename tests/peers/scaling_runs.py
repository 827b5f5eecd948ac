"""The runs of `scaling.py`: a fractal terrain, tolerances that give results of a size, and the costs of each."""

import json
import os
import platform
import sys
import tempfile
from pathlib import Path

import numpy as np

import heightfield
from fractal import averaged, fractal
from tessellators import HERE, SCALE, run

# Texels of the map of the first series.
SIDE = 2048
LEAST_SIDE = 512
LEAST_TRIANGLES, PER_DECADE = 1e3, 2
# The least of so many runs counts, unless one takes longer than this.
RUNS, LONG_S = 3, 20
# Of the second series.
TOLERANCE = 0.001
# Of the first result; tolerances are taken to fall as triangles^-0.7 until two are known.
FIRST_TOLERANCE, FIRST_RATE = 0.01, -0.7


def rows(options, scratch: Path):
    heights = fractal(options.most_side)
    by_side = {}
    side = LEAST_SIDE
    while side <= options.most_side:
        by_side[side] = heightfield.write_field(scratch / f"{side}.exr", averaged(heights, side))
        side *= 2
    del heights
    apply = Apply(options, scratch)
    yield from by_triangles(apply, by_side[min(SIDE, options.most_side)], min(SIDE, options.most_side), options.most_triangles)
    for side, file in by_side.items():
        yield apply.row("texels", file, side, TOLERANCE)


def by_triangles(apply: "Apply", file: Path, side: int, most: float):
    tolerance, known = FIRST_TOLERANCE, []
    target = LEAST_TRIANGLES
    while target <= 1.01 * most:
        if known:
            tolerance = next_tolerance(known, target)
        row = apply.row("triangles", file, side, tolerance)
        known.append((np.log(row["triangles"]), np.log(tolerance)))
        target *= 10 ** (1 / PER_DECADE)
        yield row


def next_tolerance(known: list, target: float) -> float:
    """By the line through the last two of (log triangles, log tolerance)."""
    (a, b), rate = known[-1], FIRST_RATE
    if len(known) > 1:
        rate = (b - known[-2][1]) / (a - known[-2][0])
    return float(np.exp(b + rate * (np.log(target) - a)))


class Apply:
    """Runs of one binary on the plane."""

    def __init__(self, options, scratch: Path):
        self.command = [options.displace.resolve(), "apply", heightfield.write_plane(scratch / "plane.glb")]
        self.flags = ["--scale", SCALE, "--wrap", "clamp", "--json", "--fresh", "--quiet", "-o", scratch / "ours.glb"]
        self.flags += ["--device", options.device] if options.device else []

    def row(self, series: str, file: Path, side: int, tolerance: float) -> dict:
        ran = [self.once(file, tolerance)]
        ran += [self.once(file, tolerance) for _ in range(RUNS - 1 if ran[0][1]["cpu_s"] < LONG_S else 0)]
        report, cost = min(ran, key=lambda one: one[1]["cpu_s"])
        return {"series": series, "side": side, "tolerance": f"{tolerance:.4g}", "triangles": report["triangles"],
                "cpu_s": f"{cost['cpu_s']:.2f}", "peak_mib": f"{cost['peak_bytes'] / 2**20:.1f}",
                **stages(report), "device": f"{report['device']} ({processor()})"}

    def once(self, file: Path, tolerance: float) -> tuple[dict, dict]:
        """The report, and {cpu_s, peak_bytes}."""
        command = [*self.command, "--height", file, "--tolerance-world", repr(SCALE * tolerance), *self.flags]
        with tempfile.TemporaryDirectory() as store:
            ran = run([sys.executable, "-S", "-E", HERE / "launch.py", *command], XDG_DATA_HOME=store)
        *report, cost = ran.text.strip().splitlines()
        return json.loads("\n".join(report)), json.loads(cost)


def stages(report: dict) -> dict:
    found = {name: 0.0 for name in ("decode_maps", "refine", "collapse")}
    for done in report["passes"]:
        if done["name"] in found:
            found[done["name"]] += done["ms"]
    found["other"] = report["total_ms"] - sum(found.values())
    return {f"{name}_ms": f"{ms:.1f}" for name, ms in found.items()}


def processor() -> str:
    lines = Path("/proc/cpuinfo").read_text().splitlines() if Path("/proc/cpuinfo").exists() else []
    names = [line.split(":", 1)[1].strip() for line in lines if line.startswith("model name")]
    return f"{names[0] if names else platform.machine()}, {os.cpu_count()} threads"
