"""Similarities are found again, and never mirror."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

from analysis.similarity import laid_on


@pytest.mark.parametrize("flat", [False, True])
def test_a_similarity_is_found_again(flat):
    rng = np.random.default_rng(5)
    points = rng.normal(size=(20, 3)) * (1.0, 1.0, 0.0 if flat else 1.0)
    goal = 2.5 * points @ Rotation.from_rotvec([0.3, -1.1, 0.7]).as_matrix().T + [4.0, 5.0, -6.0]
    assert np.allclose(laid_on(points, goal), goal)


def test_a_mirror_image_is_not_reached():
    points = np.random.default_rng(6).normal(size=(20, 3))
    mirrored = points * (1.0, 1.0, -1.0)
    laid = laid_on(points, mirrored)
    assert np.linalg.norm(laid - mirrored) > 0.1 * np.linalg.norm(mirrored)
    # what is reached is nearer than any other rotation tried
    for turn in Rotation.random(50, random_state=1):
        other = turn.apply(points - points.mean(axis=0)) + mirrored.mean(axis=0)
        assert ((laid - mirrored) ** 2).sum() <= ((other - mirrored) ** 2).sum() + 1e-9
