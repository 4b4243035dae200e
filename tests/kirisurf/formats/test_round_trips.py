"""Written and read again, every double and every index is the same, through files and through pyvista."""

from __future__ import annotations

import os
from pathlib import Path

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra import numpy as arrays

from kirisurf.errors import OutputError, UnusableError
from kirisurf.formats import (
    read_polygons,
    read_surface,
    surface_from_polydata,
    to_polydata,
    write_obj,
    write_vtp,
)
from kirisurf.formats.source import load
from kirisurf.formats.vtk_files import read_with_fields
from kirisurf.formats.writing import vtp_bytes
from kirisurf.loops import Loops
from kirisurf.surface import Surface

POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0.1], [0, 1, np.pi], [0.5, 2, 1 / 3]])
LOOPS = Loops.from_lists([[0, 1, 2, 3], [3, 2, 4]])
WRITERS = {"obj": lambda path, points, loops: write_obj(path, points, loops), "vtp": write_vtp}


@given(arrays.arrays(np.float64, (5, 3), elements=st.floats(allow_nan=False, allow_infinity=False)))
@settings(
    max_examples=60, deadline=None, suppress_health_check=[HealthCheck.function_scoped_fixture, HealthCheck.too_slow]
)
def test_obj_keeps_every_double(tmp_path: Path, points: np.ndarray) -> None:
    write_obj(tmp_path / "a.obj", points, LOOPS, ["a comment", "two\nlines"])
    vertices, loops = read_polygons(tmp_path / "a.obj")
    assert vertices.tobytes() == points.tobytes()
    assert np.array_equal(loops.offsets, LOOPS.offsets) and np.array_equal(loops.indices, LOOPS.indices)


def test_comments_are_lines_of_their_own(tmp_path: Path) -> None:
    write_obj(tmp_path / "a.obj", POINTS[:, :2], LOOPS, ["origin 1e6 0 0\nf 1 2 3"])
    lines = (tmp_path / "a.obj").read_text().splitlines()
    assert lines[:3] == ["# origin 1e6 0 0", "# f 1 2 3", "v 0.0 0.0 0.0"]
    assert lines[-1] == "f 4 3 5"


def test_vtp_keeps_every_double_and_is_the_same_every_time(tmp_path: Path) -> None:
    points = np.array(
        [[5e-324, -0.0, 1e-300], [1.7e150, 0, 0], [np.nextafter(1, 2), 1 / 3, -np.pi], [0, 0, 1], [0, 2, 0]]
    )
    write_vtp(tmp_path / "a.vtp", points, LOOPS)
    assert read_polygons(tmp_path / "a.vtp")[0].tobytes() == points.tobytes()
    assert vtp_bytes(points, LOOPS, {"a": POINTS[:, 0]}) == vtp_bytes(points, LOOPS, {"a": POINTS[:, 0]})


@pytest.mark.parametrize("fill", [np.nan, np.inf, 1e200])
@pytest.mark.parametrize("shape", [(5,), (5, 3)])
def test_fields_that_are_not_finite_come_back(tmp_path: Path, fill: float, shape: tuple[int, ...]) -> None:
    values = np.full(shape, fill)
    write_vtp(tmp_path / "a.vtp", POINTS, LOOPS, {"curvature": values})
    found = read_with_fields(load(tmp_path / "a.vtp")).point_fields["curvature"]
    assert np.array_equal(found, values, equal_nan=True)


def test_pyvista_reads_what_is_written(tmp_path: Path) -> None:
    import pyvista

    write_vtp(tmp_path / "a.vtp", POINTS, LOOPS, {"distance": POINTS[:, 2]}, {"area": [1.0, 2.0]})
    data = pyvista.read(tmp_path / "a.vtp")
    assert data.points.dtype == np.float64 and np.array_equal(data.points, POINTS)
    assert np.array_equal(data.point_data["distance"], POINTS[:, 2])
    assert data.cell_data["area"].tolist() == [1, 2]


