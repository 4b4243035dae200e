"""What makes a few polygons a unit cell: congruent tiles that fill the plane closed and stay apart opened."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
import shapely
from jaxtyping import Float
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from scipy.spatial import cKDTree

from kirisurf.errors import UnusableError
from kirisurf.pattern import tile_pattern
from kirisurf.tessellation import Tessellation
from kirisurf.unit_cell import UnitCell

TOLERANCE = 1e-7
"""Distance up to which points count as equal, and area as nothing; the contracted cell has area 1."""
_FARTHEST = 20
_AT_ONCE = 10_000
_SHORTEST = 1e-4
_EXACT = "write exact values, such as sqrt(3)/2"


def check_cell(cell: UnitCell, tile_places: Sequence[str], opening_places: Sequence[str], place: str) -> None:
    """Raise where a cell is not one that can be cut from a sheet and opened.

    In this order: translations that span the plane; tiles that are simple, counter-clockwise and congruent in both
    states; no overlap in either state, whatever the cells; tiles and openings that fill the contracted plane, side
    to side; neighbors that are not hinged at both ends of a side; a sheet that holds together.

    Parameters
    ----------
    cell : UnitCell
        With contracted area 1, see :meth:`UnitCell.normalized`.
    tile_places, opening_places : sequence of str
        Where every tile and every opening stands, to begin a message with.
    place : str
        Where the cell stands.

    Raises
    ------
    UnusableError
        Where one of these does not hold; the message begins with the place and says what was expected.
    """
    _check_shifts(cell, place)
    for k, tile in enumerate(cell.tiles):
        _check_tile(cell.contracted[tile], cell.deployed[tile], tile_places[k])
    for opening, where in zip(cell.openings, opening_places, strict=True):
        _check_simple(opening, "contracted", where)
    contracted = [cell.contracted[tile] for tile in cell.tiles] + list(cell.openings)
    places = [*tile_places, *opening_places]
    _check_apart(contracted, cell.contracted_shifts, "contracted", places)
    _check_apart([cell.deployed[tile] for tile in cell.tiles], cell.deployed_shifts, "deployed", places)
    filled = sum(shapely.Polygon(polygon).area for polygon in contracted)
    if abs(filled - cell.area) > 10 * TOLERANCE * len(contracted):
        raise UnusableError(
            f"{place}: expected tiles and openings that fill the contracted cell, got {100 * filled / cell.area:.6g} % "
            "of its area (what stays open by design is declared by lines 'opening')"
        )
    _check_sides(contracted, cell.contracted_shifts, places)
    _check_hinges(tile_pattern(cell, np.ones((5, 5), bool)), tile_places, place)


def _check_shifts(cell: UnitCell, place: str) -> None:
    for name, shifts in (("contracted", cell.contracted_shifts), ("deployed", cell.deployed_shifts)):
        size = np.linalg.norm(shifts, axis=1)
        if not np.linalg.det(shifts) > 1e-3 * size[0] * size[1]:
            raise UnusableError(
                f"{place}: expected {name} translations of which 'rows' points to the left of 'columns', "
                f"got directions {np.rad2deg(np.arctan2(shifts[:, 1], shifts[:, 0])).round(3).tolist()} degrees"
            )


def _check_simple(corners: Float[np.ndarray, "k 2"], state: str, place: str) -> None:
    shortest = float(np.linalg.norm(corners - np.roll(corners, 1, axis=0), axis=1).min())
    if shortest < _SHORTEST:
        raise UnusableError(f"{place}: expected sides longer than 1/10000 of the cell, got {shortest:.2g} {state}")
    ring = shapely.LinearRing(corners)
    if not ring.is_simple or shapely.Polygon(corners).area <= TOLERANCE:
        raise UnusableError(f"{place}: expected a polygon that does not cross or touch itself, got one {state}")
    if not ring.is_ccw:
        raise UnusableError(f"{place}: expected corners in counter-clockwise order, got clockwise {state}")


def _check_tile(contracted: Float[np.ndarray, "k 2"], deployed: Float[np.ndarray, "k 2"], place: str) -> None:
    _check_simple(contracted, "contracted", place)
    _check_simple(deployed, "deployed", place)
    # complex numbers: the rotation that fits best is the direction of sum conj(a) b
    a, b = (p @ np.array([1, 1j]) for p in (contracted - contracted.mean(axis=0), deployed - deployed.mean(axis=0)))
    moment = (a.conj() * b).sum()
    gap = float(np.abs(b - a * moment / abs(moment)).max()) if moment else np.inf
    if gap > TOLERANCE:
        raise UnusableError(
            f"{place}: expected a tile of the same shape in both states, got corners that differ by {gap:.2g} of "
            f"the cell's size ({_EXACT})"
        )


def _check_apart(
    polygons: Sequence[np.ndarray], shifts: Float[np.ndarray, "2 2"], state: str, places: Sequence[str]
) -> None:
    """Every polygon of one cell against the polygons of all cells that can reach it."""
    shapes = np.array([shapely.Polygon(corners) for corners in polygons])
    every = np.concatenate(polygons)
    reach = np.ptp(every, axis=0)
    # |integers| <= |inverse| |difference|: which cells have a bounding box that meets this cell's
    far = np.nan_to_num(np.ceil(np.abs(np.linalg.inv(shifts)).T @ reach), nan=np.inf)
    if not far.max() <= _FARTHEST:
        raise UnusableError(
            f"{places[0]}: expected {state} tiles of one cell near each other, got some {far.max():g} cells apart"
        )
    far = far.astype(int)
    cells = np.stack(np.meshgrid(*(np.arange(-k, k + 1) for k in far), indexing="ij"), axis=-1).reshape(-1, 2)
    tree = shapely.STRtree(shapes)
    for cell in cells[np.argsort(np.abs(cells).sum(axis=1), kind="stable")]:  # the nearest first: there most overlap
        moved = shapely.transform(shapes, lambda p, by=cell @ shifts: p + by)
        i, j = tree.query(moved, predicate="intersects")
        i, j = (i, j) if cell.any() else (i[i < j], j[i < j])
        for k in range(0, len(i), _AT_ONCE):
            a, b = i[k : k + _AT_ONCE], j[k : k + _AT_ONCE]
            overlaps = np.flatnonzero(shapely.area(shapely.intersection(shapes[b], moved[a])) > 10 * TOLERANCE)
            if len(overlaps):
                one, two = places[b[overlaps[0]]], places[a[overlaps[0]]]
                other = "" if not cell.any() else f", {cell[0]} columns and {cell[1]} rows on"
                raise UnusableError(f"{one}: expected no overlap, got one with {two}{other}, {state}")


def _check_sides(polygons: Sequence[np.ndarray], shifts: Float[np.ndarray, "2 2"], places: Sequence[str]) -> None:
    """Every contracted side is one side of one other polygon, the other way round."""
    start, end = np.concatenate(polygons), np.concatenate([np.roll(p, -1, axis=0) for p in polygons])
    folded = ((start + end) / 2) @ np.linalg.inv(shifts)
    folded = np.mod(np.mod(folded, 1.0), 1.0)
    radius = 10 * TOLERANCE
    i, j = cKDTree(folded, boxsize=1.0).query_pairs(radius, output_type="ndarray").T
    opposite = np.linalg.norm((end - start)[i] + (end - start)[j], axis=1) <= radius
    partners = np.bincount(np.concatenate([i[opposite], j[opposite]]), minlength=len(start))
    if (partners != 1).any():
        k = int(np.flatnonzero(partners != 1)[0])
        sizes = [len(p) for p in polygons]
        which = int(np.searchsorted(np.cumsum(sizes), k, side="right"))
        side = k - sum(sizes[:which])
        raise UnusableError(
            f"{places[which]}: expected sides that meet whole sides, contracted, got corner {side + 1} to corner "
            f"{(side + 1) % sizes[which] + 1} with {partners[k] or 'no'} partner"
            f"{'s' if partners[k] else ' (a corner is needed wherever a corner of another tile lies on a side)'}"
        )


def _check_hinges(pattern: Tessellation, tile_places: Sequence[str], place: str) -> None:
    glued = np.flatnonzero((pattern.edge_pairs[:, 0] == pattern.edge_pairs[:, 1]).all(axis=1))
    if len(glued):
        a, b = pattern.edge_pairs[glued[0], 0]
        edges = pattern.tiles.edges
        tile = pattern.tiles.owners[np.flatnonzero((edges[:, 0] == a) & (edges[:, 1] == b))[0]]
        raise UnusableError(
            f"{tile_places[pattern.cells[tile, 2]]}: expected a tile that is free to turn, got one that is hinged to "
            "another at both ends of a side (make them one tile)"
        )
    n, owners = pattern.n_vertices, pattern.tiles.owners
    graph = coo_matrix(
        (np.ones(len(owners)), (pattern.tiles.indices, n + owners)), shape=(n + pattern.n_tiles, n + pattern.n_tiles)
    )
    labels = connected_components(graph, directed=False)[1][n:]
    # the rim of a patch may come loose; its middle may not
    middle = (np.abs(pattern.cells[:, :2] - 2) <= 1).all(axis=1)
    loose = middle & (labels != np.bincount(labels[middle]).argmax())
    if loose.any():
        where = tile_places[pattern.cells[np.flatnonzero(loose)[0], 2]]
        raise UnusableError(
            f"{where}: expected a sheet that hinges hold together, got a tile apart from the others ({_EXACT}: hinged "
            "corners are the same point in both states)"
        )
