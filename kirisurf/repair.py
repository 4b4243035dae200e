"""Repair, remeshing and decimation on request, by MeshLab's filters in a child process.

pymeshlab is GPL-3, may crash and changes the environment of its process: it is an optional extra and
never imported here. The surface goes over centered and scaled to unit size, so that its place and units
do not matter.
"""

from __future__ import annotations

import importlib.util
import json
import tempfile
from pathlib import Path

import numpy as np
from jaxtyping import Float

from kirisurf.connectivity import separated_fans
from kirisurf.errors import ParameterError, UnusableError
from kirisurf.filling import part, with_pinched_holes_filled
from kirisurf.formats import child
from kirisurf.formats.cleaning import unmerged_surface
from kirisurf.formats.polygons import counted
from kirisurf.gate import check_indices, check_size
from kirisurf.loops import Loops
from kirisurf.surface import Surface
from kirisurf.topology import TopologyReport, examine, face_components, oriented

MEMORY_MB = 8000
SECONDS = 300.0
_WORKER = Path(__file__).with_name("repair_worker.py")
_NEAR = 1e-6
_MOST_FACES = 5_000_000
_LEAST_AREA = 0.7
_LEAST_SHARE = 0.25
"""Share of the area below which the largest piece does not stand for the surface."""


def repaired(
    surface: Surface, *, keep_largest: bool = True, close_holes: bool = True, seconds: int | float = SECONDS
) -> Surface:
    """Return the surface without what keeps a sheet from covering it, as far as that can be mended.

    Copies and flat faces go, vertices within a millionth of the size merge, faces at branching edges are
    removed until two are left, touching points are separated, the largest piece stays, and all boundary
    loops but the longest are filled. Handles and single-sided surfaces are left as they are.

    Parameters
    ----------
    surface : Surface
    keep_largest : bool
        Keep only the piece with the largest area.
    close_holes : bool
        Fill every boundary loop but the longest.
    seconds : float
        Wall-clock limit of each step.

    Raises
    ------
    ParameterError
        Where pymeshlab is not installed.
    UnusableError
        Where nothing remains, or the repair does not survive the surface or ends in time.
    """
    return repaired_with_notes(surface, keep_largest=keep_largest, close_holes=close_holes, seconds=seconds)[0]


def repaired_with_notes(
    surface: Surface, *, keep_largest: bool = True, close_holes: bool = True, seconds: int | float = SECONDS
) -> tuple[Surface, tuple[str, ...]]:
    """Repair as :func:`repaired` does; also return sentences on what was done."""
    notes: list[str] = []
    before = examine(surface)
    filters: list = [
        ["meshing_merge_close_vertices", {"threshold": {"length": _NEAR}}],
        ["meshing_remove_duplicate_faces", {}],
        ["meshing_remove_null_faces", {}],
    ]
    if before.cracks:
        filters.append(["meshing_snap_mismatched_borders", {"edgedistratio": 0.01, "unifyvertices": True}])
        filters.append(["meshing_merge_close_vertices", {"threshold": {"length": _NEAR}}])
    filters += [
        ["meshing_repair_non_manifold_edges", {"method": "Remove Faces"}],
        ["meshing_remove_unreferenced_vertices", {}],
    ]
    cleaned = _filtered(surface, filters, seconds, "repair")
    faces, origins = separated_fans(cleaned.faces, len(cleaned.vertices))
    cleaned = Surface.from_arrays(cleaned.vertices[origins], faces, surface.name, surface.smooth)
    after = examine(cleaned)
    notes += _differences(before, after)
    if keep_largest and len(after.component_sizes) > 1:
        cleaned, share = _largest_piece(cleaned)
        if share < _LEAST_SHARE:
            raise UnusableError(
                f"{surface.name}: expected a piece with most of the area, got {len(after.component_sizes)} pieces of "
                f"which the largest has {share:.0%}: merge their vertices where the surface was made"
            )
        notes.append(f"The largest of {len(after.component_sizes)} pieces was kept ({share:.0%} of the area).")
        after = examine(cleaned)
    cleaned = oriented(cleaned, after)
    is_manifold = not after.nonmanifold_edges and not after.nonmanifold_vertices
    if close_holes and len(after.boundary_sizes) > 1 and is_manifold and after.is_orientable:
        filled = _with_holes_filled(cleaned, seconds)
        n_filled = len(after.boundary_sizes) - len(examine(filled).boundary_sizes)
        notes.append(f"{counted(n_filled, 'hole was', 'holes were')} filled.")
        cleaned = filled
    return cleaned, tuple(notes)


