"""Branches: where a prescribed opening snaps, the curve of equilibria goes on through folds, and over saddles."""

from __future__ import annotations

from functools import cache
from itertools import pairwise

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from analysis.collision_path import path_collisions
from kirisurf.deployment import Barrier, BranchEnd, Minimum, deploy
from kirisurf.deployment.branch import Branch, follow_branch, jump_branches
from kirisurf.deployment.drive import Pins
from kirisurf.deployment.energy import Energy
from kirisurf.deployment.equilibrium import Minimizer
from kirisurf.deployment.equilibrium_curve import Balance, EquilibriumCurve
from kirisurf.deployment.following import follow_free_planar, follow_held
from kirisurf.deployment.guide import Guide
from kirisurf.deployment.loading import STIFFNESS, Loading, loaded, mean_opening, total_energy
from kirisurf.deployment.minimum import distance
from kirisurf.deployment.passes import find_passes
from kirisurf.deployment.path import Path, PathStatus, jumps
from kirisurf.deployment.springs import energy_of
from kirisurf.deployment.stability import find_barriers, find_minima
from kirisurf.deployment_tables import deployment_record
from kirisurf.errors import ParameterError, UnusableError
from kirisurf.pattern import tile_pattern
from kirisurf.tessellation import Tessellation
from kirisurf.unit_cells import find_cell
from tests.kirisurf.deployment.patterns import bumpy, squares

Way = tuple[Energy, Guide, Path]


@cache
def islamic(name: str, columns: int, rows: int) -> Tessellation:
    cell = find_cell(name)
    return tile_pattern(cell, np.ones((columns, rows, len(cell.tiles)), bool))


def way_of(tessellation: Tessellation, torsion: float) -> Way:
    energy = energy_of(tessellation, tessellation.contracted, torsion, 2)
    guide = Guide(tessellation, tessellation.contracted, tessellation.deployed)
    return energy, guide, follow_free_planar(energy, guide, np.linspace(0, 1, 21))


@pytest.fixture(scope="module")
def snapping() -> Way:
    """Eight tiles that snap once; the curve between is an S with two folds."""
    return way_of(islamic("islamic-quad", 1, 1), 1e-3)


@pytest.fixture(scope="module")
def onward(snapping: Way) -> Branch:
    """From the last state before the jump far beyond it."""
    energy, guide, path = snapping
    (row,) = jumps(energy, guide, path)
    return follow_branch(energy, guide, path.points[row], beyond=float(path.mean_openings[15]), most=200)


@pytest.fixture(scope="module")
def resting() -> Way:
    """24 tiles that rest in several states, some of them behind jumps."""
    return way_of(islamic("islamic-triangle", 2, 2), 1e-4)


@pytest.fixture(scope="module")
def found(resting: Way) -> tuple[tuple[Branch, ...], tuple[Minimum, ...]]:
    energy, guide, path = resting
    branches = jump_branches(energy, guide, path)
    return branches, find_minima(energy, guide, path, branches=branches)


def pull(energy: Energy, state: Balance) -> float:
    """Largest part of grad E - force * grad s, over the force of a rod, s by central differences."""
    points, slope = state.points, np.zeros(state.points.shape)
    step = 1e-6 * energy.length
    for at in np.ndindex(points.shape):
        ends = []
        for side in (-step, step):
            moved = points.copy()
            moved[at] += side
            ends.append(mean_opening(energy, moved))
        slope[at] = (ends[1] - ends[0]) / (2 * step)
    return float(np.abs(energy.gradient(points) - state.force * slope).max() / energy.unit_force)


def test_where_the_path_jumps_the_curve_goes_through_two_folds(snapping: Way, onward: Branch) -> None:
    energy, guide, path = snapping
    assert path.status is PathStatus.JUMPED
    (row,) = jumps(energy, guide, path)
    assert onward.end is BranchEnd.HELD
    assert len(onward.folds) == 2
    first, second = (onward.openings[k] for k in onward.folds)
    # an S: forth, back, and forth again
    assert second < onward.openings[0] < first < onward.openings[-1]
    np.testing.assert_allclose(onward.states[0].points, path.points[row], atol=1e-12)


