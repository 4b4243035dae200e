"""Reading PLY: ascii and binary, both byte orders.

Our own parser, because trimesh accepts indices out of range, counts that lie and faces that are cut
short (and makes triangles of them), cuts concave polygons into a fan, and VTK ends the process.
"""

from __future__ import annotations

import struct
from dataclasses import dataclass

import numpy as np

from kirisurf.errors import UnreadableError, UnusableError
from kirisurf.formats.polygons import Polygons, floats, integers, polygons, shown
from kirisurf.formats.source import Source

_TYPES = {
    b"char": "i1", b"int8": "i1", b"uchar": "u1", b"uint8": "u1",
    b"short": "i2", b"int16": "i2", b"ushort": "u2", b"uint16": "u2",
    b"int": "i4", b"int32": "i4", b"uint": "u4", b"uint32": "u4",
    b"float": "f4", b"float32": "f4", b"double": "f8", b"float64": "f8",
}  # fmt: skip
_ORDERS = {b"ascii": "", b"binary_little_endian": "<", b"binary_big_endian": ">"}
_FACE_LISTS = (b"vertex_indices", b"vertex_index")


@dataclass(frozen=True)
class _Property:
    name: bytes
    kind: str
    count_kind: str = ""


@dataclass(frozen=True)
class _Element:
    name: bytes
    count: int
    properties: tuple[_Property, ...]

    @property
    def smallest_row(self) -> int:
        """Bytes of a binary row whose lists are all empty."""
        return sum(np.dtype(p.count_kind or p.kind).itemsize for p in self.properties)


@dataclass(frozen=True)
class _Column:
    """All values of one property: `values`, and for a list the number of them in every row."""

    values: np.ndarray
    sizes: np.ndarray | None = None


def read(source: Source) -> Polygons:
    """Read the positions of the element `vertex` and the polygons of the element `face`."""
    name = source.name
    order, elements, start = _header(source)
    # A text row takes at least two bytes per number; a row without properties takes none.
    for element in elements:
        least = element.count * (element.smallest_row if order else 2 * len(element.properties) or 1)
        if least > len(source.content) - start + 1:
            raise UnreadableError(
                f"{name}: expected {element.count} rows of {shown(element.name)} as announced, "
                f"got a file of {len(source.content)} bytes: it is damaged"
            )
    body = source.content[start:]
    columns = _binary(body, order, elements, name) if order else _ascii(body, elements, name)
    vertex, face = columns.get(b"vertex", {}), columns.get(b"face", {})
    if not all(axis in vertex and vertex[axis].sizes is None for axis in (b"x", b"y", b"z")):
        raise UnreadableError(f"{name}: expected vertices with x, y and z, got none")
    with np.errstate(invalid="ignore"):  # a signaling NaN stays one, and is refused with the others
        points = np.stack([vertex[axis].values.astype(np.float64) for axis in (b"x", b"y", b"z")], axis=1)
    lists = [face[key] for key in _FACE_LISTS if key in face and face[key].sizes is not None]
    if not lists:
        if b"tristrips" in columns:
            raise UnreadableError(f"{name}: expected polygons, got triangle strips: export it with plain faces")
        raise UnusableError(f"{name}: expected faces (a list vertex_indices), got {len(points)} points and none")
    column = lists[0]
    if column.values.dtype.kind not in "iu":
        raise UnreadableError(f"{name}: expected whole numbers in the faces, got {column.values.dtype}")
    return polygons(points, np.asarray(column.sizes), column.values.astype(np.int64), name)


