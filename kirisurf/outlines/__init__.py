"""Planar outlines as targets: closed curves of smooth sides, named ones and those of files.

The way in is :func:`outline` (a name) or :func:`read_outline` (SVG, DXF, CSV); both give an :class:`Outline`:

- `outline.sides`, `n_sides`, `corners` (c, 2), `n_corners`, `is_smooth`, `area`, `length`, `diagonal`, `box`,
  `polygon` (shapely), `units`, `name`
- `outline.project(points, sides=None, extended=False)` -> :class:`OutlineProjection` with `points`, signed
  `distances` (positive outside), outward `normals`, `curvatures`, `sides`, `parameters`. With `sides` every point
  is projected on its own side; `extended` continues sides beyond their ends by tangents. Gradient of the signed
  distance: the normal n; Hessian: k / (1 + k d) t t^T.
- `outline.four_sides(corners=None)` -> (outline with sides bottom, right, top, left, sentence);
  `with_corners(marks)`, `find_corners(angle)`, `with_first_side(k)`
- `outline.polyline(spacing)`; `moved(shift)`, `scaled(factor)`, `transformed(matrix, shift)`
- a side is a :class:`Curve`: `start`, `end`, `length`, `points(u)` for u from 0 to `n_pieces`, `evenly(count)`
  (parameters spaced evenly along its length), `part(u0, u1)`, `turned()`

:func:`planar_surface` triangulates the inside with z = 0.
"""

from kirisurf.outlines.corners import CORNER_ANGLE
from kirisurf.outlines.curve import Curve, joined
from kirisurf.outlines.meshing import planar_surface
from kirisurf.outlines.named import is_published, names, outline, title
from kirisurf.outlines.outline import Outline
from kirisurf.outlines.outline_projection import OutlineProjection
from kirisurf.outlines.reading import FORMATS, read_outline
from kirisurf.outlines.shapes import arc, bezier, spline, straight

__all__ = [
    "CORNER_ANGLE",
    "FORMATS",
    "Curve",
    "Outline",
    "OutlineProjection",
    "arc",
    "bezier",
    "is_published",
    "joined",
    "names",
    "outline",
    "planar_surface",
    "read_outline",
    "spline",
    "straight",
    "title",
]
