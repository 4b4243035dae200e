"""Where curvature resides: areas and integrals on spheres and planes, sums, and the parts of a hole's curvature."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import pytest

from analysis import polygons
from analysis.curvature import hole_curvature
from analysis.gauss_bonnet import balance
from analysis.hole_sides import center_fans
from analysis.measures import measure
from analysis.patches import hole_patches
from analysis.residence import residence
from analysis.residence_numbers import part_numbers
from analysis.target_integrals import integrate_covered, integrate_target
from kirisurf.closest import ClosestPoints
from kirisurf.design import fit
from kirisurf.surface import Surface
from tests.analysis.patterns import in_space, regular


@dataclass(frozen=True)
class Sphere:
    """The unit sphere with its normal outward."""

    formula: str = "x^2 + y^2 + z^2 = 1"

    def project(self, points):
        normals = polygons.unit(points)
        return normals, normals, normals[:, :, None] * normals[:, None, :] - np.eye(3)


@pytest.fixture(scope="module")
def sphere():
    import pyvista

    mesh = pyvista.Icosphere(radius=1, nsub=3)
    return Surface.from_arrays(mesh.points, mesh.regular_faces, "sphere", Sphere())


def solid_angles(triangles):
    a, b, c = np.moveaxis(polygons.unit(triangles), 1, 0)
    cosines = 1 + (a * b).sum(1) + (b * c).sum(1) + (c * a).sum(1)
    return 2 * np.arctan2((a * np.cross(b, c)).sum(1), cosines)


@pytest.mark.parametrize("radius", [0.8, 1.0, 1.3])
def test_triangles_inside_and_outside_a_sphere_cover_their_solid_angle(sphere, radius):
    corners = radius * sphere.vertices[sphere.faces]
    area, curvature, magnitude = integrate_covered(corners, sphere.face_normals, ClosestPoints(sphere))
    assert area == pytest.approx(solid_angles(corners), rel=1e-4)
    assert area.sum() == pytest.approx(4 * np.pi, rel=1e-5)
    assert curvature == pytest.approx(area) and magnitude == pytest.approx(area)


def test_sheet_on_either_side_of_the_normals_covers_the_same(sphere):
    corners, closest = sphere.vertices[sphere.faces], ClosestPoints(sphere)
    front = integrate_covered(corners, sphere.face_normals, closest)
    back = integrate_covered(corners[:, ::-1], -sphere.face_normals, closest)
    assert back == pytest.approx(front)
    folded = integrate_covered(corners[:, ::-1], sphere.face_normals, closest)
    assert folded == pytest.approx(-front)


def test_whole_sphere_has_four_pi(sphere):
    area, curvature, magnitude = integrate_target(ClosestPoints(sphere))
    assert area == pytest.approx(sphere.area)
    assert curvature == pytest.approx(4 * np.pi, rel=0.01) and magnitude == curvature


def test_beyond_the_rim_nothing_is_covered(grid_surface):
    closest = ClosestPoints(grid_surface(n=3))
    inside = np.array([[0.0, 0, 0.1], [0.5, 0, 0.1], [0, 0.5, 0.2]])
    found = integrate_covered(np.stack([inside, inside + np.array([3.0, 0, 0])]), np.tile([0.0, 0, 1], (2, 1)), closest)
    assert found[0] == pytest.approx([0.125, 0])
    assert integrate_covered(np.zeros((0, 3, 3)), np.zeros((0, 3)), closest).shape == (3, 0)


@pytest.mark.parametrize("name", ["quad", "kagome", "islamic-quad", "hexagon"])
def test_flat_sheet_covers_what_it_is(name, grid_surface):
    pattern = regular(name)
    points = in_space(pattern.deployed)
    closest = ClosestPoints(grid_surface(n=3, size=20))
    curvature = hole_curvature(hole_patches(points, pattern))
    found = residence(points + np.array([0, 0, 0.7]), pattern, curvature, balance(points, pattern), closest)
    # fans of tiles that are not convex count what they cover twice once negative
    assert found.target_tile_areas == pytest.approx(found.tile_areas)
    assert found.target_hole_areas == pytest.approx(
        np.linalg.norm(polygons.area_vectors(points, pattern.holes), axis=1)
    )
    assert found.target_cell_curvatures == pytest.approx(np.zeros(len(pattern.holes)))
    assert found.target_area == pytest.approx(1600)


def test_fans_are_the_polygons():
    pattern = regular("islamic-quad")
    points = in_space(pattern.deployed)
    a, b, c = np.moveaxis(center_fans(points, pattern.tiles), 1, 0)
    total = np.zeros((pattern.n_tiles, 3))
    np.add.at(total, pattern.tiles.owners, np.cross(b - a, c - a) / 2)
    assert total == pytest.approx(polygons.area_vectors(points, pattern.tiles))


@pytest.fixture(scope="module")
def hypar():
    return fit("hypar", cells=(4, 4))


def test_flat_tiles_carry_nothing_and_holes_with_their_rims_carry_the_target(hypar):
    numbers, fields = hypar.measures.numbers, hypar.measures.fields
    assert np.abs(fields["tile", "angle_excess"]).max() <= 1e-12
    assert abs(numbers["gauss_bonnet_remainder"]) <= 1e-11
    target = numbers["inner_target_gaussian_curvature"]
    assert numbers["inner_angle_defect"] == pytest.approx(target, rel=0.03)
    assert numbers["inner_gauss_image_area"] == pytest.approx(target, rel=0.03)
    # the patches within the holes have the share of the holes' area, and the rims of the holes the tiles'
    share = numbers["inner_integrated_gaussian_curvature"] / target
    assert 0.4 <= share <= 0.6
    assert numbers["target_gaussian_curvature_under_tiles"] < 0.9 * numbers["target_gaussian_curvature_under_holes"] < 0


def test_parts_sum_to_the_curvature_of_the_hole(hypar):
    hole = {name: values for (where, name), values in hypar.measures.fields.items() if where == "hole"}
    for name in ("mean_curvature", "gaussian_curvature"):
        parts = hole[f"target_{name}"] + hole[f"{name}_from_patch"] + hole[f"{name}_from_fit"]
        assert parts == pytest.approx(hole[name], abs=1e-12)
    product = hole["principal_curvature_1"] * hole["principal_curvature_2"]
    assert product == pytest.approx(hole["gaussian_curvature"])
    assert (hole["principal_curvature_1"] >= hole["principal_curvature_2"]).all()


def test_sheet_on_its_target_owes_nothing_to_the_fit(grid_surface):
    pattern = regular("quad", 4)
    xy = in_space(pattern.deployed)[:, :2]
    xy = 0.9 * xy / np.abs(xy).max()
    target = grid_surface(lambda x, y: 0.5 * (x * x + y * y), 81)
    points = ClosestPoints(target).project(np.c_[xy, 0.5 * (xy**2).sum(axis=1)]).points
    measures = measure(pattern, points, pattern.contracted, target)
    assert measures.numbers["gaussian_curvature_from_fit_median"] <= 1e-9
    assert measures.numbers["gaussian_curvature_from_patch_median"] > 1e-3


def test_share_and_correlation_mean_what_they_say():
    target = np.array([1.0, 2.0, -3.0, 5.0])
    good, area = np.ones(4, bool), np.full(4, 2.0)

    def numbers(value, aim=target):
        parts = {"gaussian_curvature_from_fit": value - aim, "gaussian_curvature_from_patch": 0 * aim}
        hole = {"gaussian_curvature": value, "target_gaussian_curvature": aim, "area": area, **parts}
        return part_numbers("gaussian_curvature", hole, good)

    same = numbers(target)
    assert same["gaussian_curvature_target_share"] == 1
    assert same["gaussian_curvature_correlation"] == pytest.approx(1)
    twice = numbers(2 * target)
    assert twice["gaussian_curvature_target_share"] == pytest.approx(0.5)
    assert twice["gaussian_curvature_correlation"] == pytest.approx(1)
    assert numbers(-target)["gaussian_curvature_correlation"] == pytest.approx(-1)
    # nothing correlates with a constant, and nothing is a share of none
    assert "gaussian_curvature_correlation" not in numbers(target, np.ones(4))
    assert "gaussian_curvature_target_share" not in numbers(target, np.zeros(4))
