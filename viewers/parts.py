"""The parts of a report: plain values in, and the few sentences and medians that a reader starts with."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from viewers.words import CertificateRow, number, row_in_words


@dataclass(frozen=True, eq=False)
class ReportParts:
    """All that a report shows of one run.

    Attributes
    ----------
    title, target_name, units : str
    result : mapping
        As in result.json: status, reason, seconds, iterations, tiles, vertices, holes, edge_length,
        versions, feasibility (see `Feasibility`). What is missing is left out.
    certificate : mapping of str to float or None
    limits : mapping of str to float
    failures : tuple of str or None
        The certificate's sentences, "row: why" each; with none of them the design passed. None where there is
        no judge: every row is then held against its limit here.
    fields : mapping of (where, name) to array
    numbers : mapping of str to float
    tables : mapping of str to list of rows
        `curvature` is shown: a row per hole.
    pictures : mapping of str to path
        PNG, JPEG or SVG files to embed, in order.
    notes, warnings : tuple of str
        The automatic choices with their reasons; what needs reading.
    history : tuple of mapping
        For every step: constraint block -> largest residual.
    sheet_size : (float, float) or None
        Width and height of the flat sheet in the user's units.
    no_pictures : str
        Why there are no pictures and how to get them.
    planar : bool or None
        Whether the target is a planar outline, which has no curvature; by default this follows from the fields.
    spec : mapping
        The options of the fit.
    seconds : mapping of str to float
        Shown where runs are compared: the same design gives the same report, whatever the time it took.
    deployment : mapping or None
        What is known of the way from flat to deployed, as in deployment.json.
    deployment_picture : path or None
        Its figure.
    """

    title: str
    target_name: str
    units: str = "unit"
    result: Mapping[str, Any] = field(default_factory=dict)
    certificate: Mapping[str, float | int | None] = field(default_factory=dict)
    limits: Mapping[str, float | int] = field(default_factory=dict)
    failures: tuple[str, ...] | None = None
    fields: Mapping[tuple[str, str], np.ndarray] = field(default_factory=dict)
    numbers: Mapping[str, float | int] = field(default_factory=dict)
    tables: Mapping[str, Sequence[Mapping[str, Any]]] = field(default_factory=dict)
    pictures: Mapping[str, Path] = field(default_factory=dict)
    notes: tuple[str, ...] = ()
    warnings: tuple[str, ...] = ()
    history: tuple[Mapping[str, float], ...] = ()
    sheet_size: tuple[float, float] | None = None
    no_pictures: str = ""
    planar: bool | None = None
    spec: Mapping[str, Any] = field(default_factory=dict)
    seconds: Mapping[str, float] = field(default_factory=dict)
    deployment: Mapping[str, Any] | None = None
    deployment_picture: Path | None = None


@dataclass(frozen=True)
class Feasibility:
    """Whether the tessellation can give the stretch that the target asks for, as said before solving.

    Attributes
    ----------
    sentence, advice : str
        What was found, and what to do about it; empty where there is nothing to say.
    possible, asked : str
        Ranges of the stretch in words; empty where they are not known.
    outside : str
        Share of the target that asks for more or less than what is possible; empty where it is not known.
    """

    sentence: str
    advice: str
    possible: str
    asked: str
    outside: str


@dataclass(frozen=True)
class CurvatureSummary:
    """How much of the holes' curvature is the target's and how much the fit's, in the user's units.

    Attributes
    ----------
    gaussian, mean : (float, float)
        Medians over the holes: of the absolute curvature of the target, and of the absolute difference of
        the hole's to it.
    distance_rms, edge_length : float
    per_edge_squared : float
        distance_rms / edge_length^2: about what the fit adds to the mean curvature of a hole.
    n_holes, n_without : int
        Holes, and those without a trustworthy patch.
    """

    gaussian: tuple[float, float]
    mean: tuple[float, float]
    distance_rms: float
    edge_length: float
    per_edge_squared: float
    n_holes: int
    n_without: int


def verdict(parts: ReportParts) -> str:
    """Return the sentence that a reader in a hurry needs."""
    if not parts.certificate:
        return "Not certified: no certificate was made for this design."
    if passed(parts):
        return (
            f"Certified{', with warnings that need reading' if parts.warnings else ''}: closed and opened it is one "
            "sheet of the same rigid tiles, and every check of the saved files passed."
        )
    count = len(parts.failures or ()) or sum(row.verdict in ("fail", "unchecked") for row in certificate_rows(parts))
    return f"Not certified: {count} {'check' if count == 1 else 'checks'} failed."


def certificate_rows(parts: ReportParts) -> list[CertificateRow]:
    """Return every certificate row in words, in the given order."""
    return [
        row_in_words(name, value, parts.limits.get(name), parts.failures) for name, value in parts.certificate.items()
    ]


def status_sentence(parts: ReportParts) -> str:
    """Return how the solve ended, without the certificate's sentences, which a record repeats after it."""
    sentence = str(parts.result.get("reason") or parts.result.get("status") or "")
    for failure in parts.failures or ():
        sentence = sentence.replace(f"{failure}.", "").strip()
    return sentence


