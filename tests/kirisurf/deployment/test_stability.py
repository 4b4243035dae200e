"""Stability: the paper's square-to-circle sheet snaps and stays where slits are soft, and springs back where not."""

from __future__ import annotations

import numpy as np
import pytest

from kirisurf.deployment import Kind, deploy
from kirisurf.deployment.drive import Pins, driven_vertices
from kirisurf.deployment.energy import Energy
from kirisurf.deployment.equilibrium import Minimizer
from kirisurf.deployment.following import follow_free_planar, follow_held
from kirisurf.deployment.guide import Guide
from kirisurf.deployment.ligament import torsion_of_ligament
from kirisurf.deployment.loading import Loading, mean_opening
from kirisurf.deployment.springs import energy_of
from kirisurf.deployment.stability import find_barriers, find_minima
from kirisurf.deployment.transition import RIGID_TORSION, transition_torsion
from kirisurf.errors import ParameterError
from tests.kirisurf.deployment.patterns import bumpy, circle, kagome, squares


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
    first, last = (mean_opening(energy, end) for end in (guide.flat, guide.deployed))
    pins, toward = Pins.of(guide.deployed), guide.deployed - guide.flat
    held = Minimizer(energy, pins=pins, toward=toward)
    near = path.points[np.abs(path.energies - barrier.energy).argmin()]
    ends = []
    for side in (-1e-3, 1e-3):  # a little closed, and a little opened from the saddle
        load = Loading(opening=first + (barrier.fraction + side) * (last - first))
        ends.append(Minimizer(energy, pins=pins).solve(held.solve(near, load).points).energy)
    np.testing.assert_allclose(ends, [m.energy for m in minima], atol=1e-9)
    assert barrier.opening - barrier.closing == pytest.approx(minima[1].energy - minima[0].energy, abs=1e-12)


def test_the_transition_parts_two_kinds() -> None:
    energy, guide = circle_at(0.0)
    at = transition_torsion(energy, guide)
    assert transition_torsion(energy, guide, most=0.5 * at) == np.inf
    assert transition_torsion(energy, guide, least=2 * at) == 0
    counts = []
    for torsion in (0.98 * at, 1.02 * at):
        minimizer = Minimizer(energy.with_torsion(torsion), pins=Pins.of(guide.deployed))
        rests = [minimizer.solve(guide.at(fraction), max_steps=400) for fraction in (0.0, 0.8, 1.0)]
        assert all(rest.is_converged and rest.is_stable for rest in rests)
        counts.append(len({round(rest.energy, 9) for rest in rests}))
    assert counts == [2, 1]


def test_a_mechanism_has_no_transition() -> None:
    tessellation = squares()
    energy = energy_of(tessellation, tessellation.contracted, 0.0, 2)
    guide = Guide(tessellation, tessellation.contracted, tessellation.deployed)
    assert transition_torsion(energy, guide, RIGID_TORSION) == 0
    assert transition_torsion(energy, guide, should_stop=lambda: True) is None


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


@pytest.mark.parametrize("degrees", [0.0, 15.0, 50.0, 77.0])
def test_no_support_holds_a_sheet_that_is_let_go(degrees: float) -> None:
    # where a sheet rests nothing pulls, on supported coordinates neither, whichever way it lies
    tessellation = kagome()
    flat, angle = tessellation.contracted, np.radians(degrees)
    turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
    energy = energy_of(tessellation, flat, 1e-3, 2)
    guide = Guide(tessellation, flat, tessellation.deployed @ turn)
    minimizer = Minimizer(energy, pins=Pins.of(guide.deployed))
    for start in (guide.deployed, guide.at(0.5), bumpy(guide.at(0.8), 0.02)):
        found = minimizer.solve(start, max_steps=1000)
        assert found.is_converged and found.is_stable
        assert np.abs(energy.gradient(found.points)).max() <= 1e-9 * energy.unit_force


def test_a_drive_does_not_hide_where_the_sheet_rests() -> None:
    energy, guide = circle_at(1e-4)
    held = driven_vertices(circle()[0], "corners")
    fractions = np.linspace(0, 1, 11)
    path = follow_held(energy, guide, held, fractions, guide.places(fractions, is_straight=True))
    opened = find_minima(energy, guide, path)[-1]
    assert opened.fraction > 0.8
    assert np.abs(energy.gradient(opened.points)).max() <= 1e-9 * energy.unit_force
    free = follow_free_planar(energy, guide, np.linspace(0, 1, 21))
    assert find_minima(energy, guide, free)[-1].opening == pytest.approx(opened.opening, abs=1e-3)
    # a way that does not come near both says nothing of the barrier; the free way goes over the saddle
    assert path.energies[-1] != opened.energy
    known = find_barriers(energy, guide, free, find_minima(energy, guide, free))
    for barrier in find_barriers(energy, guide, path, find_minima(energy, guide, path)):
        assert barrier.energy >= known[-1].energy - 1e-12


@pytest.mark.parametrize("torsion", [0.0, 1e-10, 1e-8, 1e-6])
def test_an_open_state_is_seen_however_soft_the_slits(torsion: float) -> None:
    energy, guide = circle_at(torsion)
    path = follow_free_planar(energy, guide, np.linspace(0, 1, 21))
    assert [round(minimum.fraction, 2) for minimum in find_minima(energy, guide, path)] == [0.0, 1.0]


def test_a_path_that_leads_nowhere_says_nothing_of_the_shape() -> None:
    tessellation = squares()
    found = deploy(tessellation, tessellation.contracted, tessellation.deployed, torsion=1e-3, drive=[0], steps=4)
    assert found.verdicts[0].kind is Kind.SPRINGS_BACK
    assert found.transition == 0
