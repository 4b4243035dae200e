"""What a spec asks of a sheet, in the terms of the problem."""

from __future__ import annotations

import numpy as np

from kirisurf.contracted_shape import ContractedShape
from kirisurf.errors import ParameterError
from kirisurf.outlines import Outline
from kirisurf.sizes import slit_openings, tile_edges
from kirisurf.spec import RECTANGLE, FitSpec
from kirisurf.targets import read_named_outline
from kirisurf.tessellation import Tessellation
from kirisurf.tile_corners import TileCorners
from kirisurf.two_states import Shape

MARGIN = 1.1
"""Smallest edges and openings are asked of the solver with this factor, since it measures them by the sizes of
the start, and the certificate by those of the finished sheet."""

EDGE_MARGIN = 1.3
"""The same for edges where both states are unknown: tiles of several kinds change more in size."""


def shape_of(spec: FitSpec, edge: float = 1.0) -> Shape:
    """Return what a spec asks of tiles and openings, where the median tile edge of the start has a given length."""
    return Shape(
        smallest_edge=EDGE_MARGIN * spec.min_edge * edge,
        margin=MARGIN * float(np.sin(np.radians(spec.min_angle))),
        largest_opening=None if spec.max_opening is None else float(np.radians(spec.max_opening)),
        smallest_corner=None if spec.min_corner is None else float(np.radians(spec.min_corner)),
    )


def contracted_shape(spec: FitSpec) -> ContractedShape:
    """Return the shape that a spec asks of the contracted sheet.

    Raises
    ------
    ParameterError
        Where the pattern is trimmed, and has no four sides.
    UnreadableError, UnusableError
        Where the file of an outline cannot be read or used.
    """
    if spec.contracted == "free":
        return ContractedShape()
    if spec.cells is None:
        raise ParameterError(
            f"--contracted {spec.contracted}: expected a rectangular pattern (--cells), whose sides follow that shape, "
            f"got one trimmed to {spec.tiles} tiles"
        )
    name, _, ratio = spec.contracted.partition(":")
    if name == RECTANGLE:
        return ContractedShape(RECTANGLE, float(ratio) if ratio else None)
    return ContractedShape("outline", None, standard(read_named_outline(spec.contracted, spec.units)))


def standard(outline: Outline) -> Outline:
    """Return an outline with four sides, its middle at the origin and of area 1."""
    four, _ = outline.four_sides()
    middle = np.asarray(four.polygon.centroid.coords[0])
    return four.moved(-middle).scaled(four.area**-0.5)


def needs_both_states(tessellation: Tessellation, spec: FitSpec) -> bool:
    """Are the contracted points unknowns too? See :class:`kirisurf.two_states.TwoStates`."""
    asked = spec.contracted != "free" or spec.prefer not in ("balanced", "curvature")
    asked = asked or spec.max_opening is not None or spec.min_corner is not None
    return asked or tessellation.has_openings or not bool(TileCorners.of(tessellation).convex.all())


def sufficiency(spec: FitSpec, tessellation: Tessellation, points: np.ndarray) -> float:
    """Return the smallest edge and opening over what was asked for, whichever is less: 1 or more suffices."""
    edges = tile_edges(tessellation, points)
    least = slit_openings(tessellation, points).min(initial=np.pi)
    opening = least / np.radians(spec.min_angle) if spec.min_angle > 0 else np.inf
    edge = edges.min() / np.median(edges) / spec.min_edge if spec.min_edge > 0 else np.inf
    return float(min(opening, edge))
