"""The cut pattern: the lines that a cutter follows in the flat sheet, each slit once.

A slit runs from hinge to hinge, or from the rim to a hinge. At a hinge it stops short, so that a ligament
of the hinge width remains between its tip and the slit (or the rim) across it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from kirisurf.arrays import checked, frozen
from kirisurf.contours import contours, welded_points
from kirisurf.errors import ParameterError
from kirisurf.kerf import Ray, clearance, compensated_contours
from kirisurf.slits import SlitPath, slit_paths
from kirisurf.tessellation import Tessellation

_AUTOMATIC_WIDTH = 0.04  # of the median tile edge: holds paper and thin sheet, and leaves the tiles rigid
_LONGEST_TIP = 0.5  # a hinge may take at most this part of the slit's last edge
_LONGEST_OF_TWO = 0.4  # where both ends of one edge are hinges: a fifth of the edge is always cut


@dataclass(frozen=True, eq=False)
class Cuts:
    """The lines of a flat sheet.

    Attributes
    ----------
    slits : tuple of (k, 2) arrays
        One open polyline for every slit, shortened at its hinges, in the units of the points.
    whole : tuple of (k, 2) arrays
        The same before shortening, from hinge to hinge.
    hinges : (m, 2)
        Middle of the ligament at every hinge end of a slit.
    outline : (o, 2)
        Outer contour, counter-clockwise, not closed by a repeated point.
    openings : tuple of (k, 2) arrays
        All other contours: clockwise for a designed opening.
    hinge_width : float
        Length of the ligament that remains at a hinge, along the slit, in the units of the points.
    kerf : float
        Width of the cut that the lines are compensated for (:mod:`kirisurf.kerf`).
    narrowed : int
        Number of hinges that are narrower, because theirs would have swallowed most of the slit.
    narrowest : float
        Width of the narrowest hinge.
    bare : int
        Number of hinges that no slit runs into: their tiles touch in a point, with nothing to hold them.
    """

    slits: tuple[np.ndarray, ...]
    hinges: Float[np.ndarray, "m 2"]
    outline: Float[np.ndarray, "o 2"]
    hinge_width: float
    whole: tuple[np.ndarray, ...] = ()
    openings: tuple[np.ndarray, ...] = ()
    kerf: float = 0.0
    narrowed: int = 0
    narrowest: float = np.inf
    bare: int = 0

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences on what is not as it was asked for."""
        said = []
        if self.narrowed:
            said.append(
                f"--hinge-width: {self.narrowed} of {len(self.hinges)} hinges are narrower than "
                f"{self.hinge_width:.6g} (down to {self.narrowest:.6g}): hinges of that width would swallow most of "
                "their slits."
            )
        if self.bare:
            said.append(
                f"{self.bare} hinges lie between openings: their tiles touch in a point only, and fall apart when cut."
            )
        return tuple(said)

    @property
    def box(self) -> tuple[np.ndarray, np.ndarray]:
        """Lowest and highest coordinates (2,) of what is cut, half a kerf round the outline included."""
        return self.outline.min(axis=0) - 0.5 * self.kerf, self.outline.max(axis=0) + 0.5 * self.kerf


