"""What Fig. 1 is drawn from: rigid squares in every state, and a point of a sheet where tiles meet."""

from __future__ import annotations

import numpy as np
import pytest

import kirisurf
from kirisurf.errors import UnusableError
from kirisurf.reproducing_first import meeting_corner, opening_squares


@pytest.fixture(scope="module")
def design() -> kirisurf.Design:
    return kirisurf.fit("circle", cells=(2, 2), contracted="rectangle:1")


def test_squares_stay_squares_of_side_one_while_they_turn() -> None:
    squares = opening_squares(2, (0, 10, 27, 45))
    corners = squares.states[0][np.array(list(squares.tiles))]
    for state, degree in zip(squares.states, squares.degrees, strict=True):
        found = state[np.array(list(squares.tiles))]
        sides = np.roll(found, -1, axis=1) - found
        np.testing.assert_allclose(np.linalg.norm(sides, axis=2), 1.0, atol=1e-12)
        before = (np.roll(corners, -1, axis=1) - corners) @ (1, 1j)
        turns = np.degrees(np.angle((sides @ (1, 1j)) / before))
        np.testing.assert_allclose(np.abs(turns), degree, atol=1e-9)
        if degree:
            assert len(np.unique(np.sign(turns[squares.tones == 0]))) == 1
            assert (
                np.sign(turns[:, 0]) == np.where(squares.tones == squares.tones[0], 1, -1) * np.sign(turns[0, 0])
            ).all()


def test_the_width_of_many_squares_grows_by_the_stretch() -> None:
    """A sheet of n squares is n (cos r + sin r) wide, up to its rim: the difference over n falls with 1/n."""
    off = []
    for cells in (4, 8):
        squares = opening_squares(cells, (0, 30))
        closed, opened = (float(np.ptp(state[:, 0])) for state in squares.states)
        off.append(abs(opened / closed - squares.stretches[1]))
    assert off[1] <= 0.55 * off[0] + 1e-12
    assert off[0] < 0.1


def test_what_meets_at_a_point_is_equal(design: kirisurf.Design) -> None:
    corner = meeting_corner(design, (0.3, 0.7))
    assert len(corner.tiles) == len(corner.pairs) == 4
    points = np.array([tile[k] for tile, k in zip(corner.tiles, corner.corners, strict=True)])
    np.testing.assert_allclose(points, points[:1].repeat(4, axis=0), atol=1e-9)
    assert corner.angles.sum() == pytest.approx(2 * np.pi, abs=1e-9)
    np.testing.assert_allclose(corner.lengths[:, 0], corner.lengths[:, 1], atol=1e-9)
    for (a, i), (b, j) in corner.pairs:
        one, other = (
            np.array([corner.tiles[t][s], np.roll(corner.tiles[t], -1, axis=0)[s]]) for t, s in ((a, i), (b, j))
        )
        np.testing.assert_allclose(one, other[::-1], atol=1e-9)


def test_the_point_shown_is_the_one_nearest_to_the_place(design: kirisurf.Design) -> None:
    flat = design.contracted_points
    low, size = flat.min(axis=0), np.ptp(flat, axis=0)
    for place in ((0.1, 0.1), (0.9, 0.5), (0.5, 0.5)):
        corner = meeting_corner(design, place)
        found = corner.tiles[0][corner.corners[0]]
        rings = [flat[design.tessellation.corners[ring[0], 1]] for ring in design.tessellation.rings]
        away = np.linalg.norm(np.array(rings) - low - np.array(place) * size, axis=1).min()
        assert np.linalg.norm(found - low - np.array(place) * size) == pytest.approx(away, abs=1e-9)


def test_a_sheet_whose_tiles_nowhere_meet_all_round_is_told() -> None:
    hexagons = kirisurf.fit("anvil", cells=(2, 1), tessellation="hexagon")
    with pytest.raises(UnusableError, match="expected a sheet with a point that has tiles all round, got none"):
        meeting_corner(hexagons, (0.5, 0.5))