def _header(source: Source) -> tuple[str, list[_Element], int]:
    name, content = source.name, source.content
    end = content.find(b"end_header", 0, 1 << 20)
    if end < 0:
        raise UnreadableError(f"{name}: expected end_header, got a PLY whose header never ends")
    start = end + len(b"end_header")
    while content[start : start + 1] in (b" ", b"\t"):
        start += 1
    start += 2 if content[start : start + 2] == b"\r\n" else 1
    order: str | None = None
    elements: list[_Element] = []
    for line in content[:end].splitlines()[1:]:
        words = line.split()
        if not words or words[0] in (b"comment", b"obj_info"):
            continue
        if words[0] == b"format" and len(words) >= 2 and words[1] in _ORDERS:
            order = _ORDERS[words[1]]
        elif words[0] == b"element" and len(words) == 3 and words[2].isdigit():
            elements.append(_Element(words[1], int(words[2][:19]), ()))
        elif words[0] == b"property" and elements and (found := _property(words[1:])):
            last = elements[-1]
            elements[-1] = _Element(last.name, last.count, (*last.properties, found))
        else:
            raise UnreadableError(f"{name}: expected a PLY header line, got {shown(line)}")
    if order is None:
        raise UnreadableError(f"{name}: expected a format line in the PLY header, got none")
    _check_names([element.name for element in elements], "elements", name)
    for element in elements:
        _check_names([found.name for found in element.properties], f"properties of {shown(element.name)}", name)
    return order, elements, start


def _check_names(names: list[bytes], what: str, name: str) -> None:
    """Of two with one name, either might be meant."""
    if len(set(names)) < len(names):
        twice = next(found for found in names if names.count(found) > 1)
        raise UnreadableError(f"{name}: expected {what} of different names, got two called {shown(twice)}")


def _property(words: list[bytes]) -> _Property | None:
    if len(words) == 2 and words[0] in _TYPES:
        return _Property(words[1], _TYPES[words[0]])
    if len(words) == 4 and words[0] == b"list" and words[1] in _TYPES and words[2] in _TYPES:
        count_kind = _TYPES[words[1]]
        return _Property(words[3], _TYPES[words[2]], count_kind) if count_kind[0] in "iu" else None
    return None


def _ascii(body: bytes, elements: list[_Element], name: str) -> dict[bytes, dict[bytes, _Column]]:
    if b"\0" in body:
        raise UnreadableError(f"{name}: expected PLY text as its header says, got binary content")
    tokens = body.split()
    found: dict[bytes, dict[bytes, _Column]] = {}
    at = 0
    for element in elements:
        raw: dict[bytes, list[bytes]] = {p.name: [] for p in element.properties}
        sizes: dict[bytes, list[int]] = {p.name: [] for p in element.properties if p.count_kind}
        width = len(element.properties)
        if not sizes:
            stop = at + width * element.count
            if stop > len(tokens):
                raise _cut(name, element)
            for k, p in enumerate(element.properties):
                raw[p.name] = tokens[at + k : stop : width]
            at = stop
        else:
            for _ in range(element.count):
                for p in element.properties:
                    size = 1
                    if p.count_kind:
                        try:
                            size = int(tokens[at].replace(b"_", b"?"))
                        except (ValueError, IndexError):
                            raise _cut(name, element) from None
                        sizes[p.name].append(size)
                        at += 1
                    if size < 0 or at + size > len(tokens):
                        raise _cut(name, element)
                    raw[p.name] += tokens[at : at + size]
                    at += size
        found[element.name] = {
            p.name: _Column(
                _numbers(raw[p.name], p, name), np.array(sizes[p.name], dtype=np.int64) if p.count_kind else None
            )
            for p in element.properties
            if _is_needed(element, p)
        }
    if at != len(tokens):
        raise UnreadableError(f"{name}: expected {at} numbers as its header announces, got {len(tokens)}: damaged")
    return found


def _is_needed(element: _Element, prop: _Property) -> bool:
    """Colors and the like are passed over, so that an odd value there does no harm."""
    return prop.name in ((b"x", b"y", b"z") if element.name == b"vertex" else _FACE_LISTS)


def _numbers(tokens: list[bytes], prop: _Property, name: str) -> np.ndarray:
    what = f"the property {shown(prop.name)}"
    return floats(tokens, name, what) if prop.kind[0] == "f" else integers(tokens, name, what)


