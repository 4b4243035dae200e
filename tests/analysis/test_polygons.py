"""Normals, angles, areas and triangles of polygons in space."""

from __future__ import annotations

import numpy as np
import pytest

from analysis import polygons
from kirisurf.loops import Loops

ELL = np.array([[0.0, 0], [2, 0], [2, 1], [1, 1], [1, 2], [0, 2]])
STAR = (
    np.stack([np.cos(np.arange(10) * np.pi / 5), np.sin(np.arange(10) * np.pi / 5)], 1) * np.tile([1, 0.4], 5)[:, None]
)


@pytest.mark.parametrize(("polygon", "area"), [(ELL, 3.0), (STAR, 5 * 0.4 * np.sin(np.pi / 5))])
def test_angles_areas_and_triangles_of_non_convex_polygons(polygon, area, rotation):
    points = np.pad(polygon, ((0, 0), (0, 1))) @ rotation.T + 3.0
    loops = Loops.from_lists([np.arange(len(points))])
    k = len(points)
    angles = polygons.corner_angles(points, loops)
    assert angles.sum() == pytest.approx((k - 2) * np.pi)
    assert (angles > np.pi).sum() == (1 if k == 6 else 5)
    assert polygons.normals(points, loops)[0] == pytest.approx(rotation[:, 2])
    assert np.linalg.norm(polygons.area_vectors(points, loops)) == pytest.approx(area)
    triangles, owners = polygons.triangles(points, loops)
    assert len(triangles) == k - 2
    assert not owners.any()
    vectors = polygons.newell(points[triangles])
    # no triangle faces backwards, so none lies outside
    assert (vectors @ rotation[:, 2] > 0).all()
    assert vectors.sum(axis=0) == pytest.approx(area * rotation[:, 2])


def test_straight_corner_counts_as_pi():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]])
    angles = polygons.corner_angles(points, Loops.from_lists([np.arange(5)]))
    assert angles == pytest.approx(np.array([0.5, 1, 0.5, 0.5, 0.5]) * np.pi)


def test_sizes_may_be_mixed():
    points = np.array([[0.0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [3, 0, 0]])
    loops = Loops.from_lists([[0, 1, 2, 3], [1, 4, 2]])
    assert polygons.area_vectors(points, loops)[:, 2] == pytest.approx([1.0, 1.0])
    assert polygons.edge_lengths(points, loops) == pytest.approx([1, 1, 1, 1, 2, np.sqrt(5), 1])
    assert len(polygons.triangles(points, loops)[0]) == 3
