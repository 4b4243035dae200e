"""The start of a fit: flattening, placement, opening, initial guess, and the reasons for the choices."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from jaxtyping import Float

from kirisurf.errors import UnusableError
from kirisurf.flattening import Flattening, checked_flattening, flatten
from kirisurf.guess import tile_centers
from kirisurf.layout import LEAST_OPENING, MOST_OPENING, Layout
from kirisurf.placement import CLOSE, MOST_UNEQUAL, Placement, rectangle_placement, trimmed_placement
from kirisurf.rectangle_map import map_to_rectangle, rectangle_corners
from kirisurf.spec import DEFAULT_TILES, FitSpec
from kirisurf.surface import Surface
from kirisurf.tessellation import Tessellation

LEAST_STRETCH, MOST_STRETCH = 1.05, 1.40
"""Range of the stretch that is planned for: a quad sheet can give 1 to sqrt 2."""

MOST_SPREAD = 3.5
"""Largest ratio of stretches over a target that tiles of different sizes were seen to follow: of 28 surfaces those
up to 3.1 were solved (but for one with strips narrower than its tiles), those from 4.7 on were not."""

LEAST_OVERLAP = 0.75
"""Part of the area, common to sheet and outline, below which the outline is said to be too narrow for the tiles."""


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
    layout : Layout, optional
        How the points came about, where the pattern was laid on the target: from it follow coarser starts.
    """

    tessellation: Tessellation
    points: Float[np.ndarray, "n 3"]
    notes: tuple[str, ...]
    warnings: tuple[str, ...]
    layout: Layout | None = None


def make_start(surface: Surface, spec: FitSpec) -> Start:
    """Lay the pattern of a spec on a surface.

    Raises
    ------
    UnusableError
        Where the surface cannot be flattened one to one, or no sheet fits its outline.
    """
    conformal = flatten(surface)
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
    if spec.cells is not None:
        flattening, placement = _rectangle(base, conformal, spec.cells, notes, warnings)
    else:
        flattening, placement = base, _trimmed(base, spec, notes, warnings)
    layout = Layout(flattening, placement, conformal.log_scale)
    asked = flattening.interpolate(conformal.log_scale, tile_centers(layout.tessellation, placement))
    layout = replace(layout, log_stretch=_stretch(conformal.log_scale, asked, spec, notes, warnings))
    if spec.initial == "flat":
        points = _laid_flat(surface, _mean_plane(surface, conformal), layout)
        notes.append("Start: the pattern lies flat in the mean plane of the target (--initial flat).")
        return Start(layout.tessellation, points, tuple(notes), tuple(warnings))
    return Start(layout.tessellation, layout.points, tuple(notes), tuple(warnings), layout)


def _rectangle(
    base: Flattening, conformal: Flattening, cells: tuple[int, int], notes: list[str], warnings: list[str]
) -> tuple[Flattening, Placement]:
    corners, found = rectangle_corners(conformal)
    tried = []
    for turn in range(2):
        flattening = base if base.kind == "projection" else map_to_rectangle(conformal, np.roll(corners, -turn))
        tried.append((flattening, rectangle_placement(flattening, *cells)))
    # columns along the long side or across it: whichever covers more, the former where both do alike
    flattening, placement = tried[int(tried[1][1].overlap > tried[0][1].overlap + CLOSE)]
    width, height = np.ptp(flattening.uv, axis=0)
    where = (
        "the four corners of its outline" if found else "four points of its outline, which has no four clear corners"
    )
    notes.append(f"Placement: {cells[0]}x{cells[1]} unit cells fitted to {where} ({flattening.kind} map).")
    if max(width * cells[1], height * cells[0]) > MOST_UNEQUAL * min(width * cells[1], height * cells[0]):
        fitting = max(1, round(cells[1] * width / height))
        warnings.append(
            f"The target is {width / height:.2f} times as long as wide, the pattern {cells[0] / cells[1]:.2f} times: "
            f"it covers {100 * placement.overlap:.0f} % of the outline. --cells {fitting}x{cells[1]} would fit."
        )
    return flattening, placement


def _trimmed(base: Flattening, spec: FitSpec, notes: list[str], warnings: list[str]) -> Placement:
    angle = None if spec.orientation == "auto" else float(np.radians(float(spec.orientation)))
    asked = spec.tiles or DEFAULT_TILES
    placement = trimmed_placement(base, asked, angle)
    if abs(placement.n_tiles - asked) > 0.07 * asked + 4:
        warnings.append(
            f"{asked} tiles were asked for, {placement.n_tiles} were laid: "
            "the outline leaves no sheet nearer to that number."
        )
    if placement.overlap < LEAST_OVERLAP:
        warnings.append(
            f"The sheet covers {100 * placement.overlap:.0f} % of the outline: parts narrower than two tiles are left "
            "out. More tiles (--tiles), which are smaller, would cover more."
        )
    reason = "the one of 0, 22.5, 45 and 67.5 that covers the outline best" if angle is None else "as asked"
    notes.append(
        f"Placement: {placement.n_tiles} tiles on the {base.kind} map, trimmed to the outline, turned by "
        f"{np.degrees(placement.angle):.1f} degrees from its long side ({reason}); "
        f"the trimmed lattice and the outline share {100 * placement.overlap:.0f} % of their area."
    )
    return placement


def _stretch(
    log_scale: np.ndarray, asked: np.ndarray, spec: FitSpec, notes: list[str], warnings: list[str]
) -> np.ndarray:
    """Logarithm of the planned stretch at every vertex (v,), from what the target asks there and at the tiles."""
    low, high = np.percentile(asked, [2, 98])
    spread = float(np.exp(high - low))
    if spec.opening == "auto" and spec.initial != "standard":
        middle = 0.5 * (np.log(LEAST_STRETCH) + np.log(MOST_STRETCH)) - 0.5 * (low + high)
        notes.append(
            f"Opening: it varies so that the stretch follows the target's, which differs by a factor of {spread:.2f} "
            f"over the sheet; its middle lies halfway between {LEAST_STRETCH:g} and {MOST_STRETCH:g} "
            "(a quad sheet can stretch from 1 to 1.41)."
        )
        stretch = log_scale + middle
    else:
        opening = 60.0 if spec.opening == "auto" else float(spec.opening)
        opening = float(np.clip(opening, LEAST_OPENING, MOST_OPENING))
        half = np.radians(opening) / 2
        stretch = np.full(len(log_scale), np.log(np.cos(half) + np.sin(half)))
        if spec.initial != "standard":
            stretch = stretch + log_scale - np.median(asked)
        reason = "as for every standard start" if spec.opening == "auto" else "as asked"
        if spec.opening not in ("auto", opening):
            reason = f"{spec.opening:g} was asked, starts lie between {LEAST_OPENING:g} and {MOST_OPENING:g}"
        notes.append(f"Opening: {opening:g} degrees at the start ({reason}).")
    if spread > np.sqrt(2):
        hope = (
            "No sheet of quad tiles is known to follow that: expect it to end without a certificate"
            if spread > MOST_SPREAD
            else "Expect small or strained tiles, or a distance to the target, where it curves most"
        )
        warnings.append(
            f"The target asks for stretches that differ by a factor of {spread:.2f} over the sheet; quad tiles of one "
            f"size give at most 1.41. {hope}; a smaller part of the target, or one cut open there, would ask for less."
        )
    return stretch


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
