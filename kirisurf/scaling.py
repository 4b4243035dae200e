"""The frame of a solve: the target moved to the origin and measured in tile edges."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from kirisurf.closest import ClosestPoints
from kirisurf.projection import Projection
from kirisurf.sizes import tile_edges
from kirisurf.surface import Surface
from kirisurf.tessellation import Tessellation


@dataclass(frozen=True, eq=False)
class Frame:
    """A shift and a scale; rotations are left alone, since every row is invariant under them.

    Attributes
    ----------
    origin : (3,)
    length : float
        Median tile edge of the start, the unit of the solve.
    """

    origin: np.ndarray
    length: float

    def into(self, points: np.ndarray) -> np.ndarray:
        """From the target's units to tile edges."""
        return (points - self.origin) / self.length

    def back(self, points: np.ndarray) -> np.ndarray:
        """From tile edges to the target's units."""
        return points * self.length + self.origin


class Scaled:
    """Closest points of a smooth surface, asked and answered in tile edges."""

    def __init__(self, closest: ClosestPoints, frame: Frame) -> None:
        self._closest = closest
        self._frame = frame

    def project(self, points: np.ndarray) -> Projection:
        """Return closest points in units of the frame; shape operators are per tile edge."""
        found = self._closest.project(self._frame.back(points))
        length = self._frame.length
        return Projection(
            points=self._frame.into(found.points),
            distances=found.distances / length,
            normals=found.normals,
            shape_operators=found.shape_operators * length,
            faces=found.faces,
            on_rim=found.on_rim,
            rim_points=self._frame.into(found.rim_points),
            rim_conormals=found.rim_conormals,
        )


def median_edge(tessellation: Tessellation, points: np.ndarray) -> float:
    """Return the median length of the tile edges."""
    return float(np.median(tile_edges(tessellation, points)))


def unit_scale(
    surface: Surface, tessellation: Tessellation, points: np.ndarray, closest: ClosestPoints | None = None
) -> tuple[Frame, Scaled]:
    """Return the frame of a start and the target in it, whose closest points may be at hand."""
    frame = Frame(surface.vertices.mean(axis=0), median_edge(tessellation, points))
    return frame, Scaled(closest or ClosestPoints(surface), frame)
