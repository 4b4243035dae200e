"""Smooth surfaces: the laws of a closest-point map, for every sample."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial import cKDTree

import sample_surfaces
from sample_surfaces.height_field import HeightField
from sample_surfaces.sphere import Sphere

NAMES = sample_surfaces.names()
HEIGHTS = tuple(name for name in NAMES if name != "sphere")
RNG_SEED = 3


def _near(name: str, share: float, n: int = 400) -> tuple[np.ndarray, float]:
    # Points (n, 3) scattered about the sample by a share of its diagonal, and the diagonal.
    surface = sample_surfaces.load(name)
    rng = np.random.default_rng(RNG_SEED)
    chosen = surface.vertices[rng.integers(0, len(surface.vertices), n)]
    return chosen + share * surface.diagonal * rng.normal(size=(n, 3)), surface.diagonal


@pytest.mark.parametrize("name", HEIGHTS)
def test_height_derivatives_have_taylor_slope_three(name: str):
    """The remainder after the second-order term falls with the third power, or is rounding (quadrics)."""
    smooth = sample_surfaces.load(name).smooth
    assert isinstance(smooth, HeightField)
    rng = np.random.default_rng(RNG_SEED)
    size = smooth.box[1] - smooth.box[0]
    x, y = (smooth.box[0] + rng.random((50, 2)) * size).T
    a, b = rng.normal(size=(50, 2)).T * size.max()
    jet = smooth.height(x, y)
    remainders = []
    for h in (4e-3, 2e-3, 1e-3):
        predicted = np.sum(jet.parts * [a**0, h * a, h * b, (h * a) ** 2 / 2, h * h * a * b, (h * b) ** 2 / 2], axis=0)
        remainders.append(np.linalg.norm(smooth.height(x + h * a, y + h * b).value - predicted))
    slope = np.log2(remainders[-2] / remainders[-1]) if remainders[-1] > 0 else np.inf
    assert slope > 2.9 or remainders[0] < 1e-13 * size.max()


@pytest.mark.parametrize("share", [1e-6, 0.02, 0.2])
@pytest.mark.parametrize("name", NAMES)
def test_projection_is_stationary(name: str, share: float):
    """The way to the closest point is along the unit normal there, which points up, and the point is on the surface."""
    points, diagonal = _near(name, share)
    smooth = sample_surfaces.load(name).smooth
    closest, normals, _ = smooth.project(points)
    way = points - closest
    across = way - (way * normals).sum(axis=1)[:, None] * normals
    assert np.linalg.norm(across, axis=1).max() <= 1e-14 * diagonal
    assert np.linalg.norm(normals, axis=1) == pytest.approx(np.ones(len(points)), abs=1e-15)
    if name == "sphere":
        assert np.linalg.norm(closest, axis=1) == pytest.approx(np.ones(len(points)), abs=1e-15)
    else:
        assert normals[:, 2].min() > 0
        assert np.array_equal(closest, smooth.points(closest[:, :2]))


@pytest.mark.parametrize("share", [0.02, 0.3])
@pytest.mark.parametrize("name", HEIGHTS)
def test_projection_is_closest_by_brute_force(name: str, share: float):
    """No sample of the box and a quarter round it is closer; within the box, some sample is nearly as close."""
    points, diagonal = _near(name, share)
    smooth = sample_surfaces.load(name).smooth
    closest, _, _ = smooth.project(points)
    distances = np.linalg.norm(points - closest, axis=1)
    size = smooth.box[1] - smooth.box[0]
    axes = [np.linspace(smooth.box[0][k] - size[k] / 4, smooth.box[1][k] + size[k] / 4, 400) for k in range(2)]
    samples = smooth.points(np.stack(np.meshgrid(*axes), axis=-1).reshape(-1, 2))
    brute, _ = cKDTree(samples).query(points)
    assert (distances - brute).max() <= 1e-13 * diagonal
    inside = ((closest[:, :2] > smooth.box[0]) & (closest[:, :2] < smooth.box[1])).all(axis=1)
    assert inside.sum() > 20
    assert np.abs(distances - brute)[inside].max() < 0.01 * diagonal


@pytest.mark.parametrize("name", NAMES)
def test_shape_operator_is_minus_the_derivative_of_the_normal(name: str):
    """S is symmetric, S n = 0, S t = -dn(t) by central differences, and the surface bends as S says."""
    points, diagonal = _near(name, 0.0, 100)
    smooth = sample_surfaces.load(name).smooth
    closest, normals, operators = smooth.project(points)
    assert np.array_equal(operators, operators.transpose(0, 2, 1))
    scale = np.abs(operators).max()
    assert np.abs(np.einsum("nij,nj->ni", operators, normals)).max() <= 1e-13 * scale
    directions = np.random.default_rng(RNG_SEED).normal(size=(100, 3))
    tangents = directions - (directions * normals).sum(axis=1)[:, None] * normals
    tangents /= np.linalg.norm(tangents, axis=1)[:, None]
    step = 1e-5 * diagonal
    _, ahead, _ = smooth.project(closest + step * tangents)
    _, behind, _ = smooth.project(closest - step * tangents)
    turned = -(ahead - behind) / (2 * step)
    assert np.abs(turned - np.einsum("nij,nj->ni", operators, tangents)).max() < 1e-6 * scale
    # x = p + t + 1/2 (t.S t) n + O(|t|^3): this fixes the sign.
    remainders = []
    for h in (4e-3 * diagonal, 2e-3 * diagonal):
        moved = smooth.project(closest + h * tangents)[0] - closest
        bend = 0.5 * np.einsum("ni,nij,nj->n", moved, operators, moved)
        remainders.append(np.linalg.norm((moved * normals).sum(axis=1) - bend))
    assert remainders[1] < remainders[0] / 7.5 or remainders[0] < 1e-12 * diagonal


@pytest.mark.parametrize(
    ("name", "place", "mean", "gaussian"),
    [
        ("paraboloid", [0, 0, 0], 1.0, 1.0),
        ("hypar", [0, 0, 0], 0.0, -0.25),
        ("sphere", [0, 0, -1], 1.0, 1.0),
        ("sphere", [0.6, 0, -0.8], 1.0, 1.0),
        ("mexicanhat", [0, 0, 1], -64 / 3, (64 / 3) ** 2),
        ("mexicanhat2", [0, 0, 1], -25 / 3, (25 / 3) ** 2),
        ("peaks", [0.5, 0, 0.5], -(np.pi**2) / 2, np.pi**4 / 4),
        ("peaks2", [0, 0, 0], 0.0, 0.0),
        ("saddle_roof", [0, 0, 5], 0.0, 0.0),
    ],
)
def test_known_curvatures(name: str, place: list[float], mean: float, gaussian: float):
    """Mean curvature is positive where the surface bends toward its upward normal: a bowl, not a hill."""
    _, _, operators = sample_surfaces.load(name).smooth.project(np.array([place], dtype=float))
    trace = np.trace(operators[0])
    assert trace / 2 == pytest.approx(mean, abs=1e-12)
    assert 0.5 * (trace**2 - (operators[0] ** 2).sum()) == pytest.approx(gaussian, abs=1e-11)


@pytest.mark.parametrize("name", NAMES)
def test_far_points_are_projected_without_a_warning(name: str):
    """A thousand diagonals away the map still answers with finite numbers (warnings are errors here)."""
    points, diagonal = _near(name, 1e3, 20)
    closest, normals, operators = sample_surfaces.load(name).smooth.project(points)
    assert np.isfinite(closest).all()
    assert np.isfinite(normals).all()
    assert np.isfinite(operators).all()
    assert (np.linalg.norm(closest - points, axis=1) < 1e4 * diagonal).all()


@pytest.mark.parametrize("name", NAMES)
def test_projection_does_not_depend_on_its_company(name: str):
    """One point alone, no point at all, or many at once: the same answer."""
    points, _ = _near(name, 0.1, 6)
    smooth = sample_surfaces.load(name).smooth
    together = smooth.project(points)
    alone = [smooth.project(points[i : i + 1]) for i in range(len(points))]
    for k in range(3):
        assert np.array_equal(together[k], np.concatenate([answer[k] for answer in alone]))
    assert [part.shape for part in smooth.project(points[:0])] == [(0, 3), (0, 3), (0, 3, 3)]


def test_the_center_of_the_sphere_has_an_answer():
    """Every point is closest to the center; the lowest one is returned, not a NaN."""
    closest, normals, _ = Sphere(2.0).project(np.zeros((1, 3)))
    assert np.array_equal(closest, [[0, 0, -2]])
    assert np.array_equal(normals, [[0, 0, 1]])
