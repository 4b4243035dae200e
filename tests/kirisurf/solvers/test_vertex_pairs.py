"""Sums of blocks on the sparsity pattern against dense matrices."""

from __future__ import annotations

import numpy as np
import pytest

from kirisurf.solvers.vertex_pairs import BlockSum, Stencil, VertexPairs


def random_blocks(rng: np.random.Generator, stencil: Stencil) -> np.ndarray:
    if isinstance(stencil, tuple):
        rows, columns = stencil
        return rng.standard_normal((len(rows), 3 * rows.shape[1], 3 * columns.shape[1]))
    blocks = rng.standard_normal((len(stencil), 3 * stencil.shape[1], 3 * stencil.shape[1]))
    return blocks + np.swapaxes(blocks, 1, 2)


def dense_sum(n: int, stencils: list[Stencil], sources: list[np.ndarray | None]) -> np.ndarray:
    """Add up number by number."""
    total = np.zeros((3 * n, 3 * n))
    for stencil, source in zip(stencils, sources, strict=True):
        if source is None:
            continue
        rows, columns = stencil if isinstance(stencil, tuple) else (stencil, stencil)
        for group, block in enumerate(source):
            r = (3 * rows[group][:, None] + np.arange(3)).ravel()
            c = (3 * columns[group][:, None] + np.arange(3)).ravel()
            np.add.at(total, (r[:, None], c[None, :]), block)
            if isinstance(stencil, tuple):
                np.add.at(total, (c[:, None], r[None, :]), block.T)
    return total


@pytest.mark.parametrize("seed", range(5))
def test_sums_equal_the_dense_ones(seed: int) -> None:
    """Vertices repeat within a group, meet themselves across a pair, and two sources have one stencil."""
    rng = np.random.default_rng(seed)
    n = 7
    stencils: list[Stencil] = [
        rng.integers(0, n, (9, 4)),
        (rng.integers(0, n, (6, 2)), rng.integers(0, n, (6, 3))),
        rng.permuted(np.tile(np.arange(n), (5, 1)), axis=1)[:, :3],
        np.arange(n)[:, None],
        np.zeros((0, 2), np.int64),
        rng.integers(0, n, (4, 2)),
    ]
    stencils += [np.array(stencils[0]), (stencils[1][0].copy(), stencils[1][1].copy())]
    pairs = VertexPairs(n, stencils)
    total = BlockSum(pairs, stencils)
    for missing in ([], [0], [6, 1, 7]):  # the workspace holds nothing of the sum before
        sources = [None if i in missing else random_blocks(rng, s) for i, s in enumerate(stencils)]
        expected = dense_sum(n, stencils, sources).reshape(n, 3, n, 3)
        np.testing.assert_allclose(total.sum(sources), expected[pairs.rows, :, pairs.columns], atol=1e-13)
        expected[pairs.rows, :, pairs.columns] = expected[pairs.columns, :, pairs.rows] = 0.0
        assert not expected.any()


def test_pairs_are_the_upper_half_in_order_with_the_whole_diagonal() -> None:
    pairs = VertexPairs(5, [np.array([[3, 0]]), (np.array([[4]]), np.array([[1]]))])
    expected = [(0, 0), (0, 3), (1, 1), (1, 4), (2, 2), (3, 3), (4, 4)]
    assert list(zip(pairs.rows.tolist(), pairs.columns.tolist(), strict=True)) == expected
    np.testing.assert_array_equal(pairs.pointers, np.searchsorted(pairs.rows, np.arange(6)))
    np.testing.assert_array_equal(pairs.find(pairs.rows, pairs.columns), np.arange(len(pairs)))


def test_a_source_too_few_is_refused() -> None:
    stencils: list[Stencil] = [np.array([[0, 1]]), np.array([[1, 2]])]
    total = BlockSum(VertexPairs(3, stencils), stencils)
    with pytest.raises(ValueError, match="shorter"):
        total.sum([np.ones((1, 6, 6))])


def test_a_pattern_of_nothing_is_the_diagonal() -> None:
    pairs = VertexPairs(2, [])
    np.testing.assert_array_equal(BlockSum(pairs, []).sum([]), np.zeros((2, 3, 3)))
