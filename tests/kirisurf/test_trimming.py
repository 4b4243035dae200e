"""Masks of tiles: sound whatever the outline and the cell, rectangles with the published counts."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from kirisurf.adjacency import adjacency
from kirisurf.derive import n_outer_loops
from kirisurf.formats import read_polygons
from kirisurf.loops import Loops
from kirisurf.pattern import tile_pattern
from kirisurf.trimming import overlap_fractions, rectangle_mask, sound_tiles
from kirisurf.unit_cell import quad_cell
from tests.kirisurf.cells import NAMES, every_cell, motion


def blob(name: str, seed: int, share: float) -> np.ndarray:
    """Tiles in a random outline: a circle with waves, some tiles left out."""
    rng = np.random.default_rng(seed)
    cell = motion(name).cell
    side = int(np.ceil(np.sqrt(240 / len(cell.tiles))))
    mask = np.ones((side, side, len(cell.tiles)), bool)
    c, r, k = np.nonzero(mask)
    centers = np.array([cell.contracted[tile].mean(axis=0) for tile in cell.tiles])
    place = centers[k] + np.stack([c, r], axis=1) @ cell.contracted_shifts
    place = place - place.mean(axis=0)
    angle = np.arctan2(place[:, 1], place[:, 0])
    waves = sum(rng.normal(0, 0.15) * np.cos(n * angle + rng.uniform(0, 6)) for n in range(1, 7))
    inside = np.linalg.norm(place, axis=1) < 0.45 * side * (1 + waves)
    mask[c, r, k] = inside & (rng.random(len(k)) < share)
    return mask


@settings(deadline=None, max_examples=60)
@given(st.sampled_from(NAMES), st.integers(0, 10**6), st.sampled_from([0.75, 0.9, 1.0]))
def test_random_outlines_become_sound_sheets(name: str, seed: int, share: float) -> None:
    found = motion(name)
    mask = sound_tiles(blob(name, seed, share), found.adjacency)
    if not mask.any():
        return
    t = tile_pattern(found.cell, mask)
    # a disk, but for what the pattern leaves open: one piece, no pinch, nothing pierced
    assert n_outer_loops(t) - (t.openings.sizes > 0).sum() == 1
    # its holes are whole holes of the endless pattern, and every tile is at one of them
    wanted = {ring.tiles.tobytes() for ring in found.adjacency.rings}
    for tiles in t.hole_tiles:
        around = t.cells[tiles]
        around = around[np.lexsort((around[:, 0], around[:, 1], around[:, 2]))]
        assert (around - [*around[0, :2], 0]).tobytes() in wanted
    assert len(np.unique(t.hole_tiles.indices)) == t.n_tiles
    np.testing.assert_array_equal(sound_tiles(mask, found.adjacency), mask)


@every_cell
def test_a_sound_part_is_as_large_as_can_be(name: str) -> None:
    """A full rectangle of an endless pattern loses no tile that is at a whole hole."""
    found = motion(name)
    mask = rectangle_mask(found.cell, found.adjacency, 4, 4)
    t = tile_pattern(found.cell, mask)
    assert sound_tiles(mask, found.adjacency).sum() == len(np.unique(t.hole_tiles.indices))


def test_a_gap_is_filled_and_an_opening_is_not() -> None:
    for name in ("kagome", "hexagon"):
        found = motion(name)
        mask = rectangle_mask(found.cell, found.adjacency, 5, 4)
        pierced = mask.copy()
        pierced[2, 2, 1] = False
        sound = sound_tiles(mask, found.adjacency)
        assert sound[2, 2, 1]
        np.testing.assert_array_equal(sound_tiles(pierced, found.adjacency), sound)


@every_cell
def test_neighbors_know_each_other(name: str) -> None:
    """Slit sides are seen from both tiles; the sides of all holes are the sides of all tiles."""
    found = motion(name).adjacency
    rows = {tuple(row) for row in found.sides.tolist()}
    assert {(b, a, -c, -r) for a, b, c, r in rows} == rows
    hinges = {tuple(row) for row in found.hinges.tolist()}
    assert {(j, b, i, a, -c, -r) for i, a, j, b, c, r in hinges} == hinges
    for fan in found.fans:
        assert len(fan.tiles) >= 2
    assert any(ring.is_open for ring in found.rings) == bool(motion(name).cell.openings)


def test_quads_have_rings_and_fans_of_four() -> None:
    found = adjacency(quad_cell())
    assert [len(ring.tiles) for ring in found.rings] == [len(fan.tiles) for fan in found.fans] == [4] * 4
    assert len(found.sides) == 16 and all(fan.joined.all() for fan in found.fans)


@every_cell
@pytest.mark.parametrize("shape", [(3, 3), (4, 2), (2, 5)])
def test_rectangles_have_the_cells_asked_for_and_one_rim(name: str, shape: tuple[int, int]) -> None:
    found = motion(name)
    mask = rectangle_mask(found.cell, found.adjacency, *shape)
    added = mask.sum() - np.prod(shape) * len(found.cell.tiles)
    assert added == 0 or found.cell.openings
    assert 0 <= added <= 2 * sum(shape) * len(found.cell.tiles)
    t = tile_pattern(found.cell, mask)
    assert n_outer_loops(t) - (t.openings.sizes > 0).sum() == 1
    # rows that are sheared are shifted back: upright, the sheet is hardly wider than its columns
    width = np.ptp(t.contracted[:, 0]) / np.linalg.norm(found.cell.contracted_shifts[0])
    assert width <= shape[0] + 1.6


# vertices of the published sheets; tiles follow from those of a cell, but for the half column of hexagons
PUBLISHED = [
    ("quad", "quad", 4, 4, 144, 64),
    ("kagome", "triangle", 3, 3, 120, 72),
    ("kagome", "triangle", 3, 4, 158, 96),
    ("kagome", "triangle", 6, 7, 530, 336),
    ("hexagon", "hexagon", 4, 2, 170, 36),
    ("islamic-quad", "islamicquad", 3, 2, 211, 48),
    ("islamic-triangle", "islamictriangle", 4, 2, 308, 48),
    ("islamic-triangle", "islamictriangle", 3, 3, 346, 54),
    ("islamic-triangle", "islamictriangle", 6, 3, 679, 108),
]


@pytest.mark.parametrize(("name", "_", "columns", "rows", "vertices", "tiles"), PUBLISHED)
def test_rectangles_have_the_published_counts(
    name: str, _: str, columns: int, rows: int, vertices: int, tiles: int
) -> None:
    found = motion(name)
    t = tile_pattern(found.cell, rectangle_mask(found.cell, found.adjacency, columns, rows))
    assert (t.n_vertices, t.n_tiles) == (vertices, tiles)


@pytest.mark.parametrize(
    ("name", "prefix"), [("quad", "quad"), ("kagome", "triangle"), ("hexagon", "hexagon"),
                         ("islamic-quad", "islamicquad"), ("islamic-triangle", "islamictriangle")]
)  # fmt: skip
def test_every_published_sheet_has_our_counts(reference: Path, name: str, prefix: str) -> None:
    files = sorted((reference / "reference" / "choi2019").glob(f"?d/{prefix}_*_deployed.obj"))
    assert files
    found = motion(name)
    for file in files:
        columns, rows = (int(part[1:]) for part in file.stem.split("_")[2:4])
        points, loops = read_polygons(file)
        t = tile_pattern(found.cell, rectangle_mask(found.cell, found.adjacency, columns, rows))
        assert (t.n_vertices, t.n_tiles) == (len(points), len(loops)), file.name
        assert sorted(t.tiles.sizes) == sorted(loops.sizes)


def test_overlaps_are_parts_of_the_polygons() -> None:
    outline = shapely.box(0, 0, 2, 2)
    corners = np.array([[1, 1], [3, 1], [3, 2], [1, 2], [0.5, 0.5], [1, 0.5], [1, 1], [5, 5], [6, 5], [6, 6]], float)
    loops = Loops.from_lists([[0, 1, 2, 3], [4, 5, 6], [7, 8, 9]])
    np.testing.assert_allclose(overlap_fractions(outline, corners, loops), [0.5, 1, 0], atol=1e-12)
