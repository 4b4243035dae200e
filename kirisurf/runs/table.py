"""`curvature.csv`: one row for every hole."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Mapping

import numpy as np

CENTER = "center"
COLUMNS = (
    "mean_curvature",
    "gaussian_curvature",
    "mean_curvature_averaged",
    "gaussian_curvature_averaged",
    "target_mean_curvature",
    "target_gaussian_curvature",
    "principal_curvature_1",
    "principal_curvature_2",
    "integrated_gaussian_curvature",
    "target_integrated_gaussian_curvature",
    "angle_defect",
    "gauss_image_area",
    "target_integrated_gaussian_curvature_cell",
    "mean_curvature_from_patch",
    "gaussian_curvature_from_patch",
    "mean_curvature_from_fit",
    "gaussian_curvature_from_fit",
    "area",
    "opening_angle",
    "flag",
)


def curvature_rows(fields: Mapping[str, np.ndarray]) -> list[dict[str, float | int]]:
    """Return one row per hole: its number, the center of its patch, and every column of `COLUMNS`.

    Parameters
    ----------
    fields : mapping of str to (h,)
        Fields of the holes, with `CENTER` (h, 3) among them; a column without a field is NaN.
    """
    centers = np.asarray(fields[CENTER], dtype=float).reshape(-1, 3)
    rows: list[dict[str, float | int]] = []
    for k, center in enumerate(centers.tolist()):
        row: dict[str, float | int] = {"hole": k, **dict(zip("xyz", center, strict=True))}
        for name in COLUMNS:
            row[name] = float(fields[name][k]) if name in fields else math.nan
        row["flag"] = 0 if row["flag"] == 0 else 1
        rows.append(row)
    return rows


def curvature_csv(fields: Mapping[str, np.ndarray]) -> str:
    """Return the table as CSV text in full precision; what is not a number is an empty cell."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    names = ["hole", "x", "y", "z", *COLUMNS]
    writer.writerow(names)
    for row in curvature_rows(fields):
        writer.writerow(["" if math.isnan(row[name]) else repr(row[name]) for name in names])
    return text.getvalue()
