"""The engine's side that computes: a loop in a process of its own, with what is at hand between two fits."""

from __future__ import annotations

import signal
import time
from collections import deque
from dataclasses import replace
from multiprocessing.connection import Connection
from multiprocessing.synchronize import Event as Flag
from pathlib import Path
from typing import Any

import numpy as np

from kirisurf.arrays import frozen
from kirisurf.contract import contract
from kirisurf.cuts import cuts
from kirisurf.design import Design
from kirisurf.dxf import dxf_text
from kirisurf.errors import KirisurfError
from kirisurf.formats.atomic import write_text
from kirisurf.ground import Ground
from kirisurf.judging import certified, measured
from kirisurf.origin import moved, round_origin
from kirisurf.pipeline import fit_surface, require_memory
from kirisurf.publishing import sheet
from kirisurf.refit import Begun, is_direct, refit
from kirisurf.start import make_start
from kirisurf.states import Step
from kirisurf.status import Status
from kirisurf.svg import svg_text
from kirisurf.targets import loaded, prepared
from kirisurf.tessellation import Tessellation
from kirisurf.topology import require_disk
from viewers.workbench.at_hand import AtHand
from viewers.workbench.events import (
    Began,
    Certified,
    CutFile,
    Ended,
    Event,
    Failed,
    Fitted,
    Guessed,
    Job,
    Moved,
    Ready,
    Request,
    SaveRun,
    Shape,
    Stepped,
    TargetRead,
    Written,
)
from viewers.workbench.pictures import draw_pictures
from viewers.workbench.pipeline import Stage, first_stale

PICTURES_A_SECOND = 25.0
"""Most pictures of a sheet on its way that are sent: more than a window draws would only keep it busy."""


class Superseded(Exception):
    """A newer request waits: what was computed for this one is not wanted any more."""


def work(connection: Connection, stop: Flag, began: float) -> None:
    """Answer requests until the other side closes the connection.

    Parameters
    ----------
    connection : Connection
        Takes `Request`, gives `Event`.
    stop : multiprocessing.Event
        Set by the other side where the solver is to end at its best point.
    began : float
        When the process was started, by `time.time`, for the report.
    """
    # Ctrl-C in the terminal is for the window, which closes the connection.
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    worker = Worker(connection, stop)
    try:
        connection.send(Ready(time.time() - began))
        while True:
            worker.answer(connection.recv())
    except (EOFError, OSError):
        return


