"""Reading glTF 2.0 (.gltf with embedded data, .glb): positions and triangles of the default scene.

Our own reader, because trimesh returns an empty scene for a truncated or compressed file, multiplies
instances without a bound and reads what the file names. Here buffers come from the file itself only,
every accessor is checked against them before a byte is read, and a node is visited once, as the
format demands: so there are no cycles and no instance bombs.
"""

from __future__ import annotations

import base64
import binascii
import json
from dataclasses import dataclass

import numpy as np

from kirisurf.errors import UnreadableError
from kirisurf.formats.polygons import Polygons, counted, polygons
from kirisurf.formats.source import Source

_COMPONENTS = {5120: "i1", 5121: "u1", 5122: "i2", 5123: "u2", 5125: "u4", 5126: "f4"}
_WIDTHS = {"SCALAR": 1, "VEC3": 3}
_LARGEST = 1e60
_HARMLESS = ("KHR_materials_", "KHR_texture_", "KHR_lights_", "KHR_mesh_quantization", "EXT_texture_", "KHR_xmp")


@dataclass(frozen=True)
class _File:
    """The parsed document with its buffers."""

    name: str
    document: dict
    buffers: list[bytes]

    def item(self, collection: str, index: object) -> dict:
        """Return entry `index` of a top-level array, refusing what is not there."""
        entries = self.document.get(collection, [])
        if not isinstance(index, int) or isinstance(index, bool) or not isinstance(entries, list):
            raise self.damaged(f"an index into {collection}", index)
        if not 0 <= index < len(entries) or not isinstance(entries[index], dict):
            raise self.damaged(f"an index into {len(entries)} {collection}", index)
        return entries[index]

    def number(self, entry: dict, key: str, default: int | None = None) -> int:
        """Return a non-negative whole number."""
        value = entry.get(key, default)
        if not isinstance(value, int) or isinstance(value, bool) or not 0 <= value < 2**53:
            raise self.damaged(f"a whole number for {key}", value)
        return value

    def entries(self, entry: dict, key: str) -> list:
        """Return an array, empty where it is missing."""
        value = entry.get(key, [])
        if not isinstance(value, list):
            raise self.damaged(f"an array for {key}", type(value).__name__)
        return value

    def damaged(self, expected: str, got: object) -> UnreadableError:
        """Return the one exception of this reader."""
        return UnreadableError(f"{self.name}: expected {expected}, got {_shown(got)}: the glTF is damaged")


def _shown(value: object) -> str:
    """Return a short, printable form of a value from a file."""
    return str(value)[:60].encode("unicode_escape").decode("ascii")


def _quiet() -> np.errstate:
    """What overflows, or is a signaling NaN, is refused with all that is not finite, where a face has it."""
    return np.errstate(over="ignore", divide="ignore", invalid="ignore")


def read(source: Source) -> Polygons:
    """Read all triangles of the default scene, each node's transformation applied, in meters and y up."""
    text, binary = _chunks(source) if source.format == "glb" else (source.content, None)
    try:
        document = json.loads(text)
    except (ValueError, RecursionError) as problem:
        raise UnreadableError(f"{source.name}: expected glTF (JSON), got: {_shown(problem)}") from None
    if not isinstance(document, dict) or not isinstance(document.get("asset"), dict):
        raise UnreadableError(f"{source.name}: expected glTF with an asset entry, got other JSON")
    version = str(document["asset"].get("version", ""))
    if version.split(".")[0] != "2":
        raise UnreadableError(f"{source.name}: expected glTF 2, got version {_shown(version)}")
    file = _File(source.name, document, [])
    for extension in file.entries(document, "extensionsRequired"):
        if not str(extension).startswith(_HARMLESS):
            raise UnreadableError(f"{source.name}: expected plain glTF, got one that requires {_shown(extension)}")
    for number, entry in enumerate(file.entries(document, "buffers")):
        file.buffers.append(_buffer(file, entry, binary if number == 0 else None))

    vertices: list[np.ndarray] = []
    faces: list[np.ndarray] = []
    left_out = 0
    offset = 0
    for node, matrix in _nodes(file):
        if "mesh" not in node:
            continue
        for primitive in file.entries(file.item("meshes", node["mesh"]), "primitives"):
            triangles = _triangles(file, primitive)
            if triangles is None:
                left_out += 1
                continue
            points, corners = triangles
            with _quiet():
                vertices.append(points @ matrix[:3, :3].T + matrix[:3, 3])
                is_mirrored = np.linalg.det(matrix[:3, :3]) < 0  # it turns the triangles inside out
            faces.append((corners[:, ::-1] if is_mirrored else corners) + offset)
            offset += len(points)
    joined = np.concatenate(faces) if faces else np.zeros((0, 3), np.int64)
    points = np.concatenate(vertices) if vertices else np.zeros((0, 3))
    notes = [f"{counted(left_out, 'part', 'parts')} of points or lines left out."] if left_out else []
    return polygons(points, np.full(len(joined), 3), joined.ravel(), source.name, notes)


