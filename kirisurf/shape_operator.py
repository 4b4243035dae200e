"""Shape operators of a triangle mesh from its vertex normals."""

from __future__ import annotations

import numpy as np
from jaxtyping import Float

from kirisurf.arrays import frozen
from kirisurf.surface import Surface


def vertex_shape_operators(surface: Surface) -> Float[np.ndarray, "v 3 3"]:
    """Return the shape operator S of every vertex: S t = -dn(t), symmetric, S n = 0.

    On every face, S is the symmetric tangential matrix that best explains, in the least-squares sense,
    how the vertex normals change along the three edges; a vertex takes the mean of its faces weighted by
    area (Rusinkiewicz, "Estimating curvatures and their derivatives on triangle meshes", 2004).
    """
    corners = surface.vertices[surface.faces]
    normals = surface.normals[surface.faces]
    edges = np.roll(corners, -1, axis=1) - corners
    turns = np.roll(normals, -1, axis=1) - normals
    first = edges[:, 0] / np.maximum(np.linalg.norm(edges[:, 0], axis=1, keepdims=True), 1e-300)
    second = np.cross(surface.face_normals, first)
    frame = np.stack([first, second], axis=1)
    e = np.einsum("fki,fji->fkj", edges, frame)
    d = -np.einsum("fki,fji->fkj", turns, frame)
    # rows for (a, b, c) of S = [[a, b], [b, c]]: S e = d for three edges
    zero = np.zeros_like(e[:, :, 0])
    rows = np.concatenate(
        [np.stack([e[:, :, 0], e[:, :, 1], zero], axis=2), np.stack([zero, e[:, :, 0], e[:, :, 1]], axis=2)], axis=1
    )
    right = np.concatenate([d[:, :, 0], d[:, :, 1]], axis=1)
    normal = np.einsum("fri,frj->fij", rows, rows)
    scale = np.maximum(np.trace(normal, axis1=1, axis2=2), 1e-300)
    normal += 1e-12 * scale[:, None, None] * np.eye(3)
    a, b, c = np.linalg.solve(normal, np.einsum("fri,fr->fi", rows, right)[:, :, None])[:, :, 0].T
    planar = np.stack([np.stack([a, b], axis=1), np.stack([b, c], axis=1)], axis=1)
    shape = np.einsum("fai,fab,fbj->fij", frame, planar, frame)
    total = np.zeros((len(surface.vertices), 3, 3))
    weight = np.zeros(len(surface.vertices))
    for k in range(3):
        np.add.at(total, surface.faces[:, k], surface.face_areas[:, None, None] * shape)
        np.add.at(weight, surface.faces[:, k], surface.face_areas)
    total /= np.maximum(weight, 1e-300)[:, None, None]
    tangent = np.eye(3) - surface.normals[:, :, None] * surface.normals[:, None, :]
    return frozen(tangent @ total @ tangent)
