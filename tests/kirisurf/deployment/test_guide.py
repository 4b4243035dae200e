"""The guide between flat and deployed."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from kirisurf.deployment.guide import Guide, nearest_place
from kirisurf.deployment.springs import energy_of
from kirisurf.errors import UnusableError
from tests.kirisurf.deployment.patterns import circle, hypar, squares


@pytest.mark.parametrize("design", [circle, hypar])
def test_both_ends_are_the_sheet_itself(design: object) -> None:
    tessellation, contracted, deployed = design()  # type: ignore[operator]
    guide = Guide(tessellation, contracted, deployed)
    np.testing.assert_allclose(guide.at(0.0), guide.flat, atol=1e-9)
    np.testing.assert_allclose(guide.at(1.0), deployed, atol=1e-9)
    energy = energy_of(tessellation, contracted, dimension=deployed.shape[1])
    assert energy.value(guide.flat) < 1e-25
    # straight lines shorten what turns
    assert energy.value(guide.straight(0.5)) > 10 * energy.value(guide.at(0.5))


def test_squares_turn_evenly_and_stay_rigid() -> None:
    tessellation = squares()
    guide = Guide(tessellation, tessellation.contracted, tessellation.deployed)
    energy = energy_of(tessellation, tessellation.contracted, dimension=2)
    for fraction in np.linspace(0, 1, 7):
        points = guide.at(fraction)
        assert energy.value(points) < 1e-25
        np.testing.assert_allclose(energy.openings(points), fraction * 1.2, atol=1e-12)
    np.testing.assert_allclose(np.abs(guide.turns[:, 2]), 0.6, atol=1e-12)


def test_the_place_of_the_flat_sheet_does_not_matter() -> None:
    tessellation, contracted, deployed = hypar()
    turn = Rotation.from_rotvec([0, 0, 2.5]).as_matrix()[:2, :2]
    guides = [Guide(tessellation, flat, deployed) for flat in (contracted, contracted @ turn.T + [3.0, -1.0])]
    np.testing.assert_allclose(guides[0].at(0.4), guides[1].at(0.4), atol=1e-9)


def test_in_the_plane_no_sheet_is_mirrored() -> None:
    points = np.random.default_rng(0).standard_normal((7, 2))
    placed = nearest_place(points, points * [1.0, -1.0])
    edges = [np.diff(p[:3], axis=0) for p in (points, placed)]
    np.testing.assert_allclose(*(np.linalg.det(e) for e in edges), atol=1e-12)


def test_tiles_of_two_shapes_are_refused() -> None:
    tessellation = squares()
    with pytest.raises(UnusableError, match="tiles of one shape in both"):
        Guide(tessellation, tessellation.contracted, tessellation.deployed * [1.0, 1.05])
