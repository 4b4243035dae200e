"""Plates: flat convex polygons with a thickness, and how deep two of them reach into each other."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Bool, Float

from analysis import polygons

LEVEL = 1e-8
"""Height over the edge length up to which a plate lies in the plane of another one; below that is rounding."""

_PARALLEL = 1e-9  # sine of the angle of two lines from which their cross product has a direction


@dataclass(frozen=True, eq=False)
class Plates:
    """One plate per row.

    Attributes
    ----------
    corners : (m, k, 3), units
        Points whose convex hull is the middle plane.
    sides : (m, s, 3)
        Unit vectors along the sides, zero for one without length.
    normals : (m, 3)
        Unit normals.
    thickness : float, units
    """

    corners: Float[np.ndarray, "m k 3"]
    sides: Float[np.ndarray, "m s 3"]
    normals: Float[np.ndarray, "m 3"]
    thickness: float = 0.0

    @classmethod
    def of(cls, corners: Float[np.ndarray, "m k 3"], normals: Float[np.ndarray, "m 3"], thickness: float) -> Plates:
        """Return the plates over convex polygons, which may repeat corners."""
        return cls(corners, polygons.unit(np.roll(corners, -1, axis=1) - corners), normals, thickness)

    def chosen(self, which: np.ndarray) -> Plates:
        """Return some of the plates."""
        return Plates(self.corners[which], self.sides[which], self.normals[which], self.thickness)

    def cut(
        self, at: Float[np.ndarray, "m 3"], inward: Float[np.ndarray, "m 3"], distance: Float[np.ndarray, " m"]
    ) -> tuple[Plates, Bool[np.ndarray, " m"]]:
        """Return what of every plate lies at least so far from a point, along a unit vector, and whether any does."""
        height = np.einsum("mkc,mc->mk", self.corners - at[:, None], inward) - distance[:, None]
        following = np.roll(self.corners, -1, axis=1)
        after = np.roll(height, -1, axis=1)
        best = np.argmax(height, axis=1)
        inner = np.take_along_axis(self.corners, best[:, None, None], axis=1)
        # every side shrinks to its part beyond the cut; one without such a part to a corner that is beyond it
        fall = np.where(height == after, 1.0, height - after)
        crossing = self.corners + (height / fall)[..., None] * (following - self.corners)
        begin = np.where((height < 0)[..., None], crossing, self.corners)
        end = np.where((after < 0)[..., None], crossing, following)
        gone = ((height < 0) & (after < 0))[..., None]
        kept = np.concatenate([np.where(gone, inner, begin), np.where(gone, inner, end)], axis=1)
        along = np.cross(self.normals, inward)[:, None]
        left = Plates(kept, np.concatenate([self.sides, along], axis=1), self.normals, self.thickness)
        return left, height.max(axis=1) > 0

    @property
    def sideways(self) -> Float[np.ndarray, "m s 3"]:
        """Normals of the sides within the plates' planes."""
        return np.cross(self.sides, self.normals[:, None])

    def extent(self, axes: Float[np.ndarray, "m a 3"]) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest place (m, a) of every plate along axes."""
        places = np.einsum("mac,mkc->mak", axes, self.corners)
        half = 0.5 * self.thickness * np.abs(np.einsum("mac,mc->ma", axes, self.normals))
        return places.min(axis=2) - half, places.max(axis=2) + half


def depths(one: Plates, two: Plates, edge_length: float, least: float = 0.0) -> Float[np.ndarray, " m"]:
    """Return the depth to which the plates of every row reach into each other, negative where they do not.

    The depth is the length of the shortest shift that parts the two, among the shifts within the plane of either of
    them. Why not among all: two tiles that overlap flat in one plane are as deep in each other as they overlap, not
    as they are thick. With the axes a of the separating-axis theorem (normals of both prisms' faces, cross products
    of their edges) it is min_a o(a) / max_i |a - (a . n_i) n_i|, o(a) being the overlap of the shadows on a.

    Parameters
    ----------
    one, two : Plates
        With equally many rows.
    edge_length : float, units
        Measure of what is level.
    least : float, units
        Depth from which on it is wanted; a smaller one may come back too large, but not above this.

    Returns
    -------
    (m,), units
    """
    level = LEVEL * edge_length
    faces = np.concatenate([one.normals[:, None], two.normals[:, None], one.sideways, two.sideways], axis=1)
    depth = _least_overlap(one, two, faces, level)
    open_ = np.flatnonzero(depth > least)
    a, b = one.chosen(open_), two.chosen(open_)
    edges_a = np.concatenate([a.sides, a.normals[:, None]], axis=1)
    edges_b = np.concatenate([b.sides, b.normals[:, None]], axis=1)
    crosses = np.cross(edges_a[:, :, None], edges_b[:, None])
    crosses = crosses.reshape(len(open_), crosses.shape[1] * crosses.shape[2], 3)
    depth[open_] = np.minimum(depth[open_], _least_overlap(a, b, crosses, level))
    return depth


def _least_overlap(one: Plates, two: Plates, axes: np.ndarray, level: float) -> np.ndarray:
    length = np.linalg.norm(axes, axis=2)
    real = length > _PARALLEL
    axes = axes / np.where(real, length, 1.0)[..., None]
    low, high = one.extent(axes)
    lower, higher = two.extent(axes)
    overlap = np.minimum(high - lower, higher - low) + level
    along = np.minimum(*(np.abs(np.einsum("mac,mc->ma", axes, plate.normals)) for plate in (one, two)))
    within = np.sqrt(np.maximum(1.0 - along**2, 0.0))
    shift = overlap / np.maximum(within, 1e-12)
    return np.where(real, shift, np.inf).min(axis=1, initial=np.inf)
