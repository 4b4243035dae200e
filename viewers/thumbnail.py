"""Thumbnails: a small picture of a deployed sheet, drawn without OpenGL, for tables of many runs."""

from __future__ import annotations

import io

import numpy as np
from numpy.typing import ArrayLike
from PIL import Image

from kirisurf.arrays import checked
from kirisurf.errors import ParameterError, UnusableError
from kirisurf.loops import Loops
from viewers.framing import fit_frame
from viewers.painting import line_of_sight, painted

SIZE = (240, 180)
_COLORS = 32
_MARGIN = 0.05


def thumbnail(points: ArrayLike, tiles: Loops, holes: Loops | None = None, size: tuple[int, int] = SIZE) -> bytes:
    """Draw a deployed sheet as a small picture.

    Tiles and holes are painted from the farthest to the nearest, in parallel projection, shaded by the angle between
    their normal and a fixed light (Lambert). A flat sheet is seen along its normal, any other from where
    `viewers.framing.choose_view` looks at a target. Neither the unit of length nor the place changes the picture.

    Parameters
    ----------
    points : (n, 3)
        Deployed vertices, in any unit.
    tiles : Loops
    holes : Loops, optional
        Drawn in the color of a target that shows through; left open without them.
    size : (int, int)
        Width and height in pixels, 16 to 4096 each.

    Returns
    -------
    bytes
        A PNG file with a palette, on white: the same bytes for the same sheet.

    Raises
    ------
    ParameterError
        Where there is no tile, a loop has less than three corners or names a point that is not there, a point is not
        finite, all points of tiles coincide, or the size is out of range.

    Examples
    --------
    >>> square = Loops.from_lists([[0, 1, 2, 3]])
    >>> thumbnail([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], square)[1:4]
    b'PNG'
    """
    width, height = _checked_size(size)
    local, tiles, holes = _checked_sheet(points, tiles, holes)
    view = line_of_sight(local, tiles)
    frame = fit_frame(view, local[tiles.indices], width / height, _MARGIN)
    picture = painted(local, tiles, holes, view, frame, (width, height))
    small = picture.quantize(_COLORS, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    file = io.BytesIO()
    small.save(file, "PNG", optimize=True)
    return file.getvalue()


def _checked_size(size: tuple[int, int]) -> tuple[int, int]:
    if len(size) != 2 or not all(isinstance(n, int) and 16 <= n <= 4096 for n in size):
        raise ParameterError(f"size of a thumbnail: expected two whole numbers from 16 to 4096, got {size}")
    return size


def _checked_sheet(points: ArrayLike, tiles: Loops, holes: Loops | None) -> tuple[np.ndarray, Loops, Loops]:
    """Return points in a frame of their own (middle of the tiles at 0, longest extent 1), tiles, and holes."""
    try:
        place = checked(points, "points of a thumbnail", (None, 3))
    except UnusableError as problem:
        raise ParameterError(str(problem)) from None
    holes = Loops.from_lists([]) if holes is None else holes
    if not len(tiles):
        raise ParameterError("thumbnail: expected at least one tile, got none")
    for name, loops in (("tiles", tiles), ("holes", holes)):
        if len(loops) and loops.sizes.min() < 3:
            raise ParameterError(f"{name} of a thumbnail: expected at least 3 corners, got {int(loops.sizes.min())}")
        if len(loops) and (loops.indices.min() < 0 or loops.indices.max() >= len(place)):
            found = f"{int(loops.indices.min())} to {int(loops.indices.max())}"
            raise ParameterError(f"{name} of a thumbnail: expected vertices 0 to {len(place) - 1}, got {found}")
    # halves: the difference of two large numbers may be too large for a float, that of their halves is not
    low, high = 0.5 * place[tiles.indices].min(axis=0), 0.5 * place[tiles.indices].max(axis=0)
    extent = float((high - low).max())
    if not extent > 0:
        raise ParameterError(f"points of a thumbnail: expected tiles of some size, got all of them at {place[0]}")
    return 0.5 * (0.5 * place - 0.5 * (low + high)) / extent, tiles, holes
