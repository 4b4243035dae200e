"""The conformal map of a disk to a rectangle whose corners are four points of its boundary."""

from __future__ import annotations

from dataclasses import replace

import igl
import numpy as np
from jaxtyping import Float, Int
from scipy.sparse import csc_matrix

from kirisurf.flattening import Flattening, checked_flattening, positive_solver
from kirisurf.gate import check_native
from kirisurf.placement import main_direction


def rectangle_corners(flattening: Flattening) -> tuple[Int[np.ndarray, " 4"], bool]:
    """Choose four boundary vertices, counter-clockwise, as corners of a rectangle.

    Four clear corners of the outline (turning by more than 45 degrees within 5 % of its length) are taken as
    they are; otherwise the points of the outline that reach farthest towards the corners of the smallest
    rectangle round it.

    Returns
    -------
    corners : (4,) int
        Vertices of the surface, the first one at the lower left.
    found : bool
        True where the outline has four clear corners.
    """
    loop = np.asarray(flattening.surface.boundary_loops[0])
    curve = flattening.uv[loop]
    angle = main_direction(flattening.outline)
    frame = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    local = curve @ frame
    local = local - 0.5 * (local.min(axis=0) + local.max(axis=0))
    sharp = _clear_corners(local)
    if len(sharp) == 4:
        chosen, found = sharp, True
    else:
        half = 0.5 * np.ptp(local, axis=0)
        towards = local / half
        chosen = np.array([_farthest(towards @ np.array(d)) for d in ((-1, -1), (1, -1), (1, 1), (-1, 1))])
        found = False
    # start at the corner nearest to the lower left, keep the counter-clockwise order of the loop
    chosen = np.sort(chosen)
    score = local[chosen].sum(axis=1)
    first = int(np.flatnonzero(score <= score.min() + 1e-6 * np.ptp(local))[0])
    return loop[np.roll(chosen, -first)], found


def map_to_rectangle(flattening: Flattening, corners: Int[np.ndarray, " 4"]) -> Flattening:
    """Map the surface conformally to a rectangle with the given corners.

    Two harmonic functions, one 0 and 1 on the left and right side, one on the bottom and top, are the
    coordinates; the Dirichlet energy of the first is height over width. The rectangle has the area of the
    given flattening.

    Raises
    ------
    UnusableError
        Where the map is not one to one.
    """
    surface = flattening.surface
    vertices, faces = check_native(surface.vertices, surface.faces, surface.name)
    unit = (vertices - vertices.mean(axis=0)) / surface.diagonal
    laplacian = -csc_matrix(igl.intrinsic_delaunay_cotmatrix(unit, faces)[0])
    loop = np.asarray(surface.boundary_loops[0])
    start = int(np.flatnonzero(loop == corners[0])[0])
    loop = np.roll(loop, -start)
    ends = [int(np.flatnonzero(loop == c)[0]) for c in corners] + [len(loop)]
    loop = np.r_[loop, loop[:1]]
    bottom, right, top, left = (loop[ends[k] : ends[k + 1] + 1] for k in range(4))
    across = _harmonic(laplacian, left, right)
    along = _harmonic(laplacian, bottom, top)
    ratio = np.sqrt(float(along @ laplacian @ along) / float(across @ laplacian @ across))
    height = np.sqrt(flattening.outline.area / ratio)
    return checked_flattening(surface, np.stack([across * ratio * height, along * height], axis=1), "rectangle")


def turned_by_a_quarter(rectangle: Flattening) -> Flattening:
    """Return a map to a rectangle with its second corner at the lower left: the map that belongs to those corners."""
    width = rectangle.uv[:, 0].max()
    return replace(rectangle, uv=np.stack([rectangle.uv[:, 1], width - rectangle.uv[:, 0]], axis=1))


def _harmonic(laplacian: csc_matrix, zero: np.ndarray, one: np.ndarray) -> Float[np.ndarray, " v"]:
    value = np.zeros(laplacian.shape[0])
    value[one] = 1.0
    free = np.setdiff1d(np.arange(len(value)), np.concatenate([zero, one]))
    rows = laplacian[free]
    value[free] = positive_solver(rows[:, free])(-(rows @ value))
    return value


def _farthest(score: np.ndarray) -> int:
    """First index within rounding of the largest score."""
    return int(np.flatnonzero(score >= score.max() - 1e-6)[0])


def _clear_corners(curve: np.ndarray) -> np.ndarray:
    """Positions where the outline turns left by more than 45 degrees within 5 % of its length."""
    step = np.roll(curve, -1, axis=0) - curve
    length = np.linalg.norm(step, axis=1)
    direction = np.arctan2(step[:, 1], step[:, 0])
    turning = (direction - np.roll(direction, 1) + np.pi) % (2 * np.pi) - np.pi
    place = np.r_[0, np.cumsum(length)][:-1]
    total = length.sum()
    found: list[int] = []
    order = np.lexsort((np.arange(len(turning)), -np.round(turning, 6)))
    for k in order:
        away = np.abs((place - place[k] + 0.5 * total) % total - 0.5 * total)
        near = away <= 0.025 * total
        if turning[near].sum() <= np.radians(45):
            continue
        if all(min(abs(place[k] - place[j]), total - abs(place[k] - place[j])) > 0.05 * total for j in found):
            found.append(int(k))
    return np.array(sorted(found), dtype=np.int64)
