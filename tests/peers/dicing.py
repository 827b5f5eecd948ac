"""The unit square diced as renderers do, to a screen error: uniformly by powers of two, and by lengths of edges.

By lengths: every edge of the undisplaced surface whose length on the screen is above the dicing rate is halved, and
triangles follow their edges, until none is longer; an edge's lot depends on that edge alone, so nothing opens. As in
Cycles, a length on the screen is that in the world over the size of a pixel there, foreshortened or not, and what the view
does not see is diced `UNSEEN` times as coarsely.
"""

import numpy as np

from heightfield import Mesh
from screen import SAMPLES, UNSEEN, Error, Surface, bilinear

# Rates that are tried: a pixel times powers of 2^(1/8).
RATES_PER_OCTAVE = 8
COARSEST_OCTAVES, FINEST_OCTAVES = 6, -1
# Of half an image.
RAMP = 0.25
MOST_TRIANGLES = 4_000_000
# Two triangles on the square, as the plane has them; places are (u, v).
SQUARE = np.array([[(0, 0), (0, 1), (1, 1)], [(0, 0), (1, 1), (1, 0)]], np.float64)
# Children by which edges (1, 2 and 4: the edge from corner 0, 1 and 2 on) are halved; 3 to 5 are their middles.
CHILDREN = {
    0: [(0, 1, 2)],
    1: [(0, 3, 2), (3, 1, 2)], 2: [(0, 1, 4), (0, 4, 2)], 4: [(0, 1, 5), (5, 1, 2)],
    3: [(3, 1, 4), (0, 3, 4), (0, 4, 2)], 6: [(4, 2, 5), (1, 4, 5), (1, 5, 0)], 5: [(5, 0, 3), (2, 5, 3), (2, 3, 1)],
    7: [(0, 3, 5), (3, 1, 4), (5, 4, 2), (3, 4, 5)],
}


class Uniform:
    """A surface diced uniformly; errors are kept by level."""

    def __init__(self, surface: Surface):
        self.surface, self.errors_px = surface, []

    def to(self, target_px: float) -> int:
        """The least 2 * 4^level triangles that are no further off than the target."""
        level = 0
        while self.error_px(level) > target_px:
            level += 1
        return 2 * 4**level

    def error_px(self, level: int) -> float:
        if level == len(self.errors_px):
            step = (self.surface.size - 1) >> level
            is_read = step > SAMPLES // 4
            # Within texels the surface is a saddle: each further level has a quarter of the error.
            error = self.surface.error(uniform_heights(self.surface, step)).seen_px if is_read else self.errors_px[-1] / 4
            self.errors_px.append(error)
        return self.errors_px[level]


def uniform_heights(surface: Surface, step: int) -> np.ndarray:
    """Of cells of so many places a side, split along u = v, at all places."""
    corners = surface.heights[::step, ::step]
    cell = np.minimum(np.arange(surface.size) // step, len(corners) - 2)
    within = np.arange(surface.size) / step - cell
    (i, j), (s, t) = np.meshgrid(cell, cell), np.meshgrid(within, within)
    first, last = corners[j, i], corners[j + 1, i + 1]
    between = np.where(s >= t, corners[j, i + 1], corners[j + 1, i])
    return first + np.maximum(s, t) * (between - first) + np.minimum(s, t) * (last - between)


class ByEdges:
    """A surface diced by lengths of edges; what was tried is kept: {power: (triangles, error)}."""

    def __init__(self, surface: Surface):
        self.surface, self.tried = surface, {}

    def to(self, target_px: float) -> tuple[int, float] | None:
        """(triangles, rate in pixels) of the largest rate that meets the target, as bisection finds it; none if that
        takes more than `MOST_TRIANGLES`."""
        coarse, fine = RATES_PER_OCTAVE * COARSEST_OCTAVES, RATES_PER_OCTAVE * FINEST_OCTAVES
        while coarse - fine > 1:
            power = (coarse + fine) // 2
            coarse, fine = (coarse, power) if self.at(power)[1] <= target_px else (power, fine)
        triangles, error = self.at(fine)
        is_met = error <= target_px and triangles < MOST_TRIANGLES
        return (triangles, 2 ** (fine / RATES_PER_OCTAVE)) if is_met else None

    def at(self, power: int) -> tuple[int, float]:
        """Rates too fine to be tried count as `MOST_TRIANGLES` and as met."""
        if power not in self.tried:
            self.tried[power] = self.dice(2 ** (power / RATES_PER_OCTAVE))
        return self.tried[power]

    def dice(self, rate_px: float) -> tuple[int, float]:
        places = diced(self.surface, rate_px)
        if places is None:
            return MOST_TRIANGLES, 0.0
        return len(places), error_of(self.surface, places).seen_px


def diced(surface: Surface, rate_px: float) -> np.ndarray | None:
    """Triangles (t, 3, 2) of places."""
    open_, done, count = SQUARE, [], 0
    while len(open_):
        halved = np.stack([screen_length(surface, open_[:, k], open_[:, (k + 1) % 3]) > rate_px for k in range(3)], axis=1)
        pattern = halved @ (1, 2, 4)
        done.append(open_[pattern == 0])
        open_ = children(open_, pattern)
        count += len(done[-1])
        if count + len(open_) > MOST_TRIANGLES:
            return None
    return np.concatenate(done)


def children(triangles: np.ndarray, pattern: np.ndarray) -> np.ndarray:
    made = []
    for which, corners in CHILDREN.items():
        some = triangles[pattern == which]
        six = np.concatenate([some, 0.5 * (some + np.roll(some, -1, axis=1))], axis=1)
        made += [six[:, list(of)] for of in corners] if which else []
    return np.concatenate(made)


def screen_length(surface: Surface, a: np.ndarray, b: np.ndarray) -> np.ndarray:
    """Pixels of the undisplaced edges from places a to b (e, 2), where a pixel is least of their ends and middles."""
    pixel = np.min([pixel_size(surface, place) for place in (a, 0.5 * (a + b), b)], axis=0)
    return np.linalg.norm(a - b, axis=1) / pixel


def pixel_size(surface: Surface, places: np.ndarray) -> np.ndarray:
    """At its depth in the image, `UNSEEN` times as large at its distance outside, in between over `RAMP`: with a step,
    edges on both sides of it would make needles without end."""
    view, world = surface.view, np.stack([places[:, 0], np.zeros(len(places)), places[:, 1]], axis=1)
    right, up, depth = ((world - view.eye) @ view.axes().T).T
    unit = 0.5 / view.pixels_at_unit_depth() * np.maximum(depth, surface.near)
    beyond = np.maximum(np.abs(right) / (view.width * unit), np.abs(up) / (view.height * unit)) - 1
    outside = np.where(depth > 0, np.clip(beyond / RAMP, 0, 1), 1)
    distance = np.sqrt(right**2 + up**2 + depth**2)
    return np.maximum(depth * (1 - outside) + UNSEEN * distance * outside, surface.near) / view.pixels_at_unit_depth()


def error_of(surface: Surface, places: np.ndarray) -> Error:
    texels = places.reshape(-1, 2) * (len(surface.field) - 1)
    heights = bilinear(surface.field, texels[:, 0], texels[:, 1])
    vertices = np.concatenate([texels, heights[:, None]], axis=1)
    return surface.error_of_mesh(Mesh(vertices, np.arange(len(vertices)).reshape(-1, 3)))
