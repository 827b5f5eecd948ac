"""Tangents beside Blender's: MikkTSpace (Mikkelsen 2008) by two programs on the same corners.

    tangents.py --displace BIN --corpus DIR --bpy PYTHON [--device NAME] [--out DIR]

From each model its tangents are taken away and a normal map is put on each material, so that `displace apply --method flat
--uniform 0` makes tangents. Its GLB is read corner by corner, and Blender's `calc_tangents` (PYTHON is one that has `bpy`) is
asked for the same positions, normals, texture coordinates and triangles, bit for bit: normals are set as they are, not packed
in 16 bits, and v stays as glTF has it, downwards, so that Blender's handedness is the opposite one.

Compared are corners of triangles whose texture coordinates span an area (`LEAST_AREA` of the square of their largest side);
on the others MikkTSpace borrows from neighbours, and where these differ either is right. Prints a Markdown table of degrees;
exits 1 where a compared corner's handedness differs, or a tangent by more than `MOST_DEGREES`, or one in a hundred by more than
`MOST_P99_DEGREES`. That much is Blender's own: it weighs the triangles of a fan by an approximate arc cosine, and lies up to
1e-2 degrees beside the same sums in f64.
"""

import argparse
import copy
import os
import subprocess
import sys
import tempfile
from pathlib import Path

import numpy as np

from gltf import Gltf, Part, save

MOST_P99_DEGREES, MOST_DEGREES = 1e-3, 1e-2
LEAST_AREA = 1e-6
HEAD = ["model", "corners", "of them mirrored", "median °", "p99 °", "largest °", "other handedness", "without area"]
HEAD += ["of them apart", "verdict"]
MODELS = [
    "models/Avocado/Avocado.gltf", "models/BoxTextured.glb", "models/CesiumMilkTruck.glb", "models/ClearcoatWicker.glb",
    "models/MultiUVTest.glb", "models/NegativeScaleTest.glb", "models/NormalTangentTest.glb", "models/Suzanne/Suzanne.gltf",
    "models/TwoSidedPlane/TwoSidedPlane.gltf", "models/VertexColorTest.glb", "models/clothFolds.glb",
    "models/craft_speederD/craft_speederD.gltf", "models/torus.gltf", "maps/LeePerrySmith_head/LeePerrySmith.glb",
]  # fmt: skip
# A PNG of one texel, straight up.
PIXEL = bytes.fromhex(
    "89504e470d0a1a0a0000000d4948445200000001000000010802000000907753de0000000c49444154789c636868f80f"
    "000383020000a5fb890000000049454e44ae426082"
)


def without_tangents(source: Path, path: Path) -> None:
    """The model with a normal map for each of its triangles that has texture coordinates."""
    model = Gltf(source)
    document, blob = copy.deepcopy(model.json), model.blob
    start = len(blob)
    blob += PIXEL + b"\0" * (-len(PIXEL) % 4)
    document["bufferViews"].append({"buffer": 0, "byteOffset": start, "byteLength": len(PIXEL)})
    document["images"] = [{"bufferView": len(document["bufferViews"]) - 1, "mimeType": "image/png"}]
    document["textures"], document["buffers"] = [{"source": 0}], [{"byteLength": len(blob)}]
    document["materials"] = [{"normalTexture": {"index": 0}}]
    for key in ("animations", "skins", "samplers", "extensionsUsed", "extensionsRequired", "extensions"):
        document.pop(key, None)
    for primitive in (p for mesh in document["meshes"] for p in mesh["primitives"]):
        primitive["attributes"].pop("TANGENT", None)
        primitive.pop("extensions", None)
        primitive.pop("material", None)
        if "TEXCOORD_0" in primitive["attributes"]:
            primitive["material"] = 0
    for node in document["nodes"]:
        node.pop("skin", None)
    save(path, document, blob)


def by_displace(options, source: Path) -> list[Part]:
    bare, made = options.out / "bare.glb", options.out / f"{source.stem}.glb"
    without_tangents(source, bare)
    command = [str(options.displace), "apply", str(bare), "--method", "flat", "--uniform", "0", "--quiet", "-o", str(made)]
    subprocess.run(command + (["--device", options.device] if options.device else []), check=True, timeout=300)
    seen, parts = set(), []
    for part in Gltf(made).parts():
        key = part.positions.tobytes(), part.triangles.tobytes()
        if part.uvs is not None and key not in seen:
            seen.add(key)
            parts.append(part)
    assert all(part.tangents is not None for part in parts), f"{source.stem}: no tangents"
    return parts


