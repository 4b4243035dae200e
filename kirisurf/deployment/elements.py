"""Springs on a few vertices each: exact energies, forces and stiffnesses, in the plane and in space.

Every element is a function of vectors from one vertex, its origin, to one, two or three others, so that moving
the whole sheet costs nothing by construction. Lengths may have any unit: an energy is a number.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from kirisurf.deployment.angles import signed_angles, smooth_angles, squared_angles
from kirisurf.errors import UnusableError
from kirisurf.vectors import cross, dot

SHORTEST = 1e-9
"""Part of its rest length below which a rod has no direction: there the angle of a fold or slit is none."""

SOFT = 0.01
"""Overlap of two tiles at a slit, radians, over which their contact grows stiff."""


@dataclass(frozen=True, eq=False)
class Rods:
    """Linear springs: ((|u| - l) / l)^2.

    Attributes
    ----------
    stencil : (k, 2)
    lengths : (k,)
        Rest lengths l.
    """

    stencil: Int[np.ndarray, "k 2"]
    lengths: Float[np.ndarray, " k"]

    def strains(self, vectors: Float[np.ndarray, "1 d k"]) -> Float[np.ndarray, " k"]:
        """Return the strains (|u| - l) / l, computed from |u|^2 - l^2 so that small ones keep their digits."""
        squares = (vectors[0] ** 2).sum(axis=0)
        length = np.sqrt(squares)
        return (squares - self.lengths**2) / ((length + self.lengths) * self.lengths)

    def values(self, vectors: Float[np.ndarray, "1 d k"]) -> Float[np.ndarray, " k"]:
        """Return the energy of every rod."""
        return self.strains(vectors) ** 2

    def derivatives(
        self, vectors: Float[np.ndarray, "1 d k"], curved: bool = True
    ) -> tuple[Float[np.ndarray, "1 d k"], dict[tuple[int, int], Float[np.ndarray, "d d k"]]]:
        """Return first and second derivatives."""
        u = vectors[0]
        length = np.maximum(np.sqrt((u**2).sum(axis=0)), SHORTEST * self.lengths)
        direction = u / length
        across = 2 * self.strains(vectors) / (self.lengths * length)
        bend = across if curved else np.zeros_like(across)
        second = (2 / self.lengths**2 - bend) * direction[:, None] * direction[None]
        for i in range(len(u)):
            second[i, i] += bend
        return (across * length * direction)[None], {(0, 0): second}


@dataclass(frozen=True, eq=False)
class Hinges:
    """Torsional springs: the square of the angle of a slit, its sides u and v beginning at the hinge.

    In the plane the angle has a sign and goes on beyond pi, up to 3 pi / 2; below 0 the tiles overlap. In space it is
    that between the two sides, up to pi: a slit that opens further is taken for one that closes on its other side.

    Attributes
    ----------
    stencil : (k, 3)
        Hinge, end of the first side, end of the second; counter-clockwise the slit lies between them.
    """

    stencil: Int[np.ndarray, "k 3"]

    def angles(self, vectors: Float[np.ndarray, "2 d k"]) -> Float[np.ndarray, " k"]:
        """Return the angles of the slits in radians."""
        u, v = vectors
        if len(u) == 2:
            return signed_angles(u, v)
        return np.arctan2(np.sqrt((cross(u, v) ** 2).sum(axis=0)), dot(u, v))

    def values(self, vectors: Float[np.ndarray, "2 d k"]) -> Float[np.ndarray, " k"]:
        """Return the squares of the angles."""
        return self.angles(vectors) ** 2

    def derivatives(
        self, vectors: Float[np.ndarray, "2 d k"], curved: bool = True
    ) -> tuple[Float[np.ndarray, "2 d k"], dict[tuple[int, int], Float[np.ndarray, "d d k"]]]:
        """Return first and second derivatives."""
        return squared_angles(vectors[0], vectors[1], self.angles(vectors))


@dataclass(frozen=True, eq=False)
class Contacts:
    """Springs that keep the two sides of a slit apart in the plane: the square of the angle by which they overlap.

    An angle above 0 costs nothing. Between 0 and -d, with d = `SOFT`, the stiffness grows evenly, so that second
    derivatives have no step: t^3 / (3 d) for an overlap t below d, and t^2 - d t + d^2 / 3 above.

    Attributes
    ----------
    stencil : (k, 3)
        As of the hinges.
    """

    stencil: Int[np.ndarray, "k 3"]

    def values(self, vectors: Float[np.ndarray, "2 2 k"]) -> Float[np.ndarray, " k"]:
        """Return the energy of every contact."""
        over = np.maximum(-signed_angles(vectors[0], vectors[1]), 0.0)
        return np.where(over < SOFT, over**3 / (3 * SOFT), over**2 - SOFT * over + SOFT**2 / 3)

    def derivatives(
        self, vectors: Float[np.ndarray, "2 2 k"], curved: bool = True
    ) -> tuple[Float[np.ndarray, "2 2 k"], dict[tuple[int, int], Float[np.ndarray, "2 2 k"]]]:
        """Return first and second derivatives."""
        angle = signed_angles(vectors[0], vectors[1])
        over = np.maximum(-angle, 0.0)
        slope = -np.where(over < SOFT, over**2 / SOFT, 2 * over - SOFT)
        bend = 2 * np.minimum(over / SOFT, 1.0)
        _, (first, second) = smooth_angles(vectors[0], vectors[1], angle)
        turned = slope if curved else np.zeros_like(slope)
        return slope * first, {
            (i, j): bend * first[i][:, None] * first[j][None] + turned * second[i, j] for i, j in second
        }


@dataclass(frozen=True, eq=False)
class Folds:
    """Springs against folding: (det(u, v, w) / s)^2, the height of a corner over the plane of three others.

    Rods hold a flat tile in its plane to second order only. The height is measured over the width of the tile, with
    s = (2 A)^(3/2) and A the area of the triangle of the three. In the plane it is zero, and there are none.

    Attributes
    ----------
    stencil : (k, 4)
        Three corners of the tile, and the one whose height is meant.
    scales : (k,)
        s of every fold.
    """

    stencil: Int[np.ndarray, "k 4"]
    scales: Float[np.ndarray, " k"]

    def heights(self, vectors: Float[np.ndarray, "3 3 k"]) -> Float[np.ndarray, " k"]:
        """Return the heights, over the width of the tile."""
        return dot(cross(vectors[0], vectors[1]), vectors[2]) / self.scales

    def values(self, vectors: Float[np.ndarray, "3 3 k"]) -> Float[np.ndarray, " k"]:
        """Return the energy of every fold."""
        return self.heights(vectors) ** 2

    def derivatives(
        self, vectors: Float[np.ndarray, "3 3 k"], curved: bool = True
    ) -> tuple[Float[np.ndarray, "3 3 k"], dict[tuple[int, int], Float[np.ndarray, "3 3 k"]]]:
        """Return first and second derivatives."""
        u, v, w = vectors
        slopes = np.stack([cross(v, w), cross(w, u), cross(u, v)]) / self.scales
        height = 2 * self.heights(vectors)
        second = {(i, j): 2 * slopes[i][:, None] * slopes[j][None] for i in range(3) for j in range(i, 3)}
        # d2 det / du dv = -[w]x, d2 det / du dw = [v]x, d2 det / dv dw = -[u]x with [a]x b = a x b
        for pair, vector, sign in (((0, 1), w, -1.0), ((0, 2), v, 1.0), ((1, 2), u, -1.0)) if curved else ():
            part = sign * height * vector / self.scales
            for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
                second[pair][i, j] -= part[k]
                second[pair][j, i] += part[k]
        return height * slopes, second


def folds_of(
    flat: Float[np.ndarray, "n 2"], loops: Int[np.ndarray, "g k"]
) -> tuple[Int[np.ndarray, "f 4"], Float[np.ndarray, " f"]]:
    """Return stencils and scales of the folds of flat tiles with equally many corners, more than three.

    Raises
    ------
    UnusableError
        Where a tile has no area.
    """
    size = loops.shape[1]
    triples = np.array([(i, j, k) for i in range(size) for j in range(i + 1, size) for k in range(j + 1, size)])
    a, b, c = flat[loops[:, triples]].transpose(2, 3, 0, 1)
    double = np.abs((b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]))
    best = double.argmax(axis=1)
    most = double[np.arange(len(loops)), best]
    if not most.min() > 0:
        raise UnusableError("tessellation: expected tiles with an area, got one without")
    base = triples[best]
    others = np.array([[k for k in range(size) if k not in row] for row in base.tolist()])
    stencil = np.stack([np.repeat(np.take_along_axis(loops, base[:, [i]], 1), size - 3, 1) for i in range(3)], axis=2)
    stencil = np.concatenate([stencil, np.take_along_axis(loops, others, 1)[:, :, None]], axis=2).reshape(-1, 4)
    return stencil, np.repeat(most**1.5, size - 3)


Elements = Rods | Hinges | Contacts | Folds
"""Equal elements: k of them, each on the vectors from the first vertex of its stencil to the others.

`values` are their energies, `derivatives` the first by the vectors and the second by pairs (i, j) of them with i <= j;
where not `curved`, the latter are those of Gauss and Newton, in which a spring keeps its direction.
"""
