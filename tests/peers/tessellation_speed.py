"""Processor seconds for a tolerance: `displace apply` beside delatin, martini and meshoptimizer, and beside decimation.

    tessellation_speed.py --displace BIN [--corpus DIR] [--device NAME] [--out DIR] [--runs 3] [--bpy PYTHON]
                          [--no-decimation] [--no-bars]

Input: the four height fields of `tessellation.py` at e = 0.002 of their range, and a fractal of 2049 x 2049 texels. Seconds
are user and system, of all threads, without what each process costs before its work (`tessellators.py`); the least of the
runs counts. Rounds are those of the report. Then one field as a grid of a million triangles, decimated by Blender (with
`--bpy`, a Python that has `bpy`) and MeshLab to as few triangles as keep the same error at its texels, found by bisection;
their seconds are of the last simplification alone, with the grid in memory.

Prints Markdown tables; exits 1 when a mesh of ours breaks the tolerance, and when ours at texels takes more seconds than
delatin over the four fields together or over the fractal, more than three times delatin's over any, or more than 1.3 times
its own on one thread over all; `--no-bars` prints these as missed and exits 0. Needs what `tessellation.py` needs.
"""

import argparse
import json
import os
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

import heightfield
from fractal import fractal
from heightfield import Mesh
from screen import bilinear
from tessellators import HERE, OURS, PEERS, SCALE, Displace, Failed, Field, Result, by_peer, run

FIELDS = ("d14", "fbm", "waves", "bricks")
ERROR, LARGE_SIDE = 0.002, 2049
# Ours / delatin: of the four fields together and of the fractal; of any. And ours / ours on one thread, of all together.
MOST_IN_ALL, MOST_OF_ANY, MOST_OF_ONE_THREAD = 1.0, 3.0, 1.3
# Cells a side of the grid to decimate: 2 * 708^2 = 1002528 triangles.
GRID_OF, GRID_CELLS = "d14", 708
STEPS = 6
LONG_S = 20


def fields(options) -> list[Field]:
    files = {name: options.corpus / "heightfields" / f"{name}_513.exr" for name in FIELDS}
    # Not packed: delatin is handed floats.
    files[f"fractal {LARGE_SIDE}^2"] = heightfield.write_field(options.out / "fractal.tiff", fractal(LARGE_SIDE))
    return [Field(name, file, heightfield.read_field(file)) for name, file in files.items()]


def least(once, runs: int) -> Result:
    """Of some runs; a long one is the only one."""
    results = [once()]
    results += [once() for _ in range(runs - 1 if results[0].cpu_s < LONG_S else 0)]
    return min(results, key=lambda result: result.cpu_s)


def row_of(field: Field, displace: Displace, options) -> dict[str, Result]:
    tolerance = field.tolerance(ERROR)
    row = {tool: least(lambda tool=tool: displace.tessellate(field, tolerance, tool), options.runs) for tool in OURS}
    row["one thread"] = least(lambda: displace.on_one_thread().tessellate(field, tolerance, "texels"), options.runs)
    row |= {tool: least(lambda tool=tool: by_peer(tool, field, tolerance, options.out), options.runs) for tool in PEERS}
    for tool in OURS:
        if row[tool].error > 1 + field.rounding() / tolerance:
            row[tool].faults.append(f"{row[tool].error:.5f} tolerances off")
    return row


