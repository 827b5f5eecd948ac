"""Height maps of any size that look the same from afar: fractal noise, and its averages over squares of texels."""

import numpy as np

# Less than half: what a map shows between the texels of a smaller one is soon below any tolerance of interest.
ROUGHNESS, SEED = 0.4, 1


def fractal(side: int) -> np.ndarray:
    """(side, side) f32 from 0 to 1: noise on grids of 2, 4, 8, ... cells a side, each with `ROUGHNESS` of the heights of the
    one before it, bilinear between them."""
    random, heights = np.random.default_rng(SEED), np.zeros((2, 2), np.float32)
    while len(heights) < side:
        heights = doubled(heights)
        heights += random.standard_normal(heights.shape, np.float32) * ROUGHNESS ** float(np.log2(len(heights) - 1))
    heights = heights[:side, :side]
    return (heights - heights.min()) / np.ptp(heights)


def doubled(heights: np.ndarray) -> np.ndarray:
    """Nodes between nodes: 2n - 1 a side."""
    for axis in (0, 1):
        rows = np.moveaxis(heights, axis, 0)
        wide = np.empty((2 * len(rows) - 1, rows.shape[1]), np.float32)
        wide[::2], wide[1::2] = rows, 0.5 * (rows[1:] + rows[:-1])
        heights = np.moveaxis(wide, 0, axis)
    return heights


def averaged(heights: np.ndarray, side: int) -> np.ndarray:
    times = len(heights) // side
    return heights.reshape(side, times, side, times).mean(axis=(1, 3), dtype=np.float64).astype(np.float32)
