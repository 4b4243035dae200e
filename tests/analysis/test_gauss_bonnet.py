"""Gauss-Bonnet on sheets: the identity, closed polyhedra, Gauss images, and second order per hole."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from analysis import polygons
from analysis.curvature import hole_curvature
from analysis.gauss_bonnet import balance
from analysis.hole_sides import gauss_image_areas, sides_beyond, tiles_beyond, to_holes
from analysis.patches import hole_patches
from kirisurf.loops import Loops
from kirisurf.pattern import quad_pattern
from tests.analysis.patterns import NAMES, in_space, regular, windowed

GRAPHS = {
    "sphere": (lambda x, y: np.sqrt(4 - x * x - y * y), lambda x, y: 0 * x + 0.25),
    "paraboloid": (lambda x, y: 0.5 * (x * x + y * y), lambda x, y: (1 + x * x + y * y) ** -2.0),
    "hypar": (lambda x, y: 0.5 * x * y, lambda x, y: -0.25 * (1 + 0.25 * (x * x + y * y)) ** -2.0),
}
ALIKE = ("quad", "kagome", "hexagon", "truncated-square")
"""Patterns whose holes, with their shares of the tiles, are all alike."""


def cuboctahedron():
    """The polyhedron of 8 triangles, as tiles, and 6 squares, as holes, on the midpoints of a cube's edges."""
    corners = np.array([p for p in np.ndindex(3, 3, 3) if sum(q == 1 for q in p) == 1]) - 1.0
    axes = [s * np.eye(3)[k] for k in range(3) for s in (-1, 1)]
    diagonals = [np.array(p) for p in np.ndindex(2, 2, 2)]
    faces = [_face(corners, np.array(axis)) for axis in axes]
    tiles = [_face(corners, 2.0 * d - 1) for d in diagonals]
    nowhere = np.zeros((12, 2))
    return corners, replace(
        quad_pattern(2, 2),
        deployed=nowhere,
        contracted=nowhere,
        weld=np.arange(12),
        tiles=Loops.from_lists(tiles),
        holes=Loops.from_lists(faces),
        cells=np.zeros((8, 3), np.int64),
    )


def _face(corners, normal):
    """Vertices farthest along a normal, counter-clockwise seen from outside."""
    height = corners @ normal
    face = np.flatnonzero(height > height.max() - 1e-9)
    u = corners[face[0]] - corners[face].mean(axis=0)
    relative = corners[face] - corners[face].mean(axis=0)
    angle = np.arctan2(relative @ np.cross(normal, u) / np.linalg.norm(normal), relative @ u)
    return face[np.argsort(angle)]


def test_a_closed_polyhedron_curves_by_four_pi():
    points, sheet = cuboctahedron()
    found = balance(points, sheet)
    assert (found.euler, found.rim) == (2, 0)
    assert found.vertices == pytest.approx(4 * np.pi)
    assert found.defects == pytest.approx(np.full(6, 4 * np.pi / 6))
    assert gauss_image_areas(points, sheet) == pytest.approx(np.full(6, 4 * np.pi / 6))


def test_gauss_images_of_a_bent_closed_polyhedron_still_cover_the_sphere_once():
    points, sheet = cuboctahedron()
    bent = points + 0.2 * np.random.default_rng(3).normal(size=points.shape)
    areas = gauss_image_areas(bent, sheet)
    assert np.ptp(areas) > 0.1
    assert areas.sum() == pytest.approx(4 * np.pi)
    assert balance(bent, sheet).total == pytest.approx(4 * np.pi)


def test_gauss_image_is_the_angle_excess_of_the_normals():
    """Girard: the area of a convex spherical polygon is the sum of its angles minus (k - 2) pi."""
    pattern = quad_pattern(2, 2)
    points = in_space(pattern.deployed)
    points[:, 2] = np.sqrt(4 - (points[:, :2] ** 2).sum(axis=1))
    normals = polygons.normals(points, pattern.tiles)
    areas = gauss_image_areas(points, pattern)
    for k, side in enumerate(np.split(tiles_beyond(pattern), pattern.holes.offsets[1:-1])):
        a = normals[side]
        before, after = np.roll(a, 1, axis=0), np.roll(a, -1, axis=0)
        u = polygons.unit(after - (after * a).sum(axis=1, keepdims=True) * a)
        v = polygons.unit(before - (before * a).sum(axis=1, keepdims=True) * a)
        assert np.arccos((u * v).sum(axis=1)).sum() - 2 * np.pi == pytest.approx(areas[k], rel=1e-6)


@pytest.mark.parametrize("name", NAMES)
def test_identity_holds_for_any_points(name):
    rng = np.random.default_rng(len(name))
    for pattern in (regular(name), regular(name, 5, trimmed=True)):
        points = in_space(pattern.deployed) + 0.05 * rng.normal(size=(pattern.n_vertices, 3))
        found = balance(points, pattern)
        assert abs(found.remainder) <= 1e-11
        assert found.holes == pytest.approx(found.hole_excess.sum())
        assert found.tiles == pytest.approx(found.tile_excess.sum())
        assert abs(found.total) > 1e-3


