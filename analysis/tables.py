"""Tables as rows of plain values, and as CSV text."""

from __future__ import annotations

import csv
import io
from collections.abc import Mapping, Sequence

import numpy as np
from jaxtyping import Float

HOLE_COLUMNS = (
    "hole",
    "x",
    "y",
    "z",
    "mean_curvature",
    "gaussian_curvature",
    "mean_curvature_averaged",
    "gaussian_curvature_averaged",
    "target_mean_curvature",
    "target_gaussian_curvature",
    "area",
    "opening_angle",
    "flag",
)
"""Columns of curvature.csv."""


def hole_rows(centers: Float[np.ndarray, "g 3"], fields: Mapping[str, np.ndarray]) -> list[dict]:
    """Return a row per hole with the columns of `HOLE_COLUMNS`.

    Parameters
    ----------
    centers : (g, 3), units
    fields : mapping of str to (g,) array
        The hole fields of :class:`analysis.measures.Measures`.
    """
    columns = {"hole": np.arange(len(centers))} | dict(zip("xyz", centers.T, strict=True)) | dict(fields)
    return [
        dict(zip(HOLE_COLUMNS, values, strict=True))
        for values in zip(*(columns[name].tolist() for name in HOLE_COLUMNS), strict=True)
    ]


def number_rows(numbers: Mapping[str, float | None]) -> list[dict]:
    """Return a row (name, value) per number."""
    return [{"name": name, "value": value} for name, value in numbers.items()]


def csv_text(rows: Sequence[Mapping[str, object]], columns: Sequence[str] | None = None) -> str:
    r"""Return rows as CSV text with a header line; numbers in full precision, an empty cell for None.

    Parameters
    ----------
    rows : sequence of mappings
    columns : sequence of str, optional
        By default the keys of the first row.

    Raises
    ------
    ValueError
        Where a row has a key that is no column.

    Examples
    --------
    >>> csv_text([{"hole": 0, "area": 0.1}])
    'hole,area\n0,0.1\n'
    """
    names = list(columns if columns is not None else rows[0] if rows else ())
    text = io.StringIO()
    writer = csv.DictWriter(text, names, lineterminator="\n")
    writer.writeheader()
    writer.writerows(rows)
    return text.getvalue()


def curvature_csv(rows: Sequence[Mapping[str, object]]) -> str:
    """Return the holes table as the text of curvature.csv, its header also where there is no hole."""
    return csv_text(rows, HOLE_COLUMNS)
