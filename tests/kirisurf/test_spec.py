"""The spec: exact round trip through TOML, one failing input for every rule, later options refused by name."""

from __future__ import annotations

import tomllib

import pytest
from hypothesis import given
from hypothesis import strategies as st

from kirisurf.errors import ParameterError
from kirisurf.spec import CLOSENESS, DEFAULT_TILES, SOLVERS, FitSpec, parse_cells
from kirisurf.units import UNITS

positive = st.floats(1e-12, 1e12)
specs = st.fixed_dictionaries(
    {
        "target": st.text(st.characters(blacklist_categories=["Cs"], blacklist_characters="\0"), min_size=1).filter(
            str.strip
        )
    },
    optional={
        "closeness": st.sampled_from(CLOSENESS),
        "initial": st.sampled_from(["auto", "standard", "conformal", "analytic", "flat"]),
        "solver": st.sampled_from(SOLVERS),
        "tolerance": st.floats(1e-12, 1e-3),
        "max_seconds": positive,
        "max_steps": st.integers(1, 10**6),
        "repair": st.booleans(),
        "min_edge": st.floats(0, 1),
        "min_angle": st.floats(0, 90),
        "hinge_width": st.floats(1.0, 1e300),
        "kerf": st.floats(0, 0.999),
        "units": st.sampled_from(UNITS),
        "opening": st.floats(0, 90) | st.just("auto"),
        "orientation": st.floats(-360, 360) | st.just("auto"),
    },
)
sizes = st.one_of(
    st.just({}),
    st.tuples(st.integers(1, 10**4), st.integers(1, 10**4)).map(lambda cells: {"cells": cells}),
    st.integers(4, 10**7).map(lambda tiles: {"tiles": tiles}),
)


@given(specs, sizes)
def test_toml_gives_back_the_same_spec(values: dict, size: dict) -> None:
    if "cells" in size:
        values.pop("orientation", None)  # cells follow the corners of the outline
    spec = FitSpec(**values, **size)
    assert FitSpec.from_toml(spec.to_toml()) == spec
    assert FitSpec.from_dict(spec.as_dict()) == spec
    assert tomllib.loads(spec.to_toml()) == spec.as_dict()


def test_a_spec_without_size_asks_for_the_default_number_of_tiles() -> None:
    assert FitSpec("x.stl").tiles == DEFAULT_TILES
    assert FitSpec("x.stl", cells=(2, 3)).tiles is None


@pytest.mark.parametrize(
    "values",
    [
        {"target": " "},
        {"target": "a\0b"},
        {"target": 5},
        {"cells": (0, 4)},
        {"cells": (4,)},
        {"cells": "4x4"},
        {"cells": (4.5, 4)},
        {"cells": (2, 2), "tiles": 9},
        {"tiles": 3},
        {"tiles": True},
        {"tiles": 10.0},
        {"closeness": "bets"},
        {"initial": "warm"},
        {"solver": 3},
        {"tolerance": 0},
        {"tolerance": 1e-13},
        {"cells": (3, 3), "orientation": 30.0},
        {"tolerance": 1},
        {"tolerance": float("nan")},
        {"tolerance": "1e-9"},
        {"max_seconds": 0},
        {"max_seconds": float("inf")},
        {"max_steps": 0},
        {"max_steps": 1.5},
        {"repair": 1},
        {"remesh": "yes"},
        {"remesh_edge": 1.0},
        {"remesh": True, "remesh_edge": -1.0},
        {"min_edge": 1.1},
        {"min_angle": -1},
        {"hinge_width": 0},
        {"kerf": -0.1},
        {"kerf": 0.5, "hinge_width": 0.5},
        {"kerf": float("nan")},
        {"units": "parsec"},
        {"opening": "wide"},
        {"opening": 91},
        {"orientation": float("inf")},
        {"tessellation": "squares"},
        {"tessellation": 4},
    ],
    ids=str,
)
def test_a_wrong_value_is_refused_with_what_was_expected(values: dict) -> None:
    with pytest.raises(ParameterError, match=r"expected .*, got "):
        FitSpec(**{"target": "x.stl", **values})


@pytest.mark.parametrize(
    "values",
    [
        {"tessellation": "islamic-triangle"},
        {"tessellation": "trihexagonal"},
        {"tessellation": "cells/mine.cell"},
        {"initial": "teichmuller"},
        {"contracted": "rectangle"},
        {"contracted": "rectangle:2"},
        {"contracted": "outline.svg"},
        {"contracted": "disc"},
        {"max_opening": 90.0, "min_corner": 20.0},
        {"prefer": "smoothest"},
    ],
    ids=str,
)
def test_shapes_of_the_sheet_survive_the_round_trip(values: dict) -> None:
    spec = FitSpec("x.stl", **values)
    assert FitSpec.from_toml(spec.to_toml()) == spec


@pytest.mark.parametrize(
    ("values", "said"),
    [
        ({"tessellation": "kagom"}, "did you mean 'kagome'"),
        ({"contracted": "rectangle:"}, "rectangle:RATIO"),
        ({"contracted": "rectangle:nan"}, "rectangle:RATIO"),
        ({"contracted": "rectangle:1e9"}, "0.01 to 100"),
        ({"contracted": " "}, "expected free"),
        ({"contracted": 2}, "expected free"),
        ({"max_opening": 2.0}, "more than the smallest opening"),
        ({"max_opening": 181.0}, "up to 180"),
        ({"min_corner": 61.0}, "up to 60"),
        ({"prefer": "smooth"}, "did you mean 'smoothest'"),
    ],
    ids=str,
)
def test_shapes_of_the_sheet_are_checked(values: dict, said: str) -> None:
    with pytest.raises(ParameterError, match=said):
        FitSpec("x.stl", **values)


def test_unknown_names_are_refused_with_the_nearest_known_one() -> None:
    with pytest.raises(ParameterError, match="did you mean 'closeness'"):
        FitSpec.from_dict({"target": "x.stl", "closenes": "best"})
    with pytest.raises(ParameterError, match="expected a target"):
        FitSpec.from_dict({})
    with pytest.raises(ParameterError, match="expected TOML"):
        FitSpec.from_toml("target =")


@pytest.mark.parametrize("text", ["", "4", "4x", "x4", "4x4x4", "-4x4", "4.5x4", "0x4", "4x99999", "٤"])
def test_cells_have_one_form(text: str) -> None:
    with pytest.raises(ParameterError, match="expected WxH"):
        parse_cells(text)


def test_changing_the_size_forgets_the_other_size() -> None:
    spec = FitSpec("x.stl", cells=(2, 2))
    assert spec.changed(tiles=50).cells is None
    assert spec.changed(tiles=50).changed(cells=(3, 3)).tiles is None
