"""Every number that a report shows, as plain values: the page is written from them, and a JSON file holds them."""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import Any

import numpy as np

from kirisurf.field_units import unit_label
from viewers.fields import describe_field
from viewers.number_words import CURVED, number_in_words
from viewers.parts import (
    ReportParts,
    certificate_rows,
    curvature_summary,
    designed_gap,
    is_planar,
    passed,
    status_sentence,
    verdict,
)
from viewers.report_bins import curvature_bins
from viewers.report_scenes import CURVATURES, RESIDUALS, curvature_range

RIGID = ("length", "angle", "planarity", "isometry", "closure", "loop")
"""Rows of the certificate whose largest value says how far the sheet is from one of rigid tiles."""

POWERS = {"mean_curvature": -1, "gaussian_curvature": -2}


def report_numbers(parts: ReportParts) -> dict[str, Any]:
    """Return what the report of one run shows: numbers in full precision, and the sentences.

    Numbers are those of result.json and of the fields, with the medians, shares and counts that are taken of them.
    A part that the run has nothing for is left out.
    """
    result, planar = parts.result, is_planar(parts)
    keys = ("tiles", "holes", "vertices", "slits", "iterations", "edge_length", "hinge_width", "kerf")
    shortest = parts.certificate.get("min_edge")
    edge = result.get("edge_length")
    found: dict[str, Any] = {
        "title": parts.title,
        "target": parts.target_name,
        "units": parts.units,
        "certified": passed(parts),
        "verdict": verdict(parts),
        "status": result.get("status"),
        "reason": status_sentence(parts),
        "failures": list(parts.failures or ()),
        "warnings": list(parts.warnings),
        "notes": list(parts.notes),
        "design": {key: result[key] for key in keys if result.get(key) is not None}
        | ({"shortest_edge": edge * shortest} if edge and shortest is not None else {})
        | ({"width": parts.sheet_size[0], "height": parts.sheet_size[1]} if parts.sheet_size else {}),
        "spec": dict(parts.spec),
        "certificate": _certificate(parts),
        "measures": _measures(parts, planar),
        "feasibility": result.get("feasibility"),
        "versions": dict(result.get("versions") or {}),
        "history": [dict(step) for step in parts.history],
        "deployment": _deployment(parts),
    }
    found["rigid"] = max((abs(v) for n in RIGID if (v := parts.certificate.get(n)) is not None), default=None)
    if not planar:
        found |= {
            "curvature": curvature_numbers(parts),
            "histograms": _histograms(parts),
            "balance": balance_numbers(parts.numbers),
            "residence": residence_shares(parts),
            "holes": list(parts.tables.get("curvature", ())),
        }
    found["maps"] = _maps(parts, planar)
    return {key: value for key, value in found.items() if value is not None}


def _deployment(parts: ReportParts) -> dict[str, Any] | None:
    """Return the way from flat to deployed, without what is of its files."""
    left_out = ("files", "versions", "key", "run", "seconds")
    found = parts.deployment
    return None if found is None else {key: value for key, value in found.items() if key not in left_out}


def curvature_numbers(parts: ReportParts) -> dict[str, Any] | None:
    """Return how much of the maps is the target's and how much is not, or None where nothing is known.

    For mean and Gaussian curvature: medians of the target's absolute value and of the absolute difference, `relative`
    (that over the other), and, as far as measured, `target_share`, `from_fit_median`, `from_patch_median` and
    `correlation` (docs/measures.md); beside them what the distance of the vertices adds to H, about d / L^2.
    """
    summary = curvature_summary(parts)
    if summary is None:
        return None
    found: dict[str, Any] = {
        "n_holes": summary.n_holes,
        "n_without": summary.n_without,
        "distance_rms": _finite(summary.distance_rms),
        "offset_curvature": _finite(summary.per_edge_squared),
    }
    for name, (target, apart) in (("gaussian_curvature", summary.gaussian), ("mean_curvature", summary.mean)):
        found[name] = {
            "target_median": target,
            "difference_median": apart,
            "relative": apart / target if target > 0 else None,
            "unit": unit_label(POWERS[name], parts.units),
        } | {
            key: parts.numbers.get(f"{name}_{key}")
            for key in ("target_share", "from_fit_median", "from_patch_median", "correlation")
        }
    return found


