"""Thumbnails: a small picture of a deployed sheet, drawn without OpenGL, for tables of many runs."""

from __future__ import annotations

import io

import numpy as np
from jaxtyping import Float
from numpy.typing import ArrayLike
from PIL import Image, ImageColor, ImageDraw

from analysis.polygons import area_vectors, unit
from kirisurf.arrays import checked
from kirisurf.errors import ParameterError, UnusableError
from kirisurf.formats.triangulation import triangulated
from kirisurf.loops import Loops
from kirisurf.surface import Surface
from viewers import theme
from viewers.framing import FROM_ABOVE, View, choose_view, fit_frame

SIZE = (240, 180)
_FINER = 4
_COLORS = 32
_MARGIN = 0.05
_FLAT = 1e-3
_LIGHT = unit(np.array([-0.4, 0.55, 1.0]))
_AMBIENT = 0.34
_BRIGHTEST = 1.12
# of what turns its back to the eye: the inside of a fold has to tell from the outside
_BEHIND = 0.82
# pixels: tiles whose median edge is shorter melt into a tone, larger ones have sharp outlines
_NO_OUTLINE, _FULL_OUTLINE = 2.5, 11.0


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
    view = _view(local, tiles)
    frame = fit_frame(view, local[tiles.indices], width / height, _MARGIN)
    scale = 0.5 * height * _FINER / frame.half_height
    seen = (local - np.array(frame.center)) @ view.axes.T
    pixels = np.rint(seen[:, :2] * (scale, -scale) + (0.5 * width * _FINER, 0.5 * height * _FINER))
    picture = Image.new("RGB", (width * _FINER, height * _FINER), theme.PAPER)
    _paint(ImageDraw.Draw(picture), pixels.astype(np.int64), local, seen[:, 2], tiles, holes, view)
    small = picture.reduce(_FINER).quantize(_COLORS, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
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


def _view(local: Float[np.ndarray, "n 3"], tiles: Loops) -> View:
    """Return the line of sight: along the normal of a flat sheet, else as pictures of a target look at it."""
    corners = local[tiles.indices]
    spread, axes = np.linalg.eigh(np.cov(corners.T))
    if spread[0] > _FLAT**2 * spread[2]:
        return choose_view(Surface.from_arrays(local, triangulated(local, tiles)[0]))
    normal = axes[:, 0]
    if spread[1] <= _FLAT**2 * spread[2] or abs(normal[2]) > 1 - 1e-6:
        return FROM_ABOVE
    facing = area_vectors(local, tiles).sum(axis=0)
    side = normal[2] if abs(normal[2]) > 0.5 else float(normal @ facing) or 1.0
    normal = normal if side > 0 else -normal
    return View((float(normal[0]), float(normal[1]), float(normal[2])), (0.0, 0.0, 1.0))


def _paint(
    canvas: ImageDraw.ImageDraw,
    pixels: np.ndarray,
    local: np.ndarray,
    nearness: np.ndarray,
    tiles: Loops,
    holes: Loops,
    view: View,
) -> None:
    """Paint all polygons, the farthest first; a hole before the tiles round it, so that their outlines stay whole."""
    edges = tiles.edges
    length = float(np.median(np.linalg.norm(pixels[edges[:, 1]] - pixels[edges[:, 0]], axis=1))) / _FINER
    behind = float(np.median(np.linalg.norm(local[edges[:, 1]] - local[edges[:, 0]], axis=1)))
    fill = np.vstack([_shades(local, holes, theme.TARGET, view), _shades(local, tiles, theme.TILE, view)])
    depth = np.concatenate([_means(nearness, holes) - behind, _means(nearness, tiles)])
    strength = np.clip((length - _NO_OUTLINE) / (_FULL_OUTLINE - _NO_OUTLINE), 0.0, 1.0)
    ink = fill + strength * (np.array(ImageColor.getrgb(theme.TILE_EDGE)) - fill)
    width = int(np.clip(round(_FINER * length / 18), 1, 3))
    fills, inks = (list(map(tuple, np.rint(each).astype(int).tolist())) for each in (fill, ink))
    corners = [pixels[loops.indices].ravel().tolist() for loops in (holes, tiles)]
    ends = [(2 * loops.offsets).tolist() for loops in (holes, tiles)]
    for k in np.argsort(depth, kind="stable").tolist():
        kind, row = (0, k) if k < len(holes) else (1, k - len(holes))
        polygon = corners[kind][ends[kind][row] : ends[kind][row + 1]]
        if kind:
            canvas.polygon(polygon, fill=fills[k], outline=inks[k], width=width)
        else:
            canvas.polygon(polygon, fill=fills[k])


def _means(values: Float[np.ndarray, " n"], loops: Loops) -> Float[np.ndarray, " t"]:
    return np.add.reduceat(values[loops.indices], loops.offsets[:-1]) / loops.sizes if len(loops) else np.zeros(0)


def _shades(local: Float[np.ndarray, "n 3"], loops: Loops, color: str, view: View) -> Float[np.ndarray, "t 3"]:
    """Return the colors of polygons, brighter the more they face the light."""
    areas = area_vectors(local, loops)
    normals = unit(areas) @ view.axes.T
    # what most of the sheet shows is its front, whichever way its loops run
    front = float(np.sign(areas.sum(axis=0) @ view.axes[2])) or 1.0
    behind = normals[:, 2] * front < 0
    toward = normals * np.where(normals[:, 2:] < 0, -1.0, 1.0)
    light = _AMBIENT + (_BRIGHTEST - _AMBIENT) * np.clip(toward @ _LIGHT, 0.0, None)
    light = np.where(behind, _BEHIND, 1.0) * np.minimum(light, 1.0)
    return light[:, None] * np.array(ImageColor.getrgb(color))
