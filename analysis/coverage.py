"""How much of the target a sheet covers."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float, Int

from analysis.embedding import DiskEmbedding, is_disk
from kirisurf.closest import ClosestPoints
from kirisurf.tessellation import Tessellation

SAMPLES = 20
"""Pieces into which every side is cut before it is projected."""


@dataclass(frozen=True)
class Coverage:
    """Covered area over the target's area.

    Attributes
    ----------
    filled : float
        Inside the closest-point image of the polyline through the outer vertices: holes and notches count.
    strict : float
        Inside the image of the tiles and the closed holes only.
    """

    filled: float
    strict: float


def measure_coverage(
    points: Float[np.ndarray, "n 3"], tessellation: Tessellation, closest: ClosestPoints
) -> Coverage | None:
    """Return the coverage of a target, or None where the target is no disk.

    Both curves are cut into short pieces, projected on the target, and mapped with it to a disk
    (:class:`analysis.embedding.DiskEmbedding`); the enclosed part of every face is measured there.
    """
    surface = closest.surface
    if not is_disk(surface) or len(tessellation.outline) < 3:
        return None
    embedding = DiskEmbedding(surface)
    outline = tessellation.outline
    around = np.stack([outline, np.roll(outline, -1)], axis=1)
    filled, strict = (
        embedding.enclosed_fraction(_image(points, edges, closest, embedding))
        for edges in (around, rim_edges(tessellation))
    )
    return Coverage(filled, strict)


def rim_edges(tessellation: Tessellation) -> Int[np.ndarray, "m 2"]:
    """Return the directed tile edges (m, 2) that bound tiles and closed holes: the rim with its notches."""
    edges, holes = tessellation.tiles.edges, tessellation.holes.edges
    n = tessellation.n_vertices
    return edges[~np.isin(edges @ np.array([n, 1]), holes @ np.array([1, n]))]


def _image(points: np.ndarray, edges: np.ndarray, closest: ClosestPoints, embedding: DiskEmbedding) -> np.ndarray:
    """Directed segments (m, 2, 2) in the disk of the closest-point image of straight edges."""
    t = np.arange(SAMPLES + 1)[:, None] / SAMPLES
    start, end = points[edges[:, 0]], points[edges[:, 1]]
    # ends are computed once from the vertex itself, so that neighboring pieces join exactly
    samples = start[:, None] + t * (end - start)[:, None]
    samples[:, -1] = end
    placed = embedding.place(*closest.locate(samples.reshape(-1, 3))).reshape(len(edges), SAMPLES + 1, 2)
    return np.stack([placed[:, :-1], placed[:, 1:]], axis=2).reshape(-1, 2, 2)
