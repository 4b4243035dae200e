"""Stability: the paper's square-to-circle sheet snaps and stays where slits are soft, and springs back where not."""

from __future__ import annotations

import numpy as np
import pytest

from kirisurf.deployment.drive import pinned_coordinates
from kirisurf.deployment.energy import Energy, energy_of
from kirisurf.deployment.equilibrium import Minimizer
from kirisurf.deployment.following import follow_free_planar
from kirisurf.deployment.guide import Guide
from kirisurf.deployment.ligament import torsion_of_ligament
from kirisurf.deployment.stability import find_barriers, find_minima, transition_torsion
from kirisurf.errors import ParameterError
from tests.kirisurf.deployment.patterns import circle, squares


def circle_at(torsion: float) -> tuple[Energy, Guide]:
    tessellation, contracted, deployed = circle()
    return energy_of(tessellation, contracted, torsion, 2), Guide(tessellation, contracted, deployed)


def test_soft_slits_give_two_states_and_a_saddle_between() -> None:
    energy, guide = circle_at(0.0)
    path = follow_free_planar(energy, guide, np.linspace(0, 1, 21))
    minima = find_minima(energy, guide, path)
    assert [m.is_flat for m in minima] == [True, False]
    assert max(m.energy for m in minima) < 1e-20
    assert minima[1].fraction == pytest.approx(1.0, abs=1e-6)
    (barrier,) = find_barriers(energy, guide, path, minima)
    assert barrier.is_saddle
    assert barrier.energy >= path.energies.max()
    # paths of other drives go over it, or higher
    assert barrier.energy == pytest.approx(path.energies.max(), rel=2e-2)


def test_the_saddle_leads_to_both_states() -> None:
    energy, guide = circle_at(1e-4)
    path = follow_free_planar(energy, guide, np.linspace(0, 1, 21))
    minima = find_minima(energy, guide, path)
    (barrier,) = find_barriers(energy, guide, path, minima)
    top = barrier.fraction * (len(path.fractions) - 1)
    minimizer = Minimizer(energy, pinned=pinned_coordinates(guide.deployed))
    ends = [minimizer.solve(path.points[int(k)]).energy for k in (top - 3, top + 4)]
    np.testing.assert_allclose(ends, [m.energy for m in minima], atol=1e-9)
    assert barrier.opening - barrier.closing == pytest.approx(minima[1].energy - minima[0].energy, abs=1e-12)


def test_the_transition_parts_two_kinds() -> None:
    energy, guide = circle_at(0.0)
    at = transition_torsion(energy, guide)
    assert transition_torsion(energy, guide, most=0.5 * at) == np.inf
    assert transition_torsion(energy, guide, least=2 * at) == 0
    counts = []
    for torsion in (0.98 * at, 1.02 * at):
        minimizer = Minimizer(energy.with_torsion(torsion), pinned=pinned_coordinates(guide.deployed))
        rests = [minimizer.solve(guide.at(fraction), max_steps=400) for fraction in (0.0, 0.8, 1.0)]
        assert all(rest.is_converged and rest.is_stable for rest in rests)
        counts.append(len({round(rest.energy, 9) for rest in rests}))
    assert counts == [2, 1]


def test_a_mechanism_has_no_transition() -> None:
    tessellation = squares()
    energy = energy_of(tessellation, tessellation.contracted, 0.0, 2)
    assert transition_torsion(energy, Guide(tessellation, tessellation.contracted, tessellation.deployed)) == 0


def test_where_nothing_costs_energy_both_ends_are_named() -> None:
    tessellation = squares()
    energy = energy_of(tessellation, tessellation.contracted, 0.0, 2)
    guide = Guide(tessellation, tessellation.contracted, tessellation.deployed)
    path = follow_free_planar(energy, guide, np.linspace(0, 1, 6))
    assert [(m.is_flat, round(m.fraction, 9)) for m in find_minima(energy, guide, path)] == [(True, 0.0), (False, 1.0)]


def test_with_stiff_slits_a_mechanism_rests_flat_alone() -> None:
    tessellation = squares()
    energy = energy_of(tessellation, tessellation.contracted, 1e-3, 2)
    guide = Guide(tessellation, tessellation.contracted, tessellation.deployed)
    path = follow_free_planar(energy, guide, np.linspace(0, 1, 6))
    (rest,) = find_minima(energy, guide, path)
    assert rest.is_flat and rest.energy < 1e-18


def test_a_ligament_by_hand() -> None:
    # squares of side 1/2: lambda = Nc (1 - nu) w^2 / (24 sum A)
    tessellation = squares(4, 4)
    energy = energy_of(tessellation, tessellation.contracted, dimension=2)
    slits = int(tessellation.slit_ends.sum())
    expected = slits * 0.7 * 0.05**2 / (24 * 16.0)
    assert torsion_of_ligament(energy, 0.05) == pytest.approx(expected, rel=1e-12)
    assert torsion_of_ligament(energy, 0.05, reach=0.1) == pytest.approx(expected / 2, rel=1e-12)
    assert torsion_of_ligament(energy, 0.05, modulus_ratio=2.0, thickness_ratio=0.25) == pytest.approx(expected / 2)
    large = energy_of(tessellation, 10 * tessellation.contracted, dimension=2)
    assert torsion_of_ligament(large, 0.5) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize(
    "options", [{"width": 0.0}, {"width": np.nan}, {"width": 1.0, "reach": -1.0}, {"width": 1.0, "poisson": 0.5}]
)
def test_ligaments_that_are_none_are_refused(options: dict[str, float]) -> None:
    tessellation = squares()
    with pytest.raises(ParameterError, match="expected a number"):
        torsion_of_ligament(energy_of(tessellation, tessellation.contracted), **options)  # type: ignore[arg-type]
