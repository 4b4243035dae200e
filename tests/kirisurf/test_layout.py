"""Laid starts of every tessellation: exact where the target is flat, of second order where it is curved."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.distance import pdist

import sample_surfaces
from kirisurf.layout import Layout
from kirisurf.motion import motion_of
from kirisurf.opening import planned_range
from kirisurf.pattern import tile_pattern
from kirisurf.spec import FitSpec
from kirisurf.start import make_start
from kirisurf.surface import Surface
from kirisurf.tessellation import Tessellation
from kirisurf.unit_cells import catalog
from tests.kirisurf.cells import motion

NAMES = [entry.name for entry in catalog()]
SIMILAR = [name for name in NAMES if name != "rotating-rectangles" and not name.startswith("islamic")]
every_name = pytest.mark.parametrize("name", NAMES)


def square(n: int = 12) -> Surface:
    x, y = np.meshgrid(np.linspace(0, 2, n), np.linspace(0, 2, n), indexing="ij")
    k = np.arange(n * n).reshape(n, n)
    a, b, c, d = k[:-1, :-1].ravel(), k[1:, :-1].ravel(), k[1:, 1:].ravel(), k[:-1, 1:].ravel()
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    return Surface.from_arrays(np.stack([x, y, 0 * x], axis=-1).reshape(-1, 3), faces, "square")


def laid(surface: Surface, name: str, **options: object) -> Layout:
    layout = make_start(surface, FitSpec(target=surface.name, tessellation=name, **options)).layout
    assert layout is not None
    return layout


def edge_mismatch(layout: Layout) -> np.ndarray:
    """Difference of the two copies of every slit edge, over the median edge."""
    sides = layout.points[layout.tessellation.edge_pairs]
    length = np.linalg.norm(sides[:, :, 1] - sides[:, :, 0], axis=-1)
    return np.abs(length[:, 0] - length[:, 1]) / np.median(length)


def areas(tessellation: Tessellation, points: np.ndarray) -> np.ndarray:
    result = []
    for tile in tessellation.tiles:
        p, q = points[tile], points[np.roll(tile, -1)]
        result.append(0.5 * (p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]).sum())
    return np.array(result)


@pytest.mark.parametrize("how", [{"cells": (3, 2)}, {"tiles": 60}], ids=["cells", "tiles"])
@every_name
def test_on_a_flat_square_lies_the_regular_pattern(name: str, how: dict) -> None:
    """Uniformly opened, on a map that is a similarity, the start is a state of the motion at another size."""
    layout = laid(square(), name, opening=45.0, **({"initial": "conformal"} if "cells" in how else {}), **how)
    found = motion(name)
    way = 1.0 if found.snaps else 0.5
    assert np.ptp(layout.way) < 1e-7
    state = tile_pattern(found.state(way), layout.placement.mask)
    assert state.n_vertices == len(layout.points)
    np.testing.assert_allclose(layout.points[:, 2], 0, atol=1e-12)
    expected, distances = pdist(state.deployed), pdist(layout.points)
    scale = distances.sum() / expected.sum()
    np.testing.assert_allclose(distances, scale * expected, atol=1e-7 * distances.max())
    assert edge_mismatch(layout).max() < 1e-7


@pytest.mark.parametrize("target", ["dome", "peaks"])
@pytest.mark.parametrize("how", [{"cells": (3, 3)}, {"tiles": 150}], ids=["cells", "tiles"])
@every_name
def test_no_tile_is_turned_over(name: str, how: dict, target: str) -> None:
    layout = laid(sample_surfaces.load(target, resolution=24), name, **how)
    assert areas(layout.tessellation, layout.laid).min() > 0
    assert layout.points.shape == (layout.tessellation.n_vertices, 3)
    assert np.isfinite(layout.points).all()


@pytest.mark.parametrize("name", SIMILAR)
def test_slit_edges_agree_the_better_the_smaller_the_tiles(name: str) -> None:
    """Inside of the range that the pattern gives the mismatch falls with the side of the tiles, here to a quarter."""
    surface = sample_surfaces.load("hypar", resolution=120)
    flat = Surface.from_arrays(surface.vertices * [1, 1, 0.5], surface.faces, "flat")
    mismatch = [np.median(edge_mismatch(laid(flat, name, tiles=tiles, orientation=0.0))) for tiles in (100, 1600)]
    assert mismatch[0] < 0.01
    assert mismatch[1] < 0.35 * mismatch[0]


@pytest.mark.parametrize("name", NAMES)
def test_the_number_of_tiles_is_about_the_one_asked_for(name: str) -> None:
    for target, tiles in (("dome", 300), ("saddle_roof", 120)):
        layout = laid(sample_surfaces.load(target, resolution=24), name, tiles=tiles)
        assert abs(layout.placement.n_tiles - tiles) <= 0.07 * tiles + 4
        assert layout.placement.overlap > 0.8


@every_name
def test_rectangles_reach_to_the_sides_of_a_square(name: str) -> None:
    """The deployed outline follows the four sides where the pattern is stretched to them."""
    layout = laid(square(), name, cells=(3, 3), initial="teichmuller")
    low, high = layout.laid.min(axis=0), layout.laid.max(axis=0)
    size = np.ptp(layout.flattening.uv, axis=0)
    corner = layout.flattening.uv.min(axis=0)
    # an inset of a hundredth, and tiles that open less than the middle of the plan
    np.testing.assert_allclose(low - corner, 0, atol=0.04 * size.max())
    np.testing.assert_allclose(corner + size - high, 0, atol=0.04 * size.max())


@pytest.mark.parametrize("name", NAMES)
def test_a_coarser_layout_covers_the_same_place(name: str) -> None:
    for how in ({"cells": (8, 6)}, {"tiles": 800}):
        fine = laid(sample_surfaces.load("dome", resolution=24), name, **how)
        coarse = fine.coarser()
        assert coarse is not None
        assert coarse.tessellation.n_tiles == pytest.approx(fine.tessellation.n_tiles / 4, rel=0.2)
        reach = [np.r_[layout.laid.min(axis=0), layout.laid.max(axis=0)] for layout in (coarse, fine)]
        assert np.abs(reach[0] - reach[1]).max() <= 1.5 * fine.spacing
        assert areas(coarse.tessellation, coarse.laid).min() > 0


def test_plans_stay_inside_of_what_the_pattern_gives() -> None:
    for entry in catalog():
        found = motion_of(entry.cell())
        least, most = planned_range(found)
        assert 1 < least <= most <= found.most
        assert (least == most) == found.snaps
