"""Motions of unit cells: both ends, closed forms, hinges that hold, and what a stretch says about the way."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kirisurf.arrays import frozen
from kirisurf.motion import Motion, motion_of
from kirisurf.pattern import tile_pattern
from kirisurf.unit_cell import UnitCell, quad_cell
from kirisurf.unit_cells import catalog
from kirisurf.unit_cells.hexagon import hexagon_cell
from kirisurf.unit_cells.kagome import kagome_cell
from tests.kirisurf.cells import every_cell, motion, moving_cell

WAY = np.linspace(0, 1, 11)


def gap(found: Motion, way: float) -> float:
    """Largest distance between corners that are hinged, over a patch of cells."""
    state = found.state(way)
    pattern = tile_pattern(found.cell, np.ones((3, 3), bool))
    corners = state.deployed[found.cell.tiles.indices]
    place = found.cell.tiles.offsets[pattern.cells[pattern.tiles.owners, 2]]
    place = place + np.arange(len(place)) - pattern.tiles.offsets[pattern.tiles.owners]
    points = corners[place] + pattern.cells[pattern.tiles.owners, :2] @ state.deployed_shifts
    low, high = (np.full((pattern.n_vertices, 2), sign * np.inf) for sign in (1, -1))
    np.minimum.at(low, pattern.tiles.indices, points)
    np.maximum.at(high, pattern.tiles.indices, points)
    return float((high - low).max())


@moving_cell
def test_hinges_hold_all_the_way(name: str) -> None:
    assert not motion(name).snaps
    assert max(gap(motion(name), way) for way in WAY) < 1e-12


def test_the_catalog_knows_what_moves() -> None:
    for entry in catalog():
        assert motion(entry.name).snaps != entry.moves


@pytest.mark.parametrize("name", ["islamic-quad", "islamic-triangle"])
def test_snapping_cells_hold_at_both_ends_only(name: str) -> None:
    assert motion(name).snaps
    assert gap(motion(name), 0.0) < 1e-12 and gap(motion(name), 1.0) < 1e-12
    assert gap(motion(name), 0.5) > 1e-3


def apart(cell: UnitCell, points: np.ndarray, shifts: np.ndarray) -> np.ndarray:
    """Distances between all corners of two by two cells: equal where two states are, up to a rigid motion."""
    every = np.concatenate([points[cell.tiles.indices] + [c, r] @ shifts for c in (0, 1) for r in (0, 1)])
    return np.linalg.norm(every[:, None] - every, axis=-1)


@every_cell
def test_the_ends_are_the_given_states(name: str) -> None:
    cell, closed, opened = motion(name).cell, motion(name).state(0.0), motion(name).state(1.0)
    np.testing.assert_allclose(
        apart(cell, closed.deployed, closed.deployed_shifts), apart(cell, cell.contracted, cell.contracted_shifts),
        atol=1e-12,
    )  # fmt: skip
    np.testing.assert_allclose(
        apart(cell, opened.deployed, opened.deployed_shifts), apart(cell, cell.deployed, cell.deployed_shifts),
        atol=1e-12,
    )  # fmt: skip


@every_cell
def test_tiles_stay_congruent_and_the_lattice_upright(name: str) -> None:
    found = motion(name)
    for way in WAY:
        state = found.state(way)
        for tile in found.cell.tiles:
            sides = [
                np.linalg.norm(np.diff(p[[*tile, tile[0]]], axis=0), axis=1) for p in (state.deployed, state.contracted)
            ]
            np.testing.assert_allclose(*sides, atol=1e-12)
        gradient = np.linalg.solve(state.contracted_shifts, state.deployed_shifts)
        np.testing.assert_allclose(gradient, gradient.T, atol=1e-12)
        assert np.linalg.eigvalsh(gradient).min() > 0


@pytest.mark.parametrize(
    ("make", "most", "tangent"),
    [(quad_cell, np.pi / 4, 1.0), (kagome_cell, np.pi / 3, np.sqrt(3)), (hexagon_cell, np.pi / 6, 1 / np.sqrt(3))],
)
def test_stretches_follow_the_closed_forms(make, most: float, tangent: float) -> None:
    found = motion_of(make())
    expected = np.cos(WAY * most) + tangent * np.sin(WAY * most)
    np.testing.assert_allclose(found.stretch(WAY), expected, atol=1e-13)
    for way in WAY:
        np.testing.assert_allclose(found.stretches(way), found.stretch(np.array([way]))[0], atol=1e-13)


def test_rectangles_stretch_by_two_different_factors() -> None:
    """Sides 2:1 turned by r: the cell is longer by cos r + sin r / 2 one way and by cos r + 2 sin r the other."""
    found = motion("rotating-rectangles")
    for way in WAY:
        turn = way * np.arctan2(3, 4)
        expected = np.cos(turn) + np.array([2.0, 0.5]) * np.sin(turn)
        np.testing.assert_allclose(found.stretches(way), expected, atol=1e-13)


@every_cell
def test_the_way_is_found_from_the_stretch(name: str) -> None:
    found = motion(name)
    ways, stretches = found.table
    assert (np.diff(ways) > 0).all() and (np.diff(stretches) > 0).all()
    asked = np.linspace(1, found.most, 40)
    np.testing.assert_allclose(found.stretch(found.way(asked)), asked, atol=1e-12)
    np.testing.assert_allclose(found.way(np.array([0.5, 9.0])), [0.0, ways[-1]], atol=1e-12)


def test_a_cell_opened_too_far_gives_what_it_gives_on_the_way() -> None:
    """Squares turned by 60 degrees are smaller than those turned by 45: the largest stretch is not at the end."""
    found = motion_of(quad_cell(np.pi / 3))
    assert found.stretch(np.array([1.0]))[0] < 1.37
    assert found.most == pytest.approx(np.sqrt(2), abs=1e-3)
    assert found.way(np.array([found.most]))[0] < 0.8


def test_a_cell_turned_as_a_whole_moves_alike() -> None:
    """The open state of a file may lie at any angle, half a turn included."""
    for angle in (2.0, np.pi, -3.0):
        turn = np.array([[np.cos(angle), np.sin(angle)], [-np.sin(angle), np.cos(angle)]])
        cell = quad_cell(0.7)
        turned = replace(
            cell, deployed=frozen(cell.deployed @ turn), deployed_shifts=frozen(cell.deployed_shifts @ turn)
        )
        np.testing.assert_allclose(motion_of(turned).turns, motion_of(cell).turns, atol=1e-12)
        assert not motion_of(turned).snaps


@every_cell
def test_tiles_of_one_state_are_that_state(name: str) -> None:
    """Laid on the lattice of a state over its stretch, all tiles make a patch of that state at unit area."""
    found = motion(name)
    cells = np.argwhere(np.ones((2, 2, len(found.cell.tiles)), bool))
    for way in (0.2, 1.0):
        state, lattice = found.state(way), found.lattice(np.array([way]))[0]
        stretch = found.stretch(np.array([way]))[0]
        laid = stretch * found.corners(cells, np.full(len(cells), way), lattice / stretch)
        expected = [state.deployed[found.cell.tiles[int(k)]] + np.array([c, r]) @ lattice for c, r, k in cells]
        np.testing.assert_allclose(laid, np.concatenate(expected), atol=1e-12)