def test_arc_length_and_prescribed_openings_find_the_same_states(snapping: Way, onward: Branch) -> None:
    energy, guide, path = snapping
    (row,) = jumps(energy, guide, path)
    minimizer = Minimizer(energy, pins=Pins.of(guide.deployed), toward=guide.deployed - guide.flat)
    beyond = [state for state in onward.states[onward.folds[1] + 1 :] if state.opening > path.mean_openings[row + 1]]
    assert len(beyond) > 4 and all(state.n_across == 0 for state in beyond)
    for state in beyond:
        near = path.points[np.abs(path.mean_openings - state.opening).argmin()]
        found = minimizer.solve(near, Loading(opening=state.opening + state.force / STIFFNESS), near=state.points)
        np.testing.assert_allclose(found.points, state.points, atol=1e-8 * energy.length)
        assert found.energy == pytest.approx(state.energy, rel=1e-8)


def test_a_prescribed_opening_does_not_pass_the_fold(snapping: Way, onward: Branch) -> None:
    energy, guide, _ = snapping
    minimizer = Minimizer(energy, pins=Pins.of(guide.deployed), toward=guide.deployed - guide.flat)
    fold = onward.states[onward.folds[0]]
    top = max(state.opening for state in onward.states[: onward.folds[0] + 2])
    beyond = minimizer.solve(fold.points, Loading(opening=top + 0.02))
    assert beyond.is_converged
    assert distance(beyond.points, fold.points, energy.length) > 1.0
    after = onward.states[onward.folds[0] + 1]
    assert distance(after.points, fold.points, energy.length) < 0.2


def test_every_state_is_in_equilibrium_held_or_not(snapping: Way, onward: Branch) -> None:
    energy = snapping[0]
    assert max(state.n_across for state in onward.states) == 1
    for state in onward.states[::4]:
        assert pull(energy, state) < 1e-8
        assert state.residual <= 1e-10
        assert state.energy == pytest.approx(energy.value(state.points), rel=1e-12)
        assert state.opening == pytest.approx(mean_opening(energy, state.points), rel=1e-12)


def test_falling_directions_are_those_of_the_dense_matrix(snapping: Way, onward: Branch) -> None:
    energy = snapping[0]
    counted = set()
    for state in onward.states[::8]:
        size = state.points.size
        load, step = Loading(force=state.force), 1e-5 * energy.length
        columns = []
        for k in range(size):
            side = np.zeros(size)
            side[k] = step
            ends = [loaded(energy, state.points + s * side.reshape(-1, 2), load).gradient.ravel() for s in (-1, 1)]
            columns.append((ends[1] - ends[0]) / (2 * step) * energy.length)
        matrix = 0.5 * (np.array(columns) + np.array(columns).T)
        slope = loaded(energy, state.points, load).slope
        assert slope is not None
        across = np.eye(size) - np.outer(slope.ravel(), slope.ravel()) / (slope**2).sum()
        every, kept = np.linalg.eigvalsh(matrix), np.linalg.eigvalsh(across @ matrix @ across)
        if min(np.sort(np.abs(every))[3], np.sort(np.abs(kept))[4]) < 1e-5:
            continue  # too near to a fold for differences
        counted.add((state.n_negative, state.n_across))
        assert (state.n_negative, state.n_across) == (int((every < -1e-6).sum()), int((kept < -1e-6).sum()))
    assert len(counted) > 2


def test_at_a_fold_one_falling_direction_comes_or_goes(onward: Branch) -> None:
    assert onward.crossings == ()
    changes = {k: two.n_across - one.n_across for k, (one, two) in enumerate(pairwise(onward.states))}
    assert {k for k, change in changes.items() if change} == set(onward.folds)
    assert [changes[k] for k in onward.folds] == [1, -1]


def test_a_shorter_step_finds_the_same_fold_to_second_order(snapping: Way) -> None:
    # of states at even distances h, the one nearest to a fold is off it by h / 2 at most: by a (h / 2)^2 in the opening
    energy, guide, path = snapping
    (row,) = jumps(energy, guide, path)
    steps, tops = (0.06, 0.03, 0.015), []
    for longest in steps:
        branch = follow_branch(energy, guide, path.points[row], most=int(0.8 / longest), longest=longest)
        assert branch.folds
        fold = branch.folds[0]
        tops.append(branch.openings[fold - 1 : fold + 3].max())
        if longest == steps[-1]:
            at = branch.openings[fold - 1 : fold + 3]
            bend = -np.diff(at, 2).mean() / np.mean(branch.lengths[fold - 1 : fold + 2]) ** 2
            exact = tops[-1] + 0.125 * bend * longest**2
    assert bend > 0
    for longest, top in zip(steps, tops, strict=True):
        assert -0.25 * bend * steps[-1] ** 2 <= exact - top <= 0.15 * bend * longest**2 + 0.25 * bend * steps[-1] ** 2


