"""The public result of a fit: a design, from any kind of target, with its measures, meshes and files.

Computing does not know judging (`analysis`) and showing (`viewers`): a design is where a user of Python meets
all three, so the modules that ask them are imported inside its methods, when they are needed.
"""

from __future__ import annotations

import os
import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float

from kirisurf.field_units import described_file
from kirisurf.loops import Loops
from kirisurf.origin import moved, round_origin
from kirisurf.pipeline import FitResult, fit_surface
from kirisurf.spec import FitSpec
from kirisurf.start import Laid
from kirisurf.states import Step
from kirisurf.status import Status
from kirisurf.surface import Surface
from kirisurf.targets import load, loaded, prepared, resolved, target_name
from kirisurf.tessellation import Tessellation

if TYPE_CHECKING:
    import pyvista

    from analysis.certificate import Certificate
    from analysis.measures import Measures
    from kirisurf.runs import Run, RunFolder


@dataclass(frozen=True, eq=False)
class Design:
    """A kirigami sheet for a target: flat and closed in one state, on the target in the other.

    Attributes
    ----------
    spec : FitSpec
        Every input, resolved.
    result : FitResult
        What the solver and the contraction returned.
    origin : (3,)
        Origin of all points in the frame of the target: zero, unless the target lies more than 100
        diagonals away from it.
    """

    spec: FitSpec
    result: FitResult
    origin: Float[np.ndarray, " 3"]

    @property
    def status(self) -> Status:
        """How the fit ended; its value is the sentence for the user."""
        return self.result.fit.status

    @property
    def surface(self) -> Surface:
        """The target, consistently oriented."""
        return self.result.surface

    @property
    def tessellation(self) -> Tessellation:
        """The pattern's topology."""
        return self.result.tessellation

    @property
    def deployed_points(self) -> Float[np.ndarray, "n 3"]:
        """Deployed vertices (n, 3), in the target's units."""
        return self.result.fit.points

    @property
    def contracted_points(self) -> Float[np.ndarray, "n 2"]:
        """Contracted vertices (n, 2), in the target's units."""
        return self.result.contracted.points

    @property
    def warnings(self) -> tuple[str, ...]:
        """Sentences that need reading."""
        return tuple(self.result.warnings)

    @property
    def notes(self) -> tuple[str, ...]:
        """Sentences on what was chosen automatically, and why."""
        return tuple(self.result.notes)

    @cached_property
    def certificate(self) -> Certificate:
        """Every residual of the design and the verdict on it."""
        from kirisurf.judging import certified

        weld = None if self.status is Status.CONVERGED else self.tessellation.weld
        tiles = self.tessellation.tiles
        prescribed = self.result.boundary, self.result.contracted_boundary
        points, flat = self.deployed_points, self.contracted_points
        return certified(self.spec, points, flat, tiles, self.surface, weld, prescribed, self.tessellation.has_openings)

    @cached_property
    def measures(self) -> Measures:
        """Distances, curvatures and sizes as named fields, tables and numbers."""
        from kirisurf.judging import measured

        return measured(self.tessellation, self.deployed_points, self.contracted_points, self.surface)

    @property
    def deployed(self) -> pyvista.PolyData:
        """The deployed tiles as a pyvista mesh with every field of vertices and tiles."""
        return self._polydata("deployed", self.deployed_points, self.tessellation.tiles, "tile")

    @property
    def contracted(self) -> pyvista.PolyData:
        """The contracted tiles (z = 0) as a pyvista mesh with every field of vertices and tiles."""
        return self._polydata("contracted", self.contracted_points, self.tessellation.tiles, "tile")

    @property
    def holes(self) -> pyvista.PolyData:
        """The deployed holes as a pyvista mesh with every field of vertices and holes."""
        return self._polydata("holes", self.deployed_points, self.tessellation.holes, "hole")

    def fields(self, where: str) -> Mapping[str, np.ndarray]:
        """Return the named fields of vertex, tile or hole."""
        from kirisurf.judging import named_fields

        return named_fields(self.measures, where)

    def save(self, folder: str | os.PathLike[str], *, overwrite: bool = False, pictures: bool = True) -> Run:
        """Write the run folder and return it as it reads back.

        Parameters
        ----------
        folder : path
            New or empty; with `overwrite`, an old run is replaced once the new one is complete.
        overwrite : bool
        pictures : bool
            Draw pictures, where OpenGL works.

        Raises
        ------
        ParameterError
            Where the folder holds something and may not be overwritten.
        OutputError
            Where it cannot be written; it is then as it was.
        """
        from kirisurf.runs import RunFolder

        with RunFolder(folder, overwrite) as opened:
            return self.save_into(opened, pictures=pictures)

    def save_into(
        self,
        folder: RunFolder,
        *,
        pictures: bool = True,
        stage: Callable[[str], None] = lambda name: None,
        provenance: Mapping[str, Any] | None = None,
    ) -> Run:
        """Write into a run folder that is open, and commit it.

        `stage` receives the name of what is done next; `provenance` says what the run was made from
        (:mod:`kirisurf.provenance`).
        """
        from kirisurf.saving import Finished, save

        stage("measuring")
        began = time.perf_counter()
        finished = Finished(self.spec, self.result, self.origin, self.measures)
        seconds = time.perf_counter() - began
        return save(
            finished, folder, pictures=pictures, measure_seconds=seconds, stage=stage, provenance=provenance or {}
        )

    def __repr__(self) -> str:
        return f"Design({self.surface.name!r}, {self.tessellation.n_tiles} tiles, {self.status.name})"

    def _repr_html_(self) -> str:
        return self._card

    @cached_property
    def _card(self) -> str:
        from kirisurf.cards import card

        return card(self)

    def _polydata(self, state: str, points: np.ndarray, loops: Loops, at_cells: str) -> pyvista.PolyData:
        from kirisurf.formats import to_polydata

        vertex, cell = self.fields("vertex"), self.fields(at_cells)
        about = described_file(state, {*vertex, *cell}, self.spec.units, self.origin)
        return to_polydata(points, loops, vertex, cell, about)


