"""A deployment as a table and as a record: plain numbers that read back to the same doubles."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float

from kirisurf.deployment import Barrier, Branch, Deployment, Minimum, Path, Verdict, torsion_of_ligament
from kirisurf.deployment.energy import Energy
from kirisurf.deployment.loading import mean_opening
from kirisurf.deployment.path import STRAINLESS

if TYPE_CHECKING:
    from analysis.collision_path import PathCollisions

COLUMNS = (
    "lambda",
    "fraction",
    "opening",
    "stretch_energy",
    "torsion_energy",
    "energy",
    "mean_strain",
    "largest_strain",
    "collisions",
    "collision_depth",
    "residual",
    "holding",
)
"""Of `deployment.csv`, a row for every state of every path."""

_SHOWN_PAIRS = 20


def path_rows(path: Path, collisions: PathCollisions) -> list[dict[str, float | int]]:
    """Return a row for every state of a path, by `COLUMNS`; opening is the mean angle of the slits in radians."""
    columns = (
        np.full(len(path.fractions), path.torsion),
        path.fractions,
        path.mean_openings,
        path.stretch_energies,
        path.torsion_energies,
        path.energies,
        path.mean_strains,
        path.largest_strains,
        collisions.counts,
        collisions.depths,
        path.residuals,
        path.holding,
    )
    return [dict(zip(COLUMNS, row, strict=True)) for row in zip(*(column.tolist() for column in columns), strict=True)]


def deployment_csv(deployment: Deployment, collisions: Sequence[PathCollisions]) -> str:
    """Return the table of all states of all paths, one after the other."""
    text = io.StringIO(newline="")
    writer = csv.DictWriter(text, COLUMNS, lineterminator="\n")
    writer.writeheader()
    for path, met in zip(deployment.paths, collisions, strict=True):
        writer.writerows(path_rows(path, met))
    return text.getvalue()


def deployment_record(deployment: Deployment, collisions: Sequence[PathCollisions]) -> dict[str, Any]:
    """Return what a deployment found, without its states."""
    energy = deployment.energy
    paths = [
        {**_path_record(deployment, path, verdict, met), "branches": [_branch(deployment, one) for one in branches]}
        for path, verdict, met, branches in zip(
            deployment.paths, deployment.verdicts, collisions, deployment.branches, strict=True
        )
    ]
    return {
        "dimension": energy.dimension,
        "tiles": energy.n_tiles,
        "springs": len(energy.rods.stencil),
        "slit_ends": len(energy.hinges.stencil),
        "mechanisms": {"flat": deployment.mechanisms[0], "deployed": deployment.mechanisms[1]},
        "is_rigid": deployment.verdicts[0].rigid,
        "rests_open": rests_open(deployment),
        "transition_lambda": transition_lambda(deployment),
        "transition_hinge_width": transition_hinge_width(deployment),
        "paths": paths,
    }


def rests_open(deployment: Deployment) -> str | None:
    """Return at which lambda above 0 the sheet rests open by itself: never, below the transition, or always."""
    if deployment.transition is None:
        return None
    if transition_lambda(deployment) is not None:
        return "below the transition"
    return "always" if deployment.transition else "never"


def transition_lambda(deployment: Deployment) -> float | None:
    """Return the lambda at which a sheet stops to rest open, None where there is no such lambda."""
    value = deployment.transition
    return value if value is not None and 0 < value < math.inf else None


def transition_hinge_width(deployment: Deployment) -> float | None:
    """Return how wide the ligaments of a sheet of one material are at that lambda, which grows as their square."""
    value = transition_lambda(deployment)
    return None if value is None else math.sqrt(value / torsion_of_ligament(deployment.energy, 1.0))


def opening_shares(
    energy: Energy, states: Float[np.ndarray, "k n d"], deployed: Float[np.ndarray, "n d"]
) -> np.ndarray:
    """Return the mean opening (k,) of states over that of the deployed one, as minima and barriers are placed."""
    last = mean_opening(energy, deployed)
    return np.array([mean_opening(energy, points) for points in states]) / last


def real_barriers(verdict: Verdict) -> tuple[Barrier, ...]:
    """Return the barriers that are more than rounding: along a path without strain there are none."""
    return tuple(barrier for barrier in verdict.barriers if barrier.opening > STRAINLESS)


def _path_record(deployment: Deployment, path: Path, verdict: Verdict, met: PathCollisions) -> dict[str, Any]:
    barriers = real_barriers(verdict)
    return {
        "lambda": path.torsion,
        "drive": path.drive,
        "kind": verdict.kind.value,
        "sentence": verdict.sentence + ("" if met.is_free else " But on the way tiles collide."),
        "status": path.status.name,
        "status_sentence": path.status.value,
        "states": len(path.fractions),
        "barrier": verdict.barrier if barriers else None,
        "barriers": [_barrier(barrier) for barrier in barriers],
        "minima": [_minimum(minimum) for minimum in verdict.minima],
        "energy_deployed": float(deployment.energy.with_torsion(path.torsion).value(deployment.guide.deployed)),
        "energy_end": float(path.energies[-1]),
        "energy_largest": float(path.energies.max()),
        "largest_strain": verdict.largest_strain,
        "strained_tiles": list(verdict.strained_tiles),
        "largest_residual": float(path.residuals.max()),
        "largest_holding": float(path.holding.max()),
        "newton_steps": int(path.steps.sum()),
        "collisions": _collisions(path, met),
    }


def _collisions(path: Path, met: PathCollisions) -> dict[str, Any]:
    """Return where tiles collide, by parts of the way, and how far the sheet opens free of it, in radians."""
    free, colliding = met.free_until, np.flatnonzero(met.counts)
    ends = [] if met.first_contact is None else [0.0 if free is None else free, float(path.fractions[colliding[-1]])]
    clear = path.mean_openings[met.counts == 0]
    first = None if met.first_contact is None else met.first_contact.pairs[:_SHOWN_PAIRS].tolist()
    return {
        "is_free": met.is_free,
        "most": int(met.counts.max()),
        "deepest": float(met.depths.max()),
        "between": ends or None,
        "opening_before_first": None if free is None else float(np.interp(free, path.fractions, path.mean_openings)),
        "widest_free_opening": float(clear.max()) if len(clear) else None,
        "first_pairs": first,
    }


def _minimum(minimum: Minimum) -> dict[str, Any]:
    names = ("fraction", "opening", "energy", "largest_strain", "is_flat")
    return {name: getattr(minimum, name) for name in names}


def _barrier(barrier: Barrier) -> dict[str, Any]:
    values = {name: getattr(barrier, name) for name in ("below", "fraction", "energy", "is_saddle")}
    return {**values, "to_open": barrier.opening, "to_close": barrier.closing}


def _branch(deployment: Deployment, branch: Branch) -> dict[str, Any]:
    """Return what a branch at a jump is, openings over that of the deployed sheet."""
    last = mean_opening(deployment.energy, deployment.guide.deployed)
    return {
        "fraction": branch.openings[0] / last,
        "fraction_end": branch.openings[-1] / last,
        "end": branch.end.name,
        "end_sentence": branch.end.value,
        "states": len(branch.states),
        "newton_steps": branch.steps,
        "folds": len(branch.folds),
        "crossings": len(branch.crossings),
        "stationary": [
            {"fraction": state.opening / last, "energy": state.energy, "falling_directions": state.n_negative}
            for state in branch.stationary
        ],
    }
