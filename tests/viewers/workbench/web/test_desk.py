"""The desk: what pages ask goes to the one session, and what went wrong is said instead of raised."""

from __future__ import annotations

import asyncio
from pathlib import Path

import pytest

from kirisurf.errors import ParameterError
from viewers.workbench.events import Failed, Lost, Written
from viewers.workbench.pipeline import Stage
from viewers.workbench.web.desk import Desk


class Looker:
    """Counts how often it is told to look."""

    def __init__(self) -> None:
        self.looks, self.has_left = [], False

    def look(self, is_moving: bool) -> None:
        self.looks.append(is_moving)

    async def leave(self) -> None:
        self.has_left = True


def test_everybody_who_looks_is_told_and_how_many_they_are(desk, published):
    lookers = Looker(), Looker()
    for looker in lookers:
        desk.enter(looker)
    assert published["tabs"] == 2
    desk.actions["color"]("tile/area")
    desk.actions["deploy"]("40")
    assert all(looker.looks == [False, True] for looker in lookers)
    assert published["coloring"] == "tile/area" and published["deployment"] == 40
    desk.exit(lookers[0])
    assert published["tabs"] == 1
    asyncio.run(desk.close())
    assert lookers[1].has_left and not lookers[0].has_left


def test_the_last_one_who_leaves_stops_nothing(desk, session, engine):
    looker = Looker()
    desk.enter(looker)
    desk.actions["change"]("min_angle", "12")
    desk.exit(looker)
    assert "cancel" not in engine.asked and not engine.closed and session.state.spec.min_angle == 12.0


@pytest.mark.parametrize(
    ("name", "given", "words"),
    [
        ("change", ("max_opening", "1"), "Largest opening: expected more than"),
        ("change", ("min_angle", "wide"), "Smallest opening: expected a number"),
        ("change", ("target", "/etc/passwd"), "option: expected one of"),
        ("change", ("min_angle",), "not understood"),
        ("change", ("tessellation", "/etc/passwd"), "Tessellation: expected one of quad"),
        ("open_sample", ("/etc/passwd",), "sample: expected one of the list"),
        ("toggle", ("roof",), "not understood"),
        ("run_again", (None,), "not understood"),
        ("deploy", ("far",), "not understood"),
    ],
)
def test_what_cannot_be_done_is_said_and_changes_nothing(desk, session, published, name, given, words):
    before = session.state
    desk.actions[name](*given)
    assert words in published["notice"] and published["notice_kind"] == "problem"
    assert session.state == before
    desk.actions["toggle"]("guess")
    assert published["notice"] == "", "what was said goes when something else is done"


def test_a_refused_value_is_taken_out_of_its_editor(desk, published):
    desk.actions["change"]("max_opening", "1")
    first = published["refused"]
    desk.actions["change"]("max_opening", "2")
    assert published["refused"] > first and published["option_values"]["max_opening"] is None


def test_actions_reach_the_session(desk, session, engine):
    desk.actions["lay_out"]("tiles")
    assert session.state.spec.cells is None and session.state.spec.tiles == 36
    desk.actions["undo"]()
    assert session.state.spec.cells == (3, 3)
    desk.actions["redo"]()
    assert session.state.spec.cells is None
    desk.actions["open_sample"]("paraboloid")
    assert session.state.spec.target == "paraboloid" and engine.asked[-1].target == "paraboloid"
    desk.actions["link"](False)
    desk.actions["live"](False)
    assert not session.state.is_linked and not session.state.is_live
    count = len(engine.asked)
    desk.actions["run_again"]("pattern")
    assert len(engine.asked) == count + 1 and session.results.running is Stage.PATTERN


@pytest.mark.parametrize("event", [Failed(0, "the disk is full"), Lost("the engine ended")])
def test_who_waits_for_a_file_is_told_where_it_cannot_be_written(session, event):
    async def act():
        desk = Desk(session, lambda values: None)
        listening = asyncio.create_task(desk.listen())

        def report(event):
            session.engine.reports.append(event)

        with pytest.raises(ParameterError, match=r"disk is full|engine ended"):
            await asyncio.wait_for(desk.written(Path("/nowhere/x.svg"), lambda: report(event)), 60)
        written = desk.written(Path("/nowhere/y.svg"), lambda: report(Written("/nowhere/y.svg")))
        found = await asyncio.wait_for(written, 60)
        assert found == Path("/nowhere/y.svg") and session.results.said == ""
        waiting = asyncio.create_task(desk.written(Path("/nowhere/z.svg"), lambda: None))
        await asyncio.sleep(0)
        await desk.close()
        with pytest.raises(ParameterError, match="closed"):
            await waiting
        listening.cancel()

    asyncio.run(act())