def fit(
    target: Any,
    *,
    progress: Callable[[Step], None] | None = None,
    should_stop: Callable[[], bool] | None = None,
    **options: Any,
) -> Design:
    """Design a kirigami sheet for a target.

    Minimizes the distance to the target over all sheets of rigid tiles that close flat
    (`closeness="best"`), or puts every vertex on it (`closeness="exact"`).

    Parameters
    ----------
    target : file, name of a sample surface, (vertices, faces), pyvista mesh, Surface or FitSpec
    progress : callable, optional
        Called with every accepted `Step` of the solver.
    should_stop : callable, optional
        Asked between steps; the best point so far is returned once it is true.
    **options
        The options of `FitSpec`, such as ``cells=(4, 4)`` or ``tiles=300``.

    Raises
    ------
    ParameterError, UnreadableError, UnusableError
        Where an option is wrong, or the target cannot be read or used.

    Examples
    --------
    >>> design = fit("hypar", cells=(2, 2))
    >>> design.status.name, design.tessellation.n_tiles, design.certificate.passed
    ('CONVERGED', 16, True)
    """
    if isinstance(target, FitSpec):
        spec = resolved(target.changed(**options), sized=True)
    elif isinstance(target, (str, os.PathLike)):
        spec = resolved(FitSpec(target=target_name(target), **options), sized=bool({"cells", "tiles"} & set(options)))
    else:
        # In the run folder the target lies beside its spec, so that the spec repeats the run.
        spec = FitSpec(target="./target.vtp", **options)
        return fit_loaded(spec, load(target), progress=progress, should_stop=should_stop)
    began = time.perf_counter()
    spec, surface, notes = loaded(spec)
    return fit_loaded(spec, surface, notes, time.perf_counter() - began, progress, should_stop)


def fit_loaded(
    spec: FitSpec,
    surface: Surface,
    notes: tuple[str, ...] = (),
    load_seconds: float = 0.0,
    progress: Callable[[Step], None] | None = None,
    should_stop: Callable[[], bool] | None = None,
    laid: Laid | None = None,
) -> Design:
    """Design a sheet for a surface that has been read.

    Parameters
    ----------
    spec : FitSpec
        Resolved (:func:`kirisurf.targets.resolved`); its target is only a name here.
    surface : Surface
    notes : tuple of str
        What was done to the surface so far.
    load_seconds : float
        Time that took.
    progress, should_stop : callable, optional
        As for :func:`fit`.
    laid : callable, optional
        As for :func:`kirisurf.pipeline.fit_surface`.
    """
    began = time.perf_counter()
    surface, changes = prepared(surface, spec)
    origin = round_origin(surface)
    seconds = load_seconds + time.perf_counter() - began
    result = fit_surface(moved(surface, origin), spec, progress, should_stop, laid)
    result = replace(result, notes=(*notes, *changes, *result.notes), seconds={"load": seconds, **result.seconds})
    return Design(spec, result, origin)
