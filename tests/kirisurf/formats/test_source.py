"""What a file is, is decided by its suffix and its content together; nothing but a plain file is opened."""

from __future__ import annotations

import os
import tracemalloc
from pathlib import Path

import pytest

from kirisurf.errors import UnreadableError, UnusableError
from kirisurf.formats import read_polygons, read_surface
from kirisurf.formats.source import load

OBJ = "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"
OFF = "OFF\n3 1 0\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n"
STL = "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid\n"


@pytest.mark.parametrize("name", ["a b.obj", "-o.obj", 'it\'s "q".obj', "größe 表面.obj", "A.OBJ", "a.b.obj"])
def test_any_name(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str) -> None:
    (tmp_path / name).write_text(OBJ)
    assert read_surface(tmp_path / name).name == name
    monkeypatch.chdir(tmp_path)
    assert len(read_surface(name).faces) == 1


@pytest.mark.parametrize(("content", "kind"), [(OFF, "off"), (STL, "stl"), (OBJ, "obj"), ("# x\n" + OBJ, "obj")])
def test_without_a_suffix_the_content_decides(tmp_path: Path, content: str, kind: str) -> None:
    (tmp_path / "surface").write_text(content)
    assert load(tmp_path / "surface").format == kind
    assert len(read_surface(tmp_path / "surface").faces) == 1


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.off", b"ply\nformat ascii 1.0\nend_header\n", "OFF content as the suffix says, got PLY"),
        ("a.obj", b"OFF\n0 0 0\n", "got OFF"),
        ("a.stl", b"\x89PNG\r\n\x1a\n" + b"\0" * 100, "a PNG picture"),
        ("a.3mf", b"PK\x03\x04" + b"\0" * 100, "a ZIP archive"),
        ("a.npy", b"\x93NUMPY\x01\x00", "a NumPy array"),
        ("a.vtm", b'<?xml version="1.0"?><VTKFile type="vtkMultiBlockDataSet"/>', "no VTK PolyData"),
        ("a.step", b"ISO-10303-21;", "called .step"),
        ("noise", b"what is this", "unknown content"),
        ("a.ply", b"version https://git-lfs.github.com/spec/v1\noid sha256:0\n", "git lfs pull"),
        ("a.obj", b"\xff\xfe" + b"\xd8\x00\xd8", "UTF-16"),
        ("a.glb", b"\0" * 12, "12 zero bytes"),
    ],
)
def test_what_is_something_else(tmp_path: Path, name: str, content: bytes, message: str) -> None:
    (tmp_path / name).write_bytes(content)
    with pytest.raises(UnreadableError, match=message):
        read_surface(tmp_path / name)


def test_missing_folder_device_and_size(tmp_path: Path) -> None:
    with pytest.raises(UnreadableError, match="No such file"):
        read_surface(tmp_path / "no.obj")
    with pytest.raises(UnreadableError, match="folder"):
        read_surface(tmp_path)
    with pytest.raises(UnreadableError, match="null"):
        read_surface("a\0b.obj")
    (tmp_path / "empty.obj").touch()
    with pytest.raises(UnusableError, match="empty file"):
        read_surface(tmp_path / "empty.obj")
    (tmp_path / "big.obj").write_text(OBJ + "#" * 3000)
    with pytest.raises(UnreadableError, match=r"at most 0\.002 MB"):
        read_surface(tmp_path / "big.obj", limit_mb=0.002)
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "pipe.obj")
        with pytest.raises(UnreadableError, match="a device or pipe"):
            read_surface(tmp_path / "pipe.obj")
    if Path("/dev/zero").exists():
        (tmp_path / "zero.obj").symlink_to("/dev/zero")
        with pytest.raises(UnreadableError, match="a device or pipe"):
            read_surface(tmp_path / "zero.obj")


def test_polygons_come_from_obj_and_vtp_only(tmp_path: Path) -> None:
    (tmp_path / "a.stl").write_text(STL)
    with pytest.raises(UnreadableError, match="expected OBJ or VTP"):
        read_polygons(tmp_path / "a.stl")
    (tmp_path / "a.obj").write_text("v 0 0 0\nv 1 0 0\nf 1 2\n")
    with pytest.raises(UnusableError, match="three corners or more"):
        read_polygons(tmp_path / "a.obj")
    (tmp_path / "a.obj").write_text(OBJ + "v nan 0 0\n")
    with pytest.raises(UnusableError, match="for vertex 3"):
        read_polygons(tmp_path / "a.obj")
    (tmp_path / "a.obj").write_text("v 0 0 0\n")
    with pytest.raises(UnusableError, match="without any"):
        read_polygons(tmp_path / "a.obj")


def test_a_small_file_takes_little_memory(tmp_path: Path) -> None:
    (tmp_path / "a.obj").write_text(OBJ)
    tracemalloc.start()
    try:
        assert load(tmp_path / "a.obj").content == OBJ.encode()
        assert tracemalloc.get_traced_memory()[1] < 10**6
    finally:
        tracemalloc.stop()
