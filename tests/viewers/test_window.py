"""The window, driven without a display."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from viewers import opengl, window
from viewers.opengl import off_screen_window, probe
from viewers.sheet_window import SheetWindow
from viewers.window import NoDisplayError, show_sheet, show_surface


@pytest.fixture
def opened(opengl, no_open_plotter, sheet, patches):
    with off_screen_window(probe()):
        made = SheetWindow(replace(sheet, patches=patches), "test", off_screen=True)
        yield made
        made.plotter.close()


def points_of(opened: SheetWindow, name: str) -> np.ndarray:
    return np.array(opened._drawn[1, name].data.points)


def test_the_slider_moves_the_deployed_sheet_and_says_interpolated(opened, sheet):
    assert np.array_equal(points_of(opened, "tiles"), sheet.deployed)
    opened.blend(0.25)
    flat = np.array(opened._drawn[0, "tiles"].data.points)
    opened.plotter.render()
    for name in ("tiles", "tile edges", "holes"):
        assert np.allclose(points_of(opened, name), 0.75 * flat + 0.25 * sheet.deployed)
        shown = opened._drawn[1, name].actor.mapper.dataset
        assert np.allclose(shown.points, points_of(opened, name))
    title = opened.plotter.renderers[1].actors["title 1"]
    assert title.input == "Interpolated, 25 %"
    opened.blend(1.0)
    assert np.array_equal(points_of(opened, "tiles"), sheet.deployed)
    assert opened.plotter.renderers[1].actors["title 1"].input == "Deployed"


def test_parts_can_be_hidden_and_stay_hidden_when_the_field_changes(opened):
    opened.toggle("target")
    opened.cycle()
    assert not opened._drawn[1, "target"].actor.visibility and not opened._drawn[1, "rim"].actor.visibility
    assert opened._drawn[1, "tiles"].actor.visibility
    opened.toggle("target")
    assert opened._drawn[1, "target"].actor.visibility


def test_cycling_visits_every_field_but_flags_and_returns(opened, sheet):
    first = opened.coloring
    assert first == ("hole", "gaussian_curvature")
    visited = []
    for _ in range(len(sheet.fields)):
        visited.append(opened.coloring)
        opened.cycle()
    assert opened.coloring == first
    assert set(visited) == {None, *(key for key in sheet.fields if key[1] != "flag")}
    opened.cycle(-1)
    assert opened.coloring == visited[-1]


def test_views_turn_together_until_told_otherwise(opened):
    left, right = opened.plotter.renderers[0].camera, opened.plotter.renderers[1].camera
    assert left is right
    opened.turn_together()
    assert opened.plotter.renderers[0].camera is not opened.plotter.renderers[1].camera
    opened.turn_together()
    assert opened.plotter.renderers[0].camera is opened.plotter.renderers[1].camera


def test_saved_pictures_do_not_replace_each_other(opened, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    assert [opened.save_picture().name for _ in range(2)] == ["kirisurf-view-1.png", "kirisurf-view-2.png"]


@pytest.mark.parametrize("show", [lambda s: show_sheet(s), lambda s: show_surface(s.target)])
def test_without_a_display_the_error_names_the_report(sheet, monkeypatch, show):
    monkeypatch.setattr(window, "probe_display", lambda: opengl.OpenGL(False, "", "there is no display"))
    with pytest.raises(NoDisplayError, match=r"there is no display.*report\.html.*kirisurf report") as caught:
        show(sheet)
    assert caught.value.exit_code == 1
