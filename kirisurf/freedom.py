"""The freedom that is left to a sheet: how many ways it can change without breaking a row, to first order."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from jaxtyping import Float
from scipy.sparse import csc_matrix, csr_matrix, eye, vstack
from scipy.sparse.linalg import splu

from kirisurf.block import Block
from kirisurf.problem import Problem
from kirisurf.solvers.outcome import Outcome
from kirisurf.status import Status

INDEPENDENT = 1e-7
"""Singular value, over the largest, below which a combination of rows counts as dependent."""

_MOST_DEPENDENT = 24
_ROUNDS = 30


MOST_VERTICES = 6000
"""Points of a problem up to which its freedom is counted: beyond, that takes as long as the solve."""


def freedom_of(outcome: Outcome, problem: Callable[[np.ndarray], Problem], n_deployed: int) -> int | None:
    """Return the freedom of a solved sheet; None where it is not solved, or has too many points to count.

    Parameters
    ----------
    outcome : Outcome
    problem : callable
        Problem with its models made at given points.
    n_deployed : int
    """
    if outcome.status is not Status.CONVERGED or len(outcome.points) > MOST_VERTICES:
        return None
    return freedom(problem(outcome.points), outcome.points, n_deployed)


def freedom(problem: Problem, points: Float[np.ndarray, "q 3"], n_deployed: int) -> int:
    """Return the dimension of the sheets next to a solution, rigid motions of either state not counted.

    It is the number of unknowns minus the rank of the equality rows minus the number of rigid motions that break
    no row: six of the deployed and three of the contracted sheet where both are free. Inequalities that are met
    exactly are left out: they limit how far a sheet can go, not in how many ways.

    Parameters
    ----------
    problem : Problem
    points : (q, 3)
        A solution.
    n_deployed : int
        Points of the deployed state, which come first.
    """
    jacobian = rows_of(problem.equalities, points)
    scale = np.sqrt(np.asarray(jacobian.multiply(jacobian).sum(axis=1)).ravel())
    jacobian = csr_matrix(jacobian.multiply(1.0 / np.maximum(scale, 1e-300)[:, None]))
    rank = jacobian.shape[0] - n_dependent(jacobian)
    return 3 * len(points) - rank - _rigid_motions(jacobian, points, n_deployed)


def rows_of(blocks: tuple[Block, ...], points: Float[np.ndarray, "q 3"]) -> csr_matrix:
    """Return the first derivatives of all rows of blocks, (m, 3 q) sparse."""
    parts = []
    for block in blocks:
        values = block.jacobian(points)
        groups, rows, width = values.shape
        place = (3 * block.stencil[:, :, None] + np.arange(3)).reshape(groups, 1, width)
        columns = np.broadcast_to(place, values.shape)
        numbers = np.broadcast_to(np.arange(groups * rows).reshape(groups, rows, 1), values.shape)
        entries = (values.ravel(), (numbers.ravel(), columns.ravel()))
        parts.append(csr_matrix(entries, shape=(groups * rows, 3 * len(points))))
    return csr_matrix(vstack(parts))


def n_dependent(jacobian: csr_matrix) -> int:
    """Return by how much the rank of rows of unit length falls short of their number, at most 24.

    The null space of J J' is found by inverse iteration with a block of vectors.
    """
    gram = csc_matrix(jacobian @ jacobian.T)
    rows = gram.shape[0]
    count = min(_MOST_DEPENDENT, rows)
    factor = splu(csc_matrix(gram + 1e-13 * eye(rows)), options={"SymmetricMode": True}, permc_spec="MMD_AT_PLUS_A")
    block = np.linalg.qr(np.random.default_rng(0).standard_normal((rows, count)))[0]
    for _ in range(_ROUNDS):
        block = np.linalg.qr(factor.solve(block))[0]
    values = np.linalg.svd(jacobian.T @ block, compute_uv=False)
    return int((values < INDEPENDENT * max(1.0, values.max())).sum())


def _rigid_motions(jacobian: csr_matrix, points: np.ndarray, n_deployed: int) -> int:
    """Number of independent rigid motions of the two states that break no row to first order."""
    motions = []
    states = ((np.arange(n_deployed), range(3), range(3)), (np.arange(n_deployed, len(points)), range(2), (2,)))
    for which, shifts, turns in states:
        if not len(which):
            continue
        middle = points[which].mean(axis=0)
        for axis in shifts:
            motion = np.zeros_like(points)
            motion[which, axis] = 1.0
            motions.append(motion)
        for axis in turns:
            motion = np.zeros_like(points)
            motion[which] = np.cross(np.eye(3)[axis], points[which] - middle)
            motions.append(motion)
    basis = np.linalg.qr(np.stack([m.ravel() for m in motions], axis=1))[0]
    values = np.linalg.svd(jacobian @ basis, compute_uv=False)
    return int((values < INDEPENDENT * np.sqrt(jacobian.shape[0])).sum())
