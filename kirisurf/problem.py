"""The optimization problem of a fit. It says nothing about how to solve it.

    minimize    1/2 sum_k w_k |r_k(x)|^2          closeness, rim, fairness, proximity
    subject to  c(x) = 0                          length, angle, planarity (and surface in exact mode)
                g(x) >= 0                         opening

over the deployed vertices x (n, 3), in units of the tile edge, so that every row is dimensionless.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from kirisurf.block import Block, Differences


@dataclass(frozen=True, eq=False)
class Term:
    """A least-squares term of the objective: 1/2 weight |rows|^2."""

    weight: float
    block: Block


@dataclass(frozen=True, eq=False)
class Problem:
    """Blocks of constraints and terms on n vertices.

    Attributes
    ----------
    n_vertices : int
    equalities, inequalities : tuple of Block
        Rows that vanish, and rows that are not negative.
    terms : tuple of Term
    """

    n_vertices: int
    equalities: tuple[Block, ...]
    inequalities: tuple[Block, ...]
    terms: tuple[Term, ...]

    def objective(self, points: Float[np.ndarray, "n 3"]) -> float:
        """Value of the objective."""
        return float(sum(0.5 * t.weight * (t.block.residual(points) ** 2).sum() for t in self.terms))

    def gradient(self, points: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, " n*3"]:
        """Gradient of the objective, (3 n,)."""
        total = np.zeros(3 * self.n_vertices)
        for term in self.terms:
            block = carrier(term.block)
            pull = carried(term.block, term.weight * term.block.residual(points))
            total += applied_transpose(block, block.jacobian(points), pull, self.n_vertices)
        return total

    def equality_rows(self, points: Float[np.ndarray, "n 3"]) -> np.ndarray:
        """Residuals of all equality rows, in order of blocks, groups and rows."""
        return joined(b.residual(points) for b in self.equalities)

    def inequality_rows(self, points: Float[np.ndarray, "n 3"]) -> np.ndarray:
        """Values of all inequality rows."""
        return joined(b.residual(points) for b in self.inequalities)

    def violations(self, points: Float[np.ndarray, "n 3"]) -> Mapping[str, float]:
        """Largest violation of every kind of row."""
        return worst_violations(
            [(b, b.residual(points)) for b in self.equalities], [(b, b.residual(points)) for b in self.inequalities]
        )


def worst_violations(
    equalities: Iterable[tuple[Block, np.ndarray]], inequalities: Iterable[tuple[Block, np.ndarray]]
) -> Mapping[str, float]:
    """Return the largest violation of every kind of row, from blocks and their residuals."""
    found: dict[str, float] = {}
    for block, rows in equalities:
        found[block.name] = max(found.get(block.name, 0.0), float(np.abs(rows).max(initial=0.0)))
    for block, rows in inequalities:
        found[block.name] = max(found.get(block.name, 0.0), float(np.maximum(-rows, 0).max(initial=0.0)))
    return found


def carrier(block: Block) -> Block:
    """Return the block whose derivatives those of a term are made of: of differences, the inner one."""
    return block.inner if isinstance(block, Differences) else block


def carried(block: Block, multipliers: np.ndarray) -> np.ndarray:
    """Return multipliers (g, r) of a term as multipliers of its `carrier`."""
    return block.folded(multipliers) if isinstance(block, Differences) else multipliers


def applied_transpose(block: Block, jacobian: np.ndarray, multipliers: np.ndarray, n: int) -> np.ndarray:
    """Return J' multipliers (3 n,) for one block."""
    values = np.einsum("grp,gr->gp", jacobian, multipliers)
    dofs = (3 * block.stencil[:, :, None] + np.arange(3)).reshape(values.shape)
    return np.bincount(dofs.ravel(), values.ravel(), 3 * n)


def applied(block: Block, jacobian: np.ndarray, direction: np.ndarray) -> np.ndarray:
    """Return J direction (g, r) for one block and a direction (n, 3)."""
    local = direction[block.stencil].reshape(len(block.stencil), -1)
    return np.einsum("grp,gp->gr", jacobian, local)


def joined(parts: Iterable[np.ndarray]) -> np.ndarray:
    """Return rows (g, r) of several blocks as one vector."""
    rows = [p.ravel() for p in parts]
    return np.concatenate(rows) if rows else np.zeros(0)
