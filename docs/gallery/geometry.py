"""What the numbers of the gallery are measured with: plain geometry, apart from the modules that it is to check."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

import kirisurf

Height = Callable[[np.ndarray, np.ndarray], np.ndarray]


def spacing(design: kirisurf.Design) -> float:
    """Return the side of the square that every tile has of the target: the resolution of a sheet."""
    return float(np.sqrt(design.surface.area / design.tessellation.n_tiles))


def hole_centers(design: kirisurf.Design) -> np.ndarray:
    """Return the mean of the corners of every hole, (h, 3)."""
    return np.array([design.deployed_points[hole].mean(axis=0) for hole in design.tessellation.holes])


def middle_hole(design: kirisurf.Design) -> int:
    """Return the number of the hole nearest to the z axis."""
    return int(np.linalg.norm(hole_centers(design)[:, :2], axis=1).argmin())


def triangles(design: kirisurf.Design) -> np.ndarray:
    """Return tiles and holes as fans of triangles about their middles, (m, 3, 3)."""
    points, fans = design.deployed_points, []
    for loops in (design.tessellation.tiles, design.tessellation.holes):
        for loop in loops:
            ring = points[loop]
            middle = np.broadcast_to(ring.mean(axis=0), ring.shape)
            fans.append(np.stack([middle, ring, np.roll(ring, -1, axis=0)], axis=1))
    return np.concatenate(fans)


def plan_integral(corners: np.ndarray, function: Height, parts: int = 4) -> float:
    """Integrate a function of x and y over the plan of triangles (m, 3, 3), each cut into parts^2 equal ones.

    The midpoint rule in every part: its remainder is that of the function over a small part of a tile.
    """
    a, b, c = (corners[:, k, :2] for k in range(3))
    doubled = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    total = np.zeros(len(corners))
    for i in range(parts):
        for j in range(parts - i):
            upright = ((i + 1 / 3) / parts, (j + 1 / 3) / parts)
            turned = ((i + 2 / 3) / parts, (j + 2 / 3) / parts)
            for s, t in (upright, turned) if i + j < parts - 1 else (upright,):
                place = a + s * (b - a) + t * (c - a)
                total += function(place[:, 0], place[:, 1])
    return float((0.5 * doubled / parts**2) @ total)


def summit(height: Height, reach: float, steps: int = 801) -> tuple[float, float]:
    """Return the highest value of a height over [-reach, reach]^2 and its largest curvature there.

    By a grid, whose step is so small that the height between its points does not matter; the curvature from second
    differences (the tangent plane is level at a summit).
    """
    axis = np.linspace(-reach, reach, steps)
    x, y = np.meshgrid(axis, axis, indexing="ij")
    z = height(x, y)
    i, j = np.unravel_index(z.argmax(), z.shape)
    around, step = z[i - 1 : i + 2, j - 1 : j + 2], axis[1] - axis[0]
    xx = (around[0, 1] - 2 * around[1, 1] + around[2, 1]) / step**2
    yy = (around[1, 0] - 2 * around[1, 1] + around[1, 2]) / step**2
    xy = (around[2, 2] - around[2, 0] - around[0, 2] + around[0, 0]) / (4 * step**2)
    return float(z[i, j]), float(np.abs(np.linalg.eigvalsh([[xx, xy], [xy, yy]])).max())


def tips(design: kirisurf.Design) -> np.ndarray:
    """Return the vertices that follow a planar outline, counter-clockwise round the sheet, (k, 2)."""
    prescribed = design.result.boundary
    if prescribed is None:
        raise ValueError(f"{design.surface.name}: expected a sheet in a planar outline, got none")
    outline = design.tessellation.outline
    return design.deployed_points[outline[np.isin(outline, prescribed.vertices)], :2]


def side_tips(design: kirisurf.Design, side: int) -> np.ndarray:
    """Return those of one side of the outline: 0 below, 1 right, 2 above, 3 left; (k, 2)."""
    prescribed = design.result.boundary
    if prescribed is None:
        raise ValueError(f"{design.surface.name}: expected a sheet in a planar outline, got none")
    return design.deployed_points[prescribed.vertices[prescribed.sides == side], :2]


def line_through(points: np.ndarray) -> tuple[float, float]:
    """Return slope and offset of x = slope y + offset, by least squares."""
    slope, offset = np.polyfit(points[:, 1], points[:, 0], 1)
    return float(slope), float(offset)


def polygon_area(points: ArrayLike) -> float:
    """Return the area of a polygon (k, 2), positive counter-clockwise."""
    x, y = np.asarray(points, dtype=float).T
    return float(0.5 * (x @ np.roll(y, -1) - y @ np.roll(x, -1)))


def parabola_area(chord: float, rise: float) -> float:
    """Return the area between a parabola and its chord: two thirds of the box round it (Archimedes)."""
    return 2 / 3 * chord * rise


def chord_loss(points: np.ndarray, curvature: float) -> float:
    """Return the area that a polygon loses to a curve through its corners: the sum of curvature chord^3 / 12."""
    chords = np.linalg.norm(np.roll(points, -1, axis=0) - points, axis=1)
    return float(curvature * (chords**3).sum() / 12)
