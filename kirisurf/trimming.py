"""Trimming: which tiles of an endless pattern make a sound sheet, inside an outline or as a rectangle."""

from __future__ import annotations

import numpy as np
import shapely
from jaxtyping import Bool, Float
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components

from kirisurf.adjacency import Adjacency
from kirisurf.loops import Loops
from kirisurf.unit_cell import UnitCell


def sound_tiles(mask: Bool[np.ndarray, "columns rows k"], adjacency: Adjacency) -> Bool[np.ndarray, "columns rows k"]:
    """Return the largest part of a mask of tiles that is a sheet.

    Every tile belongs to a complete ring round a hole (so that no tile dangles on one hinge), the tiles are connected
    by hinges, nothing is left open inside but what the pattern leaves open, and nowhere do parts of the sheet
    touch at a corner only.
    """
    # room for the outside all round
    reach = _reach(adjacency)
    mask = np.pad(mask, ((reach, reach), (reach, reach), (0, 0)))
    mask = _filled(mask, adjacency)
    for _ in range(mask.size + 1):
        whole = _largest(_ringed(mask, adjacency), adjacency)
        whole &= ~_pinches(whole, adjacency)
        if (whole == mask).all():
            break
        mask = _filled(whole, adjacency)
    return mask[reach:-reach, reach:-reach]


def rectangle_mask(cell: UnitCell, adjacency: Adjacency, columns: int, rows: int) -> Bool[np.ndarray, "_ _ k"]:
    """Return the tiles of a rectangle of columns x rows cells.

    Rows of cells that are sheared are shifted back by whole cells, so that every row lies within a cell of the first.
    Where a pattern leaves something open that a tile of the outer cells bounds, and no complete ring holds that tile,
    the ring is completed by tiles of the next cells, all along that side: published hexagon patterns begin with half
    a column more. (Patterns that close have straight sides, contracted; there nothing is added.)
    """
    along, up = cell.contracted_shifts
    shear = float(up @ along / (along @ along))
    reach = _reach(adjacency)
    inner = slice(reach, reach + rows)
    back = np.floor(np.arange(-reach, rows + reach) * shear + 1e-9).astype(int)
    first = int(back.max()) - back + reach
    mask = np.zeros((columns + int(np.ptp(back)) + 2 * reach, rows + 2 * reach, adjacency.n_tiles), bool)
    for row in range(reach, reach + rows):
        mask[first[row] : first[row] + columns, row] = True
    for column, row, tile in _completing(mask, adjacency):
        step = column - first[row]
        if 0 <= step < columns:
            mask[first[row] + np.arange(columns), row, tile] = True
        elif reach <= row < reach + rows:
            mask[first[inner] + step, np.arange(rows) + reach, tile] = True
        else:
            mask[column, row, tile] = True
    used = [np.flatnonzero(mask.any(axis=axes)) for axes in ((1, 2), (0, 2))]
    return mask[used[0][0] : used[0][-1] + 1, used[1][0] : used[1][-1] + 1]


def overlap_fractions(outline: shapely.Polygon, corners: Float[np.ndarray, "s 2"], tiles: Loops) -> np.ndarray:
    """Return the part of every polygon that lies inside the outline, (t,).

    Parameters
    ----------
    outline : shapely.Polygon
    corners : (s, 2)
        Polygon after polygon.
    tiles : Loops
        Their sizes; the indices are not read.
    """
    shapely.prepare(outline)
    fraction = np.zeros(len(tiles))
    sizes = tiles.sizes
    for size in np.unique(sizes):
        here = np.flatnonzero(sizes == size)
        polygons = shapely.polygons(corners[tiles.offsets[here][:, None] + np.arange(size)])
        inside = shapely.contains_properly(outline, polygons)
        fraction[here[inside]] = 1.0
        edge = shapely.intersects(outline, polygons) & ~inside
        common = shapely.area(shapely.intersection(polygons[edge], outline))
        fraction[here[edge]] = common / shapely.area(polygons[edge])
    return fraction


def _reach(adjacency: Adjacency) -> int:
    """Cells that one ring or corner spans in a direction."""
    around = [*(ring.tiles for ring in adjacency.rings), *(fan.tiles for fan in adjacency.fans)]
    return int(max(np.ptp(tiles[:, :2], axis=0).max() for tiles in around)) + 1


