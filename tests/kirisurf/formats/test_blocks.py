"""Multiblock files and time series: read by VTK with the same numbers, and whole or not at all on a disk that fails."""

from __future__ import annotations

import errno
import os
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import pyvista

from kirisurf.errors import OutputError, UnusableError
from kirisurf.formats import read_fields, to_polydata, write_vtp
from kirisurf.formats.blocks import pvd_text, vtm_text, write_pvd, write_vtm
from kirisurf.formats.pieces import is_replaceable, pieces_folder, write_with_pieces
from kirisurf.formats.writing import vtp_bytes
from kirisurf.loops import Loops

POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0.1], [0, 1, np.pi], [0.5, 2, 1 / 3]])
LOOPS = Loops.from_lists([[0, 1, 2, 3], [3, 2, 4]])
NAMES = ["plain", "with space", 'it\'s "quoted" & <odd>', "Größe 表面", "tiles%20", "-dash", "a.b"]


def content(shift: float) -> bytes:
    return vtp_bytes(POINTS + shift, LOOPS, {"distance": POINTS[:, 2] + shift}, {"area": [1.0, 2.0]})


def everything(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.parametrize("name", NAMES)
def test_blocks_come_back_with_any_name(tmp_path: Path, name: str) -> None:
    path = tmp_path / f"{name}.vtm"
    write_vtm(path, {key: content(k) for k, key in enumerate(NAMES)})
    data = pyvista.read(path)
    assert data.keys() == NAMES
    for k, block in enumerate(data):
        assert np.array_equal(block.points, POINTS + k)
        assert np.array_equal(block.point_data["distance"], POINTS[:, 2] + k)
        assert block.cell_data["area"].tolist() == [1, 2]
    assert {entry.name for entry in tmp_path.iterdir()} == {path.name, pieces_folder(path).name}


@pytest.mark.parametrize("name", NAMES)
def test_a_series_comes_back_with_its_times(tmp_path: Path, name: str) -> None:
    times = [0.0, 1 / 3, np.nextafter(1, 0), 1e30]
    path = tmp_path / f"{name}.pvd"
    write_pvd(path, times, NAMES[:2], ([content(k), content(-k)] for k in range(4)))
    reader = pyvista.get_reader(path)
    assert reader.time_values == times
    for k, time in enumerate(times):
        reader.set_active_time_value(time)
        first, second = reader.read()
        assert np.array_equal(first.points, POINTS + k)
        assert np.array_equal(second.points, POINTS - k)


def test_the_same_input_gives_the_same_bytes(tmp_path: Path) -> None:
    for name in ("a", "b"):
        (tmp_path / name).mkdir()
        write_vtm(tmp_path / name / "x.vtm", {"tiles": content(1)})
        write_pvd(tmp_path / name / "x.pvd", [0.0], ["tiles"], [[content(1)]])
    assert everything(tmp_path / "a") == everything(tmp_path / "b")


def test_new_pieces_replace_the_old_ones_all_of_them(tmp_path: Path) -> None:
    write_vtm(tmp_path / "x.vtm", {"tiles": content(1), "holes": content(2)})
    write_vtm(tmp_path / "x.vtm", {"target": content(3)})
    assert sorted(everything(tmp_path)) == ["x.vtm", "x_vtm/target.vtp"]


def fail_in(step: str, at: int, monkeypatch: pytest.MonkeyPatch) -> None:
    """Let the disk be full at the `at`-th call."""
    calls, real = [], getattr(os, step)

    def full(*arguments: object) -> object:
        calls.append(arguments)
        if len(calls) == at:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))
        return real(*arguments)

    monkeypatch.setattr(os, step, full)


# of two pieces: fsync and rename of each, the old folder aside, the new one in, fsync and rename of the index
_FAILURES = [("fsync", k, old) for k in (1, 3) for old in (True, False)]
_FAILURES += [("replace", k, True) for k in range(1, 6)] + [("replace", k, False) for k in range(1, 5)]


@pytest.mark.parametrize(("step", "at", "old"), _FAILURES)
def test_a_full_disk_leaves_everything_as_it_was(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, step: str, at: int, old: bool
) -> None:
    path = tmp_path / "x.vtm"
    if old:
        write_vtm(path, {"tiles": content(1), "target": content(2)})
    before = everything(tmp_path)
    fail_in(step, at, monkeypatch)
    with pytest.raises(OutputError, match="No space left") as caught:
        write_vtm(path, {"tiles": content(3), "holes": content(4)})
    monkeypatch.undo()
    assert caught.value.exit_code == 7
    assert everything(tmp_path) == before
    assert {entry.name for entry in tmp_path.iterdir()} == ({"x.vtm", "x_vtm"} if old else set())


