"""Everything that one evaluation of a problem gives: values, derivatives, the assembled KKT parts."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from kirisurf.block import Block, Differences
from kirisurf.problem import Problem, applied, applied_transpose, carried, carrier, joined, worst_violations
from kirisurf.solvers.assembly import Assembly, product
from kirisurf.solvers.vertex_pairs import Stencil


@dataclass(frozen=True, eq=False)
class Rows:
    """A block's residual (g, r) and Jacobian (g, r, 3 p) at the points of a linearization.

    The Jacobian of a term that is made of differences is that of the inner block.
    """

    block: Block
    residual: np.ndarray
    jacobian: np.ndarray


@dataclass(frozen=True, eq=False)
class Linearization:
    """Values and first derivatives of a problem at a point.

    Attributes
    ----------
    problem : Problem
    points : (n, 3)
    objective : float
    gradient : (3 n,)
    equality : (m,)
    inequality : (k,)
    equalities, inequalities, terms : tuples of Rows
        The same block by block.
    """

    problem: Problem
    points: np.ndarray
    objective: float
    gradient: np.ndarray
    equality: np.ndarray
    inequality: np.ndarray
    equalities: tuple[Rows, ...]
    inequalities: tuple[Rows, ...]
    terms: tuple[Rows, ...]

    @classmethod
    def at(cls, problem: Problem, points: np.ndarray) -> Linearization:
        """Evaluate a problem; values that are not finite are left to `is_finite`."""
        return cls._at(problem, points, (), ())

    def renewed(self, problem: Problem) -> Linearization:
        """Evaluate another problem at the same points; blocks that both share are not evaluated again."""
        return self._at(problem, self.points, (*self.equalities, *self.inequalities), self.terms)

    @classmethod
    def _at(
        cls, problem: Problem, points: np.ndarray, known: tuple[Rows, ...], known_terms: tuple[Rows, ...]
    ) -> Linearization:
        def constraint(block: Block) -> Rows:
            return _found(block, known) or Rows(block, block.residual(points), block.jacobian(points))

        def term(block: Block) -> Rows:
            return _found(block, known_terms) or Rows(block, block.residual(points), carrier(block).jacobian(points))

        with np.errstate(all="ignore"):
            equalities = tuple(constraint(b) for b in problem.equalities)
            inequalities = tuple(constraint(b) for b in problem.inequalities)
            terms = tuple(term(t.block) for t in problem.terms)
            objective, gradient = 0.0, np.zeros(3 * problem.n_vertices)
            for t, rows in zip(problem.terms, terms, strict=True):
                objective += float(0.5 * t.weight * (rows.residual**2).sum())
                pull = carried(t.block, t.weight * rows.residual)
                gradient += applied_transpose(carrier(t.block), rows.jacobian, pull, problem.n_vertices)
        return cls(
            problem=problem,
            points=points,
            objective=objective,
            gradient=gradient,
            equality=joined(rows.residual for rows in equalities),
            inequality=joined(rows.residual for rows in inequalities),
            equalities=equalities,
            inequalities=inequalities,
            terms=terms,
        )

    @property
    def equality_jacobians(self) -> tuple[np.ndarray, ...]:
        """Jacobians (g, r, 3 p) of the equality blocks."""
        return tuple(rows.jacobian for rows in self.equalities)

    @property
    def inequality_jacobians(self) -> tuple[np.ndarray, ...]:
        """Jacobians (g, r, 3 p) of the inequality blocks."""
        return tuple(rows.jacobian for rows in self.inequalities)

    @property
    def is_finite(self) -> bool:
        """Are all values and first derivatives finite?"""
        jacobians = (*self.equality_jacobians, *self.inequality_jacobians)
        vectors = (self.gradient, self.equality, self.inequality, *jacobians)
        return bool(np.isfinite(self.objective)) and all(bool(np.isfinite(v).all()) for v in vectors)

    @property
    def violations(self) -> Mapping[str, float]:
        """Largest violation of every kind of row, as `Problem.violations` of the points."""
        return worst_violations(
            [(rows.block, rows.residual) for rows in self.equalities],
            [(rows.block, rows.residual) for rows in self.inequalities],
        )

    def equality_transpose(self, multipliers: np.ndarray) -> np.ndarray:
        """J_E' multipliers, (3 n,)."""
        return self._transpose(self.equalities, multipliers)

    def inequality_transpose(self, multipliers: np.ndarray) -> np.ndarray:
        """J_I' multipliers, (3 n,)."""
        return self._transpose(self.inequalities, multipliers)

    def inequality_apply(self, direction: np.ndarray) -> np.ndarray:
        """J_I direction for a direction (3 n,)."""
        return joined(applied(rows.block, rows.jacobian, direction.reshape(-1, 3)) for rows in self.inequalities)

    def hessian(self, assembly: Assembly, y: np.ndarray, z: np.ndarray, weights: np.ndarray, exact: bool) -> np.ndarray:
        """Assemble grad^2 (f + y.c - z.g) + J_I' diag(weights) J_I as vertex blocks; Gauss-Newton unless `exact`."""
        return assembly.hessian(self._sources(y, z, weights, exact))

    def _sources(self, y: np.ndarray, z: np.ndarray, weights: np.ndarray, exact: bool) -> Iterator[np.ndarray | None]:
        x = self.points
        for term, rows in zip(self.problem.terms, self.terms, strict=True):
            yield from _products(term.block, rows.jacobian, term.weight)
            if term.block.curvature_stencil.size:
                pull = carried(term.block, term.weight * rows.residual)
                yield carrier(term.block).curvature(x, pull) if exact else None
        for rows, part in zip(self.equalities, split(self.equalities, y), strict=True):
            yield rows.block.curvature(x, part) if exact else None
        parts = zip(self.inequalities, split(self.inequalities, z), split(self.inequalities, weights), strict=True)
        for rows, part, weight in parts:
            yield product(rows.jacobian, weight)
            yield rows.block.curvature(x, -part) if exact else None

    def _transpose(self, parts: tuple[Rows, ...], multipliers: np.ndarray) -> np.ndarray:
        total = np.zeros(self.gradient.shape)
        for rows, part in zip(parts, split(parts, multipliers), strict=True):
            total += applied_transpose(rows.block, rows.jacobian, part, self.problem.n_vertices)
        return total


