"""The flat sheet as a solid for a 3-D printer: thick tiles, and thin ligaments (living hinges) between them.

The plane is divided into tiles, ligaments and slits of a visible width; every part becomes a prism on the
ground plane, and walls stand wherever two neighboring parts differ in height. All corners lie on one grid
that single precision holds exactly, so that the parts share them exactly, and the solid is watertight.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import shapely
from jaxtyping import Float, Int
from scipy.sparse import coo_matrix
from scipy.sparse.csgraph import connected_components
from shapely import MultiLineString, Polygon

from kirisurf.arrays import frozen
from kirisurf.contours import contours, welded_points
from kirisurf.cuts import cuts
from kirisurf.errors import ParameterError, UnusableError
from kirisurf.tessellation import Tessellation

_GRID_BITS = 22  # of the 24 that single precision has
_ARC_SEGMENTS = 4  # of a quarter turn, at the round end of a slit
_LEAST_GAP = 64  # grid steps


@dataclass(frozen=True, eq=False)
class Solid:
    """A watertight solid, standing on z = 0, its lowest x and y at 0.

    Attributes
    ----------
    vertices : (v, 3)
    triangles : (f, 3)
        Counter-clockwise seen from outside.
    tile_area, ligament_area : float
        Areas seen from above.
    n_tiles : int
    n_pieces : int
        Number of connected parts of the solid: 1 where every tile hangs on the rest.
    warnings : tuple of str
    """

    vertices: Float[np.ndarray, "v 3"]
    triangles: Int[np.ndarray, "f 3"]
    tile_area: float
    ligament_area: float
    n_tiles: int
    n_pieces: int
    warnings: tuple[str, ...] = ()

    @property
    def corners(self) -> np.ndarray:
        """Corners (f, 3, 3) of every triangle."""
        return self.vertices[self.triangles]

    @property
    def volume(self) -> float:
        """Volume by the divergence theorem."""
        a, b, c = self.corners.swapaxes(0, 1)
        return float(np.einsum("ij,ij->i", a, np.cross(b, c)).sum() / 6)


def solid(
    tessellation: Tessellation,
    contracted: np.ndarray,
    thickness: float,
    hinge_width: float | None = None,
    hinge_thickness: float | None = None,
    gap: float | None = None,
) -> Solid:
    """Return the contracted sheet as one watertight solid.

    Parameters
    ----------
    tessellation : Tessellation
        Tiles of any number of corners, convex or not.
    contracted : (n, 2)
    thickness : float
        Height of the tiles, in the units of the points.
    hinge_width : float, optional
        Of the ligaments, as in :func:`kirisurf.cuts.cuts`.
    hinge_thickness : float, optional
        Height of the ligaments; by default a third of the thickness.
    gap : float, optional
        Width of the slits; by default half of the hinge width. Both tiles lose half of it.

    Raises
    ------
    ParameterError
        Where a length is out of range, or the gap leaves nothing of a tile.
    UnusableError
        Where parts of the solid would touch along an edge only.

    Examples
    --------
    >>> from kirisurf.pattern import quad_pattern
    >>> pattern = quad_pattern(2, 2)
    >>> made = solid(pattern, 10 * pattern.contracted, 1.0, 0.8)
    >>> made.n_tiles, made.n_pieces
    (16, 1)
    """
    if not (np.isfinite(thickness) and thickness > 0):
        raise ParameterError(f"--thickness: expected a number above 0, got {thickness:.6g}")
    low = thickness / 3 if hinge_thickness is None else float(hinge_thickness)
    if not (np.isfinite(low) and 0 < low <= thickness):
        raise ParameterError(f"--hinge-thickness: expected above 0 and at most {thickness:.6g}, got {low:.6g}")
    width = cuts(tessellation, contracted, hinge_width).hinge_width
    gap = 0.5 * width if gap is None else float(gap)
    points = welded_points(tessellation, contracted)
    size = float(np.ptp(points, axis=0).max())
    grid = 2.0 ** (np.ceil(np.log2(size)) - _GRID_BITS)
    if not _LEAST_GAP * grid <= gap < width:
        raise ParameterError(
            f"--gap: expected from {_LEAST_GAP * grid:.3g} to less than the hinge width {width:.6g}, got {gap:.6g}"
        )
    # A slit of the gap's width is a cut of that kerf: the ligaments keep their width.
    lines = cuts(tessellation, contracted, width, gap)
    corners, faces, owners, kinds, areas = _parts(tessellation, points, lines.slits, lines.whole, gap, grid)
    n_tiles = int(np.sum(kinds == 2))
    if n_tiles != tessellation.n_tiles:
        raise ParameterError(
            f"--gap: expected one that leaves {tessellation.n_tiles} tiles whole, got {gap:.6g}, which leaves {n_tiles}"
        )
    levels = np.array([0.0, low, thickness], np.float32).astype(float)
    height = kinds if low < thickness else np.minimum(kinds, 1)
    triangles = _prisms(faces, height[owners], len(corners))
    _check_closed(triangles)
    used, triangles = np.unique(triangles, return_inverse=True)
    triangles = triangles.reshape(-1, 3)
    level, corner = np.divmod(used, len(corners))
    flat = corners - corners.min(axis=0)
    return Solid(
        vertices=frozen(np.column_stack([flat[corner], levels[level] if low < thickness else levels[2 * level]])),
        triangles=frozen(triangles, np.int64),
        tile_area=float(areas[kinds == 2].sum()),
        ligament_area=float(areas[kinds == 1].sum()),
        n_tiles=n_tiles,
        n_pieces=_n_pieces(triangles, len(used)),
        warnings=lines.warnings,
    )


def _parts(
    tessellation: Tessellation,
    points: np.ndarray,
    slits: tuple[np.ndarray, ...],
    whole: tuple[np.ndarray, ...],
    gap: float,
    grid: float,
) -> tuple[np.ndarray, np.ndarray, np.ndarray, np.ndarray, np.ndarray]:
    """Divide the sheet: corners (c, 2), triangles (f, 3), their part (f,), and of every part kind and area.

    Kind 2 is a tile, 1 a ligament. All lines are noded together, so that neighbors share corners exactly.
    """
    outline, openings = contours(tessellation)
    sheet = Polygon(points[outline], [points[loop] for loop in openings])
    cut, full = (MultiLineString(list(lines)).buffer(0.5 * gap, quad_segs=_ARC_SEGMENTS) for lines in (slits, whole))
    lines = shapely.union_all([sheet.boundary, cut.boundary, full.boundary], grid_size=grid)
    found = shapely.get_parts(shapely.polygonize([lines]))
    inside = shapely.point_on_surface(found)
    for region in (sheet, cut, full):
        shapely.prepare(region)
    is_solid = shapely.contains(sheet, inside) & ~shapely.contains(cut, inside)
    found = found[is_solid]
    kinds = np.where(shapely.contains(full, inside[is_solid]), 1, 2)

    pieces, owners = shapely.get_parts(shapely.constrained_delaunay_triangles(found), return_index=True)
    rings = shapely.get_coordinates(pieces).reshape(-1, 4, 2)[:, :3]
    steps = np.round(rings / grid).astype(np.int64)
    a, b, c = steps.swapaxes(0, 1)
    turn = (b - a)[:, 0] * (c - a)[:, 1] - (b - a)[:, 1] * (c - a)[:, 0]
    steps[turn < 0] = steps[turn < 0][:, ::-1]
    corners, faces = np.unique(steps.reshape(-1, 2), axis=0, return_inverse=True)
    return corners * grid, faces.reshape(-1, 3), owners, kinds, shapely.area(found)


def _prisms(faces: np.ndarray, height: np.ndarray, n: int) -> np.ndarray:
    """Triangles (g, 3) of the prisms over faces of level 1 or 2; corner k at level l is vertex l n + k."""
    top, bottom = faces + n * height[:, None], faces[:, ::-1]
    start, end = faces.ravel(), np.roll(faces, -1, axis=1).ravel()
    level = np.repeat(height, 3)
    key = start * n + end
    order = np.argsort(key)
    place = np.minimum(np.searchsorted(key[order], end * n + start), len(key) - 1)
    has_neighbor = key[order][place] == end * n + start
    beyond = np.where(has_neighbor, level[order][place], 0)
    walls = [top, bottom]
    for step in range(int(height.max())):
        # Every wall is divided at every level, so that walls that meet at a corner share its vertices.
        stands = (beyond <= step) & (step < level)
        a, b = start[stands] + step * n, end[stands] + step * n
        walls += [np.stack([a, b, b + n], axis=1), np.stack([a, b + n, a + n], axis=1)]
    return np.concatenate(walls)


def _check_closed(triangles: np.ndarray) -> None:
    """Raise where an edge is not shared by exactly two triangles that run along it in opposite directions."""
    start, end = triangles.ravel(), np.roll(triangles, -1, axis=1).ravel()
    n = int(triangles.max()) + 1
    there, back = np.sort(start * n + end), np.sort(end * n + start)
    if (there[1:] == there[:-1]).any() or not np.array_equal(there, back):
        raise UnusableError(
            "solid: expected parts that meet along faces, got some that touch along an edge only; "
            "choose another --gap or --hinge-width"
        )


def _n_pieces(triangles: np.ndarray, n: int) -> int:
    rows, columns = triangles[:, [0, 1]].ravel(), triangles[:, [1, 2]].ravel()
    return int(connected_components(coo_matrix((np.ones(len(rows)), (rows, columns)), shape=(n, n)), directed=False)[0])
