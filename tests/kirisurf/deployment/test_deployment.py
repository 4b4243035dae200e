"""The deployment of a design, as users ask for it."""

from __future__ import annotations

from functools import cache
from pathlib import Path as Folder

import numpy as np
import pytest

from kirisurf.deployment import Deployment, Kind, PathStatus, deploy, deploy_run
from kirisurf.deployment.drive import driven_vertices
from kirisurf.deployment.following import follow_held
from kirisurf.deployment.verdict import judge
from kirisurf.errors import ParameterError, UnusableError
from kirisurf.runs import Run
from kirisurf.spec import FitSpec
from tests.kirisurf.deployment.patterns import circle, hypar, squares


def test_squares_deploy_freely_and_spring_back() -> None:
    tessellation = squares()
    found = deploy(tessellation, tessellation.contracted, tessellation.deployed, torsion=(0.0, 1e-3), steps=10)
    assert [v.kind for v in found.verdicts] == [Kind.FREE, Kind.SPRINGS_BACK]
    assert found.sentence.startswith("Deploys freely: rigid tiles lead from flat to shape in 11 states")
    assert "1 mechanism." in found.sentence
    assert found.verdicts[0].rigid and found.verdicts[1].rigid
    assert found.transition == 0


@cache
def snapping() -> Deployment:
    return deploy(*circle(), torsion=(0.0, 1e-3), steps=20)


@pytest.mark.slow
def test_the_square_that_becomes_a_circle_snaps() -> None:
    found = snapping()
    assert [v.kind for v in found.verdicts] == [Kind.BISTABLE, Kind.SPRINGS_BACK]
    assert found.verdicts[0].barrier is not None and found.verdicts[0].barrier > 1e-4
    assert found.verdicts[1].barrier is None
    assert found.sentence.startswith("Snaps over a barrier of ")
    assert found.transition and 0.0 < found.transition < 1e-3
    assert found.mechanisms == (0, 0)


def test_more_strain_than_is_admissible_is_named_first() -> None:
    found = snapping()
    strained = judge(found.energy, found.guide, found.paths[0], found.still, 0, admissible=0.01)
    assert strained.kind is Kind.STRAINED
    assert strained.sentence.startswith("Needs ") and "admissible 1.0 %" in strained.sentence


def test_a_planar_sheet_in_space() -> None:
    tessellation = squares(2, 2)
    flat = deploy(tessellation, tessellation.contracted, tessellation.deployed, torsion=0.0, steps=5, dimension=3)
    assert flat.paths[0].points.shape[2] == 3
    assert flat.verdicts[0].kind is Kind.FREE


@pytest.mark.slow
def test_the_whole_of_a_design_in_space() -> None:
    found = deploy(*hypar(), torsion=(0.0, 1e-3), steps=10)
    assert [v.kind for v in found.verdicts] == [Kind.FREE, Kind.SPRINGS_BACK]
    tiles = hypar()[0].n_tiles
    for path in found.paths:
        assert path.points.shape == (11, hypar()[0].n_vertices, 3)
        assert path.tile_strains.shape == (11, tiles)
        np.testing.assert_allclose(path.tile_strains.max(axis=1), path.largest_strains)
        assert path.openings.shape == (11, int(hypar()[0].slit_ends.sum()))
        assert not path.points.flags.writeable


def test_a_moved_rim_costs_at_least_the_barrier() -> None:
    rim = deploy(*circle(), torsion=1e-3, steps=10, drive="rim")
    assert rim.verdicts[0].kind is Kind.SPRINGS_BACK
    assert rim.paths[0].drive == "rim" and rim.still.drive == "free"
    energy, found = snapping().energy, snapping()
    held = driven_vertices(circle()[0], "rim")
    fractions = np.linspace(0, 1, 11)
    path = follow_held(energy, found.guide, held, fractions, found.guide.places(fractions))
    assert path.energies.max() > found.verdicts[0].barriers[0].energy


