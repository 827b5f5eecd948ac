"""Compares two images as `displace compare` does with other people's programs: FLIP's own and scikit-image.

    metrics.py --displace BIN --corpus DIR [--out DIR]

Renders models of the corpus, makes of each pictures that differ from it (noise, blur, shift, gain, fewer levels, another
light, another level of detail), and compares them by `displace compare --json`. FLIP must agree with flip-evaluator at 67
pixels per degree, SSIM and RMSE with scikit-image and NumPy. Prints a Markdown table of twenty pairs; exits 1 when a figure
differs by more than 0.001. Needs the packages of requirements.txt in the Python that runs it.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import flip_evaluator
import numpy as np
from PIL import Image, ImageFilter
from skimage.metrics import structural_similarity

MOST = 1e-3
SIZE = "320x240"
FIGURES = ("flip_mean", "flip_p99", "rmse_linear", "ssim")
MODELS = ("models/Avocado/Avocado.gltf", "models/CesiumMilkTruck.glb", "models/Fox.glb", "models/torus.gltf")


def noise(image: Image.Image) -> Image.Image:
    grain = np.random.default_rng(7).normal(0, 12, (image.height, image.width, 3))
    return Image.fromarray(np.clip(np.asarray(image) + grain, 0, 255).astype(np.uint8))


# What is made of a render: by this script, or by other flags of the render.
CHANGES = {
    "noise": noise,
    "blur": lambda image: image.filter(ImageFilter.GaussianBlur(1.5)),
    "shift": lambda image: Image.fromarray(np.roll(np.asarray(image), 2, axis=1)),
    "darker, 8 levels": lambda image: image.point(lambda v: v * 4 // 5 // 32 * 32),
    "light": ["--light", "-1,1,0.5"],
}


def run(command: list[str]) -> str:
    done = subprocess.run(command, capture_output=True, text=True, timeout=120)
    if done.returncode != 0:
        sys.exit(f"{' '.join(command)}\n{done.stderr}")
    return done.stdout


def render(options, model: str, output: Path, flags: list[str]) -> Path:
    command = [str(options.displace), "render", str(options.corpus / model), "--size", SIZE, "--orbit", "30,20"]
    run([*command, *flags, "-o", str(output)])
    return output


def pairs(options):
    """(name, reference, other) for every model and change."""
    for model in MODELS:
        stem = Path(model).stem
        reference = render(options, model, options.out / f"{stem}.png", [])
        for number, (name, change) in enumerate(CHANGES.items()):
            other = options.out / f"{stem}.{number}.png"
            if callable(change):
                change(Image.open(reference).convert("RGB")).save(other)
            else:
                render(options, model, other, change)
            yield f"{stem}, {name}", reference, other


def encoded(path: Path) -> np.ndarray:
    """sRGB-encoded values of 0 to 1."""
    return np.asarray(Image.open(path).convert("RGB"), np.float32) / np.float32(255)


def linear(values: np.ndarray) -> np.ndarray:
    values = values.astype(np.float64)
    return np.where(values <= 0.04045, values / 12.92, ((values + 0.055) / 1.055) ** 2.4)


def expected(a: Path, b: Path) -> dict[str, float]:
    a, b = encoded(a), encoded(b)
    errors, _, _ = flip_evaluator.evaluate(a, b, "LDR", applyMagma=False, parameters={"ppd": 67.0})
    grey = [image.astype(np.float64) @ [0.2126, 0.7152, 0.0722] for image in (a, b)]
    similarity = structural_similarity(*grey, gaussian_weights=True, sigma=1.5, use_sample_covariance=False, data_range=1.0)
    return {
        # Its own mean is a sum of floats, which is off by 0.0003 on images of this size already.
        "flip_mean": float(np.mean(errors, dtype=np.float64)),
        "flip_p99": float(np.percentile(errors, 99)),
        "rmse_linear": float(np.sqrt(np.mean((linear(a) - linear(b)) ** 2))),
        "ssim": float(similarity),
    }


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--displace", type=Path, required=True, help="the displace binary")
    parser.add_argument("--corpus", type=Path, required=True)
    parser.add_argument("--out", type=Path, help="keeps the images here (default: a temporary folder)")
    options = parser.parse_args()
    options.displace = options.displace.resolve()
    with tempfile.TemporaryDirectory() as scratch:
        options.out = (options.out or Path(scratch)).resolve()
        options.out.mkdir(parents=True, exist_ok=True)
        return check(options)


def check(options) -> int:
    start, count, bad, largest = time.monotonic(), 0, 0, dict.fromkeys(FIGURES, 0.0)
    print(f"| pair | {' | '.join(f'{name} (peer)' for name in FIGURES)} | verdict |")
    print("|---" * (len(FIGURES) + 2) + "|")
    for name, a, b in pairs(options):
        ours = json.loads(run([str(options.displace), "compare", str(a), str(b), "--json"]))
        peers = expected(a, b)
        off = {figure: abs(ours[figure] - peers[figure]) for figure in FIGURES}
        wrong = [figure for figure in FIGURES if not off[figure] <= MOST]
        count, bad = count + 1, bad + bool(wrong)
        largest = {figure: max(largest[figure], off[figure]) for figure in FIGURES}
        cells = " | ".join(f"{ours[figure]:.6f} ({peers[figure]:.6f})" for figure in FIGURES)
        print(f"| {name} | {cells} | {'differs: ' + ', '.join(wrong) if wrong else 'ok'} |")
    differences = ", ".join(f"{figure} {value:.1e}" for figure, value in largest.items())
    print(f"\n{count} pairs, {bad} bad, {time.monotonic() - start:.0f} s; largest differences: {differences}")
    return 1 if bad or count != len(MODELS) * len(CHANGES) else 0


if __name__ == "__main__":
    sys.exit(main())