def test_polydata_there_and_back() -> None:
    data = to_polydata(POINTS, LOOPS, {"distance": POINTS[:, 2]}, {"flag": [True, False]})
    assert np.array_equal(data.points, POINTS) and data.n_cells == 2
    assert data.cell_data["flag"].tolist() == [1, 0]
    surface = surface_from_polydata(data, "sheet")
    assert surface.name == "sheet" and np.array_equal(surface.vertices, POINTS)
    assert surface.faces.tolist() == [[0, 1, 2], [0, 2, 3], [3, 2, 4]]
    assert np.array_equal(surface_from_polydata(data.cast_to_unstructured_grid()).faces, surface.faces)


def test_what_is_no_polydata() -> None:
    import pyvista

    for other in (pyvista.PolyData(POINTS), pyvista.PolyData(), 3, pyvista.ImageData(dimensions=(2, 1, 1))):
        with pytest.raises(UnusableError):
            surface_from_polydata(other)
    wrong = pyvista.PolyData(POINTS, faces=[3, 0, 1, 99])
    with pytest.raises(UnusableError, match="got 99"):
        surface_from_polydata(wrong)


@pytest.mark.parametrize("kind", WRITERS)
def test_wrong_arrays_are_refused_before_a_file_exists(tmp_path: Path, kind: str) -> None:
    for points, loops in (
        (POINTS[:3], LOOPS),
        (np.full((5, 3), np.nan), LOOPS),
        (POINTS.ravel(), LOOPS),
        (POINTS, Loops.from_lists([[0, 1, -1]])),
    ):
        with pytest.raises(UnusableError):
            WRITERS[kind](tmp_path / f"a.{kind}", points, loops)
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize(
    ("point_fields", "cell_fields"),
    [({"a": [1.0]}, {}), ({}, {"a": np.zeros(5)}), ({"a": ["x"] * 5}, {}), ({"a": np.zeros((5, 3, 3))}, {})],
)
def test_fields_that_do_not_fit(tmp_path: Path, point_fields: dict, cell_fields: dict) -> None:
    with pytest.raises(UnusableError, match="field a: expected numbers"):
        write_vtp(tmp_path / "a.vtp", POINTS, LOOPS, point_fields, cell_fields)


@pytest.mark.parametrize("kind", WRITERS)
def test_a_folder_that_is_not_there(tmp_path: Path, kind: str) -> None:
    with pytest.raises(OutputError, match="nowhere"):
        WRITERS[kind](tmp_path / "nowhere" / f"a.{kind}", POINTS, LOOPS)


@pytest.mark.parametrize("suffix", ["stl", "obj", "ply", "off", "glb"])
def test_every_format_that_trimesh_writes_gives_the_same_surface(tmp_path: Path, suffix: str) -> None:
    import trimesh

    cap = trimesh.creation.icosphere(2)
    faces = cap.faces[cap.triangles_center[:, 2] > 0.2]
    used = np.unique(faces)
    points = np.float32(cap.vertices[used]).astype(float)
    mesh = trimesh.Trimesh(points, np.searchsorted(used, faces), process=False)
    content = mesh.export(file_type=suffix)
    (tmp_path / f"a.{suffix}").write_bytes(content if isinstance(content, bytes) else content.encode())
    surface = read_surface(tmp_path / f"a.{suffix}")
    tolerance = 1e-7  # trimesh writes OBJ and OFF with eight digits
    expected = Surface.from_arrays(points, mesh.faces)
    assert len(surface.vertices) == len(points) and len(surface.faces) == len(faces)
    assert surface.area == pytest.approx(expected.area, rel=tolerance)
    assert np.allclose(surface.vertices[surface.faces], points[mesh.faces], atol=tolerance)


@pytest.mark.parametrize("suffix", ["vtp", "vtk", "ply", "stl", "obj"])
def test_every_format_that_pyvista_writes_gives_the_same_surface(tmp_path: Path, suffix: str) -> None:
    import pyvista

    data = pyvista.Sphere(theta_resolution=12, phi_resolution=9, end_phi=80)
    data.save(tmp_path / f"a.{suffix}")
    surface = read_surface(tmp_path / f"a.{suffix}")
    expected = surface_from_polydata(data)
    assert len(surface.faces) == len(expected.faces)
    assert surface.area == pytest.approx(expected.area, rel=1e-6)
    assert len(surface.boundary_loops) == 1
