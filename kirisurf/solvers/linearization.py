"""Everything that one evaluation of a problem gives: values, derivatives, the assembled KKT parts."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kirisurf.block import Block
from kirisurf.problem import Problem, applied, applied_transpose
from kirisurf.solvers.assembly import Assembly, vertex_blocks


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
    equality_jacobians, inequality_jacobians, term_jacobians : tuples of (g, r, 3 p)
    """

    problem: Problem
    points: np.ndarray
    objective: float
    gradient: np.ndarray
    equality: np.ndarray
    inequality: np.ndarray
    equality_jacobians: tuple[np.ndarray, ...]
    inequality_jacobians: tuple[np.ndarray, ...]
    term_jacobians: tuple[np.ndarray, ...]
    term_residuals: tuple[np.ndarray, ...]

    @classmethod
    def at(cls, problem: Problem, points: np.ndarray) -> Linearization:
        """Evaluate a problem; values that are not finite are left to `is_finite`."""
        with np.errstate(all="ignore"):
            return cls._at(problem, points)

    @classmethod
    def _at(cls, problem: Problem, points: np.ndarray) -> Linearization:
        residuals = tuple(t.block.residual(points) for t in problem.terms)
        jacobians = tuple(t.block.jacobian(points) for t in problem.terms)
        gradient = np.zeros(3 * problem.n_vertices)
        for t, r, j in zip(problem.terms, residuals, jacobians, strict=True):
            gradient += applied_transpose(t.block, j, t.weight * r, problem.n_vertices)
        return cls(
            problem=problem,
            points=points,
            objective=float(sum(0.5 * t.weight * (r**2).sum() for t, r in zip(problem.terms, residuals, strict=True))),
            gradient=gradient,
            equality=problem.equality_rows(points),
            inequality=problem.inequality_rows(points),
            equality_jacobians=tuple(b.jacobian(points) for b in problem.equalities),
            inequality_jacobians=tuple(b.jacobian(points) for b in problem.inequalities),
            term_jacobians=jacobians,
            term_residuals=residuals,
        )

    @property
    def is_finite(self) -> bool:
        """Are all values and first derivatives finite?"""
        jacobians = (*self.equality_jacobians, *self.inequality_jacobians)
        vectors = (self.gradient, self.equality, self.inequality, *jacobians)
        return bool(np.isfinite(self.objective)) and all(bool(np.isfinite(v).all()) for v in vectors)

    def equality_transpose(self, multipliers: np.ndarray) -> np.ndarray:
        """J_E' multipliers, (3 n,)."""
        return self._transpose(self.problem.equalities, self.equality_jacobians, multipliers)

    def inequality_transpose(self, multipliers: np.ndarray) -> np.ndarray:
        """J_I' multipliers, (3 n,)."""
        return self._transpose(self.problem.inequalities, self.inequality_jacobians, multipliers)

    def inequality_apply(self, direction: np.ndarray) -> np.ndarray:
        """J_I direction for a direction (3 n,)."""
        parts = [
            applied(b, j, direction.reshape(-1, 3)).ravel()
            for b, j in zip(self.problem.inequalities, self.inequality_jacobians, strict=True)
        ]
        return np.concatenate(parts) if parts else np.zeros(0)

    def hessian(self, assembly: Assembly, y: np.ndarray, z: np.ndarray, weights: np.ndarray, exact: bool) -> np.ndarray:
        """Assemble grad^2 (f + y.c - z.g) + J_I' diag(weights) J_I as vertex blocks; Gauss-Newton unless `exact`."""
        problem, x, sources = self.problem, self.points, []
        for term, residual, jacobian in zip(problem.terms, self.term_residuals, self.term_jacobians, strict=True):
            sources.append(vertex_blocks(term.weight * (np.swapaxes(jacobian, 1, 2) @ jacobian)))
            if term.block.curvature_stencil.size:
                c = term.block.curvature(x, term.weight * residual) if exact else _none(term.block)
                sources.append(vertex_blocks(c))
        for block, part in split(problem.equalities, y):
            c = block.curvature(x, part) if exact else _none(block)
            sources.append(vertex_blocks(c))
        start = 0
        for (block, part), jacobian in zip(split(problem.inequalities, z), self.inequality_jacobians, strict=True):
            w = weights[start : start + part.size].reshape(part.shape)
            start += part.size
            full = np.swapaxes(jacobian * w[:, :, None], 1, 2) @ jacobian
            if exact:
                full = full - block.curvature(x, part)
            sources.append(vertex_blocks(full))
        return assembly.hessian(sources)

    def _transpose(
        self, blocks: tuple[Block, ...], jacobians: tuple[np.ndarray, ...], multipliers: np.ndarray
    ) -> np.ndarray:
        total = np.zeros(self.gradient.shape)
        for (block, part), jacobian in zip(split(blocks, multipliers), jacobians, strict=True):
            total += applied_transpose(block, jacobian, part, self.problem.n_vertices)
        return total


def split(blocks: tuple[Block, ...], values: np.ndarray) -> list[tuple[Block, np.ndarray]]:
    """Cut a vector of rows (m,) into the blocks' (g, r)."""
    parts, start = [], 0
    for block in blocks:
        size = len(block.stencil) * block.n_rows
        parts.append((block, values[start : start + size].reshape(-1, block.n_rows)))
        start += size
    return parts


def stencils(problem: Problem) -> list[np.ndarray]:
    """Stencils of the sources of `Linearization.hessian`, in its order."""
    found = []
    for term in problem.terms:
        found.append(term.block.stencil)
        if term.block.curvature_stencil.size:
            found.append(term.block.curvature_stencil)
    found += [b.curvature_stencil for b in problem.equalities]
    found += [b.stencil for b in problem.inequalities]
    return found


def _none(block: Block) -> np.ndarray:
    size = 3 * block.curvature_stencil.shape[1]
    return np.zeros((len(block.curvature_stencil), size, size))
