"""Labels, units and ranges of fields."""

from __future__ import annotations

import numpy as np
import pytest

from analysis.measures import measure
from kirisurf.errors import ParameterError
from kirisurf.field_units import unit_label, unit_of_field
from kirisurf.pattern import quad_pattern
from kirisurf.surface import Surface
from viewers.fields import describe_field, name_unit


def test_signed_field_is_symmetric_about_zero():
    field = describe_field("mean_curvature", "hole", np.array([-1.0, 0.5, 3.0]), "mm")
    assert field.signed
    assert field.limits == (-3.0, 3.0)
    assert field.unit == "1/mm"
    assert field.range_note == ""


def test_a_wild_value_does_not_set_the_range_and_the_note_says_so():
    values = np.r_[np.linspace(-1, 1, 200), 1e6]
    field = describe_field("gaussian_curvature", "hole", values, "m")
    assert field.limits[1] == -field.limits[0]
    assert 0.9 < field.limits[1] < 1.1
    assert "98th percentile of the absolute value" in field.range_note
    assert field.unit == "1/m\u00b2"
    assert field.exceeds == (True, True) or field.exceeds == (False, True)


def test_unsigned_field_starts_at_zero_when_near_it():
    field = describe_field("planarity", "tile", np.array([1e-13, 2e-13, 9e-13]))
    assert field.limits == (0.0, 9e-13)
    assert not field.signed


@pytest.mark.parametrize("values", [np.zeros(5), np.full(5, 3.0), np.full(5, -3.0), np.zeros(0), np.full(3, np.nan)])
def test_range_is_never_empty(values):
    for name in ("mean_curvature", "planarity"):
        low, high = describe_field(name, "hole", values).limits
        assert low < high


def test_missing_values_do_not_count():
    field = describe_field("mean_curvature", "hole", np.array([np.nan, -2.0, 1.0]))
    assert field.limits == (-2.0, 2.0)


def test_unknown_field_is_named_by_its_words_and_signed_by_its_values():
    assert describe_field("my_own", "tile", np.array([1.0, 2.0])).label == "my own"
    assert not describe_field("my_own", "tile", np.array([1.0, 2.0])).signed
    assert describe_field("my_own", "tile", np.array([-1.0, 2.0])).signed


def test_wrong_arguments_are_refused():
    with pytest.raises(ParameterError, match="expected vertex, tile or hole, got 'face'"):
        describe_field("area", "face", np.zeros(2))
    with pytest.raises(ParameterError, match="percent"):
        describe_field("area", "tile", np.zeros(2), percent=30.0)


def test_units():
    assert [unit_label(p, "mm") for p in (1, 2, -1, -2, 0, "rad")] == [
        "mm",
        "mm\u00b2",
        "1/mm",
        "1/mm\u00b2",
        "",
        "rad",
    ]
    assert (name_unit("unit", 1), name_unit("unit", 2), name_unit("mm", 2)) == ("unit", "units", "mm")


def test_every_measured_field_has_words_and_the_unit_of_the_files():
    pattern = quad_pattern(3, 3)
    points = np.c_[pattern.deployed, 0.05 * pattern.deployed[:, 0] ** 2]
    corners = np.array([[-1.0, -1, 0], [6, -1, 0], [6, 6, 0], [-1, 6, 0]])
    target = Surface.from_arrays(corners, np.array([[0, 1, 2], [0, 2, 3]]))
    for where, name in measure(pattern, points, pattern.contracted, target).fields:
        field = describe_field(name, where, np.array([-1.0, 1.0]), "mm")
        assert field.unit == unit_of_field(name, "mm")
        assert field.label != name.replace("_", " ") or name in (
            "area",
            "planarity",
            "isometry",
            "flag",
            "closure_gap",
        ), name
        assert field.signed == (name not in UNSIGNED)


UNSIGNED = frozenset(
    [
        "closure_gap",
        "planarity",
        "isometry",
        "area",
        "size_ratio",
        "smallest_edge",
        "corner_angle_min",
        "corner_angle_max",
        "flag",
        "tile_angle_deviation",
        "area_magnification",
        "opening_angle",
        "opening_angle_mean",
    ]
)
