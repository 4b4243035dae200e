"""Reading glTF: transformed and merged as trimesh reads it; nothing outside the file, nothing out of bounds."""

from __future__ import annotations

import base64
import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from kirisurf.errors import UnreadableError, UnusableError
from kirisurf.formats import read_surface, read_surface_with_notes

POINTS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0.25]], "<f4")
FACES = np.array([[0, 1, 2], [0, 2, 3]], "<u2")


def _document(indices: np.ndarray = FACES, points: np.ndarray = POINTS, **changes: Any) -> dict[str, Any]:
    data = points.tobytes() + indices.tobytes()
    document: dict[str, Any] = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3"},
            {"bufferView": 1, "componentType": 5123, "count": indices.size, "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": points.nbytes},
            {"buffer": 0, "byteOffset": points.nbytes, "byteLength": indices.nbytes},
        ],
        "buffers": [
            {
                "byteLength": len(data),
                "uri": "data:application/octet-stream;base64," + base64.b64encode(data).decode(),
            }
        ],
    }
    return document | changes


def _read(folder: Path, document: object):
    path = folder / "a.gltf"
    path.write_text(document if isinstance(document, str) else json.dumps(document))
    return read_surface(path)


def _glb(document: dict[str, Any]) -> bytes:
    data = base64.b64decode(document["buffers"][0].pop("uri").partition(",")[2])
    text = json.dumps(document).encode()
    text, data = text + b" " * (-len(text) % 4), data + b"\0" * (-len(data) % 4)
    body = len(text).to_bytes(4, "little") + b"JSON" + text + len(data).to_bytes(4, "little") + b"BIN\0" + data
    return b"glTF" + (2).to_bytes(4, "little") + (12 + len(body)).to_bytes(4, "little") + body


def test_embedded_and_binary_are_the_same(tmp_path: Path) -> None:
    surface = _read(tmp_path, _document())
    assert np.array_equal(surface.vertices, POINTS)
    assert np.array_equal(surface.faces, FACES)
    (tmp_path / "a.glb").write_bytes(_glb(_document()))
    assert np.array_equal(read_surface(tmp_path / "a.glb").vertices, POINTS)


def test_every_truncation_of_a_glb_is_refused(tmp_path: Path) -> None:
    content = _glb(_document())
    for length in range(5, len(content), 13):
        (tmp_path / "a.glb").write_bytes(content[:length])
        with pytest.raises(UnreadableError):
            read_surface(tmp_path / "a.glb")


def test_transformations_agree_with_trimesh(tmp_path: Path) -> None:
    import trimesh

    scene = trimesh.Scene()
    box = trimesh.creation.box()
    turned = trimesh.transformations.rotation_matrix(0.7, [1, 2, 3])
    turned[:3, 3] = [5, 6, 7]
    scene.add_geometry(box, transform=turned, node_name="one")
    scene.add_geometry(box, transform=np.diag([2.0, 1, 1, 1]), node_name="two", parent_node_name="one")
    (tmp_path / "a.glb").write_bytes(scene.export(file_type="glb"))
    surface, notes = read_surface_with_notes(tmp_path / "a.glb")
    expected = scene.to_geometry()
    assert surface.area == pytest.approx(expected.area, rel=1e-6)
    assert np.allclose(surface.vertices.min(axis=0), expected.bounds[0], atol=1e-5)
    assert np.allclose(surface.vertices.max(axis=0), expected.bounds[1], atol=1e-5)
    assert not notes or "merged" in notes[0]


def test_a_node_of_translation_rotation_and_scale(tmp_path: Path) -> None:
    half = float(np.sqrt(0.5))
    node = {"mesh": 0, "translation": [10, 0, 0], "rotation": [0, 0, half, half], "scale": [2, 1, 1]}
    surface = _read(tmp_path, _document(nodes=[node]))
    assert np.allclose(surface.vertices, np.array([[10, 0, 0], [10, 2, 0], [9, 2, 0], [9, 0, 0.25]]))


def test_a_mirroring_node_keeps_the_front(tmp_path: Path) -> None:
    node = {"mesh": 0, "scale": [-1, 1, 1]}
    surface = _read(tmp_path, _document(nodes=[node]))
    assert (surface.face_normals[:, 2] > 0).all()


