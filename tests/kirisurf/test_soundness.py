"""Soundness: tiles side by side, facing the same way, not turned over; and what is not is found."""

from __future__ import annotations

import numpy as np
import pytest

from kirisurf.soundness import are_apart, are_convex, are_facing
from tests.kirisurf.both_states import NAMES, regular, regular_points, turned


@pytest.mark.parametrize("name", NAMES)
def test_regular_patterns_are_sound_in_both_states(name: str) -> None:
    tessellation = regular(name)
    points = regular_points(tessellation)[: tessellation.n_vertices]
    assert are_facing(tessellation, points)
    for layout in (tessellation.deployed, tessellation.contracted, 1e-6 * tessellation.contracted):
        assert are_apart(tessellation, layout)
    assert are_convex(tessellation, points) is (not name.startswith("islamic"))


@pytest.mark.parametrize("name", NAMES)
def test_a_tile_pushed_over_another_is_found(name: str) -> None:
    tessellation = regular(name)
    for state in (tessellation.deployed, tessellation.contracted):
        moved = state.copy()
        tile, other = tessellation.tiles[0], tessellation.tiles[tessellation.n_tiles - 1]
        moved[tile] += moved[other].mean(axis=0) - moved[tile].mean(axis=0)
        assert not are_apart(tessellation, moved)


def test_neighbors_that_overlap_beside_their_slit_are_found() -> None:
    """Both tiles of a hinge on the rim turned about it until they meet outside: the slit between them opens wide."""
    tessellation = regular("quad")
    points = regular_points(tessellation)[: tessellation.n_vertices]
    first, hinge, second = tessellation.hinges[~tessellation.slit_ends][0, :3]
    over = points.copy()
    tile = next(t for t in tessellation.tiles if hinge in t and second in t)
    over[tile] = turned(points[tile] - points[hinge], -np.radians(100), (0, 0)) + points[hinge]
    assert not are_apart(tessellation, over[:, :2])
    assert first in tessellation.tiles.indices
