"""Painting: polygons of a sheet from the farthest to the nearest, shaded, in parallel projection, without OpenGL."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float
from PIL import Image, ImageColor, ImageDraw

from analysis.polygons import area_vectors, unit
from kirisurf.formats.triangulation import triangulated
from kirisurf.loops import Loops
from kirisurf.surface import Surface
from viewers import theme
from viewers.framing import FROM_ABOVE, Frame, View, choose_view

_FINER = 4
_FLAT = 1e-3
_LIGHT = unit(np.array([-0.4, 0.55, 1.0]))
_AMBIENT = 0.34
_BRIGHTEST = 1.12
# of what turns its back to the eye: the inside of a fold has to tell from the outside
_BEHIND = 0.82
# pixels: tiles whose median edge is shorter melt into a tone, larger ones have sharp outlines
_NO_OUTLINE, _FULL_OUTLINE = 2.5, 11.0


def painted(
    local: Float[np.ndarray, "n 3"],
    tiles: Loops,
    holes: Loops,
    view: View,
    frame: Frame,
    size: tuple[int, int],
    colors: Float[np.ndarray, "t 3"] | None = None,
) -> Image.Image:
    """Paint tiles and holes, shaded by the angle between their normal and a fixed light (Lambert), on white.

    Parameters
    ----------
    local : (n, 3)
        Vertices near the origin.
    tiles : Loops
    holes : Loops
        Painted in the color of a target that shows through.
    view : View
    frame : Frame
    size : (int, int)
        Width and height in pixels.
    colors : (t, 3), optional
        Red, green and blue of every tile in full light, 0 to 255; by default those of paper.

    Returns
    -------
    Image
        RGB, of that size.
    """
    width, height = size
    scale = 0.5 * height * _FINER / frame.half_height
    seen = (local - np.array(frame.center)) @ view.axes.T
    pixels = np.rint(seen[:, :2] * (scale, -scale) + (0.5 * width * _FINER, 0.5 * height * _FINER))
    picture = Image.new("RGB", (width * _FINER, height * _FINER), theme.PAPER)
    paper = np.array(ImageColor.getrgb(theme.TILE), float) if colors is None else colors
    _paint(ImageDraw.Draw(picture), pixels.astype(np.int64), local, seen[:, 2], tiles, holes, view, paper)
    return picture.reduce(_FINER)


def line_of_sight(local: Float[np.ndarray, "n 3"], tiles: Loops) -> View:
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
    paper: np.ndarray,
) -> None:
    """Paint all polygons, the farthest first; a hole before the tiles round it, so that their outlines stay whole."""
    edges = tiles.edges
    length = float(np.median(np.linalg.norm(pixels[edges[:, 1]] - pixels[edges[:, 0]], axis=1))) / _FINER
    behind = float(np.median(np.linalg.norm(local[edges[:, 1]] - local[edges[:, 0]], axis=1)))
    target = np.array(ImageColor.getrgb(theme.TARGET))
    fill = np.vstack([_light(local, holes, view) * target, _light(local, tiles, view) * paper])
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


def _light(local: Float[np.ndarray, "n 3"], loops: Loops, view: View) -> Float[np.ndarray, "t 1"]:
    """Return the brightness of polygons: the more they face the light, the brighter."""
    areas = area_vectors(local, loops)
    normals = unit(areas) @ view.axes.T
    # what most of the sheet shows is its front, whichever way its loops run
    front = float(np.sign(areas.sum(axis=0) @ view.axes[2])) or 1.0
    behind = normals[:, 2] * front < 0
    toward = normals * np.where(normals[:, 2:] < 0, -1.0, 1.0)
    light = _AMBIENT + (_BRIGHTEST - _AMBIENT) * np.clip(toward @ _LIGHT, 0.0, None)
    return (np.where(behind, _BEHIND, 1.0) * np.minimum(light, 1.0))[:, None]
