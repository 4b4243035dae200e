"""Small sound files of every mesh format, as the beginnings of mutations."""

from __future__ import annotations

import base64
import json
from functools import cache
from pathlib import Path

import numpy as np

from kirisurf.formats.stl import stl_bytes
from kirisurf.formats.writing import vtp_bytes, write_obj
from kirisurf.loops import Loops


def grid(n: int = 4) -> tuple[np.ndarray, np.ndarray]:
    """Return vertices (n^2, 3) of a saddle over the unit square and its quadrilaterals."""
    x, y = np.meshgrid(np.arange(n) / (n - 1), np.arange(n) / (n - 1), indexing="ij")
    k = np.arange(n * n).reshape(n, n)
    quads = np.stack([k[:-1, :-1], k[1:, :-1], k[1:, 1:], k[:-1, 1:]], axis=-1).reshape(-1, 4)
    return np.column_stack([x.ravel(), y.ravel(), (x * y).ravel() / 3]), quads


VERTICES, QUADS = grid()
FACES = np.concatenate([QUADS[:, [0, 1, 2]], QUADS[:, [0, 2, 3]]])
CORNERS = np.array([[0, 0, 0], [1, 0, 0], [1, 1, 0.25], [0, 1, 0]])


def document() -> dict:
    """Return a glTF document of two instances of the grid under a transformed node, its buffer embedded."""
    points, indices = VERTICES.astype("<f4"), FACES.astype("<u2")
    content = points.tobytes() + indices.tobytes()
    return {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [
            {"children": [1, 2], "rotation": [0, 0, 0.6, 0.8], "scale": [1, 2, 3], "translation": [1.0, 2.0, 3.0]},
            {"mesh": 0},
            {"mesh": 0, "matrix": [1, 0, 0, 0, 0, 1, 0, 0, 0, 0, -1, 0, 1, 0, 0, 1]},
        ],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "indices": 1, "mode": 4}]}],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": len(points), "type": "VEC3", "byteOffset": 0},
            {"bufferView": 1, "componentType": 5123, "count": int(indices.size), "type": "SCALAR"},
        ],
        "bufferViews": [
            {"buffer": 0, "byteLength": points.nbytes, "byteStride": 12},
            {"buffer": 0, "byteOffset": points.nbytes, "byteLength": indices.nbytes},
        ],
        "extensionsRequired": ["KHR_materials_unlit"],
        "buffers": [
            {
                "byteLength": len(content),
                "uri": "data:application/octet-stream;base64," + base64.b64encode(content).decode(),
            }
        ],
    }


def glb(described: dict) -> bytes:
    """Return a document with one embedded buffer in the binary form."""
    described = json.loads(json.dumps(described))
    content = base64.b64decode(described["buffers"][0].pop("uri").partition(",")[2])
    text = json.dumps(described).encode()
    text, content = text + b" " * (-len(text) % 4), content + b"\0" * (-len(content) % 4)
    chunks = len(text).to_bytes(4, "little") + b"JSON" + text + len(content).to_bytes(4, "little") + b"BIN\0" + content
    return b"glTF" + (2).to_bytes(4, "little") + (12 + len(chunks)).to_bytes(4, "little") + chunks


def ply(order: str = "<", coordinate: str = "float") -> bytes:
    """Return two triangles in binary, with a color for each."""
    name = {"<": b"little", ">": b"big"}[order]
    kind = {"float": "f4", "double": "f8"}[coordinate]
    head = b"ply\nformat binary_%s_endian 1.0\nelement vertex 4\n" % name
    head += b"".join(b"property %s %s\n" % (coordinate.encode(), axis) for axis in (b"x", b"y", b"z"))
    head += b"element face 2\nproperty list uchar int vertex_indices\nproperty uchar red\nend_header\n"
    rows = [b"\3" + np.array(row, order + "i4").tobytes() + b"\7" for row in ([0, 1, 2], [0, 2, 3])]
    return head + CORNERS.astype(order + kind).tobytes() + b"".join(rows)