def _shifted(mask: np.ndarray, column: int, row: int) -> np.ndarray:
    """View or copy `out[c, r] = mask[c + column, r + row]`, False beyond the mask."""
    out = np.zeros_like(mask)
    columns, rows = mask.shape[:2]
    c = slice(max(0, -column), min(columns, columns - column))
    r = slice(max(0, -row), min(rows, rows - row))
    out[c, r] = mask[c.start + column : c.stop + column, r.start + row : r.stop + row]
    return out


def _ringed(mask: np.ndarray, adjacency: Adjacency) -> np.ndarray:
    """Tiles that belong to a complete ring."""
    result = np.zeros_like(mask)
    for ring in adjacency.rings:
        complete = np.ones(mask.shape[:2], bool)
        for column, row, tile in ring.tiles.tolist():
            complete &= _shifted(mask[:, :, tile], column, row)
        for column, row, tile in ring.tiles.tolist():
            result[:, :, tile] |= _shifted(complete, -column, -row)
    return result


def _components(mask: np.ndarray, neighbors: np.ndarray) -> np.ndarray:
    """Number of the connected part that every tile of a mask belongs to; see `Adjacency.sides` for neighbors."""
    number = np.arange(mask.size).reshape(mask.shape)
    starts, ends = [], []
    for tile, other, column, row in neighbors.tolist():
        if (tile, 0, 0) > (other, column, row):
            continue
        both = mask[:, :, tile] & _shifted(mask[:, :, other], column, row)
        here = number[:, :, tile][both]
        starts.append(here)
        ends.append(here + (column * mask.shape[1] + row) * mask.shape[2] + other - tile)
    start, end = np.concatenate(starts), np.concatenate(ends)
    graph = coo_matrix((np.ones(len(start), np.int8), (start, end)), shape=(mask.size, mask.size))
    return connected_components(graph, directed=False)[1].reshape(mask.shape)


def _largest(mask: np.ndarray, adjacency: Adjacency) -> np.ndarray:
    if not mask.any():
        return mask
    parts = _components(mask, adjacency.hinged)
    return mask & (parts == np.argmax(np.bincount(parts[mask])))


def _filled(mask: np.ndarray, adjacency: Adjacency) -> np.ndarray:
    """The mask with every gap that is not connected, across slits, to the first cell, which is outside."""
    parts = _components(~mask, adjacency.sides)
    outside = np.isin(parts, parts[0, 0])
    return mask | ~outside


def _pinches(mask: np.ndarray, adjacency: Adjacency) -> np.ndarray:
    """Tiles whose removal leaves one part of the sheet at every contracted vertex: of several, the largest."""
    pinched = np.zeros_like(mask)
    for fan in adjacency.fans:
        kept = np.stack([_shifted(mask[:, :, tile], column, row) for column, row, tile in fan.tiles.tolist()], axis=-1)
        ends = kept & ~(np.roll(kept, -1, axis=-1) & fan.joined)
        for column, row in np.argwhere((ends.sum(axis=-1) > 1) & ~kept.all(axis=-1)):
            for place in _lesser(kept[column, row], ends[column, row]):
                c, r, tile = fan.tiles[place]
                pinched[column + c, row + r, tile] = True
    return pinched


def _lesser(kept: np.ndarray, ends: np.ndarray) -> list[int]:
    """Places round a corner of all parts but the largest; of equal parts the last stays."""
    # begin after the end of a part
    first = int(np.flatnonzero(ends)[0]) + 1
    order = [*range(first, len(kept)), *range(first)]
    parts: list[list[int]] = [[]]
    for place in order:
        if kept[place]:
            parts[-1].append(place)
        if ends[place]:
            parts.append([])
    parts = sorted((part for part in parts if part), key=lambda part: (len(part), min(part)))
    return [place for part in parts[:-1] for place in part]


def _completing(mask: np.ndarray, adjacency: Adjacency) -> np.ndarray:
    """Tiles (column, row, tile) that complete a ring for every tile at an opening that has none."""
    added = np.zeros_like(mask)
    bare = mask & ~_ringed(mask, adjacency)
    for column, row, tile in np.argwhere(bare).tolist():
        best = None
        for ring in adjacency.rings:
            for c, r, _ in ring.tiles[ring.tiles[:, 2] == tile].tolist() if ring.is_open else ():
                around = ring.tiles + np.array([column - c, row - r, 0])
                missing = around[~(mask | added)[tuple(around.T)]]
                if 2 * len(missing) <= len(around) and (best is None or len(missing) < len(best)):
                    best = missing
        if best is not None:
            added[tuple(best.T)] = True
    return np.argwhere(added)
