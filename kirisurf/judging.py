"""The one door from computing to `analysis`: certificates and measures of finished designs.

The solver never asks `analysis`, and importing kirisurf must not load it: it is imported inside the functions.
"""

from __future__ import annotations

import os
import re
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from kirisurf.arrays import frozen
from kirisurf.closest import ClosestPoints
from kirisurf.errors import ParameterError, UnusableError
from kirisurf.field_units import ORIGIN
from kirisurf.formats import read_fields, read_polygons
from kirisurf.loops import Loops
from kirisurf.one_thread import on_one_thread
from kirisurf.origin import moved
from kirisurf.outlines import Outline
from kirisurf.prescribed import Prescribed
from kirisurf.quadric_blend import QuadricBlend
from kirisurf.runs.table import CENTER
from kirisurf.spec import FitSpec
from kirisurf.surface import Surface
from kirisurf.targets import load
from kirisurf.tessellation import Tessellation

if TYPE_CHECKING:
    from analysis.certificate import Certificate
    from analysis.collision_path import PathCollisions
    from analysis.foreign_holes import ForeignHoles
    from analysis.frames import Frame
    from analysis.measures import Measures

PrescribedPair = tuple[Prescribed | None, Prescribed | None]

OUTLINE_PARTS = 2000
"""Segments along the diagonal by which an outline is measured."""

_ORIGIN_LINES = 50


@on_one_thread
def certified(
    spec: FitSpec,
    deployed: np.ndarray,
    contracted: np.ndarray,
    tiles: Loops,
    surface: Surface,
    weld: np.ndarray | None = None,
    prescribed: PrescribedPair = (None, None),
    openings: bool | None = None,
) -> Certificate:
    """Certify a design from its points and tiles, by the limits that its spec asks for.

    Parameters
    ----------
    spec : FitSpec
    deployed : (n, 3)
    contracted : (n, 2) or (n, 3)
    tiles : Loops
    surface : Surface
    weld : (n,) int, optional
        Contracted vertex of every vertex, for a design whose copies do not coincide yet; by default it is
        found by proximity.
    prescribed : (Prescribed or None, Prescribed or None)
        The outlines that the deployed and the contracted sheet follow.
    openings : bool, optional
        Whether what stays open in the contracted sheet is meant to; by default this follows from the sheet.
    """
    from analysis.certificate import certify
    from analysis.limits import OUTLINE_ROWS

    limits = dict.fromkeys(("length", "angle", "planarity", "isometry", "closure", "loop"), spec.tolerance)
    limits |= dict.fromkeys(OUTLINE_ROWS, spec.tolerance)
    limits["min_edge"] = spec.min_edge
    limits["opening_min"] = float(np.radians(spec.min_angle))
    if spec.closeness == "exact":
        # every vertex on the smooth surface: that of the sample, or the one that stands for the mesh
        limits["distance_smooth_max"] = 1e-9
        if surface.smooth is None:
            surface = replace(surface, smooth=QuadricBlend(surface))
    return certify(
        deployed,
        contracted,
        tiles,
        surface,
        weld,
        limits,
        boundary=_followed(prescribed[0], deployed),
        contracted_boundary=_followed(prescribed[1], contracted),
        openings=openings,
    )


def _followed(prescribed: Prescribed | None, points: np.ndarray) -> tuple[np.ndarray, np.ndarray] | None:
    return None if prescribed is None else (prescribed.vertices, prescribed.distances(points))


@on_one_thread
def measured(
    tessellation: Tessellation,
    deployed: np.ndarray,
    contracted: np.ndarray,
    surface: Surface,
    closest: ClosestPoints | None = None,
) -> Measures:
    """Measure a design: distances, curvatures and sizes as named fields, tables and numbers.

    Its target's closest points may be at hand.
    """
    from analysis.measures import measure

    outline = surface.outline
    curve = outline.polyline(outline.diagonal / OUTLINE_PARTS) if isinstance(outline, Outline) else None
    return measure(tessellation, deployed, contracted, surface, closest, curve)


def patch_points(tessellation: Tessellation, deployed: np.ndarray, n: int) -> np.ndarray:
    """Sample the patch over every hole, (h, n, n, 3), for drawing; NaN for a hole without a trustworthy one."""
    from analysis.patches import hole_patches

    return hole_patches(deployed, tessellation).sample(n)


@on_one_thread
def hole_measures(
    tessellation: Tessellation, deployed: np.ndarray, surface: Surface, construction: str
) -> tuple[dict[str, np.ndarray], dict[str, float]]:
    """Return the fields of the holes, with their centers (h, 3), and numbers, for another construction of patches."""
    from analysis.hole_measures import measure_holes

    found = measure_holes(deployed, tessellation, ClosestPoints(surface), construction)
    return {**found.fields, CENTER: frozen(found.centers)}, dict(found.numbers)


def named_fields(measures: Measures, where: str) -> dict[str, np.ndarray]:
    """Return the fields of vertex, tile or hole by name; holes have their centers (h, 3) among them."""
    found = {name: values for (place, name), values in measures.fields.items() if place == where}
    if where == "hole":
        rows = measures.tables["holes"]
        found[CENTER] = frozen(np.array([[row[axis] for axis in "xyz"] for row in rows]).reshape(-1, 3))
    return found


def deployment(
    tessellation: Tessellation, contracted: np.ndarray, deployed: np.ndarray, shares: Iterable[float]
) -> Iterator[Frame]:
    """Yield the sheet at shares of the way between its states: interpolated, no mechanism."""
    from analysis.frames import frames

    return frames(tessellation, contracted, deployed, shares)


