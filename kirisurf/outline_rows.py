"""Prescribed outlines as rows of the problem: of the deployed sheet in the plane, and of the contracted one."""

from __future__ import annotations

from abc import abstractmethod
from typing import Protocol, runtime_checkable

import numpy as np

from kirisurf.block import Block
from kirisurf.constraints.linear import LinearRows
from kirisurf.constraints.outline import OnOutline, OnScaledOutline
from kirisurf.outlines import Outline
from kirisurf.rim import Rim

CLEARANCE = 0.02
"""Distance (tile edges) that the outer vertices of a side keep from its corners, along it."""


@runtime_checkable
class OutlineRows(Protocol):
    """Rows that hold a sheet to an outline, with closest points renewed at given points; stencils never change."""

    @abstractmethod
    def equalities_at(self, points: np.ndarray) -> tuple[Block, ...]:
        """Return the rows that vanish."""

    @abstractmethod
    def inequalities_at(self, points: np.ndarray) -> tuple[Block, ...]:
        """Return the rows that are not negative."""


class FollowsOutline:
    """Vertices of a rim lie on an outline, those of a side on that side, and no other vertex lies outside.

    Parameters
    ----------
    name : str
    rim : Rim
    others : (k,) int
        Outer vertices that are not of the rim.
    outline : Outline
        In units of the problem; with four sides where the rim has sides.
    start : (q, 3)
        Points of the problem.
    """

    def __init__(self, name: str, rim: Rim, others: np.ndarray, outline: Outline, start: np.ndarray) -> None:
        self._name, self._outline, self._others = name, outline, others
        self._vertices, self._sides, self._has_sides = rim.vertices, rim.sides, rim.has_sides
        self._clear = _clear_of_corners(rim, outline, start) if rim.has_sides else ()

    def equalities_at(self, points: np.ndarray) -> tuple[Block, ...]:
        """Return the rows at `points`."""
        here = points[self._vertices, :2]
        if self._has_sides:
            found = self._outline.project(here, self._sides, extended=True)
        else:
            found = self._outline.project(here)
        return (OnOutline(self._name, self._vertices, found),)

    def inequalities_at(self, points: np.ndarray) -> tuple[Block, ...]:
        """Return the rows at `points`."""
        if not len(self._others):
            return self._clear
        found = self._outline.project(points[self._others, :2])
        return (*self._clear, OnOutline("inside", self._others, found, inside=True))


class ApproachesOutline:
    """Vertices of a rim lie at given distances from an outline, and some at given places near its corners.

    Parameters
    ----------
    name : str
    vertices, others : (k,) int, (o,) int
        Of the rim, and outer ones that are not.
    offsets, most : (k,), (o,)
        Signed distances, positive outside: those of the rim, and the largest ones of the others.
    outline : Outline
        In units of the problem.
    pinned : (c,) int
    places : (c, 2)
    """

    def __init__(
        self,
        name: str,
        vertices: np.ndarray,
        others: np.ndarray,
        offsets: np.ndarray,
        most: np.ndarray,
        outline: Outline,
        pinned: np.ndarray,
        places: np.ndarray,
    ) -> None:
        self._name, self._vertices, self._offsets, self._outline = name, vertices, offsets, outline
        self._others, self._most = others, most
        self._pins = _at_places(name, pinned, places)

    def equalities_at(self, points: np.ndarray) -> tuple[Block, ...]:
        """Return the rows at `points`."""
        found = self._outline.project(points[self._vertices, :2])
        rows = OnOutline(self._name, self._vertices, found, self._offsets)
        return (rows,) if self._pins is None else (rows, self._pins)

    def inequalities_at(self, points: np.ndarray) -> tuple[Block, ...]:
        """Return the rows at `points`."""
        if not len(self._others):
            return ()
        found = self._outline.project(points[self._others, :2])
        return (OnOutline("inside", self._others, found, self._most, inside=True),)


class FollowsScaledOutline:
    """Vertices of a contracted rim lie on an outline whose size is unknown.

    Parameters
    ----------
    name : str
    rim : Rim
        With four sides, each in its own order; its vertices are those of the problem.
    outline : Outline
        With four sides, centered.
    size : int
        Vertex of the problem whose first coordinate is the size.
    """

    def __init__(self, name: str, rim: Rim, outline: Outline, size: int) -> None:
        self._name, self._rim, self._outline, self._size = name, rim, outline, size
        self._within = _within_scaled_sides(rim, outline, size) if rim.has_sides else ()

    def equalities_at(self, points: np.ndarray) -> tuple[Block, ...]:
        """Return the rows at `points`."""
        here = points[self._rim.vertices, :2] / points[self._size, 0]
        sides = self._rim.sides if self._rim.has_sides else None
        found = self._outline.project(here, sides, extended=sides is not None)
        rows = OnScaledOutline(self._name, self._rim.vertices, self._size, found)
        # the size is one number: the second coordinate of its point would be a freedom that is none
        unused = LinearRows("size", np.array([[self._size]]), np.array([[[0.0, 1.0, 0.0]]]), np.zeros(1))
        return rows, unused

    def inequalities_at(self, points: np.ndarray) -> tuple[Block, ...]:
        """Return the rows that keep the first and the last vertex of every side on it."""
        return self._within


