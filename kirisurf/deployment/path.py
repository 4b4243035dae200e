"""The path of a sheet from flat to deployed: states in equilibrium, and what is measured of each."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from enum import Enum

import numpy as np
from jaxtyping import Bool, Float, Int

from kirisurf.arrays import frozen
from kirisurf.deployment.energy import Energy
from kirisurf.deployment.equilibrium import Equilibrium
from kirisurf.deployment.guide import Guide

STRAINLESS = 1e-12
"""Energy below which a state is taken for one without strain."""

FAR = 1.0
"""Displacement from one state to the next, in tile edges beyond the guide's, that is called a jump."""


ShouldStop = Callable[[], bool]
Progress = Callable[[int, int], None]


class PathStatus(Enum):
    """How the following of a path ended; the value is the sentence that the user reads."""

    COMPLETE = "Complete: every state is in equilibrium."
    JUMPED = "Complete, with jumps: between some states the sheet snapped to a place that no smooth way leads to."
    UNBALANCED = "Incomplete: some states are not in equilibrium. Read their residuals; take more steps."
    INTERRUPTED = "Interrupted: the states so far were kept."


@dataclass(frozen=True, eq=False)
class Path:
    """States of a sheet from flat to deployed, k of them.

    Attributes
    ----------
    torsion : float
        lambda.
    drive : str
        free, rim, corners, or vertices.
    fractions : (k,)
        Part of the way: of the way of the moved vertices, or of the mean opening.
    points : (k, n, d)
    stretch_energies, torsion_energies : (k,)
        Their sum is the energy; folding counts as stretch.
    largest_strains, mean_strains : (k,)
        Over all rods, regardless of sign.
    tile_strains : (k, t)
        Largest of every tile.
    openings : (k, c), radians
        Angles of the slits, in the order of `tessellation.hinges[slit_ends]`.
    residuals : (k,)
        Largest force that nothing balances, over that of a rod with strain 1.
    holding : (k,)
        Largest force with which the drive holds a vertex, over that of a rod with strain 1.
    steps : (k,) int
        Newton steps.
    moves : (k,)
        Largest displacement from the state before, in tile edges.
    status : PathStatus
    """

    torsion: float
    drive: str
    fractions: Float[np.ndarray, " k"]
    points: Float[np.ndarray, "k n d"]
    stretch_energies: Float[np.ndarray, " k"]
    torsion_energies: Float[np.ndarray, " k"]
    largest_strains: Float[np.ndarray, " k"]
    mean_strains: Float[np.ndarray, " k"]
    tile_strains: Float[np.ndarray, "k t"]
    openings: Float[np.ndarray, "k c"]
    residuals: Float[np.ndarray, " k"]
    holding: Float[np.ndarray, " k"]
    steps: np.ndarray
    moves: Float[np.ndarray, " k"]
    status: PathStatus

    @property
    def energies(self) -> Float[np.ndarray, " k"]:
        """The energy at every state."""
        return self.stretch_energies + self.torsion_energies

    @property
    def mean_openings(self) -> Float[np.ndarray, " k"]:
        """Mean angle of the slits in radians."""
        return self.openings.mean(axis=1)


def measured_path(
    energy: Energy,
    guide: Guide,
    drive: str,
    fractions: np.ndarray,
    states: list[Equilibrium],
    interrupted: bool = False,
) -> Path:
    """Return states with what is measured of them."""
    points = np.array([state.points for state in states]).reshape(-1, *guide.flat.shape)
    parts = np.array([energy.parts(p) for p in points]).reshape(-1, 3)
    strains = np.array([np.abs(energy.strains(p)) for p in points]).reshape(-1, len(energy.rods.stencil))
    tiles = np.array([energy.tile_strains(p) for p in points]).reshape(-1, energy.n_tiles)
    holding = [np.linalg.norm(energy.gradient(p), axis=1).max() / energy.unit_force for p in points]
    moves = np.abs(np.diff(points, axis=0)).max(axis=(1, 2), initial=0.0) / energy.length
    far = _is_far(energy, guide, fractions[: len(points)], moves)
    if interrupted or len(points) < len(fractions):
        status = PathStatus.INTERRUPTED
    elif not all(state.is_converged for state in states):
        status = PathStatus.UNBALANCED
    else:
        status = PathStatus.JUMPED if far.any() else PathStatus.COMPLETE
    return Path(
        torsion=energy.torsion,
        drive=drive,
        fractions=frozen(fractions[: len(points)]),
        points=frozen(points),
        stretch_energies=frozen(parts[:, 0] + parts[:, 2]),
        torsion_energies=frozen(parts[:, 1]),
        largest_strains=frozen(strains.max(axis=1, initial=0.0)),
        mean_strains=frozen(strains.mean(axis=1)) if len(points) else frozen(np.zeros(0)),
        tile_strains=frozen(tiles),
        openings=frozen(np.array([energy.openings(p) for p in points]).reshape(-1, len(energy.hinges.stencil))),
        residuals=frozen([state.residual for state in states]),
        holding=frozen(holding),
        steps=frozen([state.steps for state in states], np.int64),
        moves=frozen(np.r_[np.zeros(min(1, len(points))), moves]),
        status=status,
    )


def jumps(energy: Energy, guide: Guide, path: Path) -> Int[np.ndarray, " _"]:
    """Return the numbers of the states behind which the sheet snaps: no smooth way leads to the next one."""
    return np.flatnonzero(_is_far(energy, guide, path.fractions, path.moves[1:]))


def _is_far(energy: Energy, guide: Guide, fractions: np.ndarray, moves: np.ndarray) -> Bool[np.ndarray, " _"]:
    """Return whether a sheet moves further from one state to the next than its guide and `FAR` more."""
    guided = np.array([guide.at(fraction) for fraction in fractions]).reshape(-1, *guide.flat.shape)
    expected = np.abs(np.diff(guided, axis=0)).max(axis=(1, 2), initial=0.0) / energy.length
    return np.asarray(moves > expected + FAR)
