"""Distances between a sheet and its target, both ways."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from analysis import polygons
from analysis.sheet import hole_fans
from kirisurf.closest import ClosestPoints
from kirisurf.gate import flat_faces
from kirisurf.surface import Surface
from kirisurf.tessellation import Tessellation

N_SAMPLES = 20_000
"""Samples of the target for the reach."""


def root_mean_square(values: Float[np.ndarray, " n"]) -> float:
    """Return sqrt(mean(values^2))."""
    return float(np.sqrt(np.mean(np.square(values))))


def signed_distances(points: Float[np.ndarray, "n 3"], closest: ClosestPoints) -> Float[np.ndarray, " n"]:
    """Return the distance of points to the target's triangles, positive on the side of its normals, units."""
    surface = closest.surface
    faces, weights = closest.locate(points)
    corners = surface.faces[faces]
    foot = np.einsum("nk,nki->ni", weights, surface.vertices[corners])
    normal = np.einsum("nk,nki->ni", weights, surface.normals[corners])
    side = np.where(np.einsum("ni,ni->n", points - foot, normal) < 0, -1.0, 1.0)
    return side * closest.distances(points)


def reach(
    points: Float[np.ndarray, "n 3"], tessellation: Tessellation, target: Surface, n_samples: int = N_SAMPLES
) -> Float[np.ndarray, " m"]:
    """Return the distances of area-uniform samples of the target to the sheet, units.

    The sheet is its tiles and the patches that fill its closed holes: triangles from a hole's center to its
    sides. Notches of the rim are open.
    """
    return distances_to_sheet(sample_uniformly(target, n_samples), points, tessellation)


def distances_to_sheet(
    samples: Float[np.ndarray, "m 3"], points: Float[np.ndarray, "n 3"], tessellation: Tessellation
) -> Float[np.ndarray, " m"]:
    """Return the distances of points of space to the sheet (tiles and hole patches), infinite to one without area."""
    tiles = polygons.triangles(points, tessellation.tiles)[0]
    every, fans = hole_fans(points, tessellation.holes)
    faces = np.concatenate([tiles, fans])
    # a closed hole's patch has no area, and adds nothing to the sheet
    faces = faces[~flat_faces(every, faces)]
    if not len(faces):
        return np.full(len(samples), np.inf)
    used, compact = np.unique(faces, return_inverse=True)
    sheet = Surface.from_arrays(every[used], compact.reshape(-1, 3), "the deployed sheet")
    return ClosestPoints(sheet).distances(samples)


def sample_uniformly(surface: Surface, n: int) -> Float[np.ndarray, "n 3"]:
    """Return n points on a surface, spread evenly by area, the same for the same surface.

    Faces are drawn at equal steps of the cumulative area; within the faces the points follow the additive
    recurrence of the plastic number (a low-discrepancy sequence).
    """
    cumulative = np.cumsum(surface.face_areas)
    face = np.searchsorted(cumulative, (np.arange(n) + 0.5) / n * cumulative[-1])
    face = np.minimum(face, len(cumulative) - 1)
    plastic = 1.324717957244746
    s, t = (np.mod(0.5 + np.arange(1, n + 1) / plastic**k, 1.0)[:, None] for k in (1, 2))
    folded = s + t > 1
    s, t = np.where(folded, 1 - s, s), np.where(folded, 1 - t, t)
    a, b, c = (surface.vertices[surface.faces[face, k]] for k in range(3))
    return a + s * (b - a) + t * (c - a)
