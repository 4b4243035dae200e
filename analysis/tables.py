"""Tables as rows of plain values."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float

from kirisurf.runs.table import COLUMNS

HOLE_COLUMNS = ("hole", "x", "y", "z", *COLUMNS)
"""Columns of curvature.csv, which kirisurf.runs writes."""


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
