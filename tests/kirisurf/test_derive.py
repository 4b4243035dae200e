"""Topology beyond quad sheets: hinges of many tiles, openings that stay, slits without a hinge."""

from __future__ import annotations

import numpy as np
import pytest

from kirisurf.derive import derive_tessellation, n_outer_loops
from kirisurf.loops import Loops
from kirisurf.pattern import tile_pattern
from kirisurf.tessellation import Tessellation
from kirisurf.unit_cell import quad_cell
from kirisurf.unit_cells import find_cell


def fan(tiles: int, opened: float) -> Tessellation:
    """Triangles of 40 degrees about one hinge, closed side to side, deployed with gaps of `opened` radians."""
    angle = np.deg2rad(40)
    contracted, deployed, loops = [np.zeros(2)], [np.zeros(2)], []
    for k in range(tiles):
        n = len(contracted)
        contracted += [(np.cos(a), np.sin(a)) for a in (k * angle, (k + 1) * angle)]
        deployed += [(np.cos(a), np.sin(a)) for a in (k * (angle + opened), k * (angle + opened) + angle)]
        loops.append([0, n, n + 1])
    contracted, deployed = np.array(contracted), np.array(deployed)
    weld = np.unique(contracted.round(9), axis=0, return_inverse=True)[1].ravel()
    return derive_tessellation(deployed, contracted, Loops.from_lists(loops), weld)


@pytest.mark.parametrize("tiles", [2, 3, 5])
def test_a_hinge_of_many_tiles_has_a_gap_after_each_in_turn(tiles: int) -> None:
    t = fan(tiles, 0.1)
    assert len(t.edge_pairs) == tiles - 1
    assert len(t.hinges) == tiles
    assert t.slit_ends.sum() == tiles - 1
    u, v = (t.deployed[t.hinges[:, k]] for k in (0, 2))
    gaps = np.arctan2(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0], (u * v).sum(axis=1)) % (2 * np.pi)
    np.testing.assert_allclose(gaps[t.slit_ends], 0.1, atol=1e-12)
    np.testing.assert_allclose(gaps.sum() + tiles * np.deg2rad(40), 2 * np.pi, atol=1e-12)
    assert len(t.holes) == 0
    assert n_outer_loops(t) == 1


def test_order_at_a_hinge_does_not_depend_on_the_order_of_tiles() -> None:
    t = fan(5, 0.1)
    order = np.array([3, 0, 4, 2, 1])
    u = derive_tessellation(t.deployed, t.contracted, t.tiles.subset(order), t.weld)
    assert {tuple(row) for row in t.hinges.tolist()} == {tuple(row) for row in u.hinges.tolist()}


def test_a_missing_tile_leaves_a_hole_with_an_opening() -> None:
    mask = np.ones((2, 2, 4), bool)
    whole = tile_pattern(quad_cell(0.5), mask)
    mask[0, 0, 3] = False
    t = tile_pattern(quad_cell(0.5), mask)
    assert n_outer_loops(t) == 2
    # the four holes round the missing tile are one, bounded by its four sides
    assert len(t.holes) == len(whole.holes) - 3
    assert sorted(t.openings.sizes.tolist()) == [0] * (len(t.holes) - 1) + [4]
    (opening,) = (opening for opening in t.openings if len(opening))
    corners = t.contracted[t.tiles.indices[opening]]
    np.testing.assert_allclose(np.ptp(corners, axis=0), 0.5)


def test_openings_follow_their_hole_and_have_no_partner() -> None:
    t = tile_pattern(find_cell("hexagon"), np.ones((3, 3), bool))
    paired = {tuple(edge) for pair in t.edge_pairs.tolist() for edge in (pair[0], pair[1][::-1])}
    for hole, opening in zip(t.holes, t.openings, strict=True):
        edges = t.tiles.edges[opening]
        assert paired.isdisjoint(map(tuple, edges.tolist()))
        # the opening is a closed curve of contracted vertices, clockwise seen from its tiles
        np.testing.assert_array_equal(t.weld[edges[:, 0]], np.roll(t.weld[edges[:, 1]], -1))
        places = [hole.tolist().index(vertex) for vertex in edges[:, 0]]
        assert places == sorted(places)


def test_slits_whose_ends_are_both_apart_are_edge_pairs_too() -> None:
    t = tile_pattern(find_cell("islamic-quad"), np.ones((3, 3), bool))
    hinged = (t.edge_pairs[:, 0] == t.edge_pairs[:, 1]).sum(axis=1)
    # squares hinge with octagons at one end of every side; octagons lie along each other without a hinge
    assert set(hinged.tolist()) == {0, 1}
    np.testing.assert_array_equal(t.weld[t.edge_pairs[:, 0]], t.weld[t.edge_pairs[:, 1]])
    a, b = (t.deployed[t.edge_pairs[hinged == 0, k, 1]] - t.deployed[t.edge_pairs[hinged == 0, k, 0]] for k in (0, 1))
    np.testing.assert_allclose(a, b, atol=1e-12)
