"""Peers on the same problems: the same minimum, the same endings, and what is said where they are missing."""

from __future__ import annotations

import numpy as np
import pytest

import sample_surfaces
from kirisurf.cli import main
from kirisurf.errors import ParameterError
from kirisurf.formulation import Formulation, Weights
from kirisurf.problem import Problem
from kirisurf.scaling import unit_scale
from kirisurf.solvers import optional
from kirisurf.solvers.callbacks import SparseProgram
from kirisurf.solvers.choice import Solver, default_steps, make_solver
from kirisurf.solvers.interior_point import InteriorPoint
from kirisurf.solvers.outcome import Limits
from kirisurf.spec import SOLVERS, FitSpec
from kirisurf.start import make_start
from kirisurf.states import Step
from kirisurf.status import Status

PEERS = ("ipopt", "uno")


def formulation(name: str, cells: int, exact: bool = False) -> tuple[Formulation, np.ndarray]:
    surface = sample_surfaces.load(name, resolution=20)
    start = make_start(surface, FitSpec(target=name, cells=(cells, cells)))
    frame, scaled = unit_scale(surface, start.tessellation, start.points)
    points = frame.into(start.points)
    return Formulation(start.tessellation, points, scaled, Weights(), exact=exact), points


@pytest.fixture(params=PEERS)
def peer(request: pytest.FixtureRequest) -> str:
    """A peer whose library is there."""
    if not optional.is_installed(request.param):
        missing = optional.LIBRARIES[request.param]
        pytest.skip(f"{request.node.name} did not run: {missing} is not installed (the extra kirisurf[peers])")
    return request.param


def random_multipliers(program: SparseProgram, seed: int = 1) -> np.ndarray:
    return np.random.default_rng(seed).standard_normal(program.m)


def dense_hessian(program: SparseProgram, x: np.ndarray, factor: float, multipliers: np.ndarray) -> np.ndarray:
    lower = np.zeros((program.n, program.n))
    lower[program.hessian_rows, program.hessian_columns] = program.hessian(x, factor, multipliers)
    return lower + np.tril(lower, -1).T


def flat_problem() -> tuple[Problem, SparseProgram, np.ndarray]:
    made, start = formulation("paraboloid", 1)
    problem = made.problem_at(start)
    x = (start + 0.02 * np.random.default_rng(0).standard_normal(start.shape)).ravel()
    return problem, SparseProgram(problem, start.ravel()), x


def test_the_flat_values_are_those_of_the_problem() -> None:
    problem, program, x = flat_problem()
    points = x.reshape(-1, 3)
    assert program.objective(x) == problem.objective(points)
    np.testing.assert_array_equal(
        program.rows(x), np.concatenate([problem.equality_rows(points), problem.inequality_rows(points)])
    )
    n_equalities = len(problem.equality_rows(points))
    assert (program.upper[:n_equalities] == 0).all() and (program.upper[n_equalities:] > 1e19).all()
    assert (program.lower == 0).all() and program.m == len(program.lower)
    assert (program.hessian_rows >= program.hessian_columns).all()


@pytest.mark.parametrize("factor", [1.0, 0.3, 0.0])
def test_flat_derivatives_have_slope_two(factor: float) -> None:
    """Gradient against values, and Hessian against gradient and Jacobian, for every weight of the objective."""
    _, program, x = flat_problem()
    multipliers = random_multipliers(program)
    direction = np.random.default_rng(2).standard_normal(program.n)

    def lagrangian(v: np.ndarray) -> float:
        return factor * program.objective(v) + multipliers @ program.rows(v)

    def slope(v: np.ndarray) -> np.ndarray:
        jacobian = np.zeros((program.m, program.n))
        np.add.at(jacobian, (program.jacobian_rows, program.jacobian_columns), program.jacobian(v))
        return factor * program.gradient(v) + jacobian.T @ multipliers

    steps = 1e-2 * 0.5 ** np.arange(5)
    first = [abs(lagrangian(x + h * direction) - lagrangian(x) - h * slope(x) @ direction) for h in steps]
    hessian = dense_hessian(program, x, factor, multipliers)
    second = [np.abs(slope(x + h * direction) - slope(x) - h * hessian @ direction).max() for h in steps]
    for remainders in (first, second):
        orders = np.diff(np.log(remainders)) / np.diff(np.log(steps))
        assert orders[-1] == pytest.approx(2.0, abs=0.1)


