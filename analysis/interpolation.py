"""Between the two states of a sheet: every tile moved rigidly, turned a part of its way. For the eye, no mechanism."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int
from numpy.typing import ArrayLike
from scipy.sparse import coo_matrix, csc_matrix, identity
from scipy.sparse.linalg import SuperLU, splu
from scipy.spatial.transform import Rotation

from kirisurf.arrays import checked, frozen, group_means
from kirisurf.loops import Loops


@dataclass(frozen=True, eq=False)
class Interpolation:
    """States between the contracted and the deployed one.

    Every tile turns about one axis from its contracted to its deployed attitude, by the same share of its angle.
    Its place follows from its neighbors: tiles are shifted so that the copies of their common vertices lie as near to
    each other as they can (least squares), and a vertex lies in the mean of its copies. Where a pattern can move
    without strain in the plane, as rotating squares do, this is its mechanism; elsewhere the tiles are strained a
    little on the way, and nothing says that real material takes it.

    Attributes
    ----------
    tiles : Loops
    contracted, deployed : (n, 3)
    turns : (t, 3)
        Axis times angle of the turn of every tile.
    first, last : (s, 3)
        Corners of the tiles about the tiles' middles, in both states, turned back to the contracted attitude.
    """

    tiles: Loops
    contracted: Float[np.ndarray, "n 3"]
    deployed: Float[np.ndarray, "n 3"]
    turns: Float[np.ndarray, "t 3"]
    first: Float[np.ndarray, "s 3"]
    last: Float[np.ndarray, "s 3"]
    _factor: SuperLU

    @classmethod
    def between(cls, tiles: Loops, contracted: ArrayLike, deployed: ArrayLike) -> Interpolation:
        """Return the interpolation of two states (n, 3) of the same tiles."""
        flat = checked(contracted, "contracted vertices", (None, 3))
        space = checked(deployed, "deployed vertices", (len(flat), 3))
        owner, t = tiles.owners, len(tiles)
        first = flat[tiles.indices] - group_means(flat[tiles.indices], owner, t)[owner]
        last = space[tiles.indices] - group_means(space[tiles.indices], owner, t)[owner]
        turns = _turns(first, last, owner, t)
        back = Rotation.from_rotvec(turns).inv()
        factor = splu(_laplacian(tiles.indices, owner, len(flat), t))
        return cls(tiles, flat, space, frozen(turns), frozen(first), frozen(back[owner].apply(last)), factor)

    def at(self, share: float) -> Float[np.ndarray, "n 3"]:
        """Return the vertices (n, 3) at a share of the way: 0 is contracted, 1 deployed, both exactly.

        Parameters
        ----------
        share : float
            From 0 to 1.
        """
        share = min(max(float(share), 0.0), 1.0)
        if share in (0.0, 1.0):
            return self.deployed if share else self.contracted
        indices, owner = self.tiles.indices, self.tiles.owners
        corners = (1 - share) * self.first + share * self.last
        turned = Rotation.from_rotvec(share * self.turns)[owner].apply(corners)
        n, t = len(self.deployed), len(self.tiles)
        blend = (1 - share) * self.contracted + share * self.deployed
        # shifts that bring every tile's corner to the mean of the vertex, near where a straight blend has it
        middles = group_means(blend[indices], owner, t)
        apart = group_means(turned + middles[owner], indices, n)[indices] - turned - middles[owner]
        wanted = np.stack([np.bincount(owner, column, t) for column in apart.T], axis=1)
        middles = middles + self._factor.solve(wanted)
        moved = group_means(turned + middles[owner], indices, n)
        return frozen(moved + (blend.mean(axis=0) - moved.mean(axis=0)))


def _turns(first: np.ndarray, last: np.ndarray, owner: Int[np.ndarray, " s"], t: int) -> np.ndarray:
    """Rotation of every tile from its corners in one state to those in the other, (t, 3): Kabsch's."""
    products = np.stack([np.bincount(owner, first[:, i] * last[:, j], t) for i in range(3) for j in range(3)], axis=1)
    left, _, right = np.linalg.svd(products.reshape(t, 3, 3))
    # flat tiles leave the sign of the third axis open: the right-handed one
    left[:, :, 2] *= np.sign(np.linalg.det(left) * np.linalg.det(right))[:, None]
    return Rotation.from_matrix(np.swapaxes(left @ right, 1, 2)).as_rotvec()


def _laplacian(indices: np.ndarray, owner: np.ndarray, n: int, t: int) -> csc_matrix:
    """Normal matrix (t, t) of the shifts, with the free shift of the whole sheet held."""
    incidence = coo_matrix((np.ones(len(indices)), (owner, indices)), shape=(t, n)).tocsr()
    copies = np.maximum(np.asarray(incidence.sum(axis=0)).ravel(), 1.0)
    sizes = np.asarray(incidence.sum(axis=1)).ravel()
    shared = incidence.multiply(1.0 / copies) @ incidence.T
    diagonal = coo_matrix((sizes, (np.arange(t), np.arange(t))), shape=(t, t))
    return csc_matrix(diagonal - shared + 1e-9 * identity(t))
