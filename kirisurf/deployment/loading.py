"""What drives a sheet besides vertices that are moved: a load on its mean opening, and soft springs that guide it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from kirisurf.deployment.angles import smooth_angles, smooth_values
from kirisurf.deployment.energy import Energy

STIFFNESS = 100.0
"""Stiffness of the spring on the mean opening, in units of the energy per radian squared: so stiff that it rules it."""


@dataclass(frozen=True, eq=False)
class Anchor:
    """Soft springs from every vertex to a place: stiffness / 2 times the mean of |x - place|^2 / edge^2.

    Attributes
    ----------
    points : (n, d)
    stiffness : float
        In units of the energy.
    """

    points: Float[np.ndarray, "n d"]
    stiffness: float


@dataclass(frozen=True, eq=False)
class Loading:
    """A load on the mean opening of the slits, and anchors; either may be absent.

    Attributes
    ----------
    opening : float, optional
        Mean opening in radians that a spring of stiffness `STIFFNESS` asks for.
    anchor : Anchor, optional
    force : float, optional
        Instead of the spring a force that does not change: energy per radian of the mean opening.
    """

    opening: float | None = None
    anchor: Anchor | None = None
    force: float | None = None


@dataclass(frozen=True, eq=False)
class Loaded:
    """Energy of a sheet and of its loading at one set of points, lengths in tile edges.

    Attributes
    ----------
    total, energy : float
        With the loading, and without.
    gradient : (n, d)
        Derivatives of the total, over the force of a rod with strain 1.
    bends : list
        Second derivatives of the elements, the load's curvature among those of the hinges.
    slope : (n, d) or None
        Derivatives of the mean opening, where it is loaded: the spring adds its square over `compliance`.
    compliance : float
        Infinite where a force does not change.
    pull : float
        Multiple of the identity that the anchors add.
    """

    total: float
    energy: float
    gradient: Float[np.ndarray, "n d"]
    bends: list[dict[tuple[int, int], np.ndarray]]
    slope: Float[np.ndarray, "n d"] | None = None
    compliance: float = 0.0
    pull: float = 0.0


def mean_opening(energy: Energy, points: Float[np.ndarray, "n d"]) -> float:
    """Return the mean opening in radians: in space of angles that are rounded where they close."""
    return float(smooth_values(energy.openings(points), energy.dimension).mean())


def total_energy(energy: Energy, points: Float[np.ndarray, "n d"], loading: Loading) -> float:
    """Return the energy of a sheet with that of its loading."""
    total = energy.value(points)
    if loading.anchor is not None:
        total += _spring(energy, loading.anchor) * 0.5 * float(((points - loading.anchor.points) ** 2).sum())
    if loading.force is not None:
        total -= loading.force * mean_opening(energy, points)
    elif loading.opening is not None:
        total += 0.5 * STIFFNESS * (mean_opening(energy, points) - loading.opening) ** 2
    return total


def loaded(energy: Energy, points: Float[np.ndarray, "n d"], loading: Loading, curved: bool = True) -> Loaded:
    """Return the energy of a sheet with its loading and all derivatives."""
    found = energy.evaluate(points, curved)
    unit, length = energy.unit_force, energy.length
    total, gradient, pull = found.value, found.gradient / unit, 0.0
    if loading.anchor is not None:
        spring, off = _spring(energy, loading.anchor), points - loading.anchor.points
        total += 0.5 * spring * float((off**2).sum())
        gradient, pull = gradient + spring / unit * off, spring * length / unit
    if loading.opening is None and loading.force is None:
        return Loaded(total, found.value, gradient, found.bends, pull=pull)
    vectors = energy.gathering.vectors(points)
    angles, (first, second) = smooth_angles(vectors[1][0], vectors[1][1], energy.hinges.angles(vectors[1]))
    count = len(angles)
    parts = [np.zeros_like(part) for part in vectors]
    parts[1] = first / count
    slope = energy.gathering.forces(parts)
    mean = float(angles.mean())
    if loading.force is not None:
        load, compliance = -loading.force, np.inf
        total += load * mean
    else:
        load, compliance = STIFFNESS * (mean - (loading.opening or 0.0)), unit * length / STIFFNESS
        total += 0.5 * load**2 / STIFFNESS
    bends = list(found.bends)
    bends[1] = {pair: block + load / count * second[pair] for pair, block in bends[1].items()}
    return Loaded(total, found.value, gradient + load / unit * slope, bends, length * slope, compliance, pull)


def _spring(energy: Energy, anchor: Anchor) -> float:
    return anchor.stiffness / (energy.n_vertices * energy.length**2)
