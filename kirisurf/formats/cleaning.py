"""From the polygons of a file to a surface: welded, triangulated, without what carries no surface.

Only exact copies of a position are merged, never vertices that are merely near: a tolerance would
close fine slits and glue folds.
"""

from __future__ import annotations

import numpy as np
from jaxtyping import Float, Int

from kirisurf.errors import UnusableError
from kirisurf.formats.flat import without_flat_faces
from kirisurf.formats.polygons import Polygons, counted
from kirisurf.formats.triangulation import triangulated
from kirisurf.gate import FARTHEST, check_native, check_size
from kirisurf.loops import Loops
from kirisurf.surface import Surface
from kirisurf.topology import examine


def surface_of(polygons: Polygons, name: str, is_split: bool) -> tuple[Surface, tuple[str, ...]]:
    """Weld, triangulate and clean.

    Parameters
    ----------
    polygons : Polygons
    name : str
        For messages and for the surface.
    is_split : bool
        True for formats that repeat a vertex for every face (STL) or at seams of texture and normals
        (OBJ, glTF): copies of a position are merged, unless that would close a surface which is one
        sheet as it stands (cut open on purpose, with both sides of the cut in one place). For the
        others the file's own vertices hold, unless merging joins separate pieces.

    Returns
    -------
    surface : Surface
    notes : tuple of str
        Sentences on everything that was changed.

    Raises
    ------
    UnusableError
        Where there is no face, a used coordinate is not finite or out of range, or nothing with an
        area remains.
    """
    notes = list(polygons.notes)
    vertices, loops, dropped = _used(polygons, name)
    notes += dropped
    if not np.isfinite(vertices).all():
        bad = int(np.flatnonzero(~np.isfinite(vertices).all(axis=1))[0])
        raise UnusableError(f"{name}: expected finite coordinates, got {vertices[bad].tolist()}")
    check_size(vertices, name)
    away = float(np.abs(vertices).max() / np.ptp(vertices, axis=0).max())
    if away > 1e6:
        digits = int(np.log10(FARTHEST / away)) + 3
        notes.append(f"The surface lies {away:.0e} times its size from the origin: only about {digits} digits left.")

    first, copies = merged_positions(vertices)
    n_copies = len(vertices) - len(first)
    if not n_copies:
        surface, found = unmerged_surface(vertices, loops, name)
        return surface, tuple(notes + found)
    welded, welded_notes = unmerged_surface(vertices[first], Loops(loops.offsets, copies[loops.indices]), name)
    if is_split and len(vertices) == len(loops.indices):  # every polygon by itself: nothing to keep
        return welded, tuple(notes + welded_notes)
    given, given_notes = unmerged_surface(vertices, loops, name)
    before, after = examine(given), examine(welded)
    if before.is_disk and not after.is_disk and len(before.component_sizes) == 1:
        notes.append(f"{counted(n_copies, 'vertex', 'vertices')} kept apart from another in one place: a cut is there.")
        return given, tuple(notes + given_notes)
    if not is_split and (before.is_disk or len(after.component_sizes) >= len(before.component_sizes)):
        return given, tuple(notes + given_notes)
    notes.append(f"{counted(n_copies, 'vertex', 'vertices')} merged with another in the same place.")
    return welded, tuple(notes + welded_notes)


def merged_positions(vertices: Float[np.ndarray, "n 3"]) -> tuple[Int[np.ndarray, " w"], Int[np.ndarray, " n"]]:
    """Find exact copies: the first vertex of every position in order (w,), and the position of every vertex (n,)."""
    if not len(vertices):
        return np.zeros(0, np.int64), np.zeros(0, np.int64)
    keys = vertices + 0.0  # -0.0 becomes 0.0
    order = np.lexsort(keys.T[::-1])
    new = np.concatenate([[True], (keys[order[1:]] != keys[order[:-1]]).any(axis=1)])
    first_of_group = np.minimum.reduceat(order, np.flatnonzero(new))
    rank = np.empty(len(first_of_group), np.int64)
    rank[np.argsort(first_of_group)] = np.arange(len(first_of_group))
    position = np.empty(len(vertices), np.int64)
    position[order] = rank[np.cumsum(new) - 1]
    return np.sort(first_of_group), position


def _used(polygons: Polygons, name: str) -> tuple[np.ndarray, Loops, list[str]]:
    """Drop polygons of fewer than three corners and vertices that no other polygon uses."""
    vertices, loops, notes = polygons.vertices, polygons.loops, []
    short = loops.sizes < 3
    if short.any() and not short.all():
        notes.append(f"{counted(int(short.sum()), 'face', 'faces')} with fewer than three corners left out.")
        loops = loops.subset(np.flatnonzero(~short))
    if not len(loops) or short.all():
        raise UnusableError(f"{name}: expected a surface, got {len(vertices)} vertices without any face")
    used = np.bincount(loops.indices, minlength=len(vertices)) > 0
    if used.all():
        return vertices, loops, notes
    notes.append(f"{counted(int((~used).sum()), 'vertex', 'vertices')} in no face left out.")
    renumbered = np.cumsum(used) - 1
    return vertices[used], Loops(loops.offsets, renumbered[loops.indices]), notes


def unmerged_surface(vertices: Float[np.ndarray, "n 3"], loops: Loops, name: str) -> tuple[Surface, list[str]]:
    """Triangulate and clean without merging vertices: what :func:`surface_of` does once that is decided."""
    notes = []
    try:
        faces, crossed = triangulated(vertices, _without_repeats(vertices, loops))
    except UnusableError as problem:
        raise UnusableError(f"{name}: {problem}") from None
    if crossed:
        notes.append(f"{counted(crossed, 'polygon', 'polygons')} with crossing sides or no area cut into a plain fan.")
    faces, flat = without_flat_faces(vertices, faces)
    if flat:
        notes.append(f"{counted(flat, 'face', 'faces')} without area removed.")
    _, first = np.unique(np.sort(faces, axis=1), axis=0, return_index=True)
    if len(first) < len(faces):
        notes.append(f"{counted(len(faces) - len(first), 'copy', 'copies')} of faces removed.")
        faces = faces[np.sort(first)]
    if not len(faces):
        raise UnusableError(f"{name}: expected faces with an area, got none")
    used = np.bincount(faces.ravel(), minlength=len(vertices)) > 0
    kept, triangles = check_native(vertices[used], (np.cumsum(used) - 1)[faces], name)
    return Surface(kept, triangles, name), notes


def _without_repeats(vertices: np.ndarray, loops: Loops) -> Loops:
    """Drop corners of polygons with more than three that lie on the corner before them."""
    repeated = (vertices[loops.indices] == vertices[loops.successors]).all(axis=1)
    larger = np.repeat(loops.sizes > 3, loops.sizes)
    if not (repeated & larger).any():
        return loops
    keep = ~(repeated & larger)
    sizes = np.bincount(loops.owners[keep], minlength=len(loops))
    return Loops(np.concatenate([[0], np.cumsum(sizes)]), loops.indices[keep])