def balance_numbers(numbers: Mapping[str, float | int]) -> dict[str, Any] | None:
    """Return the terms of Gauss-Bonnet, of the whole sheet and of the cells of its inner holes; None without them."""
    names = {
        "vertices": "sheet_gaussian_curvature_vertices",
        "holes": "sheet_gaussian_curvature_holes",
        "tiles": "sheet_gaussian_curvature_tiles",
        "total": "sheet_gaussian_curvature",
        "rim": "rim_turning",
        "euler": "euler_characteristic",
        "remainder": "gauss_bonnet_remainder",
    }
    if not all(name in numbers for name in names.values()):
        return None
    sheet: dict[str, float | int] = {key: numbers[name] for key, name in names.items()}
    sheet |= {"sum": sheet["total"] + sheet["rim"], "turns": 2 * math.pi * sheet["euler"]}
    cells = {
        "n": numbers.get("n_inner_holes"),
        "target": numbers.get("inner_target_gaussian_curvature"),
        "angles": numbers.get("inner_angle_defect"),
        "normals": numbers.get("inner_gauss_image_area"),
        "patches": numbers.get("inner_integrated_gaussian_curvature"),
        "difference_median": numbers.get("angle_defect_difference_median"),
        "difference_relative": numbers.get("angle_defect_difference_relative"),
    }
    if cells["angles"] is not None and cells["patches"] is not None:
        cells["sides"] = cells["angles"] - cells["patches"]
    known = all(cells[key] is not None for key in ("n", "target", "angles", "normals", "patches"))
    return {"sheet": sheet, "cells": cells if known else None}


def residence_shares(parts: ReportParts) -> dict[str, Any] | None:
    """Return what part of area, of the target's |K| and of the sheet's lies in tiles and in holes; None if unknown.

    The sheet's: angle excess of the tiles, and the curvature of the holes' cells by normals.
    """
    numbers = parts.numbers
    excess, cells = parts.fields.get(("tile", "angle_excess")), parts.fields.get(("hole", "gauss_image_area"))
    pairs = {
        "area": (numbers.get("tile_area"), numbers.get("hole_area")),
        "target": tuple(
            numbers.get(f"target_absolute_gaussian_curvature_under_{where}") for where in ("tiles", "holes")
        ),
        "sheet": (_magnitude(excess), _magnitude(cells)),
    }
    shares = {}
    for key, (tiles, holes) in pairs.items():
        if tiles is None or holes is None or not tiles + holes > 0:
            return None
        shares[key] = {"tiles": tiles / (tiles + holes), "holes": holes / (tiles + holes)}
    return shares


def good_curvatures(parts: ReportParts, name: str) -> tuple[np.ndarray, np.ndarray] | None:
    """Return curvature of the holes (h,), NaN where flagged, and of the target (h,); None where a field is missing."""
    hole, target = parts.fields.get(("hole", name)), parts.fields.get(("hole", f"target_{name}"))
    if hole is None or target is None or not len(hole):
        return None
    flag = np.asarray(parts.fields.get(("hole", "flag"), np.zeros(len(hole))))
    return np.where(flag == 0, hole, np.nan), np.asarray(target, float)


def _certificate(parts: ReportParts) -> dict[str, Any]:
    rows = {}
    for row in certificate_rows(parts):
        rows[row.name] = {
            "title": row.title,
            "value": parts.certificate.get(row.name),
            "limit": parts.limits.get(row.name),
            "unit": row.unit,
            "verdict": row.verdict,
        }
        if row.name == "gap_contracted" and (designed := designed_gap(parts)) is not None:
            rows[row.name] |= designed
    return rows


def _measures(parts: ReportParts, planar: bool) -> dict[str, Any]:
    found = {}
    for name, value in parts.numbers.items():
        row = number_in_words(name, value, parts.units)
        if not (planar and row.heading in CURVED):
            found[name] = {
                "label": row.label,
                "value": value,
                "shown": row.number,
                "unit": row.unit,
                "heading": row.heading,
            }
    return found


def _histograms(parts: ReportParts) -> dict[str, Any]:
    found = {}
    for name in CURVATURES:
        values = good_curvatures(parts, name)
        if values is not None:
            bins = curvature_bins(*values)
            found[name] = {
                "edges": bins.edges.tolist(),
                "holes": bins.holes.tolist(),
                "target": bins.target.tolist(),
                "below": bins.below,
                "above": bins.above,
            }
    return found


def _maps(parts: ReportParts, planar: bool) -> dict[str, Any]:
    """The ends of every color bar."""
    fields = {}
    for name in () if planar else CURVATURES:
        if ("hole", name) in parts.fields:
            fields[name] = curvature_range(parts.fields, name, parts.units)
        if ("hole", f"{name}_difference") in parts.fields:
            fields[f"{name}_difference"] = curvature_range(parts.fields, name, parts.units, difference=True)
    for where, name in (() if planar else (("vertex", "distance"),)) + RESIDUALS:
        values = parts.fields.get((where, name))
        if values is not None:
            fields[name] = describe_field(name, where, values, parts.units)
    return {
        name: {"low": field.limits[0], "high": field.limits[1], "unit": field.unit, "range": field.range_note}
        for name, field in fields.items()
    }


def _magnitude(values: np.ndarray | None) -> float | None:
    return None if values is None else float(np.nansum(np.abs(values)))


def _finite(value: float | int) -> float | int | None:
    return value if math.isfinite(value) else None
