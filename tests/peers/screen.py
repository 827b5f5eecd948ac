"""How far triangles over a height field are from it on a screen: both projected from the same base places, in f64.

A scene is the unit square of y = 0 displaced along +Y by `scale` times a field that is bilinear between its texels. It is
read at `SAMPLES` x `SAMPLES` places for each texel. Lengths are those of the square, depths are along the view's axis.
"""

from dataclasses import dataclass

import numpy as np

from heightfield import Mesh, heights_of

# Places a side of a texel, 16 for each.
SAMPLES = 4
# What no view sees is held to so many times the tolerance, at its distance to the eye.
UNSEEN = 8.0
# Of the diagonal of the square: what lies nearer is held to what holds there.
NEAREST = 1e-3


@dataclass
class View:
    """An image of `width` x `height` pixels; `yfov_degrees` is vertical."""

    name: str
    eye: tuple[float, float, float]
    target: tuple[float, float, float]
    yfov_degrees: float = 50.0
    width: int = 1280
    height: int = 720

    def flag(self) -> str:
        eye, target = (",".join(map(repr, place)) for place in (self.eye, self.target))
        return f"{eye};{target};{self.yfov_degrees!r};{self.width}x{self.height}"

    def axes(self) -> np.ndarray:
        """Rows: right, up, ahead."""
        ahead = np.subtract(self.target, self.eye)
        ahead = ahead / np.linalg.norm(ahead)
        right = np.cross(ahead, (0.0, 1.0, 0.0))
        right = right / np.linalg.norm(right)
        return np.stack([right, np.cross(right, ahead), ahead])

    def pixels_at_unit_depth(self) -> float:
        return 0.5 * self.height / np.tan(0.5 * np.radians(self.yfov_degrees))

    def holds(self, right, up, depth) -> np.ndarray:
        """Whether such places, from the eye along the axes, are in the image."""
        across, upright = (0.5 * side * depth / self.pixels_at_unit_depth() for side in (self.width, self.height))
        return (depth > 0) & (np.abs(right) <= across) & (np.abs(up) <= upright)


@dataclass
class Error:
    """Pixels: the largest where the view looks, and where it does not, there over `UNSEEN`; `holes`: places without mesh."""

    seen_px: float
    unseen_px: float
    holes: int

    def largest_px(self) -> float:
        return max(self.seen_px, self.unseen_px)


class Surface:
    """A field under a view, at all places that are read."""

    def __init__(self, field: np.ndarray, scale: float, view: View):
        self.field, self.scale, self.view = field.astype(np.float64), scale, view
        self.size = (len(field) - 1) * SAMPLES + 1
        self.near = NEAREST * np.sqrt(2.0 + (scale * np.ptp(self.field)) ** 2)
        steps = np.arange(self.size) / SAMPLES
        self.heights = bilinear(self.field, steps[None, :], steps[:, None])
        self.up_axes = view.axes()[:, 1]
        self.right, self.up, self.depth = self.along_axes()
        self.seen = view.holds(self.right, self.up, self.depth)

    def along_axes(self) -> list[np.ndarray]:
        """Of the places of the surface from the eye, (size, size) each: right, up, depth."""
        side = np.arange(self.size) / (self.size - 1)
        x, y, z = side[None, :] - self.view.eye[0], self.scale * self.heights - self.view.eye[1], side[:, None] - self.view.eye[2]
        return [axis[0] * x + axis[1] * y + axis[2] * z for axis in self.view.axes()]

    def error_of_mesh(self, mesh: Mesh) -> Error:
        """Of a mesh with x and y in texels."""
        vertices = mesh.vertices * (SAMPLES, SAMPLES, 1)
        return self.error(heights_of(Mesh(vertices, mesh.triangles), self.size))

    def error(self, heights: np.ndarray) -> Error:
        """Of a mesh with such heights, (size, size), in the field's unit."""
        holes = int(np.isnan(heights).sum())
        shift = self.scale * (np.where(np.isnan(heights), self.heights, heights) - self.heights)
        right, up, depth = (at + axis * shift for at, axis in zip((self.right, self.up, self.depth), self.up_axes))
        seen = self.seen | self.view.holds(right, up, depth)
        pixels = self.view.pixels_at_unit_depth()
        # Where one of the two is too near, or behind the eye, the shift counts as seen face-on at the nearest depth.
        is_near = np.minimum(self.depth, depth) < self.near
        a, b = (np.where(is_near, self.near, d) for d in (self.depth, depth))
        moved = np.where(is_near, np.abs(shift) / self.near, np.hypot(self.right / a - right / b, self.up / a - up / b))
        unseen = np.abs(shift) / np.maximum(self.distance(), self.near) / UNSEEN
        return Error(*(float(pixels * of[where].max(initial=0.0)) for of, where in ((moved, seen), (unseen, ~seen))), holes)

    def distance(self) -> np.ndarray:
        return np.sqrt(self.right**2 + self.up**2 + self.depth**2)

    def least_tolerance(self, pixels: float) -> float:
        """The least shift of a place that the view sees, in the field's unit, that moves it so many pixels."""
        depth = np.maximum(self.depth, self.near)
        right, up, ahead = self.up_axes
        moves = np.hypot(right - self.right / depth * ahead, up - self.up / depth * ahead) / depth
        return float(pixels / (self.view.pixels_at_unit_depth() * self.scale * moves[self.seen].max()))


def bilinear(field: np.ndarray, x: np.ndarray, y: np.ndarray) -> np.ndarray:
    """At places in texels, 0 to its side - 1."""
    last = len(field) - 2
    i, j = (np.minimum(np.floor(at).astype(np.int64), last) for at in (x, y))
    s, t = x - i, y - j
    above = field[j, i] * (1 - s) + field[j, i + 1] * s
    below = field[j + 1, i] * (1 - s) + field[j + 1, i + 1] * s
    return above * (1 - t) + below * t
