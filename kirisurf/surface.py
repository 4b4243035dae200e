"""The target surface: an immutable triangle mesh, in the user's own units and frame."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Protocol, runtime_checkable

import numpy as np
from jaxtyping import Float, Int
from numpy.typing import ArrayLike

from kirisurf.arrays import checked, frozen
from kirisurf.errors import UnusableError


@runtime_checkable
class SmoothSurface(Protocol):
    """A smooth surface that a mesh stands for, given by its closest-point map.

    Sample surfaces carry one (`Surface.smooth`); a mesh from a file has none.
    """

    @property
    def formula(self) -> str:
        """The surface as people write it."""
        ...

    def project(self, points: np.ndarray) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
        """Map points (n, 3) to closest points (n, 3), unit normals (n, 3), shape operators (n, 3, 3).

        The shape operator S is the symmetric 3x3 matrix with S n = 0 and S t = -dn(t) for tangents t,
        so that the surface is x = p + t + 1/2 (t.S t) n + O(|t|^3). Trace S / 2 is the mean curvature
        with respect to n.
        """
        ...


@runtime_checkable
class PlanarOutline(Protocol):
    """The outline of a planar target, see :class:`kirisurf.outlines.Outline`."""

    def moved(self, shift: ArrayLike) -> PlanarOutline:
        """Return a copy moved by a vector (2,)."""
        ...


@dataclass(frozen=True, eq=False)
class Surface:
    """A triangle mesh.

    Attributes
    ----------
    vertices : (v, 3) float64, in the user's units
    faces : (f, 3) int64, counter-clockwise seen from the side of the normals
    name : str
        File name or sample name, for messages and reports.
    smooth : SmoothSurface or None
        The smooth surface that the mesh samples, where it is known.
    outline : PlanarOutline or None
        Of a planar target (z = 0): the curve that the mesh fills.
    """

    vertices: Float[np.ndarray, "v 3"]
    faces: Int[np.ndarray, "f 3"]
    name: str = "surface"
    smooth: SmoothSurface | None = None
    outline: PlanarOutline | None = None

    @classmethod
    def from_arrays(
        cls, vertices: ArrayLike, faces: ArrayLike, name: str = "surface", smooth: SmoothSurface | None = None
    ) -> Surface:
        """Validate arrays (shape, finiteness, index range) and freeze them; topology is judged later."""
        v = checked(vertices, f"vertices of {name}", (None, 3))
        f = checked(faces, f"faces of {name}", (None, 3), np.int64)
        if f.size and (f.min() < 0 or f.max() >= len(v)):
            raise UnusableError(
                f"faces of {name}: expected vertex indices from 0 to {len(v) - 1}, got {int(f.min())} to {int(f.max())}"
            )
        return cls(v, f, name, smooth)

    @cached_property
    def face_areas(self) -> np.ndarray:
        """Areas (f,) in squared units."""
        return 0.5 * np.linalg.norm(self._crosses, axis=1)

    @cached_property
    def face_normals(self) -> np.ndarray:
        """Unit normals (f, 3); zero where a face has no area."""
        length = np.linalg.norm(self._crosses, axis=1, keepdims=True)
        return frozen(self._crosses / np.where(length > 0, length, 1.0))

    @cached_property
    def normals(self) -> np.ndarray:
        """Unit vertex normals (v, 3), weighted by the faces' corner angles (independent of the meshing)."""
        total = np.zeros_like(self.vertices)
        corners = self.vertices[self.faces]
        for k in range(3):
            u = corners[:, (k + 1) % 3] - corners[:, k]
            w = corners[:, (k + 2) % 3] - corners[:, k]
            angle = np.arctan2(np.linalg.norm(np.cross(u, w), axis=1), np.einsum("ij,ij->i", u, w))
            np.add.at(total, self.faces[:, k], angle[:, None] * self.face_normals)
        length = np.linalg.norm(total, axis=1, keepdims=True)
        return frozen(total / np.where(length > 0, length, 1.0))

    @cached_property
    def diagonal(self) -> float:
        """Length of the diagonal of the axis-aligned bounding box."""
        return float(np.linalg.norm(np.ptp(self.vertices, axis=0))) if len(self.vertices) else 0.0

    @cached_property
    def area(self) -> float:
        """Total area in squared units."""
        return float(self.face_areas.sum())

    @cached_property
    def boundary_edges(self) -> np.ndarray:
        """Directed edges (b, 2) that one face has and no other face shares."""
        edges = self.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2)
        key = np.sort(edges, axis=1)
        _, first, count = np.unique(key, axis=0, return_index=True, return_counts=True)
        return frozen(edges[np.sort(first[count == 1])], np.int64)

    @cached_property
    def boundary_loops(self) -> tuple[np.ndarray, ...]:
        """Closed vertex loops of the boundary, longest (in length) first; needs a manifold boundary."""
        following = {int(a): int(b) for a, b in self.boundary_edges}
        loops = []
        while following:
            start = next(iter(following))
            loop, here = [], start
            while here in following:
                loop.append(here)
                here = following.pop(here)
            loops.append(frozen(loop, np.int64))
        lengths = [
            np.linalg.norm(self.vertices[loop] - self.vertices[np.roll(loop, -1)], axis=1).sum() for loop in loops
        ]
        return tuple(loops[k] for k in np.argsort(lengths, kind="stable")[::-1])

    @cached_property
    def _crosses(self) -> np.ndarray:
        a, b, c = (self.vertices[self.faces[:, k]] for k in range(3))
        return np.cross(b - a, c - a)
