"""Placing a pattern as a spec asks: which flat map of the target, where on it, and what is said about the choice."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from kirisurf.errors import ParameterError
from kirisurf.flattening import Flattening
from kirisurf.ground import Ground
from kirisurf.placement import (
    CLOSE,
    MOST_UNEQUAL,
    Placement,
    directions,
    main_direction,
    rectangle_placement,
    similar_placement,
    trimmed_placement,
)
from kirisurf.rectangle_map import turned_by_a_quarter
from kirisurf.regular import Regular
from kirisurf.spec import DEFAULT_TILES, FitSpec

LEAST_OVERLAP = 0.75
"""Part of the area, common to sheet and outline, below which the outline is said to be too narrow for the tiles."""

STRETCHED = {"conformal": 1.0, "rescaled": np.inf, "teichmuller": np.inf}
"""Ratio of proportions up to which starts stretch the pattern to its rectangle, where that is not `MOST_UNEQUAL`."""


@dataclass(frozen=True, eq=False)
class Placed:
    """A placement on a flat map, with the choices that led to it.

    Attributes
    ----------
    flattening : Flattening
    placement : Placement
    notes, warnings : tuple of str
    """

    flattening: Flattening
    placement: Placement
    notes: tuple[str, ...]
    warnings: tuple[str, ...] = ()


def place_rectangle(base: Flattening, ground: Ground, spec: FitSpec, regular: Regular) -> Placed:
    """Place a rectangular sheet of `spec.cells` by the map that `spec.initial` names.

    auto
        The conformal map to the rectangle whose corners are those of the target; the pattern is stretched to it where
        their proportions differ by less than `MOST_UNEQUAL`, and lies in its middle otherwise.
    standard
        The pattern as it is, by a similarity, on as much area as the conformally flattened target has.
    rescaled
        Each axis scaled to the rectangle round the conformally flattened target.
    conformal
        As auto, but never stretched: the rectangle has the proportions (the modulus) that the target's corners give.
    teichmuller
        As auto, but always stretched to the rectangle. Of all maps of a disk with four corners onto a rectangle of
        given proportions, corners to corners, the conformal map onto a rectangle followed by the affine stretch has
        the least maximal dilatation: the ratio of both proportions (Groetzsch 1928; Ahlfors, Lectures on
        Quasiconformal Mappings, 1966, chapter I).
    analytic
        As auto, on the rectangle round the projection to the mean plane.
    flat
        As auto.

    Parameters
    ----------
    base : Flattening
        What the pattern is laid on.
    ground : Ground
        The target with its conformal maps.
    spec : FitSpec
    regular : Regular
    """
    columns, rows = spec.cells or (1, 1)
    most = STRETCHED.get(spec.initial, MOST_UNEQUAL)
    tried = []
    for turn in range(2):
        if spec.initial == "standard":
            flattening = _turned(ground.flattening, turn)
            placement = similar_placement(flattening, columns, rows, regular)
        else:
            if spec.initial == "rescaled":
                flattening = _turned(ground.flattening, turn)
            elif base.kind == "projection":
                flattening = base
            else:
                flattening = turned_by_a_quarter(ground.rectangle) if turn else ground.rectangle
            placement = rectangle_placement(flattening, columns, rows, regular, most)
        tried.append((flattening, placement))
    # columns along the long side or across it: whichever covers more, the former where both do alike
    flattening, placement = tried[int(_is_better(tried[1], tried[0], regular))]
    width, height = np.ptp(flattening.uv, axis=0)
    across, up = regular.box(placement.mask)[1]
    unequal = max(width * up, height * across) / min(width * up, height * across)
    size = f"Placement: {columns}x{rows} unit cells"
    if spec.initial == "standard":
        note = f"{size} laid undistorted over the middle of the target (--initial standard)."
    elif spec.initial == "rescaled":
        note = f"{size} scaled along both axes to the rectangle round the flattened target (--initial rescaled)."
    else:
        where = (
            "the four corners of its outline"
            if ground.has_corners
            else "four points of its outline, which has no four clear corners"
        )
        stretch = f", stretched by a factor of {unequal:.2f}" if spec.initial == "teichmuller" else ""
        note = f"{size} fitted to {where} ({flattening.kind} map{stretch})."
    warnings = []
    if unequal > max(most, MOST_UNEQUAL):
        fitting = max(1, round(columns * (width / height) / (across / up)))
        warnings.append(
            f"The target is {width / height:.2f} times as long as wide, the pattern {across / up:.2f} times: "
            f"it covers {100 * placement.overlap:.0f} % of the outline. --cells {fitting}x{rows} would fit."
        )
    return Placed(flattening, placement, (note,), tuple(warnings))


def place_trimmed(base: Flattening, spec: FitSpec, regular: Regular) -> Placed:
    """Place about `spec.tiles` tiles, trimmed to the outline.

    Raises
    ------
    ParameterError
        Where the start asked for needs a rectangle.
    UnusableError
        Where no sheet fits the outline.
    """
    if spec.initial in ("rescaled", "teichmuller"):
        raise ParameterError(
            f"--initial {spec.initial}: expected together with --cells, since it scales a rectangle to the target, "
            "got a sheet that is trimmed (--tiles)"
        )
    angle = None if spec.orientation == "auto" else float(np.radians(float(spec.orientation)))
    asked = spec.tiles or DEFAULT_TILES
    placement = trimmed_placement(base, asked, angle, regular=regular)
    warnings = []
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
    *some, last = (f"{direction:g}" for direction in sorted(directions(regular)))
    reason = f"the one of {', '.join(some)} and {last} that covers the outline best" if angle is None else "as asked"
    note = (
        f"Placement: {placement.n_tiles} tiles on the {base.kind} map, trimmed to the outline, turned by "
        f"{np.degrees(placement.angle):.1f} degrees from its long side ({reason}); "
        f"the trimmed lattice and the outline share {100 * placement.overlap:.0f} % of their area."
    )
    return Placed(base, placement, (note,), tuple(warnings))


def _is_better(second: tuple[Flattening, Placement], first: tuple[Flattening, Placement], regular: Regular) -> bool:
    """Does the second cover more, or, where both cover all, is it stretched less?"""

    def stretch(tried: tuple[Flattening, Placement]) -> float:
        matrix = tried[1].matrix @ np.linalg.inv(regular.lattice.T)
        large, small = np.linalg.svd(matrix)[1]
        return float(large / small)

    more = second[1].overlap - first[1].overlap
    if max(stretch(first), stretch(second)) > MOST_UNEQUAL:
        return stretch(second) < stretch(first) * (1 - CLOSE)
    return more > CLOSE


def _turned(flattening: Flattening, turn: int) -> Flattening:
    """A flattening with its long side along the first axis, or the second after a quarter turn."""
    angle = main_direction(flattening.outline) - 0.5 * np.pi * turn
    frame = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    return replace(flattening, uv=flattening.uv @ frame)
