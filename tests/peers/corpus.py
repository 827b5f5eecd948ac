"""Drives the command line over the corpus and reads every result with other people's programs.

    corpus.py --displace BIN --corpus DIR --height MAP [--out DIR] [--only TEXT]

Each model the corpus accepts goes through `apply --expr`, `apply --height` where it has UVs, and
`render`. The first is done again with `--compress quantize` and `--compress meshopt`; the second, of
small models, within a tolerance with levels of detail and normal maps, refused where places share texels. Each GLB that comes
out must pass gltf-validator with no error and load in three.js and trimesh with the same number of
triangles; compressed, in three.js in the same box. trimesh reads no meshopt, and shows lower levels too. Each model the corpus rejects must be refused with exit code 2 and a
sentence. Prints a Markdown table; exits 1 when a row is bad. Needs `npm ci` in this folder, and the
packages of requirements.txt in the Python that runs it.
"""

import argparse
import json
import math
import struct
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass, field
from pathlib import Path

HERE = Path(__file__).resolve().parent
TIMEOUT_SECS = 120
EXPRESSION = "0.5*sin(20*pi*x)"
COMPRESSED = ("quantize", "meshopt")
# The device that needs no start: neither how a file is packed nor what else is in it is its business.
LEVELS = ["--scale", "0.01", "--tolerance", "0.01", "--lods", "3", "--normals", "map", "--normal-map-size", "64", "--device", "reference"]
# A tolerance takes minutes on larger ones.
MOST_CORNERS = 9000
NOT_FOR_TRIMESH = ("meshopt", "lods")
# Of the diagonal, what 16 bits may move the sides of a box and more.
BOX_TOLERANCE = 1e-4


@dataclass
class Row:
    model: str
    expect: str
    exits: dict[str, int | str] = field(default_factory=dict)
    notes: list[str] = field(default_factory=list)
    glbs: list[Path] = field(default_factory=list)
    errors: int | str = "-"
    three: int | str = "-"
    trimesh: int | str = "-"


def models(corpus: Path):
    """Every glTF file of the index with what must become of it."""
    for entry in json.loads((corpus / "corpus.json").read_text())["entries"]:
        if entry["kind"] in ("model", "invalid"):
            for main in entry.get("mains", [entry["main"]]):
                own = entry.get("expect_by_main", {})
                # The index names the files of an entry by the end of their stems.
                stem = main.rsplit(".", 1)[0]
                yield main, next((own[name] for name in own if stem.endswith(name)), entry["expect"])


def document(path: Path) -> dict:
    """The JSON of a .gltf or .glb that is known to be sound."""
    data = path.read_bytes()
    if data[:4] == b"glTF":
        data = data[20 : 20 + struct.unpack_from("<I", data, 12)[0]]
    return json.loads(data)


def triangle_primitives(gltf: dict) -> list[dict]:
    return [p for mesh in gltf.get("meshes", []) for p in mesh["primitives"] if p.get("mode", 4) >= 4]


def run(row: Row, name: str, command: list[str]) -> subprocess.CompletedProcess | None:
    try:
        done = subprocess.run(command, capture_output=True, text=True, errors="replace", timeout=TIMEOUT_SECS)
    except subprocess.TimeoutExpired:
        row.exits[name] = "hang"
        row.notes.append(f"{name}: no end after {TIMEOUT_SECS} s")
        return None
    row.exits[name] = done.returncode
    if "panicked at" in done.stderr:
        row.notes.append(f"{name}: panic")
    return done


def last_line(done: subprocess.CompletedProcess) -> str:
    lines = [line for line in done.stderr.splitlines() if line.strip()]
    return lines[-1].strip() if lines else ""


def expect_success(row: Row, name: str, command: list[str], glb: Path | None = None) -> None:
    done = run(row, name, command)
    if done is None:
        return
    if done.returncode != 0:
        row.notes.append(f"{name}: {last_line(done)}")
    elif glb:
        row.glbs.append(glb)


def expect_either(row: Row, name: str, command: list[str], glb: Path, naming: str) -> None:
    done = run(row, name, command)
    if done is not None and done.returncode == 0:
        row.glbs.append(glb)
    elif done is not None and (done.returncode != 2 or naming not in done.stderr):
        row.notes.append(f"{name}: exit {done.returncode}: {last_line(done)}")


def expect_refusal(row: Row, name: str, command: list[str], naming: str = "") -> None:
    done = run(row, name, command)
    if done is None:
        return
    if done.returncode != 2:
        row.notes.append(f"{name}: exit {done.returncode}, not 2")
    elif naming not in done.stderr or not last_line(done):
        row.notes.append(f"{name}: the message does not name {naming or 'a fault'}: {last_line(done)}")
    elif not naming:
        print(f"refused {row.model}: {last_line(done)}", file=sys.stderr)


