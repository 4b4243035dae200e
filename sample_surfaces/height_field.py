"""The graph of a height: a smooth surface z = f(x, y) with its exact closest-point map."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from jaxtyping import Float
from scipy.spatial import cKDTree

from sample_surfaces.expression import Expression
from sample_surfaces.jets import Jet

_MAX_STEPS = 80
_MAX_HALVINGS = 40
# A step this small, relative to the surface's size, is inside the quadratic range of Newton's method:
# a few more full steps end at rounding.
_QUADRATIC = 1e-7
_POLISHING = 3
# Within this share of the smallest radius of curvature the start below the point is the only one needed.
_NEAR = 0.2
_STARTS = 4
_SAMPLES = 64


@dataclass(frozen=True, eq=False)
class HeightField:
    """The surface z = f(x, y), extended by its formula beyond the box that the sample covers.

    The closest point to q minimizes D(u, v) = 1/2 |(u, v, f(u, v)) - q|^2 over the two parameters, by
    Newton's method with f's exact derivatives, safeguarded by taking the Hessian's eigenvalues by their
    size and by backtracking. Normals point up (n_z > 0).

    Attributes
    ----------
    formula : str
        The height as people write it.
    height : Expression
    box : (2, 2)
        Lower and upper corner of the part that the sample covers, in its units.
    """

    formula: str
    height: Expression
    box: Float[np.ndarray, "2 2"]

    def points(self, places: Float[np.ndarray, "n 2"]) -> Float[np.ndarray, "n 3"]:
        """Return the points (n, 3) of the surface over places (n, 2) of the plane."""
        return np.column_stack([places, self.height(places[:, 0], places[:, 1]).value])

    def project(
        self, points: Float[np.ndarray, "n 3"]
    ) -> tuple[Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3"], Float[np.ndarray, "n 3 3"]]:
        """Return closest points (n, 3), upward unit normals (n, 3) and shape operators (n, 3, 3).

        Points farther away than a fifth of the smallest radius of curvature are started from several
        places of the box and of a quarter of its size round it, and keep the closest result; where several
        closest points tie, one of them is returned.
        """
        points = np.asarray(points, dtype=np.float64)
        size = self.box[1] - self.box[0]
        below = np.clip(points[:, :2], self.box[0] - size, self.box[1] + size)
        places, parts = self._descended(points, below)
        distances = np.linalg.norm(self._residual(points, places, parts), axis=1)
        far = np.flatnonzero(distances * self._largest_curvature > _NEAR)
        if len(far):
            tree, samples = self._samples
            _, nearest = tree.query(points[far], k=_STARTS)
            again = np.repeat(points[far], _STARTS, axis=0)
            others, other_parts = self._descended(again, samples[nearest.ravel()])
            other = np.linalg.norm(self._residual(again, others, other_parts), axis=1).reshape(-1, _STARTS)
            best = np.arange(len(far)) * _STARTS + other.argmin(axis=1)
            better = other.min(axis=1) < distances[far]
            places[far[better]] = others[best[better]]
            parts[:, far[better]] = other_parts[:, best[better]]
        jet = Jet(parts)
        normals, operators = _normals_and_shape_operators(jet)
        return np.column_stack([places, jet.value]), normals, operators

    @cached_property
    def _size(self) -> float:
        return float(np.linalg.norm(self.box[1] - self.box[0]))

    @cached_property
    def _samples(self) -> tuple[cKDTree, np.ndarray]:
        # A quarter more on each side: the pattern may reach over the rim.
        margin = 0.25 * (self.box[1] - self.box[0])
        low, high = self.box[0] - margin, self.box[1] + margin
        axes = [np.linspace(low[k], high[k], _SAMPLES) for k in range(2)]
        places = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 2)
        return cKDTree(self.points(places)), places

    @cached_property
    def _largest_curvature(self) -> float:
        places = self._samples[1]
        _, operators = _normals_and_shape_operators(self.height(places[:, 0], places[:, 1]))
        return float(np.sqrt(np.einsum("nij,nij->n", operators, operators).max()))

    def _descended(self, points: np.ndarray, start: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
        # Parameters (n, 2) of a local minimum of D reached from the start, and the height's jet (6, n) there.
        places, parts = start.copy(), self.height(start[:, 0], start[:, 1]).parts.copy()
        active = np.arange(len(places))
        left = np.full(len(places), _MAX_STEPS)
        while len(active):
            here, jet = places[active], Jet(parts[:, active])
            residual = self._residual(points[active], here, jet.parts)
            value = 0.5 * (residual**2).sum(axis=1)
            gradient = residual[:, :2] + residual[:, 2:] * jet.gradient.T
            step = _newton_step(jet, residual[:, 2], gradient)
            slope = (gradient * step).sum(axis=1)
            # Also where the decrease that is left drowns in the rounding of D: from there D can judge no step.
            polishing = (np.linalg.norm(step, axis=1) <= _QUADRATIC * self._size) | (-slope <= 1e-13 * value)
            left[active] = np.where(polishing, np.minimum(left[active], _POLISHING), left[active]) - 1
            trial, share = np.arange(len(active)), 1.0
            for _ in range(_MAX_HALVINGS):
                chosen = active[trial]
                there = here[trial] + share * step[trial]
                there_parts = self.height(there[:, 0], there[:, 1]).parts
                decrease = 0.5 * (self._residual(points[chosen], there, there_parts) ** 2).sum(axis=1) - value[trial]
                accepted = polishing[trial] | (decrease <= 1e-4 * share * slope[trial])
                places[chosen[accepted]] = there[accepted]
                parts[:, chosen[accepted]] = there_parts[:, accepted]
                trial, share = trial[~accepted], 0.5 * share
                if not len(trial):
                    break
            left[active[trial]] = 0
            active = active[left[active] > 0]
        return places, parts

    def _residual(self, points: np.ndarray, places: np.ndarray, parts: np.ndarray) -> np.ndarray:
        return np.column_stack([places, parts[0]]) - points


def _newton_step(jet: Jet, rise: np.ndarray, gradient: np.ndarray) -> np.ndarray:
    # Hessian of D, as (h_xx, h_xy, h_yy): I + grad f grad f' + (f - z) hess f.
    dx, dy = jet.gradient
    hessian = np.stack([1 + dx * dx, dx * dy, 1 + dy * dy]) + rise * jet.second
    a, b, c = hessian
    trace, determinant = a + c, a * c - b * b
    # The positive square root of a 2x2 matrix A is (A + sqrt(det A) I) / sqrt(tr A + 2 sqrt(det A)); with A = H^2
    # it is H with its eigenvalues taken by their size, so that the step goes down also where H bends down.
    root = np.abs(determinant)
    span = np.sqrt(np.maximum(trace**2 - 2 * determinant + 2 * root, 1e-300))
    positive = np.stack([a * a + b * b + root, b * trace, b * b + c * c + root]) / span
    definite = (trace > 0) & (determinant > 0)
    a, b, c = np.where(definite, hessian, positive)
    floor = np.where(a * c - b * b < 1e-8 * (a + c) ** 2, 1e-4 * (a + c) + 1e-300, 0.0)
    a, c = a + floor, c + floor
    adjugate = np.stack([b * gradient[:, 1] - c * gradient[:, 0], b * gradient[:, 0] - a * gradient[:, 1]])
    return (adjugate / (a * c - b * b)).T


def _normals_and_shape_operators(jet: Jet) -> tuple[np.ndarray, np.ndarray]:
    # n = (-f_x, -f_y, 1) / w. With P = I - n n', the first two columns E of P read a tangent's (dx, dy),
    # so that the second fundamental form hess f / w in the parameters becomes S = E (hess f / w) E'.
    normals = np.column_stack([-jet.gradient.T, np.ones(len(jet.value))])
    w = np.linalg.norm(normals, axis=1)
    normals /= w[:, None]
    tangents = np.eye(3)[:, :2] - normals[:, :, None] * normals[:, None, :2]
    second = jet.second[[0, 1, 1, 2]].T.reshape(-1, 2, 2) / w[:, None, None]
    operators = tangents @ second @ tangents.transpose(0, 2, 1)
    return normals, 0.5 * (operators + operators.transpose(0, 2, 1))
