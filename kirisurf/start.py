"""The start of a fit: flattening, placement, opening, initial guess, and the reasons for the choices."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from kirisurf.errors import UnusableError
from kirisurf.feasibility import Feasibility, Range, feasibility, wide_enough
from kirisurf.flattening import Flattening, checked_flattening
from kirisurf.ground import Ground
from kirisurf.layout import Layout
from kirisurf.motion import motion_of
from kirisurf.opening import middle_way, plan_opening
from kirisurf.placing import place_rectangle, place_trimmed
from kirisurf.regular import Regular
from kirisurf.spec import FitSpec
from kirisurf.surface import Surface
from kirisurf.tessellation import Tessellation
from kirisurf.unit_cells.catalog import find_cell

MOST_SPREAD = 3.5
"""Largest ratio of stretches over a target that tiles of different sizes were seen to follow: of 28 surfaces those
up to 3.1 were solved (but for one with strips narrower than its tiles), those from 4.7 on were not."""


@dataclass(frozen=True, eq=False)
class Start:
    """Everything that is known before the solve.

    Attributes
    ----------
    tessellation : Tessellation
    points : (n, 3)
        Initial guess, in the target's units.
    notes, warnings : tuple of str
        The automatic choices with their reasons, and what needs to be read.
    feasibility : Feasibility
        What the target asks of the tessellation.
    layout : Layout, optional
        How the points came about, where the pattern was laid on the target: from it follow coarser starts.
    """

    tessellation: Tessellation
    points: Float[np.ndarray, "n 3"]
    notes: tuple[str, ...]
    warnings: tuple[str, ...]
    feasibility: Feasibility
    layout: Layout | None = None


Laid = Callable[[Start], None]
"""Receives what is known before the solve."""


def make_start(surface: Surface, spec: FitSpec, ground: Ground | None = None) -> Start:
    """Lay the pattern of a spec on a surface.

    Parameters
    ----------
    surface : Surface
    spec : FitSpec
    ground : Ground, optional
        Of the surface, where one is at hand.

    Raises
    ------
    UnusableError
        Where the surface cannot be flattened one to one, or no sheet fits its outline.
    ParameterError
        Where the start asked for does not go with a trimmed sheet.
    """
    motion = motion_of(find_cell(spec.tessellation))
    regular = Regular(motion, middle_way(motion, spec))
    ground = ground or Ground(surface)
    conformal = ground.flattening
    notes: list[str] = []
    warnings: list[str] = []
    if conformal.n_repaired:
        warnings.append(
            f"The flattening of the target turned {conformal.n_repaired} faces over; the map was smoothed there. "
            "The start is less regular near them."
        )
    base = conformal
    if spec.initial == "analytic":
        flat = (surface.vertices - surface.vertices.mean(axis=0)) @ _mean_plane(surface, conformal).T
        base = checked_flattening(surface, flat, "projection")
    placed = place_trimmed(base, spec, regular) if spec.cells is None else place_rectangle(base, ground, spec, regular)
    notes += placed.notes
    warnings += placed.warnings
    layout = Layout(placed.flattening, placed.placement, conformal.log_scale, regular)
    asked = placed.flattening.interpolate(conformal.log_scale, layout.centers)
    opening = plan_opening(conformal.log_scale, asked, motion, spec)
    notes.append(opening.note)
    found = feasibility(surface, conformal.log_scale, Range.of(motion))
    if opening.spread > found.given.most / found.given.ends[0]:
        warnings.append(_too_much(opening.spread, found))
    layout = replace(layout, log_stretch=opening.log_stretch)
    if spec.initial == "flat":
        points = _laid_flat(surface, _mean_plane(surface, conformal), layout)
        notes.append("Start: the pattern lies flat in the mean plane of the target (--initial flat).")
        return Start(layout.tessellation, points, tuple(notes), tuple(warnings), found)
    return Start(layout.tessellation, layout.points, tuple(notes), tuple(warnings), found, layout)


def _too_much(spread: float, found: Feasibility) -> str:
    """Say that tiles of one size cannot follow the target over the sheet, and what would help."""
    name = found.given.name
    gives = (
        f"{name} tiles of one size give nearly {found.given.most:.2f} and nothing less but closed, since they snap"
        if found.given.snaps
        else f"{name} tiles of one size give at most {found.given.most:.2f}"
    )
    hope = (
        f"No sheet of {name} tiles is known to follow that: expect it to end without a certificate"
        if spread > MOST_SPREAD
        else "Expect small or strained tiles, or a distance to the target, where it curves most"
    )
    wide = " or ".join(str(other) for other in wide_enough(spread, found.given.name)[:2])
    other = f"{wide}, " if wide else ""
    return (
        f"The target asks for stretches that differ by a factor of {spread:.2f} over the sheet; {gives}. {hope}; "
        f"{other}a smaller part of the target, or one cut open there, would ask for less."
    )


def _laid_flat(surface: Surface, plane: np.ndarray, layout: Layout) -> np.ndarray:
    """The laid pattern, in the mean plane of the surface and turned like it."""
    center = surface.vertices.mean(axis=0)
    flattening = layout.flattening
    uv = flattening.uv - flattening.uv.mean(axis=0)
    vertices = center + uv @ _turn(surface, uv, (surface.vertices - center) @ plane.T) @ plane
    flat_surface = Surface.from_arrays(vertices, surface.faces, surface.name)
    moved = Flattening(flat_surface, flattening.uv, flattening.log_scale, flattening.kind)
    return replace(layout, flattening=moved).points


def _mean_plane(surface: Surface, conformal: Flattening) -> np.ndarray:
    """Two orthonormal rows (2, 3) that span the plane normal to the mean normal, right-handed with it.

    Their direction in the plane is that of the conformal map, which belongs to the mesh and turns with it.
    """
    normal = (surface.face_normals * surface.face_areas[:, None]).sum(axis=0)
    size = np.linalg.norm(normal)
    if size < 1e-6 * surface.area:
        raise UnusableError(f"{surface.name}: expected a surface with a front, got normals that cancel out")
    normal /= size
    first = np.eye(3)[np.argmin(np.abs(normal))]
    first = first - (first @ normal) * normal
    first /= np.linalg.norm(first)
    plane = np.stack([first, np.cross(normal, first)])
    flat = (surface.vertices - surface.vertices.mean(axis=0)) @ plane.T
    return _turn(surface, conformal.uv - conformal.uv.mean(axis=0), flat) @ plane


def _turn(surface: Surface, points: np.ndarray, goal: np.ndarray) -> np.ndarray:
    """Rotation (2, 2) that brings flat points nearest to others (least squares): points @ rotation."""
    left, _, right = np.linalg.svd(points.T @ goal)
    turn = left @ right
    if np.linalg.det(turn) < 0:
        raise UnusableError(
            f"{surface.name}: expected a surface that can be seen from one side, got one that folds over"
        )
    return turn
