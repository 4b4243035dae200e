"""The stages of a design, and which of them an option concerns."""

from __future__ import annotations

from dataclasses import fields
from enum import Enum

from kirisurf.spec import FitSpec


class Stage(Enum):
    """One stage of a design, in order; the value is its name on buttons.

    Every stage follows from those before it, so that a change at one asks for all later ones anew.
    """

    TARGET = "target"
    PATTERN = "pattern"
    GUESS = "guess"
    FIT = "fit"
    CONTRACTED = "contracted"
    HOLES = "holes"

    @property
    def number(self) -> int:
        """Place in the order."""
        return STAGES.index(self)

    @property
    def explained(self) -> str:
        """What the stage shows, in a sentence."""
        return _EXPLAINED[self]


STAGES = tuple(Stage)

_EXPLAINED = {
    Stage.TARGET: "The surface or outline, as it was read.",
    Stage.PATTERN: "The regular pattern before the fit, flat and closed; shown under the contracted sheet.",
    Stage.GUESS: "The pattern laid on the target: where the solver starts.",
    Stage.FIT: "The sheet of rigid tiles nearest to the target, open.",
    Stage.CONTRACTED: "The same tiles laid flat, with all slits closed.",
    Stage.HOLES: "A smooth patch over every hole, with its curvature.",
}

_FIRST = {
    "target": Stage.TARGET,
    "units": Stage.TARGET,
    "repair": Stage.TARGET,
    "remesh": Stage.TARGET,
    "remesh_edge": Stage.TARGET,
    "tessellation": Stage.PATTERN,
    "cells": Stage.PATTERN,
    "tiles": Stage.PATTERN,
    "orientation": Stage.PATTERN,
    "initial": Stage.GUESS,
    "opening": Stage.GUESS,
    # only the files of a saved run
    "hinge_width": None,
    "kerf": None,
}


def first_stage(option: str) -> Stage | None:
    """Return the first stage that an option of a fit concerns; None where it changes nothing but saved files.

    Examples
    --------
    >>> first_stage("orientation"), first_stage("min_angle"), first_stage("kerf")
    (<Stage.PATTERN: 'pattern'>, <Stage.FIT: 'fit'>, None)
    """
    return _FIRST.get(option, Stage.FIT)


def first_stale(before: FitSpec | None, after: FitSpec) -> Stage | None:
    """Return the first stage that has to run again after a change of options; None where nothing has to.

    Examples
    --------
    >>> spec = FitSpec(target="hypar", cells=(4, 4))
    >>> first_stale(spec, spec.changed(min_angle=10.0, cells=(5, 5)))
    <Stage.PATTERN: 'pattern'>
    """
    if before is None:
        return Stage.TARGET
    changed = [field.name for field in fields(FitSpec) if getattr(before, field.name) != getattr(after, field.name)]
    stages = [stage for stage in map(first_stage, changed) if stage is not None]
    return min(stages, key=lambda stage: stage.number, default=None)
