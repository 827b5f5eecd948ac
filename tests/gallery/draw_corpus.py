"""Draws the pictures of the gallery that need the corpus: `draw_corpus.py DISPLACE CORPUS [PICTURE|figures ...]`.

As draw.py does with its own scenes; pictures are then reduced to a palette of 256 colours. `figures` prints how far the
heads are apart. Needs numpy and Pillow.
"""

import shlex
import subprocess
import sys
import tempfile
from pathlib import Path

from PIL import Image

HERE = Path(__file__).parent
HEAD = "--size 280x350 --eye 8,2,6.5 --look-at -0.55,1.6,1.3 --fov 23 --ambient 0.12 --shading pbr"
SUN, LOW = "--light 0.25,0.8,0.9", "--light 0.2,1,0.12 --shadows ray"
COARSE, FINE = "--height height-256.png {256} --uniform 2", "--height height-1024.png {1024} --uniform 4"
FLAT = "--shading pbr --size 320x280 --orbit 0,0"
PICTURES = {
    # Rows 38 and 42 to 45, E26.
    "heads/base": f"render plain.glb {HEAD} {SUN}",
    "heads/displacement": f"render plain.glb {COARSE} {HEAD} {SUN}",
    "heads/normal-map": f"render mapped.glb {HEAD} {SUN}",
    "heads/both": f"render plain.glb {COARSE} --normal normal.png {HEAD} {SUN}",
    "heads/both-twice": f"render mapped.glb {COARSE} {HEAD} {SUN}",
    "heads/kept-normals": f"render plain.glb {COARSE} --normal flat.png --exact-zero {HEAD} {SUN}",
    "heads/fine": f"render plain.glb {FINE} {HEAD} {SUN}",
    "heads/shadows-normal-map": f"render mapped.glb {HEAD} {LOW}",
    "heads/shadows-both": f"render plain.glb {COARSE} --normal normal.png {HEAD} {LOW}",
    "heads/shadows-fine": f"render plain.glb {FINE} {HEAD} {LOW}",
    # Khronos' samples that show what is right themselves.
    "conformance/texture-coordinates": f"render models/TextureCoordinateTest.glb {FLAT} --light 0,0,1",
    "conformance/normals-tangents": "render models/NormalTangentTest.glb --shading pbr --size 400x400 --eye 0,-0.13,6 --look-at 0,-0.13,0 --fov 23.5 --light 0.5,0.5,1",
    "conformance/normals-tangents-back": "render models/NormalTangentTest.glb --shading pbr --size 400x400 --eye 0,-0.13,-6 --look-at 0,-0.13,0 --fov 23.5 --light -0.5,0.5,-1",
    "conformance/normals-tangents-mirror": "render models/NormalTangentTest.glb --shading pbr --size 360x200 --eye 0.8,0.4,6 --look-at 0.8,0.4,0 --fov 3.3 --env env/venice_sunset_1k.hdr --supersample 16",
    "conformance/multiple-uvs": "render models/MultiUVTest.glb --shading pbr --size 320x240 --orbit 30,25",
    "conformance/vertex-colors": f"render models/VertexColorTest.glb {FLAT} --light 0,0,1",
    "conformance/negative-scale": f"render models/NegativeScaleTest.glb {FLAT} --light 0.5,0.5,1",
    "conformance/attributes": "render models/AG_Mesh_PrimitiveAttribute/Mesh_PrimitiveAttribute_05.gltf --shading pbr --size 240x240 --orbit 0,0,2.2",
}
# What is judged against what.
FIGURES = [("both", "displacement"), ("both", "normal-map"), ("both", "base"), ("both", "both-twice")]
FIGURES += [("fine", name) for name in ("base", "displacement", "normal-map", "both", "both-twice")]
FIGURES += [("shadows-fine", name) for name in ("shadows-normal-map", "shadows-both")]


def heads(folder: Path, corpus: Path) -> dict[str, str]:
    """The meshes and maps of heads/, and `--scale` and `--midlevel` for heights of each size."""
    source, relief = corpus / "maps/LeePerrySmith_head", {}
    for size in ("256", "1024"):
        command = [sys.executable, HERE / "integrate_height.py", source / "LeePerrySmith.glb", source / "bump-lowRes-normal-generated.png", folder]
        told = subprocess.run([*command, "--flip-v", "--flip-red", "--size", size], check=True, capture_output=True, text=True).stdout
        (folder / "height.png").rename(folder / f"height-{size}.png")
        relief[size] = told.splitlines()[-1]
        print(told, end="")
    Image.new("RGB", (1, 1), (128, 128, 255)).save(folder / "flat.png")
    return relief


def run(displace: Path, command: str, folder: Path, relief: dict[str, str]) -> str:
    for size, flags in relief.items():
        command = command.replace("{" + size + "}", flags)
    done = subprocess.run([displace, *shlex.split(command), "--quiet"], cwd=folder, check=True, capture_output=True, text=True)
    return done.stdout


def draw(displace: Path, name: str, folder: Path, relief: dict[str, str]) -> None:
    out = HERE / f"{name}.png"
    out.parent.mkdir(exist_ok=True)
    run(displace, f"{PICTURES[name]} -o {shlex.quote(str(out))}", folder, relief)
    Image.open(out).convert("RGB").quantize(256, dither=Image.Dither.NONE).save(out, optimize=True)
    print(out)


def figures(displace: Path, folder: Path, relief: dict[str, str]) -> None:
    for name in dict.fromkeys(name for pair in FIGURES for name in pair):
        run(displace, f"{PICTURES['heads/' + name]} --aov depth,position -o {name}.exr", folder, relief)
    for reference, other in FIGURES:
        print(f"{other} against {reference}\n" + run(displace, f"compare {reference}.exr {other}.exr --json", folder, relief))


def main() -> None:
    displace, corpus, names = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve(), sys.argv[3:] or list(PICTURES)
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        for name in ("models", "env"):
            (folder / name).symlink_to(corpus / name)
        relief = heads(folder, corpus) if any(n == "figures" or n.startswith("heads/") for n in names) else {}
        for name in names:
            draw(displace, name, folder, relief) if name in PICTURES else figures(displace, folder, relief)


if __name__ == "__main__":
    main()
