"""From the curves of a drawing to closed ones: ends that meet are joined, small gaps are closed and told of."""

from __future__ import annotations

import numpy as np
from scipy.spatial import cKDTree

from kirisurf.errors import UnusableError
from kirisurf.outlines.curve import Curve, joined
from kirisurf.outlines.shapes import straight

_MEETING = 1e-4
"""Part of the drawing's diagonal within which two ends meet: what rounding to a few decimals leaves."""

_REACHES = (1e-9, 1e-6, _MEETING)
"""Parts of the diagonal within which ends are joined, one after the other."""

_SAME = 1e-8
"""Part of the diagonal within which two curves are copies of each other."""

_TOLD = 1e-9
"""Part of the diagonal from which on a gap is told of, and below which a piece has no length."""

_MOST_PAIRS = 10_000_000
"""Pairs of ends in one place, each counted twice, from which on a drawing is refused."""

_SHORT_GAP = 0.02
"""Part of a curve's own diagonal up to which a gap between its ends is closed by a straight segment."""


def closed_curves(curves: tuple[Curve, ...]) -> tuple[list[Curve], list[Curve], list[str]]:
    """Join curves end to end.

    Returns
    -------
    closed : list of Curve
        In the order of their first piece.
    open : list of Curve
        What remains.
    notes : list of str
    """
    notes: list[str] = []
    size = _diagonal(np.concatenate([_nine_of_each_piece(curve) for curve in curves])) if curves else 0.0
    kept = [piece for curve in curves if (piece := _without_specks(curve, _TOLD * size)) is not None]
    closed: list[tuple[int, Curve]] = []
    loose: list[tuple[int, Curve]] = []
    for k, curve in enumerate(kept):
        gap = float(np.linalg.norm(curve.end - curve.start))
        is_closed = gap <= _MEETING * size and _is_as_large(curve, gap / _MEETING)
        (closed if is_closed else loose).append((k, curve))
    unique = _without_copies(loose, _SAME * size)
    if len(unique) < len(loose):
        notes.append(f"{len(loose) - len(unique)} copies of lines or curves were left out.")
    chains, junctions = _chained(unique, size)
    if len(junctions):
        x, y = junctions[0]
        notes.append(f"More than two ends meet at ({x:.6g}, {y:.6g}): nothing was joined there.")
    remaining = []
    for k, chain in chains:
        gap = float(np.linalg.norm(chain.end - chain.start))
        own = _diagonal(chain.samples.points)
        if gap <= _MEETING * size and chain.n_pieces > 1:
            closed.append((k, chain))
        elif gap <= _SHORT_GAP * own and chain.length > 4 * gap:
            notes.append(
                f"An open curve was closed by a straight segment of length {gap:.4g} from "
                f"({chain.end[0]:.6g}, {chain.end[1]:.6g}) to ({chain.start[0]:.6g}, {chain.start[1]:.6g})."
            )
            closed.append((k, joined([chain, straight(np.stack([chain.end, chain.start]))])))
        else:
            remaining.append(chain)
    welded = []
    for _, curve in sorted(closed, key=lambda entry: entry[0]):
        tight, gap = _welded(curve)
        if gap > _TOLD * size:
            notes.append(f"Gaps of up to {gap:.3g} between consecutive pieces were closed.")
        welded.append(tight)
    return welded, remaining, notes


def _nine_of_each_piece(curve: Curve) -> np.ndarray:
    # Enough for the size of a drawing: full samples of every curve in it would take much memory.
    every = np.arange(curve.n_pieces)
    return curve.evaluated(np.repeat(every, 9), np.tile(np.linspace(0.0, 1.0, 9), len(every)))[0]


def _is_as_large(curve: Curve, size: float) -> bool:
    # Where the pieces begin says it of almost every curve, and costs less than samples of it.
    every = np.arange(curve.n_pieces)
    if _diagonal(curve.evaluated(every, np.zeros(len(every)))[0]) >= size:
        return True
    return _diagonal(curve.samples.points) >= size


