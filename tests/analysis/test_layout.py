"""Overlap and gaps of contracted tiles have the areas that they have."""

from __future__ import annotations

import numpy as np
import pytest

from analysis.layout import measure_layout
from kirisurf.loops import Loops

SQUARE = np.array([[0.0, 0], [1, 0], [1, 1], [0, 1]])


def squares(*corners: tuple[float, float]):
    return np.concatenate([SQUARE + corner for corner in corners]), Loops.from_lists(
        np.arange(4 * len(corners)).reshape(-1, 4)
    )


@pytest.mark.parametrize(("shift", "overlap"), [((1, 0), 0), ((0.75, 0), 0.125), ((0.5, 0.5), 0.125), ((1e-6, 0), 0.5)])
def test_overlap_area(shift, overlap):
    layout = measure_layout(*squares((0, 0), shift), None)
    assert layout.overlap == pytest.approx(overlap, abs=1e-6)
    assert len(layout.overlapping) == (overlap > 0)


def test_gap_area_and_place():
    around = [(x, y) for x in range(3) for y in range(3) if (x, y) != (1, 1)]
    layout = measure_layout(*squares(*around), None)
    assert layout.gap == pytest.approx(1 / 8)
    assert layout.gap_place == pytest.approx([1.5, 1.5], abs=0.5)
    assert layout.overlap == 0


def test_cracks_of_rounding_size_are_no_gaps():
    points, tiles = squares(*[(x, y) for x in range(3) for y in range(3)])
    weld = np.unique(points, axis=0, return_inverse=True)[1].ravel()
    points = points + np.random.default_rng(0).normal(size=points.shape) * 1e-13
    layout = measure_layout(points, tiles, weld)
    assert layout.gap == 0
    assert layout.overlap <= 1e-12


def test_flipped_and_broken_tiles_are_named():
    points, tiles = squares((0, 0), (2, 0), (4, 0))
    points[4:8] = points[4:8][::-1]
    assert measure_layout(points, tiles, None).flipped.tolist() == [1]
    points[[8, 9]] = points[[9, 8]]
    layout = measure_layout(points, tiles, None)
    assert layout.broken.tolist() == [2]
    assert layout.overlap is None
