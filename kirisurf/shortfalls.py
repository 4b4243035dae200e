"""What a finished sheet falls short of, though every row of its problem holds: said, never hidden."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from kirisurf.outlines import Outline
from kirisurf.prescribed import Prescribed
from kirisurf.sizes import slit_openings
from kirisurf.spec import FitSpec
from kirisurf.tessellation import Tessellation
from kirisurf.tile_corners import TileCorners

OUT = 1e-6
"""Distance outside an outline (tile edges) from which on it is said."""

_TURN = 0.01
"""Degrees by which a bound may be missed without a word."""


def shortfalls(
    spec: FitSpec,
    tessellation: Tessellation,
    deployed: Float[np.ndarray, "n 3"],
    contracted: Float[np.ndarray, "n 2"],
    edge: float,
    boundary: Prescribed | None,
    contracted_boundary: Prescribed | None,
) -> tuple[str, ...]:
    """Return a sentence for every bound that the finished sheet misses.

    Parameters
    ----------
    spec : FitSpec
    tessellation : Tessellation
    deployed, contracted : (n, 3), (n, 2)
    edge : float
        Tile edge, in the same units.
    boundary, contracted_boundary : Prescribed, optional
    """
    said = []
    for prescribed, points, what in ((boundary, deployed, "open"), (contracted_boundary, contracted, "flat")):
        if prescribed is not None:
            said += _outside(prescribed.outline, points[tessellation.outline, :2], edge, what)
    if spec.max_opening is not None:
        widest = float(np.degrees(slit_openings(tessellation, deployed).max(initial=0.0)))
        if widest > spec.max_opening + _TURN:
            said.append(
                f"The widest slit opens by {widest:.4g} degrees about the mean of its tiles' normals, more than the "
                f"{spec.max_opening:g} of --max-opening, which the solver measures between its sides."
            )
    if spec.min_corner is not None:
        least = _least_corner(tessellation, contracted)
        if least < spec.min_corner - _TURN:
            said.append(
                f"The smallest angle of a tile is {least:.4g} degrees, less than --min-corner {spec.min_corner:g}."
            )
    return tuple(said)


def _outside(outline: Outline, points: np.ndarray, edge: float, what: str) -> list[str]:
    out = outline.project(points).distances / edge
    count = int((out > OUT).sum())
    if not count:
        return []
    return [
        f"{count} outer vertices of the {what} sheet lie outside its outline, by up to {out.max():.2g} tile edges: "
        "only the tips that the certificate's row names lie on it."
    ]


def _least_corner(tessellation: Tessellation, contracted: np.ndarray) -> float:
    """Smallest angle (degrees) of the corners that are convex in the regular pattern."""
    before, here, after = contracted[tessellation.corners[TileCorners.of(tessellation).convex]].transpose(1, 0, 2)
    u, v = after - here, before - here
    angle = np.arctan2(u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0], (u * v).sum(axis=1))
    return float(np.degrees(angle.min(initial=np.pi)))
