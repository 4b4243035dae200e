"""How the tiles of a cell meet in the endless pattern: across slits, at hinges, round holes, at contracted corners."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Int

from kirisurf.arrays import frozen
from kirisurf.errors import UnusableError
from kirisurf.pattern import tile_pattern
from kirisurf.tessellation import Tessellation
from kirisurf.unit_cell import UnitCell

FARTHEST = 9
"""Cells in one direction that are looked at for a hole that closes."""


@dataclass(frozen=True, eq=False)
class Ring:
    """The tiles round one hole of the endless pattern, up to translation.

    Attributes
    ----------
    tiles : (r, 3)
        Cell (column, row) and number within the cell of every tile.
    is_open : bool
        Whether some of it stays open in the contracted sheet, by design.
    """

    tiles: Int[np.ndarray, "r 3"]
    is_open: bool


@dataclass(frozen=True, eq=False)
class Fan:
    """The tiles round one contracted vertex of the endless pattern, up to translation.

    Attributes
    ----------
    tiles : (r, 3)
        Cell (column, row) and number within the cell, counter-clockwise, the lowest tile first.
    joined : (r,) bool
        Whether the next tile follows across a slit, and not across an opening.
    """

    tiles: Int[np.ndarray, "r 3"]
    joined: Bool[np.ndarray, " r"]


@dataclass(frozen=True, eq=False)
class Adjacency:
    """Neighbors in the endless pattern of a cell.

    Attributes
    ----------
    n_tiles : int
        Tiles of a cell.
    hinges : (h, 6)
        Corners that are one vertex: tile, its corner, other tile, its corner, and column and row of the cell of the
        other from that of the first. Corners are positions in the cell's `tiles.indices`. Each pair once or twice.
    sides : (s, 4)
        Tiles on both sides of a slit: tile, other tile, column and row of its cell. Each pair both ways.
    rings : tuple of Ring
    fans : tuple of Fan
    """

    n_tiles: int
    hinges: Int[np.ndarray, "h 6"]
    sides: Int[np.ndarray, "s 4"]
    rings: tuple[Ring, ...]
    fans: tuple[Fan, ...]

    @cached_property
    def hinged(self) -> Int[np.ndarray, "_ 4"]:
        """Tiles that are hinged to each other, as in `sides`: across some slits of some patterns they are not."""
        return frozen(np.unique(self.hinges[:, [0, 2, 4, 5]], axis=0), np.int64)


def adjacency(cell: UnitCell) -> Adjacency:
    """Return how the tiles of a cell meet.

    Raises
    ------
    UnusableError
        Where the holes round a cell reach farther than `FARTHEST` cells.

    Examples
    --------
    >>> from kirisurf.unit_cell import quad_cell
    >>> [len(ring.tiles) for ring in adjacency(quad_cell()).rings]
    [4, 4, 4, 4]
    """
    corners = len(cell.tiles.indices)
    for reach in range(2, FARTHEST + 1):
        pattern = tile_pattern(cell, np.ones((2 * reach + 1, 2 * reach + 1), bool))
        rings, sides = _rings(pattern, reach)
        # every side of every tile bounds one hole: the classes of holes have as many sides as a cell has corners
        if sides == corners:
            return Adjacency(
                len(cell.tiles), _hinges(pattern, cell, reach), _sides(pattern, reach), rings, _fans(pattern, reach)
            )
    raise UnusableError(f"{cell.name}: expected holes that reach over at most {FARTHEST} cells, got larger ones")


def _rings(pattern: Tessellation, reach: int) -> tuple[tuple[Ring, ...], int]:
    """Classes of the closed holes that have a tile in the middle cell, and the number of their sides."""
    found: dict[bytes, tuple[Ring, int]] = {}
    for tiles, hole, opening in zip(pattern.hole_tiles, pattern.holes, pattern.openings, strict=True):
        around = pattern.cells[tiles]
        if not (around[:, :2] == reach).all(axis=1).any():
            continue
        around = around[np.lexsort((around[:, 0], around[:, 1], around[:, 2]))]
        around = around - [*around[0, :2], 0]
        found.setdefault(around.tobytes(), (Ring(frozen(around, np.int64), len(opening) > 0), len(hole)))
    return tuple(ring for ring, _ in found.values()), sum(size for _, size in found.values())


def _hinges(pattern: Tessellation, cell: UnitCell, reach: int) -> np.ndarray:
    vertex, owners = pattern.tiles.indices, pattern.tiles.owners
    place = cell.tiles.offsets[pattern.cells[owners, 2]] + np.arange(len(vertex)) - pattern.tiles.offsets[owners]
    order = np.argsort(vertex, kind="stable")
    rows = []
    for group in np.split(order, np.flatnonzero(np.diff(vertex[order])) + 1):
        inside = [k for k in group if (pattern.cells[owners[k], :2] == reach).all()]
        for first in inside:
            for other in group:
                if other != first:
                    (column, row, i), (c, r, j) = pattern.cells[owners[first]], pattern.cells[owners[other]]
                    rows.append((i, place[first], j, place[other], c - column, r - row))
    return frozen(np.array(rows).reshape(-1, 6), np.int64)


def _sides(pattern: Tessellation, reach: int) -> np.ndarray:
    edges = pattern.weld[pattern.tiles.edges]
    forward, backward = edges @ [pattern.n_welded, 1], edges @ [1, pattern.n_welded]
    _, here, there = np.intersect1d(forward, backward, return_indices=True)
    first, other = pattern.tiles.owners[here], pattern.tiles.owners[there]
    middle = (pattern.cells[first, :2] == reach).all(axis=1)
    a, b = pattern.cells[first[middle]], pattern.cells[other[middle]]
    return frozen(np.unique(np.column_stack([a[:, 2], b[:, 2], b[:, :2] - a[:, :2]]), axis=0), np.int64)


def _fans(pattern: Tessellation, reach: int) -> tuple[Fan, ...]:
    weld, owners, corners = pattern.weld, pattern.tiles.owners, pattern.corners
    middle = (pattern.cells[owners, :2] == reach).all(axis=1)
    centers = np.array([pattern.contracted[tile].mean(axis=0) for tile in pattern.tiles])
    at = weld[corners[:, 1]]
    order = np.argsort(at, kind="stable")
    starts = np.searchsorted(at[order], np.arange(pattern.n_welded + 1))
    found: dict[bytes, Fan] = {}
    for vertex in np.unique(at[middle]):
        here = order[starts[vertex] : starts[vertex + 1]]
        step = pattern.contracted[corners[here, 2]] - pattern.contracted[corners[here, 1]]
        here = here[np.argsort(np.arctan2(step[:, 1], step[:, 0]), kind="stable")]
        # counter-clockwise about the vertex a tile ends with its side from the previous corner
        joined = weld[corners[here, 0]] == weld[corners[np.roll(here, -1), 2]]
        place = centers[owners[here]]
        lowest = int(np.lexsort((np.round(place[:, 0], 9), np.round(place[:, 1], 9)))[0])
        tiles, joined = pattern.cells[owners[np.roll(here, -lowest)]], np.roll(joined, -lowest)
        tiles = tiles - [*tiles[0, :2], 0]
        found.setdefault(tiles.tobytes(), Fan(frozen(tiles, np.int64), frozen(joined, np.bool_)))
    return tuple(found.values())
