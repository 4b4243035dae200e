"""What a user chose: deeds give new states, undo brings the old ones back, options stay consistent."""

from __future__ import annotations

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kirisurf.errors import ParameterError
from kirisurf.spec import FitSpec
from viewers.workbench import options
from viewers.workbench.history import MOST, History
from viewers.workbench.pipeline import STAGES, Stage, first_stage, first_stale
from viewers.workbench.state import Selection, State


@given(st.lists(st.sampled_from(["a", "b", "undo", "redo"]), max_size=30))
def test_a_history_walks_like_a_tape(deeds):
    """The slow way: a list and a position."""
    history, tape, at = History("start"), ["start"], 0
    for deed in deeds:
        if deed == "undo":
            history, at = history.undone(), max(at - 1, 0)
        elif deed == "redo":
            history, at = history.redone(), min(at + 1, len(tape) - 1)
        else:
            history = history.did(deed)
            if deed != tape[at]:
                tape, at = [*tape[: at + 1], deed], at + 1
        assert history.present == tape[at]
        assert (*history.past, history.present, *history.future) == tuple(tape)


def test_a_history_forgets_the_oldest_and_adjustments():
    history = History(0)
    for number in range(1, MOST + 10):
        history = history.did(number)
    assert len(history.past) == MOST and history.past[0] == 9
    assert History("a").adjusted("b").undone().present == "b"


def test_every_option_of_a_fit_belongs_to_a_stage_and_the_first_one_counts():
    spec = FitSpec(target="hypar", cells=(4, 4))
    assert first_stale(None, spec) is Stage.TARGET
    assert first_stale(spec, spec) is None
    for name, value, stage in (
        ("target", "peaks", Stage.TARGET),
        ("cells", (5, 5), Stage.PATTERN),
        ("opening", 20.0, Stage.GUESS),
        ("min_angle", 9.0, Stage.FIT),
        ("kerf", 0.01, None),
    ):
        assert first_stale(spec, spec.changed(**{name: value})) is stage is first_stage(name)
    later = spec.changed(min_angle=9.0, opening=20.0, kerf=0.01)
    assert first_stale(spec, later) is Stage.GUESS


def test_toggling_twice_changes_nothing_and_every_stage_can_be_toggled(state):
    for stage in STAGES:
        assert (stage in state.toggled(stage).shown) != (stage in state.shown)
        assert state.toggled(stage).toggled(stage) == state


def test_a_hole_field_shows_the_holes(state):
    hidden = state.toggled(Stage.HOLES)
    assert Stage.HOLES in hidden.colored(("hole", "area")).shown
    assert Stage.HOLES not in hidden.colored(("tile", "area")).shown


def test_a_pick_is_let_go_by_picking_again_and_by_another_pattern(state):
    pick = Selection("tile", 3)
    picked = state.picked(pick)
    assert picked.selection == pick and picked.picked(pick).selection is None
    assert picked.with_option("min_angle", 5.0).selection == pick
    assert picked.with_option("cells", (4, 4)).selection is None
    with pytest.raises(ParameterError, match="expected a tile or a hole"):
        Selection("vertex", 1)


@pytest.mark.parametrize(("share", "kept"), [(-1.0, 0.0), (0.3, 0.3), (2.0, 1.0)])
def test_deployment_stays_between_the_states(state, share, kept):
    assert state.deployed_to(share).share == kept


def test_every_option_is_one_of_the_spec_and_takes_its_own_choices():
    spec = FitSpec(target="hypar", cells=(4, 4))
    for option in options.options():
        assert hasattr(spec, option.name), option.name
        for choice in option.choices:
            assert getattr(options.changed(spec, option.name, choice), option.name) == (choice or None)
        if option.without:
            freed = options.changed(spec, option.name, option.without_value)
            assert getattr(freed, option.name) == option.without_value
        if option.kind == "number" and option.name not in ("orientation", "kerf"):
            for value in (option.least, option.least + option.step):
                # a bound may exclude itself (above 0), never what one step reaches
                if value > 0 or option.least > 0:
                    options.changed(spec.changed(min_angle=0.0), option.name, float(value))


def test_exchanging_layouts_drops_what_does_not_go_together():
    trimmed = FitSpec(target="hypar", tiles=100, orientation=30.0)
    rectangular = options.with_cells(trimmed)
    assert rectangular.cells is not None and rectangular.orientation == "auto"
    shaped = options.changed(rectangular, "contracted", "rectangle")
    assert options.with_tiles(shaped).contracted == "free"
    assert options.turned(rectangular, 30.0) == rectangular


@given(st.floats(-720, 720), st.floats(-180, 180))
def test_turns_add_up_to_a_full_turn(first, second):
    spec = FitSpec(target="hypar", tiles=100)
    once = options.turned(options.turned(spec, first), second)
    together = options.turned(spec, first + second)
    assert abs((float(once.orientation) - float(together.orientation) + 180) % 360 - 180) < 0.21


def test_larger_tiles_are_fewer_by_the_square():
    assert options.resized(FitSpec(target="hypar", tiles=400), 2.0).tiles == 100
    assert options.resized(FitSpec(target="hypar", tiles=400), 1e3).tiles == 4
    assert options.resized(FitSpec(target="hypar", cells=(8, 2)), 4.0).cells == (2, 1)


def test_a_wrong_value_is_refused_and_names_what_was_expected(state):
    with pytest.raises(ParameterError, match="expected a number from 0 up to 90"):
        state.with_option("min_angle", 200.0)
    assert State(state.spec) == state
