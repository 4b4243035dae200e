"""Contraction closes what closes, spreads what does not, and is rigid for every tile."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kirisurf.contract import contract, flat_tiles
from kirisurf.derive import derive_tessellation
from kirisurf.errors import UnusableError
from kirisurf.loops import Loops
from kirisurf.pattern import quad_pattern
from tests.kirisurf.test_pattern import disk_mask, masked


def deployed(tessellation: object, scale: float = 1.0) -> np.ndarray:
    flat = np.column_stack([tessellation.deployed, np.zeros(tessellation.n_vertices)])
    return scale * flat @ Rotation.random(random_state=2).as_matrix().T + scale * np.array([5.0, -3.0, 1.0])


@pytest.mark.parametrize("scale", [1e-6, 1.0, 1e6])
@pytest.mark.parametrize("trimmed", [False, True])
def test_the_regular_pattern_closes_to_its_standard_layout(trimmed: bool, scale: float) -> None:
    t = masked(disk_mask(12, 5.6)) if trimmed else quad_pattern(4, 3, 0.5)
    found = contract(t, deployed(t, scale))
    expected = scale * (t.contracted - t.contracted.min(axis=0))
    np.testing.assert_allclose(found.points, expected, atol=1e-11 * scale)
    assert found.gap.max() < 1e-12 * scale


def test_every_tile_stays_rigid_and_what_is_open_is_reported() -> None:
    t = quad_pattern(3, 3, 0.5)
    points = deployed(t)
    points = points + 1e-4 * np.random.default_rng(0).standard_normal(points.shape)
    found = contract(t, points)
    flat = flat_tiles(t, points).reshape(-1, 4, 2)
    tiles = found.points[t.tiles.indices.reshape(-1, 4)]
    change = np.linalg.norm(tiles[:, 0] - tiles[:, 2], axis=1) - np.linalg.norm(flat[:, 0] - flat[:, 2], axis=1)
    assert 1e-5 < found.gap.max() < 2e-3
    # tiles bend by no more than the hinges are apart
    assert np.abs(change).max() < 4 * found.gap.max()
    spread = np.array([np.ptp(found.points[t.weld == w], axis=0).max() for w in range(t.n_welded)])
    assert spread.max() == pytest.approx(2 * found.gap.max(), rel=0.5)


def test_the_layout_does_not_depend_on_the_order_of_tiles() -> None:
    t = quad_pattern(3, 2, 0.4)
    points = deployed(t)
    points = points + 1e-6 * np.random.default_rng(1).standard_normal(points.shape)
    order = np.random.default_rng(2).permutation(t.n_tiles)
    u = derive_tessellation(t.deployed, t.contracted, t.tiles.subset(order), t.weld, t.cells[order])
    np.testing.assert_allclose(contract(t, points).points, contract(u, points).points, atol=1e-9)


def test_pieces_that_do_not_hang_together_are_refused() -> None:
    t = quad_pattern(1, 1, 0.5)
    n = t.n_vertices
    two = derive_tessellation(
        np.vstack([t.deployed, t.deployed + 9]),
        np.vstack([t.contracted, t.contracted + 9]),
        Loops.from_lists([*t.tiles, *(loop + n for loop in t.tiles)]),
        np.r_[t.weld, t.weld + t.n_welded],
    )
    with pytest.raises(UnusableError, match="connected"):
        contract(two, np.column_stack([two.deployed, np.zeros(two.n_vertices)]))