def _ascii_ply() -> bytes:
    head = "ply\nformat ascii 1.0\ncomment a saddle\nelement vertex 4\nproperty float x\nproperty float y\n"
    head += "property float z\nelement face 2\nproperty list uchar int vertex_index\nend_header\n"
    return (head + "".join(f"{x} {y} {z}\n" for x, y, z in CORNERS) + "3 0 1 2\n3 0 2 3\n").encode()


def binary_off() -> bytes:
    """Return two triangles as binary OFF with colors."""
    rows = [point.astype(">f4").tobytes() + np.ones(4, ">f4").tobytes() for point in CORNERS]
    faces = np.array([3, 0, 1, 2, 0, 3, 0, 2, 3, 0], ">i4")
    return b"COFF BINARY\n" + np.array([4, 2, 0], ">i4").tobytes() + b"".join(rows) + faces.tobytes()


def _off() -> bytes:
    points = "".join(f"{x} {y} {z}\n" for x, y, z in CORNERS)
    return f"OFF\n# a saddle\n4 2 0\n{points}3 0 1 2\n3 0 2 3 255 0 0\n".encode()


def _ascii_stl() -> bytes:
    facets = "".join(
        "facet normal 0 0 1\n outer loop\n"
        + "".join(f"  vertex {x} {y} {z}\n" for x, y, z in CORNERS[row])
        + " endloop\nendfacet\n"
        for row in ([0, 1, 2], [0, 2, 3])
    )
    return f"solid saddle\n{facets}endsolid saddle\n".encode()


def _legacy() -> tuple[bytes, bytes]:
    head = b"# vtk DataFile Version 3.0\nx\n%s\nDATASET POLYDATA\nPOINTS 4 double\n"
    text = b"0 0 0\n1 0 0\n1 1 0.2\n0 1 0\nPOLYGONS 2 8\n3 0 1 2\n3 0 2 3\nPOINT_DATA 4\nSCALARS s double 1\n"
    polygons = b"\nPOLYGONS 2 8\n" + np.array([3, 0, 1, 2, 3, 0, 2, 3], ">i4").tobytes() + b"\n"
    return (
        head % b"ASCII" + text + b"LOOKUP_TABLE default\n0 1 2 3\n",
        head % b"BINARY" + CORNERS.astype(">f8").tobytes() + polygons,
    )


@cache
def seeds(folder: Path) -> dict[str, tuple[bytes, ...]]:
    """Return sound files by their suffix; `folder` is written to."""
    loops = Loops.from_lists(QUADS.tolist())
    write_obj(folder / "seed.obj", VERTICES, loops, ["a saddle"])
    backward = b"".join(f"f {' '.join(f'{k - 16}/1/1' for k in quad)}\n".encode() for quad in QUADS.tolist())
    plain = b"".join(b"v %r %r %r 1 1 1\n" % tuple(point) for point in VERTICES.tolist())
    strip = document() | {"meshes": [{"primitives": [{"attributes": {"POSITION": 0}, "mode": 5}]}]}
    fields = {"height": VERTICES[:, 2], "place": VERTICES}
    return {
        "obj": ((folder / "seed.obj").read_bytes(), b"mtllib x.mtl\no saddle\n" + plain + b"vt 0 0\n" + backward),
        "ply": (ply("<"), ply(">", "double"), _ascii_ply()),
        "off": (_off(), binary_off()),
        "stl": (stl_bytes(VERTICES[FACES]), _ascii_stl()),
        "gltf": (json.dumps(document()).encode(), json.dumps(strip, indent=1).encode()),
        "glb": (glb(document()),),
        "vtp": (vtp_bytes(VERTICES, loops, fields, {"number": np.arange(len(QUADS))}, {"unit": ["mm"]}),),
        "vtk": _legacy(),
    }
