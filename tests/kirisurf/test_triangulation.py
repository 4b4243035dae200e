"""Triangulated polygons: counts, areas, orientation, and the largest smallest angle by brute force."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from kirisurf.errors import UnusableError
from kirisurf.triangulation import TriangulatedTiles, polygon_triangles
from tests.kirisurf.both_states import NAMES, regular


def area(corners: np.ndarray) -> np.ndarray:
    u, v = corners[..., 1, :] - corners[..., 0, :], corners[..., 2, :] - corners[..., 0, :]
    return 0.5 * (u[..., 0] * v[..., 1] - u[..., 1] * v[..., 0])


def smallest_angle(corners: np.ndarray) -> float:
    sides = np.roll(corners, -1, axis=-2) - corners
    before = -np.roll(sides, 1, axis=-2)
    cosines = (sides * before).sum(-1) / np.linalg.norm(sides, axis=-1) / np.linalg.norm(before, axis=-1)
    return float(np.arccos(np.clip(cosines, -1, 1)).min())


def triangulations(first: int, last: int) -> list[list[tuple[int, int, int]]]:
    """All of the polygon of corners first ... last."""
    if last - first < 2:
        return [[]]
    return [
        [(first, m, last), *left, *right]
        for m in range(first + 1, last)
        for left in triangulations(first, m)
        for right in triangulations(m, last)
    ]


def star_shaped(k: int, seed: int) -> np.ndarray:
    rng = np.random.default_rng(seed)
    angle = np.sort((np.arange(k) + rng.uniform(0, 0.8, k)) * 2 * np.pi / k)
    return rng.uniform(0.4, 1.0, k)[:, None] * np.stack([np.cos(angle), np.sin(angle)], axis=1)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("k", range(3, 9))
def test_polygons_are_filled_and_no_other_way_has_a_larger_smallest_angle(k: int, seed: int) -> None:
    corners = star_shaped(k, seed)
    polygon = shapely.Polygon(corners)
    triangles, diagonals = polygon_triangles(corners)
    assert triangles.shape == (k - 2, 3) and diagonals.shape == (k - 3, 4)
    assert area(corners[triangles]).min() > 0
    assert area(corners[triangles]).sum() == pytest.approx(polygon.area)
    turned_over = [t for t in triangulations(0, k - 1) if area(corners[np.array(t)]).min() > 1e-12]
    best = max(smallest_angle(corners[np.array(t)]) for t in turned_over)
    assert smallest_angle(corners[triangles]) == pytest.approx(best, abs=1e-8)


@pytest.mark.parametrize("name", NAMES)
def test_tiles_of_every_cell(name: str) -> None:
    tessellation = regular(name)
    found = TriangulatedTiles.of(tessellation)
    sizes = tessellation.tiles.sizes
    assert len(found.triangles) == (sizes - 2).sum() and len(found.diagonals) == (sizes - 3).sum()
    covered = area(tessellation.contracted[found.triangles])
    assert covered.min() > 1e-3 * covered.max()
    assert covered.sum() == pytest.approx(
        sum(shapely.Polygon(tessellation.contracted[t]).area for t in tessellation.tiles)
    )
    # two triangles meet along every diagonal, each of them once
    triples = {tuple(sorted(t)) for t in found.triangles.tolist()}
    for a, b, c, e in found.diagonals.tolist():
        assert {tuple(sorted((a, b, c))), tuple(sorted((a, c, e)))} <= triples
        assert area(tessellation.contracted[[[a, b, c], [a, c, e]]]).prod() > 0
    ends = {tuple(sorted(d)) for d in found.diagonals[:, [0, 2]].tolist()}
    assert len(ends) == len(found.diagonals)


@pytest.mark.parametrize(
    "corners",
    [
        [(0, 0), (1, 1), (1, 0), (0, 1)],
        [(0, 0), (0, 1), (1, 1), (1, 0)],
        [(0, 0), (1, 0), (2, 0), (3, 0)],
        [(0, 0), (4, 0), (1, 3), (2, -2), (3, 3)],
    ],
    ids=["crossing", "clockwise", "without area", "star that crosses itself"],
)
def test_what_is_no_simple_polygon_is_refused(corners: list[tuple[float, float]]) -> None:
    with pytest.raises(UnusableError, match="simple polygon"):
        polygon_triangles(np.array(corners, float))