def cuts(
    tessellation: Tessellation, contracted: np.ndarray, hinge_width: float | None = None, kerf: float = 0.0
) -> Cuts:
    """Return the cut lines of a contracted sheet.

    Parameters
    ----------
    tessellation : Tessellation
        Tiles of any number of corners.
    contracted : (n, 2)
        Contracted points; the copies of a welded vertex are averaged.
    hinge_width : float, optional
        In the units of the points; by default 4 % of the median tile edge, less where slits are short.
        A hinge that would take more than half of the last edge of its slit is made narrower, and counted.
    kerf : float
        Width of the cut: slits end earlier and the outline runs outside, so that hinges and part keep
        their size.

    Raises
    ------
    ParameterError
        Where the hinges would be longer than half of the median last edge of a slit, or the kerf is as wide
        as a hinge.

    Examples
    --------
    >>> from kirisurf.pattern import quad_pattern
    >>> pattern = quad_pattern(2, 2)
    >>> len(cuts(pattern, pattern.contracted).slits)
    15
    """
    points = welded_points(tessellation, checked(contracted, "contracted points", (tessellation.n_vertices, 2)))
    paths = slit_paths(tessellation)
    outline, openings = contours(tessellation)
    ends = [end for path in paths for end in _hinge_ends(path)]
    lengths = np.array([np.linalg.norm(points[inner] - points[vertex]) for vertex, inner, _ in ends])
    width = _checked_width(hinge_width, tessellation, points, lengths)
    if kerf and not (np.isfinite(kerf) and 0 <= kerf < width):
        raise ParameterError(
            f"--kerf: expected a number from 0 to less than the hinge width {width:.6g}, got {kerf:.6g}"
        )
    rays = _rays(paths, points, (outline, *openings)) if kerf else {}

    slits, whole, hinges, widths = [], [], [], []
    for path in paths:
        line = points[list(path.vertices)]
        whole.append(frozen(line))
        line = line.copy()
        for vertex, inner, tip in _hinge_ends(path):
            along = points[inner] - points[vertex]
            length = float(np.linalg.norm(along))
            along = along / (length or 1.0)  # an edge without length: a state that was saved before its solve ended
            inset = 0.0
            if kerf:
                inset = clearance(along, [ray for key, ray in rays[vertex] if key != (vertex, inner)], kerf)
            both = len(path.vertices) == 2 and path.starts_at_hinge and path.ends_at_hinge
            back = min(width + inset, (_LONGEST_OF_TWO if both else _LONGEST_TIP) * length)
            if kerf and back <= inset:
                raise ParameterError(
                    f"--kerf: expected a cut that leaves a hinge at every end of a slit, got {kerf:.6g}, which takes "
                    f"{inset:.6g} where a slit's last edge is {length:.6g}"
                )
            line[tip] = points[vertex] + back * along
            widths.append(back - inset)
            hinges.append(points[vertex] + (back - 0.5 * (kerf + widths[-1])) * along)
        slits.append(frozen(line))
    narrowed = int(np.sum(np.array(widths) < width * (1 - 1e-9)))
    outer, inner_contours = compensated_contours(points[outline], [points[loop] for loop in openings], kerf)
    return Cuts(
        slits=tuple(slits),
        hinges=frozen(np.array(hinges).reshape(-1, 2)),
        outline=frozen(outer),
        hinge_width=width,
        whole=tuple(whole),
        openings=tuple(frozen(loop) for loop in inner_contours),
        kerf=float(kerf),
        narrowed=narrowed,
        narrowest=min(widths, default=np.inf),
        bare=len(np.setdiff1d(tessellation.hinges[:, 1], tessellation.hinges[tessellation.slit_ends, 1])),
    )


def _hinge_ends(path: SlitPath) -> list[tuple[int, int, int]]:
    """(hinge, next vertex, place in the path) of the ends of a path that are hinges."""
    v = path.vertices
    ends = [(v[0], v[1], 0)] if path.starts_at_hinge else []
    return ends + ([(v[-1], v[-2], -1)] if path.ends_at_hinge else [])


def _rays(
    paths: Sequence[SlitPath], points: np.ndarray, loops: Sequence[np.ndarray]
) -> dict[int, list[tuple[tuple[int, int], Ray]]]:
    """All lines that leave a welded vertex: ((vertex, next vertex), (kind, unit vector))."""
    found: dict[int, list[tuple[tuple[int, int], Ray]]] = {}

    def add(kind: str, a: int, b: int) -> None:
        along = points[b] - points[a]
        length = float(np.linalg.norm(along))
        if length > 0:
            found.setdefault(a, []).append(((a, b), (kind, along / length)))

    for path in paths:
        v = path.vertices
        for k in range(len(v) - 1):
            add("tip" if k == 0 and path.starts_at_hinge else "slit", v[k], v[k + 1])
            add("tip" if k == len(v) - 2 and path.ends_at_hinge else "slit", v[k + 1], v[k])
    for loop in loops:
        for a, b in zip(loop.tolist(), np.roll(loop, -1).tolist(), strict=True):
            add("rim", a, b)
            add("rim", b, a)
    return found


def _checked_width(width: float | None, tessellation: Tessellation, points: np.ndarray, lengths: np.ndarray) -> float:
    tiles = tessellation.tiles
    edge = points[tessellation.weld[tiles.successors]] - points[tessellation.weld[tiles.indices]]
    median = float(np.median(np.linalg.norm(edge, axis=1)))
    if width is None:
        shortest = float(lengths.min()) if len(lengths) else np.inf
        return min(_AUTOMATIC_WIDTH * median, 0.5 * _LONGEST_TIP * shortest)
    longest = _LONGEST_TIP * float(np.median(lengths)) if len(lengths) else np.inf
    if not np.isfinite(width) or not 0 < width <= longest * (1 + 1e-12):
        raise ParameterError(
            f"--hinge-width: expected more than 0 and at most {longest:.6g} (half of the median last edge of a slit; "
            f"the median tile edge is {median:.6g}), got {width:.6g}"
        )
    return float(width)
