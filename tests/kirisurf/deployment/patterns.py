"""Sheets of which it is known how they deploy: regular patterns are mechanisms, the paper's square-to-circle snaps."""

from __future__ import annotations

from functools import cache

import numpy as np

import kirisurf
from kirisurf.pattern import quad_pattern, tile_pattern
from kirisurf.tessellation import Tessellation
from kirisurf.unit_cells import find_cell


@cache
def squares(columns: int = 3, rows: int = 2, rotation: float = 0.6) -> Tessellation:
    return quad_pattern(columns, rows, rotation)


@cache
def kagome(columns: int = 2, rows: int = 2) -> Tessellation:
    cell = find_cell("kagome")
    return tile_pattern(cell, np.ones((columns, rows, len(cell.tiles)), bool))


@cache
def circle() -> tuple[Tessellation, np.ndarray, np.ndarray]:
    """A square sheet of 64 tiles that opens into the paper's circle: tessellation, contracted, deployed (n, 2)."""
    return _design("circle", (4, 4), "rectangle:1")


@cache
def hypar() -> tuple[Tessellation, np.ndarray, np.ndarray]:
    return _design("hypar", (3, 3))


def _design(
    target: str, cells: tuple[int, int], shape: str | None = None
) -> tuple[Tessellation, np.ndarray, np.ndarray]:
    design = kirisurf.fit(target, cells=cells, **({"contracted": shape} if shape else {}))
    points = design.deployed_points
    deployed = points if np.ptp(points[:, 2]) > 0 else points[:, :2]
    return design.tessellation, design.contracted_points, deployed


def bumpy(points: np.ndarray, noise: float = 0.03, seed: int = 0) -> np.ndarray:
    return points + noise * np.random.default_rng(seed).standard_normal(points.shape)


def lifted(points: np.ndarray) -> np.ndarray:
    return np.column_stack([points, np.zeros(len(points))])
