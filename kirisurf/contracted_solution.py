"""The contracted half of a problem with both states: where it starts, and what is checked at its end."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from jaxtyping import Float

from kirisurf.contract import contract
from kirisurf.contracted_shape import ContractedShape, welded
from kirisurf.prescribed import Prescribed, rectangle_of
from kirisurf.rim import Rim, rectangle_rim
from kirisurf.sizes import tile_edges
from kirisurf.tessellation import Tessellation


def laid_start(
    tessellation: Tessellation, points: Float[np.ndarray, "n 3"], contracted: ContractedShape
) -> Float[np.ndarray, "q 3"]:
    """Return laid points (tile edges) followed by a contracted sheet.

    It is that of the laid points, or the regular one, bent, where its shape is prescribed.
    """
    if contracted.kind == "free":
        flat = welded(tessellation, contract(tessellation, points).points)
        return np.concatenate([points, np.column_stack([flat, np.zeros(len(flat))])])
    regular = np.column_stack([tessellation.contracted, np.zeros(len(tessellation.contracted))])
    start = contracted.start(tessellation, 1.0 / float(np.median(tile_edges(tessellation, regular))))
    return contracted.moved(np.concatenate([points, start]), tessellation, 0.0, 1.0)


def contracted_solution(
    tessellation: Tessellation, points: Float[np.ndarray, "q 3"], length: float, contracted: ContractedShape
) -> tuple[Float[np.ndarray, "n 2"] | None, Callable[[np.ndarray], Prescribed] | None]:
    """Return where the contracted sheet lies, and what its outline is checked against.

    Parameters
    ----------
    tessellation : Tessellation
    points : (q, 3)
        Solution of the problem.
    length : float
        Its unit, in the target's units.
    contracted : ContractedShape

    Returns
    -------
    (n, 2) or None
        In the target's units; None where the sheet is free, so that it may be laid in any way.
    callable or None
        Returns the prescribed outline of a contracted sheet (n, 2).
    """
    if contracted.kind == "free":
        return None, None
    n, w = tessellation.n_vertices, tessellation.n_welded
    laid = length * points[n + tessellation.weld, :2]
    if contracted.outline is not None:
        rim = contracted.rim(tessellation)
        # one copy of every welded vertex stands for it: closure is checked by itself
        first = np.unique(tessellation.weld, return_index=True)[1]
        outline = contracted.outline.scaled(length * float(points[n + w, 0]))
        return laid, lambda found: Prescribed(first[rim.vertices - n], rim.sides, outline)
    sides: Rim = rectangle_rim(tessellation.contracted)
    return laid, lambda found: Prescribed(sides.vertices, sides.sides, rectangle_of(found, sides, contracted.ratio))
