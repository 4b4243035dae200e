"""Elimination of the pivots of one dense front, cut into tasks that two threads may share."""

from __future__ import annotations

from collections.abc import Iterator
from functools import partial
from itertools import pairwise

import numpy as np

from kirisurf.solvers.blas import divide, factor, subtract_product, subtract_square
from kirisurf.solvers.team import Task

_WIDTH = 3  # unknowns of a vertex
_BLOCK = 192  # pivots eliminated together: a narrower product is slow, a wider triangle is
_STRIP = 48  # columns that dtrsm takes at a time: it reaches half the rate of dgemm on matrices of these sizes
_HEIGHT = 512  # rows of a task
_TILE = 384  # columns of a tile of the update, each of them a task


def tile_marks(m: int) -> list[int]:
    """Return where the tiles of an update matrix (m, m) begin, and m: tile t has the rows from its first column on."""
    n = max(1, round(m / _TILE))
    return [m // _WIDTH * i // n * _WIDTH for i in range(n)] + [m]


def tiles_in(memory: np.ndarray, marks: list[int]) -> list[np.ndarray]:
    """Cut memory into the tiles of an update matrix, each Fortran-ordered."""
    tiles, start, m = [], 0, marks[-1]
    for first, last in pairwise(marks):
        end = start + (m - first) * (last - first)
        tiles.append(memory[start:end].reshape(last - first, m - first).T)
        start = end
    return tiles


def elimination(panel: np.ndarray, tiles: list[np.ndarray]) -> Iterator[list[Task]]:
    """Yield the tasks of a front in stages; those of one stage touch different numbers.

    The cut follows from the shape alone, so that who does which task does not change a bit of the result.

    Parameters
    ----------
    panel : (k + m, k) Fortran-ordered
        Columns of the pivots, lower half; becomes the columns of the factor.
    tiles : list of Fortran-ordered
        Become the lower half of minus the product of the last m rows of the factor with themselves.

    Raises
    ------
    numpy.linalg.LinAlgError
        From a task: where the pivots are not positive definite.
    """
    height, k = panel.shape
    for start in range(0, k, _BLOCK):
        end = min(start + _BLOCK, k)
        yield [partial(_factor_diagonal, panel, start, end)]
        if end < height:
            yield [partial(_divide_rows, panel, start, end, *rows) for rows in _cut(end, height, _HEIGHT)]
    if k < height:
        # A tile reaches the end of the panel.
        yield [partial(_update_tile, panel[height - len(tile) :], tile) for tile in tiles]


def _cut(start: int, end: int, size: int) -> list[tuple[int, int]]:
    """Cut a range into equal pieces of about a size."""
    n = max(1, round((end - start) / size))
    marks = [start + (end - start) * i // n for i in range(n + 1)]
    return list(pairwise(marks))


def _factor_diagonal(panel: np.ndarray, start: int, end: int) -> None:
    block = panel[start:end, start:end]
    if start:
        subtract_square(panel[start:end, :start], block)
    factor(block)


def _divide_rows(panel: np.ndarray, start: int, end: int, top: int, bottom: int) -> None:
    if start:
        subtract_product(panel[top:bottom, :start], panel[start:end, :start], panel[top:bottom, start:end])
    _divide(panel[start:end, start:end], panel[top:bottom, start:end])


def _divide(triangle: np.ndarray, rows: np.ndarray) -> None:
    """Divide by halves: most of the work is then a product, which is four times as fast as dtrsm on a strip."""
    k = len(triangle)
    if k <= _STRIP:
        divide(triangle, rows)
        return
    half = k // 2
    _divide(triangle[:half, :half], rows[:, :half])
    subtract_product(rows[:, :half], triangle[half:, :half], rows[:, half:])
    _divide(triangle[half:, half:], rows[:, half:])


def _update_tile(lower: np.ndarray, tile: np.ndarray) -> None:
    width = tile.shape[1]
    subtract_square(lower[:width], tile[:width], fresh=True)
    if width < len(lower):
        subtract_product(lower[width:], lower[:width], tile[width:], fresh=True)
