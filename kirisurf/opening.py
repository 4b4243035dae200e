"""The planned opening: how far every part of a sheet is open at the start, and why."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from kirisurf.layout import LEAST_WAY, MOST_WAY
from kirisurf.motion import Motion
from kirisurf.spec import FitSpec

LEAST_GAIN, MOST_GAIN = 0.05, 0.99
"""What a start leaves unused: stretches below 1.05 (or a quarter of the way), and above 99 % of the largest."""

UNIFORM = ("standard", "rescaled")
"""Starts that open by the same angle everywhere."""

USUAL = 60.0
"""Opening of uniform starts in degrees, of 90 for fully open."""


@dataclass(frozen=True, eq=False)
class Opening:
    """A planned opening.

    Attributes
    ----------
    log_stretch : (v,)
        Logarithm of the planned stretch at every vertex of the target.
    spread : float
        Ratio of the stretches asked for over the sheet, without the extreme 2 % on either side.
    note : str
        The choice with its reason.
    """

    log_stretch: Float[np.ndarray, " v"]
    spread: float
    note: str


def planned_range(motion: Motion) -> tuple[float, float]:
    """Return the least and the largest stretch that starts plan with: inside of what the pattern gives.

    Examples
    --------
    >>> from kirisurf.motion import motion_of
    >>> from kirisurf.unit_cell import quad_cell
    >>> planned_range(motion_of(quad_cell()))
    (1.05, 1.4)
    """
    if motion.snaps:
        return motion.most, motion.most
    return 1 + min(LEAST_GAIN, 0.25 * (motion.most - 1)), round(MOST_GAIN * motion.most, 2)


def middle_way(motion: Motion, spec: FitSpec) -> float:
    """Return the state of the motion in the middle of those that a spec asks for."""
    if motion.snaps:
        return 1.0
    if _varies(spec):
        return float(motion.way(np.sqrt([np.prod(planned_range(motion))]))[0])
    return _asked_degrees(spec) / 90


def plan_opening(
    log_scale: Float[np.ndarray, " v"], asked: Float[np.ndarray, " t"], motion: Motion, spec: FitSpec
) -> Opening:
    """Plan the opening of a sheet.

    Parameters
    ----------
    log_scale : (v,)
        Logarithm of the conformal scale at the target's vertices.
    asked : (t,)
        The same at the tiles.
    motion : Motion
    spec : FitSpec
        Its `opening`, in degrees of 90 for fully open, and `initial`.
    """
    low, high = np.percentile(asked, [2, 98])
    spread = float(np.exp(high - low))
    least, most = planned_range(motion)
    if motion.snaps:
        note = (
            f"Opening: fully open. The {motion.cell.name} pattern snaps: between its two states, with stretches 1 and "
            f"{motion.most:.3g}, its hinges do not hold, so that tiles of different sizes follow the target."
        )
        return Opening(np.full(len(log_scale), np.log(most)), spread, note)
    if _varies(spec):
        middle = 0.5 * (np.log(least) + np.log(most)) - 0.5 * (low + high)
        note = (
            f"Opening: it varies so that the stretch follows the target's, which differs by a factor of {spread:.2f} "
            f"over the sheet; its middle lies halfway between {least:.4g} and {most:g} "
            f"(a {motion.cell.name} sheet can stretch from 1 to {motion.most:.2f})."
        )
        return Opening(log_scale + middle, spread, note)
    degrees = _asked_degrees(spec)
    stretch = np.full(len(log_scale), np.log(motion.stretch(np.array([degrees / 90]))[0]))
    if spec.initial not in UNIFORM:
        stretch = stretch + log_scale - np.median(asked)
    reason = f"as for every {spec.initial} start" if spec.opening == "auto" else "as asked"
    if spec.opening not in ("auto", degrees):
        reason = f"{spec.opening:g} was asked, starts lie between {90 * LEAST_WAY:g} and {90 * MOST_WAY:g}"
    return Opening(stretch, spread, f"Opening: {degrees:g} degrees, of 90 for fully open, at the start ({reason}).")


def _varies(spec: FitSpec) -> bool:
    return spec.opening == "auto" and spec.initial not in UNIFORM


def _asked_degrees(spec: FitSpec) -> float:
    degrees = USUAL if spec.opening == "auto" else float(spec.opening)
    return float(np.clip(degrees, 90 * LEAST_WAY, 90 * MOST_WAY))
