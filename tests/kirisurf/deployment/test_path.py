"""Paths: mechanisms cost nothing, snapping sheets have the barrier that they have, drives do what they say."""

from __future__ import annotations

import numpy as np
import pytest

from kirisurf.deployment.drive import Pins, driven_vertices
from kirisurf.deployment.equilibrium import Minimizer
from kirisurf.deployment.following import follow_free_planar, follow_held, follow_rigid, follow_supported
from kirisurf.deployment.guide import Guide
from kirisurf.deployment.path import Path, PathStatus
from kirisurf.deployment.springs import energy_of
from kirisurf.errors import ParameterError
from kirisurf.tessellation import Tessellation
from tests.kirisurf.deployment.patterns import bumpy, circle, hypar, kagome, squares

EVENLY = np.linspace(0.0, 1.0, 21)
regular = pytest.mark.parametrize("tessellation", [squares(), kagome()], ids=["squares", "kagome"])


def free_path(tessellation: Tessellation, torsion: float) -> Path:
    energy = energy_of(tessellation, tessellation.contracted, torsion, 2)
    guide = Guide(tessellation, tessellation.contracted, tessellation.deployed)
    return follow_free_planar(energy, guide, EVENLY)


@regular
def test_regular_patterns_are_free_mechanisms(tessellation: Tessellation) -> None:
    path = free_path(tessellation, 0.0)
    assert path.status is PathStatus.COMPLETE
    assert path.energies.max() <= 1e-24
    assert path.largest_strains.max() <= 1e-12
    assert path.residuals.max() <= 1e-10


@regular
def test_regular_patterns_have_the_torsional_energy_of_the_formula(tessellation: Tessellation) -> None:
    # all slits open alike, which is the least of the mean square for a given mean
    path = free_path(tessellation, 1e-3)
    opening = EVENLY * path.mean_openings[-1]
    np.testing.assert_allclose(path.torsion_energies, 1e-3 * opening**2, atol=1e-12)
    assert path.stretch_energies.max() <= 1e-14


def test_a_refined_path_has_the_same_energies() -> None:
    tessellation, contracted, deployed = circle()
    guide = Guide(tessellation, contracted, deployed)
    energy = energy_of(tessellation, contracted, 1e-3, 2)
    coarse, fine = (follow_free_planar(energy, guide, np.linspace(0, 1, k)) for k in (11, 21))
    np.testing.assert_allclose(fine.energies[::2], coarse.energies, rtol=1e-9, atol=1e-16)
    held = driven_vertices(tessellation, "rim")
    evenly = [np.linspace(0, 1, k) for k in (11, 21)]
    coarse, fine = (follow_held(energy, guide, held, at, guide.places(at)) for at in evenly)
    np.testing.assert_allclose(fine.energies[::2], coarse.energies, rtol=1e-9, atol=1e-16)


def test_the_energy_is_the_work_of_the_drive() -> None:
    # the trapezoidal rule is of second order: forces on the moved vertices, through their displacements
    tessellation, contracted, deployed = circle()
    guide = Guide(tessellation, contracted, deployed)
    energy = energy_of(tessellation, contracted, 1e-3, 2)
    held = driven_vertices(tessellation, "rim")
    gaps = []
    for count in (20, 40):
        fractions = np.linspace(0, 1, count + 1)
        path = follow_held(energy, guide, held, fractions, guide.places(fractions))
        forces = np.array([energy.gradient(p)[held] for p in path.points])
        shifts = np.diff(path.points[:, held], axis=0)
        work = 0.5 * ((forces[1:] + forces[:-1]) * shifts).sum(axis=(1, 2))
        gaps.append(np.abs(np.cumsum(work) - path.energies[1:]).max())
    assert np.log2(gaps[0] / gaps[1]) == pytest.approx(2.0, abs=0.3)