def test_a_stop_keeps_what_was_found() -> None:
    told: list[int] = []
    found = deploy(
        *circle(), torsion=(0.0, 1e-3), steps=10,
        should_stop=lambda: len(told) >= 15, progress=lambda k, _: told.append(k),
    )  # fmt: skip
    assert told == list(range(1, 16))
    assert not found.is_complete
    assert [len(p.fractions) for p in found.paths] == [11, 4]
    assert found.paths[1].status is PathStatus.INTERRUPTED
    assert found.verdicts[1].kind is Kind.UNKNOWN


@pytest.mark.parametrize(
    ("options", "words"),
    [({"torsion": -1.0}, "lambda"), ({"torsion": ()}, "lambda"), ({"steps": 1}, "steps"), ({"steps": 10**6}, "steps"),
     ({"drive": "wind"}, "drive"), ({"trajectory": "round"}, "trajectory"), ({"dimension": 4}, "dimension")],
)  # fmt: skip
def test_what_cannot_be_asked_is_refused(options: dict[str, object], words: str) -> None:
    tessellation = squares()
    with pytest.raises(ParameterError, match=words):
        deploy(tessellation, tessellation.contracted, tessellation.deployed, **options)  # type: ignore[arg-type]


def test_a_sheet_in_space_is_not_planar() -> None:
    with pytest.raises(ParameterError, match="expected 3 for a deployed sheet in space"):
        deploy(*hypar(), dimension=2)


def test_states_that_do_not_belong_together_are_refused() -> None:
    tessellation = squares()
    with pytest.raises(UnusableError, match="one shape in both"):
        deploy(tessellation, tessellation.contracted, 1.1 * tessellation.deployed)
    with pytest.raises(UnusableError, match="deployed: expected shape"):
        deploy(tessellation, tessellation.contracted, np.zeros((3, 5)))
    broken = np.array(tessellation.deployed)
    broken[0] = np.nan
    with pytest.raises(UnusableError, match="finite"):
        deploy(tessellation, tessellation.contracted, broken)


def test_a_run_without_a_certificate_is_refused() -> None:
    run = Run(Folder("runs/odd"), FitSpec("hypar"), {"certified": False, "status": "STALLED"})
    with pytest.raises(UnusableError, match="expected a certified run, got one that is not \\(STALLED\\)"):
        deploy_run(run)


@pytest.mark.parametrize("stop", [0, 3, 11, 12, 14, 22, 23, 25, 33])
def test_a_stop_anywhere_leaves_whole_states(stop: int) -> None:
    told: list[int] = []
    found = deploy(
        *circle(), torsion=(0.0, 1e-4, 1e-3), steps=10,
        should_stop=lambda: len(told) >= stop, progress=lambda k, _: told.append(k),
    )  # fmt: skip
    assert not found.is_complete and found.transition is None
    assert found.verdicts[-1].kind is Kind.UNKNOWN
    for path in found.paths:
        count = len(path.fractions)
        assert len(path.points) == len(path.residuals) == len(path.openings) == len(path.tile_strains) == count
    assert len(found.still.fractions) == min(stop, 11)


@pytest.mark.parametrize(
    ("options", "error"),
    [({"torsion": "soft"}, ParameterError), ({"torsion": [[0.0, 1.0]]}, ParameterError),
     ({"torsion": 1e300}, ParameterError), ({"drive": [[1], [2, 3]]}, ParameterError),
     ({"admissible": np.nan}, ParameterError), ({"admissible": -1.0}, ParameterError)],
)  # fmt: skip
def test_options_of_no_sense_are_refused(options: dict[str, object], error: type[Exception]) -> None:
    with pytest.raises(error, match="expected"):
        deploy(*circle(), steps=4, **options)  # type: ignore[arg-type]


@pytest.mark.parametrize("deployed", [[[0.0, 1.0], [2.0]], np.zeros((0, 3)), np.zeros((3, 4)), "sheet"])
def test_points_that_are_none_are_refused(deployed: object) -> None:
    tessellation, contracted, _ = circle()
    with pytest.raises(UnusableError, match="deployed: expected"):
        deploy(tessellation, contracted, deployed, steps=4)  # type: ignore[arg-type]


def test_a_sheet_that_does_not_open_is_refused() -> None:
    tessellation = squares(1, 1, 0.0)
    with pytest.raises(UnusableError, match="slits are open"):
        deploy(tessellation, tessellation.contracted, tessellation.contracted, steps=4)
