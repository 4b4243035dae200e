"""Mechanisms: known numbers, and the sparse count against singular values."""

from __future__ import annotations

import numpy as np
import pytest

from kirisurf.deployment.elements import Folds
from kirisurf.deployment.energy import Energy
from kirisurf.deployment.kinematics import INDEPENDENT, n_mechanisms
from kirisurf.deployment.springs import energy_of
from tests.kirisurf.deployment.patterns import bumpy, circle, hypar, kagome, lifted, squares


def by_singular_values(energy: Energy, points: np.ndarray) -> int:
    """The same count from the dense rigidity matrix, whose rows are differences of strains and heights."""

    def measures(at: np.ndarray) -> np.ndarray:
        vectors = energy.gathering.vectors(at)
        rows = [energy.rods.strains(vectors[0])]
        if isinstance(energy.bounds, Folds):
            rows.append(energy.bounds.heights(vectors[2]))
        return np.concatenate(rows)

    step, columns = 1e-6 * energy.length, []
    for k in range(points.size):
        shift = np.zeros(points.size)
        shift[k] = step
        shift = shift.reshape(points.shape)
        columns.append((measures(points + shift) - measures(points - shift)) / 2e-6)
    matrix = np.stack(columns, axis=1)
    values = np.linalg.svd(matrix, compute_uv=False)
    rank = int((values > INDEPENDENT).sum())
    return points.size - rank - (3 if energy.dimension == 2 else 6)


def test_four_squares_are_a_four_bar_linkage() -> None:
    four = squares(1, 1, 0.3)
    assert n_mechanisms(energy_of(four, four.contracted, dimension=2), four.deployed) == 1
    # in space: 4 bodies, 4 ball joints, 24 - 12 - 6
    assert n_mechanisms(energy_of(four, four.contracted, dimension=3), lifted(four.deployed) @ _turn()) == 6


@pytest.mark.parametrize("n", [1, 2, 3])
def test_rotating_squares_have_one_mechanism_in_the_plane(n: int) -> None:
    tessellation = squares(n, n, 0.4)
    assert n_mechanisms(energy_of(tessellation, tessellation.contracted, dimension=2), tessellation.deployed) == 1


def test_curved_sheets_have_as_many_as_they_have_outer_tiles() -> None:
    # t = m^2 bodies with 2 m (m - 1) ball joints: 6 m^2 - 6 m (m - 1) - 6
    tessellation, contracted, deployed = hypar()
    assert n_mechanisms(energy_of(tessellation, contracted, dimension=3), deployed) == 6 * 6 - 6


def test_a_sheet_that_snaps_has_none() -> None:
    tessellation, contracted, deployed = circle()
    assert n_mechanisms(energy_of(tessellation, contracted, dimension=2), deployed) == 0


@pytest.mark.parametrize("dimension", [2, 3])
@pytest.mark.parametrize("state", ["contracted", "deployed", "bumpy"])
@pytest.mark.parametrize("name", ["squares", "kagome"])
def test_the_sparse_count_is_that_of_singular_values(name: str, state: str, dimension: int) -> None:
    tessellation = squares(2, 2, 0.5) if name == "squares" else kagome()
    energy = energy_of(tessellation, tessellation.contracted, dimension=dimension)
    flat = tessellation.contracted if state == "contracted" else tessellation.deployed
    points = flat if dimension == 2 else lifted(flat)
    if state == "bumpy":
        points = bumpy(points)
    assert n_mechanisms(energy, points) == by_singular_values(energy, points)


def _turn() -> np.ndarray:
    return np.linalg.qr(np.random.default_rng(0).standard_normal((3, 3)))[0]
