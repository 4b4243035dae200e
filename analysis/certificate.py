"""The certificate: whether two files are one sheet of rigid tiles, and how near it comes to its target."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np
from numpy.typing import ArrayLike

from analysis import rigidity
from analysis.finding import NOTHING, Finding
from analysis.layout import measure_layout
from analysis.limits import OUTLINE_ROWS, ROWS, TARGET_ROWS, merged_limits, sentences
from analysis.rows import outline_row, ring_rows, slit_rows, target_rows, tile_names, tile_rows
from analysis.sheet import Sheet, count_pieces, read_sheet
from kirisurf.closest import ClosestPoints
from kirisurf.loops import Loops
from kirisurf.surface import Surface

RimDistances = tuple[ArrayLike, ArrayLike]
"""Vertices of the rim (k,) int, numbered as in the input, and their distances (k,) to a prescribed curve, units."""


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
        L; the `exact` mode is judged by them), `gap_designed` (area of the designed openings over that of the tiles,
        which the row `gap_contracted` is allowed; absent without openings).
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
    boundary: RimDistances | None = None,
    contracted_boundary: RimDistances | None = None,
    openings: bool | None = None,
) -> Certificate:
    """Certify a design from nothing but its two states and its tiles.

    Everything else (welding, slits, rings, holes, the outline) is derived from the arrays here, so that the
    certificate of arrays read back from files tells whether the files are right.

    A row that nothing could be checked against is None, and the design then fails. Three exceptions: `loop` is
    None wherever the contracted sheet has no designed opening (quads, kagome), `boundary` and
    `contracted_boundary` where no curve is prescribed, and without a target the target rows; they are then not
    part of the verdict.

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
    boundary : ((k,) int, (k,) float), optional
        For a planar target: vertices of the deployed rim and their distances to the target's outline, units. The
        row is max |distance| / L.
    contracted_boundary : ((k,) int, (k,) float), optional
        The same for the contracted rim and the outline prescribed for it (a rectangle, a file).
    openings : bool, optional
        Whether what stays open inside the contracted sheet is meant to; by default this follows from the sheet
        (see :func:`analysis.openings.find_openings`).

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
    rows = dict.fromkeys(ROWS, NOTHING) | tile_rows(sheet, layout)
    extra = {"flatness": _flatness(sheet)}
    designed_gap = 0.0
    if tessellation is not None:
        rows |= slit_rows(sheet, tessellation)
        rows["angle"], rows["loop"], area = ring_rows(sheet, tessellation, openings)
        designed_gap = area / layout.area if layout.area > 0 else 0.0
        if designed_gap > 0:
            extra["gap_designed"] = designed_gap
        extra["fold_max"] = float(rigidity.folds(sheet.local, sheet.tiles, tessellation).max(initial=0.0))
    if target is not None:
        found, smooth = target_rows(sheet, target, closest or ClosestPoints(target))
        rows |= found
        extra |= smooth
    prescribed = {"boundary": boundary, "contracted_boundary": contracted_boundary}
    for name, distances in prescribed.items():
        if distances is not None:
            rows[name] = outline_row(sheet, name, *distances)
    pieces = count_pieces(sheet.tiles)
    bounds = merged_limits(limits, extra)
    judged = rows | {name: Finding(value) for name, value in extra.items()}
    judged["pieces"] = Finding(pieces)
    judged["flipped"] = Finding(len(layout.flipped), tile_names(layout.flipped))
    gap = rows["gap_contracted"]
    if gap.value is not None:
        judged["gap_contracted"] = Finding(abs(gap.value - designed_gap), gap.where)
    if judged["loop"].value is None:
        del judged["loop"]
    for name in (*OUTLINE_ROWS, *TARGET_ROWS):
        if (prescribed[name] if name in OUTLINE_ROWS else target) is None:
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


def _flatness(sheet: Sheet) -> float:
    """Largest distance of a contracted vertex to the best plane of all of them, over L."""
    if not np.ptp(sheet.flat[:, 2]) > 0:
        return 0.0
    relative = sheet.flat - sheet.flat.mean(axis=0)
    across = np.linalg.svd(relative, full_matrices=False)[2][2]
    return float(np.abs(relative @ across).max() / sheet.edge_length)
