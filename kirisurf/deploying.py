"""From a run to its deployment as files: table, record, figure, time series and film."""

from __future__ import annotations

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from kirisurf.deployment import Deployment, deploy_run, energy_of, torsion_of_ligament
from kirisurf.deployment.deployment import STEPS, TORSIONS
from kirisurf.deployment.drive import DRIVES, checked_trajectory
from kirisurf.deployment.energy import checked_torsion
from kirisurf.deployment_folder import FIGURE, FILM, RECORD, SERIES, TABLE, key_of
from kirisurf.deployment_pictures import film, picture
from kirisurf.deployment_tables import deployment_csv, deployment_record
from kirisurf.errors import ParameterError
from kirisurf.exporting_deployment import write_deployment_series
from kirisurf.formats.atomic import write_bytes, write_text
from kirisurf.judging import path_collisions
from kirisurf.one_thread import on_one_thread
from kirisurf.runs import Run, RunFolder
from kirisurf.runs.record import json_text, sha256, versions

if TYPE_CHECKING:
    from analysis.collision_path import PathCollisions

TOUCHING = 0.01
"""Overlap over the tile edge up to which tiles only touch: about as far as their contacts give way."""


Stage = Callable[[str], None]
Progress = Callable[[int, int], None]


@dataclass(frozen=True, eq=False)
class DeployedRun:
    """A run with its way from flat to deployed.

    Attributes
    ----------
    run : Run
    deployment : Deployment
    collisions : tuple of PathCollisions
        Of every path.
    options : mapping
        What was asked for: torsion, steps, drive, trajectory, thickness, contact; and slit_width, touch.
    seconds : float
    """

    run: Run
    deployment: Deployment
    collisions: tuple[PathCollisions, ...]
    options: Mapping[str, Any]
    seconds: float

    @property
    def record(self) -> dict[str, Any]:
        """What was found, as `deployment.json` has it."""
        return {
            "run": self.run.name,
            "key": key_of(self.run),
            "units": self.run.result["units"],
            "options": dict(self.options),
            **deployment_record(self.deployment, self.collisions),
            "seconds": self.seconds,
        }


def checked_options(
    torsion: Sequence[float] = TORSIONS,
    steps: int = STEPS,
    drive: str = "free",
    trajectory: str | None = None,
    thickness: float = 0.0,
    contact: bool = True,
) -> dict[str, Any]:
    """Return the options of a deployment, those of lambda once each, in the order given.

    Raises
    ------
    ParameterError
        Where one is out of its range.
    """
    values = list(dict.fromkeys(checked_torsion(float(value)) for value in torsion))
    if not values:
        raise ParameterError("lambda: expected at least one number, got none")
    if isinstance(steps, bool) or not isinstance(steps, int) or not 2 <= steps <= 100_000:
        raise ParameterError(f"steps: expected a whole number from 2 to 100000, got {steps!r}")
    if drive not in DRIVES:
        raise ParameterError(f"drive: expected one of {', '.join(DRIVES)}, got {drive!r}")
    if not (np.isfinite(thickness) and thickness >= 0):
        raise ParameterError(f"thickness: expected a number of at least 0, got {thickness}")
    named = {"torsion": values, "steps": steps, "drive": drive}
    if drive == "free" and trajectory is not None:
        raise ParameterError(
            f"trajectory: expected with a drive that moves vertices, got {trajectory!r} with drive free"
        )
    named["trajectory"] = None if trajectory is None else checked_trajectory(trajectory)
    return {**named, "thickness": float(thickness), "contact": bool(contact)}


def torsion_of_run(run: Run, hinge_width: float) -> float:
    """Return lambda for ligaments of a width, in the units of the run, by `kirisurf.deployment.torsion_of_ligament`.

    Raises
    ------
    ParameterError
        Where the width is no number above 0, or no less than a tile edge.
    """
    energy = energy_of(run.tessellation, run.contracted[:, :2], 0.0)
    if np.isfinite(hinge_width) and hinge_width >= energy.length:
        raise ParameterError(
            f"hinge width: expected less than a tile edge ({energy.length:.4g} {run.result['units']}), "
            f"got {hinge_width:g}"
        )
    return torsion_of_ligament(energy, hinge_width)


@on_one_thread
def deploy_with_collisions(
    run: Run, *, progress: Progress | None = None, stage: Stage = lambda name: None, **options: Any
) -> DeployedRun:
    """Follow the sheet of a run from flat to deployed, and look for tiles that collide on the way.

    Parameters
    ----------
    run : Run
    progress : callable, optional
        Told the number of the state and of all states.
    stage : callable
        Receives the name of what is done next.
    **options
        As for :func:`checked_options`.

    Raises
    ------
    ParameterError
        Where an option is out of its range.
    UnusableError
        Where the run has no certificate, or its tiles differ in shape between the two states.
    """
    began = time.perf_counter()
    asked = checked_options(**options)
    slit_width = float(run.result["kerf"])
    way = {name: asked[name] for name in ("torsion", "steps", "drive", "trajectory", "contact")}
    tiles = run.tessellation.tiles
    # what is wrong with the thickness is told before all work
    path_collisions([run.deployed], tiles, np.zeros(1), asked["thickness"], slit_width)
    stage("following the path")
    found = deploy_run(run, **way, progress=progress)
    stage("looking for collisions")
    met = tuple(
        path_collisions(list(path.points), tiles, path.fractions, asked["thickness"], slit_width, TOUCHING)
        for path in found.paths
    )
    trajectory = None if asked["drive"] == "free" else found.trajectory
    options = {**asked, "trajectory": trajectory, "slit_width": slit_width, "touch": TOUCHING}
    return DeployedRun(run, found, met, options, time.perf_counter() - began)


def save_deployment(
    found: DeployedRun, folder: RunFolder, *, animation: bool = True, stage: Stage = lambda name: None
) -> Path:
    """Write all files into an open folder and commit it; return its path.

    Raises
    ------
    OutputError
        Where a file cannot be written; the folder is then as it was.
    """
    to, run, deployment = folder.staging, found.run, found.deployment
    stage("writing")
    write_text(to / TABLE, deployment_csv(deployment, found.collisions))
    write_deployment_series(run, deployment, deployment.paths[0], to / SERIES)
    stage("drawing")
    title = f"{run.result['target']['name']}: energy between flat and deployed"
    write_bytes(to / FIGURE, picture(run.tessellation, run.deployed, deployment, found.collisions, title))
    if animation:
        stage("animating")
        write_bytes(to / FILM, film(run.tessellation, run.deployed, deployment, deployment.paths[0]))
    names = sorted(entry.relative_to(to).as_posix() for entry in to.rglob("*") if entry.is_file())
    files = {name: sha256(to / name) for name in names}
    write_text(to / RECORD, json_text({**found.record, "versions": versions(), "files": files}))
    folder.commit()
    return folder.path
