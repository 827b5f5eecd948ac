"""Measures pairs of meshes with `displace measure` and with the samplers of MeshLab and libigl.

    distance.py --displace BIN --corpus DIR [--out DIR] [--precision 1e-4] [--samples 200000]

A sampled distance is never above the true one, so it must not exceed `hi`; and `lo` may be below it by the
precision asked for at most. Prints a Markdown table with the times; exits 1 when a pair breaks either. Needs
the packages of requirements.txt in the Python that runs it.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import igl
import numpy as np
import pymeshlab
import trimesh

# Corpus meshes against what `apply` makes of them, or against each other.
DISPLACED = [
    ("models/Suzanne/Suzanne.gltf", "0.05*sin(30*x)*cos(20*y)", 1),
    ("models/Avocado/Avocado.gltf", "0.001*sin(900*y)", 2),
    ("models/torus.gltf", "0.1*sin(20*pi*u)", 3),
    ("models/ClearcoatWicker.glb", "0.02*noise(9*x,9*y,9*z)", 2),
    ("models/Fox.glb", "0.5*sin(x)", 2),
    ("models/clothFolds.glb", "0.02*cos(40*x)", 1),
    ("models/CesiumMilkTruck.glb", "0.01*sin(40*z)", 1),
]
BESIDE = [
    ("bake/koala/koala.obj", "bake/koala/koala_low_resolution.obj"),
    ("bake/spot/spot_triangulated_uv.obj", "bake/spot/spot_control_mesh.obj"),
    ("bake/spot/spot.obj", "bake/spot/spot_triangulated_uv.obj"),
]
# Both peers round to f32 somewhere.
ROUNDING = 2e-7


def flattened(source: Path, ply: Path) -> Path:
    """One mesh in world space, as every program here reads it."""
    mesh = trimesh.load(source, force="mesh", process=False)
    mesh = trimesh.Trimesh(mesh.vertices, mesh.faces, process=False)
    ply.write_bytes(trimesh.exchange.ply.export_ply(mesh, encoding="binary", vertex_normal=False))
    return ply


def pairs(displace: Path, corpus: Path, out: Path):
    for n, (model, expression, level) in enumerate(DISPLACED):
        glb = out / f"{n}.glb"
        command = [displace, "apply", corpus / model, "--expr", expression, "--uniform", str(level), "-o", glb, "-q"]
        subprocess.run(command, check=True, capture_output=True)
        yield Path(model).stem, flattened(corpus / model, out / f"{n}a.ply"), flattened(glb, out / f"{n}b.ply")
    for n, (a, b) in enumerate(BESIDE):
        yield Path(b).stem, flattened(corpus / a, out / f"p{n}a.ply"), flattened(corpus / b, out / f"p{n}b.ply")


def ours(displace: Path, a: Path, b: Path, precision: float):
    start = time.perf_counter()
    command = [displace, "measure", a, b, "--precision", str(precision), "--json", "--fresh", "-q"]
    done = subprocess.run(command, check=True, capture_output=True, text=True)
    return json.loads(done.stdout), time.perf_counter() - start


def meshlab(a: Path, b: Path, samples: int):
    start = time.perf_counter()
    meshes = pymeshlab.MeshSet(verbose=False)
    meshes.load_new_mesh(str(a))
    meshes.load_new_mesh(str(b))
    far = pymeshlab.PercentageValue(100)
    found = [
        meshes.get_hausdorff_distance(
            sampledmesh=one, targetmesh=other, samplevert=True, sampleedge=True, sampleface=True,
            samplenum=samples, maxdist=far,
        )["max"]
        for one, other in [(0, 1), (1, 0)]
    ]
    return found, time.perf_counter() - start


def libigl(a: Path, b: Path):
    start = time.perf_counter()
    loaded = [trimesh.load(path, process=False) for path in (a, b)]
    arrays = [(np.asarray(m.vertices, dtype=np.float64), np.asarray(m.faces, dtype=np.int64)) for m in loaded]
    return igl.hausdorff(*arrays[0], *arrays[1]), time.perf_counter() - start


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("--displace", type=Path, required=True)
    parser.add_argument("--corpus", type=Path, required=True)
    parser.add_argument("--out", type=Path)
    parser.add_argument("--precision", type=float, default=1e-4)
    parser.add_argument("--samples", type=int, default=200_000)
    args = parser.parse_args()
    out = args.out or Path(tempfile.mkdtemp())
    out.mkdir(parents=True, exist_ok=True)
    bad = 0
    print("| pair | triangles | lo | hi | MeshLab | libigl | seconds: ours | MeshLab | libigl | |")
    print("|---|---|---|---|---|---|---|---|---|---|")
    for name, a, b in pairs(args.displace, args.corpus, out):
        found, seconds = ours(args.displace, a, b, args.precision)
        hausdorff, diagonal = found["hausdorff"], found["diagonal"]
        (there, back), of_meshlab = meshlab(a, b, args.samples)
        vertices, of_libigl = libigl(a, b)
        slack = ROUNDING * diagonal
        checks = [
            ("a_to_b", there), ("b_to_a", back), (None, max(there, back)), (None, vertices),
        ]
        faults = []
        for way, theirs in checks:
            known = hausdorff[way] if way else hausdorff
            if theirs > known["hi"] + slack or known["lo"] < theirs - args.precision * diagonal - slack:
                faults.append(f"{way or 'both'}: {theirs} against [{known['lo']}, {known['hi']}]")
        if hausdorff["hi"] - hausdorff["lo"] > args.precision * diagonal:
            faults.append("wider than asked")
        bad += bool(faults)
        triangles = f"{found['a']['triangles']} / {found['b']['triangles']}"
        print(
            f"| {name} | {triangles} | {hausdorff['lo'] / diagonal:.4e} | {hausdorff['hi'] / diagonal:.4e} "
            f"| {max(there, back) / diagonal:.4e} | {vertices / diagonal:.4e} "
            f"| {seconds:.2f} | {of_meshlab:.2f} | {of_libigl:.2f} | {'; '.join(faults) or 'ok'} |",
            flush=True,
        )
    print(f"\nshares of the diagonal; precision {args.precision}; {bad} bad")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
