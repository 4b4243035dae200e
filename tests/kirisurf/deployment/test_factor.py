"""Factors of indefinite matrices, held against dense ones."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csc_matrix, triu

from kirisurf.deployment.factor import Factors


def ring(n: int, seed: int) -> np.ndarray:
    """A symmetric matrix, neither positive nor negative, on a pattern of neighbors."""
    chance = np.random.default_rng(seed)
    off = chance.uniform(-1, 1, (n, n)) * (np.abs(np.subtract.outer(np.arange(n), np.arange(n))) % (n - 2) == 1)
    return np.triu(off, 1) + np.triu(off, 1).T + np.diag(chance.uniform(-3, 3, n))


def upper(matrix: np.ndarray) -> csc_matrix:
    return csc_matrix(triu(csc_matrix(matrix)))


@pytest.mark.parametrize("n", [4, 17, 60])
def test_solves_and_signs_are_those_of_the_matrix(n: int) -> None:
    factors = Factors()
    for seed in range(5):  # on one pattern
        matrix = ring(n, seed)
        factor = factors.of(upper(matrix))
        assert factor.n_negative == (np.linalg.eigvalsh(matrix) < 0).sum()
        right = np.random.default_rng(seed).standard_normal((n, 3))
        np.testing.assert_allclose(matrix @ factor.solve(right), right, atol=1e-9 * np.linalg.cond(matrix))
        np.testing.assert_array_equal(factor.solve(right[:, 1]), factor.solve(right)[:, 1])


def test_a_factor_ends_with_the_next() -> None:
    factors = Factors()
    first = factors.of(upper(ring(9, 0)))
    second = factors.of(upper(ring(9, 1)))
    with pytest.raises(RuntimeError, match="the last one"):
        first.solve(np.ones(9))
    assert np.isfinite(second.solve(np.ones(9))).all()


def test_a_pivot_of_zero_is_told() -> None:
    factors, good = Factors(), np.diag([1.0, -2.0, 3.0])
    bad = np.diag([1.0, 0.0, 3.0])
    pattern = csc_matrix(np.eye(3))

    def on_pattern(matrix: np.ndarray) -> csc_matrix:
        return csc_matrix((np.diag(matrix).copy(), pattern.indices, pattern.indptr), shape=(3, 3))

    assert factors.of(on_pattern(bad)).n_negative == -1  # at first
    assert factors.of(on_pattern(good)).n_negative == 1
    failed = factors.of(on_pattern(bad))  # and later
    assert failed.n_negative == -1
    assert factors.of(on_pattern(good)).n_negative == 1
    assert factors.of(on_pattern(np.diag([1.0, np.nan, 3.0]))).n_negative == -1
