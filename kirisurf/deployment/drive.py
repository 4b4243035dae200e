"""Drives: what moves a sheet from flat to deployed, and what is left to itself."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool, Float

from kirisurf.deployment.guide import Guide
from kirisurf.errors import ParameterError
from kirisurf.tessellation import Tessellation

DRIVES = ("free", "rim", "corners")
"""Names of drives: a load on the slits alone; the outer vertices moved; four of them moved."""

TRAJECTORIES = ("turning", "straight")
"""How moved vertices go from one place to the other: as tiles that turn evenly have them, or along straight lines."""


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


def rigid_rows(guide: Guide) -> Float[np.ndarray, "m n d"]:
    """Return orthonormal measures of the rigid motions of a sheet: held at 0 change, a sheet does not drift.

    They are the mean place, and the turn that brings the points nearest to the deployed ones: neither resists
    anything, since the energy does not know them.
    """
    points = guide.deployed - guide.deployed.mean(axis=0)
    n, d = points.shape
    rows = []
    for i in range(d):
        row = np.zeros((n, d))
        row[:, i] = 1.0
        rows.append(row.ravel())
        for j in range(i):
            row = np.zeros((n, d))
            row[:, i], row[:, j] = -points[:, j], points[:, i]
            rows.append(row.ravel())
    return np.linalg.qr(np.stack(rows, axis=1))[0].T.reshape(-1, n, d)


def _corners(tessellation: Tessellation) -> list[int]:
    """Outer vertices that lie farthest out between the axes of the contracted layout, one in each quadrant."""
    outer = tessellation.outline
    places = tessellation.contracted[outer] - tessellation.contracted[outer].mean(axis=0)
    places = places / np.ptp(places, axis=0)
    return [int(outer[np.argmax(places @ np.array(sign))]) for sign in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
