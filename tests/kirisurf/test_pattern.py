"""Counts of patterns against the formulas, Euler's theorem, trimming, and what follows from topology."""

from __future__ import annotations

import numpy as np
import pytest

from kirisurf.adjacency import adjacency
from kirisurf.derive import derive_tessellation, n_outer_loops
from kirisurf.errors import ParameterError, UnusableError
from kirisurf.loops import Loops
from kirisurf.pattern import quad_pattern, tile_pattern
from kirisurf.tessellation import Tessellation
from kirisurf.trimming import sound_tiles
from kirisurf.unit_cell import quad_cell


@pytest.mark.parametrize("cells", [1, 2, 4, 7])
def test_counts_of_a_square_pattern(cells: int) -> None:
    n = 2 * cells
    t = quad_pattern(cells, cells)
    assert t.n_tiles == n * n
    assert t.n_vertices == 2 * n * (n + 1)
    assert len(t.edge_pairs) == 2 * n * (n - 1)
    assert len(t.rings) == len(t.holes) == (n - 1) ** 2
    assert len(t.hinges) == 4 * (n - 1) ** 2 + 4 * (n - 1)
    assert t.slit_ends.sum() == 2 * n * (n - 1)
    assert t.n_welded == (n + 1) ** 2
    # 3 n minus the equations (the surface rows included) is 8 N - 1 with one dependent rim row less
    assert 3 * t.n_vertices - (len(t.edge_pairs) + len(t.rings) + t.n_tiles) - t.n_vertices == 8 * n - 1


@pytest.mark.parametrize("shape", [(1, 1), (3, 5), (6, 2)])
def test_rectangles_have_four_sides_and_one_rim(shape: tuple[int, int]) -> None:
    t = quad_pattern(*shape)
    assert set(t.sides) == {"bottom", "right", "top", "left"}
    assert n_outer_loops(t) == 1
    # a hinge on the rim is one vertex, a slit that ends there two
    columns, rows = 2 * shape[0], 2 * shape[1]
    for side, tiles in (("bottom", columns), ("top", columns), ("left", rows), ("right", rows)):
        assert tiles + 1 <= len(t.sides[side]) <= 2 * tiles


def disk_mask(n: int, radius: float) -> np.ndarray:
    x = np.arange(n) - 0.5 * (n - 1)
    return sound_mask(x[:, None] ** 2 + x[None] ** 2 <= radius**2)


def cells_of(mask: np.ndarray) -> np.ndarray:
    """Mask (columns, rows, 4) of the quad cells of a tile mask with even sides."""
    return np.stack([mask[0::2, 0::2], mask[1::2, 0::2], mask[0::2, 1::2], mask[1::2, 1::2]], axis=-1)


def sound_mask(mask: np.ndarray) -> np.ndarray:
    """The sound part of a quad tile mask."""
    even = np.pad(mask, [(0, side % 2) for side in mask.shape])
    sound = sound_tiles(cells_of(even), adjacency(quad_cell()))
    tiles = np.zeros_like(even)
    for k, (column, row) in enumerate([(0, 0), (1, 0), (0, 1), (1, 1)]):
        tiles[column::2, row::2] = sound[:, :, k]
    return tiles[: mask.shape[0], : mask.shape[1]]


def masked(mask: np.ndarray) -> Tessellation:
    """Quad pattern of a tile mask with even sides."""
    return tile_pattern(quad_cell(0.5), cells_of(mask))


@pytest.mark.parametrize("n", [8, 14, 20])
def test_trimmed_patterns_obey_euler(n: int) -> None:
    mask = disk_mask(n, 0.47 * n)
    t = masked(mask)
    assert t.n_tiles == mask.sum()
    # contracted sheet: a disk of welded vertices, contracted edges and tiles
    edges = np.sort(t.weld[t.tiles.edges], axis=1)
    assert t.n_welded - len(np.unique(edges, axis=0)) + t.n_tiles == 1
    # deployed sheet: a disk with one hole per ring
    assert t.n_vertices - len(t.tiles.indices) + t.n_tiles == 1 - len(t.holes)
    assert len(t.holes) == len(t.rings)
    assert n_outer_loops(t) == 1
    assert set(t.sides) == {"outline"}