def _binary(body: bytes, order: str, elements: list[_Element], name: str) -> dict[bytes, dict[bytes, _Column]]:
    found: dict[bytes, dict[bytes, _Column]] = {}
    at = 0
    for element in elements:
        columns, at = _rows(body, at, order, element, name)
        found[element.name] = columns
    if body[at:].strip(b"\0 \r\n"):
        raise UnreadableError(
            f"{name}: expected {at} bytes of content as the PLY header announces, got {len(body)}: it is damaged"
        )
    return found


def _rows(body: bytes, at: int, order: str, element: _Element, name: str) -> tuple[dict[bytes, _Column], int]:
    """Read one element: as one structured array where all rows have the first one's list sizes, else row by row."""
    if not element.count or not element.properties:
        empty = np.zeros(0, np.int64)
        return {p.name: _Column(empty.astype(p.kind), empty if p.count_kind else None) for p in element.properties}, at
    fields: list[tuple] = []
    here = at
    for k, p in enumerate(element.properties):
        if p.count_kind:
            size, here = _count(body, here, order, p, element, name)
            fields.append((f"n{k}", order + p.count_kind))
            fields.append((f"p{k}", order + p.kind, (size,)))
            here += size * np.dtype(p.kind).itemsize
        else:
            fields.append((f"p{k}", order + p.kind))
            here += np.dtype(p.kind).itemsize
        if here > len(body):
            raise _cut(name, element)
    row = np.dtype(fields)
    if at + element.count * row.itemsize <= len(body):
        table = np.frombuffer(body, row, element.count, at)
        lists = [k for k, p in enumerate(element.properties) if p.count_kind]
        if all((table[f"n{k}"] == table[f"n{k}"][0]).all() for k in lists):
            columns = {
                p.name: _Column(
                    table[f"p{k}"].reshape(-1),
                    table[f"n{k}"].astype(np.int64) if p.count_kind else None,
                )
                for k, p in enumerate(element.properties)
            }
            return columns, at + element.count * row.itemsize
    if not any(p.count_kind for p in element.properties):
        raise _cut(name, element)
    return _ragged_rows(body, at, order, element, name)


def _ragged_rows(body: bytes, at: int, order: str, element: _Element, name: str) -> tuple[dict[bytes, _Column], int]:
    pieces: dict[bytes, list[bytes]] = {p.name: [] for p in element.properties}
    sizes: dict[bytes, list[int]] = {p.name: [] for p in element.properties}
    widths = [np.dtype(p.kind).itemsize for p in element.properties]
    for _ in range(element.count):
        for p, width in zip(element.properties, widths, strict=True):
            size = 1
            if p.count_kind:
                size, at = _count(body, at, order, p, element, name)
            stop = at + size * width
            if stop > len(body):
                raise _cut(name, element)
            pieces[p.name].append(body[at:stop])
            sizes[p.name].append(size)
            at = stop
    return {
        p.name: _Column(
            np.frombuffer(b"".join(pieces[p.name]), order + p.kind),
            np.array(sizes[p.name], dtype=np.int64) if p.count_kind else None,
        )
        for p in element.properties
    }, at


def _count(body: bytes, at: int, order: str, prop: _Property, element: _Element, name: str) -> tuple[int, int]:
    code = {"i1": "b", "u1": "B", "i2": "h", "u2": "H", "i4": "i", "u4": "I"}[prop.count_kind]
    width = int(prop.count_kind[1])
    if at + width > len(body):
        raise _cut(name, element)
    (size,) = struct.unpack_from(order + code, body, at)
    if size < 0 or size > len(body):
        raise UnreadableError(f"{name}: expected lists within the file, got one of {size} entries: it is damaged")
    return size, at + width


def _cut(name: str, element: _Element) -> UnreadableError:
    return UnreadableError(
        f"{name}: expected {element.count} rows of {shown(element.name)} as the PLY header announces, "
        "got fewer or broken ones: it is damaged or cut off"
    )
