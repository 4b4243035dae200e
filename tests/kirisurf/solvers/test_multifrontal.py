import gc

import numpy as np
import pytest
from scipy.spatial import Delaunay

from kirisurf.solvers import dense_front, elimination_tree, symbolic
from kirisurf.solvers.multifrontal import Cholesky
from kirisurf.solvers.symbolic import Symbolic


def matrix_on(n, pairs, seed=0):
    """Return rows, columns, blocks and the dense form of a random positive definite matrix on a graph."""
    rng = np.random.default_rng(seed)
    pairs = np.unique(np.sort(np.asarray(pairs, dtype=np.int64).reshape(-1, 2), axis=1), axis=0)
    dense = np.zeros((n, 3, n, 3))
    for a, b in pairs:
        dense[a, :, b] = rng.standard_normal((3, 3))
        dense[b, :, a] = dense[a, :, b].T
    dense[np.arange(n), :, np.arange(n)] = 0.0
    weight = np.abs(dense).sum(axis=(2, 3))
    for v in range(n):
        tilt = 0.3 * rng.standard_normal((3, 3))
        dense[v, :, v] = np.diag(weight[v] + 1.0) + tilt @ tilt.T
    pairs = rng.permuted(pairs, axis=1)
    rows = np.concatenate([np.arange(n), pairs[:, 0]])
    columns = np.concatenate([np.arange(n), pairs[:, 1]])
    shuffle = rng.permutation(len(rows))
    rows, columns = rows[shuffle], columns[shuffle]
    return rows, columns, dense[rows, :, columns], dense.reshape(3 * n, 3 * n)


def planar(n, seed=0, rings=1):
    points = np.random.default_rng(seed).random((n, 2))
    triangles = Delaunay(points).simplices
    near = np.zeros((n, n))
    near[triangles[:, [0, 1, 2]].ravel(), triangles[:, [1, 2, 0]].ravel()] = 1.0
    near = near + near.T + np.eye(n)
    return np.argwhere(np.triu(np.linalg.matrix_power(near, rings), 1))


def two_pieces():
    first = planar(40, seed=3)
    return np.concatenate([first, planar(30, seed=4) + 40])


CASES = {
    "one vertex": (1, []),
    "two vertices": (2, [(0, 1)]),
    "no edges": (7, []),
    "chain": (60, [(i, i + 1) for i in range(59)]),
    "arrow": (80, [(i, 79) for i in range(79)]),
    "dense": (70, [(i, j) for i in range(70) for j in range(i)]),
    "planar": (300, planar(300)),
    "planar, two rings": (400, planar(400, rings=2)),
    "disconnected": (72, two_pieces()),  # and two vertices alone
}


@pytest.mark.parametrize("name", CASES)
def test_agrees_with_a_dense_factorization(name):
    n, pairs = CASES[name]
    rows, columns, blocks, dense = matrix_on(n, pairs)
    cholesky = Cholesky(Symbolic(n, rows, columns), blocks)
    for right in (np.random.default_rng(1).random(3 * n), np.random.default_rng(2).random((3 * n, 4))):
        kept = right.copy()
        solution = cholesky.solve(right)
        assert solution.shape == right.shape
        np.testing.assert_array_equal(right, kept)
        np.testing.assert_allclose(solution, np.linalg.solve(dense, right), rtol=1e-10, atol=1e-13)
    np.testing.assert_allclose(cholesky.log_determinant, np.linalg.slogdet(dense)[1], rtol=1e-12)


@pytest.mark.parametrize("name", CASES)
def test_raises_just_beyond_the_smallest_eigenvalue(name):
    n, pairs = CASES[name]
    rows, columns, blocks, dense = matrix_on(n, pairs)
    smallest = np.linalg.eigvalsh(dense)[0]
    found = Symbolic(n, rows, columns)
    diagonal = (rows == columns)[:, None, None] * np.eye(3)
    Cholesky(found, blocks - 0.999 * smallest * diagonal)
    with pytest.raises(np.linalg.LinAlgError, match="not positive definite"):
        Cholesky(found, blocks - 1.001 * smallest * diagonal)
    Cholesky(found, blocks)  # a failure leaves nothing behind


