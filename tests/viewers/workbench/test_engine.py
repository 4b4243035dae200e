"""The engine: what it computes, what it keeps, and what becomes of a process that dies."""

from __future__ import annotations

import os
import signal
import time

import numpy as np
import pytest

from kirisurf.cli import main
from kirisurf.errors import UnreadableError, UnusableError
from kirisurf.formats import write_obj
from kirisurf.loops import Loops
from kirisurf.pipeline import fit_surface
from kirisurf.runs import read_run
from kirisurf.spec import FitSpec
from kirisurf.status import Status
from kirisurf.targets import load
from viewers.workbench.engine import Engine
from viewers.workbench.events import (
    CutFile,
    Draw,
    Ended,
    Failed,
    Fitted,
    Guessed,
    Lost,
    Moved,
    Ready,
    SaveRun,
    Stepped,
    TargetRead,
    Written,
)
from viewers.workbench.opening import open_any, opened_run
from viewers.workbench.pipeline import Stage
from viewers.workbench.scene import contracted_view, deployed_view
from viewers.workbench.state import State


def kinds(heard):
    return [type(event) for event in heard]


def fitted_of(heard):
    return next(event for event in heard if isinstance(event, Fitted))


def test_a_first_fit_reports_every_stage_in_order_and_is_the_fit_of_the_library(desk, spec):
    results, heard = desk.fit(spec)
    order = [kinds(heard).index(kind) for kind in (TargetRead, Guessed, Moved, Stepped, Fitted, Ended)]
    assert order == sorted(order)
    plain = fit_surface(load("hypar"), spec)
    assert np.array_equal(results.sheet.deployed, plain.fit.points)
    assert np.array_equal(results.sheet.contracted[:, :2], plain.contracted.points)
    assert results.steps == tuple(event.step for event in heard if isinstance(event, Stepped))
    assert results.is_current and results.running is None and results.certified.passed


def test_a_changed_bound_goes_on_from_the_sheet_and_finds_what_a_fit_from_the_start_finds(desk, spec):
    before, _ = desk.fit(spec)
    bounded = spec.changed(min_angle=20.0)
    results, heard = desk.fit(bounded)
    assert not {TargetRead, Guessed} & set(kinds(heard))
    assert "from the sheet that was there" in " ".join(results.notes)
    plain = fit_surface(load("hypar"), bounded)
    edge = plain.fit.edge_length
    assert np.abs(results.sheet.deployed - plain.fit.points).max() < 1e-4 * edge
    assert len(results.steps) < len(before.steps)


def test_running_again_from_a_stage_starts_there(desk, spec):
    desk.fit(spec)
    assert {TargetRead, Guessed} <= set(kinds(desk.fit(spec, since=Stage.TARGET)[1]))
    again = kinds(desk.fit(spec, since=Stage.PATTERN)[1])
    assert Guessed in again and TargetRead not in again
    from_start = desk.fit(spec, since=Stage.FIT)[0]
    assert "from the sheet that was there" not in " ".join(from_start.notes)
    for stage in (Stage.CONTRACTED, Stage.HOLES):
        heard = desk.fit(spec, since=stage)[1]
        assert Stepped not in kinds(heard) and Fitted in kinds(heard)


def test_a_preview_lays_the_pattern_and_solves_nothing(desk):
    spec = FitSpec(target="hypar", tiles=60, orientation=10.0)
    heard = desk.fit(spec, until=Stage.GUESS)[1]
    assert Guessed in kinds(heard) and not {Stepped, Fitted} & set(kinds(heard))
    assert kinds(heard)[-1] is Ended


def test_a_stopped_fit_is_shown_and_can_go_on_to_the_solution(desk, spec):
    desk.stop.set()
    stopped, _ = desk.fit(spec)
    assert stopped.status is Status.INTERRUPTED and stopped.can_resume and stopped.sheet is not None
    desk.stop.clear()
    resumed, _ = desk.fit(spec, since=Stage.FIT, resume=True)
    assert resumed.status is Status.CONVERGED and not resumed.can_resume


def test_a_planar_target_is_fitted_too(desk):
    results, _ = desk.fit(FitSpec(target="circle", cells=(2, 2)))
    assert results.status is Status.CONVERGED and results.sheet.is_planar
    assert all("curvature" not in name for _, name in results.sheet.colorings)


@pytest.mark.parametrize(
    ("spec", "words"),
    [
        (FitSpec(target="./no-such-file.stl", cells=(3, 3)), "no-such-file"),
        (FitSpec(target="hypar", tiles=60, initial="rescaled"), "expected together with --cells"),
    ],
)
def test_a_mistake_is_reported_and_the_next_job_works(desk, spec, words):
    results, _ = desk.fit(spec)
    assert words in results.problem and results.running is None
    good, _ = desk.fit(FitSpec(target="hypar", cells=(2, 2)))
    assert good.status is Status.CONVERGED and not good.problem


def test_a_cut_file_is_that_of_the_fit_on_show(desk, spec, tmp_path):
    assert isinstance(desk.ask(CutFile(str(tmp_path / "early.svg")))[-1], Failed)
    desk.fit(spec)
    for suffix, sign in ((".svg", "<svg"), (".dxf", "$INSUNITS")):
        path = tmp_path / f"cut{suffix}"
        assert isinstance(desk.ask(CutFile(str(path)))[-1], Written)
        assert sign in path.read_text(encoding="utf-8")
    heard = desk.ask(CutFile(str(tmp_path / "wide.svg"), hinge_width=100.0))
    assert isinstance(heard[-1], Failed) and "hinge" in heard[-1].message
    assert not (tmp_path / "wide.svg").exists()


