"""Curvature of patches and of targets.

Sign: the mean curvature is positive where the surface bends toward its normal (a bowl seen from inside, a
sphere with the normal inward); the Gaussian curvature is positive on a sphere. Patch normals are on the
front side of the tiles.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float

from analysis import polygons
from analysis.bezier import BezierPatch
from analysis.patches import HolePatches
from kirisurf.closest import ClosestPoints

# Strang and Fix: degree 5 on a triangle, 7 points; rows of barycentric coordinates, weights sum to 1
_A, _B = (6 - np.sqrt(15)) / 21, (6 + np.sqrt(15)) / 21
TRIANGLE_POINTS = np.array(
    [[1 / 3] * 3] + [[1 - 2 * w if i == k else w for i in range(3)] for w in (_A, _B) for k in range(3)]
)
TRIANGLE_WEIGHTS = np.array([9 / 40] + [(155 - np.sqrt(15)) / 1200] * 3 + [(155 + np.sqrt(15)) / 1200] * 3)


@dataclass(frozen=True, eq=False)
class FundamentalForms:
    """First and second fundamental form at points of surfaces.

    Attributes
    ----------
    first : (..., 3)
        E = Su.Su, F = Su.Sv, G = Sv.Sv.
    second : (..., 3)
        L = Suu.n, M = Suv.n, N = Svv.n.
    normals : (..., 3)
        n = Su x Sv / |Su x Sv|.
    """

    first: Float[np.ndarray, "*n 3"]
    second: Float[np.ndarray, "*n 3"]
    normals: Float[np.ndarray, "*n 3"]

    @property
    def area(self) -> np.ndarray:
        """sqrt(EG - F^2): area of the surface over area of the parameters."""
        return np.sqrt(np.maximum(self._determinant, 0.0))

    @property
    def gaussian(self) -> np.ndarray:
        """K = (LN - M^2) / (EG - F^2); NaN where the surface has no tangent plane."""
        curved = self.second[..., 0] * self.second[..., 2] - self.second[..., 1] ** 2
        return _quotient(curved, self._determinant)

    @property
    def mean(self) -> np.ndarray:
        """H = (EN - 2FM + GL) / (2 (EG - F^2)); NaN where the surface has no tangent plane."""
        e, f, g = np.moveaxis(self.first, -1, 0)
        ll, m, n = np.moveaxis(self.second, -1, 0)
        return _quotient(e * n - 2 * f * m + g * ll, 2 * self._determinant)

    @property
    def principal(self) -> np.ndarray:
        """Principal curvatures (..., 2), the larger first: H +- sqrt(H^2 - K)."""
        root = np.sqrt(np.maximum(self.mean**2 - self.gaussian, 0.0))
        return np.stack([self.mean + root, self.mean - root], axis=-1)

    @property
    def _determinant(self) -> np.ndarray:
        return self.first[..., 0] * self.first[..., 2] - self.first[..., 1] ** 2


def fundamental_forms(
    patches: BezierPatch, u: Float[np.ndarray, "g q"], v: Float[np.ndarray, "g q"]
) -> FundamentalForms:
    """Return the fundamental forms of every patch at its own q parameters."""
    su, sv = patches.derivative(u, v, 1, 0), patches.derivative(u, v, 0, 1)
    normals = polygons.unit(np.cross(su, sv))
    first = [(su * su).sum(-1), (su * sv).sum(-1), (sv * sv).sum(-1)]
    second = [(patches.derivative(u, v, i, j) * normals).sum(-1) for i, j in ((2, 0), (1, 1), (0, 2))]
    return FundamentalForms(np.stack(first, axis=-1), np.stack(second, axis=-1), normals)


@dataclass(frozen=True, eq=False)
class HoleCurvature:
    """Curvature of the holes' patches.

    Attributes
    ----------
    centers : (g, 3), units
        Patch points at the centers of the holes.
    normals : (g, 3)
        Patch normals there, on the tiles' front side.
    mean, gaussian : (g,), 1/units and 1/units^2
        At the centers.
    principal : (g, 2), 1/units
        At the centers, the larger first.
    mean_averaged, gaussian_averaged : (g,)
        Averages over the holes, weighted by area; NaN where the hole has no area.
    areas : (g,), squared units
        Of the patches within the holes.
    integrated_gaussian, integrated_absolute_gaussian : (g,), radians
        K and |K| integrated over the holes.
    """

    centers: Float[np.ndarray, "g 3"]
    normals: Float[np.ndarray, "g 3"]
    mean: Float[np.ndarray, " g"]
    gaussian: Float[np.ndarray, " g"]
    principal: Float[np.ndarray, "g 2"]
    mean_averaged: Float[np.ndarray, " g"]
    gaussian_averaged: Float[np.ndarray, " g"]
    areas: Float[np.ndarray, " g"]
    integrated_gaussian: Float[np.ndarray, " g"]
    integrated_absolute_gaussian: Float[np.ndarray, " g"]


def hole_curvature(holes: HolePatches) -> HoleCurvature:
    """Return the curvature of every hole's patch, at its center and averaged over the hole.

    The average is the integral over the hole's own polygon in the parameter domain, cut into triangles from
    its center, by a 7-point Gauss rule each; (signed areas, so that any polygon will do).
    """
    patches, (u, v) = holes.patches, holes.centers.T[:, :, None]
    middle = fundamental_forms(patches, u, v)
    g = len(patches)
    total = np.zeros((4, g))
    for which, indices in holes.corners.by_size().values():
        corner = holes.parameters[indices]
        following = np.roll(corner, -1, axis=1)
        center = np.broadcast_to(holes.centers[which, None], corner.shape)
        a, b = corner - center, following - center
        doubled = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
        at = np.einsum("qk,kgsi->gsqi", TRIANGLE_POINTS, np.stack([center, corner, following]))
        weight = 0.5 * doubled[:, :, None] * TRIANGLE_WEIGHTS
        at, weight = at.reshape(len(which), -1, 2), weight.reshape(len(which), -1)
        forms = fundamental_forms(BezierPatch(patches.nets[which]), at[..., 0], at[..., 1])
        element = forms.area * weight
        for row, value in enumerate((1.0, forms.mean, forms.gaussian, np.abs(forms.gaussian))):
            total[row, which] = (value * element).sum(axis=1)
    area, mean, gaussian, magnitude = total
    return HoleCurvature(
        centers=patches.evaluate(u, v)[:, 0],
        normals=middle.normals[:, 0],
        mean=middle.mean[:, 0],
        gaussian=middle.gaussian[:, 0],
        principal=middle.principal[:, 0],
        mean_averaged=_quotient(mean, area),
        gaussian_averaged=_quotient(gaussian, area),
        areas=area,
        integrated_gaussian=gaussian,
        integrated_absolute_gaussian=magnitude,
    )


def target_curvature(
    closest: ClosestPoints, points: Float[np.ndarray, "g 3"], fronts: Float[np.ndarray, "g 3"]
) -> tuple[Float[np.ndarray, " g"], Float[np.ndarray, " g"]]:
    """Return mean and Gaussian curvature of a target at the closest points of `points`.

    From the target's shape operator S (its formula's, where it has one): H = tr S / 2 and K the sum of the
    principal minors. The sign of H is taken for a normal on the side of `fronts`.

    Parameters
    ----------
    closest : ClosestPoints
    points : (g, 3), units
    fronts : (g, 3)
        Normals of the sheet.
    """
    projection = closest.project(points)
    shape = projection.shape_operators
    trace = np.einsum("gii->g", shape)
    side = np.where(np.einsum("gi,gi->g", projection.normals, fronts) < 0, -1.0, 1.0)
    return side * trace / 2, (trace**2 - np.einsum("gij,gji->g", shape, shape)) / 2


def _quotient(numerator: np.ndarray, denominator: np.ndarray) -> np.ndarray:
    """Quotient, NaN where the denominator is not positive."""
    valid = denominator > 0
    return np.where(valid, numerator / np.where(valid, denominator, 1.0), np.nan)
