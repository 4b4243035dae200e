"""The rows of the certificate: the worst value of every check, and where it is."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import ArrayLike

from analysis import accuracy, polygons, rigidity
from analysis.coverage import measure_coverage
from analysis.finding import NOTHING, Finding
from analysis.intersections import crossing_pairs
from analysis.layout import Layout, overlapping_tiles
from analysis.openings import find_openings
from analysis.sheet import Sheet
from kirisurf.arrays import checked
from kirisurf.closest import ClosestPoints
from kirisurf.errors import UnusableError
from kirisurf.surface import Surface
from kirisurf.tessellation import Tessellation

_FLAT = 1e-9
"""Distance from one plane (edges) up to which a deployed sheet is flat."""


def tile_rows(sheet: Sheet, layout: Layout) -> dict[str, Finding]:
    """Return the rows that need no welding: tiles, their edges, crossings, the contracted layout."""
    length, tiles = sheet.edge_length, sheet.tiles
    offsets = rigidity.planar_offsets(sheet.local, tiles) / length
    changes = rigidity.shape_changes(sheet.local, sheet.flat, tiles) / length
    edges = polygons.edge_lengths(sheet.local, tiles) / length
    crossing = _crossing(sheet)
    broken = f"contracted {tile_names(layout.broken)} cross themselves" if len(layout.broken) else ""
    pair = tile_names(layout.overlapping[0]) if len(layout.overlapping) else ""
    x, y = layout.gap_place
    return {
        "planarity": _worst(offsets, lambda k: f"tile {k}"),
        "isometry": _worst(changes, lambda k: f"tile {k}"),
        "min_edge": Finding(float(edges.min()), f"the edge from {sheet.place(tiles.indices[edges.argmin()])}"),
        "intersections": Finding(len(crossing), tile_names(crossing[0]) if len(crossing) else ""),
        "overlap_contracted": Finding(layout.overlap, broken or pair),
        "gap_contracted": Finding(layout.gap, broken or f"contracted point ({x:.6g}, {y:.6g})"),
    }


def _crossing(sheet: Sheet) -> np.ndarray:
    """Pairs of tiles (m, 2) that cross in space, or overlap where the deployed sheet is flat.

    In one plane neighbors can overlap beside their common vertex, which no crossing in space shows.
    """
    crossing = crossing_pairs(sheet.local, sheet.tiles, sheet.edge_length)
    relative = sheet.local - sheet.local.mean(axis=0)
    axes = np.linalg.svd(relative, full_matrices=False)[2]
    if np.abs(relative @ axes[2]).max() > _FLAT * sheet.edge_length:
        return crossing
    plane = relative @ axes[:2].T
    if polygons.area_vectors(np.c_[plane, np.zeros(len(plane))], sheet.tiles)[:, 2].sum() < 0:
        plane = plane * [1.0, -1.0]
    pairs = np.concatenate([crossing.reshape(-1, 2), overlapping_tiles(plane, sheet.tiles)])
    return np.unique(np.sort(pairs, axis=1), axis=0)


def slit_rows(sheet: Sheet, tessellation: Tessellation) -> dict[str, Finding]:
    """Return `length`, `closure` and, where there are slit ends, `opening_min`."""
    rows = {"length": rigidity.edge_mismatch(sheet, tessellation), "closure": rigidity.closure(sheet, tessellation)}
    ends = np.flatnonzero(tessellation.slit_ends)
    opening = rigidity.openings(sheet.local, sheet.tiles, tessellation)[ends]
    if len(ends):
        k = int(opening.argmin())
        rows["opening_min"] = Finding(float(opening[k]), sheet.place(tessellation.hinges[ends[k], 1]))
    return rows


def ring_rows(sheet: Sheet, tessellation: Tessellation, designed: bool | None) -> tuple[Finding, Finding, float]:
    """Return the angle row over rings and designed openings, the loop row, and the designed openings' area.

    Parameters
    ----------
    sheet : Sheet
    tessellation : Tessellation
    designed : bool or None
        As in :func:`analysis.openings.find_openings`.
    """
    residuals = rigidity.ring_residuals(sheet.local, sheet.tiles, tessellation)
    inner = sheet.tiles.indices[tessellation.rings.indices[tessellation.rings.offsets[:-1]]]
    openings = find_openings(sheet.local, tessellation, designed)
    vertices = np.concatenate([inner, openings.vertices])
    return (
        _worst(np.concatenate([residuals, openings.angle_residuals]), lambda k: sheet.place(vertices[k])),
        _worst(openings.gaps / sheet.edge_length, lambda k: sheet.place(openings.vertices[k])),
        openings.area,
    )


def outline_row(sheet: Sheet, name: str, vertices: ArrayLike, distances: ArrayLike) -> Finding:
    """Return the largest distance of a rim vertex to its curve over L, and where that vertex is in its state.

    Raises
    ------
    UnusableError
        Where vertices and distances do not fit together, or a vertex belongs to no tile.
    """
    numbers = checked(vertices, f"vertices of {name}", (None,), np.int64)
    apart = checked(distances, f"distances of {name}", (len(numbers),))
    place = np.minimum(np.searchsorted(sheet.numbers, numbers), len(sheet.numbers) - 1)
    unknown = sheet.numbers[place] != numbers
    if unknown.any():
        raise UnusableError(f"vertices of {name}: expected vertices of tiles, got {numbers[unknown.argmax()]}")
    return _worst(apart / sheet.edge_length, lambda k: sheet.place(place[k], contracted=name != "boundary"))


def target_rows(sheet: Sheet, target: Surface, closest: ClosestPoints) -> tuple[dict[str, Finding], dict[str, float]]:
    """Return the rows on the target, and the distances to the smooth surface that it stands for, if any."""
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


def tile_names(tiles: np.ndarray) -> str:
    """Return tiles in words for a sentence, no more than five of them; nothing where there are none."""
    shown = ", ".join(str(k) for k in tiles[:5])
    return f"tiles {shown}{', ...' if len(tiles) > 5 else ''}" if len(tiles) else ""


def _worst(values: np.ndarray, where: Callable[[int], str]) -> Finding:
    """The value of largest magnitude; not a number counts as the largest."""
    if not len(values):
        return NOTHING
    k = int(np.argmax(np.nan_to_num(np.abs(values), nan=np.inf)))
    return Finding(float(np.abs(values[k])), where(k))
