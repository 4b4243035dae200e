"""The interior-point method against SciPy's solvers, and its honest endings."""

from __future__ import annotations

import numpy as np
import pytest

import sample_surfaces
from kirisurf.constraints.edge import LongEdges
from kirisurf.constraints.length import EqualLengths
from kirisurf.formulation import Formulation, Weights
from kirisurf.objective.proximity import Proximity
from kirisurf.pattern import quad_pattern
from kirisurf.problem import Problem, Term
from kirisurf.scaling import unit_scale
from kirisurf.solvers.choice import make_solver
from kirisurf.solvers.filter import Filter
from kirisurf.solvers.interior_point import InteriorPoint
from kirisurf.solvers.outcome import Limits
from kirisurf.spec import FitSpec
from kirisurf.start import make_start
from kirisurf.states import Step
from kirisurf.status import Status


def formulation(name: str, cells: int, exact: bool = False) -> tuple[Formulation, np.ndarray]:
    surface = sample_surfaces.load(name, resolution=20)
    start = make_start(surface, FitSpec(target=name, cells=(cells, cells)))
    frame, scaled = unit_scale(surface, start.tessellation, start.points)
    points = frame.into(start.points)
    return Formulation(start.tessellation, points, scaled, Weights(), exact=exact), points


@pytest.mark.parametrize("method", ["slsqp", "trust-constr"])
def test_scipy_finds_the_same_minimum(method: str) -> None:
    made, start = formulation("paraboloid", 1 if method == "trust-constr" else 2)
    problem = made.problem_at(start)
    ours = InteriorPoint(Limits(), last_barrier=1e-9).solve(problem, start)
    theirs = make_solver(method, Limits(max_steps=600)).solve(problem, start)
    assert ours.status is Status.CONVERGED
    assert max(problem.violations(theirs.points).values()) < 1e-7
    assert problem.objective(ours.points) == pytest.approx(problem.objective(theirs.points), rel=1e-4)
    np.testing.assert_allclose(ours.points, theirs.points, atol=5e-3)


def test_the_solution_meets_the_optimality_conditions() -> None:
    made, start = formulation("hypar", 3)
    outcome = InteriorPoint(Limits()).solve(made.problem_at(start), start, made.problem_at)
    last = outcome.history[-1]
    assert outcome.status is Status.CONVERGED
    assert max(last.residuals.values()) <= 1e-11 and last.optimality <= 1e-8


def test_the_end_is_superlinear() -> None:
    made, start = formulation("hypar", 4)
    history = InteriorPoint(Limits()).solve(made.problem_at(start), start).history
    worst = np.array([max(step.residuals.values()) for step in history])
    near = np.flatnonzero((worst[:-1] < 1e-3) & (worst[1:] > 1e-14))
    orders = np.log(worst[near + 1]) / np.log(worst[near])
    assert orders.max() > 1.5


def test_exact_mode_puts_every_vertex_on_the_formula() -> None:
    made, start = formulation("paraboloid", 3, exact=True)
    outcome = InteriorPoint(Limits()).solve(made.problem_at(start), start, made.problem_at)
    assert outcome.status is Status.CONVERGED
    assert max(made.problem_at(outcome.points).violations(outcome.points).values()) < 1e-10


def impossible() -> tuple[Problem, np.ndarray]:
    """Rows (difference of squared lengths)^2 + 1 = 0, which no point meets."""
    tessellation = quad_pattern(1, 1, 0.5)
    points = np.column_stack([2 * tessellation.deployed, np.zeros(tessellation.n_vertices)])

    class Apart(EqualLengths):
        name = "contradiction"

        def residual(self, points: np.ndarray) -> np.ndarray:
            return super().residual(points) ** 2 + 1.0

        def jacobian(self, points: np.ndarray) -> np.ndarray:
            return 2 * super().residual(points)[:, :, None] * super().jacobian(points)

        def curvature(self, points: np.ndarray, multipliers: np.ndarray) -> np.ndarray:
            rows, slopes = super().residual(points), super().jacobian(points)[:, 0]
            bend = 2 * rows[:, :, None] * super().curvature(points, np.ones_like(multipliers))
            return multipliers[:, :, None] * (bend + 2 * slopes[:, :, None] * slopes[:, None, :])

    problem = Problem(
        tessellation.n_vertices,
        (Apart(tessellation),),
        (LongEdges(tessellation, 0.1),),
        (Term(1.0, Proximity(points)),),
    )
    return problem, points + 0.05 * np.random.default_rng(0).standard_normal(points.shape)


def test_a_contradiction_is_not_called_converged() -> None:
    problem, start = impossible()
    outcome = InteriorPoint(Limits(max_steps=60)).solve(problem, start)
    assert outcome.status in (Status.INFEASIBLE, Status.STALLED, Status.STEP_LIMIT, Status.NOT_FINITE)
    assert np.isfinite(outcome.points).all()
    assert max(problem.violations(outcome.points).values()) < 1.5


def test_limits_and_interruption_keep_the_best_point() -> None:
    made, start = formulation("peaks", 4)
    seen: list[Step] = []
    stopped = InteriorPoint(Limits()).solve(
        made.problem_at(start), start, made.problem_at, seen.append, lambda: len(seen) > 3
    )
    assert stopped.status is Status.INTERRUPTED and len(stopped.history) == len(seen) == 4
    least = min(max(step.residuals.values()) for step in seen)
    assert InteriorPoint(Limits(max_steps=2)).solve(made.problem_at(start), start).status is Status.STEP_LIMIT
    assert InteriorPoint(Limits(max_seconds=0.0)).solve(made.problem_at(start), start).status is Status.TIME_LIMIT
    assert max(made.problem_at(stopped.points).violations(stopped.points).values()) <= least * (1 + 1e-9)


def test_a_start_that_is_not_finite_ends_honestly() -> None:
    made, start = formulation("hypar", 2)
    collapsed = np.zeros_like(start)
    outcome = InteriorPoint(Limits(max_steps=5)).solve(made.problem_at(start), collapsed)
    assert outcome.status is not Status.CONVERGED


def test_the_same_start_gives_the_same_bytes() -> None:
    made, start = formulation("peaks", 3)
    first, second = (InteriorPoint(Limits()).solve(made.problem_at(start), start, made.problem_at) for _ in range(2))
    assert first.points.tobytes() == second.points.tobytes()


def test_the_filter_forbids_what_is_dominated() -> None:
    filter_ = Filter(10.0)
    assert not filter_.accepts(11.0, -100.0)
    filter_.add(1.0, 5.0)
    assert not filter_.accepts(1.0, 5.0) and not filter_.accepts(2.0, 6.0)
    assert filter_.accepts(0.5, 9.0) and filter_.accepts(2.0, 4.0)
    filter_.add(0.1, 0.1)
    assert not filter_.accepts(0.5, 9.0)
    filter_.clear()
    assert filter_.accepts(2.0, 6.0)
