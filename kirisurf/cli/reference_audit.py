"""The published files of a configuration, audited as our own designs are."""

from __future__ import annotations

from pathlib import Path

import numpy as np

from kirisurf.errors import KirisurfError, UnreadableError
from kirisurf.motion import motion_of
from kirisurf.pattern import tile_pattern
from kirisurf.published import Configuration
from kirisurf.reproducing import Numbers
from kirisurf.trimming import rectangle_mask
from kirisurf.unit_cells.catalog import find_cell

RADII = tuple(10.0**k for k in range(-12, 0))
"""Distances over the median edge, up to which contracted points are tried as copies of one."""


def checked_reference(path: str) -> Path:
    """Return the folder of the published files.

    Raises
    ------
    UnreadableError
        Where there is no such folder, or no published pair in it.
    """
    folder = Path(path)
    if not folder.is_dir():
        raise UnreadableError(f"--reference: expected a folder with 2d, 3d and targets, got {path}, which is none")
    if not any(folder.glob("[23]d/*_deployed.obj")):
        raise UnreadableError(f"--reference: expected 2d or 3d with files *_deployed.obj, got none in {path}")
    return folder


def audited(folder: Path, configuration: Configuration) -> tuple[Numbers | None, str]:
    """Certify the published files of a configuration.

    Of several initial maps the one with the smallest rigid row is taken.

    Returns
    -------
    Numbers or None
        None where the files are missing, or cannot be used.
    str
        Which files, or why there are none.
    """
    found: list[tuple[Numbers, str]] = []
    reasons: list[str] = []
    for stem in configuration.stems:
        try:
            found.append((_numbers(folder, configuration, stem), stem))
        except KirisurfError as problem:
            reasons.append(str(problem))
    if not found:
        return None, "; ".join(reasons)
    return min(found, key=lambda each: each[0].rigid)


def _numbers(folder: Path, configuration: Configuration, stem: str) -> Numbers:
    from analysis.certificate import certify
    from kirisurf.formats import read_polygons, read_surface

    home = folder / configuration.kind
    deployed, tiles = read_polygons(home / f"{stem}_deployed.obj")
    contracted, _ = read_polygons(home / f"{stem}_contracted.obj")
    target = None
    if configuration.kind == "3d":
        target = read_surface(folder / "targets" / f"{configuration.target}.obj")
    edges = deployed[tiles.edges]
    length = float(np.median(np.linalg.norm(edges[:, 1] - edges[:, 0], axis=1)))
    certificate = certify(deployed, contracted, tiles, target, _welded(contracted, length, configuration))
    return Numbers.of(certificate.rows, certificate.failures, target is not None, certificate.passed)


def _welded(points: np.ndarray, length: float, configuration: Configuration) -> np.ndarray:
    """Number the contracted points that are copies of one.

    They coincide only roughly, and some edges have collapsed: a distance that is too large joins the ends of these.
    """
    from analysis.sheet import coincident

    cell = find_cell(configuration.tessellation)
    pattern = tile_pattern(cell, rectangle_mask(cell, motion_of(cell).adjacency, *configuration.cells))
    for radius in RADII:
        found = coincident(points, radius * length)
        if found.max() < pattern.n_welded:
            break
    return found
