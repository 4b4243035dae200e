from itertools import pairwise

import numpy as np
import pytest

from kirisurf.solvers.dense_front import elimination, tile_marks, tiles_in


@pytest.mark.parametrize(("k", "m"), [(3, 0), (3, 3), (60, 150), (201, 0), (390, 1200), (600, 6)])
def test_elimination_against_numpy(k, m):
    rng = np.random.default_rng(0)
    columns = rng.standard_normal((k + m, k))
    columns[:k] = columns[:k] @ columns[:k].T + k * np.eye(k)
    panel = np.asfortranarray(columns)
    panel[:k][np.triu_indices(k, 1)] = np.nan  # the upper half is nobody's
    tiles = tiles_in(np.full(m * m, np.nan), tile_marks(m))
    for tasks in elimination(panel, tiles):
        for task in reversed(tasks):  # in any order
            task()
    factor = np.linalg.cholesky(columns[:k])
    lower = np.linalg.solve(factor, columns[k:].T).T
    np.testing.assert_allclose(np.tril(panel[:k]), factor, rtol=1e-9, atol=1e-9)
    np.testing.assert_allclose(panel[k:], lower, rtol=1e-9, atol=1e-9)
    marks = tile_marks(m)
    assert len(tiles) == len(marks) - 1
    for first, tile in zip(marks, tiles, strict=False):
        width = tile.shape[1]
        expected = -lower[first:] @ lower[first : first + width].T
        np.testing.assert_allclose(np.tril(tile), np.tril(expected), rtol=1e-9, atol=1e-9)


@pytest.mark.parametrize("m", [0, 3, 384, 900, 4002])
def test_tiles_are_a_staircase_without_gaps(m):
    marks = tile_marks(m)
    assert marks[0] == 0 and marks[-1] == m and all(mark % 3 == 0 for mark in marks)
    memory = np.arange(float(m * m))
    tiles = tiles_in(memory, marks)
    assert [tile.shape for tile in tiles] == [(m - a, b - a) for a, b in pairwise(marks)]
    every = np.concatenate([tile.T.ravel() for tile in tiles])
    np.testing.assert_array_equal(every, memory[: len(every)])
    assert len(every) <= m * m
