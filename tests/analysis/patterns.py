"""Regular patterns of every tessellation of the catalog, and one that mixes openings with closed points."""

from __future__ import annotations

import numpy as np

from kirisurf.pattern import tile_pattern
from kirisurf.tessellation import Tessellation
from kirisurf.unit_cell import quad_cell
from kirisurf.unit_cells.catalog import catalog, find_cell

NAMES = tuple(entry.name for entry in catalog())
"""Every tessellation of the catalog."""


def regular(name: str, n: int = 3, trimmed: bool = False) -> Tessellation:
    """Return a regular pattern of n x n cells, or what of them lies in a disk."""
    i, j = np.meshgrid(np.arange(n) - (n - 1) / 2, np.arange(n) - (n - 1) / 2, indexing="ij")
    return tile_pattern(find_cell(name), (i**2 + j**2 < 0.26 * n**2) if trimmed else np.ones((n, n), bool))


def in_space(points: np.ndarray) -> np.ndarray:
    """Return plane points about their middle, in the plane z = 0."""
    return np.pad(points - points.mean(axis=0), ((0, 0), (0, 1)))


def windowed(n: int = 5, rotation: float = 0.5) -> Tessellation:
    """Return a quad pattern with a window in every other cell: 4-sided designed openings among closed points."""
    mask = np.ones((n, n, 4), bool)
    # a cell's last tile never lies on the lower or left rim, and cells on the other two keep theirs
    mask[:-1:2, :-1:2, 3] = False
    return tile_pattern(quad_cell(rotation), mask)
