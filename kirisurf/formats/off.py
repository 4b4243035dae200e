"""Reading OFF: ascii and binary, with or without normals, colors and texture coordinates.

Our own parser, because the libraries accept files with fewer faces than they announce and read the
four-dimensional form as three-dimensional (trimesh), or exit the process on polygons (meshio).
"""

from __future__ import annotations

import re
from itertools import chain

import numpy as np

from kirisurf.errors import UnreadableError
from kirisurf.formats.polygons import Polygons, floats, integers, polygons, shown
from kirisurf.formats.source import Source, text_lines


def read(source: Source) -> Polygons:
    """Read vertices and polygons; the keyword may be missing, as the format allows."""
    header = re.match(rb"\s*(?:(ST)?(C)?(N)?(4)?(n)?OFF)?([ \t]+BINARY[ \t]*\r?\n)?", source.content)
    assert header is not None  # noqa: S101 - the expression also matches nothing
    texture, colors, normals, homogeneous, any_dimension, binary = header.groups()
    if homogeneous or any_dimension:
        raise UnreadableError(f"{source.name}: expected points in three dimensions, got 4OFF or nOFF")
    if binary:
        extra = 4 * ((3 if normals else 0) + (4 if colors else 0) + (2 if texture else 0))
        for order in "><":  # Geomview writes big-endian, others their own machine's order
            found = _binary(source.content[header.end() :], order, extra, source.name)
            if found is not None:
                return found
        raise UnreadableError(f"{source.name}: expected as many bytes as the binary OFF announces, got others")
    return _ascii(Source(source.path, source.format, source.content[header.end() :]))


def _ascii(source: Source) -> Polygons:
    name = source.name
    lines = [words for line in text_lines(source) if (words := line.partition(b"#")[0].split())]
    first = lines[0] if lines else []
    counts = integers(first, name, "the counts")
    if len(counts) not in (2, 3) or counts.min() < 0:
        raise UnreadableError(f"{name}: expected counts of vertices, faces, edges, got {shown(b' '.join(first))}")
    n, m = int(counts[0]), int(counts[1])
    if len(lines) != 1 + n + m:
        raise UnreadableError(
            f"{name}: expected {n} lines of vertices and {m} of faces as announced, got {len(lines) - 1} lines"
        )
    if any(len(line) < 3 for line in lines[1 : 1 + n]):
        raise UnreadableError(f"{name}: expected 3 coordinates per vertex, got fewer")
    vertices = floats(list(chain.from_iterable(line[:3] for line in lines[1 : 1 + n])), name, "vertices")
    faces = lines[1 + n :]
    sizes = integers([line[0] for line in faces], name, "faces")
    if any(size < 0 or len(line) < size + 1 for line, size in zip(faces, sizes.tolist(), strict=True)):
        raise UnreadableError(f"{name}: expected as many indices as each face announces, got fewer")
    tokens = list(chain.from_iterable(line[1 : 1 + k] for line, k in zip(faces, sizes.tolist(), strict=True)))
    return polygons(vertices.reshape(-1, 3), sizes, integers(tokens, name, "faces"), name)


def _binary(body: bytes, order: str, extra: int, name: str) -> Polygons | None:
    """Read with the given byte order; None where the counts do not fit the bytes exactly."""
    if len(body) < 12:
        return None
    n, m, _ = (int(k) for k in np.frombuffer(body, order + "i4", 3))
    stride = 12 + extra
    start = 12 + n * stride
    if n < 0 or m < 0 or start + 4 * m > len(body) or (len(body) - start) % 4:
        return None
    vertices = np.frombuffer(body, np.dtype((np.uint8, stride)), n, 12)[:, :12].copy().view(order + "f4")
    with np.errstate(invalid="ignore"):  # a signaling NaN stays one, and is refused with the others
        points = vertices.astype(np.float64)
    words = np.frombuffer(body, order + "i4", offset=start).tolist()
    for colored in (True, False):  # the format ends each face with a color count; some writers leave it out
        sizes, indices, at = [], [], 0
        for _ in range(m):
            size = words[at] if at < len(words) else -1
            after = at + 1 + size
            trailing = 0
            if colored:
                trailing = 1 + words[after] if 0 <= after < len(words) and 0 <= words[after] <= 4 else -1
            if size < 1 or after > len(words) or trailing < 0:
                break
            sizes.append(size)
            indices += words[at + 1 : after]
            at = after + trailing
        if len(sizes) == m and at == len(words):
            found = np.array(indices, dtype=np.int64)
            if not found.size or (found.min() >= 0 and found.max() < n):
                return polygons(points, np.array(sizes), found, name)
    return None
