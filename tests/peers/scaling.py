"""What `displace apply` costs as results and maps grow: processor seconds, stages and peak memory.

    scaling.py --displace BIN [--device NAME] [--most-triangles 1e6] [--most-side 8192] [--out DIR]
    scaling.py --redraw

Two series, on a fractal height map, `--tolerance-world` on the plane of `tessellation.py`: results of 10^3 triangles and
more, two a decade, of one map of 2048 x 2048 texels; and maps of 512 x 512 texels and more, which are the same terrain
averaged over squares, at one tolerance. Writes `tests/charts/scaling.csv` and draws `scaling.svg` from it; `--redraw` does
the latter alone and needs the standard library alone. Prints both series, and the exponents b of cost ~ size^b. Exits 1
when an exponent is above its bar: whatever is in linear time and memory, sorting included, stays below it.

CSV: series, side (texels), tolerance (of the range), triangles, cpu_s (user and system of the process), peak_mib (its
largest resident set), wall milliseconds of the stages that the report names, device.
"""

import argparse
import csv
import sys
import tempfile
from pathlib import Path

import chart

CHARTS = Path(__file__).resolve().parent.parent / "charts"
STAGES = ("decode_maps", "refine", "collapse", "other")
COLUMNS = ["series", "side", "tolerance", "triangles", "cpu_s", "peak_mib", *(f"{stage}_ms" for stage in STAGES), "device"]
# Exponents; by texels a result of a fixed size also has costs that do not grow.
MOST = {("triangles", "cpu_s"): 1.15, ("triangles", "peak_mib"): 1.05, ("texels", "cpu_s"): 1.15, ("texels", "peak_mib"): 1.05}
# Below, the start of the process and what it holds anyhow are most of it.
LEAST = {"triangles": 3e4, "texels": 1e6}


def size_of(row: dict) -> float:
    return row["triangles"] if row["series"] == "triangles" else row["side"] ** 2


def points(rows: list[dict], series: str, column: str) -> list[tuple[float, float]]:
    found = [(float(size_of(row)), float(row[column])) for row in rows if row["series"] == series]
    return sorted(point for point in found if point[1] > 0)


def slope(rows: list[dict], series: str, column: str) -> float | None:
    """Over sizes that are not small; none of fewer than three."""
    large = [point for point in points(rows, series, column) if point[0] >= 0.9 * LEAST[series]]
    return chart.slope(large) if len(large) > 2 else None


def read(file: Path) -> list[dict]:
    with file.open(newline="") as lines:
        rows = list(csv.DictReader(lines))
    return [row | {column: float(row[column]) for column in COLUMNS[1:-1]} for row in rows]


def write(file: Path, rows: list[dict]) -> None:
    with file.open("w", newline="") as lines:
        writer = csv.DictWriter(lines, COLUMNS, lineterminator="\n")
        writer.writeheader()
        writer.writerows(rows)


def draw(rows: list[dict], file: Path) -> None:
    curve = lambda series, column, name: chart.Curve(name, points(rows, series, column), slope(rows, series, column))  # noqa: E731
    titles = {"triangles": f"map of {int(sides(rows, 'triangles')[0])}^2", "texels": "one tolerance"}
    panels = []
    for column, y, name in (("cpu_s", "seconds", "processor"), ("peak_mib", "MiB", "peak")):
        for series, title in titles.items():
            curves = [curve(series, column, name)]
            panels.append(chart.Panel(title, series, y, curves))
    for panel, series in zip(panels, titles):
        for stage in STAGES[:-1]:
            seconds = [row | {"seconds": row[f"{stage}_ms"] / 1000} for row in rows]
            panel.curves.append(chart.Curve(stage, points(seconds, series, "seconds"), slope(seconds, series, "seconds")))
    devices = ", ".join(sorted({row["device"] for row in rows}))
    chart.write(file, panels, 2, f"displace apply on {devices}; stages are wall time; beside each name: b of cost ~ size^b")


def sides(rows: list[dict], series: str) -> list[float]:
    return sorted({row["side"] for row in rows if row["series"] == series})


def tell(rows: list[dict]) -> bool:
    """Prints the exponents; whether all are within their bars."""
    within = True
    for (series, column), most in MOST.items():
        found = slope(rows, series, column)
        if found is None:
            print(f"{column} ~ {series}^b: too few points")
            continue
        within &= found <= most
        verdict = f"at most {most}: {'ok' if found <= most else 'missed'}"
        last = chart.slope(points(rows, series, column)[-2:])
        print(f"{column} ~ {series}^{found:.2f} from {LEAST[series]:g} {series} on ({verdict}; between the last two {last:.2f})")
    for series, stage in ((series, stage) for series in LEAST for stage in STAGES):
        if found := slope(rows, series, f"{stage}_ms"):
            print(f"wall of {stage} ~ {series}^{found:.2f}")
    return within


def arguments():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--displace", type=Path, help="the displace binary")
    parser.add_argument("--device", help="of displace")
    parser.add_argument("--most-triangles", type=float, default=1e6, help="of the first series")
    parser.add_argument("--most-side", type=int, default=8192, help="texels of the second series; a power of two")
    parser.add_argument("--out", type=Path, default=CHARTS, help="of scaling.csv and scaling.svg (default: tests/charts)")
    parser.add_argument("--redraw", action="store_true", help="draw the committed data again, measure nothing")
    options = parser.parse_args()
    if not options.redraw and options.displace is None:
        parser.error("give --displace, or --redraw to draw what was measured")
    return options


def main() -> int:
    options = arguments()
    if not options.redraw:
        with tempfile.TemporaryDirectory() as scratch:
            write(options.out / "scaling.csv", measured(options, Path(scratch)))
    rows = read(options.out / "scaling.csv")
    draw(rows, options.out / "scaling.svg")
    return 0 if tell(rows) else 1


def measured(options, scratch: Path) -> list[dict]:
    # Only here are packages needed.
    import scaling_runs

    rows = []
    print(f"| {' | '.join(COLUMNS)} |\n{'|---' * len(COLUMNS)}|")
    for row in scaling_runs.rows(options, scratch):
        rows.append({column: row[column] for column in COLUMNS})
        print(f"| {' | '.join(str(value) for value in rows[-1].values())} |", flush=True)
    return rows


if __name__ == "__main__":
    sys.exit(main())