def test_a_run_that_carries_its_target_needs_no_other_file(desk, tmp_path):
    surface = load("hypar", resolution=12)
    triangles = Loops(np.arange(0, 3 * len(surface.faces) + 1, 3), surface.faces.ravel())
    write_obj(tmp_path / "mine.obj", surface.vertices, triangles)
    desk.fit(FitSpec(target=str(tmp_path / "mine.obj"), cells=(2, 2)))
    heard = desk.ask(SaveRun(str(tmp_path / "run"), pictures=False, carries_target=True))
    assert isinstance(heard[-1], Written), heard
    (tmp_path / "mine.obj").unlink()
    assert main(["fit", "--spec", str(tmp_path / "run" / "run.toml"), "-o", str(tmp_path / "b"), "--no-pictures"]) == 0
    assert np.array_equal(read_run(tmp_path / "b").deployed, read_run(tmp_path / "run").deployed)


def test_a_saved_run_is_that_of_its_spec_and_opens_again(desk, spec, tmp_path):
    desk.fit(spec)
    shown = desk.fit(spec.changed(min_angle=20.0))[0]
    heard = desk.ask(SaveRun(str(tmp_path / "run"), pictures=False))
    assert isinstance(heard[-1], Written), heard
    run = read_run(tmp_path / "run")
    assert np.array_equal(run.deployed, fit_surface(load("hypar"), spec.changed(min_angle=20.0)).fit.points)
    state, known = opened_run(str(tmp_path / "run"))
    assert state.spec.min_angle == 20.0 and known.certified.passed and known.status is Status.CONVERGED
    assert known.sheet.deployed.shape == shown.sheet.deployed.shape
    assert len(known.steps) == run.result["iterations"]
    for view in (contracted_view, deployed_view):
        assert view(state, known).items
    refused = desk.ask(SaveRun(str(tmp_path / "run"), pictures=False))
    assert isinstance(refused[-1], Failed) and "run" in refused[-1].message


def test_saving_nothing_is_refused(desk, tmp_path):
    assert "expected a fit" in desk.ask(SaveRun(str(tmp_path / "run"), pictures=False))[-1].message


def test_options_come_on_top_of_those_of_a_target(tmp_path):
    (tmp_path / "broken.obj").write_text("v 0 0 0\nf 1 2 3\n")
    for wrong in ("no_such_surface", str(tmp_path / "none.obj"), str(tmp_path / "broken.obj")):
        with pytest.raises((UnreadableError, UnusableError)):
            open_any(wrong)
    state, results = open_any("hypar", cells=(5, 4), min_angle=7.0)
    assert state == State(state.spec) and state.spec.cells == (5, 4) and state.spec.min_angle == 7.0
    assert results.sheet is None


def test_pictures_and_animations_are_written(opengl, desk, state, fitted, tmp_path):
    from PIL import Image

    scenes = (contracted_view(state, fitted), deployed_view(state, fitted))
    for name, frames in (("both.png", 1), ("moving.gif", 2)):
        heard = desk.ask(Draw(scenes, str(tmp_path / name), (240, 200)))
        assert isinstance(heard[-1], Written), heard
        with Image.open(tmp_path / name) as picture:
            assert getattr(picture, "n_frames", 1) == frames
            low, high = np.asarray(picture.convert("L")).min(), np.asarray(picture.convert("L")).max()
            assert low < 120 < high
    heard = desk.ask(Draw(scenes, str(tmp_path / "both.mp4")))
    assert "expected scenes and a .png or .gif" in heard[-1].message


def dies(connection, stop, began):
    """Stands for a crash in native code, after one request."""
    connection.send(Ready(0.0))
    connection.recv()
    os.kill(os.getpid(), signal.SIGKILL)


def until(engine, kind, seconds=240.0):
    """Return all events up to the first of a kind."""
    heard, end = [], time.monotonic() + seconds
    while not any(isinstance(event, kind) for event in heard):
        assert time.monotonic() < end, f"no {kind} among {kinds(heard)}"
        heard += engine.events(wait=1.0)
    return heard


def test_a_process_computes_gives_way_and_is_cancelled(spec):
    fine = FitSpec(target="hypar", cells=(20, 20))  # far from its end when its first step is heard
    with Engine() as engine:
        engine.start(fine)
        until(engine, Stepped)
        number = engine.start(spec)
        heard = until(engine, Ended)
        assert {event.job for event in heard if isinstance(event, (Fitted, Ended))} == {number}
        assert fitted_of(heard).status is Status.CONVERGED
        engine.start(fine)
        until(engine, Stepped)
        engine.cancel()
        assert fitted_of(until(engine, Ended)).status is Status.INTERRUPTED
        process = engine._process
        assert process is not None and engine.is_alive
    assert engine._process is None and not engine.is_alive


@pytest.mark.skipif(os.name != "posix", reason="a death by a signal was not tried: only POSIX systems have them")
def test_a_death_is_told_once_and_the_next_request_starts_another_process(spec):
    with Engine(dies) as engine:
        engine.start(spec)
        lost = [event for event in until(engine, Lost) if isinstance(event, Lost)]
        assert len(lost) == 1 and "signal 9" in lost[0].message
        assert list(engine.events()) == [] and not engine.is_alive
        engine.start(spec)
        assert isinstance(until(engine, Lost)[-1], Lost)
