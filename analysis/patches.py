"""Bicubic Bezier patches over the holes of a deployed sheet."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from analysis.bezier import BezierPatch
from analysis.constructions import BY_NAME, CONSTRUCTIONS
from analysis.patch_frames import hole_frames
from kirisurf.errors import ParameterError
from kirisurf.loops import Loops
from kirisurf.tessellation import Tessellation

LARGEST_CONDITION = 50.0
"""Condition number of the six quadratic monomials at a hole's vertices above which they do not determine its
curvature; a regular hole has about 5."""

STEEPEST = 0.2
"""Cosine of the angle between a tile and the plane of its hole below which no graph over the plane is its patch."""


@dataclass(frozen=True, eq=False)
class HolePatches:
    """The patches of all holes with the holes' places in them.

    Attributes
    ----------
    patches : BezierPatch
    corners : Loops
        Holes with their own numbering: loop h lists rows of `parameters`.
    parameters : (s, 2)
        (u, v) of every hole corner.
    centers : (g, 2)
        (u, v) of the mean of the hole's corners.
    ill_conditioned : (g,) bool
        The vertices do not determine the curvature: too few, nearly on a conic, or a tile stands across.
    residuals : (g,), units
        Largest distance of a surrounding vertex to its point of the patch.
    """

    patches: BezierPatch
    corners: Loops
    parameters: Float[np.ndarray, "s 2"]
    centers: Float[np.ndarray, "g 2"]
    ill_conditioned: Bool[np.ndarray, " g"]
    residuals: Float[np.ndarray, " g"]

    def sample(self, n: int) -> Float[np.ndarray, "g k m 3"]:
        """Return a grid of points of every patch over its hole, units.

        Where every hole has four corners, point (i, j) is S at the bilinear blend of the corners q_0 ... q_3 in
        parameters, (1-s)(1-t) q_0 + s(1-t) q_1 + st q_2 + (1-s)t q_3 with s = i/(n-1), t = j/(n-1). Else it is S
        at (1-s) c + s q(j), from the hole's center c to the point q(j) of its polygon, which starts and ends at q_0
        and meets every corner.

        Parameters
        ----------
        n : int
            Points along every side, or from the center to the rim.

        Returns
        -------
        (g, n, m, 3)
            m = n for quadrilaterals. NaN where the curvature is not determined.

        Raises
        ------
        ParameterError
            Where n is below 2.
        """
        if n < 2:
            raise ParameterError(f"sample: expected at least 2 points along every side, got {n}")
        sizes = self.corners.sizes
        most = int(sizes.max(initial=4))
        m = n if (sizes == 4).all() else 2 * most + 1
        places = np.full((len(self.patches), n, m, 2), np.nan)
        s = np.linspace(0.0, 1.0, n)[:, None]
        for size, (which, rows) in self.corners.by_size().items():
            corner = self.parameters[rows]
            if m == n and size == 4:
                weights = np.stack([(1 - s) * (1 - s.T), s * (1 - s.T), s * s.T, (1 - s) * s.T])
                places[which] = np.einsum("cij,gcd->gijd", weights, corner)
            else:
                rim = np.einsum("jc,gcd->gjd", _round_trip(size, m), corner)
                center = self.centers[which, None, None]
                places[which] = center + s[:, :, None] * (rim[:, None] - center)
        flat = places.reshape(len(places), n * m, 2)
        points = self.patches.evaluate(flat[..., 0], flat[..., 1]).reshape(len(places), n, m, 3)
        return np.where(self.ill_conditioned[:, None, None, None], np.nan, points)


def hole_patches(
    points: Float[np.ndarray, "n 3"], tessellation: Tessellation, construction: str = "tiles"
) -> HolePatches:
    """Return the patch of every closed hole.

    Parameters are the positions in the best plane of the vertices of the tiles round the hole, scaled to [0, 1]^2
    alike in both directions; normals of the patch are on the tiles' front side. The patch does not depend on any
    numbering.

    Parameters
    ----------
    points : (n, 3), units
    tessellation : Tessellation
    construction : {"tiles", "corners", "corners_and_normals"}
        What the patch is fitted to: the vertices of the tiles round the hole; the corners of the hole alone; these
        with the mean of the normals of the two tiles that meet there. See :mod:`analysis.constructions`.

    Raises
    ------
    ParameterError
        Where there is no such construction.

    Examples
    --------
    >>> from kirisurf.pattern import quad_pattern
    >>> pattern = quad_pattern(2, 2)
    >>> flat = np.pad(pattern.deployed, ((0, 0), (0, 1)))
    >>> len(hole_patches(flat, pattern, "corners").patches)
    9
    """
    if construction not in BY_NAME:
        expected = ", ".join(CONSTRUCTIONS)
        raise ParameterError(f"patches: expected one of {expected}, got {construction!r}")
    frames = hole_frames(points, tessellation)
    heights = BY_NAME[construction](points, tessellation, frames)
    g, holes = len(frames.around), tessellation.holes
    steps = heights.sizes[:, None] * (2 * np.arange(4) / 3 - 1)
    net = np.stack(
        np.broadcast_arrays(steps[:, :, None], steps[:, None, :], heights.nets),
        axis=3,
    )
    corners = 0.5 + frames.local(points, holes)[:, :2] / (2 * heights.sizes[holes.owners, None])
    middle = np.stack([np.bincount(holes.owners, corners[:, i], g) for i in range(2)], axis=1)
    return HolePatches(
        patches=BezierPatch(np.einsum("gijk,gkl->gijl", net, frames.axes) + frames.centers[:, None, None]),
        corners=Loops(holes.offsets, np.arange(len(corners))),
        parameters=corners,
        centers=middle / np.maximum(holes.sizes, 1)[:, None],
        ill_conditioned=(heights.conditions > LARGEST_CONDITION) | (frames.steepest < STEEPEST),
        residuals=heights.residuals,
    )


def _round_trip(size: int, m: int) -> np.ndarray:
    """Weights (m, size) of a polygon's corners in m > size points along it, from corner 0 through all and back."""
    first = np.arange(size + 1) * (m - 1) // size
    side = np.minimum(np.searchsorted(first, np.arange(m), side="right") - 1, size - 1)
    along = (np.arange(m) - first[side]) / (first[side + 1] - first[side])
    weights = np.zeros((m, size))
    np.add.at(weights, (np.arange(m), side), 1 - along)
    np.add.at(weights, (np.arange(m), (side + 1) % size), along)
    return weights
