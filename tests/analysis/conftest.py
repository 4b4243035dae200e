"""Designs and surfaces that the tests of the analysis share."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest

from kirisurf.loops import Loops
from kirisurf.pattern import quad_pattern
from kirisurf.surface import Surface
from kirisurf.tessellation import Tessellation


@dataclass(frozen=True)
class Design:
    """A sound design: the regular pattern, opened flat in space."""

    deployed: np.ndarray
    contracted: np.ndarray
    tiles: Loops
    tessellation: Tessellation


@pytest.fixture
def flat_design() -> Callable[..., Design]:
    """Return a maker of flat designs: cells, rotation of the tiles."""

    def make(columns: int = 3, rows: int = 3, rotation: float = 0.6) -> Design:
        pattern = quad_pattern(columns, rows, rotation)
        deployed = np.c_[pattern.deployed - pattern.deployed.mean(axis=0), np.zeros(pattern.n_vertices)]
        return Design(deployed, np.array(pattern.contracted), pattern.tiles, pattern)

    return make


@pytest.fixture
def grid_surface() -> Callable[..., Surface]:
    """Return a maker of graphs z = f(x, y) over [-size, size]^2 with n x n vertices."""

    def make(function: Callable = lambda x, y: 0 * x, n: int = 21, size: float = 1.0, smooth: object = None) -> Surface:
        side = np.linspace(-size, size, n)
        x, y = np.meshgrid(side, side)
        number = np.arange(n * n).reshape(n, n)
        a, b, c, d = (q.ravel() for q in (number[:-1, :-1], number[:-1, 1:], number[1:, 1:], number[1:, :-1]))
        vertices = np.c_[x.ravel(), y.ravel(), function(x, y).ravel()]
        return Surface.from_arrays(vertices, np.r_[np.c_[a, b, c], np.c_[a, c, d]], "graph", smooth)

    return make


@pytest.fixture
def rotation() -> np.ndarray:
    """Return a rotation in general position, (3, 3)."""
    q, r = np.linalg.qr(np.random.default_rng(5).normal(size=(3, 3)))
    q = q * np.sign(np.diag(r))
    return q * np.sign(np.linalg.det(q))
