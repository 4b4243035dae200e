"""Items: frozen buffers of what is drawn (faces, lines), made from a target or a sheet by pure functions."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from kirisurf.arrays import frozen
from kirisurf.loops import Loops
from kirisurf.surface import Surface
from viewers import theme
from viewers.fields import Field
from viewers.sheet import Sheet

# Layers, in picture diagonals toward the eye. The projection is parallel: nothing moves in the picture,
# and tiles a little below the target are not swallowed by it.
BEHIND, BETWEEN, FRONT, LINES = -0.04, -0.006, 0.0, 0.003


@dataclass(frozen=True, eq=False)
class Item:
    """One drawable thing.

    Attributes
    ----------
    name : str
        target, rim, tiles, tile edges, holes, hole outlines or vertices.
    kind : str
        faces, lines or dots.
    points : (n, 3)
    loops : Loops
        Polygons of faces, polylines of lines (not closed by themselves), one index each of dots.
    color : str
        Color where no field is given.
    field : Field or None
        Values per point (where = vertex) or per loop.
    normals : (n, 3) or None
        For smooth shading; faces are flat without.
    width : float
        Of lines and dots, in picture points.
    layer : float
        Shift toward the eye, in diagonals of the picture.
    """

    name: str
    kind: str
    points: Float[np.ndarray, "n 3"]
    loops: Loops
    color: str
    field: Field | None = None
    normals: Float[np.ndarray, "n 3"] | None = None
    width: float = theme.EDGE_WIDTH
    layer: float = FRONT


def target_items(surface: Surface, layer: float = FRONT) -> tuple[Item, ...]:
    """The target's faces and its rim."""
    faces = Loops(
        frozen(np.arange(0, 3 * len(surface.faces) + 1, 3), np.int64), frozen(surface.faces.ravel(), np.int64)
    )
    rim = segments(surface.boundary_edges)
    return (
        Item("target", "faces", surface.vertices, faces, theme.TARGET, normals=surface.normals, layer=layer),
        Item("rim", "lines", surface.vertices, rim, theme.TARGET_RIM, width=theme.RIM_WIDTH, layer=layer + LINES),
    )


def sheet_items(
    sheet: Sheet, points: np.ndarray, coloring: Field | None = None, *, holes: bool = True
) -> tuple[Item, ...]:
    """Tiles, their edges and, if wanted, holes, with the vertices at `points` (n, 3)."""
    points = frozen(points)
    on_holes = coloring if coloring is not None and coloring.where == "hole" else None
    on_tiles = coloring if coloring is not None and coloring.where != "hole" else None
    plain = theme.TILE if coloring is None else theme.GHOST_TILE
    edge = theme.TILE_EDGE if coloring is None else theme.GHOST_EDGE
    items = [Item("tiles", "faces", points, sheet.tiles, plain, on_tiles)]
    if holes and len(sheet.holes):
        grid = sheet.patches if np.shares_memory(points, sheet.deployed) or _same(points, sheet.deployed) else None
        items.append(hole_item(points, sheet.holes, grid, on_holes))
    # Lines of many small tiles would otherwise darken the colors between them.
    width = theme.EDGE_WIDTH * min(1.0, max(0.4, (150.0 / max(len(sheet.tiles), 1)) ** 0.5))
    items.append(Item("tile edges", "lines", points, segments(sheet.tiles.edges), edge, width=width, layer=LINES))
    return tuple(items)


def hole_item(points: np.ndarray, holes: Loops, patches: np.ndarray | None, coloring: Field | None) -> Item:
    """Holes as faces: curved patches where a grid of points is given, else the polygons of their vertices.

    Parameters
    ----------
    points : (n, 3)
    holes : Loops
    patches : (h, k, m, 3) or None
        NaN for a hole without a patch, which is drawn as its polygon.
    coloring : Field or None
        One value per hole.
    """
    if patches is None:
        return Item("holes", "faces", frozen(points), holes, theme.NO_VALUE, coloring, layer=BETWEEN)
    h, k, m, _ = patches.shape
    curved = np.isfinite(patches).reshape(h, -1).all(axis=1)
    which = np.flatnonzero(curved)
    corner = (np.arange(k - 1)[:, None] * m + np.arange(m - 1)).ravel()
    quads = corner[:, None] + np.array([0, m, m + 1, 1])
    quads = (quads[None] + (np.arange(len(which)) * k * m)[:, None, None]).reshape(-1, 4)
    polygons = holes.subset(np.flatnonzero(~curved))
    used = patches[which].reshape(-1, 3)
    everything = np.vstack([used, points])
    indices = np.concatenate([quads.ravel(), polygons.indices + len(used)])
    offsets = np.concatenate([np.arange(len(quads)) * 4, polygons.offsets + 4 * len(quads)])
    loops = Loops(frozen(offsets, np.int64), frozen(indices, np.int64))
    if coloring is not None:
        values = np.concatenate([np.repeat(coloring.values[which], len(corner)), coloring.values[~curved]])
        coloring = replace(coloring, values=frozen(values))
    return Item("holes", "faces", frozen(everything), loops, theme.NO_VALUE, coloring, layer=BETWEEN)


def segments(pairs: np.ndarray) -> Loops:
    """Return lines of two indices each from (s, 2) int."""
    return Loops(frozen(np.arange(0, 2 * len(pairs) + 1, 2), np.int64), frozen(np.asarray(pairs).ravel(), np.int64))


def _same(a: np.ndarray, b: np.ndarray) -> bool:
    return a.shape == b.shape and bool((a == b).all())