def _close_pairs(points: np.ndarray, reach: float) -> np.ndarray:
    # All pairs of points within a distance; where very many lie in one place, their pairs would fill the memory.
    tree = cKDTree(points)
    reach = max(reach, 1e-300)
    count = int(tree.query_ball_point(points, reach, return_length=True).sum())
    if count > _MOST_PAIRS:
        raise UnusableError(
            f"expected a drawing of which few ends meet in one place, got {count} pairs of ends that do: save nothing "
            "but the outline"
        )
    return tree.query_pairs(reach, output_type="ndarray")


def _diagonal(points: np.ndarray) -> float:
    return float(np.linalg.norm(np.ptp(points, axis=0)))


def _without_specks(curve: Curve, least: float) -> Curve | None:
    # Pieces without length have no tangent.
    reach = np.linalg.norm(curve.polynomials[:, 1:], axis=2).sum(axis=1)
    reach = reach + np.linalg.norm(curve.waves, axis=2).sum(axis=1) * np.abs(curve.angles[:, 1])
    kept = reach > least
    if kept.all():
        return curve
    if not kept.any():
        return None
    return Curve.of_pieces(curve.polynomials[kept], curve.waves[kept], curve.angles[kept])


def _without_copies(curves: list[tuple[int, Curve]], tolerance: float) -> list[tuple[int, Curve]]:
    # A line drawn twice has both ends and its middle in common with its copy.
    if len(curves) < 2:
        return curves
    keys = []
    for _, curve in curves:
        ends = sorted([curve.start.tolist(), curve.end.tolist()])
        middle = curve.points(np.array([0.5 * curve.n_pieces]))[0]
        keys.append([*ends[0], *ends[1], *middle.tolist()])
    copies = set(_close_pairs(np.array(keys), tolerance).max(axis=1, initial=-1).tolist())
    return [entry for k, entry in enumerate(curves) if k not in copies]


def _chained(curves: list[tuple[int, Curve]], size: float) -> tuple[list[tuple[int, Curve]], np.ndarray]:
    # End 2 k is the start of curve k, end 2 k + 1 its end; every end has one partner at most.
    if not curves:
        return [], np.zeros((0, 2))
    ends = np.array([point for _, curve in curves for point in (curve.start, curve.end)])
    partner = np.full(len(ends), -1)
    crowded = np.zeros(0, np.int64)
    # Ends that coincide belong together; only what is left over is joined across wider gaps.
    for reach in _REACHES:
        free = np.flatnonzero(partner < 0)
        if not len(free):
            break
        pairs = free[_close_pairs(ends[free], reach * size)]
        degree = np.bincount(pairs.ravel(), minlength=len(ends))
        crowded = np.flatnonzero(degree > 1)
        for a, b in pairs[(degree[pairs] == 1).all(axis=1)]:
            partner[a], partner[b] = b, a
    done = np.zeros(len(curves), bool)
    chains = []
    # Chains that have a loose end begin there; what is left are rings.
    loose = [end for end in range(len(ends)) if partner[end] < 0]
    for start in (*loose, *range(0, len(ends), 2)):
        if done[start // 2]:
            continue
        parts, here, first = [], start, start // 2
        while not done[here // 2]:
            k = here // 2
            done[k] = True
            first = min(first, k)
            parts.append(curves[k][1] if here % 2 == 0 else curves[k][1].turned())
            here = int(partner[here ^ 1])
            if here < 0:
                break
        chains.append((curves[first][0], joined(parts)))
    return chains, ends[crowded[partner[crowded] < 0]]


def _welded(curve: Curve) -> tuple[Curve, float]:
    # Each piece is bent by a linear term so that it ends exactly where the next begins.
    n = curve.n_pieces
    every = np.arange(n)
    ends = curve.evaluated(every, np.ones(n))[0]
    starts = curve.evaluated(every, np.zeros(n))[0]
    gaps = np.roll(starts, -1, axis=0) - ends
    cubic = curve.polynomials.copy()
    cubic[:, 1] += gaps
    largest = float(np.linalg.norm(gaps, axis=1).max())
    return (curve if largest == 0 else Curve.of_pieces(cubic, curve.waves, curve.angles)), largest
