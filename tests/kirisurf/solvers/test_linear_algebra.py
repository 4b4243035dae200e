"""Assembly against dense matrices, pivots against eigenvalues, solutions against NumPy."""

from __future__ import annotations

import numpy as np
import pytest

from kirisurf.constraints.angle import FullTurns
from kirisurf.constraints.length import EqualLengths
from kirisurf.constraints.opening import OpenHinges
from kirisurf.constraints.planarity import FlatTiles
from kirisurf.objective.fairness import EqualNeighbors
from kirisurf.objective.proximity import Proximity
from kirisurf.problem import Problem, Term
from kirisurf.solvers.assembly import Assembly
from kirisurf.solvers.direction import REGULARIZATION, factor_with_inertia, refined
from kirisurf.solvers.linear import Factorization, Ordering
from kirisurf.solvers.linearization import Linearization, stencils
from kirisurf.solvers.scipy_peers import jacobian_of
from tests.kirisurf.block_laws import bumpy_sheet


def small_problem() -> tuple[Problem, np.ndarray]:
    tessellation, points = bumpy_sheet()
    problem = Problem(
        n_vertices=tessellation.n_vertices,
        equalities=(EqualLengths(tessellation), FullTurns(tessellation, 4), FlatTiles(tessellation, 4)),
        inequalities=(OpenHinges(tessellation, 0.05, points),),
        terms=(Term(0.7, EqualNeighbors(tessellation, 4)), Term(1e-2, Proximity(points + 0.1))),
    )
    return problem, points


def test_gradient_has_taylor_order_two() -> None:
    problem, points = small_problem()
    step = np.random.default_rng(0).standard_normal(points.shape)
    slope = float(problem.gradient(points) @ step.ravel())
    rest = [abs(problem.objective(points + h * step) - problem.objective(points) - h * slope) for h in (1e-3, 1e-4)]
    assert np.log10(rest[0] / rest[1]) == pytest.approx(2, abs=0.05)


def test_linearization_agrees_with_the_sparse_jacobian() -> None:
    problem, points = small_problem()
    at = Linearization.at(problem, points)
    dense = jacobian_of(problem.equalities, points).toarray()
    assembly = Assembly(problem.n_vertices, problem.equalities, stencils(problem))
    np.testing.assert_allclose(assembly.jacobian_matrix(at.jacobian(assembly)).toarray(), dense, atol=1e-14)
    y = np.random.default_rng(1).standard_normal(len(dense))
    np.testing.assert_allclose(at.equality_transpose(y), dense.T @ y, atol=1e-12)
    inequality = jacobian_of(problem.inequalities, points).toarray()
    direction = np.random.default_rng(2).standard_normal(points.size)
    np.testing.assert_allclose(at.inequality_apply(direction), inequality @ direction, atol=1e-12)


def test_assembled_hessian_is_that_of_the_lagrangian() -> None:
    problem, points = small_problem()
    rng = np.random.default_rng(3)
    at = Linearization.at(problem, points)
    assembly = Assembly(problem.n_vertices, problem.equalities, stencils(problem))
    y, z = rng.standard_normal(assembly.n_rows), rng.random(len(at.inequality))
    weights = rng.random(len(z))
    blocks = at.hessian(assembly, y, z, weights, exact=True)
    matrix = assembly.matrix(blocks, at.jacobian(assembly), 0.0, 0.0).toarray()
    hessian = matrix[: assembly.n_dofs, : assembly.n_dofs]
    np.testing.assert_allclose(matrix, matrix.T, atol=1e-12)
    inequality = jacobian_of(problem.inequalities, points).toarray()
    lagrangian = hessian - inequality.T @ (weights[:, None] * inequality)

    def gradient(p: np.ndarray) -> np.ndarray:
        return (
            problem.gradient(p) + jacobian_of(problem.equalities, p).T @ y - jacobian_of(problem.inequalities, p).T @ z
        )

    direction = rng.standard_normal(points.shape)
    h = 1e-5
    change = (gradient(points + h * direction) - gradient(points - h * direction)) / (2 * h)
    np.testing.assert_allclose(lagrangian @ direction.ravel(), change, atol=1e-6 * np.abs(change).max())


def test_pivots_count_the_negative_eigenvalues() -> None:
    problem, points = small_problem()
    at = Linearization.at(problem, points)
    assembly = Assembly(problem.n_vertices, problem.equalities, stencils(problem))
    ordering = Ordering(assembly)
    rng = np.random.default_rng(4)
    for scale in (0.0, 1.0, 30.0):
        y, z = scale * rng.standard_normal(assembly.n_rows), np.zeros(len(at.inequality))
        blocks = at.hessian(assembly, y, z, z, exact=True)
        matrix = assembly.matrix(blocks, at.jacobian(assembly), 0.0, REGULARIZATION)
        negative = int((np.linalg.eigvalsh(matrix.toarray()) < 0).sum())
        assert Factorization(matrix, ordering).n_negative == negative
        factor, shift = factor_with_inertia(assembly, ordering, blocks, at.jacobian(assembly), 0.0)
        assert factor.n_negative == assembly.n_rows
        assert (shift > 0) == (negative != assembly.n_rows)


def test_refined_solutions_are_those_without_regularization() -> None:
    problem, points = small_problem()
    at = Linearization.at(problem, points)
    assembly = Assembly(problem.n_vertices, problem.equalities, stencils(problem))
    none = np.zeros(assembly.n_rows), np.zeros(len(at.inequality))
    blocks = at.hessian(assembly, *none, none[1], exact=False)
    factor, shift = factor_with_inertia(assembly, Ordering(assembly), blocks, at.jacobian(assembly), 0.0)
    matrix = assembly.matrix(blocks, at.jacobian(assembly), shift, 0.0)
    right = np.random.default_rng(5).standard_normal(matrix.shape[0])
    expected = np.linalg.solve(matrix.toarray(), right)
    np.testing.assert_allclose(refined(factor, matrix, right), expected, atol=1e-9 * np.abs(expected).max())
