"""Cutting a part out of a surface, and filling holes that touch each other in a point."""

from __future__ import annotations

import numpy as np
from jaxtyping import Bool

from kirisurf.formats.cleaning import merged_positions
from kirisurf.formats.triangulation import cut_ears
from kirisurf.surface import Surface


def part(surface: Surface, chosen: Bool[np.ndarray, " f"]) -> Surface:
    """Return the chosen faces with the vertices that they use."""
    faces = surface.faces[chosen]
    used = np.bincount(faces.ravel(), minlength=len(surface.vertices)) > 0
    return Surface.from_arrays(surface.vertices[used], (np.cumsum(used) - 1)[faces], surface.name, surface.smooth)


def with_pinched_holes_filled(surface: Surface) -> Surface:
    """Fill holes that touch in a point (which separating the fans made one loop), each by itself."""
    _, position = merged_positions(surface.vertices)
    kept = np.arange(len(surface.vertices))
    patches = []
    for loop in surface.boundary_loops[1:]:
        if len(np.unique(position[loop])) == len(loop):
            continue
        for piece in _simple_parts(loop[::-1], position):  # a patch runs against the faces round it
            ears = cut_ears(surface.vertices[piece]) if len(piece) > 2 else None
            if ears is not None:
                patches.append(piece[ears])
        _, first, again = np.unique(position[loop], return_index=True, return_inverse=True)
        kept[loop] = loop[first][again]
    if not patches:
        return surface
    faces = kept[np.concatenate([surface.faces, *patches])]
    whole = Surface.from_arrays(surface.vertices, faces, surface.name, surface.smooth)
    return part(whole, np.ones(len(faces), bool))


def _simple_parts(loop: np.ndarray, position: np.ndarray) -> list[np.ndarray]:
    """Split a loop where it returns to a position into loops that do not."""
    parts: list[np.ndarray] = []
    path: list[int] = []
    for vertex in loop.tolist():
        places = [position[k] for k in path]
        if position[vertex] in places:
            start = places.index(position[vertex])
            parts.append(np.array(path[start:]))
            path = path[:start]
        path.append(vertex)
    return [*parts, np.array(path)]