def remeshed(
    surface: Surface,
    target_edge_length: int | float | None = None,
    *,
    n_faces: int | None = None,
    seconds: int | float = SECONDS,
) -> Surface:
    """Return the surface with triangles of even size and shape, on the old surface, its boundary kept.

    Parameters
    ----------
    surface : Surface
    target_edge_length : float, in the surface's units
    n_faces : int
        Instead: about this many faces; the edge length of as many equilateral triangles of the same area.
    seconds : float
        Wall-clock limit.

    Raises
    ------
    ParameterError
        Where not exactly one of length and number is given, it is not positive, it asks for more than
        five million faces, or pymeshlab is not installed.
    UnusableError
        Where remeshing does not survive the surface or end in time.
    """
    if (target_edge_length is None) == (n_faces is None):
        raise ParameterError("expected either an edge length or a number of faces for remeshing, got both or neither")
    given = target_edge_length if n_faces is None else n_faces
    if given is None or not np.isfinite(given) or given <= 0:
        raise ParameterError(f"expected a positive edge length or number of faces for remeshing, got {given}")
    equilateral = np.sqrt(3) / 4
    if target_edge_length is None:
        target_edge_length = float(np.sqrt(surface.area / (equilateral * given)))
    wanted = surface.area / (equilateral * target_edge_length**2)
    if wanted > _MOST_FACES:
        raise ParameterError(f"expected at most {_MOST_FACES} faces after remeshing, got {wanted:.2g}")
    size = _size(surface.vertices)
    parameters = {"targetlen": {"length": target_edge_length / size}, "iterations": 10, "checksurfdist": False}
    found = _filtered(surface, [["meshing_isotropic_explicit_remeshing", parameters]], seconds, "remeshing")
    _check_kept(surface, found, "remeshing")
    return found


def decimated(surface: Surface, n_faces: int, *, seconds: int | float = SECONDS) -> Surface:
    """Return the surface with at most `n_faces` faces, edges collapsed where they matter least, its boundary kept.

    Raises
    ------
    ParameterError
        Where the number is not positive or pymeshlab is not installed.
    UnusableError
        Where decimation does not survive the surface or end in time.
    """
    if n_faces < 1:
        raise ParameterError(f"expected a positive number of faces, got {n_faces}")
    if n_faces >= len(surface.faces):
        return surface
    parameters = {
        "targetfacenum": int(n_faces),
        "preserveboundary": True,
        "boundaryweight": 10.0,
        "preservenormal": True,
        "preservetopology": True,
        "qualitythr": 0.5,
    }
    found = _filtered(surface, [["meshing_decimation_quadric_edge_collapse", parameters]], seconds, "decimation")
    _check_kept(surface, found, "decimation")
    return found


def _filtered(surface: Surface, filters: list, seconds: int | float, what: str) -> Surface:
    """Run the filters; vertices in one place are not merged: they may have been separated on purpose."""
    cleaned, _ = unmerged_surface(*_filtered_arrays(surface, filters, seconds, what), surface.name)
    return Surface(cleaned.vertices, cleaned.faces, surface.name, surface.smooth)