def designed_gap(parts: ReportParts) -> dict[str, float] | None:
    """Return what of the gaps in the flat sheet is there by design, `designed`, and the `rest`; over the tiles' area.

    None where nothing is designed: the gaps are within their limit, or the judge objects to them.
    """
    gap, limit = parts.certificate.get("gap_contracted"), parts.limits.get("gap_contracted")
    fails = any(sentence.startswith("gap_contracted:") for sentence in parts.failures or ())
    if gap is None or limit is None or gap <= limit or fails or parts.failures is None:
        return None
    told = parts.result.get("certificate_beside", {}).get("gap_designed")
    return {} if told is None else {"designed": told, "rest": abs(gap - told)}


def feasibility(parts: ReportParts) -> Feasibility | None:
    """Return what was said before solving, from the result's `feasibility`, or None where nothing was.

    Its keys: `sentence`, `advice`, `least` and `most` (possible stretch), `spread` (the two ends of the asked stretch,
    or its ratio), `outside` (share of the target's area). Each may be missing or null.
    """
    found = parts.result.get("feasibility")
    if not isinstance(found, Mapping) or not any(value is not None for value in found.values()):
        return None
    least, most, spread, outside = (found.get(key) for key in ("least", "most", "spread", "outside"))
    if isinstance(spread, (list, tuple)):
        asked = " to ".join(number(value) for value in spread)
    else:
        asked = "" if spread is None else f"the largest is {number(spread)} times the smallest"
    return Feasibility(
        sentence=str(found.get("sentence") or ""),
        advice=str(found.get("advice") or ""),
        possible="" if least is None or most is None else f"{number(least)} to {number(most)}",
        asked=asked,
        outside="" if outside is None else f"{100 * outside:.2g} %",
    )


def is_planar(parts: ReportParts) -> bool:
    """Return whether a report is on a planar target: told so, or without any curvature at the holes.

    None is a curvature whose H L and K L^2, with L the tile edge, are at the size of rounding for target and holes.
    """
    if parts.planar is not None:
        return parts.planar
    edge = float(parts.result.get("edge_length") or 0.0)
    for name, power in (("mean_curvature", 1), ("gaussian_curvature", 2)):
        for key in (name, f"target_{name}"):
            values = parts.fields.get(("hole", key))
            if values is None or not len(values) or not edge > 0:
                return False
            if np.nanmax(np.abs(values), initial=0.0) * edge**power > 1e-9:
                return False
    return True


def curvature_summary(parts: ReportParts) -> CurvatureSummary | None:
    """Return the medians beside the curvature maps, or None where the fields are missing or the target is planar."""
    if is_planar(parts):
        return None
    found = {}
    for name in ("gaussian_curvature", "mean_curvature"):
        hole, target = parts.fields.get(("hole", name)), parts.fields.get(("hole", f"target_{name}"))
        if hole is None or target is None:
            return None
        flag = parts.fields.get(("hole", "flag"), np.zeros(len(hole)))
        good = np.isfinite(hole) & np.isfinite(target) & (np.asarray(flag) == 0)
        if not good.any():
            return None
        found[name] = (float(np.median(np.abs(target[good]))), float(np.median(np.abs(hole[good] - target[good]))))
        count, without = len(hole), int((~good).sum())
    distance = parts.fields.get(("vertex", "distance"))
    rms = float(np.sqrt(np.mean(np.square(distance)))) if distance is not None and len(distance) else float("nan")
    edge = float(parts.result.get("edge_length") or float("nan"))
    return CurvatureSummary(
        found["gaussian_curvature"], found["mean_curvature"], rms, edge, rms / edge**2, count, without
    )


def passed(parts: ReportParts) -> bool:
    """Return whether a certificate was made and no row of it fails."""
    if not parts.certificate or parts.failures:
        return False
    return all(row.verdict not in ("fail", "unchecked") for row in certificate_rows(parts))