@pytest.mark.parametrize("name", ["one vertex", "planar"])
def test_refuses_numbers_that_are_none(name):
    rows, columns, blocks, _ = matrix_on(*CASES[name])
    blocks[len(blocks) // 2, 1, 1] = np.nan
    with pytest.raises(np.linalg.LinAlgError):
        Cholesky(Symbolic(CASES[name][0], rows, columns), blocks)


def test_a_factor_outlives_the_next_factorization_and_repeats_to_the_bit():
    n, pairs = CASES["planar, two rings"]
    rows, columns, blocks, _ = matrix_on(n, pairs)
    found = Symbolic(n, rows, columns)
    right = np.random.default_rng(1).random(3 * n)
    first = Cholesky(found, blocks)
    solution = first.solve(right)
    Cholesky(found, 2.0 * blocks)
    np.testing.assert_array_equal(first.solve(right), solution)
    again = Cholesky(Symbolic(n, rows, columns), blocks)
    np.testing.assert_array_equal(again.solve(right), solution)


def test_statistics_are_those_of_the_factor():
    n = 70
    rows, columns, _, _ = matrix_on(*CASES["dense"])
    found = Symbolic(n, rows, columns)
    assert found.n_fronts == 1
    assert found.n_nonzeros == 210 * 211 // 2
    assert found.factor_bytes == 8 * 210 * 210
    assert found.n_flops == pytest.approx(210**3 / 3)
    assert found.stack_bytes == 0


@pytest.fixture
def cut_small(monkeypatch):
    """Cut small fronts as large ones are cut, and share them as those of large matrices are shared."""
    for name, size in {"_BLOCK": 15, "_STRIP": 6, "_HEIGHT": 12, "_TILE": 12}.items():
        monkeypatch.setattr(dense_front, name, size)
    monkeypatch.setattr(elimination_tree, "_FRONT_SECONDS", 1e-6)
    monkeypatch.setattr(symbolic, "_SHARED_FLOPS", 0.0)
    monkeypatch.setattr(symbolic, "n_cores", lambda: 2)


@pytest.mark.parametrize("name", CASES)
def test_pieces_add_up_to_the_same_factor(cut_small, name):
    n, pairs = CASES[name]
    rows, columns, blocks, dense = matrix_on(n, pairs)
    cholesky = Cholesky(Symbolic(n, rows, columns), blocks)
    right = np.random.default_rng(1).random(3 * n)
    np.testing.assert_allclose(cholesky.solve(right), np.linalg.solve(dense, right), rtol=1e-10, atol=1e-13)
    np.testing.assert_allclose(cholesky.log_determinant, np.linalg.slogdet(dense)[1], rtol=1e-12)


def test_two_threads_repeat_what_one_does_to_the_bit(cut_small):
    n, pairs = CASES["planar, two rings"]
    rows, columns, blocks, _ = matrix_on(n, pairs)
    shared, alone = Symbolic(n, rows, columns), Symbolic(n, rows, columns)
    alone.n_workers = 1
    assert shared.n_workers == 2 and len(shared.subtrees) >= 8 and shared.top
    right = np.random.default_rng(1).random(3 * n)
    expected = Cholesky(alone, blocks).solve(right)
    for _ in range(20):
        np.testing.assert_array_equal(Cholesky(shared, blocks).solve(right), expected)


def test_every_front_is_in_one_subtree_or_above_all(cut_small):
    n, pairs = CASES["planar, two rings"]
    rows, columns, _, _ = matrix_on(n, pairs)
    found = Symbolic(n, rows, columns)
    inside = [i for first, last in found.subtrees for i in range(first, last + 1)]
    assert sorted(inside + found.top) == list(range(found.n_fronts))
    for first, last in found.subtrees:
        assert all(first <= child < i for i in range(first, last + 1) for child in found.children[i])


def test_storage_serves_the_next_factor_once_nobody_holds_it(cut_small):
    n, pairs = CASES["planar"]
    rows, columns, blocks, _ = matrix_on(n, pairs)
    found = Symbolic(n, rows, columns)
    kept, gone = Cholesky(found, blocks), Cholesky(found, blocks)
    place = gone._panels[0].__array_interface__["data"]
    del gone
    again = Cholesky(found, blocks)
    assert again._panels[0].__array_interface__["data"] == place
    assert kept._panels[0].__array_interface__["data"] != place


def test_a_failure_returns_its_storage_at_once(cut_small):
    n, pairs = CASES["planar"]
    rows, columns, blocks, _ = matrix_on(n, pairs)
    found = Symbolic(n, rows, columns)
    gc.disable()
    try:
        for _ in range(2):
            with pytest.raises(np.linalg.LinAlgError):
                Cholesky(found, -blocks)
            assert len(found._spare) == 1
    finally:
        gc.enable()
