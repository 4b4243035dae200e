"""Named fields, tables and numbers of a design."""

from __future__ import annotations

import numpy as np
import pytest

from analysis.measures import measure
from analysis.tables import HOLE_COLUMNS
from kirisurf.errors import UnusableError
from kirisurf.pattern import quad_pattern
from kirisurf.surface import Surface
from kirisurf.unit_cells.catalog import find_cell
from tests.analysis.patterns import NAMES, in_space, regular

FIELDS = {
    "vertex": "distance distance_over_edge closure_gap residual_ring opening_angle_mean",
    "tile": "planarity isometry area size_ratio smallest_edge corner_angle_min corner_angle_max tile_angle_deviation "
    "area_magnification angle_excess target_integrated_gaussian_curvature",
    "hole": "mean_curvature gaussian_curvature mean_curvature_averaged gaussian_curvature_averaged "
    "target_mean_curvature target_gaussian_curvature gaussian_curvature_difference mean_curvature_difference "
    "principal_curvature_1 principal_curvature_2 integrated_gaussian_curvature target_integrated_gaussian_curvature "
    "angle_defect gauss_image_area target_integrated_gaussian_curvature_cell mean_curvature_from_patch "
    "gaussian_curvature_from_patch mean_curvature_from_fit gaussian_curvature_from_fit "
    "area opening_angle opening_angle_mean flag",
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
    partial = {("vertex", "opening_angle_mean"), ("tile", "area_magnification"), ("hole", "angle_defect")}
    assert all(np.isfinite(value).all() for key, value in measures.fields.items() if key not in partial)


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
        curved = -2 if "gaussian_" in name else -1 if "mean_" in name or "principal" in name else 0
        power = powers.get(name, 0 if "angle" in name or "integrated" in name else curved)
        assert two.fields[where, name] == pytest.approx(value * 5.0**power, rel=1e-5, abs=1e-8, nan_ok=True), name


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


def _numbers(pattern, **more) -> dict:
    space = in_space(pattern.deployed)
    low, high = space.min(axis=0) - 1, space.max(axis=0) + 1
    corners = np.array([[low[0], low[1], 0], [high[0], low[1], 0], [high[0], high[1], 0], [low[0], high[1], 0]])
    target = Surface.from_arrays(corners, np.array([[0, 1, 2], [0, 2, 3]]))
    return dict(measure(pattern, space, pattern.contracted, target, **more).numbers)


@pytest.mark.parametrize("name", NAMES)
def test_regular_pattern_measures_as_its_cell(name):
    pattern = regular(name, 4)
    numbers = _numbers(pattern)
    assert numbers["tile_area_spread"] <= 1e-12 and numbers["edge_length_spread"] <= 1e-12
    assert numbers["n_flagged_holes"] == 0
    assert numbers["porosity"] == pytest.approx(numbers["hole_area"] / (numbers["hole_area"] + numbers["tile_area"]))
    assert numbers["linear_magnification"] ** 2 == pytest.approx(numbers["area_magnification"])
    assert 0 < numbers["opening_angle_min"] <= numbers["opening_angle_mean"] <= numbers["opening_angle_max"] < np.pi
    assert 0 < numbers["corner_angle_min"] <= numbers["corner_angle_max"] < 2 * np.pi
    assert numbers["edge_length_min"] <= numbers["edge_length"]
    # a finite sheet opens less than an infinite one: its rim does not open
    cell = find_cell(name)
    assert 1 < numbers["area_magnification"] < np.prod(cell.stretches)


def test_corner_angles_of_the_published_tiles():
    degrees = {"quad": (90, 90), "kagome": (60, 60), "hexagon": (120, 120), "islamic-quad": (45, 225)}
    for name, (smallest, largest) in degrees.items():
        numbers = _numbers(regular(name, 2))
        assert np.degrees(numbers["corner_angle_min"]) == pytest.approx(smallest, abs=1e-9), name
        assert np.degrees(numbers["corner_angle_max"]) == pytest.approx(largest, abs=1e-9), name


def test_the_boundary_layer_is_measured_where_the_outline_is_given():
    pattern = regular("quad", 3)
    x, y = np.ptp(pattern.deployed, axis=0) / 2
    outline = np.array([[-x, -y], [x, -y], [x, y], [-x, y]])
    numbers = _numbers(pattern, target_outline=outline)
    assert numbers["boundary_layer_area"] == pytest.approx(11 / 72)
    assert numbers["outline_area_difference"] == pytest.approx(1 / 12)
    assert "boundary_layer_area" not in _numbers(pattern)


def test_openings_stand_at_their_vertices_and_holes():
    pattern = quad_pattern(3, 3, 0.4)
    space = in_space(pattern.deployed)
    corners = np.array([[-9.0, -9, 0], [9, -9, 0], [9, 9, 0], [-9, 9, 0]])
    target = Surface.from_arrays(corners, np.array([[0, 1, 2], [0, 2, 3]]))
    field = measure(pattern, space, pattern.contracted, target).fields
    ends = np.unique(pattern.hinges[pattern.slit_ends, 1])
    at = field["vertex", "opening_angle_mean"]
    assert at[ends] == pytest.approx(np.full(len(ends), 0.8))
    assert np.isnan(np.delete(at, ends)).all()
    assert field["hole", "opening_angle_mean"] == pytest.approx(field["hole", "opening_angle"])
