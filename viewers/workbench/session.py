"""A session: one user's work with an engine. It holds the frozen values of a workbench and moves them on."""

from __future__ import annotations

from dataclasses import replace

from kirisurf.spec import FitSpec
from viewers.scenes import Scene
from viewers.workbench.engine import Engine
from viewers.workbench.events import Draw, Event
from viewers.workbench.history import History
from viewers.workbench.pipeline import Stage, first_stale
from viewers.workbench.poses import Poses
from viewers.workbench.results import Results
from viewers.workbench.scene import contracted_view, deployed_view
from viewers.workbench.state import State


class Session:
    """What a window or a page drives, and asks for what to draw.

    Parameters
    ----------
    state : State
    results : Results
    engine : Engine

    Attributes
    ----------
    history : History of State
    results : Results
    fitted_spec : FitSpec or None
        Options of the last job that was asked for.
    """

    def __init__(self, state: State, results: Results, engine: Engine) -> None:
        self.history = History(state)
        self.results = results
        self.engine = engine
        # a run that was opened is the fit of its options
        self.fitted_spec: FitSpec | None = None if results.sheet is None else state.spec
        self._poses: Poses | None = None
        self._previewed = 0

    @property
    def state(self) -> State:
        """What the user chose."""
        return self.history.present

    @property
    def poses(self) -> Poses | None:
        """Poses of the sheet on show, made once for every sheet."""
        sheet = self.results.sheet
        if sheet is None:
            self._poses = None
        elif self._poses is None or self._poses.sheet is not sheet:
            self._poses = Poses(sheet)
        return self._poses

    @property
    def is_stale(self) -> bool:
        """Whether the options have changed since the fit that is on show."""
        return first_stale(self.fitted_spec, self.state.spec) is not None

    @property
    def is_previewing(self) -> bool:
        """Whether a pattern is being laid for a hand that drags; a fit gives way to one, another one waits."""
        return self.results.running is not None and self.results.job == self._previewed

    def scenes(self) -> tuple[Scene, Scene]:
        """Return the contracted and the deployed view."""
        args = (self.state, self.results, self.poses)
        return contracted_view(*args), deployed_view(*args)

    def do(self, state: State) -> None:
        """Take the next state as a deed that can be undone; changed options start a fit where fits are live."""
        self.history = self.history.did(state)
        self._follow()

    def adjust(self, state: State) -> None:
        """Take the next state as no deed of its own: a slider on its way."""
        self.history = self.history.adjusted(state)

    def undo(self) -> None:
        """Take the last deed back."""
        self.history = self.history.undone()
        self._follow()

    def redo(self) -> None:
        """Do the deed again that was undone last."""
        self.history = self.history.redone()
        self._follow()

    def fit(self, since: Stage | None = None, resume: bool = False) -> None:
        """Fit the options as they are, from a stage on; by default from the first that changed.

        Resuming goes on from the best point of a fit that was stopped.
        """
        spec = self.state.spec
        stale = first_stale(self.fitted_spec, spec)
        first = Stage.FIT if resume else since or stale or Stage.FIT
        job = self.engine.start(spec, since=first, resume=resume) if since or resume else self.engine.start(spec)
        self.fitted_spec = spec
        self.results = self.results.begun(job, first)

    def preview(self, spec: FitSpec) -> None:
        """Lay the pattern of other options on the target, and no more: quick enough for a hand that drags."""
        job = self.engine.start(spec, until=Stage.GUESS)
        self.fitted_spec, self._previewed = None, job
        self.results = self.results.begun(job, Stage.GUESS)

    def cancel(self) -> None:
        """End the solver at its best point."""
        self.engine.cancel()

    def save(self, folder: str, overwrite: bool = False) -> None:
        """Write a run folder of the fit on show."""
        self.results = replace(self.results, running=Stage.HOLES, doing="saving the run")
        self.engine.save(folder, overwrite)

    def cut(self, path: str) -> None:
        """Write the cut pattern of the fit on show, .svg or .dxf."""
        spec = self.state.spec
        self.results = replace(self.results, running=Stage.HOLES, doing="writing the cut file")
        self.engine.cut(path, spec.hinge_width, spec.kerf)

    def draw(self, request: Draw) -> None:
        """Write a picture or an animation."""
        self.results = replace(self.results, running=Stage.HOLES, doing=f"drawing {request.path}")
        self.engine.draw(request)

    def listen(self, wait: float = 0.0) -> bool:
        """Take in what the engine reports; whether there was anything."""
        heard = False
        for event in self.engine.events(wait):
            self.take(event)
            heard = True
        return heard

    def take(self, event: Event) -> None:
        """Take in one report of the engine."""
        self.results = self.results.received(event)

    def _follow(self) -> None:
        if self.state.is_live and self.is_stale:
            self.fit()