@pytest.mark.parametrize(("mode", "faces"), [(5, [[0, 1, 3], [1, 2, 3]]), (6, [[1, 3, 0], [3, 2, 0]])])
def test_strips_and_fans(tmp_path: Path, mode: int, faces: list[list[int]]) -> None:
    document = _document(np.array([0, 1, 3, 2], "<u2"))
    document["meshes"][0]["primitives"][0]["mode"] = mode
    assert _read(tmp_path, document).faces.tolist() == faces


def test_seams_are_merged(tmp_path: Path) -> None:
    points = POINTS[FACES.ravel()]
    surface = _read(tmp_path, _document(np.arange(6, dtype="<u2"), points))
    assert len(surface.vertices) == 4


def _deep(document: dict[str, Any], *path: Any, value: Any) -> dict[str, Any]:
    entry: Any = document
    for key in path[:-1]:
        entry = entry[key]
    entry[path[-1]] = value
    return document


@pytest.mark.parametrize(
    ("path", "value", "message"),
    [
        (("accessors", 0, "count"), 2**31 - 1, "within its view"),
        (("accessors", 0, "count"), -1, "whole number"),
        (("accessors", 0, "byteOffset"), 4, "within its view"),
        (("accessors", 0, "type"), "VEC2", "type VEC3"),
        (("accessors", 0, "componentType"), 5124, "type VEC3"),
        (("accessors", 0, "sparse"), {}, "sparse"),
        (("accessors", 1, "count"), 5, "three indices"),
        (("accessors", 1, "componentType"), 5122, "unsigned"),
        (("bufferViews", 0, "byteLength"), 10**12, "view within"),
        (("bufferViews", 0, "byteStride"), 10**12, "within its view"),
        (("bufferViews", 0, "buffer"), 7, "buffers"),
        (("buffers", 0, "byteLength"), 10**12, "a buffer of"),
        (("buffers", 0, "uri"), "file:///etc/passwd", "no other file is opened"),
        (("buffers", 0, "uri"), "../../secret.bin", "no other file is opened"),
        (("buffers", 0, "uri"), "data:application/octet-stream;base64,@@@", "base64"),
        (("meshes", 0, "primitives"), {"not": "an array"}, "an array"),
        (("meshes", 0, "primitives", 0, "indices"), 9, "accessors"),
        (("nodes", 0, "children"), [0], "in two places"),
        (("nodes", 0, "matrix"), [1, 2, 3], "16 finite numbers"),
        (("nodes", 0, "scale"), ["a", 1, 1], "numbers for scale"),
        (("scenes", 0, "nodes"), [3], "nodes"),
        (("scenes", 0, "nodes"), [True], "nodes"),
        (("asset", "version"), "1.0", "glTF 2"),
        (("extensionsRequired",), ["KHR_draco_mesh_compression"], "requires KHR_draco"),
    ],
)
def test_damaged_or_unsafe_documents(tmp_path: Path, path: tuple, value: Any, message: str) -> None:
    with pytest.raises(UnreadableError, match=message):
        _read(tmp_path, _deep(_document(), *path, value=value))


def test_an_instance_bomb_is_refused_at_once(tmp_path: Path) -> None:
    nodes: list[dict[str, Any]] = [{"children": [k + 1] * 8} for k in range(12)]
    with pytest.raises(UnreadableError, match="in two places"):
        _read(tmp_path, _document(nodes=[*nodes, {"mesh": 0}]))


@pytest.mark.parametrize("text", ["{", "[]", "{}", '{"asset": 3}', '{"a":' * 100_000])
def test_other_json(tmp_path: Path, text: str) -> None:
    with pytest.raises(UnreadableError):
        _read(tmp_path, text)


def test_indices_out_of_range_and_numbers_that_are_none(tmp_path: Path) -> None:
    with pytest.raises(UnreadableError, match="indices of 4 vertices"):
        _read(tmp_path, _document(np.array([0, 1, 4], "<u2")))
    points = POINTS.copy()
    points[2, 1] = np.nan
    with pytest.raises(UnusableError, match="finite"):
        _read(tmp_path, _document(points=points))