def test_the_peer_finds_our_minimum(peer: str) -> None:
    made, start = formulation("hypar", 4)
    problem = made.problem_at(start)
    ours = InteriorPoint(Limits(), last_barrier=1e-9).solve(problem, start)
    theirs = make_solver(peer, Limits(max_steps=default_steps(peer))).solve(problem, start)
    assert ours.status is theirs.status is Status.CONVERGED
    assert max(problem.violations(theirs.points).values()) <= 1e-11
    assert problem.objective(theirs.points) == pytest.approx(problem.objective(ours.points), rel=1e-6)
    np.testing.assert_allclose(theirs.points, ours.points, atol=1e-3)


def test_the_peer_renews_the_model_of_the_target(peer: str) -> None:
    made, start = formulation("peaks", 2)
    solver = make_solver(peer, Limits(max_steps=300))
    frozen = solver.solve(made.problem_at(start), start)
    renewed = solver.solve(made.problem_at(start), start, made.problem_at)
    assert frozen.status is renewed.status is Status.CONVERGED
    assert len(renewed.history) > len(frozen.history)
    at_end = made.problem_at(renewed.points)
    again = solver.solve(at_end, renewed.points)
    assert at_end.objective(again.points) == pytest.approx(at_end.objective(renewed.points), rel=0.02)


def test_the_peer_treats_exact_mode(peer: str) -> None:
    made, start = formulation("paraboloid", 2, exact=True)
    outcome = make_solver(peer, Limits(max_steps=300)).solve(made.problem_at(start), start, made.problem_at)
    assert outcome.status is Status.CONVERGED
    assert max(made.problem_at(outcome.points).violations(outcome.points).values()) <= 1e-9


def test_the_peer_stops_when_it_is_told(peer: str) -> None:
    made, start = formulation("peaks", 2)
    seen: list[Step] = []
    stopped = make_solver(peer, Limits()).solve(
        made.problem_at(start), start, made.problem_at, seen.append, lambda: len(seen) > 3
    )
    assert stopped.status is Status.INTERRUPTED and len(stopped.history) == len(seen) == 4
    problem = made.problem_at(start)
    assert make_solver(peer, Limits(max_steps=2)).solve(problem, start).status is Status.STEP_LIMIT
    assert make_solver(peer, Limits(max_seconds=0.0)).solve(problem, start).status is Status.TIME_LIMIT


def test_what_a_callback_raises_comes_through_the_peer(peer: str) -> None:
    made, start = formulation("hypar", 2)
    count = 0

    def interrupted(step: Step) -> None:
        nonlocal count
        count += 1
        if count > 2:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        make_solver(peer, Limits()).solve(made.problem_at(start), start, None, interrupted)


@pytest.mark.parametrize("name", PEERS)
def test_a_missing_library_is_named_with_its_remedy(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(optional, "LIBRARIES", {name: "a_library_that_nobody_has"})
    made, start = formulation("hypar", 1)
    with pytest.raises(ParameterError, match=rf"--solver {name}: expected .* install the extra kirisurf\[peers\]"):
        make_solver(name, Limits()).solve(made.problem_at(start), start)


@pytest.mark.parametrize("name", PEERS)
def test_the_command_line_ends_with_code_2_without_the_library(
    name: str, monkeypatch: pytest.MonkeyPatch, tmp_path, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(optional, "LIBRARIES", {name: "a_library_that_nobody_has"})
    code = main(["fit", "hypar", "--cells", "1x1", "--solver", name, "-o", str(tmp_path / "run"), "--no-pictures"])
    said = capsys.readouterr().err
    assert code == 2 and "kirisurf[peers]" in said and "Traceback" not in said
    assert not (tmp_path / "run" / "result.json").exists()


@pytest.mark.parametrize("name", SOLVERS)
def test_every_solver_has_a_name_and_speaks_the_protocol(name: str) -> None:
    assert isinstance(make_solver(name, Limits()), Solver)