def test_a_frame_that_fails_leaves_nothing(tmp_path: Path) -> None:
    def frames() -> Iterator[list[bytes]]:
        yield [content(0)]
        raise UnusableError("no frame")

    with pytest.raises(UnusableError, match="no frame"):
        write_pvd(tmp_path / "x.pvd", [0.0, 1.0], ["tiles"], frames())
    assert list(tmp_path.iterdir()) == []


def test_other_files_are_never_moved(tmp_path: Path) -> None:
    (tmp_path / "x_vtm").mkdir()
    (tmp_path / "x_vtm" / "thesis.tex").write_text("all of it")
    with pytest.raises(OutputError, match="x_vtm: expected a new folder or one of earlier pieces"):
        write_vtm(tmp_path / "x.vtm", {"tiles": content(1)})
    assert everything(tmp_path) == {"x_vtm/thesis.tex": b"all of it"}
    (tmp_path / "y_vtm").write_text("a file")
    (tmp_path / "real").mkdir()
    (tmp_path / "z_vtm").symlink_to(tmp_path / "real")
    assert [is_replaceable(tmp_path / name) for name in ("x_vtm", "y_vtm", "z_vtm", "real", "new")] == [
        *[False] * 3,
        *[True] * 2,
    ]


@pytest.mark.parametrize("place", ["nowhere/x.vtm", "folder.vtm"])
def test_a_place_that_cannot_be_written(tmp_path: Path, place: str) -> None:
    (tmp_path / "folder.vtm").mkdir()
    with pytest.raises(OutputError, match="expected to write this file, got"):
        write_vtm(tmp_path / place, {"tiles": content(1)})
    assert {entry.name for entry in tmp_path.rglob("*")} == {"folder.vtm"}


def test_the_pieces_of_two_kinds_do_not_meet(tmp_path: Path) -> None:
    assert len({pieces_folder(tmp_path / name) for name in ("a.vtm", "a.pvd", "a_vtm", "a")}) == 4
    write_with_pieces(tmp_path / "a.vtm", vtm_text({}), [])
    write_with_pieces(tmp_path / "a.pvd", pvd_text([]), [])
    assert sorted(entry.name for entry in tmp_path.iterdir()) == ["a.pvd", "a.vtm", "a_pvd", "a_vtm"]


def test_what_a_file_says_about_itself_comes_back(tmp_path: Path) -> None:
    about = {"unit": ["1/mm²", "", "Größe"], "origin": np.array([[1e6, -0.0, 1 / 3]]), "share": [0.25]}
    write_vtp(tmp_path / "a.vtp", POINTS, LOOPS, {"distance": POINTS[:, 2]}, None, about)
    for found in (read_fields(tmp_path / "a.vtp").about, pyvista.read(tmp_path / "a.vtp").field_data):
        assert list(found["unit"]) == about["unit"]
        assert np.array_equal(np.ravel(found["origin"]), [1e6, 0.0, 1 / 3])
        assert list(found["share"]) == [0.25]
    made = to_polydata(POINTS, LOOPS, about=about)
    assert list(made.field_data["unit"]) == about["unit"] and made.field_data["origin"].shape == (1, 3)


@pytest.mark.parametrize("entry", [[], ["a", 1], [[["a"]]], np.zeros((1, 1, 1)), [None]])
def test_what_a_file_cannot_say(tmp_path: Path, entry: object) -> None:
    if isinstance(entry, list) and not entry:
        write_vtp(tmp_path / "a.vtp", POINTS, LOOPS, about={"empty": entry})
        return
    with pytest.raises(UnusableError, match="odd: expected texts or rows of numbers"):
        write_vtp(tmp_path / "a.vtp", POINTS, LOOPS, about={"odd": entry})
    assert list(tmp_path.iterdir()) == []


def test_texts_that_are_no_utf8_do_not_stop_a_reader(tmp_path: Path) -> None:
    from vtkmodules.vtkCommonCore import vtkStringArray
    from vtkmodules.vtkIOXML import vtkXMLPolyDataWriter

    column = vtkStringArray()
    column.SetName("latin")
    column.InsertNextValue(b"Gr\xf6\xdfe")
    data = to_polydata(POINTS, LOOPS, about={"good": ["ö"]})
    data.GetFieldData().AddArray(column)
    writer = vtkXMLPolyDataWriter()
    writer.SetFileName(str(tmp_path / "a.vtp"))
    writer.SetInputData(data)
    writer.Write()
    found = read_fields(tmp_path / "a.vtp")
    assert found.about["good"] == ["ö"] and np.array_equal(found.polygons.vertices, POINTS)