def stencils(problem: Problem) -> list[Stencil]:
    """Stencils of the sources of `Linearization.hessian`, in its order."""
    found: list[Stencil] = []
    for term in problem.terms:
        found += _product_stencils(term.block)
        if term.block.curvature_stencil.size:
            found.append(carrier(term.block).curvature_stencil)
    found += [b.curvature_stencil for b in problem.equalities]
    for block in problem.inequalities:
        found += [block.stencil, block.curvature_stencil]
    return found


def split(parts: Iterable[Rows], values: np.ndarray) -> list[np.ndarray]:
    """Cut a vector of rows (m,) into the blocks' (g, r)."""
    cut, start = [], 0
    for rows in parts:
        size = rows.residual.size
        cut.append(values[start : start + size].reshape(rows.residual.shape))
        start += size
    return cut


def _found(block: Block, known: tuple[Rows, ...]) -> Rows | None:
    return next((rows for rows in known if rows.block is block), None)


def _product_stencils(block: Block) -> list[Stencil]:
    """Stencils of `_products`."""
    if not isinstance(block, Differences):
        return [block.stencil]
    stencil = block.inner.stencil
    return [stencil, (stencil[block.pairs[:, 0]], stencil[block.pairs[:, 1]])]


def _products(block: Block, jacobian: np.ndarray, weight: float) -> Iterator[np.ndarray]:
    """Weight times J'J of a term by its groups; of differences by inner groups, and across each pair."""
    if not isinstance(block, Differences):
        yield product(jacobian, np.full(jacobian.shape[:2], weight))
        return
    first, second = block.pairs.T
    degrees = np.bincount(block.pairs.ravel(), minlength=len(jacobian))
    jacobian = np.ascontiguousarray(jacobian)
    yield product(jacobian, np.broadcast_to(weight * degrees[:, None], jacobian.shape[:2]))
    yield np.swapaxes((-weight * jacobian)[first], 1, 2) @ jacobian[second]
