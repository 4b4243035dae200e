"""Drives: what moves a sheet from flat to deployed, and what is left to itself."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from jaxtyping import Bool, Float

from kirisurf.errors import ParameterError
from kirisurf.tessellation import Tessellation

DRIVES = ("free", "rim", "corners")
"""Names of drives: a load on the slits alone; the outer vertices moved; four of them moved."""

TRAJECTORIES = ("turning", "rigid", "straight")
"""How moved vertices go from one place to the other: as tiles that turn evenly have them, as on the free path without
torsion, which rigid tiles take where there is such a path, or along straight lines."""


def driven_vertices(tessellation: Tessellation, drive: str | Sequence[Any] | np.ndarray) -> Bool[np.ndarray, " n"]:
    """Return which vertices a drive moves.

    Parameters
    ----------
    tessellation : Tessellation
    drive : str or array_like (k,) int
        One of `DRIVES`, or numbers of vertices.

    Raises
    ------
    ParameterError
        Where the drive is unknown, or names no vertex, a vertex that does not exist, or all of them.

    Examples
    --------
    >>> from kirisurf.pattern import quad_pattern
    >>> int(driven_vertices(quad_pattern(2, 2), "corners").sum())
    4
    """
    held = np.zeros(tessellation.n_vertices, bool)
    if isinstance(drive, str):
        if drive not in DRIVES:
            raise ParameterError(f"drive: expected one of {', '.join(DRIVES)}, or numbers of vertices, got {drive!r}")
        if drive == "rim":
            held[tessellation.outline] = True
        elif drive == "corners":
            held[_corners(tessellation)] = True
        return held
    try:
        which = np.asarray(drive)
    except ValueError:  # rows of different lengths
        raise ParameterError(f"drive: expected numbers of vertices, got {drive!r}") from None
    if which.ndim != 1 or which.dtype.kind not in "iu" or not len(which):
        raise ParameterError(
            f"drive: expected numbers of vertices, got an array of {which.dtype} of shape {which.shape}"
        )
    if which.min() < 0 or which.max() >= len(held):
        raise ParameterError(
            f"drive: expected numbers of vertices from 0 to {len(held) - 1}, got {which.min()} to {which.max()}"
        )
    held[which] = True
    if held.all():
        raise ParameterError("drive: expected some vertices to be left free, got all of them")
    return held


def checked_trajectory(trajectory: str) -> str:
    """Return the name of a trajectory.

    Raises
    ------
    ParameterError
        Where there is none of that name.
    """
    if trajectory not in TRAJECTORIES:
        raise ParameterError(f"trajectory: expected one of {', '.join(TRAJECTORIES)}, got {trajectory!r}")
    return trajectory


def usual_trajectory(dimension: int) -> str:
    """Return the trajectory where none is asked for: turning in the plane, rigid in space.

    In the plane a sheet has few motions, and the free path is itself what a moved rim is compared with. In space the
    rim of tiles that turn evenly strains a sheet that could do without.
    """
    return "turning" if dimension == 2 else "rigid"


@dataclass(frozen=True, eq=False)
class Pins:
    """Supports of three vertices that hold the rigid motions of a sheet and resist nothing else.

    In a frame that is turned with the sheet, the first vertex stays, a far one stays on the axis through both, and in
    space a third stays in the plane of all three: 3 coordinates are held in the plane, 6 in space. The energy does not
    know rigid motions, so that no force is needed for it; in a frame that is not turned, a support would act as soon as
    the far vertex comes nearer than its coordinate across the axis.

    Attributes
    ----------
    first, far, third : int
        Vertices; the third counts in space alone.
    """

    first: int
    far: int
    third: int

    @classmethod
    def of(cls, points: Float[np.ndarray, "n d"]) -> Pins:
        """Choose vertices that lie far apart.

        Examples
        --------
        >>> Pins.of(np.array([[0.0, 0.0], [1.0, 0.0], [3.0, 1.0]])).far
        2
        """
        away = points - points[0]
        far = int((away**2).sum(axis=1).argmax())
        axis = away[far] / max(float(np.linalg.norm(away[far])), 1e-300)
        across = away - np.outer(away @ axis, axis)
        return cls(0, far, int((across**2).sum(axis=1).argmax()))

    def held(self, shape: tuple[int, int]) -> Bool[np.ndarray, "n d"]:
        """Return which coordinates are held, in the turned frame."""
        result = np.zeros(shape, bool)
        result[self.first] = True
        result[self.far, 1:] = True
        result[self.third, 2:] = True
        return result

    def frame(self, points: Float[np.ndarray, "n d"]) -> Float[np.ndarray, "d d"]:
        """Return axes (columns) along which the supports lie: points @ axes are coordinates in the turned frame."""
        d = points.shape[1]
        ways = [points[self.far] - points[self.first], points[self.third] - points[self.first], *np.eye(d)]
        axes: list[np.ndarray] = []
        for way in ways:
            rest = way - sum((way @ axis) * axis for axis in axes)
            size = np.linalg.norm(rest)
            if size > 1e-9 * max(float(np.linalg.norm(way)), 1e-300) and len(axes) < d:
                axes.append(rest / size)
        if np.linalg.det(np.stack(axes, axis=1)) < 0:
            axes[-1] = -axes[-1]
        return np.stack(axes, axis=1)


def _corners(tessellation: Tessellation) -> list[int]:
    """Outer vertices that lie farthest out between the axes of the contracted layout, one in each quadrant."""
    outer = tessellation.outline
    places = tessellation.contracted[outer] - tessellation.contracted[outer].mean(axis=0)
    places = places / np.ptp(places, axis=0)
    return [int(outer[np.argmax(places @ np.array(sign))]) for sign in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
