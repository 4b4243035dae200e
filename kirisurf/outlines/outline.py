"""The planar outline: an immutable closed curve, counter-clockwise, of smooth sides that meet at corners."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import shapely
from jaxtyping import Float, Int
from numpy.typing import ArrayLike

from kirisurf.arrays import checked, frozen
from kirisurf.errors import ParameterError, UnusableError
from kirisurf.outlines.corners import CORNER_ANGLE, check_corner_count, corner_parameters, cut, four_sided
from kirisurf.outlines.curve import Curve, joined
from kirisurf.outlines.foot_points import FootFinder
from kirisurf.outlines.outline_projection import OutlineProjection, on_all_sides, on_given_sides
from kirisurf.outlines.simple import require_simple

_GAP = 1e-9
"""Part of the diagonal by which the ends of consecutive sides may differ."""


@dataclass(frozen=True, eq=False)
class Outline:
    """A closed curve without crossings, counter-clockwise.

    Attributes
    ----------
    name : str
    sides : tuple of Curve
        Each begins where the one before ends, at a corner.
    is_smooth : bool
        True for a single side that closes without a corner.
    units : str or None
        Length unit of the coordinates where it is known: um, mm, cm, m, in or ft.
    """

    name: str
    sides: tuple[Curve, ...]
    is_smooth: bool = False
    units: str | None = None

    @classmethod
    def from_sides(
        cls, sides: Sequence[Curve], name: str = "outline", units: str | None = None, is_smooth: bool = False
    ) -> Outline:
        """Return the outline of consecutive curves, turned counter-clockwise.

        Raises
        ------
        UnusableError
            Where the curves do not meet, enclose no area, or cross.
        """
        if not sides or (is_smooth and len(sides) > 1):
            raise UnusableError(f"{name}: expected {'one side' if is_smooth else 'sides'}, got {len(sides)}")
        check_corner_count(len(sides), name)
        found = tuple(sides)
        samples = np.concatenate([side.samples.points for side in found])
        if not np.isfinite(samples).all():
            raise UnusableError(f"{name}: expected finite coordinates, got others")
        diagonal = float(np.linalg.norm(np.ptp(samples, axis=0)))
        for k, side in enumerate(found):
            following = found[(k + 1) % len(found)].start
            gap = float(np.linalg.norm(side.end - following))
            if gap > _GAP * diagonal:
                raise UnusableError(
                    f"{name}: expected consecutive sides to meet, got a gap of {gap:.3g} at {_place(side.end)}"
                )
        area = joined(found).green_area
        require_simple(np.concatenate([side.samples.points[:-1] for side in found]), name)
        if not abs(area) > 1e-9 * diagonal**2:
            raise UnusableError(f"{name}: expected a curve round an area, got {area:.3g} for a size of {diagonal:.3g}")
        if area < 0:
            found = tuple(side.turned() for side in reversed(found))
        return cls(name, found, is_smooth, units)

    @classmethod
    def from_curve(cls, curve: Curve, name: str = "outline", units: str | None = None) -> Outline:
        """Return the outline of a closed curve, cut at the corners that it has.

        Raises
        ------
        UnusableError
            As :meth:`from_sides`.
        """
        whole = cls.from_sides([curve], name, units)
        return whole.with_corners(whole.find_corners())

    @property
    def n_sides(self) -> int:
        """Number of sides."""
        return len(self.sides)

    @property
    def n_corners(self) -> int:
        """Number of corners: that of the sides, or 0 for a smooth curve."""
        return 0 if self.is_smooth else len(self.sides)

    @cached_property
    def corners(self) -> Float[np.ndarray, "c 2"]:
        """Corners (c, 2): where the sides begin."""
        return frozen(np.reshape([side.start for side in self.sides[: self.n_corners]], (-1, 2)))

    @cached_property
    def curve(self) -> Curve:
        """All sides as one closed curve; side k begins at parameter `offsets[k]`."""
        return joined(self.sides)

    @cached_property
    def offsets(self) -> Int[np.ndarray, " e"]:
        """Number of pieces before every side, and of all."""
        return frozen(np.cumsum([0] + [side.n_pieces for side in self.sides]), np.int64)

    @cached_property
    def area(self) -> float:
        """Area inside, in squared units."""
        return self.curve.green_area

    @cached_property
    def length(self) -> float:
        """Length of the whole curve, in the outline's units."""
        return self.curve.length

    @cached_property
    def box(self) -> Float[np.ndarray, "2 2"]:
        """Lower and upper corner (2, 2) of the axis-aligned bounding box, to second order in the sampling."""
        points = self.curve.samples.points
        return frozen([points.min(axis=0), points.max(axis=0)])

    @cached_property
    def diagonal(self) -> float:
        """Length of the diagonal of the bounding box, in the outline's units."""
        return float(np.linalg.norm(self.box[1] - self.box[0]))

    @cached_property
    def polygon(self) -> shapely.Polygon:
        """The area inside with its curve cut into short chords."""
        return shapely.Polygon(self.curve.samples.points[:-1])

    def polyline(self, spacing: float) -> Float[np.ndarray, "b 2"]:
        """Return points (b, 2) of the curve, at most about `spacing` apart, every corner among them.

        Raises
        ------
        ParameterError
            Where the spacing is not positive, or asks for more than ten million points.
        """
        if not spacing > 0 or self.length / spacing > 1e7:
            raise ParameterError(f"spacing: expected more than {self.length / 1e7:.3g}, got {spacing:g}")
        parts = [side.points(side.evenly(max(1, math.ceil(side.length / spacing)))[:-1]) for side in self.sides]
        return np.concatenate(parts)

    def project(
        self, points: Float[np.ndarray, "n 2"], sides: Int[np.ndarray, " n"] | None = None, extended: bool = False
    ) -> OutlineProjection:
        """Return the closest points of points (n, 2).

        Parameters
        ----------
        points : (n, 2)
        sides : (n,) int, optional
            The side on which each point is projected; by default the closest one.
        extended : bool
            With `sides`: a point whose closest one on its side is an end goes to the tangent there instead, so
            that the signed distance stays smooth beyond a corner.

        Raises
        ------
        ParameterError
            Where there is no such side, or `extended` comes without sides.
        """
        if sides is None:
            if extended:
                raise ParameterError("extended: expected sides to extend, got none")
            return on_all_sides(self._finder, self.offsets, points)
        if len(sides) and (sides.min() < 0 or sides.max() >= self.n_sides):
            raise ParameterError(f"sides: expected 0 to {self.n_sides - 1}, got {sides.min()} to {sides.max()}")
        return on_given_sides(self._side_finders, points, sides, extended and not self.is_smooth)

    def find_corners(self, angle: float = CORNER_ANGLE) -> Float[np.ndarray, " c"]:
        """Return parameters (c,) of `curve` where it turns by more than an angle (radians) at one place."""
        return corner_parameters(self.curve, angle)

    def with_corners(self, marks: ArrayLike) -> Outline:
        """Return a copy with the given corners and no others.

        Parameters
        ----------
        marks : (c,) or (c, 2)
            Parameters of `curve`, or points, of which the closest ones on the curve are taken. None of them
            makes a smooth outline.

        Raises
        ------
        UnusableError
            Where they have another shape, are not finite, or coincide.
        """
        given = np.asarray(marks, dtype=np.float64)
        if given.ndim == 2:
            feet = self._finder.find(checked(given, "corners", (None, 2)))
            given = feet.pieces + feet.s
        wanted = checked(given, "corners", (None,))
        check_corner_count(len(wanted), self.name)
        if not len(wanted):
            return replace(self, sides=(self.curve,), is_smooth=True)
        return replace(self, sides=cut(self.curve, wanted), is_smooth=False)

    def four_sides(self, corners: ArrayLike | None = None) -> tuple[Outline, str]:
        """Return a copy with four sides (bottom, right, top, left) and a sentence on how its corners were chosen.

        The corners are those given; or the outline's own, or those where it turns, where there are four; or
        else the points that reach farthest towards the corners of the smallest rectangle round it.

        Parameters
        ----------
        corners : (4,) or (4, 2), optional
            As :meth:`with_corners` takes them.

        Raises
        ------
        UnusableError
            Where the given corners are not four different places.
        """
        return four_sided(self, corners)

    def with_first_side(self, k: int) -> Outline:
        """Return a copy whose sides are counted from side k on."""
        return replace(self, sides=self.sides[k:] + self.sides[:k])

    def moved(self, shift: ArrayLike) -> Outline:
        """Return a copy moved by a vector (2,)."""
        return self.transformed(np.eye(2), shift)

    def scaled(self, factor: float) -> Outline:
        """Return a copy with all coordinates multiplied by a positive factor."""
        if not (factor > 0 and math.isfinite(factor)):
            raise ParameterError(f"factor: expected a positive number, got {factor!r}")
        return self.transformed(factor * np.eye(2), np.zeros(2))

    def transformed(self, matrix: ArrayLike, shift: ArrayLike | None = None) -> Outline:
        """Return the image under x -> matrix x + shift; a reflected one is turned counter-clockwise again.

        Raises
        ------
        ParameterError
            Where the matrix (2, 2) has no inverse.
        """
        linear, offset = (
            checked(matrix, "matrix", (2, 2)),
            checked(np.zeros(2) if shift is None else shift, "shift", (2,)),
        )
        sign = float(np.linalg.det(linear))
        if not abs(sign) > 1e-12 * float(np.abs(linear).max()) ** 2:
            raise ParameterError(f"matrix: expected one that has an inverse, got {linear.tolist()}")
        sides = tuple(side.transformed(linear, offset) for side in self.sides)
        return replace(self, sides=sides if sign > 0 else tuple(side.turned() for side in reversed(sides)))

    @cached_property
    def _finder(self) -> FootFinder:
        return FootFinder(self.curve)

    @cached_property
    def _side_finders(self) -> tuple[FootFinder, ...]:
        return tuple(FootFinder(side) for side in self.sides)


def _place(point: np.ndarray) -> str:
    return f"({point[0]:.6g}, {point[1]:.6g})"
