"""Reading PLY in its three encodings: equal to trimesh where that is right, refused where the file lies."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from kirisurf.errors import UnreadableError, UnusableError
from kirisurf.formats import read_surface

POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0.1], [0, 1, np.pi], [0.5, 2, 1 / 3]])
LOOPS = [[0, 1, 2, 3], [3, 2, 4]]
ENCODINGS = {"ascii": "", "binary_little_endian": "<", "binary_big_endian": ">"}


def _ply(encoding: str, loops: list[list[int]] = LOOPS, vertices: int = 5, faces: int | None = None) -> bytes:
    faces = len(loops) if faces is None else faces
    header = (
        f"ply\nformat {encoding} 1.0\ncomment made in a test\nelement vertex {vertices}\nproperty double x\n"
        "property uchar red\nproperty double y\nproperty double z\n"
        f"element face {faces}\nproperty float quality\nproperty list uchar int vertex_indices\n"
        "property list uchar float texcoord\nelement edge 1\nproperty int vertex1\nend_header\n"
    ).encode()
    order = ENCODINGS[encoding]
    if not order:
        rows = [f"{x!r} 255 {y!r} {z!r}" for x, y, z in POINTS.tolist()]
        rows += [f"0.5 {len(loop)} {' '.join(map(str, loop))} 2 0.5 0.5" for loop in loops]
        return header + ("\n".join([*rows, "3"]) + "\n").encode()
    body = b""
    for x, y, z in POINTS:
        body += np.array([x], order + "f8").tobytes() + b"\xff" + np.array([y, z], order + "f8").tobytes()
    for loop in loops:
        body += np.array([0.5], order + "f4").tobytes() + bytes([len(loop)]) + np.array(loop, order + "i4").tobytes()
        body += b"\2" + np.array([0.5, 0.5], order + "f4").tobytes()
    return header + body + np.array([3], order + "i4").tobytes()


def _read(folder: Path, content: bytes):
    path = folder / "a.ply"
    path.write_bytes(content)
    return read_surface(path)


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize("loops", [LOOPS, [[0, 1, 2], [0, 2, 3], [3, 2, 4]]], ids=["ragged", "triangles"])
def test_doubles_and_polygons_survive(tmp_path: Path, encoding: str, loops: list[list[int]]) -> None:
    surface = _read(tmp_path, _ply(encoding, loops))
    assert np.array_equal(surface.vertices, POINTS)
    assert surface.faces.tolist() == [[0, 1, 2], [0, 2, 3], [3, 2, 4]]


def test_single_precision_is_widened_exactly(tmp_path: Path) -> None:
    content = _ply("binary_little_endian").replace(b"property double", b"property float ")
    narrow = POINTS.astype("<f4")
    body = b"".join(p[:1].tobytes() + b"\xff" + p[1:].tobytes() for p in narrow)
    start, end = content.index(b"end_header\n") + 11, len(content) - 4 - 2 * (4 + 1 + 1 + 8) - 7 * 4
    surface = _read(tmp_path, content[:start] + body + content[end:])
    assert np.array_equal(surface.vertices, narrow.astype(np.float64))


@pytest.mark.parametrize("encoding", ENCODINGS)
@pytest.mark.parametrize(
    ("change", "message"),
    [
        ({"vertices": 4_000_000_000}, "rows of 'vertex' as announced"),
        ({"vertices": 10**18}, "rows of 'vertex' as announced"),
        ({"faces": 3}, "it is damaged"),
        ({"faces": 1}, "damaged"),
        ({"vertices": 4}, "damaged"),
        ({"loops": [[0, 1, 2, 3], [3, 2, 5]]}, "got vertex 5"),
        ({"loops": [[0, 1, 2, 3], [3, 2, -7]]}, "got vertex -7"),
    ],
    ids=str,
)
def test_lying_counts_and_indices(tmp_path: Path, encoding: str, change: dict, message: str) -> None:
    with pytest.raises(UnreadableError, match=message):
        _read(tmp_path, _ply(encoding, **change))


@pytest.mark.parametrize("encoding", ENCODINGS)
def test_every_truncation_is_refused(tmp_path: Path, encoding: str) -> None:
    content = _ply(encoding)
    for length in range(4, len(content) - 2, 7):
        with pytest.raises(UnreadableError):
            _read(tmp_path, content[:length])


@pytest.mark.parametrize(
    ("old", "new", "message"),
    [
        (b"end_header", b"", "never ends"),
        (b"element vertex 5", b"element vertex -5", "header line"),
        (b"property double x", b"property triple x", "header line"),
        (b"format ascii 1.0\n", b"", "format line"),
        (b"property double y\n", b"", "damaged"),
        (b"format ascii", b"format binary_little_endian", "damaged"),
        (b"list uchar int vertex_indices", b"list uchar float vertex_indices", "whole numbers"),
        (b"list uchar int", b"list float int", "header line"),
    ],
)
def test_damaged_headers(tmp_path: Path, old: bytes, new: bytes, message: str) -> None:
    with pytest.raises(UnreadableError, match=message):
        _read(tmp_path, _ply("ascii").replace(old, new))


def test_points_without_faces_and_numbers_that_are_none(tmp_path: Path) -> None:
    head, _, _ = _ply("ascii").partition(b"element face")
    with pytest.raises(UnusableError, match="5 points and none"):
        _read(tmp_path, head + b"end_header\n" + b"0 0 0 0\n" * 5)
    with pytest.raises(UnusableError, match="finite"):
        _read(tmp_path, _ply("ascii").replace(repr(float(np.pi)).encode(), b"nan"))


@pytest.mark.parametrize("encoding", ["ascii", "binary"])
def test_agrees_with_trimesh(tmp_path: Path, encoding: str) -> None:
    import trimesh

    sphere = trimesh.creation.icosphere(2)
    content = sphere.export(file_type="ply", encoding=encoding)
    surface = _read(tmp_path, content if isinstance(content, bytes) else content.encode())
    assert np.allclose(surface.vertices, sphere.vertices, atol=1e-6)
    assert np.array_equal(surface.faces, sphere.faces)
