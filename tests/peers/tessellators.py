"""Height fields tessellated to a tolerance by `displace apply` and by delatin, martini and meshoptimizer.

Every mesh is judged by `heightfield.deviation` alone. Seconds are of processor (user and system, all threads) and leave
out what a process costs before its work: for Node, all but the call; for `displace`, the same command on a flat map of
3 x 3 texels. What is left of ours still reads the map and writes the GLB; what is left of theirs has the heights in memory.
"""

import copy
import dataclasses
import json
import os
import resource
import subprocess
import tempfile
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import heightfield
from heightfield import Mesh

HERE = Path(__file__).resolve().parent
PEERS = ("delatin", "martini", "meshoptimizer")
OURS = ("texels", "surface")
SCALE = 0.1
TIMEOUT_SECS = 600
# Of the largest height: scale x height, its midlevel and a vertex are each rounded to f32 once.
ROUNDING = 2.0**-22


@dataclass
class Field:
    """`tolerance(e)` is in the field's unit: e of its range."""

    name: str
    file: Path
    heights: np.ndarray

    def tolerance(self, e: float) -> float:
        return e * float(np.ptp(self.heights.astype(np.float64)))

    def rounding(self) -> float:
        return ROUNDING * float(np.abs(self.heights).max())


@dataclass
class Result:
    """`error` and `bound` (what the tool itself promises) are in tolerances; `start_s` is not in `cpu_s`; `rounds` that the
    tool tells of."""

    triangles: int
    error: float
    cpu_s: float
    start_s: float
    bound: float | None = None
    faults: list[str] = dataclasses.field(default_factory=list)
    rounds: int | None = None


class Failed(Exception):
    """A program ended badly; the message is its own."""


@dataclass
class Ran:
    """What a program wrote to standard output, and its `cpu_s`: user and system, all threads."""

    text: str
    cpu_s: float


def run(command: list, **environment: str) -> Ran:
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    words, variables = [str(word) for word in command], os.environ | environment
    try:
        done = subprocess.run(words, capture_output=True, text=True, timeout=TIMEOUT_SECS, env=variables)
    except subprocess.TimeoutExpired as late:
        raise Failed(f"{Path(words[0]).name} runs for more than {TIMEOUT_SECS} s") from late
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode != 0:
        told = (done.stderr.strip() or done.stdout.strip()).splitlines()
        raise Failed(f"{Path(words[0]).name} exits {done.returncode}: {told[0] if told else 'silent'}")
    return Ran(done.stdout, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime)


def peer_mesh(tool: str, field: Field, tolerance: float, out: Path) -> tuple[Mesh, float, float]:
    """A peer's mesh, its processor seconds, and those of the process besides."""
    raw, corners, size = out / "heights.raw", out / "corners.raw", len(field.heights)
    field.heights.tofile(raw)
    ran = run(["node", HERE / "tessellate.mjs", tool, raw, size, repr(tolerance), corners])
    seconds = json.loads(ran.text)["cpu_s"]
    y, x = np.divmod(np.arange(size * size), size)
    vertices = np.stack([x, y, field.heights.reshape(-1)], axis=1).astype(np.float64)
    return Mesh(vertices, np.fromfile(corners, np.uint32).reshape(-1, 3)), seconds, ran.cpu_s - seconds


def by_peer(tool: str, field: Field, tolerance: float, out: Path) -> Result:
    mesh, seconds, start = peer_mesh(tool, field, tolerance, out)
    found = heightfield.deviation(mesh, field.heights)
    return Result(len(mesh.triangles), found.largest / tolerance, seconds, start, faults=found.faults())


class Displace:
    """The binary, the plane it displaces, and the seconds that it needs to start (`start_s`)."""

    def __init__(self, binary: Path, device: str | None, out: Path):
        self.command = [binary.resolve(), "apply", heightfield.write_plane(out / "plane.glb")]
        self.flags = ["--scale", SCALE, "--sampling", "node", "--json", "--fresh", "--quiet"]
        self.flags += ["--device", device] if device else []
        self.out, self.starts, self.environment = out, {}, {}

    def on_one_thread(self) -> "Displace":
        alone = copy.copy(self)
        alone.starts, alone.environment = {}, {"RAYON_NUM_THREADS": "1"}
        return alone

    def run(self, file: Path, tolerance: float, error_at: str) -> tuple[dict, float]:
        bound = ["--tolerance-world", repr(SCALE * tolerance)]
        # The default is asked for by silence, as a user does.
        bound += ["--error-at", "texels"] if error_at == "texels" else []
        return self.apply(file, bound)

    def apply(self, file: Path, flags: list) -> tuple[dict, float]:
        """The report and processor seconds of `ours.glb`; nothing is stored."""
        with tempfile.TemporaryDirectory() as store:
            ran = run([*self.command, "--height", file, *self.flags, *flags, "-o", self.out / "ours.glb"], XDG_DATA_HOME=store, **self.environment)
        return json.loads(ran.text), ran.cpu_s

    def start_s(self, error_at: str) -> float:
        """The least of four runs on a flat map; the first may still have pipelines to compile."""
        if error_at not in self.starts:
            flat = heightfield.write_field(self.out / "flat.exr", np.zeros((3, 3), np.float32))
            self.starts[error_at] = min(self.run(flat, 1.0, error_at)[1] for _ in range(4))
        return self.starts[error_at]

    def tessellate(self, field: Field, tolerance: float, error_at: str) -> Result:
        start = self.start_s(error_at)
        report, seconds = self.run(field.file, tolerance, error_at)
        mesh = heightfield.read_displaced(self.out / "ours.glb", len(field.heights), SCALE)
        found = heightfield.deviation(mesh, field.heights)
        faults, accuracy = found.faults(), report.get("accuracy") or {}
        # In the unit of the request; the plane's node has no transform.
        bound = accuracy["bound"] / (SCALE * tolerance) if accuracy.get("unit") == "world" else None
        if bound is None:
            faults.append(f"reports no bound in world units: {accuracy}")
        if len(mesh.triangles) != report["triangles"]:
            faults.append(f"reports {report['triangles']} triangles, writes {len(mesh.triangles)}")
        return Result(len(mesh.triangles), found.largest / tolerance, seconds - start, start, bound, faults, report.get("rounds"))
