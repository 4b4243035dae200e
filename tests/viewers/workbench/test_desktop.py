"""The window itself, opened off-screen: buttons, panels and pictures follow the session and drive it."""

from __future__ import annotations

import functools
import gc
import os
import sys
from dataclasses import replace

import numpy as np
import pytest

from viewers.workbench.desktop import probing
from viewers.workbench.desktop.actions import ANIMATIONS, DRAWINGS, PICTURES
from viewers.workbench.desktop.asking import free_name, with_suffix
from viewers.workbench.desktop.painting import ticks
from viewers.workbench.desktop.qt import INSTALL_LINE, is_installed
from viewers.workbench.engine import Engine
from viewers.workbench.events import Began, Ended, Fitted, Written
from viewers.workbench.field_groups import field_groups
from viewers.workbench.options import in_labels, options
from viewers.workbench.pipeline import Stage
from viewers.workbench.scene import colorings
from viewers.workbench.session import Session
from viewers.workbench.state import Selection, State


class Listed(Engine):
    """An engine that notes what it is asked and reports what a test puts there."""

    def __init__(self) -> None:
        super().__init__()
        self.asked, self.reports, self.closed = [], [], False

    def start(self, spec, since=Stage.HOLES, until=Stage.HOLES, resume=False):
        self.asked.append((spec, since, until, resume))
        return len(self.asked)

    def cancel(self):
        self.asked.append("cancel")

    def events(self, wait=0.0):
        reports, self.reports = self.reports, []
        return iter(reports)

    def close(self):
        self.closed = True


@pytest.fixture
def session(state, fitted) -> Session:
    return Session(state, fitted, Listed())


def test_a_session_fits_what_changed_and_nothing_else(session, state):
    session.do(state.colored(None))
    session.do(session.state.toggled(Stage.GUESS))
    assert session.engine.asked == []
    session.do(session.state.with_option("min_angle", 12.0))
    assert [asked[0].min_angle for asked in session.engine.asked] == [12.0]
    session.undo()
    assert session.engine.asked[-1][0] == state.spec and Stage.GUESS in session.state.shown
    session.undo()
    assert len(session.engine.asked) == 2 and Stage.GUESS not in session.state.shown


def test_a_session_that_is_not_live_waits_to_be_asked(session, state):
    session.do(state.live(False))
    session.do(session.state.with_option("min_angle", 12.0))
    assert session.engine.asked == [] and session.is_stale
    session.fit()
    assert len(session.engine.asked) == 1 and not session.is_stale


def test_poses_are_made_once_for_a_sheet(session):
    first = session.poses
    session.adjust(session.state.deployed_to(0.4))
    assert session.poses is first and first.sheet is session.results.sheet


def test_ticks_are_round_and_within():
    for low, high in ((-1.3, 1.3), (0.0, 0.07), (-16.0, 17.0), (2.0, 2.004)):
        found = ticks(low, high)
        assert 3 <= len(found) <= 9 and min(found) >= low - 1e-12 and max(found) <= high + 1e-12
        assert low > 0 or 0.0 in found


def test_every_field_is_listed_once_by_its_place_with_its_unit(fitted):
    known = colorings(fitted)
    listed = [(choice.where, choice.name) for group in field_groups(known, "mm") for choice in group.choices]
    assert sorted(listed) == sorted(known)
    backward = field_groups(reversed((*known, ("tile", "unheard_of"))), "mm")
    assert any("mm" in choice.unit for group in backward for choice in group.choices)
    assert [choice.name for group in backward for choice in group.choices if group.title[0] == "T"][-1] == "unheard_of"


def test_a_name_for_a_folder_is_one_that_nothing_has(tmp_path):
    for count in (1, 2, 3):
        name = free_name(str(tmp_path / "run"))
        assert not (tmp_path / name).exists() and name.startswith("run") and (count > 1) == (name != "run")
        (tmp_path / name).mkdir()


def test_the_suffix_of_a_file_is_that_of_its_kind_and_stands_once():
    for kind in (*DRAWINGS, *PICTURES, *ANIMATIONS):
        once = with_suffix("hood", kind)
        assert once != "hood" and with_suffix(once, kind) == once and with_suffix(once.upper(), kind) == once.upper()