@on_one_thread
def audit(deployed: Any, contracted: Any, target: Any = None) -> Certificate:
    """Certify any pair of states, of kirisurf or of another program.

    Parameters
    ----------
    deployed, contracted : path, (points, tiles) or pyvista.PolyData
        The same polygons on the same vertices in both states: OBJ or VTP files, points (n, 2) or (n, 3)
        with `Loops` or a list of index lists, or meshes.
    target : file, name of a sample surface, (vertices, faces) or pyvista mesh, optional
        Without it the rows on the target are not judged. A file of kirisurf that was shifted to a round
        origin says so; the target is shifted with it.

    Raises
    ------
    UnusableError
        Where the two states are not the same polygons, or a file holds nothing usable.
    UnreadableError
        Where a file cannot be read.

    Examples
    --------
    >>> from kirisurf.pattern import quad_pattern
    >>> pattern = quad_pattern(2, 2)
    >>> audit((pattern.deployed, pattern.tiles), (pattern.contracted, pattern.tiles)).passed
    True
    """
    from analysis.certificate import certify

    points, flat, tiles, surface = _judged(deployed, contracted, target)
    return certify(points, flat, tiles, surface)


@on_one_thread
def measured_holes(deployed: Any, contracted: Any, target: Any = None) -> ForeignHoles:
    """Measure the holes of any pair of states; parameters and errors as for :func:`audit`.

    Examples
    --------
    >>> from kirisurf.pattern import quad_pattern
    >>> pattern = quad_pattern(2, 2)
    >>> found = measured_holes((pattern.deployed, pattern.tiles), (pattern.contracted, pattern.tiles))
    >>> len(found.holes), bool(abs(found.fields["gaussian_curvature"]).max() < 1e-9)
    (9, True)
    """
    from analysis.foreign_holes import foreign_holes

    return foreign_holes(*_judged(deployed, contracted, target))


def _judged(deployed: Any, contracted: Any, target: Any) -> tuple[np.ndarray, np.ndarray, Loops, Surface | None]:
    """Read both states (n, 3) and (n, 2) or (n, 3), their tiles, and the target in the frame of the deployed one."""
    points, tiles = _state(deployed)
    flat, same = _state(contracted)
    if len(points) != len(flat):
        raise UnusableError(
            f"audit: expected the same vertices in both states, got {len(points)} deployed and {len(flat)} contracted"
        )
    if len(tiles) != len(same) or not np.array_equal(tiles.indices, same.indices):
        raise UnusableError(
            f"audit: expected the same polygons in the same order in both states, got {len(tiles)} deployed and "
            f"{len(same)} contracted that differ"
        )
    if points.shape[1] == 2:
        points = np.column_stack([points, np.zeros(len(points))])
    surface = None
    if target is not None:
        surface = moved(load(target), origin_of(deployed) - origin_of(target))
    return points, flat, tiles, surface


def origin_of(deployed: Any) -> np.ndarray:
    """Return the origin (3,) that an OBJ file names in a comment, a VTP file in its field data; zero without one."""
    if isinstance(deployed, (str, os.PathLike)) and Path(deployed).suffix.lower() == ".vtp":
        return _finite(np.ravel(np.asarray(read_fields(deployed).about.get(ORIGIN, ()))))
    if isinstance(deployed, (str, os.PathLike)) and Path(deployed).suffix.lower() == ".obj":
        with open(deployed, encoding="utf-8", errors="replace") as file:
            for _, line in zip(range(_ORIGIN_LINES), file, strict=False):
                match = re.match(r"#\s*origin:\s*(\S+)\s+(\S+)\s+(\S+)", line)
                if match:
                    return _numbers(match.groups())
    return np.zeros(3)


def _state(state: Any) -> tuple[np.ndarray, Loops]:
    if isinstance(state, (str, os.PathLike)):
        return read_polygons(state)
    if hasattr(state, "irregular_faces"):
        return np.asarray(state.points, dtype=float), Loops.from_lists(
            [np.asarray(face) for face in state.irregular_faces]
        )
    if isinstance(state, (tuple, list)) and len(state) == 2:
        points, tiles = np.asarray(state[0], dtype=float), state[1]
        if points.ndim == 2 and points.shape[1] in (2, 3):
            return points, tiles if isinstance(tiles, Loops) else Loops.from_lists([np.asarray(t) for t in tiles])
    raise ParameterError(f"audit: expected a file, (points, tiles) or a pyvista mesh, got {type(state).__name__}")


def _numbers(words: tuple[str, ...]) -> np.ndarray:
    """Three finite numbers, or zeros: a comment of another program is no origin."""
    try:
        return _finite(np.array([float(word) for word in words]))
    except ValueError:
        return np.zeros(3)


def _finite(values: np.ndarray) -> np.ndarray:
    is_origin = values.shape == (3,) and values.dtype.kind in "iuf" and np.isfinite(values).all()
    return values.astype(float) if is_origin else np.zeros(3)


@on_one_thread
def path_collisions(
    states: Sequence[np.ndarray],
    tiles: Loops,
    shares: np.ndarray,
    thickness: float = 0.0,
    slit_width: float = 0.0,
    touch: float | None = None,
) -> PathCollisions:
    """Return the collisions along a path, see :func:`analysis.collision_path.path_collisions`."""
    from analysis.collision_path import path_collisions
    from analysis.collisions import TOUCH

    return path_collisions(states, tiles, shares, thickness, slit_width, TOUCH if touch is None else touch)


def regression() -> Any:
    """Return the module that compares measures with a baseline, :mod:`analysis.regression`."""
    from analysis import regression as found

    return found
