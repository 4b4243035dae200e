"""What the page shows, without a page."""

from __future__ import annotations

import json
from dataclasses import replace

import numpy as np
import pytest

from kirisurf.errors import ParameterError
from viewers.fields import describe_field
from viewers.workbench.options import options
from viewers.workbench.pipeline import Stage
from viewers.workbench.web.charts import color_bar, residual_curves, scale_bar
from viewers.workbench.web.editors import option_value, option_values
from viewers.workbench.web.values import fixed_values, page_values


def values(session):
    return page_values(session, session.scenes())


def test_everything_on_the_page_can_be_sent_to_it(session):
    known = {**fixed_values(), **values(session)}
    assert json.loads(json.dumps(known, allow_nan=False)) == known


def test_an_option_comes_back_as_it_was_shown(session):
    spec = session.state.spec
    shown = option_values(spec)
    for option in options():
        value = shown[option.name]
        if option.kind == "number" and value is None and not option.without:
            continue
        given = value if option.kind in ("pair", "choice") else "" if value is None else str(value)
        if option.kind == "pair" or given or option.without:
            assert option_value(option.name, given) == (
                getattr(spec, option.name) if given != "" else option.without_value or given or None
            )


@pytest.mark.parametrize(
    ("name", "given"),
    [
        ("no such option", "1"),
        ("target", "/etc/passwd"),
        ("min_angle", "wide"),
        ("min_angle", ""),
        ("min_angle", [1]),
        ("cells", "4"),
        ("cells", [1, "x"]),
        ("cells", [1, 2, 3]),
        ("tiles", "1.5"),
    ],
)
def test_what_is_no_value_of_an_option_is_refused(name, given):
    with pytest.raises(ParameterError, match="expected"):
        option_value(name, given)


def test_numbers_may_have_a_comma():
    assert option_value("min_angle", "7,5") == 7.5 and option_value("max_opening", "") is None
    assert option_value("opening", "") == "auto"


def test_the_page_follows_the_session(session):
    before = values(session)
    assert before["shown"]["guess"] is False and before["can"]["undo"] is False and before["bar"]["label"]
    session.do(session.state.toggled(Stage.GUESS).colored(None))
    after = values(session)
    assert after["shown"]["guess"] is True and after["can"]["undo"] is True and after["bar"] is None
    assert after["coloring"] == "" and before["coloring"] == "hole/gaussian_curvature"
    offered = [field["value"] for group in before["colorings"] for field in group["fields"]]
    assert before["coloring"] in offered and len(set(offered)) == len(offered)


def test_picking_fills_the_numbers(session):
    from viewers.workbench.state import Selection

    session.adjust(session.state.picked(Selection("hole", 2)))
    shown = values(session)
    assert shown["picked_title"] == "Hole 2"
    row = next(row for row in shown["picked"] if row[0] == "Gaussian curvature K")
    wanted = session.results.sheet.fields["hole", "gaussian_curvature"][2]
    assert float(row[1]) == pytest.approx(wanted, rel=1e-2)


def test_there_is_a_next_step_whenever_nothing_runs(session, fitted):
    assert "hole" in values(session)["next_step"]
    session.do(session.state.live(False))
    session.do(session.state.with_option("min_angle", 20.0))
    assert values(session)["next_step"] == "Press Fit." and not values(session)["can"]["save"]
    session.results = replace(fitted, running=Stage.FIT)
    assert values(session)["next_step"] == ""


def test_paths_of_uploads_are_not_shown(session):
    path = "/tmp/kirisurf-x/upload-y/roof.obj"
    session.history = session.history.adjusted(session.state.with_spec(session.state.spec.changed(target=path)))
    session.results = replace(session.results, running=Stage.TARGET, doing=f"reading {path}")
    shown = values(session)
    assert shown["target"] == "roof.obj" and "/tmp" not in shown["status"] and "roof.obj" in shown["status"]


def test_a_color_bar_has_its_ticks_where_their_values_are():
    field = describe_field("mean_curvature", "hole", np.linspace(-2.0, 1.0, 50), "mm")
    bar = color_bar(field, "Holes")
    low, high = field.limits
    for tick in bar["ticks"]:
        assert low + (high - low) * tick["at"] / 100 == pytest.approx(float(tick["words"]), abs=1e-3)
    colors = bar["gradient"].removeprefix("linear-gradient(to right, ").rstrip(")").split(", ")
    middle = [int(colors[len(colors) // 2][k : k + 2], 16) for k in (1, 3, 5)]
    assert min(middle) > 235, "zero is white in a diverging map"
    assert bar["label"] == "Holes: mean curvature H" and bar["unit"] == "1/mm"


@pytest.mark.parametrize("per_pixel", [1e-6, 0.013, 1.0, 777.0])
def test_a_scale_bar_is_as_long_as_it_says(per_pixel):
    bar = scale_bar(per_pixel, 600.0, "mm")
    assert bar["pixels"] * per_pixel == pytest.approx(float(bar["words"].split()[0]), rel=1e-3)
    assert 40 < bar["pixels"] <= 600
    assert scale_bar(float("nan"), 600.0, "mm")["pixels"] == 0.0


def test_larger_residuals_stand_higher():
    steps = [{"length": 1e-2, "angle": 1.0}, {"length": 1e-6, "angle": float("nan")}, {"length": 0.0, "angle": 1e-12}]
    curves = residual_curves(steps, 1e-9)
    length = next(line for line in curves["lines"] if line["name"] == "length")
    heights = [y for _, y in length["points"]]
    assert heights == sorted(heights) and heights[1] < curves["tolerance"] < heights[2] <= 1.0
    assert [x for x, _ in length["points"]] == [0.0, 0.5, 1.0]
    assert residual_curves([], 1e-9)["words"] == "No steps yet"