def test_a_state_is_foreseen_to_second_order_and_with_the_bend_to_third(snapping: Way, onward: Branch) -> None:
    energy, guide, _ = snapping
    curve = EquilibriumCurve(energy, Pins.of(guide.deployed), onward.states[0].points)

    def off(before: Balance, bend: np.ndarray, length: float) -> list[float]:
        there = curve.after(before, length)
        assert there is not None
        guesses = curve.foreseen(before, length), curve.foreseen(before, length, length * bend)
        return [float(np.linalg.norm(there.points - guess)) for guess in guesses]

    orders = []
    for before, length in zip(onward.states, onward.lengths, strict=False):
        if length < 0.04:
            continue  # next to a corner, where a contact begins
        ahead, behind = curve.after(before, 1e-4), curve.after(before, -1e-4)
        assert ahead is not None and behind is not None
        bend = (ahead.direction - behind.direction) / 2e-4
        orders.append(np.log2(np.array(off(before, bend, 0.02)) / off(before, bend, 0.01)))
    assert len(orders) > 10
    assert np.all(np.abs(np.median(orders, axis=0) - (2, 3)) < 0.2), orders


def test_the_energy_is_the_work_of_the_load_through_folds(snapping: Way) -> None:
    energy, guide, path = snapping
    (row,) = jumps(energy, guide, path)
    gaps = []
    for longest in (0.08, 0.02):
        branch = follow_branch(energy, guide, path.points[row], most=2000, longest=longest, beyond=0.0)
        forces = np.array([state.force for state in branch.states])
        work = np.cumsum(0.5 * (forces[1:] + forces[:-1]) * np.diff(branch.openings))
        gaps.append(np.abs(work - (branch.energies[1:] - branch.energies[0])).max())
    assert gaps[1] < 1e-3 * np.ptp(branch.energies)
    # of second order where the longest step is taken, and shorter ones are not changed by it
    assert gaps[1] < gaps[0] / 5


def test_the_way_back_is_the_same(snapping: Way, onward: Branch) -> None:
    energy, guide, _ = snapping
    start = onward.states[0]
    last = onward.states[-1]
    back = follow_branch(energy, guide, last.points, opens=False, beyond=start.opening, most=200)
    assert back.end is BranchEnd.HELD
    turns = [[branch.openings[k] for k in branch.folds] for branch in (onward, back)]
    np.testing.assert_allclose(turns[1][::-1], turns[0], atol=0.01)


def test_a_state_without_load_is_stationary(
    resting: Way, found: tuple[tuple[Branch, ...], tuple[Minimum, ...]]
) -> None:
    energy, guide, _ = resting
    states = [state for branch in found[0] for state in branch.stationary]
    assert {state.n_negative for state in states} >= {0, 1}
    minimizer = Minimizer(energy, pins=Pins.of(guide.deployed))
    for state in states:
        assert state.force == 0
        assert np.abs(energy.gradient(state.points)).max() <= 1e-10 * energy.unit_force
        if state.n_negative == 0:
            assert minimizer.solve(state.points).steps == 0
        assert minimizer.is_saddle(state.points) == (state.n_negative == 1)


def test_a_sheet_that_flows_down_from_a_pass_comes_to_rest_on_both_sides(
    resting: Way, found: tuple[tuple[Branch, ...], tuple[Minimum, ...]]
) -> None:
    (energy, guide, path), (branches, minima) = resting, found
    passes = find_passes(energy, guide, branches, minima, float(path.energies.max()))
    assert passes
    scale = energy.length / energy.unit_force
    for closed, saddles in passes.items():
        saddle = saddles[0]
        curvature = np.linalg.eigh(dense(energy, saddle.points))
        mode = curvature.eigenvectors[:, 0].reshape(-1, 2)
        reached = set()
        for side in (-0.01, 0.01):
            start = saddle.points + side * energy.length * mode
            flow = solve_ivp(
                lambda _, x: -scale * energy.gradient(x.reshape(-1, 2)).ravel(), (0, 1e6), start.ravel(), "BDF",
                jac=lambda _, x: -scale * dense(energy, x.reshape(-1, 2)), rtol=1e-4, atol=1e-6,
            )  # fmt: skip
            end = flow.y[:, -1].reshape(-1, 2)
            reached |= {k for k, one in enumerate(minima) if distance(end, one.points, energy.length) < 0.01}
        assert reached == {closed, closed + 1}


def dense(energy: Energy, points: np.ndarray) -> np.ndarray:
    found, size = energy.evaluate(points), points.size
    return np.array([energy.product(found, column.reshape(-1, 2)).ravel() for column in np.eye(size)])


