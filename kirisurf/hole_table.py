"""The curvature of the holes as a table: of a run or a design, by any construction of the patches, to files."""

from __future__ import annotations

import csv
import io
import os
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np
from jaxtyping import Float

from kirisurf.errors import ParameterError
from kirisurf.field_units import described_file
from kirisurf.formats import write_vtp
from kirisurf.formats.atomic import write_text
from kirisurf.judging import hole_measures
from kirisurf.loops import Loops
from kirisurf.runs import Run, read_run
from kirisurf.runs.record import json_text
from kirisurf.runs.table import COLUMNS, curvature_csv, curvature_rows
from kirisurf.surface import Surface
from kirisurf.targets import is_sample, load

PATCHES = ("tiles", "corners", "corners_and_normals")
"""What of the sheet round a hole its patch is fitted to; the first is what runs are measured by."""

SUFFIXES = (".csv", ".json", ".vtp")


@dataclass(frozen=True, eq=False)
class HoleTable:
    """Curvature of the holes of one design.

    Attributes
    ----------
    name : str
        Of the run, or of the target.
    units : str or None
        Unit of length.
    patches : str
        How the patches were constructed, one of `PATCHES`.
    points : (n, 3), units
        Deployed vertices.
    holes : Loops
    fields : mapping of str to (h,) or (h, 3)
        The hole fields of :class:`analysis.measures.Measures`, with `center` (h, 3).
    numbers : mapping of str to float
        Those of docs/measures.md that have to do with curvature.
    """

    name: str
    units: str | None
    patches: str
    points: Float[np.ndarray, "n 3"]
    holes: Loops
    fields: Mapping[str, np.ndarray]
    numbers: Mapping[str, float | None]

    @property
    def rows(self) -> list[dict[str, float | int]]:
        """One row for every hole: the columns of curvature.csv."""
        return curvature_rows(self.fields)

    def save(self, path: str | os.PathLike[str]) -> Path:
        """Write the table; the suffix chooses the format.

        .csv has a row for every hole, .json the rows and the numbers, .vtp the holes as polygons with every field.

        Raises
        ------
        ParameterError
            Where the suffix is another.
        OutputError
            Where the file cannot be written.
        """
        return save_tables([self], path)

    def as_dict(self) -> dict[str, Any]:
        """Return rows and numbers as plain values."""
        return {
            "name": self.name,
            "units": self.units,
            "patches": self.patches,
            "numbers": dict(self.numbers),
            "holes": self.rows,
        }


def curvature(source: Any, patches: str = PATCHES[0]) -> HoleTable:
    """Return the curvature of the holes of a design beside the target's.

    Parameters
    ----------
    source : Design, Run or path of a run folder
    patches : {"tiles", "corners", "corners_and_normals"}
        What the patch over a hole is fitted to: the vertices of the tiles round it, which is what runs are measured by;
        its corners alone; or its corners and the normals there. docs/measures.md says how far each is off.

    Raises
    ------
    ParameterError
        Where there is no such construction, or the source is something else.
    UnreadableError
        Where the run cannot be read.

    Examples
    --------
    >>> import kirisurf
    >>> table = curvature(kirisurf.fit("hypar", cells=(2, 2)))
    >>> len(table.rows), sorted(table.rows[0])[:2], 0.5 < table.numbers["gaussian_curvature_target_share"] < 1
    (9, ['angle_defect', 'area'], True)
    """
    if patches not in PATCHES:
        raise ParameterError(f"--patches: expected one of {', '.join(PATCHES)}, got {patches!r}")
    if isinstance(source, (str, os.PathLike)):
        source = read_run(source)
    if isinstance(source, Run):
        fields = {name: values for (where, name), values in source.fields.items() if where == "hole"}
        found = HoleTable(
            source.name,
            source.spec.units,
            PATCHES[0],
            source.deployed,
            source.tessellation.holes,
            MappingProxyType(fields),
            _of_curvature(source.result["measures"]),
        )
    elif hasattr(source, "deployed_points") and hasattr(source, "measures"):
        found = HoleTable(
            source.surface.name,
            source.spec.units,
            PATCHES[0],
            source.deployed_points,
            source.tessellation.holes,
            MappingProxyType(dict(source.fields("hole"))),
            _of_curvature(source.measures.numbers),
        )
    else:
        raise ParameterError(f"curvature: expected a design, a run or its folder, got {type(source).__name__}")
    return found if patches == PATCHES[0] else _constructed(found, source, patches)


def save_tables(tables: Sequence[HoleTable], path: str | os.PathLike[str]) -> Path:
    """Write the tables of one design or several as one file; with several, the first column of a .csv is the run.

    Raises
    ------
    ParameterError
        Where the suffix is not among `SUFFIXES`, or is .vtp with several tables.
    OutputError
        Where the file cannot be written.
    """
    path = Path(path)
    check_suffix(path, len(tables))
    suffix = path.suffix.lower()
    if suffix == ".csv":
        write_text(path, tables_csv(tables))
    elif suffix == ".json":
        found = [table.as_dict() for table in tables]
        write_text(path, json_text(found[0] if len(found) == 1 else {"runs": found}))
    else:
        table = tables[0]
        about = described_file("holes", set(table.fields), table.units)
        write_vtp(path, table.points, table.holes, {}, dict(table.fields), about)
    return path


def check_suffix(path: str | os.PathLike[str], n_tables: int = 1) -> None:
    """Check the name of a file before anything is read; raises as `save_tables`."""
    suffix = Path(path).suffix.lower()
    if suffix not in SUFFIXES:
        raise ParameterError(f"{path}: expected a suffix among {', '.join(SUFFIXES)}, got {suffix or 'none'}")
    if suffix == ".vtp" and n_tables > 1:
        raise ParameterError(f"{path}: expected one run for a .vtp file, got {n_tables}; -o DIR writes one for each")


def tables_csv(tables: Sequence[HoleTable]) -> str:
    """Return the rows of all tables as CSV text in full precision; with several tables, the first column is the run."""
    if len(tables) == 1:
        return curvature_csv(tables[0].fields)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    columns = ["hole", "x", "y", "z", *COLUMNS]
    writer.writerow(["run", *columns])
    for table in tables:
        for row in table.rows:
            writer.writerow([table.name, *("" if row[name] != row[name] else repr(row[name]) for name in columns)])
    return text.getvalue()


def _constructed(table: HoleTable, source: Any, patches: str) -> HoleTable:
    """The table with patches of another construction, measured anew on the same target."""
    surface = _target(source) if isinstance(source, Run) else source.surface
    fields, numbers = hole_measures(source.tessellation, table.points, surface, patches)
    return replace(table, patches=patches, fields=MappingProxyType(fields), numbers=_of_curvature(numbers))


def _target(run: Run) -> Surface:
    """The target of a run, with the formula of its sample surface, by which the run was measured."""
    if run.result["target"].get("smooth") is None or not is_sample(run.spec.target):
        return run.target
    return replace(run.target, smooth=load(run.spec.target).smooth)


def _of_curvature(numbers: Mapping[str, float | None]) -> Mapping[str, float | None]:
    names = ("curvature", "flagged", "patch_", "angle_defect", "gauss", "rim_turning", "euler", "n_inner")
    return MappingProxyType({key: value for key, value in numbers.items() if any(name in key for name in names)})
