"""The deployment of a design: paths for several lambda, what each means, and where the meaning changes."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from kirisurf.arrays import checked
from kirisurf.deployment.branch import Branch, jump_branches
from kirisurf.deployment.drive import checked_trajectory, driven_vertices, usual_trajectory
from kirisurf.deployment.energy import Energy, checked_torsion
from kirisurf.deployment.following import follow_free_planar, follow_held, follow_rigid, follow_supported
from kirisurf.deployment.guide import Guide
from kirisurf.deployment.kinematics import n_mechanisms
from kirisurf.deployment.loading import mean_opening
from kirisurf.deployment.path import Path, PathStatus, Progress, ShouldStop
from kirisurf.deployment.springs import energy_of
from kirisurf.deployment.transition import LEAST_TORSION, RIGID_TORSION, transition_torsion
from kirisurf.deployment.verdict import ADMISSIBLE, Kind, Verdict, judge
from kirisurf.errors import ParameterError, UnusableError
from kirisurf.one_thread import on_one_thread
from kirisurf.runs import Run
from kirisurf.tessellation import Tessellation

TORSIONS = (0.0, 1e-4, 1e-3)
"""Values of lambda where none are asked for: ligaments of no width, and of about 4 and 14 % of a square tile."""

STEPS = 50
CLOSED = 1e-6
"""Mean opening in radians up to which a sheet has nothing to open into."""

PLANAR = 1e-9
"""Height over width of a deployed sheet up to which it is planar."""


@dataclass(frozen=True, eq=False)
class Deployment:
    """How a sheet gets from flat to deployed.

    Attributes
    ----------
    energy : Energy
        Without torsion.
    guide : Guide
    paths : tuple of Path
        One for every lambda that was asked for.
    still : Path
        The free path without torsion: whether rigid tiles lead to the shape, and if not, what strain it takes.
    verdicts : tuple of Verdict
        One for every path.
    branches : tuple of tuple of Branch
        For every path the equilibria at its jumps, on from the state before and back from the one behind.
    mechanisms : (flat, deployed)
        Motions of first order that strain no tile, at both ends.
    transition : float or None
        lambda above which the sheet no longer rests open by itself: 0 where it never does, infinity where it always
        does; None where neither was seen, or it was stopped.
    trajectory : str
        How vertices were moved, if any.
    """

    energy: Energy
    guide: Guide
    paths: tuple[Path, ...]
    still: Path
    verdicts: tuple[Verdict, ...]
    branches: tuple[tuple[Branch, ...], ...]
    mechanisms: tuple[int, int]
    transition: float | None
    trajectory: str

    @property
    def sentence(self) -> str:
        """The verdict for the first lambda."""
        return self.verdicts[0].sentence

    @property
    def is_complete(self) -> bool:
        """Was every path followed to its end, and judged?"""
        return all(verdict.kind is not Kind.UNKNOWN for verdict in self.verdicts)


@on_one_thread
def deploy(
    tessellation: Tessellation,
    contracted: ArrayLike,
    deployed: ArrayLike,
    *,
    torsion: float | Sequence[Any] | np.ndarray = TORSIONS,
    steps: int = STEPS,
    drive: str | Sequence[Any] | np.ndarray = "free",
    trajectory: str | None = None,
    dimension: int | None = None,
    contact: bool = True,
    admissible: float = ADMISSIBLE,
    should_stop: ShouldStop | None = None,
    progress: Progress | None = None,
) -> Deployment:
    """Follow a sheet from flat to deployed.

    Parameters
    ----------
    tessellation : Tessellation
    contracted : (n, 2)
    deployed : (n, 2) or (n, 3)
    torsion : float or sequence of float
        Values of lambda, see :class:`kirisurf.deployment.energy.Energy`.
    steps : int
        States after the flat one, evenly along the way.
    drive : str or sequence of int
        free: a load opens the slits and moves no vertex (in space soft supports keep the sheet near the path that
        rigid tiles take); rim, corners: these vertices are moved; or numbers of vertices.
    trajectory : str
        How vertices are moved: turning with their tiles (in the plane, by default), as rigid tiles have them (in
        space, by default), or along straight lines, as in the paper.
    dimension : int, optional
        2 or 3; by default 2 where the deployed sheet is planar.
    contact : bool
        Keep the sides of slits from overlapping, in the plane; False for the energy of the paper.
    admissible : float
        Strain up to which tiles may be strained on the way, for the verdict.
    should_stop : callable, optional
        Asked before every state: True ends the paths, and what was found is returned.
    progress : callable, optional
        Told the number of the state and of all states, over all paths.

    Raises
    ------
    ParameterError
        Where lambda is negative, or a drive, trajectory, dimension or number of steps is not one.
    UnusableError
        Where points are missing or not finite, or tiles differ in shape between the two states.

    Examples
    --------
    >>> from kirisurf.pattern import quad_pattern
    >>> squares = quad_pattern(2, 2, 0.6)
    >>> found = deploy(squares, squares.contracted, squares.deployed, torsion=0.0, steps=10)
    >>> found.verdicts[0].kind.value, found.mechanisms[1]
    ('deploys freely', 1)
    """
    values = _torsions(torsion)
    if isinstance(steps, bool) or not isinstance(steps, (int, np.integer)) or not 2 <= steps <= 100_000:
        raise ParameterError(f"steps: expected a whole number from 2 to 100000, got {steps!r}")
    if not (np.isfinite(admissible) and admissible >= 0):
        raise ParameterError(f"admissible: expected a number of at least 0, got {admissible}")
    held = driven_vertices(tessellation, drive)
    name = drive if isinstance(drive, str) else "vertices"
    flat = checked(contracted, "contracted", (tessellation.n_vertices, 2))
    points = _in_dimension(deployed, tessellation.n_vertices, dimension)
    trajectory = usual_trajectory(points.shape[1]) if trajectory is None else checked_trajectory(trajectory)
    energy = energy_of(tessellation, flat, 0.0, points.shape[1], contact)
    if not len(energy.hinges.stencil):
        raise UnusableError("tessellation: expected slits, got a sheet without: it has nothing to open")
    guide = Guide(tessellation, flat, points)
    if not mean_opening(energy, guide.deployed) > CLOSED:
        raise UnusableError("deployed: expected a sheet whose slits are open, got one that is closed")
    fractions = np.linspace(0.0, 1.0, steps + 1)
    count = steps + 1
    total = count * (1 + sum(1 for value in values if value > 0 or name != "free"))
    done = 0

    def told(k: int, _: int) -> None:
        if progress is not None:
            progress(done + k, total)

    free = follow_free_planar if energy.dimension == 2 else follow_rigid
    still = free(energy, guide, fractions, should_stop, told)
    done += count
    paths = []
    along = still.fractions if trajectory == "rigid" else fractions
    places = still.points if trajectory == "rigid" else guide.places(fractions, trajectory == "straight")
    for value in values:
        stiff = energy.with_torsion(value)
        if name != "free":
            path = follow_held(stiff, guide, held, along, places, should_stop, told, name)
        elif value == 0:
            paths.append(still)
            continue
        elif energy.dimension == 2:
            path = follow_free_planar(stiff, guide, fractions, should_stop, told)
        else:
            path = follow_supported(stiff, guide, still, should_stop, told)
        done += count
        # what follows a path that was cut short is no longer than it
        is_cut = still.status is PathStatus.INTERRUPTED
        paths.append(replace(path, status=PathStatus.INTERRUPTED) if is_cut else path)
    mechanisms = n_mechanisms(energy, guide.flat), n_mechanisms(energy, guide.deployed)
    stiffened = [energy.with_torsion(value) for value in values]
    branches = [
        jump_branches(stiff, guide, path, should_stop=should_stop) for stiff, path in zip(stiffened, paths, strict=True)
    ]
    verdicts = tuple(
        judge(stiff, guide, path, still, mechanisms[1], admissible, should_stop, arms)
        for stiff, path, arms in zip(stiffened, paths, branches, strict=True)
    )
    transition = None
    if not any(verdict.kind is Kind.UNKNOWN for verdict in verdicts):
        least = RIGID_TORSION if verdicts[0].rigid else LEAST_TORSION
        transition = transition_torsion(energy, guide, least, should_stop=should_stop)
    return Deployment(energy, guide, tuple(paths), still, verdicts, tuple(branches), mechanisms, transition, trajectory)


def deploy_run(run: Run, **options: object) -> Deployment:
    """Follow the sheet of a run folder; options are those of `deploy`.

    Raises
    ------
    UnusableError
        Where the run is not certified: its two ends are then no states of one sheet.
    """
    if run.result.get("certified") is not True:
        raise UnusableError(
            f"{run.folder}: expected a certified run, got one that is not ({run.result['status']}): "
            "its flat and its deployed state are not states of one sheet"
        )
    return deploy(run.tessellation, run.contracted, run.deployed, **options)  # type: ignore[arg-type]


def _torsions(torsion: float | Sequence[Any] | np.ndarray) -> list[float]:
    try:
        values = np.atleast_1d(np.asarray(torsion, float))
    except (TypeError, ValueError):
        raise ParameterError(f"lambda: expected a number or several, got {torsion!r}") from None
    if values.ndim != 1 or not len(values):
        raise ParameterError(f"lambda: expected a number or several, got an array of shape {values.shape}")
    return [checked_torsion(value) for value in values.tolist()]


def _in_dimension(given: ArrayLike, n: int, dimension: int | None) -> np.ndarray:
    if dimension not in (None, 2, 3):
        raise ParameterError(f"dimension: expected 2 or 3, got {dimension}")
    try:
        columns = np.shape(given)[-1:]
    except ValueError:
        columns = ()
    deployed = checked(given, "deployed", (n, 2 if columns == (2,) else 3))
    height = np.ptp(deployed[:, 2]) if deployed.shape[1] == 3 and len(deployed) else 0.0
    is_planar = height <= PLANAR * np.ptp(deployed[:, :2], axis=0).max(initial=0.0)
    if dimension == 2 and not is_planar:
        raise ParameterError(f"dimension: expected 3 for a deployed sheet in space, got 2 (it is {height:.3g} high)")
    if dimension == 3 or not is_planar:
        return deployed if deployed.shape[1] == 3 else np.pad(deployed, ((0, 0), (0, 1)))
    return deployed[:, :2]
