"""Named fields, tables and numbers of a design."""

from __future__ import annotations

import numpy as np
import pytest

from analysis.measures import measure
from analysis.tables import HOLE_COLUMNS
from kirisurf.errors import UnusableError
from kirisurf.pattern import quad_pattern

FIELDS = {
    "vertex": "distance distance_over_edge closure_gap residual_ring",
    "tile": "planarity isometry area size_ratio tile_angle_deviation",
    "hole": "mean_curvature gaussian_curvature mean_curvature_averaged gaussian_curvature_averaged "
    "target_mean_curvature target_gaussian_curvature gaussian_curvature_difference mean_curvature_difference "
    "area opening_angle flag",
}


@pytest.fixture
def lifted(grid_surface):
    pattern = quad_pattern(4, 4)
    xy = pattern.deployed - pattern.deployed.mean(axis=0)
    xy = 0.9 * xy / np.abs(xy).max()
    points = np.c_[xy, 0.5 * (xy**2).sum(axis=1)]
    return pattern, points, grid_surface(lambda x, y: 0.5 * (x**2 + y**2), 61)


def test_fields_have_their_names_and_lengths(lifted):
    pattern, points, target = lifted
    measures = measure(pattern, points, pattern.contracted, target)
    lengths = {"vertex": pattern.n_vertices, "tile": pattern.n_tiles, "hole": len(pattern.holes)}
    expected = {(where, name): lengths[where] for where, names in FIELDS.items() for name in names.split()}
    assert {key: len(value) for key, value in measures.fields.items()} == expected
    assert all(np.isfinite(value).all() for value in measures.fields.values())


def test_flat_design_measures_as_what_it_is(flat_design, grid_surface):
    design = flat_design(3, 3, 0.4)
    target = grid_surface(n=4, size=2.5)
    measures = measure(design.tessellation, design.deployed + np.array([0, 0, 0.1]), design.contracted, target)
    field = measures.fields
    assert field["vertex", "distance"] == pytest.approx(np.full(len(design.deployed), 0.1))
    assert field["vertex", "distance_over_edge"] == pytest.approx(np.full(len(design.deployed), 0.2))
    for name in (("vertex", "closure_gap"), ("vertex", "residual_ring"), ("tile", "planarity"), ("tile", "isometry")):
        assert np.abs(field[name]).max() <= 1e-12
    assert field["tile", "area"] == pytest.approx(np.full(36, 0.25))
    assert field["tile", "size_ratio"] == pytest.approx(np.ones(36))
    assert field["tile", "tile_angle_deviation"] == pytest.approx(np.zeros(36), abs=1e-12)
    assert field["hole", "opening_angle"] == pytest.approx(np.full(25, 0.8))
    assert field["hole", "area"] == pytest.approx(np.full(25, 0.25 * np.sin(0.8)))
    assert np.abs(field["hole", "gaussian_curvature"]).max() <= 1e-11
    assert measures.numbers["porosity"] == pytest.approx(25 * np.sin(0.8) / (25 * np.sin(0.8) + 36))


def test_holes_on_a_paraboloid_follow_the_target(lifted):
    pattern, points, target = lifted
    measures = measure(pattern, points, pattern.contracted, target)
    assert measures.numbers["gaussian_curvature_difference_relative"] <= 0.04
    assert measures.numbers["mean_curvature_difference_relative"] <= 0.04
    assert (measures.fields["hole", "target_mean_curvature"] > 0).all()
    integrated = measures.numbers["integrated_gaussian_curvature"]
    assert integrated == pytest.approx(measures.numbers["integrated_target_gaussian_curvature"], rel=0.03)


def test_measures_do_not_depend_on_the_frame(lifted, rotation):
    pattern, points, target = lifted
    moved = type(target).from_arrays(5 * target.vertices @ rotation.T + 40.0, target.faces)
    one = measure(pattern, points, pattern.contracted, target)
    two = measure(pattern, 5 * points @ rotation.T + 40.0, 5 * pattern.contracted, moved)
    powers = {"distance": 1, "area": 2, "closure_gap": 1}
    for (where, name), value in one.fields.items():
        power = powers.get(name, -2 if "gaussian" in name else -1 if "mean" in name else 0)
        assert two.fields[where, name] == pytest.approx(value * 5.0**power, rel=1e-5, abs=1e-8), name


def test_closed_sheet_has_holes_without_area(grid_surface):
    pattern = quad_pattern(3, 3)
    closed = np.pad(pattern.contracted - pattern.contracted.mean(axis=0), ((0, 0), (0, 1)))
    measures = measure(pattern, closed, pattern.contracted, grid_surface(n=4, size=2))
    assert measures.fields["hole", "area"] == pytest.approx(np.zeros(25), abs=1e-15)
    assert measures.fields["hole", "opening_angle"] == pytest.approx(np.zeros(25), abs=1e-12)
    assert measures.numbers["porosity"] == pytest.approx(0)
    # the patches go through the tiles round a hole, which are there and flat however little it opens
    assert measures.fields["hole", "gaussian_curvature"] == pytest.approx(np.zeros(25), abs=1e-12)
    assert measures.fields["hole", "mean_curvature"] == pytest.approx(np.zeros(25), abs=1e-12)


def test_ring_residual_stands_at_its_vertices(lifted):
    pattern, points, target = lifted
    field = measure(pattern, points, pattern.contracted, target).fields["vertex", "residual_ring"]
    inner = np.isin(pattern.weld, pattern.ring_vertices)
    assert np.abs(field[inner]).max() > 0.1
    assert not field[~inner].any()


def test_the_holes_table_holds_the_fields(lifted):
    pattern, points, target = lifted
    measures = measure(pattern, points, pattern.contracted, target)
    rows = measures.tables["holes"]
    assert tuple(rows[0]) == HOLE_COLUMNS
    assert len(rows) == len(pattern.holes)
    for name in ("gaussian_curvature", "mean_curvature_averaged", "area"):
        assert [row[name] for row in rows] == measures.fields["hole", name].tolist()
    assert {row["flag"] for row in rows} == {0}
    center = np.array([[row[axis] for axis in "xyz"] for row in rows])
    corners = np.array([points[hole].mean(axis=0) for hole in pattern.holes])
    assert np.linalg.norm(center - corners, axis=1).max() < 0.02


def test_arrays_of_another_length_are_refused(lifted):
    pattern, points, target = lifted
    with pytest.raises(UnusableError, match="deployed vertices: expected shape"):
        measure(pattern, points[:-1], pattern.contracted, target)
    with pytest.raises(UnusableError, match="contracted vertices: expected shape"):
        measure(pattern, points, pattern.contracted[:-1], target)
