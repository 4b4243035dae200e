import numpy as np
import pytest

from kirisurf.solvers import blas

RNG = np.random.default_rng(0)


def inside(m, n):
    """Return an (m, n) view in the middle of a larger Fortran-ordered array of random numbers, and the array."""
    outer = np.asfortranarray(RNG.standard_normal((m + 5, n + 4)))
    return outer[2 : m + 2, 1 : n + 1], outer


def changed(view, outer, before):
    """Did anything outside the view change?"""
    rest = outer - before
    rest[2 : view.shape[0] + 2, 1 : view.shape[1] + 1] = 0.0
    return bool(rest.any())


@pytest.mark.parametrize(("m", "n", "k"), [(1, 1, 1), (7, 4, 3), (30, 1, 20), (1, 9, 2)])
@pytest.mark.parametrize("fresh", [False, True])
def test_products(m, n, k, fresh):
    a, b, (c, outer) = inside(m, k)[0], inside(n, k)[0], inside(m, n)
    before = outer.copy()
    expected = (0.0 if fresh else c) - a @ b.T
    if fresh:
        c[0, 0] = before[2, 1] = np.nan  # what was there counts as zero, whatever it was
    blas.subtract_product(a, b, c, fresh)
    np.testing.assert_allclose(c, expected, atol=1e-13)
    before[2, 1] = 0.0
    assert not changed(c, outer, before)


@pytest.mark.parametrize(("m", "k"), [(1, 1), (9, 4), (3, 30)])
@pytest.mark.parametrize("fresh", [False, True])
def test_squares_touch_the_lower_half(m, k, fresh):
    a, (c, outer) = inside(m, k)[0], inside(m, m)
    before, old = outer.copy(), c.copy()
    blas.subtract_square(a, c, fresh)
    expected = (0.0 if fresh else old) - a @ a.T
    np.testing.assert_allclose(np.tril(c), np.tril(expected), atol=1e-13)
    np.testing.assert_array_equal(np.triu(c, 1), np.triu(old, 1))
    assert not changed(c, outer, before)


def test_factors_and_triangles_against_numpy():
    k, m = 12, 7
    a, outer = inside(k, k)
    a[:] = a @ a.T + k * np.eye(k)
    before, upper = outer.copy(), np.triu(a, 1)
    lower = np.linalg.cholesky(a)
    blas.factor(a)
    np.testing.assert_allclose(np.tril(a), lower, atol=1e-12)
    np.testing.assert_array_equal(np.triu(a, 1), upper)
    assert not changed(a, outer, before)
    b, around = inside(m, k)
    before, expected = around.copy(), np.linalg.solve(lower, b.T).T
    blas.divide(a, b)
    np.testing.assert_allclose(b, expected, atol=1e-12)
    assert not changed(b, around, before)
    for transposed in (False, True):
        right = RNG.standard_normal(k)
        expected = np.linalg.solve(lower.T if transposed else lower, right)
        blas.solve_triangle(a, right, transposed)
        np.testing.assert_allclose(right, expected, atol=1e-12)


def test_factor_refuses_what_is_not_positive_definite():
    with pytest.raises(np.linalg.LinAlgError, match="not positive definite"):
        blas.factor(np.asfortranarray(np.diag([1.0, -1.0])))
