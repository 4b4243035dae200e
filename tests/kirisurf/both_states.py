"""Regular rectangular patterns of every cell, deployed and contracted at once, in tile edges."""

from __future__ import annotations

from functools import cache

import numpy as np

from kirisurf.motion import motion_of
from kirisurf.pattern import tile_pattern
from kirisurf.scaling import median_edge
from kirisurf.tessellation import Tessellation
from kirisurf.trimming import rectangle_mask
from kirisurf.unit_cells.catalog import catalog, find_cell

NAMES = tuple(entry.name for entry in catalog())


@cache
def regular(name: str, columns: int = 2, rows: int = 2) -> Tessellation:
    cell = find_cell(name)
    return tile_pattern(cell, rectangle_mask(cell, motion_of(cell).adjacency, columns, rows))


def regular_points(tessellation: Tessellation) -> np.ndarray:
    """Deployed points, then one contracted point for every welded vertex (q, 3)."""
    first = np.unique(tessellation.weld, return_index=True)[1]
    flat = np.concatenate([tessellation.deployed, tessellation.contracted[first]])
    points = np.column_stack([flat, np.zeros(len(flat))])
    return points / median_edge(tessellation, points[: tessellation.n_vertices])


def bumpy(points: np.ndarray, seed: int = 0, noise: float = 0.05) -> np.ndarray:
    return points + noise * np.random.default_rng(seed).standard_normal(points.shape)


def turned(points: np.ndarray, angle: float, shift: tuple[float, float]) -> np.ndarray:
    """Flat points moved in their plane."""
    c, s = np.cos(angle), np.sin(angle)
    return points @ np.array([[c, s, 0], [-s, c, 0], [0, 0, 1]]) + np.array([*shift, 0.0])
