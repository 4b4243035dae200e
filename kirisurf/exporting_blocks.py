"""A run as several meshes in one: named blocks (VTM), and the opening sheet as a time series (PVD)."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from kirisurf.field_units import described_file
from kirisurf.formats import source
from kirisurf.formats.blocks import write_pvd, write_vtm
from kirisurf.formats.writing import vtp_bytes
from kirisurf.judging import deployment
from kirisurf.loops import Loops
from kirisurf.runs import Run
from kirisurf.runs.run import RUN_BLOCKS

if TYPE_CHECKING:
    from analysis.frames import Frame

FRAMES = 31
"""Frames of a time series unless asked: a second of film."""
MOST_FRAMES = 1000
LAID_BENEATH = "contracted, moved to lie beneath the deployed"
INTERPOLATED = "interpolated between the contracted and the deployed state: for the eye, not a mechanism"


def write_blocks(run: Run, path: Path) -> None:
    """Write tiles, holes, target and contracted tiles of a run as the named blocks of one file.

    The blocks are the files of the run, byte for byte.

    Raises
    ------
    UnreadableError
        Where a file of the run is gone.
    OutputError
        Where a file cannot be written; what was there is untouched.
    """
    write_vtm(path, {name: source.load(run.folder / file).content for name, file in RUN_BLOCKS.items()})


def write_series(run: Run, path: Path, n_frames: int = FRAMES) -> None:
    """Write the sheet of a run opening: time 0 is contracted, 1 deployed; tiles and holes are the parts of a frame.

    Every frame carries what is measured on itself: `isometry` of the tiles, how far from rigid the interpolation
    leaves them, over the median tile edge, and `opening_angle` of the holes.

    Parameters
    ----------
    run : Run
    path : path
    n_frames : int
        At least 2.

    Raises
    ------
    OutputError
        Where a file cannot be written; what was there is untouched.
    """
    shares = np.linspace(0.0, 1.0, n_frames).tolist()
    write_pvd(path, shares, ("tiles", "holes"), _frames(run, shares))


def _frames(run: Run, shares: list[float]) -> Iterator[tuple[bytes, bytes]]:
    tessellation = run.tessellation
    for frame in deployment(tessellation, run.contracted, run.deployed, shares):
        yield (
            _encoded(run, frame, tessellation.tiles, "isometry", frame.isometry),
            _encoded(run, frame, tessellation.holes, "opening_angle", frame.opening_angle),
        )


def _encoded(run: Run, frame: Frame, loops: Loops, name: str, values: np.ndarray) -> bytes:
    state = {0.0: LAID_BENEATH, 1.0: "deployed"}.get(frame.share, INTERPOLATED)
    about = described_file(state, [name], run.spec.units, run.origin)
    return vtp_bytes(frame.points, loops, None, {name: values}, {**about, "share": np.array([frame.share])})