@pytest.mark.parametrize("drive", ["rim", "corners"])
@pytest.mark.parametrize("trajectory", ["turning", "straight"])
def test_moved_vertices_are_where_they_should_be(drive: str, trajectory: str) -> None:
    tessellation, contracted, deployed = circle()
    guide = Guide(tessellation, contracted, deployed)
    energy = energy_of(tessellation, contracted, 1e-3, 2)
    held = driven_vertices(tessellation, drive)
    fractions = np.linspace(0, 1, 11)
    path = follow_held(energy, guide, held, fractions, guide.places(fractions, trajectory == "straight"))
    way = guide.at if trajectory == "turning" else guide.straight
    for fraction, points in zip(path.fractions, path.points, strict=True):
        np.testing.assert_allclose(points[held], way(fraction)[held], atol=1e-12)
    assert path.residuals.max() <= 1e-10
    forces = [np.abs(energy.gradient(p)[~held]).max() / energy.unit_force for p in path.points]
    np.testing.assert_allclose(forces, path.residuals, atol=1e-12)


def test_rigid_tiles_lead_to_a_saddle_in_space() -> None:
    tessellation, contracted, deployed = hypar()
    guide = Guide(tessellation, contracted, deployed)
    energy = energy_of(tessellation, contracted, 0.0, 3)
    still = follow_rigid(energy, guide, EVENLY)
    assert still.status is PathStatus.COMPLETE
    assert still.largest_strains.max() <= 1e-9
    np.testing.assert_allclose(still.points[-1], deployed, atol=1e-9)
    np.testing.assert_allclose(still.points[0], guide.flat, atol=1e-9)
    finer = follow_rigid(energy, guide, np.linspace(0, 1, 41))
    assert finer.moves.max() < 0.75 * still.moves.max()  # no jump hides in it
    stiff = energy.with_torsion(1e-3)
    path = follow_supported(stiff, guide, still)
    assert path.status is PathStatus.COMPLETE
    assert (path.energies <= [stiff.value(p) + 1e-15 for p in still.points]).all()
    assert (path.holding[5:] > 1e-5).all()


def test_progress_is_told_and_a_stop_keeps_what_was_found() -> None:
    tessellation = squares()
    guide = Guide(tessellation, tessellation.contracted, tessellation.deployed)
    energy = energy_of(tessellation, tessellation.contracted, 0.0, 2)
    told: list[tuple[int, int]] = []
    path = follow_free_planar(energy, guide, EVENLY, lambda: len(told) == 5, lambda *at: told.append(at))
    assert told == [(k, 21) for k in range(1, 6)]
    assert path.status is PathStatus.INTERRUPTED
    assert len(path.fractions) == len(path.points) == len(path.residuals) == 5


def test_a_flat_sheet_pushed_together_buckles_out_of_the_plane() -> None:
    # the rim moved inwards: in its plane the sheet is at a saddle, which nothing but a seed leads away from
    tessellation = squares(2, 2, 0.0)
    energy = energy_of(tessellation, tessellation.contracted, 1e-2, 3)
    middle = tessellation.contracted.mean(axis=0)
    start = np.column_stack([middle + 0.9 * (tessellation.contracted - middle), np.zeros(tessellation.n_vertices)])
    found = Minimizer(energy, held=driven_vertices(tessellation, "rim")).solve(start)
    assert found.is_converged and found.is_stable
    assert np.ptp(found.points[:, 2]) > 0.05
    again = Minimizer(energy, held=driven_vertices(tessellation, "rim")).solve(start)
    np.testing.assert_array_equal(found.points, again.points)


def test_a_sheet_that_is_let_go_closes() -> None:
    tessellation = squares()
    guide = Guide(tessellation, tessellation.contracted, tessellation.deployed)
    energy = energy_of(tessellation, tessellation.contracted, 1e-2, 2)
    found = Minimizer(energy, pins=Pins.of(guide.deployed)).solve(bumpy(guide.deployed, 0.01))
    assert found.is_converged and found.is_stable
    assert found.energy < 1e-18
    assert np.abs(energy.openings(found.points)).max() < 1e-7


@pytest.mark.parametrize(
    ("drive", "words"),
    [("sideways", "one of free, rim, corners"), ([], "numbers of vertices"), ([0.5], "numbers of vertices"),
     ([-1], "from 0 to"), ([10**6], "from 0 to"), (list(range(squares().n_vertices)), "left free")],
)  # fmt: skip
def test_drives_that_are_none_are_refused(drive: object, words: str) -> None:
    with pytest.raises(ParameterError, match=words):
        driven_vertices(squares(), drive if isinstance(drive, str) else np.array(drive))