def test_every_option_is_called_by_its_label():
    for option in options():
        words = in_labels(f"--{option.name.replace('_', '-')}: expected, --{option.name.replace('_', '-')}-other")
        assert words.startswith(f"{option.label}: ") and words.endswith("-other") and words.count("--") == 1


def test_without_qt_one_sentence_says_how_to_install_it(monkeypatch):
    monkeypatch.setattr(probing, "is_installed", lambda: False)
    answer = probing.probe_workbench()
    assert not answer.available and INSTALL_LINE in answer.reason


ending_of_qt = functools.cache(probing.ending_of_qt)


@pytest.fixture
def bench(request, monkeypatch, opengl, no_open_plotter, session):
    if not is_installed():
        pytest.skip(f"{request.node.name} did not run: {INSTALL_LINE}")
    if sys.platform.startswith("linux") and not os.environ.get("DISPLAY"):
        # Qt's own off-screen windows have no OpenGL for VTK, which draws into its own there
        os.environ.setdefault("QT_QPA_PLATFORM", "offscreen")
        if ending := ending_of_qt():
            pytest.skip(f"{request.node.name} did not run: Qt opens no window here ({ending})")
    elif probing.probe_workbench().reason:
        pytest.skip(f"{request.node.name} did not run: {probing.probe_workbench().reason}")
    from viewers.workbench.desktop.show import application
    from viewers.workbench.desktop.window import Workbench

    problems: list[BaseException] = []
    # Qt goes on after an exception in one of its callbacks, and a test would with it
    monkeypatch.setattr(sys, "excepthook", lambda kind, problem, trace: problems.append(problem))
    app = application()
    made = Workbench(session, "test")
    made.window.resize(1200, 700)
    made.window.show()
    app.processEvents()
    yield made
    made.window.close()
    app.processEvents()
    assert session.engine.closed
    assert problems == []


def drawn(bench, side, name):
    return bench.canvas.views.drawn(side, name)


def test_stage_buttons_hide_what_is_drawn(bench):
    assert drawn(bench, 1, "target") is not None
    bench.strip.buttons[Stage.TARGET].click()
    assert drawn(bench, 1, "target") is None and Stage.TARGET not in bench.session.state.shown
    bench.undo()
    assert drawn(bench, 1, "target") is not None and bench.strip.buttons[Stage.TARGET].isChecked()


def test_the_slider_moves_the_right_view_alone(bench):
    before = np.array(drawn(bench, 0, "tiles").data.points)
    bench.slider.setValue(30)
    assert np.allclose(drawn(bench, 1, "tiles").data.points, bench.session.poses.at(0.3))
    assert np.array_equal(drawn(bench, 0, "tiles").data.points, before)
    assert bench.pictures.titles[1].text() == "Interpolated: 30 % of the way"


def test_an_option_changes_the_spec_and_a_wrong_one_is_taken_back(bench):
    bench.panel.editor("min_angle").setValue(15.0)
    assert bench.session.state.spec.min_angle == 15.0 and bench.session.engine.asked[-1][0].min_angle == 15.0
    count = len(bench.session.engine.asked)
    bench.panel.editor("max_opening").setValue(10.0)
    assert bench.session.state.spec.max_opening is None and len(bench.session.engine.asked) == count
    assert "expected more than the smallest opening" in bench.status.text()
    assert bench.panel.editor("max_opening").text() == "none"


@pytest.mark.parametrize("name", ["min_angle", "cells"])
def test_a_report_of_a_fit_takes_nothing_from_what_is_being_typed(bench, name):
    bench.fit()
    editor = bench.panel.editor(name)
    editor = getattr(editor, "sides", [editor])[0]
    editor.lineEdit().setText("17")
    bench.session.engine.reports = [Began(bench.session.results.job, Stage.FIT, "solving")]
    bench.tick()
    assert editor.lineEdit().text().startswith("17") and editor.value() != 17
    editor.interpretText()
    found = getattr(bench.session.state.spec, name)
    assert found == (17.0 if name == "min_angle" else (17, 3))


def test_another_target_is_taken_and_a_broken_one_is_not(bench, tmp_path):
    before = bench.session.state.spec
    broken = tmp_path / "broken.obj"
    broken.write_text("v 0 0 0\nf 1 2 3\n")
    bench.open(str(broken))
    assert bench.session.state.spec == before and bench.session.engine.asked == []
    assert "broken.obj" in bench.status.text() and bench.status.objectName() == "problem"
    bench.open("saddle_roof")
    assert bench.session.engine.asked[-1][0].target == "saddle_roof"
    bench.undo()
    assert bench.session.state.spec == before


