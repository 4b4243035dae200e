"""Points projected on an outline or on one of its sides: feet, signed distances, normals, curvatures."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from kirisurf.outlines.curve import Curve
from kirisurf.outlines.foot_points import FootFinder, right_of

_AT_END = 1e-9
"""Pieces from the end of a side within which a foot counts as the end."""


@dataclass(frozen=True, eq=False)
class OutlineProjection:
    """Closest points on an outline, or on its sides.

    With p, n, k of one row and the tangent t, the signed distance of x near p is n.(x - p) + k/2 (t.(x - p))^2 up
    to third order, where p lies inside a smooth side; the distance's gradient at the projected point is n, its
    Hessian k / (1 + k d) t t^T.

    Attributes
    ----------
    points : (n, 2)
    distances : (n,)
        Signed, positive outside. Of a point whose closest one is a corner: its distance to the corner.
    normals : (n, 2)
        Outward unit normals of the side.
    curvatures : (n,)
        Of the side, positive where it bulges outwards, per unit of length. Zero on extensions.
    sides : (n,) int
    parameters : (n,)
        Of the side's curve; below 0 or above its number of pieces on extensions.
    """

    points: Float[np.ndarray, "n 2"]
    distances: Float[np.ndarray, " n"]
    normals: Float[np.ndarray, "n 2"]
    curvatures: Float[np.ndarray, " n"]
    sides: Int[np.ndarray, " n"]
    parameters: Float[np.ndarray, " n"]


def on_all_sides(
    finder: FootFinder, offsets: Int[np.ndarray, " e"], points: Float[np.ndarray, "n 2"]
) -> OutlineProjection:
    """Project points (n, 2) on a closed curve whose side k begins at piece `offsets[k]`."""
    rows, pieces = _rows(finder, points)
    sides = np.searchsorted(offsets, pieces, side="right") - 1
    rows["parameters"] = rows["parameters"] - offsets[sides]
    return OutlineProjection(sides=sides.astype(np.int64), **rows)


def on_given_sides(
    finders: tuple[FootFinder, ...],
    points: Float[np.ndarray, "n 2"],
    sides: Int[np.ndarray, " n"],
    extended: bool,
) -> OutlineProjection:
    """Project every point on its side, or where `extended` on the side and the tangents at its ends."""
    n = len(points)
    found = {
        "points": np.zeros((n, 2)),
        "distances": np.zeros(n),
        "normals": np.zeros((n, 2)),
        "curvatures": np.zeros(n),
        "parameters": np.zeros(n),
    }
    for k in np.unique(sides):
        mine = np.flatnonzero(sides == k)
        rows, _ = _rows(finders[k], points[mine])
        if extended:
            _extend(finders[k].curve, points[mine], rows)
        for name, values in rows.items():
            found[name][mine] = values
    return OutlineProjection(sides=np.array(sides, dtype=np.int64), **found)


def _rows(finder: FootFinder, points: np.ndarray) -> tuple[dict[str, np.ndarray], np.ndarray]:
    feet, curve = finder.find(points), finder.curve
    rows = {
        "points": curve.evaluated(feet.pieces, feet.s)[0],
        "distances": feet.distances,
        "normals": right_of(curve.tangents(feet.pieces, feet.s)),
        "curvatures": curve.curvatures(feet.pieces, feet.s),
        "parameters": feet.pieces + feet.s,
    }
    return rows, feet.pieces


def _extend(curve: Curve, points: np.ndarray, rows: dict[str, np.ndarray]) -> None:
    # Only where the closest point of the side is its end: the tangents may run into other parts of the outline.
    last = float(curve.n_pieces)
    for end, place, at_end in (
        (0.0, curve.start, rows["parameters"] <= _AT_END),
        (last, curve.end, rows["parameters"] >= last - _AT_END),
    ):
        pieces, s = curve.located(np.array([end]))
        speed = curve.speeds(pieces, s)[0]
        size = float(np.linalg.norm(speed))
        tangent = speed / size
        normal = np.array([tangent[1], -tangent[0]])
        away = points[at_end] - place
        along = away @ tangent
        rows["points"][at_end] = place + along[:, None] * tangent
        rows["distances"][at_end] = away @ normal
        rows["normals"][at_end] = normal
        rows["curvatures"][at_end] = 0.0
        rows["parameters"][at_end] = end + along / size
