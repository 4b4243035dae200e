"""Foot points on a curve: where it comes closest to given points."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Bool, Float, Int
from scipy.spatial import cKDTree

from kirisurf.outlines.curve import Curve

_STEPS = 100
"""Steps of Newton or of halving; halving alone ends after 53."""

_CHUNK = 20_000
"""Points that are looked at together, which bounds the memory."""


@dataclass(frozen=True, eq=False)
class FootPoints:
    """Feet of perpendiculars on a curve.

    Attributes
    ----------
    pieces : (n,) int
    s : (n,)
        Place on the piece, from 0 to 1.
    distances : (n,)
        Signed: positive on the right of the curve, the outside of a counter-clockwise one.
    """

    pieces: Int[np.ndarray, " n"]
    s: Float[np.ndarray, " n"]
    distances: Float[np.ndarray, " n"]


@dataclass(frozen=True, eq=False)
class FootFinder:
    """Finds foot points on one curve, with a search tree of its samples.

    Where d is a point's distance to the nearest sample, its foot lies in an interval of length L with ends at
    distances e, f such that (e + f - L) / 2 <= d. In every such interval where the distance goes down and up
    again, Newton's method for (x(s) - p).x'(s) = 0 is kept between the ends by halving.
    """

    curve: Curve

    def find(self, points: Float[np.ndarray, "n 2"]) -> FootPoints:
        """Return the foot points of points (n, 2)."""
        if not len(points):
            return FootPoints(np.zeros(0, np.int64), np.zeros(0), np.zeros(0))
        parts = [self._found(points[k : k + _CHUNK]) for k in range(0, len(points), _CHUNK)]
        return FootPoints(*(np.concatenate([part[k] for part in parts]) for k in range(3)))

    @cached_property
    def _tree(self) -> cKDTree:
        return cKDTree(self.curve.samples.points)

    @cached_property
    def _closed(self) -> bool:
        size = float(np.ptp(self.curve.samples.points, axis=0).max())
        return bool(np.abs(self.curve.end - self.curve.start).max() <= 1e-9 * size)

    def _found(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        best, nearest = self._tree.query(points)
        pieces, s, distances = self._at_samples(points, nearest)
        owner, interval = self._candidates(points, best)
        root_s = self._roots(points[owner], interval)
        root_pieces = self.curve.samples.pieces[interval]
        x, _, _ = self.curve.evaluated(root_pieces, root_s)
        away = np.linalg.norm(points[owner] - x, axis=1)
        order = np.lexsort((interval, away, owner))
        order = order[np.r_[True, np.diff(owner[order]) > 0]] if len(order) else order
        # A root as near as the sample is the better one: there the perpendicular is exact.
        order = order[away[order] <= best[owner[order]] * (1 + 1e-15)]
        chosen = owner[order]
        pieces[chosen], s[chosen] = root_pieces[order], root_s[order]
        normals = right_of(self.curve.tangents(pieces[chosen], s[chosen]))
        distances[chosen] = np.copysign(away[order], ((points[chosen] - x[order]) * normals).sum(axis=1))
        return pieces, s, distances

    def _at_samples(self, points: np.ndarray, nearest: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        # At a joint two pieces meet; that one counts whose normal points more towards the point.
        samples = self.curve.samples
        m = len(samples.pieces)
        # The end of a closed curve is its start.
        after = np.where(nearest == m, 0 if self._closed else m - 1, nearest)
        before = np.where(nearest == 0, m - 1 if self._closed else 0, nearest - 1)
        s_after = np.where((nearest == m) & (after == m - 1), 1.0, samples.low[after])
        s_before = np.where((nearest == 0) & (before == 0), 0.0, samples.high[before])
        away = points - samples.points[nearest]
        heights = [
            (away * right_of(self.curve.tangents(samples.pieces[k], s))).sum(axis=1)
            for k, s in ((after, s_after), (before, s_before))
        ]
        first = np.abs(heights[0]) >= np.abs(heights[1])
        distances = np.copysign(np.linalg.norm(away, axis=1), np.where(first, *heights))
        return samples.pieces[np.where(first, after, before)], np.where(first, s_after, s_before), distances

    def _candidates(self, points: np.ndarray, best: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        # Pairs (point, interval) in which the foot may lie: by the tree, by the bound, by the slopes at the ends.
        samples = self.curve.samples
        m = len(samples.pieces)
        reach = best + float(samples.lengths.max()) * (1 + 1e-9)
        near = self._tree.query_ball_point(points, reach * (1 + 1e-9), return_sorted=True)
        owner = np.repeat(np.arange(len(points)), [len(k) for k in near])
        ends = np.concatenate([np.asarray(k, dtype=np.int64) for k in near])
        key = np.unique(np.concatenate([owner * (m + 1) + ends, owner * (m + 1) + ends - 1])[np.r_[ends < m, ends > 0]])
        owner, interval = key // (m + 1), key % (m + 1)
        p, length = points[owner], samples.lengths[interval]
        e = np.linalg.norm(p - samples.points[interval], axis=1)
        f = np.linalg.norm(p - samples.points[interval + 1], axis=1)
        kept = e + f - length * (1 + 1e-9) <= 2 * best[owner] * (1 + 1e-12)
        owner, interval = owner[kept], interval[kept]
        pieces, p = samples.pieces[interval], points[owner]
        down = self._slope(p, pieces, samples.low[interval])[0] <= 0
        up = self._slope(p, pieces, samples.high[interval])[0] >= 0
        return owner[down & up], interval[down & up]

    def _roots(self, points: np.ndarray, interval: np.ndarray) -> np.ndarray:
        samples = self.curve.samples
        pieces = samples.pieces[interval]
        low, high = samples.low[interval].copy(), samples.high[interval].copy()
        s = 0.5 * (low + high)
        going = np.arange(len(s))
        for _ in range(_STEPS):
            if not len(going):
                break
            slope, change = self._slope(points[going], pieces[going], s[going])
            high[going] = np.where(slope >= 0, s[going], high[going])
            low[going] = np.where(slope <= 0, s[going], low[going])
            a, b = low[going], high[going]
            step = np.where(change > 0, slope / np.where(change > 0, change, 1.0), np.inf)
            wanted = s[going] - step
            newton = (wanted >= a) & (wanted <= b)
            following = np.where(newton, wanted, 0.5 * (a + b))
            ready = (np.abs(following - s[going]) <= 2e-16) | (a >= b)
            s[going] = following
            going = going[~ready]
        return s

    def _slope(self, points: np.ndarray, pieces: np.ndarray, s: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        x, first, second = self.curve.evaluated(pieces, s)
        away = x - points
        return (away * first).sum(axis=1), (first**2).sum(axis=1) + (away * second).sum(axis=1)

    def ends(self, feet: FootPoints) -> tuple[Bool[np.ndarray, " n"], Bool[np.ndarray, " n"]]:
        """Return where feet are the curve's first point (n,), and where its last (n,)."""
        last = self.curve.n_pieces - 1
        return (feet.pieces == 0) & (feet.s == 0.0), (feet.pieces == last) & (feet.s == 1.0)


def right_of(vectors: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 2"]:
    """Return vectors (n, 2) turned right by a quarter: tangents give outward normals."""
    return np.stack([vectors[:, 1], -vectors[:, 0]], axis=1)
