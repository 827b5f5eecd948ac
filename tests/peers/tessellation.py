"""Triangles for a tolerance: `displace apply` beside delatin, martini and meshoptimizer, on the same height fields.

    tessellation.py [--displace BIN] [--corpus DIR] [--fields d14,fbm] [--field FILE ...] [--errors 0.02,0.01]
                    [--device NAME] [--out DIR] [--json]

Input of ours: the unit square of y = 0 as two triangles, normal +Y, u = x, v = z, `--sampling node`, so that texels are
places of the full grid; `--tolerance-world` is e of the field's range. Every mesh, whoever made it, is then read at all
texels in f64 by `heightfield.py`. Prints a Markdown table; exits 1 when a mesh of ours is further from a texel than the
tolerance (but for the rounding of f32), leaves a texel out or turns a triangle over, when its bound does not hold, or when
counts break the bars. Without `--displace` only the others are run. Needs `npm install` in this folder, and the packages of
requirements.txt.
"""

import argparse
import json
import math
import os
import sys
import tempfile
from dataclasses import asdict
from pathlib import Path

import heightfield
from tessellators import OURS, PEERS, Displace, Failed, Field, Result, by_peer

# Triangles of longest-edge refinement and exact collapse, worked out one by one (e = 0.02, 0.01, 0.005, 0.002).
COLLAPSE = {
    "d14": {0.02: 543, 0.01: 1333, 0.005: 3044, 0.002: 8838},
    "fbm": {0.02: 973, 0.01: 2874, 0.005: 8671, 0.002: 33119},
    "waves": {0.02: 240, 0.01: 505, 0.005: 1054, 0.002: 2882},
    "bricks": {0.02: 2118, 0.01: 2122, 0.005: 2126, 0.002: 2528},
}
# What doing it in parallel may cost.
MOST_OF_COLLAPSE = 1.03
# Geometric mean of ours / delatin.
MOST_OF_DELATIN = {("d14", "fbm", "waves"): 0.68, ("bricks",): 0.15}


def fields(options) -> list[Field]:
    named = [(name, options.corpus / "heightfields" / f"{name}_513.exr") for name in options.fields]
    return [Field(name, file, heightfield.read_field(file)) for name, file in named + [(file.stem, file) for file in options.field]]


def row_of(field: Field, e: float, displace: Displace | None, out: Path) -> dict:
    """Every tool once: {field, e, tolerance, rounding (in tolerances), results by tool, ratio, most, faults}."""
    tolerance, results, faults = field.tolerance(e), {}, []
    for tool in OURS if displace else ():
        try:
            results[tool] = displace.tessellate(field, tolerance, tool)
        except Failed as failure:
            faults.append(f"{tool}: {failure}")
    results |= {tool: by_peer(tool, field, tolerance, out) for tool in PEERS}
    of_collapse = COLLAPSE.get(field.name, {}).get(e)
    row = {"field": field.name, "e": e, "tolerance": tolerance, "rounding": field.rounding() / tolerance, "results": results}
    row["ratio"] = results["texels"].triangles / results["delatin"].triangles if "texels" in results else None
    row["most"] = math.floor(of_collapse * MOST_OF_COLLAPSE) if of_collapse else None
    return row | {"faults": faults + faults_of(row)}


def faults_of(row: dict) -> list[str]:
    results, faults = row["results"], []
    for tool in (tool for tool in (*OURS, "delatin") if tool in results):
        found = results[tool]
        faults += [f"{tool}: {fault}" for fault in found.faults]
        if found.error > 1 + row["rounding"]:
            faults.append(f"{tool}: {found.error:.5f} tolerances off")
    bound = results["surface"].bound if "surface" in results else None
    if bound is not None:
        faults += ["surface: the bound is above the tolerance"] if bound > 1 + 1e-6 else []
        faults += ["surface: the bound does not hold"] if results["surface"].error > bound + row["rounding"] else []
    if "texels" in results and row["most"] and results["texels"].triangles > row["most"]:
        faults.append(f"texels: more than {row['most']} triangles")
    return faults


