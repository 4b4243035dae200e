"""Reading STL, ascii and binary, and writing binary.

Our own parser, because the libraries return an empty scene for a truncated file (trimesh) and
believe the announced count (VTK); the binary form is one structured array anyway.
"""

from __future__ import annotations

import numpy as np

from kirisurf.errors import UnreadableError, UnusableError
from kirisurf.formats.polygons import Polygons, floats, polygons, shown
from kirisurf.formats.source import Source, is_binary_stl, text_lines

_FACET = np.dtype([("normal", "<f4", 3), ("corners", "<f4", (3, 3)), ("attribute", "<u2")])


def stl_bytes(corners: np.ndarray) -> bytes:
    """Return triangles as binary STL.

    Parameters
    ----------
    corners : (f, 3, 3)
        Corners of every triangle, counter-clockwise seen from outside; single precision in the file.
    """
    corners = np.asarray(corners, dtype=np.float64).reshape(-1, 3, 3)
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    length = np.linalg.norm(normal, axis=1, keepdims=True)
    facets = np.zeros(len(corners), dtype=_FACET)
    facets["normal"] = normal / np.where(length > 0, length, 1.0)
    facets["corners"] = corners
    return b"kirisurf".ljust(80) + np.uint32(len(corners)).tobytes() + facets.tobytes()


def read(source: Source) -> Polygons:
    """Read the triangles; three vertices each, as the format has them."""
    # Binary first: some writers begin the binary header with the word "solid".
    corners = _binary(source.content) if is_binary_stl(source.content) else _ascii(source)
    if not len(corners):
        raise UnusableError(f"{source.name}: expected triangles, got an STL with none")
    return polygons(corners, np.full(len(corners) // 3, 3), np.arange(len(corners)), source.name)


def _binary(content: bytes) -> np.ndarray:
    corners = np.frombuffer(content, _FACET, offset=84)["corners"].reshape(-1, 3)
    with np.errstate(invalid="ignore"):  # a signaling NaN stays one, and is refused with the others
        return corners.astype(np.float64)


def _ascii(source: Source) -> np.ndarray:
    content, name = source.content, source.name
    if content.lstrip()[:5].lower() != b"solid":
        if len(content) < 84:
            raise UnreadableError(f"{name}: expected STL, got {len(content)} bytes that are no such thing")
        announced = int.from_bytes(content[80:84], "little")
        raise UnreadableError(
            f"{name}: expected {84 + 50 * announced} bytes for the {announced} triangles that the STL announces, "
            f"got {len(content)}: it is damaged, or no STL"
        )
    tokens: list[bytes] = []
    corners = opened = closed = 0
    for number, line in enumerate(text_lines(source), start=1):
        words = line.split()
        keyword = words[0].lower() if words else b""
        if keyword == b"vertex":
            if len(words) != 4:
                raise UnreadableError(f"{name}: expected vertex x y z, got {shown(line)} in line {number}")
            tokens += words[1:]
            corners += 1
        elif keyword == b"endloop":
            if corners != 3:
                raise UnreadableError(f"{name}: expected 3 vertices per facet, got {corners} before line {number}")
            corners = 0
        elif keyword == b"solid":
            opened += 1
        elif keyword == b"endsolid" or (keyword == b"end" and words[1:2] == [b"solid"]):
            closed += 1
    if corners or opened != closed:
        raise UnreadableError(
            f"{name}: expected an endsolid for each of {opened} solids, got {closed}: the file is cut off"
        )
    return floats(tokens, name, "vertices").reshape(-1, 3)