def speed_table(rows) -> tuple[bool, dict]:
    """Prints; (whether our meshes are as they should be, all rows by field)."""
    timed = (*OURS, "one thread", *PEERS)
    head = [f"e = {ERROR}", *(f"{tool}, s" for tool in timed), *(f"{tool} / delatin" for tool in OURS)]
    head += ["triangles, texels", "surface", "delatin", "rounds, texels", "surface", "faults"]
    print(f"| {' | '.join(head)} |\n{'|---' * len(head)}|")
    is_right, done = True, {}
    for name, row in rows:
        faults = [f"{tool}: {fault}" for tool in OURS for fault in row[tool].faults]
        line = [name, *(f"{row[tool].cpu_s:.2f}" for tool in timed)]
        line += [f"{row[tool].cpu_s / row['delatin'].cpu_s:.2f}" for tool in OURS]
        line += [str(row[tool].triangles) for tool in (*OURS, "delatin")] + [str(row[tool].rounds) for tool in OURS]
        print(f"| {' | '.join([*line, '; '.join(faults) or 'none'])} |", flush=True)
        is_right, done[name] = is_right and not faults, row
    return is_right, done


def is_within_bars(done: dict) -> bool:
    """Prints each ratio beside its bar."""
    def ratio(names, peer: str) -> float:
        ours, other = (sum(done[name][tool].cpu_s for name in names) for tool in ("texels", peer))
        return ours / other

    large = [name for name in done if name not in FIELDS]
    worst = max(done, key=lambda name: ratio([name], "delatin"))
    found = [
        ("the four fields / delatin", ratio(FIELDS, "delatin"), MOST_IN_ALL),
        (f"{large[0]} / delatin", ratio(large, "delatin"), MOST_IN_ALL),
        (f"{worst}, the largest of any / delatin", ratio([worst], "delatin"), MOST_OF_ANY),
        ("all / all on one thread", ratio(done, "one thread"), MOST_OF_ONE_THREAD),
    ]
    print("\n| ours at texels | ratio | at most | |\n|---|---|---|---|")
    for name, of, most in found:
        print(f"| {name} | {of:.2f} | {most:g} | {'ok' if of <= most else 'missed'} |")
    return all(of <= most for _, of, most in found)


def starts(displace: Displace, options) -> str:
    """Seconds of processes that do next to nothing."""
    commands = {"displace --version": [options.displace.resolve(), "--version"], "node": ["node", "--eval", ""]}
    seconds = {name: min(run(command).cpu_s for _ in range(4)) for name, command in commands.items()}
    seconds |= {f"apply on a flat map, {tool}": displace.start_s(tool) for tool in OURS}
    return "; ".join(f"{name} {of:.3f}" for name, of in seconds.items())


class Decimation:
    """A field as a grid, on the plane, simplified by another program; the field's own texels judge."""

    def __init__(self, field: Field, out: Path):
        self.field, self.out, self.size = field, out, len(field.heights)
        y, x = np.divmod(np.arange((GRID_CELLS + 1) ** 2), GRID_CELLS + 1)
        u, v = x / GRID_CELLS, y / GRID_CELLS
        heights = bilinear(field.heights.astype(np.float64), u * (self.size - 1), v * (self.size - 1))
        np.stack([u, v, SCALE * heights], axis=1).astype(np.float32).tofile(out / "grid.vertices")
        corner = np.flatnonzero((x < GRID_CELLS) & (y < GRID_CELLS))
        right, below = corner + 1, corner + GRID_CELLS + 1
        halves = [np.stack(half, axis=1) for half in ((corner, right, below + 1), (corner, below + 1, below))]
        np.concatenate(halves).astype(np.int32).tofile(out / "grid.triangles")

    def to(self, tool: str, python: str, tolerance: float) -> dict:
        """{triangles, cpu_s, version, error (tolerances)} of the fewest triangles that keep the tolerance, in the field's unit."""
        low, high, best = 1e-3, 1.0, {}
        for _ in range(STEPS):
            share = (low * high) ** 0.5
            made = self.once(tool, python, share) | {"share": share}
            made["error"] /= tolerance
            low, high, best = (low, share, made) if made["error"] <= 1 else (share, high, best)
        return best

    def once(self, tool: str, python: str, share: float) -> dict:
        files = self.out / "grid.vertices", self.out / "grid.triangles"
        told = json.loads(run([python, HERE / "decimate.py", tool, *files, repr(share), self.out / "fewer"]).text.splitlines()[-1])
        x, y, height = np.fromfile(self.out / "fewer.vertices", np.float32).astype(np.float64).reshape(-1, 3).T
        vertices = np.stack([x * (self.size - 1), y * (self.size - 1), height / SCALE], axis=1)
        mesh = Mesh(vertices, np.fromfile(self.out / "fewer.triangles", np.int32).reshape(-1, 3))
        found = heightfield.deviation(mesh, self.field.heights)
        return told | {"error": found.largest, "uncovered": found.uncovered, "folded": found.folded}


