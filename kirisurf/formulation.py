"""From a tessellation, a start and a target to a Problem: which rows are hard, what is minimized, how much."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from kirisurf.block import Block
from kirisurf.closest import ClosestPointMap
from kirisurf.constraints.angle import FullTurns
from kirisurf.constraints.convexity import ConvexTiles
from kirisurf.constraints.edge import LongEdges
from kirisurf.constraints.facing import FacingTiles
from kirisurf.constraints.length import EqualLengths
from kirisurf.constraints.opening import OpenHinges
from kirisurf.constraints.planarity import FlatTiles
from kirisurf.constraints.surface import OnSurface
from kirisurf.objective.fairness import EqualNeighbors
from kirisurf.objective.proximity import Proximity
from kirisurf.objective.rim import RimDistance
from kirisurf.problem import Problem, Term
from kirisurf.tessellation import Tessellation
from kirisurf.triangulation import TriangulatedTiles


@dataclass(frozen=True)
class Weights:
    """Weights of the objective, all per squared tile edge.

    Attributes
    ----------
    closeness : float
        Distance to the target.
    rim : float
        Distance beyond the rim.
    reach : float
        Distance of the outline inside the rim, relative to `rim`.
    fairness : float
        Differences between neighboring tiles (times tiles over pairs).
    proximity : float
        Displacement from the start.
    """

    closeness: float = 1.0
    rim: float = 0.3
    reach: float = 0.06
    fairness: float = 1e-2
    proximity: float = 1e-2


class Formulation:
    """The problem of one fit, whose model of the target can be renewed at any points.

    Parameters
    ----------
    tessellation : Tessellation
    start : (n, 3)
        In units of the tile edge; also the reference of the proximity term.
    target : ClosestPointMap
        In the same units.
    weights : Weights
    exact : bool
        Every vertex on the target is a constraint, instead of closeness in the objective.
    margin : float
        Sine of the smallest opening.
    smallest_edge : float
        Over the tile edge; 0 leaves the rows out.
    guarded : bool
        Whether rows keep the tiles convex and neighbors facing the same way. Why not always: few targets need
        them, and where they are slack their barrier still pushes, by up to a tenth of the distance to the target.
    wishes : sequence of Term
        Secondary objectives.
    """

    def __init__(
        self,
        tessellation: Tessellation,
        start: Float[np.ndarray, "n 3"],
        target: ClosestPointMap,
        weights: Weights,
        exact: bool = False,
        margin: float = 0.05,
        smallest_edge: float = 0.1,
        guarded: bool = False,
        wishes: tuple[Term, ...] = (),
    ) -> None:
        self._target = target
        self._weights = weights
        self._exact = exact
        self._vertices = np.arange(tessellation.n_vertices)
        self._outline = np.zeros(tessellation.n_vertices, bool)
        self._outline[tessellation.outline] = True
        sizes = np.unique(tessellation.tiles.sizes)
        self._rigid: list[Block] = [EqualLengths(tessellation)]
        self._rigid += [FullTurns(tessellation, int(k)) for k in np.unique(tessellation.rings.sizes)]
        diagonals = TriangulatedTiles.of(tessellation).diagonals
        if len(diagonals):
            self._rigid.append(FlatTiles(diagonals))
        self._inequalities: list[Block] = [OpenHinges(tessellation, margin, start)]
        if guarded:
            self._inequalities.append(FacingTiles(tessellation, start))
            self._inequalities += [ConvexTiles(tessellation, int(k), start) for k in sizes]
        if smallest_edge > 0:
            self._inequalities.append(LongEdges(tessellation, smallest_edge))
        fairness = [EqualNeighbors(tessellation, int(k)) for k in sizes]
        pairs = max(1, sum(len(block.stencil) for block in fairness))
        self._fixed = [Term(weights.fairness * tessellation.n_tiles / pairs, b) for b in fairness if len(b.stencil)]
        self._fixed += [Term(weights.proximity, Proximity(start)), *wishes]

    def problem_at(self, points: Float[np.ndarray, "n 3"]) -> Problem:
        """Return the problem with its model of the target made at `points`; stencils are always the same."""
        projection = self._target.project(points)
        surface = OnSurface(self._vertices, projection)
        rim = RimDistance(self._outline, projection, points, self._weights.reach)
        terms = [*self._fixed, Term(self._weights.rim, rim)]
        if not self._exact:
            terms.append(Term(self._weights.closeness, surface))
        return Problem(
            n_vertices=len(self._vertices),
            equalities=(*self._rigid, surface) if self._exact else tuple(self._rigid),
            inequalities=tuple(self._inequalities),
            terms=tuple(terms),
        )
