"""What is drawn, as descriptions: no window is opened here."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from kirisurf.status import Status
from viewers.fields import describe_field
from viewers.items import sheet_items
from viewers.workbench import events, scene
from viewers.workbench.details import certificate_lines, measure_lines, picked_lines
from viewers.workbench.pipeline import STAGES, Stage
from viewers.workbench.poses import Poses
from viewers.workbench.progress import progress_words, solved_share
from viewers.workbench.results import Results
from viewers.workbench.state import Selection, all_shown


def names(drawn):
    return [item.name for item in drawn.items]


def item(drawn, name):
    return next(each for each in drawn.items if each.name == name)


def test_hiding_a_stage_takes_its_items_away(state, fitted):
    everything = all_shown(state)
    owned = {
        Stage.TARGET: {"target", "rim"},
        Stage.GUESS: {"guess"},
        Stage.FIT: {"tiles", "tile edges"},
        Stage.HOLES: {"holes"},
    }
    whole = set(names(scene.deployed_view(everything, fitted)))
    assert whole == set().union(*owned.values())
    for stage, gone in owned.items():
        assert set(names(scene.deployed_view(everything.toggled(stage), fitted))) == whole - gone
    flat = names(scene.contracted_view(everything, fitted))
    assert flat == ["pattern", "tiles", "tile edges"]
    assert names(scene.contracted_view(everything.toggled(Stage.CONTRACTED), fitted)) == ["pattern"]
    assert names(scene.contracted_view(everything.toggled(Stage.PATTERN), fitted)) == ["tiles", "tile edges"]
    hidden = replace(state, shown=frozenset())
    assert not names(scene.deployed_view(hidden, fitted)) and len(STAGES) == 6


def test_both_views_share_frame_and_line_of_sight(state, fitted):
    poses = Poses(fitted.sheet)
    left, right = scene.contracted_view(state, fitted, poses), scene.deployed_view(state, fitted, poses)
    assert left.view == right.view
    assert np.array_equal(left.frame, right.frame)


def test_the_ends_of_the_deployment_are_the_two_states_and_between_is_labelled(state, fitted):
    poses = Poses(fitted.sheet)
    at = {s: scene.deployed_view(state.deployed_to(s), fitted, poses) for s in (0.0, 0.5, 1.0)}
    assert np.array_equal(item(at[1.0], "tiles").points, fitted.sheet.deployed)
    assert np.array_equal(item(at[0.0], "tiles").points, poses.flat)
    assert at[0.5].title.startswith("Interpolated") and at[0.5].note == scene.INTERPOLATED
    # between, a curved target would hide the sheet: its rim stays
    assert "target" in names(at[1.0]) and "target" not in names(at[0.5]) and "rim" in names(at[0.5])
    assert "Interpolated" not in at[0.0].title + at[1.0].title
    # the flat pose is the contracted sheet, moved as a whole
    flat, own = poses.flat, fitted.sheet.contracted
    assert np.allclose(np.linalg.norm(flat[1:] - flat[:-1], axis=1), np.linalg.norm(own[1:] - own[:-1], axis=1))


def test_the_field_colors_what_it_lies_on_and_signs_get_a_symmetric_range(state, fitted):
    for where, name in scene.colorings(fitted):
        drawn = scene.deployed_view(state.colored((where, name)), fitted)
        field = item(drawn, "holes" if where == "hole" else "tiles").field
        assert field is not None and field.name == name
        assert not field.signed or field.limits[0] == -field.limits[1]
    assert scene.coloring(state.colored(("tile", "no such field")), fitted) is None


def test_a_pick_is_outlined_in_both_views(state, fitted):
    for kind, loops in (("tile", fitted.sheet.tiles), ("hole", fitted.sheet.holes)):
        picked = state.picked(Selection(kind, 2))
        for drawn in (scene.deployed_view(picked, fitted), scene.contracted_view(picked, fitted)):
            assert set(item(drawn, "picked").loops.indices) == set(loops[2])
    assert "picked" not in names(scene.deployed_view(state.picked(Selection("hole", 10**6)), fitted))


def test_every_face_of_a_hole_names_its_hole(fitted):
    """Against the colors: a field that numbers the holes is spread over their faces by other code."""
    sheet = fitted.sheet
    assert sheet.patches is not None
    numbered = describe_field("number", "hole", np.arange(len(sheet.holes), dtype=float))
    for points in (sheet.deployed, Poses(sheet).flat):
        for drawn in sheet_items(sheet, points, numbered):
            if drawn.name == "holes":
                assert np.array_equal(scene.cell_numbers(sheet, drawn), drawn.field.values)
    tiles = next(each for each in sheet_items(sheet, sheet.deployed) if each.name == "tiles")
    assert np.array_equal(scene.cell_numbers(sheet, tiles), np.arange(len(sheet.tiles)))


def test_while_the_solver_goes_the_sheet_on_its_way_is_shown(state, fitted):
    guess = fitted.guess
    moving = fitted.begun(9, Stage.FIT).received(events.Moved(9, guess))
    drawn = scene.deployed_view(state, moving)
    assert np.array_equal(item(drawn, "tiles").points, guess.points) and item(drawn, "tiles").field is None
    assert scene.contracted_view(state, moving).title == "Contracted, before the change"
    first = scene.contracted_view(state, Results(moving=guess, target=fitted.target))
    assert first.title.startswith("Pattern") and names(first) == ["tiles", "tile edges"]


def test_before_anything_is_known_the_scenes_are_empty(state):
    assert not scene.deployed_view(state, Results()).items
    assert not scene.contracted_view(state, Results()).items
    assert scene.deployment_scenes(state, Results()) == ()


def test_an_animation_starts_flat_and_is_open_halfway(state, fitted):
    frames = scene.deployment_scenes(state, fitted, 8)
    assert len(frames) == 8 and frames[0].title == "Contracted" and frames[4].title == "Deployed"
    turned = scene.turntable_scenes(frames[4], 12)
    directions = np.array([frame.view.direction for frame in turned])
    assert np.allclose(directions[:, 2], directions[0, 2]) and np.allclose(directions[:, :2].sum(axis=0), 0)
    assert all(np.array_equal(frame.frame, turned[0].frame) for frame in turned)


def test_reports_on_old_jobs_are_left_out(fitted):
    current = fitted.begun(7)
    assert current.received(events.Failed(6, "old")) is current
    failed = current.received(events.Failed(7, "too narrow"))
    assert failed.problem == "too narrow" and failed.running is None and failed.sheet is fitted.sheet
    lost = current.received(events.Lost("gone"))
    assert lost.problem == "gone" and lost.running is None


def test_another_target_takes_the_sheet_away_and_the_same_one_keeps_it(fitted):
    again = fitted.begun(7).received(events.TargetRead(7, fitted.target))
    assert again.sheet is not None and again.sheet.target is fitted.target
    other = replace(fitted.target, name="another")
    assert fitted.begun(7).received(events.TargetRead(7, other)).sheet is None


def test_numbers_of_a_pick_are_those_of_the_fields(fitted):
    sheet = fitted.sheet
    lines = {line.label: line for line in picked_lines(sheet, Selection("tile", 4))}
    area = sheet.fields["tile", "area"][4]
    assert float(lines["area"].value) == pytest.approx(area, rel=5e-3) and lines["area"].unit == "unit\u00b2"
    smallest = np.degrees(sheet.fields["tile", "corner_angle_min"][4])
    assert float(lines["smallest tile angle"].value) == pytest.approx(smallest, rel=5e-3)
    distance = np.abs(sheet.fields["vertex", "distance"][sheet.tiles[4]]).max()
    assert abs(float(lines["distance to the target, at a corner"].value)) == pytest.approx(distance, rel=5e-3)
    assert picked_lines(sheet, None) == () == picked_lines(sheet, Selection("hole", 10**6))


def test_the_verdict_and_the_measures_are_in_words(fitted):
    assert fitted.certified.passed
    rows = certificate_lines(fitted.certified)
    assert rows and all(row.verdict != "fail" for row in rows)
    failing = replace(fitted.certified, failures=("length: 1 is too much",))
    assert [row.name for row in certificate_lines(failing) if row.verdict == "fail"] == ["length"]
    assert "porosity" in [line.label for line in measure_lines(fitted.fitted.numbers)]


def test_progress_is_the_share_of_digits_and_ends_full():
    steps = [{"length": 10.0**-k, "angle": 0.0} for k in range(12)]
    shares = [solved_share(steps[: k + 1], 1e-9) for k in range(12)]
    assert shares == sorted(shares) and shares[0] == 0.0 and shares[-1] == 1.0
    assert solved_share([], 1e-9) == 0.0


def test_the_status_line_says_what_matters_most(fitted):
    assert progress_words(fitted, False)[0].startswith("Certified, 36 tiles")
    assert "press Fit" in progress_words(fitted, True)[0]
    assert progress_words(replace(fitted, problem="no such file"), False) == ("no such file", True)
    stopped = replace(fitted, fitted=replace(fitted.fitted, status=Status.INTERRUPTED))
    words, is_problem = progress_words(stopped, False)
    assert words.startswith(Status.INTERRUPTED.value) and is_problem and ("Resume" in words) == stopped.can_resume
    assert stopped.can_resume and not fitted.can_resume
