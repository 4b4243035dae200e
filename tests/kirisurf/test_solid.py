"""Solids of the flat sheet: watertight by trimesh's judgement, with the volume of areas times thicknesses."""

from __future__ import annotations

import io

import numpy as np
import pytest
import shapely
import trimesh
from shapely import MultiLineString, Polygon
from trimesh.intersections import mesh_plane

from kirisurf.cuts import cuts
from kirisurf.errors import ParameterError, UnusableError
from kirisurf.formats.stl import stl_bytes
from kirisurf.pattern import tile_pattern
from kirisurf.solid import Solid, _check_closed, solid
from kirisurf.unit_cells import find_cell
from tests.kirisurf.patterns import NAMES, bent, pattern

THICKNESS, HINGE_THICKNESS, WIDTH, GAP = 3.0, 0.7, 4.0, 1.0


def made(name: str, **options: float) -> Solid:
    tessellation = pattern(name)
    points = 100 * bent(tessellation, 0.03)
    return solid(tessellation, points, THICKNESS, WIDTH, **{"hinge_thickness": HINGE_THICKNESS, "gap": GAP, **options})


def read_back(part: Solid) -> trimesh.Trimesh:
    """What a slicer sees: a soup of triangles in single precision, joined where corners are equal."""
    mesh = trimesh.load(io.BytesIO(stl_bytes(part.corners)), file_type="stl", process=False)
    mesh.merge_vertices(digits_vertex=12)
    return mesh


@pytest.mark.parametrize("name", NAMES)
def test_the_file_is_watertight_and_weighs_what_it_should(name: str) -> None:
    part = made(name)
    mesh = read_back(part)
    assert mesh.is_watertight and mesh.is_winding_consistent and mesh.is_volume
    assert mesh.body_count == part.n_pieces == 1
    assert part.n_tiles == pattern(name).n_tiles
    expected = THICKNESS * part.tile_area + HINGE_THICKNESS * part.ligament_area
    assert part.volume == pytest.approx(expected, rel=1e-6)
    assert mesh.volume == pytest.approx(part.volume, rel=1e-6)
    assert np.array_equal(mesh.bounds[0], [0, 0, 0]) and mesh.bounds[1, 2] == pytest.approx(THICKNESS)
    assert np.array_equal(part.vertices, part.vertices.astype(np.float32))


@pytest.mark.parametrize("name", NAMES)
def test_its_areas_are_those_of_the_sheet_without_its_slits(name: str) -> None:
    part = made(name)
    tessellation = pattern(name)
    points = 100 * bent(tessellation, 0.03)
    plain, lines = cuts(tessellation, points, WIDTH), cuts(tessellation, points, WIDTH, GAP)
    sheet = Polygon(plain.outline, plain.openings)
    saw = MultiLineString([line.tolist() for line in lines.slits]).buffer(GAP / 2, quad_segs=4)
    assert part.tile_area + part.ligament_area == pytest.approx(sheet.difference(saw).area, rel=1e-6)
    # every ligament is about as long as the slit is wide, and as wide as it was asked for
    assert part.ligament_area == pytest.approx(len(lines.hinges) * WIDTH * GAP, rel=0.25)


def test_a_cross_section_shows_tiles_above_and_the_whole_sheet_below() -> None:
    part = made("zigzag")
    mesh = read_back(part)
    for height, area, pieces in (
        (0.5 * HINGE_THICKNESS, part.tile_area + part.ligament_area, 1),
        (0.5 * (HINGE_THICKNESS + THICKNESS), part.tile_area, part.n_tiles),
    ):
        segments = mesh_plane(mesh, plane_normal=[0, 0, 1], plane_origin=[0, 0, height])[:, :, :2]
        # both triangles at an edge cut it at one point, up to rounding
        merged = shapely.line_merge(shapely.multilinestrings(list(np.round(segments, 6))))
        rings = [Polygon(ring) for ring in shapely.get_parts(merged)]
        holes = [r for r in rings if any(o is not r and o.contains(r.representative_point()) for o in rings)]
        assert len(rings) - len(holes) == pieces
        assert sum(r.area for r in rings) - 2 * sum(r.area for r in holes) == pytest.approx(area, rel=1e-5)


def test_hinges_as_thick_as_the_tiles_make_a_plate() -> None:
    part = made("kagome", hinge_thickness=THICKNESS)
    assert read_back(part).is_watertight
    assert part.volume == pytest.approx(THICKNESS * (part.tile_area + part.ligament_area), rel=1e-9)
    assert set(part.vertices[:, 2].tolist()) == {0.0, THICKNESS}


def test_the_hinges_are_thin_and_the_gap_narrow_by_default() -> None:
    tessellation = pattern("rectangle")
    part = solid(tessellation, 100 * tessellation.contracted, 3.0)
    assert sorted(set(part.vertices[:, 2].tolist())) == [0.0, 1.0, 3.0]
    assert read_back(part).is_watertight


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"thickness": 0.0}, "--thickness: expected a number above 0"),
        ({"thickness": -1.0}, "--thickness: expected a number above 0"),
        ({"thickness": float("nan")}, "--thickness: expected a number above 0"),
        ({"hinge_thickness": 5.0}, "--hinge-thickness: expected above 0 and at most 3"),
        ({"hinge_thickness": 0.0}, "--hinge-thickness: expected above 0"),
        ({"gap": 4.0}, "--gap: expected from .* to less than the hinge width 4"),
        ({"gap": 1e-9}, "--gap: expected from"),
        ({"hinge_width": 80.0}, "--hinge-width: expected more than 0"),
    ],
)
def test_a_wrong_length_is_refused(options: dict[str, float], message: str) -> None:
    tessellation = pattern("rectangle")
    values = {"thickness": THICKNESS, "hinge_width": WIDTH, **options}
    with pytest.raises(ParameterError, match=message):
        solid(tessellation, 100 * tessellation.contracted, **values)


def test_an_open_surface_is_noticed() -> None:
    tetrahedron = np.array([[0, 2, 1], [0, 1, 3], [1, 2, 3], [0, 3, 2]])
    _check_closed(tetrahedron)
    for wrong in (tetrahedron[1:], np.vstack([tetrahedron[:3], [[0, 2, 3]]]), np.vstack([tetrahedron, tetrahedron])):
        with pytest.raises(UnusableError, match="touch along an edge"):
            _check_closed(wrong)


@pytest.mark.parametrize("name", ["quad", "kagome", "hexagon", "islamic-quad", "islamic-triangle"])
def test_every_tessellation_of_the_catalog_can_be_printed_and_cut(name: str) -> None:
    tessellation = tile_pattern(find_cell(name), np.ones((2, 3), bool))
    lines = cuts(tessellation, 100 * tessellation.contracted)
    assert lines.warnings == () and bool(lines.openings) == (name == "hexagon")
    part = solid(tessellation, 100 * tessellation.contracted, THICKNESS)
    mesh = read_back(part)
    assert mesh.is_watertight and mesh.body_count == 1 and part.n_tiles == tessellation.n_tiles
