"""How a workbench opens: the first state and results of a target, or of a run that was saved.

What reads runs is imported inside the function that does, so that a window on a target opens sooner.
"""

from __future__ import annotations

import os
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from kirisurf.origin import moved, round_origin
from kirisurf.spec import FitSpec
from kirisurf.states import Step
from kirisurf.status import Status
from kirisurf.targets import is_outline_name, is_sample, loaded, resolved, target_name
from kirisurf.topology import require_disk
from viewers.way import Way
from viewers.workbench.events import Certified, Fitted, Shape
from viewers.workbench.results import Results
from viewers.workbench.state import State

if TYPE_CHECKING:
    from kirisurf.runs import Run


def opened_target(target: str, **options: Any) -> tuple[State, Results]:
    """Return a state for a target that is to be fitted, and nothing known yet.

    Parameters
    ----------
    target : str
        A mesh file, an outline, or the name of a sample.
    **options
        Of `FitSpec`.

    Raises
    ------
    ParameterError
        Where an option is wrong.
    UnreadableError, UnusableError
        Where there is no such target, or it can be none; this is said before a window opens.
    """
    spec = resolved(FitSpec(target=target_name(target), **options), sized=bool({"cells", "tiles"} & set(options)))
    if not (is_sample(spec.target) or is_outline_name(spec.target)):
        _check(spec)
    return State(spec), Results()


def opened_run(folder: str) -> tuple[State, Results]:
    """Return the state of a run's options, and its sheet, fields and certificate as known.

    Raises
    ------
    UnreadableError
        Where the folder holds no run, or one that has changed.
    """
    from kirisurf.publishing import run_sheet
    from kirisurf.runs import read_run

    run = read_run(folder)
    spec = _with_target(run)
    sheet = replace(run_sheet(run), way=_way(run))
    beside = run.result["certificate_beside"]
    shape = Shape(sheet.tiles, sheet.holes, sheet.deployed, run.tessellation.contracted)
    fitted = Fitted(
        job=0,
        spec=spec,
        sheet=replace(sheet, target=None),
        guess=shape,
        status=Status[run.result["status"]],
        notes=tuple(run.result["notes"]),
        warnings=tuple(run.result.get("warnings", ())),
        numbers={name: value for name, value in run.result["measures"].items() if value is not None},
        history=tuple(Step(row, np.nan, np.nan, np.nan, np.nan) for row in run.result["history"]),
        seconds=dict(run.result["seconds"]),
    )
    certified = Certified(0, run.certificate, beside["limits"], tuple(beside["failures"]))
    known = Results().received(fitted)
    known = replace(known, target=run.target, sheet=sheet, certified=certified, guess=None)
    return State(spec), replace(known, said=f"opened the run {run.name}")


def check_target(name: str) -> None:
    """Read a target as a fit would, and leave it at that.

    Raises
    ------
    KirisurfError
        Where it can be no target.
    """
    _check(FitSpec(target=target_name(name)))


def _check(spec: FitSpec) -> None:
    surface = loaded(spec)[1]
    if not (spec.repair or spec.remesh):
        require_disk(moved(surface, round_origin(surface)))


def retargeted(state: State, target: str) -> State:
    """Return a state for another target; of the options those are kept that do not depend on the one before.

    Raises
    ------
    ParameterError
        Where they do not go together.
    """
    before = state.spec
    kept = {name: getattr(before, name) for name in ("tessellation", "closeness", "prefer")}
    return state.with_spec(resolved(FitSpec(target=target_name(target), **kept)))


def open_any(name: str, **options: Any) -> tuple[State, Results]:
    """Return state and results of a run folder, or of a target; raises as the two others.

    Options are those of `FitSpec`, on top of those of the run or of the defaults.
    """
    if not os.path.isdir(name) or is_sample(name):
        return opened_target(name, **options)
    state, results = opened_run(name)
    return (state.with_spec(state.spec.changed(**options)) if options else state), results


def _way(run: Run) -> Way | None:
    """The way from flat to deployed, where it was computed."""
    from kirisurf.deployment_folder import read_way

    found = read_way(run)
    return None if found is None else Way(*found)


def _with_target(run: Run) -> FitSpec:
    """The run's options with a target that can be read again: where the file is gone, the copy in the folder."""
    spec = run.spec
    found = resolved(spec, run.folder.absolute(), sized=True)
    if os.path.isabs(found.target) and not os.path.exists(found.target):
        return found.changed(target=str(run.folder.absolute() / "target.vtp"))
    return found