def test_a_full_mask_and_the_rectangle_are_the_same() -> None:
    t, u = masked(np.ones((6, 4), bool)), quad_pattern(3, 2, 0.5)
    for name in ("deployed", "contracted", "weld", "edge_pairs", "corners", "hinges", "outline"):
        np.testing.assert_array_equal(getattr(t, name), getattr(u, name))


def test_edge_pairs_are_copies_of_one_contracted_edge_and_share_a_hinge() -> None:
    t = quad_pattern(3, 3)
    np.testing.assert_array_equal(t.weld[t.edge_pairs[:, 0]], t.weld[t.edge_pairs[:, 1]])
    assert ((t.edge_pairs[:, 0] == t.edge_pairs[:, 1]).sum(axis=1) == 1).all()


def test_holes_lie_on_the_left_and_the_outline_goes_round() -> None:
    t = quad_pattern(3, 4, 0.6)
    areas = [polygon_area(t.deployed[hole]) for hole in t.holes]
    np.testing.assert_allclose(areas, np.sin(1.2) / 4, atol=1e-12)
    assert polygon_area(t.deployed[t.outline]) > polygon_area(t.contracted[t.outline]) > 0


def polygon_area(p: np.ndarray) -> float:
    q = np.roll(p, -1, axis=0)
    return 0.5 * float((p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]).sum())


@pytest.mark.parametrize("rotation", [0.2, 0.5, np.pi / 4])
def test_slits_open_by_twice_the_rotation(rotation: float) -> None:
    t = quad_pattern(2, 3, rotation)
    u, v = (t.deployed[t.hinges[:, k]] - t.deployed[t.hinges[:, 1]] for k in (0, 2))
    angle = np.arctan2(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0], (u * v).sum(axis=1)) % (2 * np.pi)
    np.testing.assert_allclose(angle[t.slit_ends], 2 * rotation, atol=1e-12)
    # round a hinge: two tile angles, the opening, and the other gap
    np.testing.assert_allclose(angle[~t.slit_ends], np.pi - 2 * rotation, atol=1e-12)


def test_relabeling_the_vertices_changes_names_only() -> None:
    t = quad_pattern(2, 2)
    new = np.random.default_rng(0).permutation(t.n_vertices)
    back = np.argsort(new)
    u = derive_tessellation(
        t.deployed[back], t.contracted[back], Loops(t.tiles.offsets, new[t.tiles.indices]), t.weld[back], t.cells
    )
    assert {frozenset(new[h].tolist()) for h in t.holes} == {frozenset(h.tolist()) for h in u.holes}
    assert {tuple(new[h]) for h in t.hinges} == {tuple(h) for h in u.hinges}


def test_tiles_of_opposite_orientation_are_refused() -> None:
    t = quad_pattern(1, 1)
    loops = [np.array(loop) for loop in t.tiles]
    loops[0] = loops[0][::-1]
    with pytest.raises(UnusableError, match="opposite"):
        derive_tessellation(t.deployed, t.contracted, Loops.from_lists(loops), t.weld)


@pytest.mark.parametrize("mask", [np.zeros((2, 2), bool), np.ones((2, 2, 3), bool), np.ones(4, bool)])
def test_bad_masks_are_refused(mask: np.ndarray) -> None:
    with pytest.raises(ParameterError, match="expected"):
        tile_pattern(quad_cell(), mask)


def test_sound_masks_drop_what_dangles() -> None:
    mask = np.zeros((9, 9), bool)
    mask[1:5, 1:5] = True
    mask[5, 2] = True  # dangles on one hinge
    mask[7:9, 7:9] = True  # a second, smaller piece
    mask[2, 2] = False  # a hole
    expected = np.zeros_like(mask)
    expected[1:5, 1:5] = True
    np.testing.assert_array_equal(sound_mask(mask), expected)


def test_sound_masks_have_no_corner_contacts() -> None:
    mask = np.zeros((6, 6), bool)
    mask[0:4, 0:3] = True
    mask[4:6, 3:6] = True
    found = sound_mask(mask)
    assert found.sum() == 12 and found[0:4, 0:3].all()


@pytest.mark.parametrize("seed", range(5))
def test_random_masks_become_disks(seed: int) -> None:
    rng = np.random.default_rng(seed)
    mask = sound_mask(rng.random((16, 16)) < 0.8)
    assert mask.any()
    assert n_outer_loops(masked(mask)) == 1
