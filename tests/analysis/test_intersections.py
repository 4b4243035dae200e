"""Tiles that cross are found, tiles that touch are not."""

from __future__ import annotations

import numpy as np
import pytest

from analysis.intersections import crossing_pairs
from kirisurf.loops import Loops

SQUARE = np.array([[-1.0, -1, 0], [1, -1, 0], [1, 1, 0], [-1, 1, 0]])
UPRIGHT = SQUARE[:, [0, 2, 1]]


def crossings(*tiles: np.ndarray) -> list[tuple[int, int]]:
    loops = np.split(np.arange(sum(map(len, tiles))), np.cumsum([len(tile) for tile in tiles])[:-1])
    return [(int(a), int(b)) for a, b in crossing_pairs(np.concatenate(tiles), Loops.from_lists(loops), 2.0)]


@pytest.mark.parametrize(
    ("shift", "crossed"),
    [
        ((0, 0, 0), True),
        ((1.9, 0, 0), True),
        ((0, 0, 0.999), True),
        ((0, 0, 1.0), False),  # stands on it
        ((0, 1.0, 0), False),  # touches its side with its face
        ((2.0, 0, 0), False),
        ((0, 0, 1.0 - 1e-7), False),  # within the tolerance of touching
        ((0, 0, 1.5), False),
    ],
)
def test_upright_square_against_lying_one(shift, crossed, rotation):
    one, two = SQUARE @ rotation.T, (UPRIGHT + shift) @ rotation.T
    assert crossings(one, two) == ([(0, 1)] if crossed else [])
    assert crossings(two, one) == ([(0, 1)] if crossed else [])


@pytest.mark.parametrize(
    ("shift", "crossed"),
    [((0.5, 0.5, 0), True), ((2.0, 0, 0), False), ((2.0, 2.0, 0), False), ((0, 0, 1e-3), False), ((0, 0, 0), True)],
)
def test_squares_in_parallel_planes(shift, crossed, rotation):
    assert bool(crossings(SQUARE @ rotation.T, (SQUARE + shift) @ rotation.T)) == crossed


def test_square_in_the_mouth_of_a_concave_tile_does_not_cross(rotation):
    mouth = np.array(
        [[-2.0, -2, 0], [2, -2, 0], [2, 2, 0], [1.5, 2, 0], [1.5, -1.5, 0], [-1.5, -1.5, 0], [-1.5, 2, 0], [-2, 2, 0]]
    )
    assert crossings(mouth @ rotation.T, UPRIGHT @ rotation.T) == []
    assert crossings(mouth @ rotation.T, (UPRIGHT - np.array([0, 1.7, 0])) @ rotation.T) == [(0, 1)]


def test_tiles_with_a_common_vertex_are_left_to_the_opening():
    points = np.concatenate([SQUARE, UPRIGHT[:3]])
    assert len(crossing_pairs(points, Loops.from_lists([[0, 1, 2, 3], [4, 5, 6]]), 2.0)) == 1
    assert len(crossing_pairs(points, Loops.from_lists([[0, 1, 2, 3], [0, 5, 6]]), 2.0)) == 0


def test_random_triangles_against_brute_force():
    rng = np.random.default_rng(3)
    triangles = rng.uniform(-1, 1, (60, 1, 3)) * 2 + rng.normal(size=(60, 3, 3)) * 0.6

    def pierces(one, two):
        base, sides = two[0], np.stack([two[1] - two[0], two[2] - two[0]])
        for k in range(3):
            start, end = one[k], one[(k + 1) % 3]
            x, y, t = np.linalg.solve(np.stack([*sides, start - end], axis=1), start - base)
            if x > 0 and y > 0 and x + y < 1 and 0 < t < 1:
                return True
        return False

    expected = [
        (i, j)
        for i in range(60)
        for j in range(i + 1, 60)
        if pierces(triangles[i], triangles[j]) or pierces(triangles[j], triangles[i])
    ]
    assert len(expected) > 20
    assert sorted(crossings(*triangles)) == expected
