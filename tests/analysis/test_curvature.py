"""Curvature of holes: exact truths, invariances, a theorem, and second order of convergence."""

from __future__ import annotations

import numpy as np
import pytest

from analysis.curvature import TRIANGLE_POINTS, TRIANGLE_WEIGHTS, fundamental_forms, hole_curvature, target_curvature
from analysis.patches import BezierPatch, hole_patches
from kirisurf.closest import ClosestPoints
from kirisurf.pattern import quad_pattern


def _graph_curvature(fx, fy, fxx, fxy, fyy):
    w = 1 + fx**2 + fy**2
    mean = ((1 + fx**2) * fyy - 2 * fx * fy * fxy + (1 + fy**2) * fxx) / (2 * w**1.5)
    return mean, (fxx * fyy - fxy**2) / w**2


def _paraboloid(xy):
    return np.c_[xy, 0.5 * (xy**2).sum(axis=1)]


def _hypar(xy):
    return np.c_[xy, 0.5 * xy[:, 0] * xy[:, 1]]


def _sphere(xy):
    """Stereographic: the lower unit hemisphere and somewhat less, seen from inside."""
    half = xy * 0.45
    below = 1 + (half**2).sum(axis=1, keepdims=True)
    return np.c_[2 * half, below - 2] / below


SURFACES = {
    "paraboloid": (_paraboloid, lambda p: _graph_curvature(p[:, 0], p[:, 1], 1, 0, 1)),
    "hypar": (_hypar, lambda p: _graph_curvature(0.5 * p[:, 1], 0.5 * p[:, 0], 0, 0.5, 0)),
    "sphere": (_sphere, lambda p: (np.ones(len(p)), np.ones(len(p)))),
}


def _lifted(name: str, cells: int):
    pattern = quad_pattern(cells, cells)
    xy = pattern.deployed - pattern.deployed.mean(axis=0)
    return pattern, SURFACES[name][0](xy / np.abs(xy).max())


@pytest.mark.parametrize("name", SURFACES)
def test_curvature_converges_with_second_order(name):
    steps, relative = [], []
    for cells in (4, 8, 16):
        pattern, points = _lifted(name, cells)
        found = hole_curvature(hole_patches(points, pattern))
        mean, gaussian = SURFACES[name][1](found.centers)
        steps.append([np.median(np.abs(found.gaussian - gaussian)), np.median(np.abs(found.mean - mean))])
        relative.append(np.median(np.abs(found.gaussian / gaussian - 1)))
    orders = np.polyfit(-np.log2([8, 16, 32]), np.log2(steps), 1)[0]
    assert (orders >= 1.8).all(), orders
    assert relative[0] <= 0.04


def test_published_experiment_is_reproduced():
    """Median relative error of K on the lifted paraboloid at 8, 16, 32 tiles a side: about .021, .0055, .0014."""
    for cells, expected in ((4, 0.021), (8, 0.0055), (16, 0.0014)):
        pattern, points = _lifted("paraboloid", cells)
        found = hole_curvature(hole_patches(points, pattern))
        gaussian = SURFACES["paraboloid"][1](found.centers)[1]
        assert np.median(np.abs(found.gaussian / gaussian - 1)) == pytest.approx(expected, rel=0.2)


def test_averages_converge_to_the_values_at_the_centers():
    differences = []
    for cells in (4, 8):
        pattern, points = _lifted("paraboloid", cells)
        found = hole_curvature(hole_patches(points, pattern))
        differences.append(np.median(np.abs(found.gaussian_averaged - found.gaussian)))
    assert np.log2(differences[0] / differences[1]) >= 1.7


def test_paraboloid_patch_has_exact_curvature_at_its_vertex():
    # z = x^2 + y^2 / 2 as a Bezier patch: principal curvatures 2 and 1 at (0, 0), toward the upward normal
    i = np.arange(4) / 3
    square = np.array([0, 0, 1 / 3, 1])
    net = np.stack([np.broadcast_to(i[:, None], (4, 4)), np.broadcast_to(i, (4, 4)), square[:, None] + square / 2], 2)
    origin = np.zeros((1, 1))
    forms = fundamental_forms(BezierPatch(net[None]), origin, origin)
    assert forms.gaussian[0, 0] == pytest.approx(2, abs=1e-13)
    assert forms.mean[0, 0] == pytest.approx(1.5, abs=1e-13)
    assert forms.principal[0, 0] == pytest.approx([2, 1])
    assert forms.normals[0, 0] == pytest.approx([0, 0, 1])


def test_plane_and_cylinder_have_no_gaussian_curvature():
    pattern = quad_pattern(6, 6)
    xy = pattern.deployed - pattern.deployed.mean(axis=0)
    plane = hole_curvature(hole_patches(np.pad(xy, ((0, 0), (0, 1))), pattern))
    assert np.abs([plane.gaussian, plane.mean, plane.gaussian_averaged]).max() <= 1e-11
    radius, x = 5.0, xy[:, 0]
    cylinder = np.stack([radius * np.sin(x / radius), xy[:, 1], -radius * np.cos(x / radius)], axis=1)
    found = hole_curvature(hole_patches(cylinder, pattern))
    assert found.mean == pytest.approx(np.full(len(found.mean), 0.5 / radius), rel=1e-2)
    assert np.abs(found.gaussian).max() <= 1e-3 / radius**2


