"""The sphere, seen from inside: closest points and shape operators in closed form."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float


@dataclass(frozen=True, eq=False)
class Sphere:
    """A sphere round the origin whose normals point inward, so that those of its lower half point up.

    Attributes
    ----------
    radius : float
        In the sample's units.
    """

    radius: float = 1.0

    @property
    def formula(self) -> str:
        """The sphere as people write it."""
        return f"x^2 + y^2 + z^2 = {self.radius**2:g}"

    def project(
        self, points: Float[np.ndarray, "n 3"]
    ) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3 3"]]:
        """Return closest points (n, 3), inward unit normals (n, 3) and shape operators (n, 3, 3).

        Every point of the sphere is closest to its center; there the lowest one is returned.
        """
        points = np.asarray(points, dtype=np.float64)
        distance = np.linalg.norm(points, axis=1, keepdims=True)
        outward = np.where(distance > 0, points, [0.0, 0.0, -1.0]) / np.where(distance > 0, distance, 1.0)
        tangential = np.eye(3) - outward[:, :, None] * outward[:, None, :]
        return self.radius * outward, -outward, tangential / self.radius
