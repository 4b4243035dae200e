"""Interpolated states: the ends, rigid tiles, and the mechanism of rotating squares."""

from __future__ import annotations

import numpy as np
import pytest

from analysis.interpolation import Interpolation
from kirisurf.pattern import quad_pattern


def in_space(points: np.ndarray) -> np.ndarray:
    return np.column_stack([points, np.zeros(len(points))])


@pytest.fixture
def squares() -> Interpolation:
    pattern = quad_pattern(4, 3)
    return Interpolation.between(pattern.tiles, in_space(pattern.contracted), in_space(pattern.deployed))


def edge_lengths(squares: Interpolation, points: np.ndarray) -> np.ndarray:
    start, end = squares.tiles.edges.T
    return np.linalg.norm(points[end] - points[start], axis=1)


def test_the_ends_are_the_two_states(squares):
    assert np.array_equal(squares.at(0.0), squares.contracted)
    assert np.array_equal(squares.at(1.0), squares.deployed)
    for share in (1e-9, 1 - 1e-9):
        assert np.abs(squares.at(share) - squares.at(float(round(share)))).max() < 1e-7


@pytest.mark.parametrize("share", [0.2, 0.5, 0.9])
def test_rotating_squares_open_by_their_mechanism(squares, share):
    """Squares that turn by +-45 degrees in all are rigid throughout, and their corners stay joined."""
    points = squares.at(share)
    assert np.allclose(edge_lengths(squares, points), edge_lengths(squares, squares.deployed), rtol=1e-6)


def test_a_rigid_motion_of_an_end_moves_the_turns_with_it(squares):
    """Between a sheet and its moved copy all tiles turn alike: every state between is a copy too."""
    c, s = np.cos(0.8), np.sin(0.8)
    turn = np.array([[c, 0, s], [0, 1, 0], [-s, 0, c]])
    moved = Interpolation.between(squares.tiles, squares.deployed, squares.deployed @ turn.T + [1.0, 2.0, 3.0])
    halfway = moved.at(0.5)
    assert np.allclose(edge_lengths(squares, halfway), edge_lengths(squares, squares.deployed), rtol=1e-9)
    gram = lambda p: (p - p.mean(axis=0)) @ (p - p.mean(axis=0)).T  # noqa: E731
    assert np.allclose(gram(halfway), gram(squares.deployed), atol=1e-6)
