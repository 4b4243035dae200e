"""Reading OBJ, OFF and ascii STL: what is right is read exactly, what is damaged is refused with its class."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from kirisurf.errors import UnreadableError, UnusableError
from kirisurf.formats import read_polygons, read_surface, read_surface_with_notes

SQUARE = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"
FACET = "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1 0 0\n  vertex 0 1 0\n endloop\nendfacet\n"


def _file(folder: Path, name: str, content: str | bytes) -> Path:
    path = folder / name
    path.write_bytes(content.encode() if isinstance(content, str) else content)
    return path


@pytest.mark.parametrize(
    "faces",
    [
        "f 1 2 3 4",
        "f 1/1 2/2 3/3 4/4",
        "f 1//7 2//7 3//7 4//7",
        "f 1/1/7 2/2/7 3/3/7 4/4/7",
        "f -4 -3 -2 -1",
        "f 1 2 \\\n 3 4",
        "f 1 2 3 4 # a comment",
        "g \xff\nusemtl x\ns off\nf 1 2 3 4",
    ],
)
def test_obj_faces_in_every_spelling(tmp_path: Path, faces: str) -> None:
    path = _file(tmp_path, "a.obj", (SQUARE + faces).encode("latin-1"))
    vertices, loops = read_polygons(path)
    assert vertices.tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    assert loops[0].tolist() == [0, 1, 2, 3]


def test_obj_negative_indices_count_from_the_vertices_so_far(tmp_path: Path) -> None:
    path = _file(tmp_path, "a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf -3 -2 -1\nv 0 0 1\nf -4 -1 -3\n")
    assert [loop.tolist() for loop in read_polygons(path)[1]] == [[0, 1, 2], [0, 3, 1]]


@pytest.mark.parametrize("encoding", ["utf-8-sig", "utf-16"])
def test_obj_with_a_byte_order_mark(tmp_path: Path, encoding: str) -> None:
    path = _file(tmp_path, "a.obj", ("# größe\n" + SQUARE + "f 1 2 3\n").encode(encoding))
    assert len(read_polygons(path)[0]) == 4


def test_obj_colors_are_passed_over_even_if_not_numbers(tmp_path: Path) -> None:
    path = _file(tmp_path, "a.obj", SQUARE.replace("v 1 0 0", "v 1 0 0 nan nan nan") + "f 1 2 3\n")
    assert len(read_surface(path).vertices) == 3


def test_obj_planar_vertices_get_no_height(tmp_path: Path) -> None:
    vertices, _ = read_polygons(_file(tmp_path, "a.obj", "v 0 0\nv 2.5 0\nv 0 1\nf 1 2 3\n"))
    assert vertices.tolist() == [[0, 0, 0], [2.5, 0, 0], [0, 1, 0]]


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (SQUARE + "f 0 1 2\n", "got 0"),
        (SQUARE + "f 1 2 9\n", "got vertex 8"),
        (SQUARE + "f -5 1 2\n", "got -5"),
        (SQUARE + "f 1 2 x\n", "got 'x'"),
        (SQUARE + "f 1 2 3.5\n", r"got '3\.5'"),
        (SQUARE + "f 1 2 99999999999999999999999\n", "whole numbers"),
        (SQUARE + "f 1 1_0 3\n", "1_0"),
        ("v 0,5 0 0\n" + SQUARE + "f 1 2 3\n", "decimal comma"),
        ("v 0\n" + SQUARE + "f 1 2 3\n", "expected 3 coordinates"),
        (SQUARE + "f 1 2 3\0\n", "binary content"),
    ],
)
def test_damaged_obj_is_unreadable(tmp_path: Path, content: str, message: str) -> None:
    with pytest.raises(UnreadableError, match=message):
        read_surface(_file(tmp_path, "a.obj", content))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (SQUARE, "4 vertices without any face"),
        (SQUARE + "f 1 2\n", "without any face"),
        (SQUARE + "f 1 1 1\n", "in one place"),
        ("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n", "faces with an area"),
        (SQUARE.replace("v 1 0 0", "v nan 0 0") + "f 1 2 3\n", "finite"),
        (SQUARE.replace("v 1 0 0", "v 1e400 0 0") + "f 1 2 3\n", "finite"),
        (SQUARE.replace("v 1 0 0", "v 1.#IND 0 0") + "f 1 2 3\n", "finite"),
        (SQUARE.replace("v 1 0 0", "v 1e300 0 0") + "f 1 2 3\n", "overflow"),
        ("v 0 0 0\nv 1e-200 0 0\nv 0 1e-200 0\nf 1 2 3\n", "underflow"),
        ("v 1e15 0 0\nv 1e15 1 0\nv 1e15 0 1\nf 1 2 3\n", "too few digits"),
        ("", "empty"),
        (" \n\n", "empty"),
    ],
)
def test_obj_without_a_usable_surface(tmp_path: Path, content: str, message: str) -> None:
    with pytest.raises(UnusableError, match=message):
        read_surface(_file(tmp_path, "a.obj", content))


def test_obj_never_opens_what_it_names(tmp_path: Path) -> None:
    pipe = tmp_path / "m.mtl"  # opening it for reading would wait for ever
    import os

    if not hasattr(os, "mkfifo"):
        pytest.skip("the library reference test did not run: no named pipes here")
    os.mkfifo(pipe)
    assert len(read_surface(_file(tmp_path, "a.obj", "mtllib m.mtl\n" + SQUARE + "f 1 2 3 4\n")).faces) == 2


def test_what_is_left_out_is_said(tmp_path: Path) -> None:
    path = _file(tmp_path, "a.obj", SQUARE + "v nan nan nan\nl 1 2\nf 1 2 3\nf 1 3 4\nf 2 3 1\nf 1 2\nf 1 1 2\n")
    surface, notes = read_surface_with_notes(path)
    assert len(surface.vertices) == 4 and len(surface.faces) == 2
    assert notes == (
        "1 line, point or curve left out.",
        "1 face with fewer than three corners left out.",
        "1 vertex in no face left out.",
        "1 face without area removed.",
        "1 copy of faces removed.",
    )


@pytest.mark.parametrize(
    "content",
    [
        "OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n3 0 2 3\n",
        "OFF 4 2 0\r\n0 0 0\r\n1 0 0\r\n1 1 0\r\n0 1 0\r\n3 0 1 2\r\n3 0 2 3\r\n",
        "  OFF4 1 5 # or nah\n\n0 0 0\n1 0 0\n# between\n1 1 0\n0 1 0\n4 0 1 2 3 1.0 0.5 0 1\n",
        "COFF\n4 1 0\n0 0 0 255 0 0 255\n1 0 0 0 0 0 9\n1 1 0 1 1 1 1\n0 1 0 1 1 1 1\n4 0 1 2 3\n",
        "STCNOFF\n4 1 0\n0 0 0 0 0 1 1 1 1 1 0 0\n1 0 0 0 0 1 1 1 1 1 0 0\n1 1 0 0 0 1\n0 1 0 0 0 1\n4 0 1 2 3\n",
        "4 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n",
    ],
)
def test_off_in_every_spelling(tmp_path: Path, content: str) -> None:
    surface = read_surface(_file(tmp_path, "a.off", content))
    assert surface.vertices.tolist() == [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
    assert surface.faces.tolist() == [[0, 1, 2], [0, 2, 3]]


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("colored", [True, False])
def test_binary_off(tmp_path: Path, order: str, colored: bool) -> None:
    points = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0.5], [0, 1, 0], [0.5, 2, 0]], order + "f4")
    loops = [[0, 1, 2, 3], [3, 2, 4]]
    content = b"OFF BINARY\n" + np.array([5, 2, 0], order + "i4").tobytes() + points.tobytes()
    for loop in loops:
        content += np.array([len(loop), *loop], order + "i4").tobytes()
        if colored:
            content += np.array([3], order + "i4").tobytes() + np.array([1, 0, 0], order + "f4").tobytes()
    surface = read_surface(_file(tmp_path, "a.off", content))
    assert np.array_equal(surface.vertices, points.astype(np.float64))
    assert surface.faces.tolist() == [[0, 1, 2], [0, 2, 3], [3, 2, 4]]
    with pytest.raises(UnreadableError, match="as many bytes"):
        read_surface(_file(tmp_path, "b.off", content[:-4]))


@pytest.mark.parametrize(
    ("content", "message"),
    [
        ("OFF\n4 2 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n", "got 5 lines"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n3 0 1 2\n", "got 5 lines"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 3\n", "got vertex 3"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 -1\n", "got vertex -1"),
        ("OFF\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n4 0 1 2\n", "got fewer"),
        ("OFF\n3 1 0\n0 0 0\n1 0\n1 1 0\n3 0 1 2\n", "3 coordinates"),
        ("OFF\n-3 1 0\n", "counts"),
        ("OFF\nx\n", "whole numbers"),
        ("OFF\n", "counts"),
        ("4OFF\n3 1 0\n0 0 0 1\n1 0 0 1\n1 1 0 1\n3 0 1 2\n", "three dimensions"),
        ("nOFF\n3\n3 1 0\n0 0 0\n1 0 0\n1 1 0\n3 0 1 2\n", "three dimensions"),
        ("OFF\n99999999999999 1 0\n0 0 0\n", "lines"),
    ],
)
def test_damaged_off_is_unreadable(tmp_path: Path, content: str, message: str) -> None:
    with pytest.raises(UnreadableError, match=message):
        read_surface(_file(tmp_path, "a.off", content))


def test_ascii_stl_keeps_double_precision_and_merges_corners(tmp_path: Path) -> None:
    second = FACET.replace("0 0 0", "1 0 0").replace(
        "vertex 1 0 0\n  vertex 0", "vertex 1 1.1000000000000001 0\n  vertex 0"
    )
    surface = read_surface(
        _file(tmp_path, "a.stl", f"solid x\n{FACET}{second}endsolid x\nsolid empty\nendsolid empty\n")
    )
    assert len(surface.vertices) == 4 and len(surface.faces) == 2
    assert 1.1 in surface.vertices


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (f"solid x\n{FACET}", "cut off"),
        (f"solid x\n{FACET}{FACET[:60]}", "cut off"),
        (f"solid x\n{FACET.replace('  vertex 0 1 0', '')}endsolid", "expected 3 vertices per facet, got 2"),
        (f"solid x\n{FACET.replace('vertex 0 1 0', 'vertex 0 1')}endsolid", "expected vertex x y z"),
        (f"solid x\n{FACET.replace('0 1 0', '0 0,5 0')}endsolid", "decimal comma"),
        ("hello", "no such thing"),
        (b"\0" * 80 + (7).to_bytes(4, "little") + b"\1" * 50, "expected 434 bytes for the 7 triangles"),
        (b"\1" * 80 + b"\xff\xff\xff\xff" + b"\1" * 200, "expected 214748364834 bytes"),
    ],
)
def test_damaged_stl_is_unreadable(tmp_path: Path, content: str | bytes, message: str) -> None:
    with pytest.raises(UnreadableError, match=message):
        read_surface(_file(tmp_path, "a.stl", content))


def test_stl_without_triangles(tmp_path: Path) -> None:
    with pytest.raises(UnusableError, match="with none"):
        read_surface(_file(tmp_path, "a.stl", b"x" * 80 + b"\0\0\0\0"))
    with pytest.raises(UnusableError, match="with none"):
        read_surface(_file(tmp_path, "b.stl", "solid x\nendsolid x\n"))


def test_binary_stl_whose_header_says_solid(tmp_path: Path) -> None:
    facet = np.zeros(1, np.dtype([("n", "<f4", 3), ("p", "<f4", (3, 3)), ("a", "<u2")]))
    facet["p"] = [[0, 0, 0], [0.1, 0, 0], [0, 1, 0]]
    path = _file(tmp_path, "a.STL", b"solid by someone".ljust(80) + (1).to_bytes(4, "little") + facet.tobytes())
    assert read_surface(path).vertices[1, 0] == np.float64(np.float32(0.1))