def means(rows: list[dict]) -> list[dict]:
    """The geometric means over the groups that were run whole: {fields, ratio, most}."""
    found = []
    for names, most in MOST_OF_DELATIN.items():
        ratios = [row["ratio"] for row in rows if row["ratio"] and row["e"] in COLLAPSE.get(row["field"], {}) and row["field"] in names]
        if len(ratios) == sum(len(COLLAPSE[name]) for name in names):
            found.append({"fields": names, "ratio": math.exp(sum(map(math.log, ratios)) / len(ratios)), "most": most})
    return found


def cells(result: Result | None, with_bound: bool = False) -> list[str]:
    if result is None:
        return ["-"] * (4 if with_bound else 3)
    bound = ["-" if result.bound is None else f"{result.bound:.4f}"] if with_bound else []
    return [str(result.triangles), *bound, f"{result.error:.4f}", f"{result.cpu_s:.2f}"]


def counts_table(rows) -> list[dict]:
    """Prints each row once it is there; gives them back."""
    peers = "".join(f" {tool} | err | s |" for tool in PEERS)
    print(f"| field | e | ours, texels | err | s | ours, surface | bound | err | s |{peers} ours / delatin | most | verdict |")
    print("|---" * (12 + 3 * len(PEERS)) + "|")
    done = []
    for row in rows:
        results = row["results"]
        line = [row["field"], f"{row['e']:g}", *cells(results.get("texels")), *cells(results.get("surface"), with_bound=True)]
        for tool in PEERS:
            line += cells(results[tool])
        line += [f"{row['ratio']:.3f}" if row["ratio"] else "-", str(row["most"] or "-"), "; ".join(row["faults"]) or "ok"]
        print(f"| {' | '.join(line)} |", flush=True)
        done.append(row)
    print("\nerr: the largest vertical deviation at all texels, and bound: what the report promises, in tolerances; s: processor seconds")
    for mean in means(done):
        print(f"ours / delatin, geometric mean of {', '.join(mean['fields'])}: {mean['ratio']:.3f} (at most {mean['most']})")
    return done


def starts(rows: list[dict]) -> str:
    """The least seconds that each tool needed before its work."""
    tools = [tool for tool in (*OURS, *PEERS) if any(tool in row["results"] for row in rows)]
    least = {tool: min(row["results"][tool].start_s for row in rows if tool in row["results"]) for tool in tools}
    return ", ".join(f"{tool} {seconds:.2f}" for tool, seconds in least.items())


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--displace", type=Path, help="the displace binary; without it only the others are run")
    parser.add_argument("--corpus", type=Path, default=os.environ.get("DISPLACE_CORPUS"), help="default: DISPLACE_CORPUS")
    parser.add_argument("--fields", help=f"of the corpus (default: {','.join(COLLAPSE)}, or none with --field)")
    parser.add_argument("--field", type=Path, action="append", default=[], help="any EXR or PNG of 2^k + 1 texels a side; repeatable")
    parser.add_argument("--errors", default="0.02,0.01,0.005,0.002", help="shares of the field's range")
    parser.add_argument("--device", help="of displace")
    parser.add_argument("--out", type=Path, help="keeps the files of the last run here (default: a temporary folder)")
    parser.add_argument("--json", action="store_true", help="everything measured, instead of a table")
    options = parser.parse_args()
    options.fields = options.fields.split(",") if options.fields else [] if options.field else list(COLLAPSE)
    options.errors = [float(e) for e in options.errors.split(",")]
    if options.corpus is None and options.fields:
        parser.error("the fields are in the corpus: give --corpus or set DISPLACE_CORPUS")
    options.corpus = options.corpus and Path(options.corpus)
    return options


def main() -> int:
    options = arguments()
    with tempfile.TemporaryDirectory() as scratch:
        options.out = (options.out or Path(scratch)).resolve()
        options.out.mkdir(parents=True, exist_ok=True)
        return check(options)


def check(options) -> int:
    displace = Displace(options.displace, options.device, options.out) if options.displace else None
    rows = (row_of(field, e, displace, options.out) for field in fields(options) for e in options.errors)
    if options.json:
        rows = list(rows)
        plain = [row | {"results": {tool: asdict(result) for tool, result in row["results"].items()}} for row in rows]
        print(json.dumps({"rows": plain, "means": means(rows)}, indent=2))
    else:
        rows = counts_table(rows)
        print(f"left out of the seconds, to start: {starts(rows)}")
    bad = any(row["faults"] for row in rows) or any(mean["ratio"] > mean["most"] for mean in means(rows))
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
