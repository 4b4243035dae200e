"""The plane over which the patch of a hole is a graph, and what its patch is fitted to there."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from analysis import polygons
from kirisurf.loops import Loops
from kirisurf.surroundings import surrounding_vertices
from kirisurf.tessellation import Tessellation


@dataclass(frozen=True, eq=False)
class HoleFrames:
    """Best planes of the vertices round every hole.

    Attributes
    ----------
    around : Loops
        Vertices of the tiles round every hole.
    centers : (g, 3), units
        Their means.
    axes : (g, 3, 3)
        Rows: two directions in the plane, and its normal on the tiles' front side.
    steepest : (g,)
        Smallest cosine of the angle between that normal and those of the tiles: none of them leaves a graph where it
        is near zero or below.
    """

    around: Loops
    centers: Float[np.ndarray, "g 3"]
    axes: Float[np.ndarray, "g 3 3"]
    steepest: Float[np.ndarray, " g"]

    def local(self, points: Float[np.ndarray, "n 3"], loops: Loops) -> Float[np.ndarray, "s 3"]:
        """Return the coordinates in the frames of the points that every hole's loop names."""
        relative = points[loops.indices] - self.centers[loops.owners]
        return np.einsum("sij,sj->si", self.axes[loops.owners], relative)


def hole_frames(points: Float[np.ndarray, "n 3"], tessellation: Tessellation) -> HoleFrames:
    """Return the frame of every closed hole.

    The directions in the plane follow from the positions alone (the direction of sum z^4 with z = x + iy), so that
    they do not depend on any numbering.
    """
    around = surrounding_vertices(tessellation)
    g, owners = len(around), around.owners
    local = points[around.indices]
    center = np.stack([np.bincount(owners, local[:, i], g) for i in range(3)], axis=1)
    center = center / np.maximum(around.sizes, 1)[:, None]
    local = local - center[owners]

    fronts = polygons.area_vectors(points, tessellation.tiles)
    ring = tessellation.hole_tiles
    front = np.stack([np.bincount(ring.owners, fronts[ring.indices, i], g) for i in range(3)], axis=1)
    covariance = np.zeros((g, 3, 3))
    np.add.at(covariance, owners, local[:, :, None] * local[:, None, :])
    normal = np.linalg.eigh(covariance)[1][:, :, 0]
    normal *= np.where(np.einsum("gi,gi->g", normal, front) < 0, -1.0, 1.0)[:, None]
    steepest = np.ones(g)
    tile_normal = polygons.unit(fronts)[ring.indices]
    np.minimum.at(steepest, ring.owners, np.einsum("ri,ri->r", tile_normal, normal[ring.owners]))

    first, second = polygons.frames(normal)
    z = np.einsum("si,si->s", local, first[owners]) + 1j * np.einsum("si,si->s", local, second[owners])
    fourth = np.bincount(owners, (z**4).real, g) + 1j * np.bincount(owners, (z**4).imag, g)
    turn = np.exp(0.25j * np.angle(fourth))[:, None]
    along = turn.real * first + turn.imag * second
    return HoleFrames(around, center, np.stack([along, np.cross(normal, along), normal], axis=1), steepest)
