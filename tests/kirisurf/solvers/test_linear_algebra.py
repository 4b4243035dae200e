"""Assembly against dense matrices, the factor against eigenvalues, solutions against NumPy."""

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
from kirisurf.solvers.direction import INEXACT, REGULARIZATION, KktFactor, NewtonSystem
from kirisurf.solvers.linearization import Linearization, stencils
from kirisurf.solvers.multifrontal import Symbolic
from kirisurf.solvers.scipy_peers import jacobian_of
from kirisurf.triangulation import TriangulatedTiles
from tests.kirisurf.block_laws import bumpy_sheet


def small_problem() -> tuple[Problem, np.ndarray]:
    tessellation, points = bumpy_sheet()
    problem = Problem(
        n_vertices=tessellation.n_vertices,
        equalities=(
            EqualLengths(tessellation),
            FullTurns(tessellation, 4),
            FlatTiles(TriangulatedTiles.of(tessellation).diagonals),
        ),
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


def parts(problem: Problem, points: np.ndarray) -> tuple[Linearization, Assembly, Symbolic]:
    at = Linearization.at(problem, points)
    assembly = Assembly(problem.n_vertices, problem.equalities, stencils(problem))
    return at, assembly, Symbolic(problem.n_vertices, assembly.pattern.rows, assembly.pattern.columns)


def test_linearization_agrees_with_the_sparse_jacobian() -> None:
    problem, points = small_problem()
    at, assembly, _ = parts(problem, points)
    dense = jacobian_of(problem.equalities, points).toarray()
    np.testing.assert_allclose(assembly.jacobian(at.equality_jacobians).toarray(), dense, atol=1e-14)
    normal = assembly.matrix(assembly.normal(at.equality_jacobians)).toarray()
    np.testing.assert_allclose(normal, dense.T @ dense, atol=1e-12)
    y = np.random.default_rng(1).standard_normal(len(dense))
    np.testing.assert_allclose(at.equality_transpose(y), dense.T @ y, atol=1e-12)
    inequality = jacobian_of(problem.inequalities, points).toarray()
    direction = np.random.default_rng(2).standard_normal(points.size)
    np.testing.assert_allclose(at.inequality_apply(direction), inequality @ direction, atol=1e-12)


@pytest.mark.parametrize("shift", [0.0, 0.3])
def test_a_product_with_the_upper_half_is_that_with_the_matrix(shift: float) -> None:
    problem, points = small_problem()
    at, assembly, _ = parts(problem, points)
    rng = np.random.default_rng(4)
    blocks = assembly.normal([rng.standard_normal(j.shape) for j in at.equality_jacobians])
    shifted, x = assembly.shifted(blocks, shift), rng.standard_normal(assembly.n_dofs)
    expected = assembly.matrix(blocks).toarray() @ x + shift * x
    np.testing.assert_allclose(assembly.apply(shifted, x), expected, atol=1e-12 * np.abs(expected).max())
    np.testing.assert_allclose(assembly.matrix(shifted) @ x, expected, atol=1e-12 * np.abs(expected).max())


def test_assembled_hessian_is_that_of_the_lagrangian() -> None:
    problem, points = small_problem()
    rng = np.random.default_rng(3)
    at, assembly, _ = parts(problem, points)
    y, z = rng.standard_normal(assembly.n_rows), rng.random(len(at.inequality))
    weights = rng.random(len(z))
    hessian = assembly.matrix(at.hessian(assembly, y, z, weights, exact=True)).toarray()
    np.testing.assert_allclose(hessian, hessian.T, atol=1e-12)
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


@pytest.mark.parametrize("scale", [0.0, 1.0, 30.0])
def test_a_factor_exists_exactly_where_the_inertia_is_that_of_a_minimum(scale: float) -> None:
    problem, points = small_problem()
    at, assembly, symbolic = parts(problem, points)
    rng = np.random.default_rng(4)
    y, z = scale * rng.standard_normal(assembly.n_rows), np.zeros(len(at.inequality))
    blocks = at.hessian(assembly, y, z, z, exact=True)
    normal, jacobian = assembly.normal(at.equality_jacobians), assembly.jacobian(at.equality_jacobians)
    dense, m = jacobian.toarray(), assembly.n_rows
    for shift in (0.0, KktFactor(assembly, symbolic, blocks, normal.copy(), jacobian).shift):
        hessian = assembly.matrix(assembly.shifted(blocks, shift)).toarray()
        matrix = np.block([[hessian, dense.T], [dense, -REGULARIZATION * np.eye(m)]])
        negative = int((np.linalg.eigvalsh(matrix) < 0).sum())
        found = KktFactor(assembly, symbolic, assembly.shifted(blocks, shift), normal.copy(), jacobian).shift
        assert (found == 0) == (negative == m)


def test_solutions_are_those_without_regularization() -> None:
    problem, points = small_problem()
    at, assembly, symbolic = parts(problem, points)
    none = np.zeros(assembly.n_rows), np.zeros(len(at.inequality))
    blocks = at.hessian(assembly, *none, none[1], exact=False)
    normal, jacobian = assembly.normal(at.equality_jacobians), assembly.jacobian(at.equality_jacobians)
    factor = KktFactor(assembly, symbolic, blocks, normal, jacobian)
    dense = jacobian.toarray()
    m = len(dense)
    matrix = np.block([[assembly.matrix(blocks).toarray(), dense.T], [dense, np.zeros((m, m))]])
    right = np.random.default_rng(5).standard_normal(len(matrix))
    expected = np.linalg.solve(matrix, right)
    np.testing.assert_allclose(factor.solve(right), expected, atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("size", [0.0, 1.0, 1e3])
def test_a_direction_solves_the_newton_system_whatever_the_multipliers(size: float) -> None:
    problem, points = small_problem()
    at, assembly, symbolic = parts(problem, points)
    rng = np.random.default_rng(6)
    y, slacks = size * rng.standard_normal(assembly.n_rows), 0.5 + rng.random(len(at.inequality))
    z, barrier = 0.1 / slacks, 1e-2
    system = NewtonSystem(at, assembly, symbolic, slacks, y, z, barrier, False, 0.0)
    found = system.direction(at.equality, at.inequality - slacks)
    weights = z / slacks
    hessian = assembly.matrix(at.hessian(assembly, y, z, weights, exact=False))
    jacobian = jacobian_of(problem.equalities, points)
    pulled = at.inequality_transpose(barrier / slacks - weights * (at.inequality - slacks))
    newton = np.concatenate([at.gradient + jacobian.T @ y - pulled, at.equality])
    rest = np.concatenate(
        [
            hessian @ found.dx + system.shift * found.dx + jacobian.T @ found.y + at.gradient - pulled,
            jacobian @ found.dx + at.equality,
        ]
    )
    assert np.abs(rest).max() <= 2 * INEXACT * np.abs(newton).max()
    np.testing.assert_allclose(found.ds, at.inequality_apply(found.dx) + at.inequality - slacks, atol=1e-12)
