"""Every tessellation there is by name: the five of the paper, the bundled files, and the user's own files."""

from __future__ import annotations

import difflib
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from kirisurf.errors import ParameterError
from kirisurf.naming import is_file_name
from kirisurf.tessellation_names import FILES, SUFFIX
from kirisurf.unit_cell import UnitCell, quad_cell
from kirisurf.unit_cells.cell_file import read_cell, read_title
from kirisurf.unit_cells.hexagon import hexagon_cell
from kirisurf.unit_cells.islamic_quad import islamic_quad_cell
from kirisurf.unit_cells.islamic_triangle import islamic_triangle_cell
from kirisurf.unit_cells.kagome import kagome_cell


@dataclass(frozen=True)
class Entry:
    """A tessellation that has a name.

    Attributes
    ----------
    name, title : str
    cell : callable
        Returns the unit cell, as open as it gets.
    moves : bool
        Whether rigid tiles lead from one state to the other through states of equal cells. Where they do not, the
        sheet snaps, and only its two states are free of strain.
    file : Path or None
        Where the cell stands, for those that are not built from formulas.
    """

    name: str
    title: str
    cell: Callable[[], UnitCell]
    moves: bool = True
    file: Path | None = None


def catalog() -> tuple[Entry, ...]:
    """Return the named tessellations: those of the paper first, then the bundled files by name.

    Examples
    --------
    >>> [entry.name for entry in catalog()][:5]
    ['quad', 'kagome', 'hexagon', 'islamic-quad', 'islamic-triangle']
    """
    built = (
        Entry("quad", "rotating squares; 4x4 unit cells are 8x8 tiles", quad_cell),
        Entry("kagome", "rotating triangles; 8 tiles a cell", kagome_cell),
        Entry(
            "hexagon", "rotating hexagons round openings that stay, a third of the sheet; 4 tiles a cell", hexagon_cell
        ),
        Entry("islamic-quad", "octagons and squares that turn by 90 degrees; 8 tiles a cell", islamic_quad_cell, False),
        Entry(
            "islamic-triangle",
            "18-gons and triangles that turn by 60 degrees; 6 tiles a cell",
            islamic_triangle_cell,
            False,
        ),
    )
    bundled = []
    for file in sorted(FILES.glob(f"*{SUFFIX}")):
        name, title = read_title(file)
        bundled.append(Entry(name, title, partial(read_cell, file), True, file))
    return built + tuple(bundled)


def find_cell(name: str) -> UnitCell:
    """Return the unit cell of a name in the catalog, or of a file.

    Raises
    ------
    ParameterError
        Where there is no such name.
    UnreadableError, UnusableError
        As :func:`kirisurf.unit_cells.cell_file.read_cell`.

    Examples
    --------
    >>> len(find_cell("kagome").tiles)
    8
    """
    entries = {entry.name: entry for entry in catalog()}
    if name in entries:
        return entries[name].cell()
    if is_file_name(name):
        return read_cell(name)
    near = difflib.get_close_matches(name, entries, n=1)
    hint = f" (did you mean {near[0]!r}?)" if near else ""
    raise ParameterError(f"tessellation: expected one of {', '.join(entries)} or a file, got {name!r}{hint}")
