"""The guide: every tile turns evenly from its place in the flat sheet to that in the deployed one."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float
from scipy.sparse import coo_matrix, diags
from scipy.sparse.linalg import splu
from scipy.spatial.transform import Rotation

from kirisurf.arrays import checked, frozen, group_means
from kirisurf.errors import UnusableError
from kirisurf.tessellation import Tessellation

RIGID = 1e-3
"""Largest distance, in tile edges, between a tile and its rigid image in the other state."""


class Guide:
    """States between two that tiles would take if each turned at an even rate.

    At a part f of the way every tile has turned by f of its whole turn about its own axis; tiles then lie where
    hinged corners are nearest to each other (least squares), and vertices where these meet on the mean. At both ends
    this is the sheet itself. It is no path of rigid tiles, but near one where there is one: straight lines between
    the two places of a vertex, the paper's choice, shorten every tile that turns.

    The flat sheet is placed by the rigid motion that brings it nearest to the deployed one.

    Parameters
    ----------
    tessellation : Tessellation
    contracted : (n, 2)
    deployed : (n, d)
        d = 2 in the plane, 3 in space.

    Attributes
    ----------
    flat, deployed : (n, d)
        The two ends.
    turns : (t, 3)
        Rotation vectors of the tiles, radians.

    Raises
    ------
    UnusableError
        Where a tile has different shapes in the two states.
    """

    def __init__(
        self, tessellation: Tessellation, contracted: Float[np.ndarray, "n 2"], deployed: Float[np.ndarray, "n d"]
    ) -> None:
        n, d = tessellation.n_vertices, np.shape(deployed)[-1]
        deployed = checked(deployed, "deployed", (n, d if d in (2, 3) else 3))
        flat = checked(contracted, "contracted", (n, 2))
        self.deployed, self.flat = deployed, frozen(nearest_place(flat, deployed))
        tiles = tessellation.tiles
        self._owners, self._corners, t = tiles.owners, tiles.indices, tessellation.n_tiles
        start, end = (_in_space(state)[self._corners] for state in (self.flat, deployed))
        middles = [group_means(part, self._owners, t) for part in (start, end)]
        self._arms = start - middles[0][self._owners]
        target = end - middles[1][self._owners]
        rotation = _rotations(self._arms, target, self._owners, t)
        self.turns = frozen(rotation.as_rotvec())
        gap = np.linalg.norm(rotation[self._owners].apply(self._arms) - target, axis=1)
        length = np.median(np.linalg.norm(np.diff(flat[tiles.edges], axis=1), axis=2))
        if gap.max() > RIGID * length:
            raise UnusableError(
                f"deployed and contracted sheet: expected tiles of one shape in both, got corners of tile "
                f"{self._owners[gap.argmax()]} that differ by {gap.max() / length:.2g} of a tile edge"
            )
        incidence = coo_matrix((np.ones(len(self._corners)), (self._corners, self._owners)), shape=(n, t)).tocsr()
        weights = np.asarray(incidence.sum(axis=1)).ravel()
        sizes = np.asarray(incidence.sum(axis=0)).ravel()
        self._shares = diags(1.0 / weights) @ incidence
        laplacian = (diags(sizes) - incidence.T @ self._shares).tocsc()
        # the place of the first tile is free: it is set with the mean of all vertices
        self._factor = splu(laplacian[1:, 1:]) if t > 1 else None

    def at(self, fraction: float) -> Float[np.ndarray, "n d"]:
        """Return the points at a part of the way, 0 flat and 1 deployed."""
        t, n = len(self.turns), len(self.flat)
        arms = Rotation.from_rotvec(fraction * self.turns)[self._owners].apply(self._arms)
        own = group_means(arms, self._corners, n)
        right = np.stack([np.bincount(self._owners, column, t) for column in (own[self._corners] - arms).T], axis=1)
        centers = np.zeros((t, 3))
        if self._factor is not None:
            centers[1:] = self._factor.solve(right[1:])
        points = (own + self._shares @ centers)[:, : self.flat.shape[1]]
        middle = (1 - fraction) * self.flat.mean(axis=0) + fraction * self.deployed.mean(axis=0)
        return points + (middle - points.mean(axis=0))

    def straight(self, fraction: float) -> Float[np.ndarray, "n d"]:
        """Return the points on straight lines between the ends, as in the paper."""
        return (1 - fraction) * self.flat + fraction * self.deployed

    def places(self, fractions: Float[np.ndarray, " k"], is_straight: bool = False) -> Float[np.ndarray, "k n d"]:
        """Return the points at several parts of the way."""
        return np.array([self.straight(fraction) if is_straight else self.at(fraction) for fraction in fractions])


def nearest_place(points: Float[np.ndarray, "n c"], others: Float[np.ndarray, "n d"]) -> Float[np.ndarray, "n d"]:
    """Return points, planar ones too, moved rigidly to where they are nearest to others, and never mirrored."""
    d = others.shape[1]
    centered = np.pad(points - points.mean(axis=0), ((0, 0), (0, d - points.shape[1])))
    goal = others - others.mean(axis=0)
    u, _, v = np.linalg.svd(centered.T @ goal)
    signs = np.ones(d)
    signs[-1] = np.sign(np.linalg.det(u @ v))
    return centered @ (u * signs) @ v + others.mean(axis=0)


def _in_space(points: np.ndarray) -> np.ndarray:
    return np.pad(points, ((0, 0), (0, 3 - points.shape[1])))


def _rotations(start: np.ndarray, end: np.ndarray, owners: np.ndarray, t: int) -> Rotation:
    """Rotations of flat tiles onto themselves elsewhere, by the covariances of their corners and of their normals."""
    covariance = np.zeros((t, 3, 3))
    np.add.at(covariance, owners, end[:, :, None] * start[:, None, :])
    normals = []
    for side in (start, end):
        # twice the area, with its direction: corners come loop after loop
        after = np.arange(len(owners)) + 1
        last = np.flatnonzero(np.r_[owners[1:] != owners[:-1], True])
        after[last] = np.r_[0, last[:-1] + 1]
        area = np.zeros((t, 3))
        np.add.at(area, owners, np.cross(side, side[after]))
        normals.append(area / np.linalg.norm(area, axis=1, keepdims=True))
    size = np.trace(covariance, axis1=1, axis2=2)
    covariance += np.abs(size)[:, None, None] * normals[1][:, :, None] * normals[0][:, None, :]
    u, _, v = np.linalg.svd(covariance)
    u[:, :, 2] *= np.sign(np.linalg.det(u @ v))[:, None]
    return Rotation.from_matrix(u @ v)
