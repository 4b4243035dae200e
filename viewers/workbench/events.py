"""What a window asks of an engine, and what the engine reports: plain values that go from process to process."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from kirisurf.loops import Loops
from kirisurf.spec import FitSpec
from kirisurf.states import Step
from kirisurf.status import Status
from kirisurf.surface import Surface
from viewers.scenes import Scene
from viewers.sheet import Sheet
from viewers.workbench.pipeline import Stage


@dataclass(frozen=True)
class Job:
    """A fit to make.

    Attributes
    ----------
    number : int
        Of the job; every report on it carries the number.
    spec : FitSpec
        Resolved.
    since : Stage
        First stage to run, even where its result is at hand; earlier ones run where theirs is not.
    until : Stage
        Last stage to run: GUESS is quick enough to follow a hand that drags.
    resume : bool
        Go on from the best point of the last fit of this pattern.
    """

    number: int
    spec: FitSpec
    since: Stage = Stage.HOLES
    until: Stage = Stage.HOLES
    resume: bool = False


@dataclass(frozen=True)
class SaveRun:
    """Write a run folder of the last fit; without `overwrite` it has to be new or empty.

    Attributes
    ----------
    folder : str
    overwrite, pictures : bool
    carries_target : bool
        Its spec names the target that is saved beside it, and not the file that was read, which will be gone.
    """

    folder: str
    overwrite: bool = False
    pictures: bool = True
    carries_target: bool = False


@dataclass(frozen=True)
class CutFile:
    """Write the cut pattern of the last fit; the suffix of the path, .svg or .dxf, says how.

    Attributes
    ----------
    path : str
    hinge_width : float or None
        Material left at every hinge, in the target's units; None is a part of the tile edge.
    kerf : float
        Width of the cut, in the same units.
    """

    path: str
    hinge_width: float | None = None
    kerf: float = 0.0


@dataclass(frozen=True, eq=False)
class Draw:
    """Write pictures: one scene as PNG, or several as the frames of a GIF that runs for ever.

    Attributes
    ----------
    scenes : tuple of Scene
    path : str
    size : (int, int)
    seconds : float
        Of every frame.
    """

    scenes: tuple[Scene, ...]
    path: str
    size: tuple[int, int] = (1600, 1200)
    seconds: float = 0.05


Request = Job | SaveRun | CutFile | Draw


@dataclass(frozen=True, eq=False)
class Shape:
    """A pattern where it is now.

    Attributes
    ----------
    tiles, holes : Loops
    points : (n, 3)
    flat : (n, 2)
        The regular pattern, closed.
    """

    tiles: Loops
    holes: Loops
    points: Float[np.ndarray, "n 3"]
    flat: Float[np.ndarray, "n 2"]


@dataclass(frozen=True)
class Ready:
    """The engine can take requests, `seconds` after it was started."""

    seconds: float


@dataclass(frozen=True)
class Began:
    """A job has come to a stage; `words` say what is done."""

    job: int
    stage: Stage
    words: str


@dataclass(frozen=True, eq=False)
class TargetRead:
    """The target of a job, with a sentence on everything that its reader changed."""

    job: int
    surface: Surface
    notes: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Guessed:
    """The pattern laid on the target, with what was chosen and what the target asks of the pattern."""

    job: int
    shape: Shape
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()


@dataclass(frozen=True, eq=False)
class Stepped:
    """One step of the solver."""

    job: int
    step: Step


@dataclass(frozen=True, eq=False)
class Moved:
    """Where the sheet is while the solver goes; coarser patterns come first where it goes from coarse to fine."""

    job: int
    shape: Shape


@dataclass(frozen=True, eq=False)
class Fitted:
    """A fit, measured.

    Attributes
    ----------
    job : int
    spec : FitSpec
        With the target's own unit.
    sheet : Sheet
        Without its target, which came before.
    guess : Shape
    status : Status
    notes, warnings : tuple of str
    numbers : mapping of str to float
    history : tuple of Step
    seconds : mapping of str to float
    can_go_on : bool
        Whether the solver could go on from this sheet, were it stopped.
    """

    job: int
    spec: FitSpec
    sheet: Sheet
    guess: Shape
    status: Status
    notes: tuple[str, ...]
    warnings: tuple[str, ...]
    numbers: Mapping[str, float]
    history: tuple[Step, ...]
    seconds: Mapping[str, float]
    can_go_on: bool = False


@dataclass(frozen=True)
class Certified:
    """The verdict on a fit: every row of its certificate, and a sentence on every row that fails."""

    job: int
    rows: Mapping[str, float | int | None]
    limits: Mapping[str, float]
    failures: tuple[str, ...] = ()

    @property
    def passed(self) -> bool:
        """Whether no row fails."""
        return not self.failures


@dataclass(frozen=True)
class Failed:
    """A request could not be met: the sentence for the user. `job` is 0 for what was no fit."""

    job: int
    message: str


@dataclass(frozen=True)
class Ended:
    """A job is over, well or not; `words` say how, for the status line."""

    job: int
    words: str = ""


@dataclass(frozen=True)
class Written:
    """A run folder or a picture was written."""

    path: str
    seconds: float = 0.0


@dataclass(frozen=True)
class Lost:
    """The engine's process ended by itself; `message` says how. The next request starts another."""

    message: str


Event = Ready | Began | TargetRead | Guessed | Stepped | Moved | Fitted | Certified | Failed | Ended | Written | Lost