def decimation_table(field: Field, row: dict[str, Result], options) -> None:
    decimation, tolerance = Decimation(field, options.out), field.tolerance(ERROR)
    print(f"\n| {field.name}, e = {ERROR} | input | triangles | error | s | texels uncovered |\n|---|---|---|---|---|---|")
    for tool in OURS:
        print(f"| ours, {tool} | the map | {row[tool].triangles} | {row[tool].error:.3f} | {row[tool].cpu_s:.2f} | 0 |")
    for tool, python in (("blender", options.bpy), ("meshlab", sys.executable)):
        made = decimation.to(tool, python, tolerance) if has(tool, python) else None
        if not made:
            print(f"| {tool} | - | - | - | - | {'keeps it with none of the shares tried' if made == {} else 'not installed'} |")
            continue
        cells = [str(made["triangles"]), f"{made['error']:.3f}", f"{made['cpu_s']:.2f}", str(made["uncovered"])]
        print(f"| {made['version']} | a grid of {2 * GRID_CELLS**2} triangles | {' | '.join(cells)} |", flush=True)
    print("\nerror: at texels, in tolerances; s: of decimation the simplification alone, at the share that bisection ends at")


def has(tool: str, python: str) -> bool:
    package = {"blender": "bpy", "meshlab": "pymeshlab"}[tool]
    return shutil.which(python) is not None and subprocess.run([python, "-c", f"import {package}"], capture_output=True).returncode == 0


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--displace", type=Path, required=True, help="the displace binary")
    parser.add_argument("--corpus", type=Path, default=os.environ.get("DISPLACE_CORPUS"), help="default: DISPLACE_CORPUS")
    parser.add_argument("--device", help="of displace")
    parser.add_argument("--out", type=Path, help="keeps the files of the last run here (default: a temporary folder)")
    parser.add_argument("--runs", type=int, default=3, help="of each; the least seconds count")
    parser.add_argument("--bpy", default=sys.executable, help="a Python that has Blender's bpy (default: this one)")
    parser.add_argument("--no-decimation", action="store_true", help="leaves out the second table")
    parser.add_argument("--no-bars", action="store_true", help="exits 0 though ours takes more seconds than it should")
    options = parser.parse_args()
    if options.corpus is None:
        parser.error("the fields are in the corpus: give --corpus or set DISPLACE_CORPUS")
    options.corpus = Path(options.corpus)
    return options


def main() -> int:
    options = arguments()
    with tempfile.TemporaryDirectory() as scratch:
        options.out = (options.out or Path(scratch)).resolve()
        options.out.mkdir(parents=True, exist_ok=True)
        return check(options)


def check(options) -> int:
    displace, inputs = Displace(options.displace, options.device, options.out), fields(options)
    rows = ((field.name, row_of(field, displace, options)) for field in inputs)

    try:
        is_right, done = speed_table(rows)
        is_within = is_within_bars(done)
        print(f"left out of the seconds, to start: {starts(displace, options)}")
        if not options.no_decimation:
            decimation_table(next(field for field in inputs if field.name == GRID_OF), done[GRID_OF], options)
    except Failed as failure:
        print(failure)
        return 1
    return 0 if is_right and (is_within or options.no_bars) else 1


if __name__ == "__main__":
    sys.exit(main())
