"""Pictures of a deployment: what the viewers need to draw its energy and its film."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Bool, Float

from kirisurf.deployment import Deployment, Kind, Path
from kirisurf.deployment.loading import mean_opening
from kirisurf.deployment.path import FAR
from kirisurf.deployment_tables import opening_shares, real_barriers, transition_lambda
from kirisurf.exporting_deployment import in_space
from kirisurf.publishing import deployment_viewer
from kirisurf.tessellation import Tessellation

if TYPE_CHECKING:
    from analysis.collision_path import PathCollisions

INSETS = (0.0, 0.25, 0.5, 0.75, 1.0)
"""Openings, or parts of the way, at which the figure shows the sheet."""

MOST_FRAMES = 41
BALANCED = 1e-6
"""Residual up to which a state is drawn as one in equilibrium."""


def picture(
    tessellation: Tessellation,
    deployed: Float[np.ndarray, "n 3"],
    deployment: Deployment,
    collisions: Sequence[PathCollisions],
    title: str,
) -> bytes:
    """Return the figure of energy along the way for all lambda, the sheet above it for the first one; PNG.

    A free path is drawn over its opening. Where vertices are moved, their way is what grows evenly, while the sheet
    may snap; then the states of rest, which are not on that path, are left out.
    """
    viewer = deployment_viewer()
    first = deployment.paths[0]
    curves = [_curve(viewer, deployment, k, met) for k, met in enumerate(collisions)]
    rows = [int(np.abs(curves[0].places - wanted).argmin()) for wanted in INSETS]
    shown = _moving(viewer, tessellation, deployed, first, rows)
    drawn: bytes = viewer.deployment_figure(curves, shown, rows, title, transition_lambda(deployment), first.drive)
    return drawn


def film(tessellation: Tessellation, deployed: Float[np.ndarray, "n 3"], deployment: Deployment, path: Path) -> bytes:
    """Return the film of a path: GIF."""
    viewer = deployment_viewer()
    rows = np.unique(np.linspace(0, len(path.fractions) - 1, MOST_FRAMES).round().astype(int)).tolist()
    shares = opening_shares(deployment.energy, path.points[rows], deployment.guide.deployed)
    drawn: bytes = viewer.deployment_film(
        _moving(viewer, tessellation, deployed, path, rows), shares, path.torsion, path.drive
    )
    return drawn


def _curve(viewer: Any, deployment: Deployment, k: int, met: PathCollisions) -> Any:
    path, verdict = deployment.paths[k], deployment.verdicts[k]
    opened = opening_shares(deployment.energy, path.points, deployment.guide.deployed)
    if path.drive == "free":
        places = opened
        # where nothing costs energy it rests wherever it is left
        rests = () if verdict.kind is Kind.FREE else tuple((m.fraction, m.energy) for m in verdict.minima)
        tops = tuple((barrier.fraction, barrier.energy) for barrier in real_barriers(verdict))
    else:
        places, rests = path.fractions, ()
        highest = [int(np.abs(path.energies - barrier.energy).argmin()) for barrier in real_barriers(verdict)]
        tops = tuple((float(places[row]), float(path.energies[row])) for row in highest)
    contact = None
    if met.first_contact is not None:
        at = 0.0 if met.free_until is None else met.free_until
        contact = tuple(float(np.interp(at, path.fractions, values)) for values in (places, path.energies))
    followed = _followed(deployment, path)
    words, ends = verdict.kind.value, float(opened[-1])
    last = mean_opening(deployment.energy, deployment.guide.deployed)
    branches = tuple((branch.openings / last, branch.energies) for branch in deployment.branches[k])
    return viewer.Curve(path.torsion, places, path.energies, rests, tops, contact, words, followed, ends, branches)


def _followed(deployment: Deployment, path: Path) -> Bool[np.ndarray, " _"]:
    """Return whether a smooth way leads to every state but the first, and both ends of it are in equilibrium."""
    guided = np.array([deployment.guide.at(fraction) for fraction in path.fractions])
    expected = np.abs(np.diff(guided, axis=0)).max(axis=(1, 2)) / deployment.energy.length
    balanced = path.residuals <= BALANCED
    return np.asarray((path.moves[1:] <= expected + FAR) & balanced[1:] & balanced[:-1])


def _moving(viewer: Any, tessellation: Tessellation, deployed: np.ndarray, path: Path, rows: Sequence[int]) -> Any:
    states = np.array([in_space(path.points[row], deployed) for row in rows])
    strains = path.tile_strains[list(rows)]
    return viewer.MovingSheet(tessellation.tiles, tessellation.holes, states, strains, float(path.tile_strains.max()))
