"""Designs of published configurations and figures, each with the numbers that a table shows of it."""

from __future__ import annotations

import multiprocessing
import time
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor, as_completed
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from kirisurf.design import Design, fit_loaded
from kirisurf.errors import KirisurfError
from kirisurf.loops import Loops
from kirisurf.outlines import Outline
from kirisurf.published import Configuration
from kirisurf.spec import FitSpec
from kirisurf.status import Status
from kirisurf.targets import loaded

RIGID = ("length", "angle", "planarity", "isometry")
CLOSED = ("closure", "loop")
TOLERANCE = 1e-9
"""Largest row of a reproduced design."""

SMALLEST_EDGE = 0.05
"""Smallest tile edge of a reproduced design, over the median."""

OUTLINE_PARTS = 600
"""Segments along the diagonal by which an outline is drawn."""

_ALIKE = 1e-9  # radians: tiles that all turn alike are of one kind


@dataclass(frozen=True)
class Numbers:
    """What a table shows of one design; lengths over the median deployed tile edge, None where there is nothing.

    Attributes
    ----------
    certified : bool
    rigid : float
        Largest of the rows `RIGID`.
    isometry : float
    closure : float
        Largest of the rows `CLOSED`.
    boundary, contracted_boundary : float or None
        Distance of the outer vertices to the outlines that they follow, deployed and contracted.
    smallest_edge : float
    distance_rms, distance_max : float or None
        Of the deployed vertices to a curved target.
    failures : tuple of str
        The sentences of the certificate.
    """

    certified: bool
    rigid: float
    isometry: float
    closure: float
    boundary: float | None
    contracted_boundary: float | None
    smallest_edge: float
    distance_rms: float | None
    distance_max: float | None
    failures: tuple[str, ...] = ()

    @classmethod
    def of(
        cls, rows: Mapping[str, float | int | None], failures: Sequence[str], has_distance: bool, certified: bool
    ) -> Numbers:
        """Return the numbers of a certificate; a rigid row that could not be checked is infinite."""

        def worst(names: Sequence[str], missing: float) -> float:
            values = [rows.get(name) for name in names]
            return max(missing if value is None else float(value) for value in values)

        def one(name: str, shown: bool = True) -> float | None:
            value = rows.get(name)
            return None if value is None or not shown else float(value)

        return cls(
            certified,
            # a sheet of triangles or hexagons may have no point with tiles all round, or no opening
            worst(RIGID, 0.0),
            worst(("isometry",), np.inf),
            worst(CLOSED, 0.0),
            one("boundary"),
            one("contracted_boundary"),
            worst(("min_edge",), 0.0),
            one("distance_rms", has_distance),
            one("distance_max", has_distance),
            tuple(failures),
        )

    @property
    def largest(self) -> float:
        """The largest row of those that have to vanish."""
        return max(self.rigid, self.closure, self.boundary or 0.0, self.contracted_boundary or 0.0)


@dataclass(frozen=True, eq=False)
class Shape:
    """Both states of a design, for files and pictures.

    Attributes
    ----------
    tiles : Loops
    deployed : (n, 3)
    contracted : (n, 2)
    outline : (m, 2) or None
        Of a planar target.
    tones : (t,)
        1 for the tiles that turn clockwise from contracted to deployed, relative to the others; 0 for those.
    """

    tiles: Loops
    deployed: Float[np.ndarray, "n 3"]
    contracted: Float[np.ndarray, "n 2"]
    outline: Float[np.ndarray, "m 2"] | None
    tones: np.ndarray

    @classmethod
    def of(cls, design: Design) -> Shape:
        """Return the shape of a design."""
        outline = design.surface.outline
        curve = outline.polyline(outline.diagonal / OUTLINE_PARTS) if isinstance(outline, Outline) else None
        tiles = design.tessellation.tiles
        regular = design.tessellation.contracted, design.tessellation.deployed
        turns = np.array([_turn(regular[0][tile], regular[1][tile]) for tile in tiles])
        # not the median: of a trimmed sheet more tiles may turn one way than the other
        tones = (turns < 0.5 * (turns.min() + turns.max()) - _ALIKE).astype(np.int64)
        return cls(tiles, design.deployed_points, design.contracted_points, curve, tones)