def test_sheet_with_windows_is_a_disk_with_every_window_filled_or_not():
    pattern = windowed()
    assert balance(in_space(pattern.deployed), pattern).euler == 1
    inner = int(np.flatnonzero(balance(in_space(pattern.deployed), pattern).is_inner)[0])
    without = replace(pattern, holes=pattern.holes.subset(np.delete(np.arange(len(pattern.holes)), inner)))
    # one hole left open: the sheet is a ring, and the hole's sides are part of its rim
    assert balance(in_space(pattern.deployed), without).euler == 0


@pytest.mark.parametrize("name", NAMES)
def test_plane_has_no_curvature_and_its_rim_turns_once(name):
    pattern = regular(name)
    found = balance(in_space(pattern.deployed), pattern)
    for value in (found.hole_excess, found.vertex_shares, found.tile_shares, found.tiles, found.vertices):
        assert np.abs(value).max() <= 1e-7
    assert found.rim == pytest.approx(2 * np.pi * found.euler)
    assert gauss_image_areas(in_space(pattern.deployed), pattern) == pytest.approx(np.zeros(len(pattern.holes)))


def test_rigid_motion_and_scale_keep_every_angle(rotation):
    pattern = regular("kagome")
    points = in_space(pattern.deployed)
    points[:, 2] = 0.1 * points[:, 0] * points[:, 1]
    one, two = balance(points, pattern), balance(7 * points @ rotation.T + 3.0, pattern)
    assert two.defects == pytest.approx(one.defects, abs=1e-12, nan_ok=True)
    images = [gauss_image_areas(p, pattern) for p in (points, 7 * points @ rotation.T + 3.0)]
    assert images[1] == pytest.approx(images[0], abs=1e-12)


def _relative_errors(name, graph, n):
    """Median differences of angle defects and Gauss images per area to K at inner holes, over the median |K|."""
    height, exact = GRAPHS[graph]
    pattern = regular(name, n)
    flat = pattern.deployed - pattern.deployed.mean(axis=0)
    flat = 0.9 * flat / np.abs(flat).max()
    points = np.column_stack([flat, height(*flat.T)])
    patches = hole_curvature(hole_patches(points, pattern))
    tiles = np.linalg.norm(polygons.area_vectors(points, pattern.tiles), axis=1)
    cells = patches.areas + to_holes(tiles, pattern)
    angles = balance(points, pattern)
    inner = angles.is_inner
    curvature = exact(*patches.centers[:, :2].T)[inner]
    found = [(value / cells)[inner] for value in (angles.defects, gauss_image_areas(points, pattern))]
    return [np.median(np.abs(value - curvature)) / np.median(np.abs(curvature)) for value in found]


@pytest.mark.parametrize("graph", GRAPHS)
@pytest.mark.parametrize("name", ALIKE)
def test_defect_and_image_of_every_hole_converge_to_the_curvature_with_second_order(name, graph):
    coarse, fine = (np.array(_relative_errors(name, graph, n)) for n in (6, 12))
    assert (np.log2(coarse / fine) >= 1.7).all()
    assert (fine <= 2e-3).all()


@pytest.mark.parametrize("name", NAMES)
def test_holes_get_from_tiles_what_these_have_but_on_the_rim(name):
    pattern = regular(name)
    values = np.random.default_rng(1).uniform(1, 2, pattern.n_tiles)
    per_side = np.repeat(values / pattern.tiles.sizes, pattern.tiles.sizes)
    beyond = sides_beyond(pattern)
    assert len(np.unique(beyond)) == len(beyond)
    assert to_holes(values, pattern).sum() == pytest.approx(per_side[beyond].sum())
    edges = pattern.tiles.edges[beyond]
    assert (edges[:, ::-1] == pattern.holes.edges).all()


def test_angles_in_space_are_the_interior_angles_of_flat_polygons_reflex_or_not():
    arrow = np.array([[0.0, 0, 0], [2, -1, 0], [0, 2, 0], [-2, -1, 0]])
    loops = Loops.from_lists([np.arange(4)])
    front = np.tile([0.0, 0, 1], (4, 1))
    angles = polygons.angles_in_space(arrow, loops, front)
    assert angles == pytest.approx(polygons.corner_angles(arrow, loops))
    assert angles.max() > np.pi and angles.sum() == pytest.approx(2 * np.pi)
    # lifted, the corners of a skew quadrilateral sum to less than a full turn
    square = np.array([[1.0, 1, 0.3], [-1, 1, -0.3], [-1, -1, 0.3], [1, -1, -0.3]])
    skew = polygons.angles_in_space(square, loops, front)
    assert np.cos(skew) == pytest.approx(np.full(4, 0.36 / 4.36))