def test_a_pass_gives_the_barrier_where_the_path_jumps(
    resting: Way, found: tuple[tuple[Branch, ...], tuple[Minimum, ...]]
) -> None:
    (energy, guide, path), (branches, minima) = resting, found

    def saddles(found: tuple[Barrier, ...]) -> list[Barrier]:
        return [barrier for barrier in found if barrier.is_saddle]

    without, with_them = (
        find_barriers(energy, guide, path, minima),
        find_barriers(energy, guide, path, minima, branches),
    )
    assert len(saddles(with_them)) > len(saddles(without))
    for barrier in saddles(with_them):
        assert barrier.opening > 0 and barrier.closing > 0


def test_a_deployment_has_branches_at_its_jumps_alone() -> None:
    sheet = islamic("islamic-quad", 1, 1)
    made = deploy(sheet, sheet.contracted, sheet.deployed, torsion=1e-3, steps=20)
    assert made.paths[0].status is PathStatus.JUMPED
    assert [branch.end for branch in made.branches[0]] == [BranchEnd.HELD, BranchEnd.HELD]
    (record,) = deployment_record(made, [path_collisions(list(made.paths[0].points), sheet.tiles)])["paths"]
    for told, branch in zip(record["branches"], made.branches[0], strict=True):
        assert told["folds"] == 2 and told["end"] == "HELD" and told["crossings"] == 0
        assert told["states"] == len(branch.states) and told["newton_steps"] == branch.steps
        assert told["fraction_end"] == pytest.approx(
            mean_opening(made.energy, branch.states[-1].points) / mean_opening(made.energy, sheet.deployed), rel=1e-9
        )
    plain = squares()
    assert deploy(plain, plain.contracted, plain.deployed, torsion=1e-3, steps=5).branches == ((),)


def test_a_moved_rim_has_no_branches() -> None:
    sheet = islamic("islamic-quad", 1, 1)
    energy = energy_of(sheet, sheet.contracted, 1e-3, 2)
    guide = Guide(sheet, sheet.contracted, sheet.deployed)
    held = np.zeros(sheet.n_vertices, bool)
    held[sheet.outline[:2]] = True
    fractions = np.linspace(0, 1, 6)
    path = follow_held(energy, guide, held, fractions, guide.places(fractions))
    assert path.status is PathStatus.JUMPED
    assert jump_branches(energy, guide, path) == ()


def test_a_stop_keeps_what_was_found(snapping: Way) -> None:
    energy, guide, path = snapping
    (row,) = jumps(energy, guide, path)
    asked: list[int] = []

    def stop() -> bool:
        asked.append(0)
        return len(asked) > 5

    branch = follow_branch(energy, guide, path.points[row], should_stop=stop)
    assert branch.end is BranchEnd.INTERRUPTED
    assert 1 < len(branch.states) <= 6
    assert jump_branches(energy, guide, path, should_stop=lambda: True) == ()
    few = jump_branches(energy, guide, path, most=10, most_in_all=15)
    assert [len(one.states) for one in few] == [10, 5] and {one.end for one in few} == {BranchEnd.LONG}


def test_a_force_does_the_work_of_the_opening() -> None:
    sheet = islamic("islamic-quad", 1, 1)
    energy = energy_of(sheet, sheet.contracted, 1e-3, 2)
    guide = Guide(sheet, sheet.contracted, sheet.deployed)
    points, move = bumpy(guide.at(0.5), 0.01), bumpy(np.zeros(guide.flat.shape), 1.0, 1)
    load, step = Loading(force=3e-3), 1e-6
    ends = [loaded(energy, points + side * step * move, load).total for side in (-1, 1)]
    here = loaded(energy, points, load)
    assert (ends[1] - ends[0]) / (2 * step) == pytest.approx(energy.unit_force * (here.gradient * move).sum(), rel=1e-6)
    assert here.total == pytest.approx(total_energy(energy, points, load), rel=1e-12)
    assert here.total == pytest.approx(energy.value(points) - 3e-3 * mean_opening(energy, points), rel=1e-12)


def test_what_is_no_start_is_refused(snapping: Way) -> None:
    energy, guide, path = snapping
    with pytest.raises(UnusableError, match="in equilibrium under a load"):
        follow_branch(energy, guide, bumpy(path.points[5], 0.1))
    with pytest.raises(ParameterError, match="at least 2 states"):
        follow_branch(energy, guide, path.points[5], most=1)
    for longest in (0.0, -1.0, np.nan):
        with pytest.raises(ParameterError, match="longest: expected"):
            follow_branch(energy, guide, path.points[5], longest=longest)
