"""A finished run, read back from its folder."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from kirisurf.arrays import frozen
from kirisurf.derive import derive_tessellation
from kirisurf.errors import KirisurfError, UnreadableError
from kirisurf.formats import read_polygons, read_surface, source
from kirisurf.formats.vtk_files import PolygonsWithFields, read_with_fields
from kirisurf.loops import Loops
from kirisurf.naming import printable
from kirisurf.runs.folder import RESULT
from kirisurf.runs.record import sha256
from kirisurf.runs.schema import check_record
from kirisurf.spec import FitSpec
from kirisurf.surface import Surface
from kirisurf.tessellation import Tessellation

SPEC = "run.toml"
RECORD_MB = 256
"""Largest record that is read, in megabytes."""

DEPLOYED, CONTRACTED, HOLES, TARGET = "deployed", "contracted", "holes", "target"
BLOCKS = "run.vtm"
RUN_BLOCKS = {"tiles": "deployed.vtp", "holes": "holes.vtp", "target": "target.vtp", "contracted": "contracted.vtp"}
"""Names of the blocks of `BLOCKS`, which opens the whole run in ParaView, and their files."""
# What a run is read from; the report, the pictures and the tables may be edited or rewritten.
_READ = (SPEC, "deployed.obj", "contracted.obj", "deployed.vtp", "contracted.vtp", "holes.vtp", "target.vtp")
# Fields that carry the tessellation itself; everything else in the VTP files is a measure.
ASKED_STRETCH = "asked_stretch"
WELD, CELL, STANDARD_DEPLOYED, STANDARD_CONTRACTED = "weld", "cell", "standard_deployed", "standard_contracted"


@dataclass(frozen=True, eq=False)
class Run:
    """A run folder; everything but the record is read when it is first asked for.

    Attributes
    ----------
    folder : Path
    spec : FitSpec
    result : mapping
        The content of `result.json`.
    """

    folder: Path
    spec: FitSpec
    result: Mapping[str, Any]

    @property
    def name(self) -> str:
        """Name of the folder, as it may be shown."""
        return printable(self.folder.name)

    @property
    def origin(self) -> Float[np.ndarray, " 3"]:
        """Origin (3,) of the run's files in the frame of the target file; zero unless that lies far away."""
        return frozen(self.result["origin"])

    @property
    def certificate(self) -> Mapping[str, float | int | None]:
        """Rows of the certificate, as recorded."""
        return self.result["certificate"]

    @cached_property
    def deployed(self) -> Float[np.ndarray, "n 3"]:
        """Deployed points (n, 3)."""
        return self._states[0]

    @cached_property
    def contracted(self) -> Float[np.ndarray, "n 2"]:
        """Contracted points (n, 2)."""
        return frozen(self._states[1][:, :2])

    @cached_property
    def tessellation(self) -> Tessellation:
        """The tessellation, derived anew from the tiles and the welding in the files."""
        points, cells = self._fields_of(CONTRACTED).point_fields, self._fields_of(CONTRACTED).cell_fields
        try:
            return derive_tessellation(
                points[STANDARD_DEPLOYED][:, :2],
                points[STANDARD_CONTRACTED][:, :2],
                self._states[2],
                points[WELD].ravel().astype(np.int64),
                cells[CELL].astype(np.int64),
                self.spec.tessellation,
            )
        except KeyError as missing:
            raise UnreadableError(
                f"{self.folder / 'contracted.vtp'}: expected the field {missing}, got a file without it"
            ) from None

    @cached_property
    def target(self) -> Surface:
        """The target surface, in the frame of the run's files."""
        surface = read_surface(self.folder / "target.vtp")
        return Surface(surface.vertices, surface.faces, str(self.result["target"]["name"]))

    @cached_property
    def asked_stretch(self) -> Float[np.ndarray, " v"]:
        """Stretch that the target asks for at its vertices.

        Raises
        ------
        UnreadableError
            Where the file of the target does not hold it.
        """
        fields = read_with_fields(source.load(self.folder / "target.vtp")).point_fields
        if ASKED_STRETCH not in fields:
            raise UnreadableError(f"{self.folder / 'target.vtp'}: expected the field {ASKED_STRETCH}, got none")
        return frozen(fields[ASKED_STRETCH].ravel())

    @cached_property
    def fields(self) -> Mapping[tuple[str, str], np.ndarray]:
        """Measured fields: {(vertex, tile or hole; name): values}."""
        deployed, holes = self._fields_of(DEPLOYED), self._fields_of(HOLES)
        found = {("vertex", name): values for name, values in deployed.point_fields.items()}
        found |= {("tile", name): values for name, values in deployed.cell_fields.items()}
        found |= {("hole", name): values for name, values in holes.cell_fields.items()}
        return {key: frozen(values) for key, values in found.items()}

    def __repr__(self) -> str:
        return f"Run({str(self.folder)!r}, {self.result.get('tiles')} tiles, {self.result['status']})"

    def _repr_html_(self) -> str:
        return self._card

    @cached_property
    def _card(self) -> str:
        import kirisurf  # by the package's names: the module of the cards imports this one

        return kirisurf.card(self)

    @cached_property
    def _states(self) -> tuple[np.ndarray, np.ndarray, Loops]:
        deployed, tiles = read_polygons(self.folder / "deployed.obj")
        contracted, _ = read_polygons(self.folder / "contracted.obj")
        return deployed, contracted, tiles

    @cached_property
    def _read_fields(self) -> dict[str, PolygonsWithFields]:
        return {}

    def _fields_of(self, name: str) -> PolygonsWithFields:
        if name not in self._read_fields:
            self._read_fields[name] = read_with_fields(source.load(self.folder / f"{name}.vtp"))
        return self._read_fields[name]


def read_run(folder: str | os.PathLike[str]) -> Run:
    """Open a run folder.

    Raises
    ------
    UnreadableError
        Where the folder is missing, holds no finished run, or one of the files that a run is read from is
        missing or has changed since the run was written.
    """
    path = Path(folder)
    if not path.is_dir():
        got = "a file" if path.exists() else "a name that does not exist"
        raise UnreadableError(f"{path}: expected a run folder, got {got}")
    try:
        if not os.path.lexists(path / RESULT):
            raise UnreadableError(f"{path}: expected a run folder with {RESULT}, got one without: no finished run")
        result = json.loads(source.read_bytes(path / RESULT, RECORD_MB).decode("utf-8"))
    except (ValueError, RecursionError) as problem:
        raise UnreadableError(f"{path / RESULT}: expected the record of a run, got {problem}") from None
    check_record(result, path / RESULT)
    for name in _READ:
        _check_file(path / name, result["files"].get(name))
    try:
        spec = FitSpec.from_toml(source.read_bytes(path / SPEC, RECORD_MB).decode("utf-8"), str(path / SPEC))
    except (KirisurfError, ValueError) as problem:
        raise UnreadableError(str(problem)) from None
    return Run(path, spec, result)


def _check_file(path: Path, expected: object) -> None:
    if not isinstance(expected, str):
        raise UnreadableError(f"{path.parent / RESULT}: expected the hash of {path.name}, got none")
    try:
        if not path.is_file():
            raise UnreadableError(f"{path}: expected this file of the run, got none, or no plain file")
        found = sha256(path)
    except OSError as problem:
        raise UnreadableError(f"{path}: expected this file of the run, got: {problem.strerror or problem}") from None
    if found != expected:
        raise UnreadableError(f"{path}: expected the file that the run wrote, got one that has changed since (hash)")
