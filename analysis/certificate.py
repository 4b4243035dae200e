"""The certificate: whether two files are one sheet of rigid tiles, and how near it comes to its target."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike

from analysis import accuracy, polygons, rigidity
from analysis.coverage import measure_coverage
from analysis.finding import NOTHING, Finding
from analysis.intersections import crossing_pairs
from analysis.layout import Layout, measure_layout
from analysis.limits import ROWS, TARGET_ROWS, merged_limits, sentences
from analysis.openings import find_openings
from analysis.sheet import Sheet, count_pieces, read_sheet
from kirisurf.closest import ClosestPoints
from kirisurf.loops import Loops
from kirisurf.surface import Surface
from kirisurf.tessellation import Tessellation


@dataclass(frozen=True, eq=False)
class Certificate:
    """Every residual of a design, and the verdict on it.

    Lengths are over the median deployed tile edge L, angles in radians, areas over the tiles' area.

    Attributes
    ----------
    rows : mapping of str to float or None
        In the order of `analysis.limits.ROWS`; None where nothing could be checked.
    limits : mapping of str to float
        What every row, and `pieces`, `flipped` and `flatness`, is held against.
    failures : tuple of str
        One sentence for every row that fails: its name, value, limit, and where.
    pieces : int
        Parts that hinges hold together: 1 for a sheet.
    flipped : int
        Contracted tiles of the wrong orientation.
    edge_length : float
        L in the user's units.
    extra : mapping of str to float
        `flatness` (largest distance of a contracted vertex to the plane of all, over L), and, without a limit
        unless `limits` names one: `fold_max` (largest angle between the normals of hinged tiles),
        `distance_smooth_rms` and `distance_smooth_max` (to the smooth surface that the mesh stands for, over
        L; the `exact` mode is judged by them).
    """

    rows: Mapping[str, float | int | None]
    limits: Mapping[str, float]
    failures: tuple[str, ...]
    pieces: int
    flipped: int
    edge_length: float
    extra: Mapping[str, float] = field(default_factory=dict)

    @property
    def passed(self) -> bool:
        """Whether no row fails."""
        return not self.failures


def certify(
    deployed: ArrayLike,
    contracted: ArrayLike,
    tiles: Loops,
    target: Surface | None = None,
    weld: ArrayLike | None = None,
    limits: Mapping[str, float | int] | None = None,
    closest: ClosestPoints | None = None,
) -> Certificate:
    """Certify a design from nothing but its two states and its tiles.

    Everything else (welding, slits, rings, holes, the outline) is derived from the arrays here, so that the
    certificate of arrays read back from files tells whether the files are right.

    A row that nothing could be checked against is None, and the design then fails. Two exceptions: `loop` is
    None wherever the contracted sheet has no designed opening (quads, kagome), and without a target the
    target rows are None and not part of the verdict.

    Parameters
    ----------
    deployed : (n, 3), units
    contracted : (n, 2) or (n, 3), units
    tiles : Loops
        The same polygons in both states.
    target : Surface, optional
    weld : (n,) int, optional
        Contracted vertex of every vertex; by default contracted vertices closer than 1e-6 L are one. Needed
        for files whose copies coincide only roughly.
    limits : mapping of str to float, optional
        Limits that replace those of `analysis.limits.LIMITS`; they may also name entries of `extra`.
    closest : ClosestPoints, optional
        The target's closest-point tree, where one is at hand.

    Raises
    ------
    UnusableError
        Where the arrays do not fit together (see :func:`analysis.sheet.read_sheet`), or the target is not
        fit for closest points.
    ParameterError
        Where `limits` names an unknown row.

    Examples
    --------
    >>> import numpy as np
    >>> from kirisurf.pattern import quad_pattern
    >>> pattern = quad_pattern(2, 2)
    >>> flat = np.c_[pattern.deployed, np.zeros(pattern.n_vertices)]
    >>> certificate = certify(flat, pattern.contracted, pattern.tiles)
    >>> certificate.passed, certificate.pieces, round(certificate.rows["opening_min"], 9)
    (True, 1, 1.570796327)
    """
    sheet = read_sheet(deployed, contracted, tiles, weld)
    tessellation = sheet.tessellation
    layout = measure_layout(sheet.plane, sheet.tiles, None if tessellation is None else tessellation.weld)
    rows = dict.fromkeys(ROWS, NOTHING) | _tile_rows(sheet, layout)
    extra = {"flatness": _flatness(sheet)}
    designed_gap = 0.0
    if tessellation is not None:
        rows |= _slit_rows(sheet, tessellation)
        rows["angle"], rows["loop"], area = _ring_rows(sheet, tessellation)
        designed_gap = area / layout.area if layout.area > 0 else 0.0
        extra["fold_max"] = float(rigidity.folds(sheet.local, sheet.tiles, tessellation).max(initial=0.0))
    if target is not None:
        found, smooth = _target_rows(sheet, target, closest or ClosestPoints(target))
        rows |= found
        extra |= smooth
    pieces = count_pieces(sheet.tiles)
    bounds = merged_limits(limits, extra)
    judged = rows | {name: Finding(value) for name, value in extra.items()}
    judged["pieces"] = Finding(pieces)
    judged["flipped"] = Finding(len(layout.flipped), _tile_names(layout.flipped))
    gap = rows["gap_contracted"]
    if gap.value is not None:
        judged["gap_contracted"] = Finding(abs(gap.value - designed_gap), gap.where)
    for name in ("loop",) if target is not None else ("loop", *TARGET_ROWS):
        if judged[name].value is None:
            del judged[name]
    failures = sentences(judged, bounds)
    if sheet.problem:
        failures = (f"topology: the tiles make no sheet: {sheet.problem}", *failures)
    return Certificate(
        rows=MappingProxyType({name: rows[name].value for name in ROWS}),
        limits=bounds,
        failures=failures,
        pieces=pieces,
        flipped=len(layout.flipped),
        edge_length=sheet.edge_length,
        extra=MappingProxyType(extra),
    )


def _tile_rows(sheet: Sheet, layout: Layout) -> dict[str, Finding]:
    """The rows that need no welding."""
    length, tiles = sheet.edge_length, sheet.tiles
    offsets = rigidity.planar_offsets(sheet.local, tiles) / length
    changes = rigidity.shape_changes(sheet.local, sheet.flat, tiles) / length
    edges = polygons.edge_lengths(sheet.local, tiles) / length
    crossing = crossing_pairs(sheet.local, tiles, length)
    broken = f"contracted {_tile_names(layout.broken)} cross themselves" if len(layout.broken) else ""
    pair = _tile_names(layout.overlapping[0]) if len(layout.overlapping) else ""
    x, y = layout.gap_place
    return {
        "planarity": _worst(offsets, lambda k: f"tile {k}"),
        "isometry": _worst(changes, lambda k: f"tile {k}"),
        "min_edge": Finding(float(edges.min()), f"the edge from {sheet.place(tiles.indices[edges.argmin()])}"),
        "intersections": Finding(len(crossing), _tile_names(crossing[0]) if len(crossing) else ""),
        "overlap_contracted": Finding(layout.overlap, broken or pair),
        "gap_contracted": Finding(layout.gap, broken or f"contracted point ({x:.6g}, {y:.6g})"),
    }


def _slit_rows(sheet: Sheet, tessellation: Tessellation) -> dict[str, Finding]:
    rows = {"length": rigidity.edge_mismatch(sheet, tessellation), "closure": rigidity.closure(sheet, tessellation)}
    ends = np.flatnonzero(tessellation.slit_ends)
    opening = rigidity.openings(sheet.local, sheet.tiles, tessellation)[ends]
    if len(ends):
        k = int(opening.argmin())
        rows["opening_min"] = Finding(float(opening[k]), sheet.place(tessellation.hinges[ends[k], 1]))
    return rows


def _ring_rows(sheet: Sheet, tessellation: Tessellation) -> tuple[Finding, Finding, float]:
    """The angle row, the loop row, and the area of the designed openings."""
    residuals = rigidity.ring_residuals(sheet.local, sheet.tiles, tessellation)
    if len(residuals):
        vertices = sheet.tiles.indices[tessellation.rings.indices[tessellation.rings.offsets[:-1]]]
        return _worst(residuals, lambda k: sheet.place(vertices[k])), NOTHING, 0.0
    openings = find_openings(sheet.local, tessellation)
    return (
        _worst(openings.angle_residuals, lambda k: sheet.place(openings.vertices[k])),
        _worst(openings.gaps / sheet.edge_length, lambda k: sheet.place(openings.vertices[k])),
        openings.area,
    )


def _target_rows(sheet: Sheet, target: Surface, closest: ClosestPoints) -> tuple[dict[str, Finding], dict[str, float]]:
    length = sheet.edge_length
    distances = closest.distances(sheet.points) / length
    rows = {
        "distance_rms": Finding(accuracy.root_mean_square(distances)),
        "distance_max": _worst(distances, sheet.place),
    }
    smooth = {}
    if target.smooth is not None:
        apart = np.linalg.norm(sheet.points - target.smooth.project(sheet.points)[0], axis=1) / length
        smooth["distance_smooth_rms"] = accuracy.root_mean_square(apart)
        smooth["distance_smooth_max"] = float(apart.max())
    if sheet.tessellation is None:
        return rows, smooth
    samples = accuracy.sample_uniformly(target, accuracy.N_SAMPLES)
    reached = accuracy.distances_to_sheet(samples, sheet.points, sheet.tessellation) / length
    rows["reach_rms"] = Finding(accuracy.root_mean_square(reached))
    rows["reach_max"] = _worst(reached, lambda k: "the target's point ({:.6g}, {:.6g}, {:.6g})".format(*samples[k]))
    coverage = measure_coverage(sheet.points, sheet.tessellation, closest)
    if coverage is not None:
        rows["coverage"], rows["coverage_strict"] = Finding(coverage.filled), Finding(coverage.strict)
    return rows, smooth


def _flatness(sheet: Sheet) -> float:
    """Largest distance of a contracted vertex to the best plane of all of them, over L."""
    if not np.ptp(sheet.flat[:, 2]) > 0:
        return 0.0
    relative = sheet.flat - sheet.flat.mean(axis=0)
    across = np.linalg.svd(relative, full_matrices=False)[2][2]
    return float(np.abs(relative @ across).max() / sheet.edge_length)


def _worst(values: np.ndarray, where: Callable[[int], str]) -> Finding:
    """The value of largest magnitude; not a number counts as the largest."""
    if not len(values):
        return NOTHING
    k = int(np.argmax(np.nan_to_num(np.abs(values), nan=np.inf)))
    return Finding(float(np.abs(values[k])), where(k))


def _tile_names(tiles: np.ndarray) -> str:
    shown = ", ".join(str(k) for k in tiles[:5])
    return f"tiles {shown}{', ...' if len(tiles) > 5 else ''}" if len(tiles) else ""
