"""The energy of a sheet between flat and deployed: rods in the tiles, torsional springs in the slits."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float, Int

from kirisurf.deployment.elements import Contacts, Elements, Folds, Hinges, Rods
from kirisurf.deployment.stiffness import Gathering, Stiffness
from kirisurf.errors import ParameterError

MOST_TORSION = 1e6
"""Largest lambda: slits a million times as stiff as tiles."""


@dataclass(frozen=True, eq=False)
class Evaluation:
    """Energy with derivatives at one set of points.

    Attributes
    ----------
    value : float
    gradient : (n, d)
    bends : list
        Second derivatives of the elements, for :class:`Stiffness` and for `Energy.product`.
    """

    value: float
    gradient: Float[np.ndarray, "n d"]
    bends: list[dict[tuple[int, int], np.ndarray]]


@dataclass(frozen=True, eq=False)
class Energy:
    """The energy of the paper (Choi, Dudte, Mahadevan, 2019), in the plane (d = 2) and in space (d = 3).

    ::

        E(x) = 1/Ns sum ((|xi - xj| - lij) / lij)^2 + lambda 1/Nc sum theta^2 + 1/Ns sum (...)

    The first sum is over the Ns rods: every two corners of a tile, so that its sides and all its diagonals; their
    rest lengths are those of the contracted sheet. The second is over the Nc slit ends, which are closed at rest. The
    third has no part in the paper, and terms with the weight of a rod: in space it keeps tiles flat, in the plane the
    two sides of a slit from overlapping; see :class:`kirisurf.deployment.elements.Folds` and
    :class:`kirisurf.deployment.elements.Contacts`. E is a number: it does not change with the unit of length.

    Attributes
    ----------
    rods : Rods
    hinges : Hinges
    bounds : Folds, Contacts or None
        Folds in space, contacts in the plane; None where there are none, or contacts are left out.
    torsion : float
        lambda.
    n_vertices, dimension : int
    length : float
        Median length of a tile's sides, the unit in which equilibria are sought.
    area : float
        Area of all tiles.
    rod_tiles : (Ns,)
        Tile of every rod.
    n_tiles : int
    """

    rods: Rods
    hinges: Hinges
    bounds: Folds | Contacts | None
    torsion: float
    n_vertices: int
    dimension: int
    length: float
    area: float
    rod_tiles: Int[np.ndarray, " s"]
    n_tiles: int

    @cached_property
    def elements(self) -> tuple[Elements, ...]:
        """The kinds of elements."""
        return (self.rods, self.hinges) if self.bounds is None else (self.rods, self.hinges, self.bounds)

    @cached_property
    def weights(self) -> tuple[float, ...]:
        """Weight of each kind in the energy."""
        rod, slit = 1.0 / len(self.rods.stencil), self.torsion / max(len(self.hinges.stencil), 1)
        return (rod, slit) if self.bounds is None else (rod, slit, rod)

    @cached_property
    def gathering(self) -> Gathering:
        """Vectors of elements from points."""
        return Gathering(self.n_vertices, [kind.stencil for kind in self.elements])

    @cached_property
    def unit_force(self) -> float:
        """Force of a rod of median length with strain 1, in units of energy over length."""
        return 2.0 / (len(self.rods.stencil) * self.length)

    def with_torsion(self, torsion: float) -> Energy:
        """Return the same sheet with another lambda, sharing what does not change."""
        other = Energy(
            self.rods, self.hinges, self.bounds, checked_torsion(torsion), self.n_vertices, self.dimension,
            self.length, self.area, self.rod_tiles, self.n_tiles,
        )  # fmt: skip
        other.__dict__["gathering"] = self.gathering
        return other

    def parts(self, points: Float[np.ndarray, "n d"]) -> tuple[float, float, float]:
        """Return the energies of rods, of slits and of folds or contacts; their sum is E."""
        vectors = self.gathering.vectors(points)
        found = [
            w * float(kind.values(v).sum()) for w, kind, v in zip(self.weights, self.elements, vectors, strict=True)
        ]
        return found[0], found[1], (found[2] if len(found) > 2 else 0.0)

    def value(self, points: Float[np.ndarray, "n d"]) -> float:
        """Return E."""
        return sum(self.parts(points))

    def evaluate(self, points: Float[np.ndarray, "n d"], curved: bool = True) -> Evaluation:
        """Return E with its exact first and second derivatives, the latter those of Gauss and Newton if not curved."""
        value, slopes, bends = 0.0, [], []
        for weight, kind, vectors in zip(self.weights, self.elements, self.gathering.vectors(points), strict=True):
            if weight == 0:
                slopes.append(np.zeros_like(vectors))
                bends.append(_zeros(*vectors.shape))
                continue
            first, second = kind.derivatives(vectors, curved)
            value += weight * float(kind.values(vectors).sum())
            slopes.append(weight * first)
            bends.append({pair: weight * block for pair, block in second.items()})
        return Evaluation(value, self.gathering.forces(slopes), bends)

    def gradient(self, points: Float[np.ndarray, "n d"]) -> Float[np.ndarray, "n d"]:
        """Return the first derivatives of E."""
        return self.evaluate(points, curved=False).gradient

    def product(self, evaluation: Evaluation, shift: Float[np.ndarray, "n d"]) -> Float[np.ndarray, "n d"]:
        """Return the second derivatives of E times a displacement of the points."""
        result = []
        for bend, vectors in zip(evaluation.bends, self.gathering.vectors(shift), strict=True):
            part = np.zeros_like(vectors)
            for (i, j), block in bend.items():
                part[i] += np.einsum("abk,bk->ak", block, vectors[j])
                if i != j:
                    part[j] += np.einsum("abk,ak->bk", block, vectors[i])
            result.append(part)
        return self.gathering.forces(result)

    def stiffness(self, numbers: Int[np.ndarray, "n d"]) -> Stiffness:
        """Return the pattern of the second derivatives by coordinates with the given numbers, -1 for held ones."""
        return Stiffness([kind.stencil for kind in self.elements], numbers)

    def strains(self, points: Float[np.ndarray, "n d"]) -> Float[np.ndarray, " s"]:
        """Return the strain of every rod."""
        return self.rods.strains(self.gathering.vectors(points)[0])

    def tile_strains(self, points: Float[np.ndarray, "n d"]) -> Float[np.ndarray, " t"]:
        """Return the largest strain, regardless of its sign, of every tile's rods."""
        result = np.zeros(self.n_tiles)
        np.maximum.at(result, self.rod_tiles, np.abs(self.strains(points)))
        return result

    def openings(self, points: Float[np.ndarray, "n d"]) -> Float[np.ndarray, " c"]:
        """Return the angles of the slits in radians."""
        return self.hinges.angles(self.gathering.vectors(points)[1])


def checked_torsion(torsion: float) -> float:
    """Return lambda.

    Raises
    ------
    ParameterError
        Where it is negative, not finite, or above `MOST_TORSION`.
    """
    if not (np.isfinite(torsion) and torsion >= 0):
        raise ParameterError(f"lambda: expected a number of at least 0, got {torsion}")
    if torsion > MOST_TORSION:
        raise ParameterError(f"lambda: expected a number of at most {MOST_TORSION:g}, got {torsion}")
    return float(torsion)


def _zeros(p: int, d: int, k: int) -> dict[tuple[int, int], np.ndarray]:
    return {(i, j): np.zeros((d, d, k)) for i in range(p) for j in range(i, p)}
