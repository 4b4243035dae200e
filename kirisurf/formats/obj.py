"""Reading OBJ: positions and polygons, nothing else.

Our own parser, because the libraries go wrong in silence here: index 0 and indices before the first
vertex are wrapped round (trimesh), vertices are split at texture seams (VTK), files named by `mtllib`
are opened (pymeshlab). Here no other file is ever opened and every index is checked.
"""

from __future__ import annotations

import re

import numpy as np

from kirisurf.errors import UnreadableError
from kirisurf.formats.polygons import Polygons, counted, floats, integers, polygons, shown
from kirisurf.formats.source import Source, text_lines


def read(source: Source) -> Polygons:
    """Read vertices (2 or 3 coordinates) and faces; texture, normals, colors, lines, points are left out."""
    name = source.name
    if b"\\" in source.content:
        joined = re.sub(rb"\\[ \t]*\r?\n", b" ", source.content)
        source = Source(source.path, source.format, joined)
    rows: list[list[bytes]] = []
    tokens: list[bytes] = []
    sizes: list[int] = []
    before: list[int] = []
    others = 0
    for number, line in enumerate(text_lines(source), start=1):
        words = line.split()
        if b"#" in line:
            comment = next((k for k, word in enumerate(words) if word.startswith(b"#")), len(words))
            words = words[:comment]
        if not words:
            continue
        keyword = words[0]
        if keyword == b"v":
            if len(words) < 3:
                raise UnreadableError(f"{name}: expected 3 coordinates, got {shown(line)} in line {number}")
            rows.append(words[1:4])
        elif keyword == b"f":
            tokens += words[1:]
            sizes.append(len(words) - 1)
            before.append(len(rows))
        elif keyword in (b"curv", b"surf", b"curv2", b"l", b"p"):
            others += 1
    notes = [f"{counted(others, 'line, point or curve', 'lines, points or curves')} left out."] if others else []
    if any(b"/" in token for token in tokens):
        tokens = [token.partition(b"/")[0] for token in tokens]
    given = integers(tokens, name, "faces")
    owner = np.repeat(np.array(before, dtype=np.int64), sizes)
    # OBJ counts from 1; negative numbers count backwards from the last vertex so far.
    indices = np.where(given > 0, given - 1, owner + given)
    if (given == 0).any() or (indices < 0).any():
        wrong = int(given[(given == 0) | (indices < 0)][0])
        raise UnreadableError(
            f"{name}: expected face indices that count from 1 (or backwards from -1), got {wrong}: it is damaged"
        )
    return polygons(_coordinates(rows, name), np.array(sizes, dtype=np.int64), indices, name, notes)


def _coordinates(rows: list[list[bytes]], name: str) -> np.ndarray:
    if any(len(row) == 2 for row in rows):
        rows = [row if len(row) == 3 else [*row, b"0"] for row in rows]
    tokens = [token for row in rows for token in row]
    return floats(tokens, name, "coordinates").reshape(-1, 3)
