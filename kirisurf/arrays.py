"""Read-only arrays, means of groups, and the one validator of arrays: expected ..., got ...."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import ArrayLike, DTypeLike

from kirisurf.errors import UnusableError


def frozen(values: ArrayLike, dtype: DTypeLike = np.float64) -> np.ndarray:
    """Return a read-only, C-contiguous copy of `values` with the given dtype."""
    copy = np.array(values, dtype=dtype, order="C", copy=True)
    copy.flags.writeable = False
    return copy


def group_means(values: np.ndarray, groups: np.ndarray, n: int) -> np.ndarray:
    """Return the mean (n, d) of the rows of `values` (k, d) in every one of n groups; `groups` (k,) numbers them."""
    count = np.bincount(groups, minlength=n)[:, None]
    return np.stack([np.bincount(groups, column, n) for column in values.T], axis=1) / count


def checked(
    values: ArrayLike,
    name: str,
    shape: Sequence[int | None],
    dtype: DTypeLike = np.float64,
) -> np.ndarray:
    """Return `values` as a frozen array of the given shape, finite if floating.

    Parameters
    ----------
    values : array_like
    name : str
        What the array is, for the message.
    shape : sequence of int or None
        Expected shape; None stands for any length.
    dtype : dtype
        float64 or int64. Integers are only accepted from integral values.

    Raises
    ------
    UnusableError
        Where the shape, the kind of number or the finiteness is not as expected.
    """
    wanted = "(" + ", ".join("any" if s is None else str(s) for s in shape) + ")"
    try:
        array = np.asarray(values)
        if array.dtype.kind not in "biufO":  # texts, dates and complex numbers would be converted in silence
            raise UnusableError(f"{name}: expected numbers, got {array.dtype}")
        if isinstance(values, np.ma.MaskedArray) and np.ma.is_masked(values):
            raise UnusableError(f"{name}: expected numbers everywhere, got a masked array in which some are missing")
        if np.issubdtype(np.dtype(dtype), np.integer) and array.size and array.dtype.kind not in "iu":
            raise UnusableError(f"{name}: expected integers, got {array.dtype}")
        if array.dtype.kind == "u" and array.size and array.max() > np.iinfo(np.int64).max:
            raise UnusableError(f"{name}: expected numbers below 2**63, got {array.max()}")
        array = array.astype(dtype, order="C")
    except (TypeError, ValueError) as problem:
        if isinstance(problem, UnusableError):
            raise
        raise UnusableError(f"{name}: expected numbers of shape {wanted}, got {problem}") from None
    if array.ndim != len(shape) or any(s is not None and s != k for s, k in zip(shape, array.shape, strict=True)):
        raise UnusableError(f"{name}: expected shape {wanted}, got {array.shape}")
    if array.dtype.kind == "f" and not np.isfinite(array).all():
        bad = int(np.flatnonzero(~np.isfinite(array).reshape(len(array), -1).all(axis=1))[0])
        raise UnusableError(f"{name}: expected finite numbers, got {array[bad]} in row {bad}")
    return frozen(array, dtype)