def test_rigid_motion_keeps_curvature_and_scale_divides_it(rotation):
    pattern, points = _lifted("hypar", 4)
    one = hole_curvature(hole_patches(points, pattern))
    scale = 37.0
    two = hole_curvature(hole_patches(scale * points @ rotation.T + np.array([3.0, -200.0, 80.0]), pattern))
    assert two.gaussian * scale**2 == pytest.approx(one.gaussian, rel=1e-6)
    assert two.mean * scale == pytest.approx(one.mean, rel=1e-6, abs=1e-9)
    assert two.gaussian_averaged * scale**2 == pytest.approx(one.gaussian_averaged, rel=1e-6)
    assert two.areas / scale**2 == pytest.approx(one.areas, rel=1e-8)


def test_numbering_does_not_matter():
    from kirisurf.derive import derive_tessellation
    from kirisurf.loops import Loops

    pattern, points = _lifted("paraboloid", 3)
    rng = np.random.default_rng(2)
    order = rng.permutation(len(points))
    place = np.argsort(order)
    tiles = Loops.from_lists([np.roll(place[tile], rng.integers(4)) for tile in reversed(list(pattern.tiles))])
    flat = pattern.contracted[order]
    again = derive_tessellation(flat, flat, tiles, pattern.weld[order])
    one = hole_curvature(hole_patches(points, pattern))
    two = hole_curvature(hole_patches(points[order], again))
    match = np.linalg.norm(one.centers[:, None] - two.centers, axis=2).argmin(axis=1)
    assert two.gaussian[match] == pytest.approx(one.gaussian, rel=1e-8)
    assert two.mean[match] == pytest.approx(one.mean, rel=1e-8)


def test_mean_curvature_changes_sign_with_the_front():
    pattern, points = _lifted("paraboloid", 3)
    mirrored = points * np.array([1.0, 1.0, -1.0])
    one = hole_curvature(hole_patches(points, pattern))
    two = hole_curvature(hole_patches(mirrored, pattern))
    assert (one.mean > 0).all()
    assert two.mean == pytest.approx(-one.mean)
    assert two.gaussian == pytest.approx(one.gaussian)


def test_curvature_of_a_sphere_integrates_to_its_solid_angle():
    """Gauss-Bonnet on a unit sphere: the integral of K over the holes is their area on the sphere."""
    pattern, points = _lifted("sphere", 12)
    found = hole_curvature(hole_patches(points, pattern))
    integrated = (found.gaussian_averaged * found.areas).sum()
    total = 0.0
    for hole in pattern.holes:
        corner = points[hole]
        for k in range(1, len(hole) - 1):
            a, b, c = corner[0], corner[k], corner[k + 1]
            # solid angle of a triangle (Van Oosterom and Strackee)
            total += 2 * np.arctan2(abs(a @ np.cross(b, c)), 1 + a @ b + b @ c + c @ a)
    assert integrated == pytest.approx(total, rel=5e-3)


def test_quadrature_on_a_triangle_is_exact_to_degree_five():
    x, y = TRIANGLE_POINTS[:, 1], TRIANGLE_POINTS[:, 2]
    assert TRIANGLE_WEIGHTS.sum() == pytest.approx(1)
    factorial = [1, 1, 2, 6, 24, 120, 720, 5040]
    for a in range(6):
        for b in range(6 - a):
            # the integral of x^a y^b over the unit triangle is a! b! / (a + b + 2)!, half its area factored out
            exact = 2 * factorial[a] * factorial[b] / factorial[a + b + 2]
            assert (TRIANGLE_WEIGHTS * x**a * y**b).sum() == pytest.approx(exact)


def test_curvature_of_a_target_mesh_is_seen_from_the_front(grid_surface):
    surface = grid_surface(lambda x, y: 0.5 * (x**2 + y**2), 61)
    points = np.array([[0.0, 0, 0], [0.3, 0.2, 0.1]])
    up = np.array([[0.0, 0, 1], [0, 0, 1]])
    mean, gaussian = target_curvature(ClosestPoints(surface), points, up)
    assert mean[0] == pytest.approx(1, abs=0.01)
    assert gaussian[0] == pytest.approx(1, abs=0.02)
    flipped = target_curvature(ClosestPoints(surface), points, -up)
    assert flipped[0] == pytest.approx(-mean)
    assert flipped[1] == pytest.approx(gaussian)


def test_no_holes_give_empty_arrays():
    pattern = quad_pattern(1, 1)
    single = hole_patches(np.pad(pattern.deployed, ((0, 0), (0, 1))), pattern)
    assert len(hole_curvature(single).mean) == len(pattern.holes) == 1