def check_model(options, row: Row, path: Path, stem: str) -> None:
    displace, out = str(options.displace), options.out
    detail = ["--expr", EXPRESSION, "--uniform", "2"]
    expr = [displace, "apply", str(path), *detail, "-o", str(out / f"{stem}.expr.glb")]
    if row.expect == "reject":
        expect_refusal(row, "expr", expr)
        return
    if row.expect == "accept-or-reject-cleanly":
        done = run(row, "expr", expr)
        if done is not None and done.returncode == 0:
            row.glbs.append(out / f"{stem}.expr.glb")
        elif done is not None and (done.returncode != 2 or not last_line(done)):
            row.notes.append(f"expr: neither accepted nor refused cleanly: exit {done.returncode} {last_line(done)}")
        return
    expect_success(row, "expr", expr, out / f"{stem}.expr.glb")
    for kind in COMPRESSED:
        packed = out / f"{stem}.{kind}.glb"
        expect_success(row, kind, [*expr[:-1], str(packed), "--compress", kind, "--device", "reference"], packed)
    gltf = document(path)
    primitives, accessors = triangle_primitives(gltf), gltf.get("accessors", [])
    with_uv = [p for p in primitives if "TEXCOORD_0" in p["attributes"]]
    by_map = [displace, "apply", str(path), "--height", str(options.height)]
    height = [*by_map, "--scale", "0.1", "--uniform", "2", "-o", str(out / f"{stem}.height.glb")]
    if primitives and len(with_uv) == len(primitives):
        expect_success(row, "height", height, out / f"{stem}.height.glb")
        if sum(accessors[p.get("indices", p["attributes"]["POSITION"])]["count"] for p in primitives) <= MOST_CORNERS:
            lods = out / f"{stem}.lods.glb"
            expect_either(row, "lods", [*by_map, *LEVELS, "-o", str(lods)], lods, "geometry.normals")
    elif primitives:
        expect_refusal(row, "height", height, "TEXCOORD_0")
    expect_success(row, "render", [displace, "render", str(path), *detail, "--size", "160x120", "-o", str(out / f"{stem}.png")])


def read_back(command: list[str], files: list[Path]) -> dict[str, dict]:
    if not files:
        return {}
    done = subprocess.run([*command, *map(str, files)], stdout=subprocess.PIPE, text=True, cwd=HERE, check=True)
    return {line["file"]: line for line in map(json.loads, done.stdout.splitlines())}


def check_results(rows: list[Row]) -> None:
    files = [glb for row in rows for glb in row.glbs]
    # A sound file may hold no mesh at all; trimesh loads meshes only.
    with_meshes = [glb for glb in files if document(glb).get("meshes") and kind_of(glb) not in NOT_FOR_TRIMESH]
    validator = read_back(["node", "validate.mjs"], files)
    three = read_back(["node", "load_three.mjs"], files)
    trimesh = read_back([sys.executable, "load_trimesh.py"], with_meshes)
    for row in rows:
        for glb in row.glbs:
            plain = three[str(glb.with_suffix("").with_suffix(".expr.glb"))] if kind_of(glb) in COMPRESSED else None
            # What trimesh does not read, three.js alone counts.
            counted = trimesh.get(str(glb), three[str(glb)] if kind_of(glb) in NOT_FOR_TRIMESH else {"triangles": 0})
            judge(row, glb, validator[str(glb)], three[str(glb)], counted)
            if plain and "box" in plain:
                judge_box(row, kind_of(glb), plain["box"], three[str(glb)].get("box"))


def kind_of(glb: Path) -> str:
    return glb.suffixes[-2].lstrip(".")


def judge_box(row: Row, kind: str, expected: list, found: list | None) -> None:
    allowed = BOX_TOLERANCE * math.dist(*expected)
    if not found or any(abs(a - b) > allowed for p, q in zip(expected, found) for a, b in zip(p, q)):
        row.notes.append(f"{kind}: three's box is {found}, not {expected}")


def judge(row: Row, glb: Path, validator: dict, three: dict, trimesh: dict) -> None:
    kind = kind_of(glb)
    row.errors = validator["errors"] + (row.errors if isinstance(row.errors, int) else 0)
    if validator["errors"]:
        row.notes.append(f"{kind}: {validator['first']}")
    row.three, row.trimesh = three.get("triangles", "error"), trimesh.get("triangles", "error")
    for name, result in (("three", three), ("trimesh", trimesh)):
        if "error" in result:
            row.notes.append(f"{kind}: {name}: {result['error']}")
    if row.three != row.trimesh:
        row.notes.append(f"{kind}: three counts {row.three} triangles, trimesh {row.trimesh}")


def print_table(rows: list[Row]) -> None:
    print("| model | expect | exit (expr, quantize, meshopt, height, lods, render) | validator errors | three.js triangles | trimesh triangles | verdict |")
    print("|---|---|---|---|---|---|---|")
    for row in rows:
        exits = ", ".join(str(row.exits.get(name, "-")) for name in ("expr", *COMPRESSED, "height", "lods", "render"))
        verdict = "; ".join(row.notes).replace("|", "\\|") or "ok"
        print(f"| {row.model} | {row.expect} | {exits} | {row.errors} | {row.three} | {row.trimesh} | {verdict} |")


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--displace", type=Path, required=True, help="the displace binary")
    parser.add_argument("--corpus", type=Path, required=True)
    parser.add_argument("--height", type=Path, required=True, help="a height map for models with UVs")
    parser.add_argument("--out", type=Path, help="keeps the results here (default: a temporary folder)")
    parser.add_argument("--only", default="", help="only models whose path contains this")
    options = parser.parse_args()
    # Absolute, since the readers run in this script's folder.
    options.displace, options.height = options.displace.resolve(), options.height.resolve()
    with tempfile.TemporaryDirectory() as scratch:
        options.out = (options.out or Path(scratch)).resolve()
        options.out.mkdir(parents=True, exist_ok=True)
        return check_corpus(options)


def check_corpus(options) -> int:
    start, rows = time.monotonic(), []
    for main_file, expect in models(options.corpus):
        if options.only in main_file:
            row = Row(main_file, expect)
            check_model(options, row, options.corpus / main_file, main_file.replace("/", "_").rsplit(".", 1)[0])
            rows.append(row)
    check_results(rows)
    print_table(rows)
    bad = sum(bool(row.notes) for row in rows)
    print(f"\n{len(rows)} files, {bad} bad, {time.monotonic() - start:.0f} s")
    return 1 if bad or not rows else 0


if __name__ == "__main__":
    sys.exit(main())