def by_blender(options, part: Part) -> np.ndarray:
    """(T, 3, 4), its handedness in glTF's sense."""
    mesh, made = options.out / "corners.npz", options.out / "tangents.npy"
    np.savez(mesh, positions=part.positions, normals=part.normals, uvs=part.uvs, triangles=part.triangles)
    script = Path(__file__).with_name("tangents_blender.py")
    subprocess.run([options.bpy, str(script), str(mesh), str(made)], check=True, timeout=300, stdout=subprocess.DEVNULL)
    tangents = np.load(made).reshape(-1, 3, 4)
    tangents[..., 3] *= -1
    return tangents


def spans_area(part: Part) -> np.ndarray:
    """Whether a triangle's texture coordinates do, and its corners."""

    def share(corners):
        a, b = corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]
        a, b = (np.pad(side, ((0, 0), (0, 3 - side.shape[1]))) for side in (a, b))
        longest = np.maximum((a**2).sum(1), np.maximum((b**2).sum(1), ((a - b) ** 2).sum(1)))
        return np.linalg.norm(np.cross(a, b), axis=1) / np.maximum(longest, np.finfo(float).tiny)

    return np.minimum(*(share(of[part.triangles].astype(np.float64)) for of in (part.uvs, part.positions))) > LEAST_AREA


def compare(parts: list[Part], theirs: list[np.ndarray]) -> dict:
    ours = np.concatenate([part.tangents[part.triangles] for part in parts]).astype(np.float64)
    theirs = np.concatenate(theirs).astype(np.float64)
    spans = np.concatenate([spans_area(part) for part in parts])
    a, b = ours[..., :3], theirs[..., :3]
    # Of small angles the arc cosine keeps half of the digits.
    degrees = np.degrees(np.arctan2(np.linalg.norm(np.cross(a, b), axis=-1), (a * b).sum(-1)))
    turned = ours[..., 3] != theirs[..., 3]
    told = degrees[spans].ravel()
    return {
        "corners": told.size,
        "mirrored": int((ours[spans][..., 3] < 0).sum()),
        "p50": float(np.median(told)),
        "p99": float(np.percentile(told, 99)),
        "max": float(told.max()),
        "handedness": int(turned[spans].sum()),
        "left_out": int((~spans).sum() * 3),
        "left_out_apart": int((turned | (degrees > MOST_P99_DEGREES))[~spans].sum()),
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--displace", type=Path, required=True, help="the displace binary")
    parser.add_argument("--corpus", type=Path, default=os.environ.get("DISPLACE_CORPUS"), help="default: DISPLACE_CORPUS")
    parser.add_argument("--bpy", default=sys.executable, help="a Python that has bpy (default: this one)")
    parser.add_argument("--device", help="of displace")
    parser.add_argument("--out", type=Path, help="keeps the files here (default: a temporary folder)")
    options = parser.parse_args()
    if options.corpus is None:
        parser.error("the models are in the corpus: give --corpus or set DISPLACE_CORPUS")
    options.displace, options.corpus = options.displace.resolve(), Path(options.corpus)
    with tempfile.TemporaryDirectory() as scratch:
        options.out = (options.out or Path(scratch)).resolve()
        options.out.mkdir(parents=True, exist_ok=True)
        return check(options)


def check(options) -> int:
    bad = 0
    print(f"| {' | '.join(HEAD)} |\n{'|---' * len(HEAD)}|")
    for model in MODELS:
        source = options.corpus / model
        parts = by_displace(options, source)
        row = compare(parts, [by_blender(options, part) for part in parts])
        good = row["max"] <= MOST_DEGREES and row["p99"] <= MOST_P99_DEGREES and row["handedness"] == 0
        bad += not good
        degrees = [f"{row[key]:.1e}" for key in ("p50", "p99", "max")]
        cells = [row["corners"], row["mirrored"], *degrees, row["handedness"], row["left_out"], row["left_out_apart"]]
        print(f"| {source.stem} | {' | '.join(map(str, cells))} | {'ok' if good else 'differs'} |", flush=True)
    print(f"\n{len(MODELS)} models, {bad} bad")
    return 1 if bad else 0


if __name__ == "__main__":
    sys.exit(main())
