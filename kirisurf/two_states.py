"""The problem with both states unknown: deployed points, and one contracted point for every welded vertex.

    minimize    closeness, rim, fairness of the contracted tiles, proximity
    subject to  isometry of every tile, planarity, outlines
                openings, edges, corners

Every tessellation has this one form, with designed openings, tiles that are not convex or straight corners as
without, and the contracted sheet's shape can be prescribed. Why not always: a third more unknowns. Where all slits
close, tiles are convex and the contracted sheet is free, :class:`kirisurf.formulation.Formulation` says the same
without them.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from kirisurf.block import Block
from kirisurf.closest import ClosestPointMap
from kirisurf.constraints.chord import OpeningsBelow
from kirisurf.constraints.edge import LongEdges
from kirisurf.constraints.facing import FacingTiles
from kirisurf.constraints.gap import OpenGaps
from kirisurf.constraints.isometry import IsometricTiles
from kirisurf.constraints.linear import plane_rows
from kirisurf.constraints.opening import OpenHinges
from kirisurf.constraints.planarity import FlatTiles
from kirisurf.constraints.surface import OnSurface
from kirisurf.constraints.turn import TurnedCorners
from kirisurf.constraints.unfolded import UnfoldedTiles
from kirisurf.formulation import Weights
from kirisurf.objective.fairness import EqualNeighbors
from kirisurf.objective.flat_shape import FlatTileShapes
from kirisurf.objective.proximity import Proximity
from kirisurf.objective.rim import RimDistance
from kirisurf.outline_rows import OutlineRows
from kirisurf.problem import Problem, Term
from kirisurf.rim import cell_size, free_rim
from kirisurf.slit_ends import SlitEnds
from kirisurf.tessellation import Tessellation
from kirisurf.tile_corners import TileCorners, open_gaps
from kirisurf.triangulation import TriangulatedTiles

LEAST_AREA = 0.05
"""Least area of a triangle of a tile, over that in the start."""
LEAST_TURN = 0.02
"""Least sine of a convex corner, for sides as long as in the start."""
LEAST_GAP = np.radians(3.0)
"""Least angle between tiles at a corner of a designed opening, contracted."""


@dataclass(frozen=True)
class Shape:
    """What is asked of tiles and openings.

    Attributes
    ----------
    smallest_edge : float
        Over the tile edge; 0 leaves the rows out.
    margin : float
        Sine of the smallest opening.
    largest_opening, smallest_corner : float or None
        Radians.
    """

    smallest_edge: float = 0.1
    margin: float = 0.05
    largest_opening: float | None = None
    smallest_corner: float | None = None


class TwoStates:
    """The problem of one fit with both states unknown; its models of the targets can be renewed at any points.

    Points are the n deployed ones, then the w contracted ones in the plane z = 0, then what the outline of the
    contracted sheet needs.

    Parameters
    ----------
    tessellation : Tessellation
    start : (n + w + ..., 3)
        In units of the tile edge; also the reference of the proximity term.
    target : ClosestPointMap, optional
        In the same units; without one the deployed sheet lies in the plane z = 0.
    weights : Weights
    shape : Shape
    outlines : sequence of OutlineRows
        Of the deployed and of the contracted sheet.
    wishes : sequence of Term
        Secondary objectives.
    exact : bool
        Every vertex on the target is a constraint, instead of closeness in the objective.
    guarded : bool
        Whether rows keep neighbors facing the same way.
    """

    def __init__(
        self,
        tessellation: Tessellation,
        start: Float[np.ndarray, "q 3"],
        target: ClosestPointMap | None,
        weights: Weights,
        shape: Shape,
        outlines: tuple[OutlineRows, ...] = (),
        wishes: tuple[Term, ...] = (),
        exact: bool = False,
        guarded: bool = False,
    ) -> None:
        n = tessellation.n_vertices
        self._n, self._size = n, len(start)
        self._target, self._weights, self._exact = target, weights, exact
        self._outlines = outlines
        deployed = start[:n]
        # only tips: the vertices behind them would be drawn out of shape
        self._outer = np.zeros(n, bool)
        if target is not None:
            inside = np.linalg.norm(deployed - target.project(deployed).rim_points, axis=1)
            self._outer[free_rim(tessellation, -inside, cell_size(tessellation, deployed), deployed).vertices] = True
        triangulated = TriangulatedTiles.of(tessellation)
        flat = np.arange(n if target is not None else 0, len(start))
        self._equalities: list[Block] = [
            IsometricTiles(tessellation, triangulated),
            plane_rows("planarity" if target is None else "flatness", flat),
        ]
        if target is not None and len(triangulated.diagonals):
            self._equalities.append(FlatTiles(triangulated.diagonals))
        corners = TileCorners.of(tessellation)
        contracted = n + tessellation.weld
        if corners.straight.any():
            straight = contracted[tessellation.corners[corners.straight]]
            self._equalities.append(TurnedCorners("straightness", straight, np.full(len(straight), np.pi)))
        self._inequalities = _shape_rows(tessellation, triangulated, corners, start, shape)
        if len(triangulated.diagonals):
            self._inequalities.append(UnfoldedTiles(triangulated.diagonals, deployed))
        if target is None:
            beside = tessellation.hinges[~tessellation.slit_ends, :3]
            self._inequalities.append(OpenGaps(beside, float(np.arcsin(min(1.0, shape.margin)))))
        if guarded and target is not None:
            self._inequalities.append(FacingTiles(tessellation, deployed))
        fairness: list[Block] = [
            EqualNeighbors(tessellation, int(k), FlatTileShapes, contracted[tessellation.tiles.indices])
            for k in np.unique(tessellation.tiles.sizes)
        ]
        fairness = [block for block in fairness if len(block.stencil)]
        pairs = max(1, sum(len(block.stencil) for block in fairness))
        self._terms = [Term(weights.fairness * tessellation.n_tiles / pairs, block) for block in fairness]
        self._terms.append(Term(weights.proximity, Proximity(start)))
        self._terms += wishes

    def problem_at(self, points: Float[np.ndarray, "q 3"]) -> Problem:
        """Return the problem with its models of the targets made at `points`; stencils are always the same."""
        equalities, inequalities, terms = list(self._equalities), list(self._inequalities), list(self._terms)
        for outline in self._outlines:
            equalities += outline.equalities_at(points)
            inequalities += outline.inequalities_at(points)
        if self._target is not None:
            deployed = points[: self._n]
            projection = self._target.project(deployed)
            surface = OnSurface(np.arange(self._n), projection)
            terms.append(Term(self._weights.rim, RimDistance(self._outer, projection, deployed, self._weights.reach)))
            if self._exact:
                equalities.append(surface)
            else:
                terms.append(Term(self._weights.closeness, surface))
        return Problem(self._size, tuple(equalities), tuple(inequalities), tuple(terms))


def _shape_rows(
    tessellation: Tessellation, triangulated: TriangulatedTiles, corners: TileCorners, start: np.ndarray, shape: Shape
) -> list[Block]:
    """Inequalities on edges, openings and tile corners."""
    n = tessellation.n_vertices
    contracted = n + tessellation.weld
    rows: list[Block] = [OpenHinges(tessellation, shape.margin, start[:n])]
    if shape.smallest_edge > 0:
        rows.append(LongEdges(tessellation, shape.smallest_edge))
    if shape.largest_opening is not None:
        rows.append(OpeningsBelow(SlitEnds.of(tessellation), shape.largest_opening))
    convex = contracted[tessellation.corners[corners.convex]]
    if len(convex):
        before, here, after = start[convex].transpose(1, 0, 2)
        sides = np.linalg.norm(after - here, axis=1) * np.linalg.norm(before - here, axis=1)
        rows.append(TurnedCorners("convexity", convex, np.zeros(len(convex)), LEAST_TURN * sides))
        if shape.smallest_corner is not None:
            rows.append(TurnedCorners("corner", convex, np.full(len(convex), shape.smallest_corner)))
    gaps = n + open_gaps(tessellation)
    if len(gaps):
        rows.append(TurnedCorners("gap", gaps, np.full(len(gaps), LEAST_GAP)))
    triangles = contracted[triangulated.triangles]
    a, b, c = start[triangles].transpose(1, 0, 2)[:, :, :2]
    twice = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    rows.append(TurnedCorners("area", triangles[:, [2, 0, 1]], np.zeros(len(twice)), LEAST_AREA * np.abs(twice)))
    return rows