def _filtered_arrays(
    surface: Surface, filters: list, seconds: int | float, what: str
) -> tuple[Float[np.ndarray, "v 3"], Loops]:
    """Run the filters on the surface, scaled to unit size, in a child process."""
    if importlib.util.find_spec("pymeshlab") is None:
        raise ParameterError(
            f"expected pymeshlab for {what}, got a set-up without it: install the extra kirisurf[repair], "
            f"or leave the {what} out"
        )
    name = surface.name
    if not len(surface.faces):
        raise UnusableError(f"{name}: expected faces for {what}, got none")
    check_indices(surface.faces, len(surface.vertices), name)
    check_size(surface.vertices, name)
    middle = (surface.vertices.max(axis=0) + surface.vertices.min(axis=0)) / 2
    size = _size(surface.vertices)
    with tempfile.TemporaryDirectory(prefix="kirisurf-") as folder:
        source, target, steps = Path(folder, "in.npz"), Path(folder, "out.npz"), Path(folder, "filters.json")
        np.savez(source, vertices=(surface.vertices - middle) / size, faces=surface.faces)
        steps.write_text(json.dumps(filters), encoding="utf-8")
        ended = child.run(_WORKER, [str(source), str(target), str(steps)], seconds, MEMORY_MB)
        if ended.death or "error" in ended.answer or not ended.answer:
            reason = ended.death or ended.answer.get("error") or ended.complaint or "no answer"
            raise UnusableError(
                f"{name}: expected {what} to end with a surface, got: {reason}. "
                f"Leave the {what} out, or mend the surface where it was made"
            )
        with np.load(target, allow_pickle=False) as arrays:
            vertices, faces = arrays["vertices"], arrays["faces"]
    if not len(faces):
        raise UnusableError(f"{name}: expected {what} to leave faces, got none")
    loops = Loops(np.arange(0, 3 * len(faces) + 1, 3), faces.astype(np.int64).ravel())
    return vertices * size + middle, loops


def _check_kept(before: Surface, after: Surface, what: str) -> None:
    """Raise UnusableError where new triangles changed the topology or half the area: they stand for another surface."""
    old, new = examine(before), examine(after)
    pieces, loops = len(new.component_sizes), len(new.boundary_sizes)
    if pieces != len(old.component_sizes) or loops != len(old.boundary_sizes):
        raise UnusableError(
            f"{before.name}: expected {what} to keep {len(old.component_sizes)} pieces and {len(old.boundary_sizes)} "
            f"boundary loops, got {pieces} and {loops}: ask for more faces (shorter edges)"
        )
    share = after.area / before.area
    if not _LEAST_AREA < share < 1 / _LEAST_AREA:
        raise UnusableError(
            f"{before.name}: expected {what} to keep the area, got {share:.0%} of it: "
            "ask for more faces (shorter edges), or look for folds and slivers"
        )


def _size(vertices: np.ndarray) -> float:
    return float(np.ptp(vertices, axis=0).max())


def _largest_piece(surface: Surface) -> tuple[Surface, float]:
    largest = face_components(surface) == 0
    return part(surface, largest), float(surface.face_areas[largest].sum() / surface.area)


def _with_holes_filled(surface: Surface, seconds: int | float) -> Surface:
    """Fill all boundary loops but the longest (in length).

    MeshLab chooses holes by their number of edges only, so the outline is closed with a cone for the
    time being: it is no hole then, and the cone goes again with its tip.
    """
    surface = with_pinched_holes_filled(surface)
    if len(surface.boundary_loops) < 2:
        return surface
    outline = surface.boundary_loops[0]
    rim = surface.vertices[outline]
    tip = rim.mean(axis=0) + np.array([0.0, 0.0, 2.0 * surface.diagonal])
    n = len(surface.vertices)
    cone = np.stack([np.roll(outline, -1), outline, np.full(len(outline), n)], axis=1)
    coned = Surface.from_arrays(
        np.vstack([surface.vertices, tip]), np.vstack([surface.faces, cone]), surface.name, surface.smooth
    )
    parameters = {"maxholesize": len(surface.boundary_edges) + 1, "selfintersection": False, "newfaceselected": False}
    filled = _filtered(coned, [["meshing_close_holes", parameters]], seconds, "filling of holes")
    at = int(np.argmin(np.linalg.norm(filled.vertices - tip, axis=1)))
    return part(filled, (filled.faces != at).all(axis=1))


def _differences(before: TopologyReport, after: TopologyReport) -> list[str]:
    notes = []
    if after.n_faces < before.n_faces:
        notes.append(f"{counted(before.n_faces - after.n_faces, 'face was', 'faces were')} removed.")
    if before.nonmanifold_edges and not after.nonmanifold_edges:
        notes.append(f"{counted(before.nonmanifold_edges, 'branching edge was', 'branching edges were')} resolved.")
    if before.nonmanifold_vertices and not after.nonmanifold_vertices:
        notes.append(f"{counted(before.nonmanifold_vertices, 'touching point was', 'touching points were')} separated.")
    return notes
