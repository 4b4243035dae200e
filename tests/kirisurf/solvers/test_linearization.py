"""Linearizations: short cuts say what the long way says."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kirisurf.block import Block, Differences
from kirisurf.constraints.length import EqualLengths
from kirisurf.objective.fairness import EqualNeighbors
from kirisurf.objective.proximity import Proximity
from kirisurf.problem import Problem, Term
from kirisurf.solvers.assembly import Assembly
from kirisurf.solvers.linearization import Linearization, stencils
from kirisurf.solvers.scipy_peers import jacobian_of
from tests.kirisurf.block_laws import bumpy_sheet
from tests.kirisurf.solvers.test_linear_algebra import small_problem


@dataclass
class Plain:
    """A block of somebody who knows of no short cut, with the first vertex of every stencil named twice."""

    block: Block

    def __post_init__(self) -> None:
        self.name, self.n_rows = self.block.name, self.block.n_rows
        self.stencil = np.concatenate([self.block.stencil, self.block.stencil[:, :1]], axis=1)
        self.curvature_stencil = self.block.curvature_stencil

    def residual(self, points: np.ndarray) -> np.ndarray:
        return self.block.residual(points)

    def jacobian(self, points: np.ndarray) -> np.ndarray:
        full = self.block.jacobian(points)
        return np.concatenate([0.25 * full[..., :3], full[..., 3:], 0.75 * full[..., :3]], axis=2)

    def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
        return self.block.curvature(points, multipliers)


def hessian(problem: Problem, points: np.ndarray, exact: bool) -> np.ndarray:
    assembly = Assembly(problem.n_vertices, problem.equalities, stencils(problem))
    rng = np.random.default_rng(0)
    at = Linearization.at(problem, points)
    y, z = rng.standard_normal(len(at.equality)), rng.random(len(at.inequality))
    return assembly.matrix(at.hessian(assembly, y, z, rng.random(len(z)), exact=exact)).toarray()


def test_differences_and_plain_blocks_have_one_hessian_and_gradient() -> None:
    problem, points = small_problem()
    plain = replace(
        problem,
        equalities=tuple(Plain(b) for b in problem.equalities),
        inequalities=tuple(Plain(b) for b in problem.inequalities),
        terms=tuple(Term(t.weight, Plain(t.block)) for t in problem.terms),
    )
    assert isinstance(problem.terms[0].block, Differences) and not isinstance(plain.terms[0].block, Differences)
    for exact in (True, False):
        np.testing.assert_allclose(hessian(problem, points, exact), hessian(plain, points, exact), atol=1e-12)
    long, short = Linearization.at(plain, points), Linearization.at(problem, points)
    np.testing.assert_allclose(short.gradient, long.gradient, atol=1e-13)
    np.testing.assert_allclose(short.gradient, problem.gradient(points), atol=1e-13)
    assert np.isclose(short.objective, problem.objective(points), rtol=1e-14)


def test_a_vertex_named_twice_has_one_column() -> None:
    tessellation, points = bumpy_sheet()
    blocks = (Plain(EqualLengths(tessellation)), Plain(EqualNeighbors(tessellation, 4)))
    assembly = Assembly(tessellation.n_vertices, blocks, [])
    jacobians = [b.jacobian(points) for b in blocks]
    matrix, dense = assembly.jacobian(jacobians), jacobian_of(blocks, points).toarray()
    assert matrix.has_canonical_format
    np.testing.assert_allclose(matrix.toarray(), dense, atol=1e-14)
    normal = assembly.matrix(assembly.normal(jacobians)).toarray()
    np.testing.assert_allclose(normal, dense.T @ dense, atol=1e-12)


def test_a_renewed_linearization_evaluates_what_changed() -> None:
    problem, points = small_problem()
    at = Linearization.at(problem, points)
    changed = replace(problem, terms=(problem.terms[0], Term(3.0, Proximity(points + 0.2))))
    renewed, fresh = at.renewed(changed), Linearization.at(changed, points)
    assert all(a is b for a, b in zip(renewed.equalities, at.equalities, strict=True))
    assert renewed.terms[0] is at.terms[0] and renewed.terms[1] is not at.terms[1]
    assert renewed.objective == fresh.objective and renewed.problem is changed
    np.testing.assert_array_equal(renewed.gradient, fresh.gradient)
    np.testing.assert_array_equal(renewed.equality, fresh.equality)


def test_violations_are_those_of_the_problem() -> None:
    problem, points = small_problem()
    assert Linearization.at(problem, points).violations == problem.violations(points)
