"""Smooth plane curves of consecutive pieces: cubic polynomials and arcs of ellipses in one formula.

Piece i is x(s) = c0 + c1 s + c2 s^2 + c3 s^3 + a cos(p + q s) + b sin(p + q s) for s from 0 to 1. A line, a
Bezier piece and a piece of a spline have a = b = 0; an arc has c1 = c2 = c3 = 0. Cutting, turning round and
affine maps keep that form, so that a circle stays a circle to rounding.

The parameter u of a curve of k pieces runs from 0 to k: the number of the piece plus s. Beyond its ends a curve
goes on along its tangents.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float, Int
from numpy.typing import ArrayLike

from kirisurf.arrays import frozen

_TURN = 0.1
"""Radians that a curve turns, at most, between two of its samples."""

_AT_ONCE = 20_000
"""Intervals that are measured together, which bounds the memory."""

_PARTS = 64
"""Parts of its length between two samples, at least: places are then looked for near where they are."""

_NODES, _WEIGHTS = (frozen(values) for values in np.polynomial.legendre.leggauss(12))


@dataclass(frozen=True, eq=False)
class Curve:
    """Consecutive pieces, each beginning where the one before ends.

    Attributes
    ----------
    polynomials : (k, 4, 2)
        c0 to c3 of every piece.
    waves : (k, 2, 2)
        a and b of every piece; zero where it is no arc.
    angles : (k, 2)
        p and q of every piece, in radians.
    """

    polynomials: Float[np.ndarray, "k 4 2"]
    waves: Float[np.ndarray, "k 2 2"]
    angles: Float[np.ndarray, "k 2"]

    @classmethod
    def of_pieces(
        cls, polynomials: ArrayLike, waves: ArrayLike | None = None, angles: ArrayLike | None = None
    ) -> Curve:
        """Return a curve with frozen copies of the arrays; without waves it is polynomial."""
        cubic = frozen(polynomials)
        k = len(cubic)
        return cls(
            cubic,
            frozen(np.zeros((k, 2, 2)) if waves is None else waves),
            frozen(np.zeros((k, 2)) if angles is None else angles),
        )

    @property
    def n_pieces(self) -> int:
        """Number of pieces."""
        return len(self.polynomials)

    @cached_property
    def start(self) -> Float[np.ndarray, " 2"]:
        """First point (2,)."""
        return frozen(self.evaluated(np.array([0]), np.array([0.0]))[0][0])

    @cached_property
    def end(self) -> Float[np.ndarray, " 2"]:
        """Last point (2,)."""
        return frozen(self.evaluated(np.array([self.n_pieces - 1]), np.array([1.0]))[0][0])

    @cached_property
    def length(self) -> float:
        """Length, in the curve's units."""
        return float(self.samples.lengths.sum())

    @cached_property
    def samples(self) -> Samples:
        """The curve cut into short, nearly straight intervals."""
        return _samples(self)

    def evaluated(
        self, pieces: Int[np.ndarray, " n"], s: Float[np.ndarray, " n"]
    ) -> tuple[Float[np.ndarray, "n 2"], Float[np.ndarray, "n 2"], Float[np.ndarray, "n 2"]]:
        """Return points, first and second derivatives in s, each (n, 2), of the given pieces at s."""
        c = self.polynomials[pieces]
        s = s[:, None]
        x = c[:, 0] + s * (c[:, 1] + s * (c[:, 2] + s * c[:, 3]))
        first = c[:, 1] + s * (2.0 * c[:, 2] + 3.0 * s * c[:, 3])
        second = 2.0 * c[:, 2] + 6.0 * s * c[:, 3]
        if self._has_waves:
            a, b = self.waves[pieces, 0], self.waves[pieces, 1]
            q = self.angles[pieces, 1][:, None]
            turn = self.angles[pieces, 0][:, None] + q * s
            cosine, sine = np.cos(turn), np.sin(turn)
            x = x + a * cosine + b * sine
            first = first + q * (b * cosine - a * sine)
            second = second - q**2 * (a * cosine + b * sine)
        return x, first, second

    def located(self, u: Float[np.ndarray, " n"]) -> tuple[Int[np.ndarray, " n"], Float[np.ndarray, " n"]]:
        """Return piece (n,) and s (n,) of parameters; s is below 0 or above 1 beyond the ends."""
        pieces = np.clip(np.floor(u), 0, self.n_pieces - 1).astype(np.int64)
        return pieces, u - pieces

    def points(self, u: Float[np.ndarray, " n"]) -> Float[np.ndarray, "n 2"]:
        """Return the points (n, 2) at parameters (n,), on the end tangents beyond the ends."""
        pieces, s = self.located(u)
        inside = np.clip(s, 0.0, 1.0)
        return self.evaluated(pieces, inside)[0] + (s - inside)[:, None] * self.speeds(pieces, inside)

    def speeds(self, pieces: Int[np.ndarray, " n"], s: Float[np.ndarray, " n"]) -> Float[np.ndarray, "n 2"]:
        """Return the first derivatives (n, 2), or where one vanishes a vector along the tangent.

        A Bezier piece with a handle of no length stands still at its end; its tangent is then that of the
        points just inside.
        """
        _, first, second = self.evaluated(pieces, s)
        scale = np.linalg.norm(self.polynomials[pieces, 1:], axis=2).sum(axis=1)
        still = np.linalg.norm(first, axis=1) <= 1e-9 * scale
        if still.any():
            inward = np.where(s < 0.5, 1.0, -1.0)[:, None]
            near = self.evaluated(pieces, s + 1e-6 * inward[:, 0])[1]
            straight = np.linalg.norm(second, axis=1) > 1e-9 * scale
            first = np.where(still[:, None], np.where(straight[:, None], inward * second, near), first)
        return first

    def tangents(self, pieces: Int[np.ndarray, " n"], s: Float[np.ndarray, " n"]) -> Float[np.ndarray, "n 2"]:
        """Return unit tangents (n, 2)."""
        speeds = self.speeds(pieces, s)
        return speeds / np.linalg.norm(speeds, axis=1, keepdims=True)

    def curvatures(self, pieces: Int[np.ndarray, " n"], s: Float[np.ndarray, " n"]) -> Float[np.ndarray, " n"]:
        """Return signed curvatures (n,), positive where the curve turns left; 0 where it stands still."""
        _, first, second = self.evaluated(pieces, s)
        speed = np.linalg.norm(first, axis=1)
        scale = np.linalg.norm(self.polynomials[pieces, 1:], axis=2).sum(axis=1)
        turning = first[:, 0] * second[:, 1] - first[:, 1] * second[:, 0]
        still = speed <= 1e-9 * scale
        return np.where(still, 0.0, turning / np.where(still, 1.0, speed) ** 3)

    def part(self, first: float, last: float) -> Curve:
        """Return the curve between two parameters, turned round where the last is the smaller."""
        low, high = min(first, last), max(first, last)
        pieces = np.arange(int(np.floor(low)), max(int(np.ceil(high)), int(np.floor(low)) + 1))
        pieces = pieces[(pieces >= 0) & (pieces < self.n_pieces)]
        a, b = np.clip(low - pieces, 0.0, 1.0), np.clip(high - pieces, 0.0, 1.0)
        if first > last:
            pieces, a, b = pieces[::-1], b[::-1], a[::-1]
        c, d = self.polynomials[pieces], (b - a)[:, None]
        a = a[:, None]
        cubic = np.stack(
            [
                c[:, 0] + a * (c[:, 1] + a * (c[:, 2] + a * c[:, 3])),
                d * (c[:, 1] + a * (2.0 * c[:, 2] + 3.0 * a * c[:, 3])),
                d**2 * (c[:, 2] + 3.0 * a * c[:, 3]),
                d**3 * c[:, 3],
            ],
            axis=1,
        )
        p, q = self.angles[pieces].T
        return Curve.of_pieces(cubic, self.waves[pieces], np.stack([p + q * a[:, 0], q * d[:, 0]], axis=1))

    def turned(self) -> Curve:
        """Return the same curve run through the other way."""
        return self.part(float(self.n_pieces), 0.0)

    def transformed(self, matrix: Float[np.ndarray, "2 2"], shift: Float[np.ndarray, " 2"]) -> Curve:
        """Return the image of the curve under x -> matrix x + shift."""
        cubic = self.polynomials @ matrix.T
        cubic[:, 0] += shift
        return Curve.of_pieces(cubic, self.waves @ matrix.T, self.angles)

    def evenly(self, count: int) -> Float[np.ndarray, " m"]:
        """Return count + 1 parameters from end to end that are evenly spaced along the length."""
        ends = np.concatenate([[0.0], np.cumsum(self.samples.lengths)])
        marks = np.concatenate([self.samples.pieces + self.samples.low, [float(self.n_pieces)]])
        wanted = np.linspace(0.0, ends[-1], count + 1)
        k = np.clip(np.searchsorted(ends, wanted, side="right") - 1, 0, len(ends) - 2)
        u = marks[k] + (wanted - ends[k]) / (ends[k + 1] - ends[k]) * (marks[k + 1] - marks[k])
        u[0], u[-1] = 0.0, float(self.n_pieces)
        return u

    @cached_property
    def green_area(self) -> float:
        """Half the integral of x dy - y dx about the first point: the area inside, where the curve is closed."""
        s = 0.5 * (_NODES + 1.0)
        pieces = np.repeat(np.arange(self.n_pieces), len(s))
        x, first, _ = self.evaluated(pieces, np.tile(s, self.n_pieces))
        x = x - self.start
        return 0.25 * float(np.tile(_WEIGHTS, self.n_pieces) @ (x[:, 0] * first[:, 1] - x[:, 1] * first[:, 0]))

    @cached_property
    def _has_waves(self) -> bool:
        return bool(self.waves.any())


