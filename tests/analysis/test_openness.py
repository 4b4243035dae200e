"""Areas inside the outlines, magnification and porosity: closed forms of the regular patterns."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.distance import pdist

from analysis import polygons
from analysis.openness import largest_distance, measure_openness, tile_magnification
from analysis.rim import contracted_rim, deployed_rim
from kirisurf.pattern import tile_pattern
from kirisurf.unit_cell import quad_cell
from kirisurf.unit_cells.catalog import find_cell
from kirisurf.unit_cells.hexagon import hexagon_cell
from kirisurf.unit_cells.kagome import kagome_cell
from tests.analysis.patterns import NAMES, in_space, regular, windowed

MAKERS = {"quad": quad_cell, "kagome": kagome_cell, "hexagon": hexagon_cell}
STRETCHES = {
    "quad": lambda r: np.cos(r) + np.sin(r),
    "kagome": lambda r: np.cos(r) + np.sqrt(3) * np.sin(r),
    "hexagon": lambda r: np.cos(r) + np.sin(r) / np.sqrt(3),
}


def _shoelace(polygon: np.ndarray) -> float:
    x, y = polygon.T
    return 0.5 * float(np.sum(x * np.roll(y, -1) - y * np.roll(x, -1)))


def _measured(pattern):
    space = in_space(pattern.deployed)
    holes = np.linalg.norm(polygons.area_vectors(space, pattern.holes), axis=1)
    return (
        measure_openness(space, pattern.contracted, pattern, holes),
        tile_magnification(space, pattern.contracted, pattern, holes),
    )


@pytest.mark.parametrize("rotation", [0.1, 0.3, 0.5])
@pytest.mark.parametrize("name", MAKERS)
def test_inner_tiles_open_by_the_square_of_the_stretch(name, rotation):
    pattern = tile_pattern(MAKERS[name](rotation), np.ones((4, 4), bool))
    magnification = _measured(pattern)[1]
    inner = np.isfinite(magnification)
    assert 0.3 * pattern.n_tiles < inner.sum() < pattern.n_tiles
    assert magnification[inner] == pytest.approx(np.full(inner.sum(), STRETCHES[name](rotation) ** 2))


@pytest.mark.parametrize("name", NAMES)
def test_inner_cells_open_by_the_ratio_of_the_cells(name):
    cell = find_cell(name)
    pattern = regular(name, 6)
    magnification = _measured(pattern)[1]
    columns, rows, _ = pattern.cells.T
    middle = (columns == 3) & (rows == 3)
    assert np.isfinite(magnification[middle]).all()
    # every tile with what it is handed of the openings that stay, which a whole cell shares out
    tile = np.array([_shoelace(pattern.contracted[t]) for t in pattern.tiles])[middle]
    kept = sum(abs(_shoelace(opening)) for opening in cell.openings)
    weight = tile + kept / len(tile) if len(set(pattern.tiles.sizes)) == 1 else tile
    assert weight.sum() == pytest.approx(cell.area)
    ratio = abs(np.linalg.det(cell.deployed_shifts)) / cell.area
    assert weight @ magnification[middle] / weight.sum() == pytest.approx(ratio)


@pytest.mark.parametrize("trimmed", [False, True], ids=["whole", "trimmed"])
@pytest.mark.parametrize("name", NAMES)
def test_tiles_holes_and_notches_fill_the_outline(name, trimmed):
    pattern = regular(name, 5, trimmed)
    openness = _measured(pattern)[0]
    assert openness.enclosed == pytest.approx(_shoelace(pattern.deployed[pattern.outline]))
    assert openness.contracted == pytest.approx(_shoelace(pattern.contracted[pattern.outline]))


@pytest.mark.parametrize("n", [2, 5])
def test_finite_quad_sheet_in_closed_form(n):
    r = 0.4
    openness = _measured(tile_pattern(quad_cell(r), np.ones((n, n), bool)))[0]
    side = 2 * n
    holes = (side - 1) ** 2 * 0.25 * np.sin(2 * r)
    assert openness.contracted == pytest.approx(n**2)
    assert openness.tiles == pytest.approx(n**2)
    assert openness.holes == pytest.approx(holes)
    assert openness.porosity == pytest.approx(holes / (holes + n**2))


def test_porosity_of_large_sheets_tends_to_that_of_the_cell():
    for name, stretch in STRETCHES.items():
        r = 0.3
        solid = 1 / stretch(r) ** 2 * (2 / 3 if name == "hexagon" else 1)
        apart = [
            abs(_measured(tile_pattern(MAKERS[name](r), np.ones((n, n), bool)))[0].porosity - (1 - solid))
            for n in (5, 10, 20)
        ]
        # the rim is left out: of first order in the size of a cell
        assert np.log2(apart[0] / apart[1]) == pytest.approx(1, abs=0.2), name
        assert np.log2(apart[1] / apart[2]) == pytest.approx(1, abs=0.1), name


@pytest.mark.parametrize("name", ["quad", "hexagon", "islamic-triangle"])
def test_openness_does_not_depend_on_frame_or_scale(name, rotation):
    pattern = regular(name, 3)
    space = in_space(pattern.deployed)
    holes = np.linalg.norm(polygons.area_vectors(space, pattern.holes), axis=1)
    one = measure_openness(space, pattern.contracted, pattern, holes)
    two = measure_openness(7 * space @ rotation.T, 7 * pattern.contracted - 5.0, pattern, 49 * holes)
    for value in ("porosity", "area_magnification", "linear_magnification", "extent_magnification"):
        assert getattr(two, value) == pytest.approx(getattr(one, value))
    assert two.notches == pytest.approx(49 * one.notches)


def test_contracted_sheet_is_not_magnified():
    pattern = regular("kagome", 3)
    flat = in_space(pattern.contracted)
    openness = measure_openness(flat, pattern.contracted, pattern, np.zeros(len(pattern.holes)))
    for value in ("area_magnification", "linear_magnification", "extent_magnification"):
        assert getattr(openness, value) == pytest.approx(1)
    assert openness.porosity == 0


def test_pieces_of_the_deployed_rim_run_from_outer_vertex_to_outer_vertex():
    for name in NAMES:
        pattern = regular(name, 5, True)
        rim = deployed_rim(pattern)
        ends = np.stack([rim.indices[rim.offsets[:-1]], rim.indices[rim.offsets[1:] - 1]], axis=1)
        outline = np.stack([pattern.outline, np.roll(pattern.outline, -1)], axis=1)
        assert {tuple(e) for e in ends.tolist()} == {tuple(e) for e in outline.tolist()}, name


def test_curves_of_the_contracted_rim_turn_once_round_what_they_bound():
    pattern = windowed()
    curves, filled = contracted_rim(in_space(pattern.contracted), pattern)
    turns = sorted(float(np.sum(np.pi - filled[curve])) for curve in curves)
    assert turns == pytest.approx([-2 * np.pi] * 4 + [2 * np.pi])


@pytest.mark.parametrize("scale", [(1, 1, 1), (1, 1, 0), (1, 0, 0), (1e-6, 2e-6, 1e-6)])
def test_largest_distance_is_that_of_all_pairs(scale):
    rng = np.random.default_rng(3)
    for points in (rng.normal(size=(300, 3)), polygons.unit(rng.normal(size=(300, 3))), rng.uniform(size=(2, 3))):
        assert largest_distance(points * scale) == pytest.approx(pdist(points * scale).max(), rel=1e-12)
    assert largest_distance(np.zeros((1, 3))) == 0
