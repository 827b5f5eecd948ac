"""Panels of curves in an SVG, both axes logarithmic. Standard library alone."""

import math
from dataclasses import dataclass, field
from pathlib import Path

WIDTH, HEIGHT = 480, 300
LEFT, RIGHT, TOP, BOTTOM = 64, 136, 34, 48
COLOURS = ("#1b6ca8", "#c0392b", "#2e8b57", "#8e5ea2", "#b8860b", "#555555")
STYLE = "text{font:12px sans-serif;fill:#222}.grid{stroke:#ddd}.frame{fill:none;stroke:#888}.curve{fill:none;stroke-width:1.8}"


@dataclass
class Curve:
    """Points above 0 by rising x; `slope` of the straight line through them."""

    name: str
    points: list[tuple[float, float]]
    slope: float | None = None


@dataclass
class Panel:
    title: str
    x: str
    y: str
    curves: list[Curve] = field(default_factory=list)


def slope(points: list[tuple[float, float]]) -> float:
    """Least squares of log y over log x."""
    x, y = ([math.log(value) for value in axis] for axis in zip(*points))
    mean_x, mean_y = sum(x) / len(x), sum(y) / len(y)
    return sum((a - mean_x) * (b - mean_y) for a, b in zip(x, y)) / sum((a - mean_x) ** 2 for a in x)


def write(file: Path, panels: list[Panel], columns: int, caption: str) -> Path:
    rows = -(-len(panels) // columns)
    width, height = WIDTH * columns, HEIGHT * rows + 24
    parts = [f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}">']
    parts.append(f'<style>{STYLE}</style><rect width="{width}" height="{height}" fill="white"/>')
    for n, panel in enumerate(panels):
        place = f"translate({n % columns * WIDTH},{n // columns * HEIGHT})"
        parts.append(f'<g transform="{place}">{"".join(drawn(panel))}</g>')
    parts.append(text(LEFT, height - 10, caption) + "</svg>\n")
    file.write_text("\n".join(parts))
    return file


def drawn(panel: Panel):
    """The elements of one panel."""
    x, y = (Axis.over([point[k] for curve in panel.curves for point in curve.points]) for k in (0, 1))
    right, bottom = WIDTH - RIGHT, HEIGHT - BOTTOM
    at_x, at_y = (lambda value: LEFT + (right - LEFT) * x.share(value)), (lambda value: bottom - (bottom - TOP) * y.share(value))
    for value in x.decades():
        yield line(at_x(value), TOP, at_x(value), bottom) + text(at_x(value), bottom + 16, power(value), "middle")
    for value in y.decades():
        yield line(LEFT, at_y(value), right, at_y(value)) + text(LEFT - 6, at_y(value) + 4, power(value), "end")
    yield f'<rect class="frame" x="{LEFT}" y="{TOP}" width="{right - LEFT}" height="{bottom - TOP}"/>'
    yield text(LEFT, TOP - 12, f"{panel.title}, {panel.y}") + text((LEFT + right) / 2, bottom + 36, panel.x, "middle")
    for n, curve in enumerate(panel.curves):
        yield from drawn_curve(curve, COLOURS[n % len(COLOURS)], at_x, at_y)
        label = curve.name if curve.slope is None else f"{curve.name}: {curve.slope:.2f}"
        yield text(right + 8, TOP + 14 + 18 * n, label, colour=COLOURS[n % len(COLOURS)])


def drawn_curve(curve: Curve, colour: str, at_x, at_y):
    places = [(at_x(a), at_y(b)) for a, b in curve.points]
    yield f'<polyline class="curve" stroke="{colour}" points="{" ".join(f"{a:.1f},{b:.1f}" for a, b in places)}"/>'
    for a, b in places:
        yield f'<circle cx="{a:.1f}" cy="{b:.1f}" r="2.6" fill="{colour}"/>'


@dataclass
class Axis:
    """From one power of ten to another."""

    low: int
    high: int

    @staticmethod
    def over(values: list[float]) -> "Axis":
        low, high = math.floor(math.log10(min(values))), math.ceil(math.log10(max(values)))
        return Axis(low, max(high, low + 1))

    def share(self, value: float) -> float:
        return (math.log10(value) - self.low) / (self.high - self.low)

    def decades(self) -> list[float]:
        return [10.0**k for k in range(self.low, self.high + 1)]


def power(value: float) -> str:
    exponent = round(math.log10(value))
    return f"{value:g}" if -3 <= exponent <= 3 else f"1e{exponent}"


def line(x1: float, y1: float, x2: float, y2: float) -> str:
    return f'<line class="grid" x1="{x1:.1f}" y1="{y1:.1f}" x2="{x2:.1f}" y2="{y2:.1f}"/>'


def text(x: float, y: float, words: str, anchor: str = "start", colour: str | None = None) -> str:
    words = words.replace("&", "&amp;").replace("<", "&lt;")
    fill = f' style="fill:{colour}"' if colour else ""
    return f'<text x="{x:.1f}" y="{y:.1f}" text-anchor="{anchor}"{fill}>{words}</text>'
