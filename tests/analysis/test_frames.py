"""Frames between two states: ends are the states themselves, a mechanism of the plane is followed exactly."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.distance import pdist
from scipy.spatial.transform import Rotation

from analysis.frames import frames, laid_beneath
from kirisurf.errors import UnusableError
from kirisurf.pattern import quad_pattern

PATTERN = quad_pattern(3, 2)


def spatial(points: np.ndarray) -> np.ndarray:
    return np.column_stack([points, np.zeros(len(points))])


OPENED = spatial(PATTERN.deployed)


@pytest.mark.parametrize("seed", range(3))
def test_the_flat_sheet_is_moved_rigidly_and_never_further_than_it_was(seed: int) -> None:
    turn = Rotation.random(random_state=seed)
    flat = turn.apply(spatial(PATTERN.contracted)) + np.array([5.0, -3.0, 2.0])
    laid = laid_beneath(flat, OPENED)
    assert pdist(laid) == pytest.approx(pdist(flat), abs=1e-12)
    assert ((laid - OPENED) ** 2).sum() <= ((spatial(PATTERN.contracted) - OPENED) ** 2).sum() + 1e-12
    # planar rotating squares need no third dimension
    assert laid[:, 2] == pytest.approx(np.zeros(len(laid)), abs=1e-9)


def test_rotating_squares_open_as_the_mechanism_that_they_are() -> None:
    shares = np.linspace(0, 1, 7)
    found = list(frames(PATTERN, PATTERN.contracted, OPENED, shares))
    full = found[-1].opening_angle
    for frame, share in zip(found, shares, strict=True):
        assert frame.share == share
        assert frame.isometry == pytest.approx(np.zeros(PATTERN.n_tiles), abs=1e-9)
        assert frame.opening_angle == pytest.approx(share * full, abs=1e-7)


def test_a_bent_sheet_is_strained_on_the_way_and_says_so() -> None:
    x, y = PATTERN.deployed.T
    bent = np.column_stack([x, y, 0.3 * np.sin(x) * y])
    strains = [frame.isometry.max() for frame in frames(PATTERN, PATTERN.contracted, bent, (0.0, 0.5, 1.0))]
    assert strains[0] < 1e-12 and min(strains[1:]) > 1e-3  # lifted, its tiles are not those of the flat sheet either


def test_frames_do_not_depend_on_where_the_flat_sheet_lies() -> None:
    moved = Rotation.from_rotvec([0.3, -1.0, 0.5]).apply(spatial(PATTERN.contracted)) + 7.0
    for one, other in zip(
        frames(PATTERN, PATTERN.contracted, OPENED, (0.0, 0.4)), frames(PATTERN, moved, OPENED, (0.0, 0.4)), strict=True
    ):
        assert one.points == pytest.approx(other.points, abs=1e-9)


@pytest.mark.parametrize("wrong", [OPENED[:-1], OPENED * np.nan, OPENED.ravel()])
def test_wrong_states_are_refused(wrong: np.ndarray) -> None:
    with pytest.raises(UnusableError):
        list(frames(PATTERN, PATTERN.contracted, wrong, (0.5,)))
    with pytest.raises(UnusableError):
        list(frames(PATTERN, wrong, OPENED, (0.5,)))