def _chunks(source: Source) -> tuple[bytes, bytes | None]:
    content, name = source.content, source.name
    head = np.frombuffer(content[: len(content) // 4 * 4], "<u4")
    if len(content) < 20 or head[1] != 2 or head[2] != len(content):
        raise UnreadableError(
            f"{name}: expected a GLB 2 whose header announces its {len(content)} bytes, got another: it is damaged"
        )
    found: list[tuple[bytes, bytes]] = []
    at = 12
    while at < len(content):
        if at + 8 > len(content):
            raise UnreadableError(f"{name}: expected a chunk header, got {len(content) - at} bytes: the GLB is damaged")
        size = int.from_bytes(content[at : at + 4], "little")
        if at + 8 + size > len(content):
            raise UnreadableError(f"{name}: expected a chunk of {size} bytes, got {len(content) - at - 8}: damaged")
        found.append((content[at + 4 : at + 8], content[at + 8 : at + 8 + size]))
        at += 8 + size
    if found[0][0] != b"JSON":
        raise UnreadableError(f"{name}: expected a JSON chunk first, got another: the GLB is damaged")
    return found[0][1], next((body for kind, body in found[1:] if kind == b"BIN\0"), None)


def _buffer(file: _File, entry: object, binary: bytes | None) -> bytes:
    if not isinstance(entry, dict):
        raise file.damaged("a buffer", entry)
    size = file.number(entry, "byteLength")
    uri = entry.get("uri")
    if uri is None:
        if binary is None:
            raise file.damaged("a buffer with content", "none")
        content = binary
    elif isinstance(uri, str) and uri.startswith("data:") and ";base64," in uri[:200]:
        try:
            content = base64.b64decode(uri.partition(";base64,")[2], validate=True)
        except (binascii.Error, ValueError):
            raise file.damaged("base64 data", uri) from None
    else:
        raise UnreadableError(
            f"{file.name}: expected all data in the file, got a reference to {_shown(uri)}: "
            "no other file is opened. Save it as .glb"
        )
    if len(content) < size:
        raise file.damaged(f"a buffer of {size} bytes", len(content))
    return content[:size]


def _nodes(file: _File) -> list[tuple[dict, np.ndarray]]:
    """Return every node of the default scene with its matrix (4, 4) to world coordinates."""
    document = file.document
    if document.get("scenes"):
        roots = file.entries(file.item("scenes", document.get("scene", 0)), "nodes")
    else:
        numbers = range(len(file.entries(document, "nodes")))
        children = {c for k in numbers for c in file.entries(file.item("nodes", k), "children") if isinstance(c, int)}
        roots = [k for k in numbers if k not in children]
    found: list[tuple[dict, np.ndarray]] = []
    seen: set[int] = set()
    waiting = [(root, np.eye(4)) for root in reversed(roots)]
    while waiting:
        index, above = waiting.pop()
        node = file.item("nodes", index)
        if index in seen:
            raise file.damaged("a tree of nodes", f"node {index} in two places")
        seen.add(index)
        with _quiet():
            matrix = above @ _transformation(file, node)
        found.append((node, matrix))
        waiting += [(child, matrix) for child in reversed(file.entries(node, "children"))]
    return found


def _transformation(file: _File, node: dict) -> np.ndarray:
    def numbers(key: str, default: list[float]) -> np.ndarray:
        value = node.get(key, default)
        # bool is an int in Python, and NumPy would read numbers out of texts
        if not isinstance(value, list) or not all(type(item) in (int, float) for item in value):
            raise file.damaged(f"numbers for {key}", value)
        if len(value) != len(default) or not all(abs(item) <= _LARGEST for item in value):
            raise file.damaged(f"{len(default)} finite numbers for {key}", value)
        return np.array(value, dtype=np.float64)

    if "matrix" in node:
        return numbers("matrix", list(np.eye(4).ravel())).reshape(4, 4).T
    x, y, z, w = numbers("rotation", [0.0, 0.0, 0.0, 1.0])
    matrix = np.eye(4)
    with _quiet():
        rotation = np.array([
            [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
            [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
            [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
        ])  # fmt: skip
        matrix[:3, :3] = rotation * numbers("scale", [1.0, 1.0, 1.0])
    matrix[:3, 3] = numbers("translation", [0.0, 0.0, 0.0])
    return matrix


def _triangles(file: _File, primitive: object) -> tuple[np.ndarray, np.ndarray] | None:
    """Return points (n, 3) and triangles (m, 3) of a primitive; None where it holds points or lines."""
    if not isinstance(primitive, dict) or not isinstance(primitive.get("attributes"), dict):
        raise file.damaged("a primitive with attributes", primitive)
    mode = file.number(primitive, "mode", 4)
    if mode not in (4, 5, 6) or "POSITION" not in primitive["attributes"]:
        return None
    with _quiet():
        points = _accessor(file, primitive["attributes"]["POSITION"], "VEC3").astype(np.float64)
    if "indices" in primitive:
        indices = _accessor(file, primitive["indices"], "SCALAR")
        if indices.dtype.kind != "u":
            raise file.damaged("unsigned indices", indices.dtype)
        indices = indices.ravel().astype(np.int64)
    else:
        indices = np.arange(len(points))
    if indices.size and indices.max() >= len(points):
        raise file.damaged(f"indices of {len(points)} vertices", int(indices.max()))
    if mode == 4:
        if len(indices) % 3:
            raise file.damaged("three indices per triangle", f"{len(indices)} indices")
        return points, indices.reshape(-1, 3)
    if len(indices) < 3:
        return points, np.zeros((0, 3), np.int64)
    a, b, c = indices[:-2], indices[1:-1], indices[2:]
    if mode == 6:
        return points, np.stack([b, c, np.full_like(b, indices[0])], axis=1)
    odd = (np.arange(len(a)) % 2).astype(bool)
    return points, np.stack([a, np.where(odd, c, b), np.where(odd, b, c)], axis=1)


def _accessor(file: _File, index: object, kind: str) -> np.ndarray:
    """Read an accessor (count, width) after checking it against its view and the view against its buffer."""
    accessor = file.item("accessors", index)
    code = accessor.get("componentType")
    if accessor.get("type") != kind or not isinstance(code, int) or code not in _COMPONENTS:
        raise file.damaged(f"an accessor of type {kind}", (accessor.get("type"), code))
    if "sparse" in accessor or "bufferView" not in accessor:
        raise UnreadableError(f"{file.name}: expected plain accessors, got a sparse one: save it as STL, OBJ or PLY")
    dtype = np.dtype("<" + _COMPONENTS[code])
    width, count = _WIDTHS[kind], file.number(accessor, "count")
    view = file.item("bufferViews", accessor["bufferView"])
    which = file.number(view, "buffer")
    if which >= len(file.buffers):
        raise file.damaged(f"an index into {len(file.buffers)} buffers", which)
    start, length = file.number(view, "byteOffset", 0), file.number(view, "byteLength")
    if start + length > len(file.buffers[which]):
        raise file.damaged(f"a view within {len(file.buffers[which])} bytes", f"{start} + {length}")
    row = width * dtype.itemsize
    stride = file.number(view, "byteStride", row) or row
    offset = file.number(accessor, "byteOffset", 0)
    if stride < row or (count and offset + stride * (count - 1) + row > length):
        raise file.damaged(f"an accessor within its view of {length} bytes", f"{count} entries")
    if not count:
        return np.zeros((0, width), dtype)
    content = file.buffers[which]
    table = np.ndarray((count, width), dtype, content, start + offset, (stride, dtype.itemsize))
    if accessor.get("normalized") is True and dtype.kind in "iu":
        return np.maximum(table / np.iinfo(dtype).max, -1.0)
    return table