@dataclass(frozen=True, eq=False)
class Samples:
    """Intervals of a curve in which it turns little, in the order of the curve.

    Attributes
    ----------
    pieces : (m,) int
    low, high : (m,)
        Ends in s.
    lengths : (m,)
    points : (m + 1, 2)
        Where the intervals begin, and the curve's end.
    """

    pieces: Int[np.ndarray, " m"]
    low: Float[np.ndarray, " m"]
    high: Float[np.ndarray, " m"]
    lengths: Float[np.ndarray, " m"]
    points: Float[np.ndarray, "e 2"]


def joined(curves: Sequence[Curve]) -> Curve:
    """Return one curve of the pieces of all."""
    return Curve.of_pieces(
        np.concatenate([curve.polynomials for curve in curves]),
        np.concatenate([curve.waves for curve in curves]),
        np.concatenate([curve.angles for curve in curves]),
    )


def _samples(curve: Curve) -> Samples:
    k = curve.n_pieces
    every = np.arange(k)
    ends, s = 9, np.linspace(0.0, 1.0, 9)
    tangents = curve.tangents(np.repeat(every, ends), np.tile(s, k)).reshape(k, ends, 2)
    before, after = tangents[:, :-1], tangents[:, 1:]
    turns = np.arctan2(before[..., 0] * after[..., 1] - before[..., 1] * after[..., 0], (before * after).sum(axis=2))
    rough = _lengths(curve, every, np.zeros(k), np.ones(k))
    count = np.ceil(np.maximum(np.abs(turns).sum(axis=1) / _TURN, _PARTS * rough / rough.sum())).astype(np.int64)
    curved = curve.polynomials[:, 2:].any(axis=(1, 2)) | curve.waves.any(axis=(1, 2))
    count = np.maximum(count, np.where(curved, 4, 1))
    pieces = np.repeat(every, count)
    place = np.arange(len(pieces)) - np.repeat(np.cumsum(count) - count, count)
    low, high = place / count[pieces], (place + 1) / count[pieces]
    points = np.concatenate([curve.evaluated(pieces, low)[0], curve.end[None]])
    return Samples(
        frozen(pieces, np.int64), frozen(low), frozen(high), frozen(_lengths(curve, pieces, low, high)), frozen(points)
    )


def _lengths(curve: Curve, pieces: np.ndarray, low: np.ndarray, high: np.ndarray) -> np.ndarray:
    if len(pieces) > _AT_ONCE:
        parts = [slice(k, k + _AT_ONCE) for k in range(0, len(pieces), _AT_ONCE)]
        return np.concatenate([_lengths(curve, pieces[part], low[part], high[part]) for part in parts])
    s = low[:, None] + 0.5 * (high - low)[:, None] * (_NODES + 1.0)
    speed = np.linalg.norm(curve.evaluated(np.repeat(pieces, len(_NODES)), s.ravel())[1], axis=1)
    return 0.5 * (high - low) * (speed.reshape(s.shape) @ _WEIGHTS)