@dataclass(frozen=True, eq=False)
class Reproduced:
    """A configuration that was run.

    Attributes
    ----------
    name : str
    status : str
        Name of the status of the fit; or FAILED, with the reason, where there is no design.
    tiles : int
    seconds : float
    numbers : Numbers or None
    measures : mapping of str to float
    shape : Shape or None
    reason : str
    """

    name: str
    status: str
    tiles: int
    seconds: float
    numbers: Numbers | None
    measures: Mapping[str, float]
    shape: Shape | None
    reason: str = ""

    @property
    def shortcomings(self) -> tuple[str, ...]:
        """Return why it is not reproduced; empty where it is."""
        if self.numbers is None:
            return (self.reason,)
        found = list(self.numbers.failures)
        if self.status != Status.CONVERGED.name:
            found.insert(0, Status[self.status].value)
        if self.numbers.largest > TOLERANCE and not self.numbers.failures:
            found.append(f"rows: expected at most {TOLERANCE:g}, got {self.numbers.largest:.3g}")
        if self.numbers.smallest_edge < SMALLEST_EDGE:
            found.append(f"smallest edge: expected at least {SMALLEST_EDGE:g}, got {self.numbers.smallest_edge:.3g}")
        return tuple(found)


@dataclass(frozen=True)
class Wanted:
    """A design to make: its name, and its spec."""

    name: str
    spec: FitSpec

    @classmethod
    def of(cls, configuration: Configuration) -> Wanted:
        """Return what a published configuration asks for."""
        return cls(configuration.name, configuration.spec)


def reproduced(wanted: Wanted, should_stop: Callable[[], bool] | None = None) -> tuple[Reproduced, Design | None]:
    """Make a design; one that is impossible is told, not raised."""
    began = time.perf_counter()
    try:
        spec, surface, notes = loaded(wanted.spec)
        design = fit_loaded(spec, surface, notes, should_stop=should_stop)
        certificate = design.certificate
    except KirisurfError as problem:
        seconds = time.perf_counter() - began
        return Reproduced(wanted.name, "FAILED", 0, seconds, None, {}, None, str(problem)), None
    seconds = time.perf_counter() - began
    curved = not isinstance(design.surface.outline, Outline)
    return Reproduced(
        wanted.name,
        design.status.name,
        design.tessellation.n_tiles,
        seconds,
        Numbers.of(certificate.rows, certificate.failures, curved, certificate.passed),
        dict(design.measures.numbers),
        Shape.of(design),
    ), design


def all_reproduced(wanted: Sequence[Wanted], jobs: int = 1) -> Iterator[Reproduced]:
    """Make designs, several at a time, and return each as it is finished.

    Parameters
    ----------
    wanted : sequence of Wanted
    jobs : int
        Processes; with one, all is done here.
    """
    if jobs == 1 or len(wanted) < 2:
        for each in wanted:
            yield reproduced(each)[0]
        return
    # spawned: a forked child would inherit the locks of threads that it does not have
    pool = ProcessPoolExecutor(min(jobs, len(wanted)), multiprocessing.get_context("spawn"))
    try:
        # the largest first, so that no process is left with one of them at the end
        order = sorted(wanted, key=lambda each: -_size(each.spec))
        for done in as_completed([pool.submit(_alone, each) for each in order]):
            yield done.result()
    finally:
        pool.shutdown(cancel_futures=True)


def exponent(x: Sequence[int | float], y: Sequence[int | float]) -> float:
    """Return the slope of the straight line nearest to (log x, log y), by least squares.

    Examples
    --------
    >>> round(exponent([1, 4, 16], [3, 1.5, 0.75]), 12)
    -0.5
    """
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])


def _alone(wanted: Wanted) -> Reproduced:
    return reproduced(wanted)[0]


def _size(spec: FitSpec) -> int:
    return spec.cells[0] * spec.cells[1] if spec.cells is not None else spec.tiles or 0


def _turn(closed: np.ndarray, opened: np.ndarray) -> float:
    """Angle by which a tile turns from the one state to the other, in (-pi, pi]."""
    a, b = ((p - p.mean(axis=0)) @ (1, 1j) for p in (closed, opened))
    return float(np.angle(np.vdot(a, b)))
