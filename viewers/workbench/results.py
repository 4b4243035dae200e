"""What a workbench knows: reports of the engine, gathered event by event into one frozen value."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import singledispatch

from kirisurf.states import Step
from kirisurf.status import Status
from kirisurf.surface import Surface
from viewers.sheet import Sheet
from viewers.workbench import events
from viewers.workbench.events import Certified, Fitted, Shape
from viewers.workbench.pipeline import Stage


@dataclass(frozen=True, eq=False)
class Results:
    """What is known and what is being done.

    Attributes
    ----------
    job : int
        Number of the last job; reports on others are old and are left out.
    running : Stage or None
        What is computed now.
    doing : str
        The same in words.
    target : Surface or None
    guess : Shape or None
        The pattern laid on the target.
    moving : Shape or None
        The sheet on its way, while the solver goes.
    sheet : Sheet or None
        The last fit, in both states, with its fields and its target.
    is_current : bool
        Whether the sheet belongs to the options as they are.
    fitted : Fitted or None
        What was said of the sheet.
    certified : Certified or None
    steps : tuple of Step
        Of the last solve.
    notes, warnings : tuple of str
    problem : str
        Why the last job failed; empty where it did not.
    said : str
        The last thing that was written or lost.
    """

    job: int = 0
    running: Stage | None = None
    doing: str = ""
    target: Surface | None = None
    guess: Shape | None = None
    moving: Shape | None = None
    sheet: Sheet | None = None
    is_current: bool = False
    fitted: Fitted | None = None
    certified: Certified | None = None
    steps: tuple[Step, ...] = ()
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    problem: str = ""
    said: str = ""
    seconds: Mapping[str, float] = field(default_factory=dict)

    @property
    def status(self) -> Status | None:
        """How the fit on show ended."""
        return None if self.fitted is None else self.fitted.status

    @property
    def can_resume(self) -> bool:
        """Whether the fit on show is a best point so far that the solver could go on from."""
        goes_on = self.fitted is not None and self.fitted.can_go_on
        return (
            goes_on
            and self.running is None
            and self.status in (Status.INTERRUPTED, Status.TIME_LIMIT, Status.STEP_LIMIT)
        )

    def begun(self, job: int, since: Stage | None = None) -> Results:
        """Return the results with a new job under way: what is on show stays until something newer arrives."""
        kept = self if since is None or since.number > Stage.FIT.number else replace(self, steps=(), moving=None)
        return replace(kept, job=job, running=since or Stage.HOLES, doing="", problem="", is_current=False)

    def received(self, event: events.Event) -> Results:
        """Return the results after one report."""
        if getattr(event, "job", 0) not in (0, self.job):
            return self
        return _received(event, self)


@singledispatch
def _received(event: object, results: Results) -> Results:
    return results


@_received.register
def _(event: events.Began, results: Results) -> Results:
    steps = () if event.stage is Stage.FIT else results.steps
    return replace(results, running=event.stage, doing=event.words, steps=steps)


@_received.register
def _(event: events.TargetRead, results: Results) -> Results:
    other = results.target is None or results.target.name != event.surface.name
    kept = replace(results, sheet=None, fitted=None, certified=None, guess=None) if other else results
    if kept.sheet is not None:
        kept = replace(kept, sheet=replace(kept.sheet, target=event.surface))
    return replace(kept, target=event.surface, notes=event.notes, moving=None)


@_received.register
def _(event: events.Guessed, results: Results) -> Results:
    return replace(results, guess=event.shape, moving=event.shape, notes=event.notes, warnings=event.warnings)


@_received.register
def _(event: events.Stepped, results: Results) -> Results:
    return replace(results, steps=(*results.steps, event.step))


@_received.register
def _(event: events.Moved, results: Results) -> Results:
    return replace(results, moving=event.shape)


@_received.register
def _(event: events.Fitted, results: Results) -> Results:
    return replace(
        results,
        sheet=replace(event.sheet, target=results.target),
        guess=event.guess,
        fitted=event,
        moving=None,
        is_current=True,
        certified=None,
        steps=results.steps or event.history,
        notes=event.notes,
        warnings=event.warnings,
        seconds=event.seconds,
    )


@_received.register
def _(event: events.Certified, results: Results) -> Results:
    return replace(results, certified=event)


@_received.register
def _(event: events.Failed, results: Results) -> Results:
    return replace(results, running=None, doing="", moving=None, problem=event.message)


@_received.register
def _(event: events.Ended, results: Results) -> Results:
    return replace(results, running=None, doing="", said=event.words or results.said)


@_received.register
def _(event: events.Written, results: Results) -> Results:
    return replace(results, running=None, doing="", said=f"wrote {event.path}")


@_received.register
def _(event: events.Lost, results: Results) -> Results:
    return replace(results, running=None, doing="", moving=None, problem=event.message)
