"""The first contact on a way is found where the formula has it."""

from __future__ import annotations

import numpy as np
import pytest

from analysis.collision_path import path_collisions
from analysis.interpolation import Interpolation
from kirisurf.errors import ParameterError
from kirisurf.loops import Loops
from kirisurf.unit_cells.catalog import catalog
from tests.analysis import patterns
from tests.analysis.test_collisions import hinged_squares

APART = Loops.from_lists([[0, 1, 2, 3], [4, 5, 6, 7]])
SQUARE = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])


def approaching(share: float) -> np.ndarray:
    """Two unit squares: the second comes from half an edge away, and is as deep in the first at the end."""
    return np.concatenate([SQUARE, SQUARE + np.array([1.5 - share, 0.2])])


@pytest.mark.parametrize("name", [entry.name for entry in catalog() if entry.moves])
def test_the_mechanism_of_a_regular_pattern_is_free_all_the_way(name):
    pattern = patterns.regular(name, 2)
    ways = [patterns.in_space(state) for state in (pattern.contracted, pattern.deployed)]
    motion = Interpolation.between(pattern.tiles, *ways)
    found = path_collisions(np.array([motion.at(share) for share in np.linspace(0, 1, 11)]), pattern.tiles)
    assert found.is_free
    assert found.free_until == 1.0
    assert found.counts.tolist() == [0] * 11


@pytest.mark.parametrize("steps", [2, 5, 12])
def test_the_first_contact_is_found_within_the_tolerance(steps):
    shares = np.linspace(0, 1, steps)
    found = path_collisions([approaching(share) for share in shares], APART, tolerance=1e-6)
    assert 0.5 - 2e-6 <= found.free_until <= 0.5 + 2e-6
    assert found.first_contact.pairs.tolist() == [[0, 1]]
    assert found.first_contact.deepest < 1e-5
    assert found.depths == pytest.approx(np.maximum(shares - 0.5, 0), abs=1e-7)


def test_tiles_that_turn_between_two_states_stay_rigid():
    # the slit closes from an opening of 1 to -1: squares meet halfway, however few states there are
    states = [hinged_squares(opening, 0.0)[0] for opening in (1.0, -0.6)]
    found = path_collisions(states, hinged_squares(0.0, 0.0)[1], tolerance=1e-6)
    assert found.free_until == pytest.approx(1.0 / 1.6, abs=1e-4)


def test_a_pinch_is_found_at_the_angle_of_the_formula():
    fold = 0.6
    critical = np.arctan(np.sin(fold) / np.sqrt(8))
    openings = np.linspace(0.5, 0.0, 20)
    tiles = hinged_squares(0.0, 0.0)[1]
    found = path_collisions([hinged_squares(opening, fold)[0] for opening in openings], tiles, thickness=0.05)
    assert 0.5 * (1 - found.free_until) == pytest.approx(critical, rel=2e-3)


def test_states_between_are_asked_for_where_they_can_be_computed():
    asked = []

    def between(share):
        asked.append(share)
        return approaching(share**2)

    found = path_collisions([approaching(share**2) for share in (0.0, 1.0)], APART, between=between, tolerance=1e-7)
    assert found.free_until == pytest.approx(np.sqrt(0.5), abs=1e-6)
    assert asked


def test_a_way_that_begins_with_a_collision_is_free_nowhere():
    found = path_collisions([approaching(0.8), approaching(0.9)], APART)
    assert found.free_until is None
    assert not found.is_free
    assert found.counts.tolist() == [1, 1]


def test_wrong_ways_are_named():
    states = [approaching(0.0), approaching(0.1)]
    with pytest.raises(ParameterError, match="one for each"):
        path_collisions(states, APART, [0.0])
    with pytest.raises(ParameterError, match="one for each"):
        path_collisions([], APART)
    with pytest.raises(ParameterError, match="ascend"):
        path_collisions(states, APART, [1.0, 0.0])
    with pytest.raises(ParameterError, match="tolerance"):
        path_collisions(states, APART, tolerance=0.0)
