"""Drives: what moves a sheet from flat to deployed, and what is left to itself."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float

from kirisurf.errors import ParameterError
from kirisurf.tessellation import Tessellation

DRIVES = ("free", "rim", "corners")
"""Names of drives: a load on the slits alone; the outer vertices moved; four of them moved."""

TRAJECTORIES = ("turning", "rigid", "straight")
"""How moved vertices go from one place to the other: as tiles that turn evenly have them, as on the free path without
torsion, which rigid tiles take where there is such a path, or along straight lines."""


def driven_vertices(tessellation: Tessellation, drive: str | np.ndarray) -> Bool[np.ndarray, " n"]:
    """Return which vertices a drive moves.

    Parameters
    ----------
    tessellation : Tessellation
    drive : str or (k,) int
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
    which = np.asarray(drive)
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


def pinned_coordinates(points: Float[np.ndarray, "n d"]) -> Bool[np.ndarray, "n d"]:
    """Return the coordinates, 3 in the plane and 6 in space, that hold the rigid motions of a sheet and nothing else.

    All of one vertex, those of a far one across the line between the two, and in space one of a third across the
    plane of all three: no more than supports that resist nothing, since the energy does not know rigid motions.

    Examples
    --------
    >>> pinned_coordinates(np.array([[0.0, 0.0], [1.0, 0.0], [3.0, 1.0]])).tolist()
    [[True, True], [False, False], [False, True]]
    """
    _, d = points.shape
    result = np.zeros(points.shape, bool)
    away = points - points[0]
    far = int((away**2).sum(axis=1).argmax())
    along = int(np.abs(away[far]).argmax())
    result[0] = True
    result[far, np.arange(d) != along] = True
    if d == 3:
        normals = np.cross(away[far], away)
        third = int((normals**2).sum(axis=1).argmax())
        result[third, int(np.abs(normals[third]).argmax())] = True
    return result


def _corners(tessellation: Tessellation) -> list[int]:
    """Outer vertices that lie farthest out between the axes of the contracted layout, one in each quadrant."""
    outer = tessellation.outline
    places = tessellation.contracted[outer] - tessellation.contracted[outer].mean(axis=0)
    places = places / np.ptp(places, axis=0)
    return [int(outer[np.argmax(places @ np.array(sign))]) for sign in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
