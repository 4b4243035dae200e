"""Triangles of a polygon: the same area, the same side, the same corners; the same under motion and scaling."""

from __future__ import annotations

import numpy as np
import pytest

from kirisurf.formats.triangulation import cut_ears, triangulated
from kirisurf.loops import Loops


def _areas(points: np.ndarray, faces: np.ndarray) -> np.ndarray:
    a, b, c = (points[faces[:, k]] for k in range(3))
    return np.cross(b - a, c - a) / 2


def _newell(points: np.ndarray) -> np.ndarray:
    return np.cross(points, np.roll(points, -1, axis=0)).sum(axis=0) / 2


def _comb(teeth: int) -> np.ndarray:
    top = [(x, 3.0 if x % 2 else 1.0) for x in range(2 * teeth, -1, -1)]
    return np.array([(0, 0, 0), (2 * teeth, 0, 0), *[(x, y, 0) for x, y in top]], dtype=float)


def _spiral(turns: int) -> np.ndarray:
    t = np.linspace(0.5, turns, 60) * 2 * np.pi
    outer = np.stack([t * np.cos(t), t * np.sin(t), 0 * t], axis=1)
    return np.concatenate([outer, 0.85 * outer[::-1]])


SHAPES = {
    "arrow": np.array([[0, 0, 0], [1, 1, 0], [0, 3, 0], [-1, 1, 0]]) * [1, -1, 1] + [0, 5, 0],
    "dart": np.array([[2, 0, 0], [0, 2, 0], [0.5, 0.5, 0], [0, 0, 0]], dtype=float),
    "L": np.array([[0, 0, 0], [2, 0, 0], [2, 1, 0], [1, 1, 0], [1, 2, 0], [0, 2, 0]], dtype=float),
    "collinear": np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [2, 1, 0], [0, 1, 0]], dtype=float),
    "comb": _comb(7),
    "spiral": _spiral(3),
}


@pytest.mark.parametrize("name", SHAPES)
@pytest.mark.parametrize("start", [0, 1, 2])
def test_ears_cover_the_polygon_once(name: str, start: int) -> None:
    points = np.roll(SHAPES[name].astype(float), start, axis=0)
    faces, crossed = triangulated(points, Loops.from_lists([range(len(points))]))
    whole = _newell(points)
    parts = _areas(points, faces)
    assert crossed == 0 and len(faces) == len(points) - 2
    assert (parts @ whole > 0).all()
    assert np.linalg.norm(parts, axis=1).sum() == pytest.approx(np.linalg.norm(whole), rel=1e-12)


@pytest.mark.parametrize("name", SHAPES)
def test_motion_and_scale_change_no_triangle(name: str) -> None:
    points = SHAPES[name].astype(float)
    loops = Loops.from_lists([range(len(points))])
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(3, 3)))[0]
    turn *= np.sign(np.linalg.det(turn))
    faces, _ = triangulated(points, loops)
    for scale in (1e-6, 1.0, 1e6):
        moved = scale * (points @ turn.T) + scale * np.array([3.0, -2, 5])
        assert np.array_equal(triangulated(moved, loops)[0], faces)


def test_a_square_becomes_the_fan_of_its_first_corner() -> None:
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], dtype=float)
    assert triangulated(points, Loops.from_lists([[2, 3, 0, 1]]))[0].tolist() == [[2, 3, 0], [2, 0, 1]]


def test_order_of_mixed_polygons_is_kept() -> None:
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [2, 0, 0]], dtype=float)
    faces, _ = triangulated(points, Loops.from_lists([[0, 1, 2, 3], [1, 4, 2], [3, 2], [0, 1, 4, 2, 3]]))
    assert faces[:3].tolist() == [[0, 1, 2], [0, 2, 3], [1, 4, 2]] and len(faces) == 6


def test_crossing_sides_are_counted_and_still_give_a_fan() -> None:
    bow = np.array([[0, 0, 0], [1, 1, 0], [1, 0, 0], [0, 1, 0]], dtype=float)
    faces, crossed = triangulated(bow, Loops.from_lists([[0, 1, 2, 3]]))
    assert crossed == 1 and len(faces) == 2
    assert cut_ears(np.zeros((4, 3))) is None


def test_a_thousand_corners_take_no_time() -> None:
    comb = _comb(500)
    faces, crossed = triangulated(comb, Loops.from_lists([range(len(comb))]))
    assert crossed == 0 and np.linalg.norm(_areas(comb, faces), axis=1).sum() == pytest.approx(
        np.linalg.norm(_newell(comb))
    )