def test_a_problem_stays_until_the_next_deed_whatever_a_fit_tells(bench, tmp_path):
    broken = tmp_path / "broken.obj"
    broken.write_text("v 0 0 0\nf 1 2 3\n")
    bench.fit()
    bench.open(str(broken))
    said = bench.status.text()
    bench.session.engine.reports = [Began(bench.session.results.job, Stage.FIT, "solving")]
    bench.tick()
    assert "broken.obj" in said and bench.status.text() == said and bench.status.objectName() == "problem"
    bench.fit()
    assert bench.status.text() != said and bench.status.objectName() == "muted"


def test_the_title_names_the_target_and_follows_undo(bench):
    bench.open("saddle_roof")
    assert bench.window.windowTitle() == "kirisurf: saddle_roof"
    bench.undo()
    assert bench.window.windowTitle() == "test"


def test_keys_of_undo_and_an_idle_wheel_pass_an_editor_by(bench):
    from viewers.workbench.desktop.qt import qt

    core, gui, editor = qt().core, qt().gui, bench.panel.editor("min_angle")
    kinds, modifiers = core.QEvent.Type, core.Qt.KeyboardModifier
    undo = gui.QKeyEvent(kinds.ShortcutOverride, core.Qt.Key.Key_Z, modifiers.ControlModifier)
    qt().widgets.QApplication.sendEvent(editor.lineEdit(), undo)
    assert not undo.isAccepted()
    place = core.QPointF(5.0, 5.0)
    wheel = gui.QWheelEvent(
        place,
        editor.mapToGlobal(place),
        core.QPoint(),
        core.QPoint(0, 120),
        core.Qt.MouseButton.NoButton,
        modifiers.NoModifier,
        core.Qt.ScrollPhase.NoScrollPhase,
        False,
    )
    editor.clearFocus()
    before = editor.value()
    qt().widgets.QApplication.sendEvent(editor, wheel)
    assert editor.value() == before and bench.session.engine.asked == []


def test_a_row_that_fails_comes_first_and_the_tab_and_the_line_say_so(bench, fitted):
    known = fitted.certified
    failing = replace(known, failures=("coverage: expected more",))
    bench.session.results = replace(bench.session.results, certified=failing, said="")
    bench.refresh()
    assert bench.side.certificate.item(0, 0).text() == "Coverage" and bench.side.tabs.tabText(2).endswith("\u2717")
    assert "Coverage" in bench.status.text() and bench.status.objectName() == "problem"
    bench.session.results = replace(bench.session.results, certified=known)
    bench.refresh()
    assert bench.side.tabs.tabText(2) == "Certificate" and bench.status.objectName() == "muted"


def test_the_picture_follows_the_size_of_the_window_until_it_is_turned(bench, monkeypatch):
    resets = []
    monkeypatch.setattr(bench.canvas.views, "reset", lambda *size: resets.append(size))
    bench.canvas.reset_view()
    bench.canvas._resized()
    assert len(resets) == 2
    camera = bench.canvas.plotter.renderers[0].camera
    camera.position = np.array(camera.position) + 1.0
    bench.canvas._resized()
    assert len(resets) == 2


def test_headings_of_the_list_of_fields_cannot_be_chosen_and_every_field_can(bench):
    box = bench.side.fields
    rows = [(box.itemData(k), box.model().item(k).isEnabled()) for k in range(box.count())]
    chosen = {data for data, enabled in rows if enabled and data}
    assert chosen == {f"{where}/{name}" for where, name in colorings(bench.session.results)}
    assert all(data is not None for data, enabled in rows[1:] if enabled)


def test_choosing_a_field_colors_and_undo_restores_the_choice(bench):
    index = bench.side.fields.findData("tile/area")
    bench.side.fields.setCurrentIndex(index)
    assert bench.session.state.coloring == ("tile", "area")
    assert bench.canvas.item(1, "tiles").field.name == "area" and bench.canvas.item(0, "tiles").field.name == "area"
    bench.undo()
    assert bench.side.fields.currentData() == "hole/gaussian_curvature"


