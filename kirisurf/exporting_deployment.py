"""A path from flat to deployed as a time series for ParaView: states in equilibrium, with strain and openings."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path as FilePath

import numpy as np
from jaxtyping import Float

from kirisurf.deployment import Deployment, Path
from kirisurf.field_units import described_file
from kirisurf.formats.blocks import write_pvd
from kirisurf.formats.writing import vtp_bytes
from kirisurf.loops import Loops
from kirisurf.runs import Run

STRAIN, OPENING = "tile_strain", "hinge_opening"
IN_EQUILIBRIUM = "on the path from flat to deployed, in equilibrium"


def write_deployment_series(run: Run, deployment: Deployment, path: Path, file: FilePath) -> None:
    """Write the states of a path; time is the fraction of the way, tiles and holes are the parts of a frame.

    Every tile has its `tile_strain`, the largest of its rods' regardless of sign, and every vertex its
    `hinge_opening` in radians, the widest of the slits that end there; NaN where none does.

    Parameters
    ----------
    run : Run
    deployment : Deployment
    path : Path
        One of its paths.
    file : path
        Ends in .pvd; the frames lie in a folder beside it.

    Raises
    ------
    OutputError
        Where a file cannot be written; what was there is untouched.
    """
    write_pvd(file, path.fractions.tolist(), ("tiles", "holes"), _frames(run, deployment, path))


def vertex_openings(deployment: Deployment, openings: Float[np.ndarray, " c"]) -> Float[np.ndarray, " n"]:
    """Return the widest slit (n,) at every vertex, in radians; NaN where no slit ends."""
    result = np.full(deployment.energy.n_vertices, np.nan)
    np.fmax.at(result, deployment.energy.hinges.stencil[:, 0], openings)
    return result


def in_space(points: Float[np.ndarray, "n d"], deployed: Float[np.ndarray, "n 3"]) -> Float[np.ndarray, "n 3"]:
    """Return points as (n, 3): those of a planar path at the height of the deployed sheet."""
    if points.shape[1] == 3:
        return points
    return np.column_stack([points, np.full(len(points), deployed[:, 2].mean())])


def _frames(run: Run, deployment: Deployment, path: Path) -> Iterator[tuple[bytes, bytes]]:
    tessellation = run.tessellation
    for k, fraction in enumerate(path.fractions.tolist()):
        points = in_space(path.points[k], run.deployed)
        widest = vertex_openings(deployment, path.openings[k])
        about = {
            "fraction": np.array([fraction]),
            "lambda": np.array([path.torsion]),
            "energy": path.energies[k : k + 1],
            "residual": path.residuals[k : k + 1],
        }
        yield (
            _encoded(run, points, tessellation.tiles, widest, {STRAIN: path.tile_strains[k]}, about),
            _encoded(run, points, tessellation.holes, widest, {}, about),
        )


def _encoded(
    run: Run,
    points: np.ndarray,
    loops: Loops,
    widest: np.ndarray,
    cells: dict[str, np.ndarray],
    about: dict[str, np.ndarray],
) -> bytes:
    described = described_file(IN_EQUILIBRIUM, [OPENING, *cells], run.spec.units, run.origin)
    return vtp_bytes(points, loops, {OPENING: widest}, cells, {**described, **about})
