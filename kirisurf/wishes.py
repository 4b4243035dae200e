"""Secondary objectives: which of the sheets that meet every row is wanted.

The rows leave a sheet some freedom, mostly along its outline. A preference adds a term to the objective, or changes
its weights, and the sheet is pulled along that freedom without breaking a row.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from kirisurf.closest import ClosestPointMap
from kirisurf.constraints.chord import SquaredDistances
from kirisurf.constraints.outline import OnOutline
from kirisurf.errors import ParameterError
from kirisurf.formulation import Weights
from kirisurf.objective.hole_bending import HoleBending
from kirisurf.outlines import Outline
from kirisurf.problem import Term
from kirisurf.slit_ends import SlitEnds
from kirisurf.surroundings import surrounding_vertices
from kirisurf.tessellation import Tessellation

BENDING = 30.0
"""Weight of the holes' curvature, in tile edges, against that of the distances."""


@dataclass(frozen=True, eq=False)
class Preference:
    """What is done for a preference near one sheet.

    Attributes
    ----------
    weights : Weights
    measured_by : str
        Name of the rows in the objective whose root mean square says how well the preference is met.
    says : str
        What these rows are, in words.
    terms : tuple of Term
        Added to the objective.
    """

    weights: Weights
    measured_by: str
    says: str
    terms: tuple[Term, ...] = ()


def preference(
    name: str, tessellation: Tessellation, points: Float[np.ndarray, "q 3"], target: Outline | ClosestPointMap
) -> Preference:
    """Return what a preference asks for.

    Parameters
    ----------
    name : str
        smoothest, nearest, curvature, open or uniform.
    tessellation : Tessellation
    points : (q, 3)
        The sheet to start from, in tile edges: closest points, openings and sizes are wished for as seen from it.
    target : Outline or ClosestPointMap
        The outline of a planar target, which has no curvature to prefer, or the closest points of a curved one; in
        tile edges.
    """
    if name == "smoothest":
        return Preference(Weights(fairness=1.0, proximity=1e-3), "fairness", "differences of neighboring tiles")
    if name == "curvature":
        if isinstance(target, Outline):
            raise ParameterError("prefer: expected a curved target for curvature, got a planar one")
        projection = target.project(points[: tessellation.n_vertices])
        loops = [indices for _, indices in surrounding_vertices(tessellation).by_size().values()]
        bending = [HoleBending(indices, projection) for indices in loops]
        says = "differences of the holes' curvature from the target's, times the tile edge"
        return Preference(Weights(), HoleBending.name, says, tuple(Term(BENDING, block) for block in bending))
    if name == "nearest" and not isinstance(target, Outline):
        weights = Weights(closeness=3.0, rim=1.0, reach=0.5, fairness=1e-3, proximity=1e-3)
        return Preference(weights, "surface", "distances to the target, in tile edges")
    if name == "nearest" and isinstance(target, Outline):
        outer = tessellation.outline
        near = OnOutline("nearest", outer, target.project(points[outer, :2]))
        says = "distances of outer vertices to the outline, in tile edges"
        return Preference(Weights(proximity=1e-3), near.name, says, (Term(1.0, near),))
    if name == "open":
        # as open as the regular pattern: beyond that its holes close again
        chords, sides = _chords(tessellation, tessellation.deployed)
        widest = chords / sides * _chords(tessellation, points)[1]
        wide = SquaredDistances("open", SlitEnds.of(tessellation).stencil[:, 1:3], widest)
        says = "squared widths of slits, from those of the open regular pattern, over the squared edge"
        return Preference(Weights(proximity=1e-2), wide.name, says, (Term(0.1, wide),))
    edges = tessellation.tiles.edges
    length = np.linalg.norm(points[edges[:, 1]] - points[edges[:, 0]], axis=1)
    # edges of one role: equal places in equal tiles
    role = np.stack([tessellation.cells[tessellation.tiles.owners, 2], _places(tessellation)], axis=1)
    _, same = np.unique(role, axis=0, return_inverse=True)
    mean = np.bincount(same.ravel(), length) / np.bincount(same.ravel())
    even = SquaredDistances("uniform", edges, mean[same.ravel()])
    says = "differences of squared edges from those of their role, over the squared edge"
    return Preference(Weights(proximity=1e-3), even.name, says, (Term(1.0, even),))


def _chords(tessellation: Tessellation, points: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Width of every slit at its open end, and the sum of its two sides."""
    a, b, c = points[SlitEnds.of(tessellation).stencil[:, :3]].transpose(1, 0, 2)
    return np.linalg.norm(b - c, axis=1), np.linalg.norm(b - a, axis=1) + np.linalg.norm(c - a, axis=1)


def _places(tessellation: Tessellation) -> np.ndarray:
    tiles = tessellation.tiles
    return np.arange(len(tiles.indices)) - tiles.offsets[tiles.owners]
