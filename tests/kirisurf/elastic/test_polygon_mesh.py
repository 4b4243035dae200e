"""Triangles fill a polygon, keep its boundary, and are as large as they are wanted."""

from __future__ import annotations

import numpy as np
import pytest
import shapely

from kirisurf.elastic.grading import Grading
from kirisurf.elastic.polygon_mesh import polygon_mesh
from kirisurf.errors import UnusableError

SHAPES = {
    "square": [[0, 0], [1, 0], [1, 1], [0, 1]],
    "triangle": [[0, 0], [1, 0], [0.3, 0.8]],
    "mouth": [[-2, -2], [2, -2], [2, 2], [1.5, 2], [1.5, -1.5], [-1.5, -1.5], [-1.5, 2], [-2, 2]],
    "straight corner": [[0, 0], [1, 0], [2, 0], [2, 1], [0, 1]],
    "arrow": [[0, 0], [2, 1], [0, 2], [0.8, 1]],
}
UNIFORM = Grading(np.zeros((0, 2)), np.zeros(0), 0.5, 0.2)


def divided(corners: np.ndarray, grading: Grading) -> np.ndarray:
    loop = []
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        loop += [a, *(a + grading.divided(a, b)[:, None] * (b - a))]
    return np.array(loop)


def quality(points: np.ndarray, triangles: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Smallest angle in degrees, and area, of every triangle."""
    corner = points[triangles]
    angles = []
    for k in range(3):
        u, v = corner[:, (k + 1) % 3] - corner[:, k], corner[:, (k + 2) % 3] - corner[:, k]
        angles.append(np.degrees(np.arctan2(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0], (u * v).sum(axis=1))))
    u, v = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    return np.min(angles, axis=0), 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("graded", [False, True])
def test_triangles_fill_the_polygon(name, graded):
    corners = np.array(SHAPES[name], float)
    fine = Grading(corners[:2], np.array([0.01, 0.02]), 0.5, 0.4)
    boundary = divided(corners, fine if graded else UNIFORM)
    points, triangles = polygon_mesh(boundary, fine if graded else UNIFORM)
    angles, areas = quality(points, triangles)
    assert np.array_equal(points[: len(boundary)], boundary)
    assert areas.min() > 0
    assert areas.sum() == pytest.approx(shapely.Polygon(corners).area, rel=1e-12)
    # Euler's formula: a disk with all of these points has so many triangles
    assert len(triangles) == 2 * len(points) - len(boundary) - 2
    assert angles.min() > 14


def test_sizes_follow_the_grading():
    corners = np.array(SHAPES["square"], float)
    grading = Grading(corners[:1], np.array([0.01]), 0.4, 0.25)
    points, triangles = polygon_mesh(divided(corners, grading), grading)
    corner = points[triangles]
    longest = np.linalg.norm(corner - np.roll(corner, 1, axis=1), axis=2).max(axis=1)
    ratio = longest / grading.sizes(corner.mean(axis=1))
    assert ratio.min() > 0.4
    assert ratio.max() < 2.2
    assert longest.min() < 0.02


def test_a_side_is_divided_alike_from_either_end():
    grading = Grading(np.array([[0.0, 0], [0.9, 0.1]]), np.array([0.01, 0.05]), 0.5, 0.3)
    one, two = np.array([0.0, 0]), np.array([1.0, 0.2])
    assert grading.divided(one, two) == pytest.approx(1 - grading.divided(two, one)[::-1], abs=2e-3)
    pieces = np.diff(np.r_[0.0, grading.divided(one, two), 1.0]) * np.linalg.norm(two - one)
    middles = one + (np.cumsum(pieces) - 0.5 * pieces)[:, None] * (two - one) / np.linalg.norm(two - one)
    assert (pieces <= 1.15 * grading.sizes(middles)).all()


@pytest.mark.parametrize(
    "corners", [[[0, 0], [1, 1], [1, 0], [0, 1]], [[0, 0], [2, 0], [1, 0], [1, 1]], [[0, 0], [1, 0], [2, 0]]]
)
def test_polygons_that_cannot_be_filled_are_refused(corners):
    with pytest.raises(UnusableError, match="simple polygon"):
        polygon_mesh(np.array(corners, float), UNIFORM)
