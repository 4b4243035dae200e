"""The gate lets through what native code can bear, and names everything else."""

from __future__ import annotations

import time

import numpy as np
import pytest

from kirisurf.errors import UnusableError
from kirisurf.gate import check_native, flat_faces

POINTS = np.array([[0, 0, 0], [1, 0, 0], [0, 1, 0], [1, 1, 1]], dtype=float)
FACES = np.array([[0, 1, 2], [1, 3, 2]])


def test_what_passes_is_frozen_contiguous_and_equal() -> None:
    points, faces = check_native(np.asfortranarray(POINTS), FACES.astype(np.int64)[:, ::-1][:, ::-1])
    assert points.flags.c_contiguous and faces.flags.c_contiguous
    assert not points.flags.writeable and not faces.flags.writeable
    assert np.array_equal(points, POINTS) and np.array_equal(faces, FACES)
    assert points.dtype == np.float64 and faces.dtype == np.int64


def _with(row: int, column: int, value: float) -> np.ndarray:
    points = POINTS.copy()
    points[row, column] = value
    return points


@pytest.mark.parametrize(
    ("points", "faces", "message"),
    [
        (POINTS, np.zeros((0, 3), int), "at least one face"),
        (_with(0, 0, np.nan), FACES, "finite"),
        (_with(0, 0, np.inf), FACES, "finite"),
        (_with(0, 0, 1e300), FACES, "overflow"),
        (POINTS * 1e-200, FACES, "underflow"),
        (POINTS * 0, FACES, "in one place"),
        (POINTS + 1e14, FACES, "too few digits"),
        (POINTS, np.array([[0, 1, 4]]), "from 0 to 3, got 4"),
        (POINTS, np.array([[0, 1, -1]]), "got -1"),
        (POINTS, np.array([[0, 1, 1], [0, 2, 3]]), r"got \[0, 1, 1\] in face 0"),
        (POINTS, np.array([[0, 1, 2]]), "1 vertices in none, vertex 3"),
        (_with(3, 2, 0.0) * [1, 0, 1], FACES, "with an area"),
        (np.array([[0, 0, 0], [1, 1, 1], [2, 2, 2.0]]) / 3, np.array([[0, 1, 2]]), "with an area"),
    ],
)
def test_what_does_not(points: np.ndarray, faces: np.ndarray, message: str) -> None:
    with pytest.raises(UnusableError, match=message):
        check_native(points, faces, "thing")


def test_thin_is_not_flat_and_scale_does_not_matter() -> None:
    sliver = np.array([[0, 0, 0], [1, 0, 0], [0.5, 1e-12, 0]])
    for scale in (1e-30, 1.0, 1e30):
        assert not flat_faces(scale * sliver, np.array([[0, 1, 2]])).any()
    sliver[2, 1] = 1e-16
    assert flat_faces(sliver, np.array([[0, 1, 2]])).all()
    assert flat_faces(sliver[:0], np.zeros((0, 3), int)).shape == (0,)


def test_far_from_the_origin_rounding_counts() -> None:
    sliver = np.array([[0, 0, 0], [1, 0, 0], [0.5, 1e-8, 0]])
    assert not flat_faces(sliver + 1e3, np.array([[0, 1, 2]])).any()
    assert flat_faces(sliver + 1e9, np.array([[0, 1, 2]])).all()


def test_a_hundred_thousand_faces_take_no_time() -> None:
    n = 224
    x, y = np.meshgrid(np.arange(n), np.arange(n))
    at = np.arange(n * n).reshape(n, n)
    a, b, c, d = at[:-1, :-1].ravel(), at[:-1, 1:].ravel(), at[1:, 1:].ravel(), at[1:, :-1].ravel()
    faces = np.concatenate([np.stack([a, b, c], 1), np.stack([a, c, d], 1)])
    points = np.stack([x.ravel(), y.ravel(), np.sin(x).ravel()], axis=1).astype(float)
    # seconds of this thread alone: whatever else the machine does has no part in them
    start = time.thread_time()
    check_native(points, faces)
    assert time.thread_time() - start < 0.5
