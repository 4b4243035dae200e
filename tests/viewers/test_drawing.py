"""Buffers for VTK."""

from __future__ import annotations

import numpy as np

from kirisurf.loops import Loops
from viewers.drawing import VALUES, cell_buffer, colormap, polydata
from viewers.fields import describe_field
from viewers.scenes import deployed_scene, holes_scene, target_scene


def test_cell_buffer_counts_every_loop():
    loops = Loops.from_lists([[4, 5, 6], [0, 1], [9, 8, 7, 6]])
    assert cell_buffer(loops).tolist() == [3, 4, 5, 6, 2, 0, 1, 4, 9, 8, 7, 6]
    assert cell_buffer(Loops.from_lists([])).tolist() == []


def test_polydata_holds_the_polygons_as_they_are(sheet):
    tiles = holes_scene(sheet, "mean_curvature").items[0]
    drawn = polydata(tiles)
    assert drawn.n_cells == len(sheet.tiles)
    assert np.array_equal(drawn.regular_faces, sheet.tiles.indices.reshape(-1, 4))
    assert drawn.points.dtype == np.float64


def test_values_lie_where_the_field_lies(sheet):
    holes = next(item for item in holes_scene(sheet, "mean_curvature").items if item.name == "holes")
    assert np.array_equal(polydata(holes).cell_data[VALUES], sheet.fields["hole", "mean_curvature"])
    tiles = next(i for i in deployed_scene(sheet, coloring=("vertex", "distance")).items if i.name == "tiles")
    assert np.array_equal(polydata(tiles).point_data[VALUES], sheet.fields["vertex", "distance"])


def test_normals_of_the_target_are_those_of_the_surface(sheet):
    drawn = polydata(target_scene(sheet.target).items[0])
    assert np.allclose(drawn.point_data.active_normals, sheet.target.normals)


def test_the_diverging_map_is_light_in_the_middle_and_apart_at_the_ends():
    colors = colormap(describe_field("mean_curvature", "hole", np.array([-1.0, 1.0])))
    low, middle, high = (np.array(colors(v)[:3]) for v in (0.0, 0.5, 1.0))
    assert middle.min() > 0.9
    assert low[2] > low[0] + 0.3 and high[0] > high[2] + 0.3
