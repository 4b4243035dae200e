"""What Fig. 3a shows: the energy of the square that opens into a disc, at lambdas round the one that decides."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

from kirisurf.deploying import TOUCHING
from kirisurf.deployment import Deployment, deploy
from kirisurf.design import Design
from kirisurf.errors import UnusableError
from kirisurf.judging import path_collisions
from kirisurf.one_thread import on_one_thread

if TYPE_CHECKING:
    from analysis.collision_path import PathCollisions

SHARES = (0.0, 0.5, 1.0, 2.0)
"""Lambdas that are shown, over the one above which the sheet no longer rests open by itself."""

STEPS = 60


@dataclass(frozen=True, eq=False)
class Snapping:
    """A sheet with its energy at several lambdas.

    Attributes
    ----------
    deployment : Deployment
    collisions : tuple of PathCollisions
        Of every path.
    transition : float
        lambda above which it no longer rests open by itself.
    """

    deployment: Deployment
    collisions: tuple[PathCollisions, ...]
    transition: float


@on_one_thread
def snapping(design: Design, steps: int = STEPS, shares: Sequence[float] = SHARES) -> Snapping:
    """Follow a planar sheet from flat to deployed at lambdas round its transition, moved by a load on its slits.

    Raises
    ------
    UnusableError
        Where there is no transition: the sheet is a mechanism, or never rests open.
    """
    ends = design.tessellation, design.contracted_points, design.deployed_points
    transition = deploy(*ends, torsion=0.0, steps=2, contact=False).transition
    if transition is None or not 0 < transition < math.inf:
        raise UnusableError("deployment: expected a lambda at which the open state is lost, got none")
    found = deploy(*ends, torsion=[share * transition for share in shares], steps=steps, contact=False)
    tiles = design.tessellation.tiles
    met = tuple(path_collisions(list(path.points), tiles, path.fractions, touch=TOUCHING) for path in found.paths)
    return Snapping(found, met, transition)