class IsRectangle:
    """The four sides of a contracted rim are straight and along the axes; its proportions may be given.

    Parameters
    ----------
    name : str
    rim : Rim
        With four sides; its vertices are those of the problem.
    ratio : float, optional
        Width over height.
    """

    def __init__(self, name: str, rim: Rim, ratio: float | None) -> None:
        stencils, coefficients = [], []
        for k, axis in enumerate((1, 0, 1, 0)):
            vertices = np.unique(rim.side(k))
            pairs = np.stack([vertices[:-1], vertices[1:]], axis=1)
            rows = np.zeros((len(pairs), 2, 3))
            rows[:, 0, axis], rows[:, 1, axis] = 1.0, -1.0
            stencils.append(pairs)
            coefficients.append(rows)
        pairs, rows = np.concatenate(stencils), np.concatenate(coefficients)
        blocks = [LinearRows(name, pairs, rows, np.zeros(len(pairs)))]
        if ratio is not None:
            bottom, right, top, left = (int(rim.side(k)[0]) for k in range(4))
            row = np.zeros((1, 4, 3))
            row[0, 0, 0], row[0, 1, 0], row[0, 2, 1], row[0, 3, 1] = 1.0, -1.0, -ratio, ratio
            blocks.append(LinearRows(name, np.array([[right, left, top, bottom]]), row, np.zeros(1)))
        self._blocks = tuple(blocks)
        self._within = _between_neighbors(rim)

    def equalities_at(self, points: np.ndarray) -> tuple[Block, ...]:
        """Return the rows, which are linear."""
        return self._blocks

    def inequalities_at(self, points: np.ndarray) -> tuple[Block, ...]:
        """Return the rows that keep the vertices of a side between its corners."""
        return (self._within,)


def _within_scaled_sides(rim: Rim, outline: Outline, size: int) -> tuple[Block, ...]:
    """At size s, t.(y - s c) >= 0 with the tangent t at a side's corner c, into the side."""
    stencil, coefficients = [], []
    for k, side in enumerate(outline.sides):
        vertices = rim.side(k)
        for vertex, corner, u, sign in (
            (vertices[0], side.start, 0.0, 1.0),
            (vertices[-1], side.end, float(side.n_pieces), -1.0),
        ):
            if np.count_nonzero(rim.vertices == vertex) > 1:
                # on both sides, and so in their corner
                continue
            along = sign * side.tangents(*side.located(np.array([u])))[0]
            stencil.append([vertex, size])
            coefficients.append([[along[0], along[1], 0.0], [-float(along @ corner), 0.0, 0.0]])
    if not stencil:
        return ()
    return (LinearRows("side", np.array(stencil), np.array(coefficients), np.zeros(len(stencil))),)


def _between_neighbors(rim: Rim) -> LinearRows:
    """Vertices of a side lie between the two sides next to it."""
    stencil, coefficients = [], []
    for k, axis in enumerate((1, 0, 1, 0)):
        along = 1 - axis
        ends = np.unique(np.concatenate([rim.side((k - 1) % 4), rim.side((k + 1) % 4)]))
        # bottom and top run between left and right, the others between bottom and top
        low, high = (3, 1) if along == 0 else (0, 2)
        first, last = int(rim.side(low)[0]), int(rim.side(high)[0])
        for vertex in np.setdiff1d(rim.side(k), ends):
            for pair, signs in (((vertex, first), (1.0, -1.0)), ((last, vertex), (1.0, -1.0))):
                row = np.zeros((2, 3))
                row[:, along] = signs
                stencil.append(pair)
                coefficients.append(row)
    rows = np.array(coefficients).reshape(-1, 2, 3)
    return LinearRows("side", np.array(stencil, dtype=np.int64).reshape(-1, 2), rows, np.zeros(len(rows)))


def _at_places(name: str, vertices: np.ndarray, places: np.ndarray) -> LinearRows | None:
    if not len(vertices):
        return None
    rows = np.zeros((len(vertices), 2, 1, 3))
    rows[:, 0, 0, 0] = rows[:, 1, 0, 1] = 1.0
    return LinearRows(name, np.repeat(vertices, 2)[:, None], rows.reshape(-1, 1, 3), places.ravel())


def _clear_of_corners(rim: Rim, outline: Outline, start: np.ndarray) -> tuple[Block, ...]:
    """The first and the last vertex of every side stay on it: beyond a corner its extension is not the outline."""
    stencil, coefficients, constants = [], [], []
    for k, side in enumerate(outline.sides):
        vertices = rim.side(k)
        order = np.argsort(outline.project(start[vertices, :2], np.full(len(vertices), k), extended=True).parameters)
        for vertex, corner, u, sign in (
            (vertices[order[0]], side.start, 0.0, 1.0),
            (vertices[order[-1]], side.end, float(side.n_pieces), -1.0),
        ):
            along = sign * side.tangents(*side.located(np.array([u])))[0]
            stencil.append([vertex])
            coefficients.append([[along[0], along[1], 0.0]])
            constants.append(float(along @ corner) + CLEARANCE)
    return (LinearRows("side", np.array(stencil), np.array(coefficients), np.array(constants)),)
