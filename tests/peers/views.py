"""Triangles for a tolerance in pixels: `displace apply --tolerance-px` beside dicing and a view-independent mesh.

    views.py --displace BIN [--corpus DIR] [--fields d14,fbm,dem] [--views over,low] [--pixels 1,0.5,0.25] [--device NAME]
             [--out DIR] [--json]

Input: the plane of `tessellation.py` with two height fields and the middle 257 x 257 texels of an elevation model, seen by
two cameras at 1280 x 720: one looks over all of it, one stands low within it, so that much is near, outside or behind. The
error of every mesh is measured by `screen.py`: the bilinear surface against the triangle over the same base place, both
projected, in f64, at 16 places a texel; what no view sees is allowed 8 times as much, at its distance. Beside ours, by
`dicing.py`, held to what is seen alone:

- uniform: every triangle of the plane into 4^level, the least level within the tolerance;
- edges: edges halved until they are no longer on the screen than a rate, the largest rate that keeps the tolerance, and
  again to the error that ours was measured to have;
- delatin: greedy insertion, the same everywhere, at the least height that any visible place may be off. It holds that at
  texels alone: what is seen between them is measured beside it.

Prints a Markdown table; exits 1 when a mesh of ours is further off than the tolerance or the bound that it reports, leaves
a place out, or has no fewer triangles than each of the others that keep the tolerance.
"""

import argparse
import json
import os
import sys
import tempfile
from dataclasses import asdict
from pathlib import Path

import numpy as np
from PIL import Image

import dicing
import heightfield
from screen import Surface, View
from tessellators import SCALE, Displace, Failed, Field, peer_mesh

VIEWS = {
    "over": View("over", (0.5, 0.25, -0.35), (0.5, 0.03, 0.4)),
    "low": View("low", (0.5, 0.15, 0.2), (0.5, 0.08, 0.8)),
}
DEM, DEM_SIDE = "maps/dem_jacksboro/jacksboro_fault_dem_u16_metres.png", 257
# Of f32 positions.
ROUNDING = 1e-3
HEAD = ["field", "view", "px", "ours", "seen px", "unseen px / 8", "bound", "s", "uniform", "edges", "rate px",
        "edges, to our error", "delatin", "seen px", "uniform / ours", "edges / ours", "delatin / ours", "verdict"]


