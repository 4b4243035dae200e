"""The rows of the certificate, their limits, and the sentences that say which row fails and why."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from types import MappingProxyType

from analysis.finding import Finding
from kirisurf.errors import ParameterError

RIGID_TOLERANCE = 1e-9

LIMITS: Mapping[str, float] = MappingProxyType(
    {
        "length": RIGID_TOLERANCE,
        "angle": RIGID_TOLERANCE,
        "planarity": RIGID_TOLERANCE,
        "isometry": RIGID_TOLERANCE,
        "closure": RIGID_TOLERANCE,
        "opening_min": 0.0,
        "intersections": 0.0,
        "overlap_contracted": 1e-9,
        "gap_contracted": 1e-9,
        "loop": RIGID_TOLERANCE,
        "boundary": RIGID_TOLERANCE,
        "contracted_boundary": RIGID_TOLERANCE,
        "min_edge": 1e-2,
        "distance_rms": 0.25,
        "distance_max": 1.0,
        "reach_rms": 2.0,
        "reach_max": 10.0,
        "coverage": 0.5,
        "coverage_strict": 0.25,
        "pieces": 1.0,
        "flipped": 0.0,
        "flatness": RIGID_TOLERANCE,
    }
)
"""Default limits. Those on the target rows only tell a design of this target from one of another: how near a
design has to come is for its user to say."""

BESIDE = ("pieces", "flipped", "flatness")
"""Judged like rows, but kept beside them."""

ROWS = tuple(name for name in LIMITS if name not in BESIDE)
"""The rows of the certificate, in their order."""

OUTLINE_ROWS = ("boundary", "contracted_boundary")
"""Judged where a curve is prescribed for the rim, deployed or contracted."""

TARGET_ROWS = ("distance_rms", "distance_max", "reach_rms", "reach_max", "coverage", "coverage_strict")
AT_LEAST = ("min_edge", "coverage", "coverage_strict")
MORE_THAN = ("opening_min",)

_MEANINGS = {
    "length": "the two copies of a slit edge differ in length",
    "angle": "the tile angles round a point do not sum up",
    "planarity": "a tile is not flat",
    "isometry": "a tile changes its shape between the states",
    "closure": "the copies of a point do not meet when the sheet is contracted",
    "opening_min": "neighboring tiles overlap at a hinge, or the hinge is closed",
    "intersections": "tiles cross in space",
    "overlap_contracted": "tiles overlap when the sheet is contracted",
    "gap_contracted": "the contracted sheet leaves gaps",
    "loop": "a designed opening does not close",
    "boundary": "a vertex of the deployed rim lies off the target's outline",
    "contracted_boundary": "a vertex of the contracted rim lies off the prescribed outline",
    "min_edge": "a tile edge has collapsed",
    "distance_rms": "the vertices are far from the target",
    "distance_max": "a vertex is far from the target",
    "reach_rms": "the target is far from the sheet",
    "reach_max": "a part of the target is far from the sheet",
    "coverage": "too little of the target is covered",
    "coverage_strict": "too little of the target is covered by tiles and closed holes",
    "pieces": "the sheet is not in one piece",
    "flipped": "contracted tiles are turned over",
    "flatness": "the contracted sheet is not flat",
    "distance_smooth_rms": "the vertices are far from the smooth target",
    "distance_smooth_max": "a vertex is far from the smooth target",
    "fold_max": "hinged tiles are folded",
}
_UNCHECKED = {
    "length": "there is no slit edge with two copies",
    "angle": "there is no interior point with tiles all round",
    "closure": "no vertex has a second copy",
    "opening_min": "there is no slit end",
    "overlap_contracted": "a contracted tile is no simple polygon",
    "gap_contracted": "a contracted tile is no simple polygon",
    "boundary": "no vertex of the rim was named",
    "contracted_boundary": "no vertex of the rim was named",
    "coverage": "the target is no disk",
    "coverage_strict": "the target is no disk",
}


def merged_limits(limits: Mapping[str, float | int] | None, known: Collection[str]) -> Mapping[str, float]:
    """Return the default limits with some of them replaced; `known` names further values that may be limited.

    Raises
    ------
    ParameterError
        Where `limits` names something else.
    """
    unknown = sorted(set(limits or {}) - set(LIMITS) - set(known))
    if unknown:
        raise ParameterError(f"limits: expected names among {', '.join((*LIMITS, *known))}, got {', '.join(unknown)}")
    return MappingProxyType(dict(LIMITS) | {name: float(limit) for name, limit in (limits or {}).items()})


def holds(name: str, value: float | int, limit: float) -> bool:
    """Return whether a value is within its limit; what is not a number never is."""
    if name in MORE_THAN:
        return bool(value > limit)
    return bool(value >= limit) if name in AT_LEAST else bool(value <= limit)


def sentences(found: Mapping[str, Finding], limits: Mapping[str, float]) -> tuple[str, ...]:
    """Return one sentence for every finding that fails its limit or could not be checked."""
    result = []
    for name, limit in limits.items():
        finding = found.get(name)
        if finding is None:
            continue
        if finding.value is None:
            reason = finding.where or _UNCHECKED.get(name, "there is nothing to check")
            result.append(f"{name}: could not be checked: {reason}")
        elif not holds(name, finding.value, limit):
            sense = "more than" if name in MORE_THAN else "at least" if name in AT_LEAST else "at most"
            where = f", worst at {finding.where}" if finding.where else ""
            result.append(f"{name}: expected {sense} {limit:g}, got {finding.value:.6g}: {_MEANINGS[name]}{where}")
    return tuple(result)
