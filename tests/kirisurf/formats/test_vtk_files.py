"""VTP and legacy VTK through a child process: doubles survive, damaged and unsafe files are refused."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from kirisurf.errors import UnreadableError, UnusableError
from kirisurf.formats import child, read_fields, read_polygons, read_surface, write_obj, write_vtp
from kirisurf.loops import Loops

POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0.1], [0, 1, np.pi], [0.5, 2, 1 / 3]])
LOOPS = Loops.from_lists([[0, 1, 2, 3], [3, 2, 4]])
LEGACY = (
    "# vtk DataFile Version 3.0\na title\nASCII\nDATASET {kind}\nPOINTS 5 double\n"
    + "\n".join(f"{x!r} {y!r} {z!r}" for x, y, z in POINTS.tolist())
    + "\n{cells}"
)
POLYGONS = "POLYGONS 2 9\n4 0 1 2 3\n3 3 2 4\n"
CELLS = "CELLS 2 9\n4 0 1 2 3\n3 3 2 4\nCELL_TYPES 2\n9\n5\n"


def _legacy(folder: Path, kind: str = "POLYDATA", cells: str = POLYGONS) -> Path:
    path = folder / "a.vtk"
    path.write_text(LEGACY.format(kind=kind, cells=cells))
    return path


@pytest.mark.parametrize(("kind", "cells"), [("POLYDATA", POLYGONS), ("UNSTRUCTURED_GRID", CELLS)])
def test_legacy_files_of_polygons(tmp_path: Path, kind: str, cells: str) -> None:
    surface = read_surface(_legacy(tmp_path, kind, cells))
    assert np.array_equal(surface.vertices, POINTS)
    assert surface.faces.tolist() == [[0, 1, 2], [0, 2, 3], [3, 2, 4]]


def test_vtp_under_an_odd_name_with_fields(tmp_path: Path) -> None:
    path = tmp_path / '-it\'s a "größe" 表.vtp'
    fields = {"height": POINTS[:, 2], "flag": np.array([0, 1, 0, 1, 1], dtype=bool)}
    write_vtp(path, POINTS, LOOPS, fields, {"normal": np.eye(3)[:2]})
    vertices, loops = read_polygons(path)
    assert np.array_equal(vertices, POINTS)
    assert np.array_equal(loops.indices, LOOPS.indices) and np.array_equal(loops.offsets, LOOPS.offsets)
    found = read_fields(path)
    assert np.array_equal(found.point_fields["height"], POINTS[:, 2])
    assert found.point_fields["flag"].tolist() == [0, 1, 0, 1, 1]
    assert np.array_equal(found.cell_fields["normal"], np.eye(3)[:2])
    write_obj(tmp_path / "a.obj", POINTS, LOOPS)
    with pytest.raises(UnreadableError, match="expected VTP or VTK"):
        read_fields(tmp_path / "a.obj")


@pytest.mark.parametrize(
    ("kind", "cells", "error", "message"),
    [
        ("POLYDATA", POLYGONS.replace("2 4", "2 9"), UnreadableError, "got vertex 9"),
        ("POLYDATA", "POLYGONS 2 900\n4 0 1 2 3\n", UnreadableError, "900 numbers after POLYGONS"),
        ("POLYDATA", "", UnusableError, "without any face"),
        ("POLYDATA", "TRIANGLE_STRIPS 1 5\n4 0 1 2 3\n", UnusableError, "triangle strips"),
        ("UNSTRUCTURED_GRID", "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n", UnusableError, "PolyData"),
    ],
)
def test_damaged_and_other_legacy_files(tmp_path: Path, kind: str, cells: str, error: type, message: str) -> None:
    with pytest.raises(error, match=message):
        read_surface(_legacy(tmp_path, kind, cells))


def test_announced_sizes_are_checked_before_vtk_sees_them(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(child, "run", lambda *_: pytest.fail("the child process was started"))
    path = _legacy(tmp_path)
    path.write_text(path.read_text().replace("POINTS 5", "POINTS 99999999999"))
    with pytest.raises(UnreadableError, match="cut off"):
        read_surface(path)
    entities = '<?xml version="1.0"?><!DOCTYPE r [<!ENTITY x SYSTEM "file:///etc/passwd">]><VTKFile type="PolyData"/>'
    (tmp_path / "a.vtp").write_text(entities)
    with pytest.raises(UnreadableError, match="unsafe"):
        read_surface(tmp_path / "a.vtp")


def test_a_file_that_ends_the_library_ends_the_child_only(tmp_path: Path) -> None:
    write_vtp(tmp_path / "a.vtp", POINTS, LOOPS)
    bomb = (tmp_path / "a.vtp").read_bytes().replace(b'NumberOfPoints="5"', b'NumberOfPoints="1000000000000"')
    (tmp_path / "a.vtp").write_bytes(bomb)
    with pytest.raises(UnreadableError, match="damaged"):
        read_surface(tmp_path / "a.vtp")


def test_a_cut_vtp(tmp_path: Path) -> None:
    write_vtp(tmp_path / "a.vtp", POINTS, LOOPS)
    content = (tmp_path / "a.vtp").read_bytes()
    (tmp_path / "a.vtp").write_bytes(content[: len(content) * 2 // 3])
    with pytest.raises(UnreadableError, match="damaged"):
        read_surface(tmp_path / "a.vtp")


def test_a_child_that_hangs_is_killed_on_time(tmp_path: Path) -> None:
    script = tmp_path / "sleep.py"
    script.write_text("import time; time.sleep(60)")
    assert "no answer within 0.3 s" in child.run(script, [], 0.3, 100).death


def test_a_child_that_dies_is_told_from_one_that_answers(tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text("import os, signal; os.kill(os.getpid(), signal.SIGSEGV)")
    assert child.run(script, [], 60, 100).death == "death by SIGSEGV"
    script.write_text("import sys; print('noise'); print('{\"memory\": %s}' % sys.argv[1])")
    ended = child.run(script, [], 60, 100)
    assert ended.answer == {"memory": 100} and not ended.death
    script.write_text("raise RuntimeError('the reason')")
    ended = child.run(script, [], 60, 100)
    assert ended.answer == {} and "the reason" in ended.complaint