def field(name: str, options) -> Field:
    """Of the corpus; the elevation model from 0 to 1."""
    if name != "dem":
        file = options.corpus / "heightfields" / f"{name}_513.exr"
        return Field(name, file, heightfield.read_field(file))
    metres = np.asarray(Image.open(options.corpus / DEM)).astype(np.float32)
    top, left = ((side - DEM_SIDE) // 2 for side in metres.shape)
    metres = metres[top : top + DEM_SIDE, left : left + DEM_SIDE]
    heights = np.ascontiguousarray((metres - metres.min()) / np.ptp(metres))
    return Field(name, heightfield.write_field(options.out / "dem.exr", heights), heights)


def rows(options):
    displace = Displace(options.displace, options.device, options.out)
    for one in (field(name, options) for name in options.fields):
        for view in (VIEWS[name] for name in options.views):
            surface = Surface(one.heights, SCALE, view)
            others = dicing.Uniform(surface), dicing.ByEdges(surface)
            for pixels in options.pixels:
                yield row_of(one, surface, others, pixels, displace, options.out)


def row_of(one: Field, surface: Surface, others: tuple, pixels: float, displace: Displace, out: Path) -> dict:
    """One tolerance: ours, the others, what is wrong with ours."""
    row = {"field": one.name, "view": surface.view.name, "px": pixels, "faults": []}
    try:
        row |= ours(one, surface, pixels, displace)
    except Failed as failure:
        row["faults"].append(str(failure))
    tolerance = surface.least_tolerance(pixels)
    uniform, by_edges = others
    row["uniform"] = uniform.to(pixels)
    row["edges"], row["rate_px"] = by_edges.to(pixels) or (None, None)
    row["edges_to_our_error"] = (by_edges.to(row["error"].seen_px) or (None,))[0] if "error" in row else None
    greedy = peer_mesh("delatin", one, tolerance, out)[0]
    row["delatin"], row["delatin_px"] = len(greedy.triangles), surface.error_of_mesh(greedy).seen_px
    return row | {"faults": row["faults"] + faults_of(row)}


def ours(one: Field, surface: Surface, pixels: float, displace: Displace) -> dict:
    report, seconds = displace.apply(one.file, ["--tolerance-px", repr(pixels), "--view", surface.view.flag()])
    mesh = heightfield.read_displaced(displace.out / "ours.glb", len(one.heights), SCALE)
    found = {"ours": len(mesh.triangles), "error": surface.error_of_mesh(mesh), "cpu_s": seconds}
    return found | {"bound": report["accuracy"]["bound"], "device": report["device"]}


def faults_of(row: dict) -> list[str]:
    if "ours" not in row:
        return []
    error, faults = row["error"], []
    if error.largest_px() > row["px"] * (1 + ROUNDING):
        faults.append("above the tolerance")
    if error.largest_px() > row["bound"] * (1 + ROUNDING):
        faults.append("above its bound")
    if error.holes:
        faults.append(f"{error.holes} places uncovered")
    keep = [tool for tool in ("uniform", "edges", "delatin") if row[tool] and (tool != "delatin" or row["delatin_px"] <= row["px"])]
    return faults + [f"no fewer than {tool}" for tool in keep if row["ours"] >= row[tool]]


def line(row: dict) -> list[str]:
    made = row.get("ours")
    error = [f"{row['error'].seen_px:.4f}", f"{row['error'].unseen_px:.4f}", f"{row['bound']:.4f}", f"{row['cpu_s']:.2f}"] if made else ["-"] * 4
    most = f"> {dicing.MOST_TRIANGLES}"
    rate = f"{row['rate_px']:.2f}" if row["rate_px"] else "-"
    others = [str(row["uniform"]), str(row["edges"] or most), rate, str(row["edges_to_our_error"] or most), str(row["delatin"])]
    others.append(f"{row['delatin_px']:.4f}")
    ratios = [f"{row[tool] / made:.2f}" if made and row[tool] else "-" for tool in ("uniform", "edges", "delatin")]
    verdict = "; ".join(row["faults"]) or "ok"
    return [row["field"], row["view"], f"{row['px']:g}", str(made or "-"), *error, *others, *ratios, verdict]


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--displace", type=Path, required=True, help="the displace binary")
    parser.add_argument("--corpus", type=Path, default=os.environ.get("DISPLACE_CORPUS"), help="default: DISPLACE_CORPUS")
    parser.add_argument("--fields", default="d14,fbm,dem", help="height fields of the corpus, and dem")
    parser.add_argument("--views", default=",".join(VIEWS))
    parser.add_argument("--pixels", default="1,0.5,0.25", help="tolerances")
    parser.add_argument("--device", help="of displace")
    parser.add_argument("--out", type=Path, help="keeps the files of the last run here (default: a temporary folder)")
    parser.add_argument("--json", action="store_true", help="everything measured, instead of a table")
    options = parser.parse_args()
    if options.corpus is None:
        parser.error("the fields are in the corpus: give --corpus or set DISPLACE_CORPUS")
    options.corpus, options.fields, options.views = Path(options.corpus), options.fields.split(","), options.views.split(",")
    if unknown := set(options.views) - set(VIEWS):
        parser.error(f"no view is named {', '.join(sorted(unknown))}: choose from {', '.join(VIEWS)}")
    options.pixels = [float(pixels) for pixels in options.pixels.split(",")]
    return options


def main() -> int:
    options = arguments()
    with tempfile.TemporaryDirectory() as scratch:
        options.out = (options.out or Path(scratch)).resolve()
        options.out.mkdir(parents=True, exist_ok=True)
        return check(options)


def check(options) -> int:
    done = []
    if not options.json:
        print(f"| {' | '.join(HEAD)} |\n{'|---' * len(HEAD)}|")
    for row in rows(options):
        done.append(row)
        if not options.json:
            print(f"| {' | '.join(line(row))} |", flush=True)
    if options.json:
        print(json.dumps([row | ({"error": asdict(row["error"])} if "error" in row else {}) for row in done], indent=2))
    else:
        print("\nseen and unseen px: the largest error of ours where the view looks, and elsewhere; bound: of its report; s: processor")
        print(f"seconds of ours; rate px: of edges; measured on {', '.join(sorted({row['device'] for row in done if 'device' in row}))}")
    return 1 if any(row["faults"] for row in done) else 0


if __name__ == "__main__":
    sys.exit(main())
