"""Reading VTP and legacy VTK through vtk in a child process.

vtk's readers end the process on lying counts and allocation bombs, and pass on indices out of range
that end it in the next filter: so they run apart, under limits, and what returns is checked here.
"""

from __future__ import annotations

import re
import tempfile
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from kirisurf.errors import UnreadableError, UnusableError
from kirisurf.formats import child
from kirisurf.formats.polygons import Polygons, polygons
from kirisurf.formats.source import Source

MEMORY_MB = 8000
SECONDS = 60
_WORKER = Path(__file__).with_name("vtk_worker.py")


@dataclass(frozen=True, eq=False)
class PolygonsWithFields:
    """Polygons of a VTK file with its named fields.

    Attributes
    ----------
    polygons : Polygons
    point_fields, cell_fields : mapping of str to array
        One row per vertex, or per polygon.
    about : mapping of str to array or list of str
        Field data: what the file says about itself.
    """

    polygons: Polygons
    point_fields: Mapping[str, np.ndarray]
    cell_fields: Mapping[str, np.ndarray]
    about: Mapping[str, np.ndarray | list[str]]


def read(source: Source) -> Polygons:
    """Read points and polygons; verts and lines are left out."""
    return read_with_fields(source).polygons


def read_with_fields(source: Source) -> PolygonsWithFields:
    """Read points, polygons, every numeric array of points and cells, and the field data.

    Raises
    ------
    UnreadableError
        Where the file is damaged or unsafe, or vtk does not survive it.
    UnusableError
        Where it holds something else than polygons.
    """
    name = source.name
    if source.format == "vtp" and re.search(rb"<!(DOCTYPE|ENTITY)", source.content):
        raise UnreadableError(f"{name}: expected plain VTK XML, got one that declares a DOCTYPE or entities: unsafe")
    if source.format == "vtk":
        _check_announced(source)
    with tempfile.TemporaryDirectory(prefix="kirisurf-") as folder:
        # A copy under a plain name: vtk sees the bytes that were checked and no odd characters in a path.
        copy, output = Path(folder, "input." + source.format), Path(folder, "output.npz")
        copy.write_bytes(source.content)
        seconds = SECONDS + len(source.content) / 2e6
        ended = child.run(_WORKER, [source.format, str(copy), str(output)], seconds, MEMORY_MB)
        if ended.death or not ended.answer:
            raise UnreadableError(
                f"{name}: expected a VTK file, got one that the vtk library does not survive "
                f"({ended.death or ended.complaint or 'no answer'}): it is damaged"
            )
        if "error" in ended.answer:
            if ended.answer.get("kind") == "wrong":
                raise UnusableError(f"{name}: expected a surface of polygons (PolyData), got {ended.answer['error']}")
            raise UnreadableError(f"{name}: expected a whole VTK file, got a damaged one: {ended.answer['error']}")
        with np.load(output, allow_pickle=False) as arrays:
            found = {key: arrays[key] for key in arrays.files}
    points, offsets, indices = found["points"], found["offsets"], found["indices"]
    if offsets[0] != 0 or offsets[-1] != len(indices) or (np.diff(offsets) < 0).any():
        raise UnreadableError(f"{name}: expected rising offsets up to {len(indices)}, got others: it is damaged")
    result = polygons(points, np.diff(offsets), indices, name)
    fields: dict[str, dict[str, np.ndarray]] = {}
    for where, rows in (("point", len(points)), ("cell", len(offsets) - 1)):
        fields[where] = {
            key: found[stored] for key, stored in ended.answer["fields"][where].items() if len(found[stored]) == rows
        }
    about = {key: found[stored] for key, stored in ended.answer["fields"]["about"].items()}
    return PolygonsWithFields(result, fields["point"], fields["cell"], {**about, **ended.answer["texts"]})


def _check_announced(source: Source) -> None:
    """Refuse a legacy file that is shorter than the points and polygons which it announces: vtk fills in zeros."""
    lines = source.content[:4096].splitlines()
    is_ascii = len(lines) > 2 and lines[2].strip().upper() == b"ASCII"
    for found in re.finditer(rb"^(POINTS|POLYGONS|CELLS)[ \t]+(\d+)[ \t]+(\w+)[ \t]*\r?$", source.content, re.M | re.I):
        keyword, count, last = found.group(1).upper(), int(found.group(2)[:19]), found.group(3)
        numbers = 3 * count if keyword == b"POINTS" else int(last[:19]) if last.isdigit() else 0
        rest = len(source.content) - found.end()
        width = 8 if last.lower() in (b"double", b"long") else 1 if last.lower().endswith(b"char") else 4
        # A text number takes two bytes at least; whether they are numbers is left to vtk, but for their count.
        enough = rest >= numbers * (2 if is_ascii else width if keyword == b"POINTS" else 4)
        if enough and is_ascii:
            enough = len(source.content[found.end() :].split(None, numbers)) >= numbers
        if not enough:
            raise UnreadableError(
                f"{source.name}: expected {numbers} numbers after {keyword.decode()}, got fewer: it is cut off"
            )
