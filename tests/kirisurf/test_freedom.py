"""Freedom is unknowns minus rank minus rigid motions: against dense arithmetic, and against counts by hand."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import csr_matrix, vstack

from kirisurf.asked import standard
from kirisurf.constraints.linear import LinearRows, plane_rows
from kirisurf.contracted_shape import ContractedShape
from kirisurf.formulation import Weights
from kirisurf.freedom import freedom, n_dependent, rows_of
from kirisurf.outlines import outline
from kirisurf.pattern import quad_pattern
from kirisurf.problem import Problem
from kirisurf.rim import rectangle_rim
from kirisurf.tessellation import Tessellation
from kirisurf.two_states import Shape, TwoStates
from tests.kirisurf.both_states import bumpy, regular, regular_points


def problem(tessellation: Tessellation, points: np.ndarray) -> Problem:
    return TwoStates(tessellation, points, None, Weights(), Shape()).problem_at(points)


def dense_rank(found: Problem, points: np.ndarray) -> int:
    rows = rows_of(found.equalities, points).toarray()
    rows = rows / np.linalg.norm(rows, axis=1, keepdims=True)
    return int((np.linalg.svd(rows, compute_uv=False) > 1e-8).sum())


@pytest.mark.parametrize("name", ["quad", "kagome", "hexagon", "islamic-quad", "trihexagonal"])
def test_against_a_dense_rank(name: str) -> None:
    """Both states lie in the plane: three rigid motions of either remain."""
    tessellation = regular(name)
    points = regular_points(tessellation)
    found = problem(tessellation, points)
    expected = points.size - dense_rank(found, points) - 6
    assert freedom(found, points, tessellation.n_vertices) == expected > 0


def test_derivatives_are_those_of_the_rows() -> None:
    tessellation = regular("kagome")
    points = bumpy(regular_points(tessellation))
    found = problem(tessellation, points)
    direction = np.random.default_rng(0).standard_normal(points.shape)
    h = 1e-6
    change = (found.equality_rows(points + h * direction) - found.equality_rows(points - h * direction)) / (2 * h)
    np.testing.assert_allclose(rows_of(found.equalities, points) @ direction.ravel(), change, atol=1e-8)


@pytest.mark.parametrize("cells", [1, 2, 3])
def test_counts_of_squares_with_all_tips_on_their_sides(cells: int) -> None:
    """N x N tiles with n vertices: 2 n coordinates, 2 N (N - 1) slits of equal sides, (N - 1)^2 rings, 4 N tips."""
    tessellation = quad_pattern(cells, cells)
    points = regular_points(tessellation)
    size, n = 2 * cells, tessellation.n_vertices
    assert n == 2 * size * (size + 1)
    free = problem(tessellation, points)
    inner = 2 * n - 2 * size * (size - 1) - (size - 1) ** 2
    assert freedom(free, points, n) == inner - 3
    rim = rectangle_rim(tessellation.deployed)
    tips = LinearRows(
        "boundary",
        rim.vertices[:, None],
        np.eye(3)[np.where(rim.sides % 2 == 0, 1, 0)][:, None],
        np.zeros(len(rim.vertices)),
    )
    held = Problem(free.n_vertices, (*free.equalities, tips), (), ())
    assert len(rim.vertices) == 4 * size
    # the sides hold the deployed sheet in its place: rigid motions are among the rows
    assert freedom(held, points, n) == inner - 4 * size


def test_a_row_that_is_there_twice_counts_once() -> None:
    tessellation = regular("quad")
    points = regular_points(tessellation)
    found = problem(tessellation, points)
    twice = Problem(found.n_vertices, (*found.equalities, plane_rows("again", np.arange(7))), (), ())
    before = rows_of(found.equalities, points)
    assert freedom(twice, points, tessellation.n_vertices) == freedom(found, points, tessellation.n_vertices)
    scaled = csr_matrix(before.multiply(1 / np.sqrt(before.multiply(before).sum(axis=1))))
    assert n_dependent(csr_matrix(vstack([scaled, scaled[:7]]))) == n_dependent(scaled) + 7


def test_the_size_of_a_contracted_outline_is_one_unknown() -> None:
    """Its point has three coordinates, of which one counts."""
    tessellation = quad_pattern(2, 2)
    contracted = ContractedShape("outline", None, standard(outline("egg")))
    points = np.vstack([regular_points(tessellation)[: tessellation.n_vertices], contracted.start(tessellation, 2.0)])
    two = TwoStates(tessellation, points, None, Weights(), Shape(), contracted.rows(tessellation, 0.0))
    found = two.problem_at(points)
    rows = rows_of(found.equalities, points).toarray()[:, :-2]
    # beside the size, no rigid motion of the contracted sheet is left; three of the deployed one are
    expected = points.size - 2 - np.linalg.matrix_rank(rows, tol=1e-8) - 3
    assert freedom(found, points, tessellation.n_vertices) == expected