class Worker:
    """Answers requests one after the other.

    Parameters
    ----------
    connection, stop
        As for :func:`work`.
    """

    def __init__(self, connection: Connection, stop: Flag) -> None:
        self._connection = connection
        self._stop = stop
        self._at_hand: AtHand | None = None
        self._sent_at = 0.0

    def answer(self, request: Request) -> None:
        """Answer the latest of the requests that wait; all but the last of several jobs are skipped."""
        waiting: deque[Request] = deque([request])
        while self._connection.poll():
            waiting.append(self._connection.recv())
        jobs = [one for one in waiting if isinstance(one, Job)]
        for one in waiting:
            if not isinstance(one, Job) or one is jobs[-1]:
                self._answer(one)

    def _answer(self, request: Request) -> None:
        number = request.number if isinstance(request, Job) else 0
        try:
            if isinstance(request, Job):
                self._fit(request)
            elif isinstance(request, SaveRun):
                self._save(request)
            elif isinstance(request, CutFile):
                self._cut(request)
            else:
                began = time.perf_counter()
                draw_pictures(request)
                self._send(Written(request.path, time.perf_counter() - began))
        except Superseded:
            return
        except KirisurfError as problem:
            self._send(Failed(number, str(problem)))
        except (EOFError, ConnectionError):
            raise
        except MemoryError:
            self._send(Failed(number, "memory: there was not enough; ask for fewer tiles"))
        except Exception as problem:
            # the engine outlives a defect: the user may change an option and go on
            self._send(Failed(number, f"internal error: {type(problem).__name__}: {problem}"))

    def _send(self, event: Event) -> None:
        self._connection.send(event)

    def _fit(self, job: Job) -> None:
        """Run the stages of a job that are asked for or stale."""
        began = time.perf_counter()
        known = self._at_hand
        stale = first_stale(None if known is None else known.spec, job.spec)
        since = min((s for s in (stale, job.since) if s is not None), key=lambda stage: stage.number)
        require_memory(job.spec)
        if known is None or since is Stage.TARGET:
            known = self._read_target(job)
        elif since.number <= Stage.GUESS.number:
            known = replace(known, begun=None)
        if since.number <= Stage.FIT.number:
            known = replace(known, before=known.result or known.before, result=None)
        known = replace(known, spec=job.spec.changed(units=job.spec.units or known.spec.units))
        self._at_hand = known
        if known.begun is None:
            known = self._lay(known, job)
        if job.until.number < Stage.FIT.number:
            self._send(Ended(job.number))
            return
        if known.result is None:
            known = self._solve(known, job)
        elif since is Stage.CONTRACTED:
            self._send(Began(job.number, Stage.CONTRACTED, "laying the tiles flat"))
            contracted = contract(known.result.tessellation, known.result.fit.points)
            known = replace(known, result=replace(known.result, contracted=contracted))
        self._at_hand = known
        self._report(known, job, time.perf_counter() - began)

    def _read_target(self, job: Job) -> AtHand:
        self._at_hand = None
        self._send(Began(job.number, Stage.TARGET, f"reading {job.spec.target}"))
        spec, surface, notes = loaded(job.spec)
        surface, more = prepared(surface, spec)
        origin = round_origin(surface)
        surface = require_disk(moved(surface, origin))
        self._send(TargetRead(job.number, surface, notes + more))
        return AtHand(spec, Ground(surface), origin, notes + more)

    def _lay(self, known: AtHand, job: Job) -> AtHand:
        """Lay the pattern on the target; a rectangular one in a planar outline is bent into it by the solver."""
        spec = known.spec
        if known.surface.outline is not None and spec.cells is not None and spec.initial == "auto":
            return known
        self._send(Began(job.number, Stage.GUESS, "laying the pattern"))
        start = make_start(known.surface, spec, known.ground)
        known = replace(known, begun=Begun.of(known.ground, start))
        self._at_hand = known
        notes = (start.feasibility.sentence, start.feasibility.advice)
        self._send(
            Guessed(
                job.number,
                _shape(start.tessellation, start.points),
                (*(note for note in notes if note), *start.notes),
                start.warnings,
            )
        )
        self._give_way()
        return known

    def _sheet_to_go_on_from(self, known: AtHand, job: Job) -> np.ndarray | None:
        """Points of the same pattern that the solver may start from without changing what it is to find."""
        if known.begun is None or known.before is None:
            return None
        fit, start = known.before.fit, known.begun.start
        follows = fit.status is Status.CONVERGED and is_direct(start) and job.since is not Stage.FIT
        return fit.points if fit.tessellation is start.tessellation and (job.resume or follows) else None

    def _solve(self, known: AtHand, job: Job) -> AtHand:
        self._send(Began(job.number, Stage.FIT, "solving"))
        spec = known.spec

        def should_stop() -> bool:
            return self._stop.is_set() or self._connection.poll()

        def progress(step: Step) -> None:
            self._send(Stepped(job.number, step))

        def watch(tessellation: Tessellation, where: np.ndarray) -> None:
            if time.monotonic() - self._sent_at > 1.0 / PICTURES_A_SECOND:
                self._sent_at = time.monotonic()
                self._send(Moved(job.number, _shape(tessellation, where)))

        if known.begun is not None and known.can_refit:
            points = self._sheet_to_go_on_from(known, job)
            result = refit(known.begun, spec, points, watch, progress, should_stop)
        else:
            result = fit_surface(known.surface, spec, progress, should_stop)
        self._give_way()
        # the new sheet is seen before it is measured
        self._send(Moved(job.number, _shape(result.tessellation, result.fit.points)))
        return replace(known, result=replace(result, notes=known.notes + result.notes))

    def _report(self, known: AtHand, job: Job, seconds: float) -> None:
        """Measure a fit, send it, and send the verdict on it, which takes longer than the fit of a small sheet."""
        result, spec = known.result, known.spec
        if result is None:
            return
        self._send(Began(job.number, Stage.HOLES, "measuring"))
        began = time.perf_counter()
        tessellation, points, flat = result.tessellation, result.fit.points, result.contracted.points
        # an exact fit is to a smooth surface of its own
        closest = known.ground.closest if result.surface is known.surface else None
        found = measured(tessellation, points, flat, result.surface, closest)
        stretch = None if result.feasibility is None else (result.feasibility.asked, result.feasibility.given.ends)
        drawn = sheet(tessellation, points, flat, result.surface, found.fields, spec.units, stretch)
        self._send(
            Fitted(
                job.number,
                spec,
                replace(drawn, target=None),
                _shape(tessellation, result.initial),
                result.fit.status,
                result.notes,
                result.warnings,
                dict(found.numbers),
                result.fit.history,
                {**result.seconds, "measure": time.perf_counter() - began, "all": seconds},
                known.can_refit,
            )
        )
        self._give_way()
        if result.fit.status is Status.INTERRUPTED:
            # stopped half-way it is no sheet yet, and whoever stopped it would rather go on
            self._send(Ended(job.number))
            return
        self._send(Began(job.number, Stage.HOLES, "checking every row of the certificate"))
        weld = None if result.fit.status is Status.CONVERGED else tessellation.weld
        prescribed = result.boundary, result.contracted_boundary
        verdict = certified(
            spec, points, flat, tessellation.tiles, result.surface, weld, prescribed, tessellation.has_openings
        )
        rows = dict(verdict.rows)
        self._send(Certified(job.number, rows, dict(verdict.limits), tuple(verdict.failures)))
        self._send(Ended(job.number))

    def _give_way(self) -> None:
        if self._connection.poll():
            raise Superseded

    def _save(self, request: SaveRun) -> None:
        known = self._at_hand
        if known is None or known.result is None:
            self._send(Failed(0, "save: expected a fit, got none yet"))
            return
        result, began = known.result, time.perf_counter()
        self._send(Began(0, Stage.HOLES, "saving the run"))
        if result.fit.status is not Status.INTERRUPTED:
            # from the start again: run.toml then repeats the run to the last digit, whatever the window showed before
            result = fit_surface(known.surface, known.spec)
            result = replace(result, notes=known.notes + result.notes)
        # an outline is more than the mesh that is saved of it
        carries_target = request.carries_target and known.surface.outline is None
        spec = known.spec.changed(target="./target.vtp") if carries_target else known.spec
        design = Design(spec, replace(result, seconds={"load": 0.0, **result.seconds}), frozen(known.origin))
        run = design.save(Path(request.folder), overwrite=request.overwrite, pictures=request.pictures)
        self._send(Written(str(run.folder), time.perf_counter() - began))

    def _cut(self, request: CutFile) -> None:
        known, began = self._at_hand, time.perf_counter()
        if known is None or known.result is None:
            self._send(Failed(0, "cut file: expected a fit, got none yet"))
            return
        lines = cuts(known.result.tessellation, known.result.contracted.points, request.hinge_width, request.kerf)
        path, units = Path(request.path), known.spec.units
        as_dxf = path.suffix.lower() == ".dxf"
        title = f"{known.surface.name}: cut pattern"
        write_text(path, dxf_text(lines, units) if as_dxf else svg_text(lines, units, title))
        self._send(Written(request.path, time.perf_counter() - began))


def _shape(tessellation: Tessellation, points: Any) -> Shape:
    return Shape(tessellation.tiles, tessellation.holes, frozen(points), tessellation.contracted)