def test_a_click_on_a_tile_picks_it_and_fills_the_table(bench):
    """Project the middle of a tile to the picture, click there, and read its number."""
    sheet, renderer = bench.session.results.sheet, bench.canvas.plotter.renderers[0]
    middle = bench.session.poses.flat[sheet.tiles[7]].mean(axis=0)
    # Qt's off-screen platform tells VTK no size
    bench.canvas.plotter.render_window.SetSize(bench.canvas.widget.width(), bench.canvas.widget.height())
    bench.canvas.reset_view()
    renderer.SetWorldPoint(*middle, 1.0)
    renderer.WorldToDisplay()
    x, y, _ = renderer.GetDisplayPoint()
    width, height = bench.canvas.plotter.render_window.GetSize()
    widget = bench.canvas.widget
    bench.canvas._pick_at((x * widget.width() / width, (height - 1 - y) * widget.height() / height))
    assert bench.session.state.selection == Selection("tile", 7)
    assert bench.side.picked_title.text() == "Tile 7" and bench.side.picked.rowCount() > 5
    assert drawn(bench, 0, "picked") is not None and drawn(bench, 1, "picked") is not None


def test_reports_of_the_engine_reach_the_picture(bench, fitted):
    bench.fit()
    assert bench.actions["stop"].isEnabled() and not bench.actions["save"].isEnabled()
    moved = fitted.sheet.deployed + np.array([0.0, 0.0, 0.5])
    sheet = replace(fitted.sheet, deployed=moved, target=None)
    bench.session.engine.reports = [replace(fitted.fitted, job=1, sheet=sheet), Ended(1)]
    assert isinstance(bench.session.engine.reports[0], Fitted)
    bench.tick()
    assert np.allclose(drawn(bench, 1, "tiles").data.points, moved)
    assert bench.actions["save"].isEnabled() and not bench.actions["stop"].isEnabled()


def test_a_sheet_of_other_options_is_not_written_and_the_line_asks_for_a_fit(bench, fitted):
    bench.fit()
    bench.session.engine.reports = [replace(fitted.fitted, job=1), Written("here.svg")]
    bench.tick()
    assert bench.actions["cut"].isEnabled() and "here.svg" in bench.status.text()
    bench.live(False)
    bench.change("min_angle", 12.0)
    assert not bench.actions["cut"].isEnabled() and "press Fit" in bench.status.text()
    bench.undo()
    assert bench.actions["cut"].isEnabled()


def test_dragging_lays_the_pattern_and_letting_go_fits_it(bench):
    trimmed = State(bench.session.state.spec.changed(tiles=60, cells=None)).spec
    bench.replace_spec(trimmed)
    bench.drag(20.0, 2.0, False)
    spec, _, until, _ = bench.session.engine.asked[-1]
    assert (spec.orientation, spec.tiles, until) == (20.0, 15, Stage.GUESS)
    bench.drag(30.0, 2.0, True)
    spec, _, until, _ = bench.session.engine.asked[-1]
    assert (spec.orientation, spec.tiles, until) == (30.0, 15, Stage.HOLES)
    assert bench.session.state.spec.orientation == 30.0


def test_the_views_turn_together_until_told_otherwise(bench):
    renderers = bench.canvas.plotter.renderers
    assert renderers[0].camera is renderers[1].camera
    bench.actions["link"].trigger()
    assert renderers[0].camera is not renderers[1].camera
    assert np.allclose(renderers[0].camera.position, renderers[1].camera.position)
    bench.actions["link"].trigger()
    assert renderers[0].camera is renderers[1].camera


@pytest.mark.skipif(sys.version_info >= (3, 12), reason="None has no count of references from Python 3.12 on")
def test_qt_leaves_the_references_of_none_alone(request):
    """A binding that takes one at every call ends the process after some minutes, as PySide6 6.12.0 does."""
    if not is_installed():
        pytest.skip(f"{request.node.name} did not run: {INSTALL_LINE}")
    from viewers.workbench.desktop.qt import qt

    timer = qt().core.QTimer()
    gc.collect()
    gc.disable()  # what other tests left has references of None too
    try:
        before = sys.getrefcount(None)
        for _ in range(500):
            timer.setInterval(1)
        assert abs(sys.getrefcount(None) - before) < 250
    finally:
        gc.enable()
