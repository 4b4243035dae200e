"""Closest points against brute force, continuity of normals, shape operators, the rim."""

from __future__ import annotations

import numpy as np
import pytest
import trimesh

import sample_surfaces
from kirisurf.closest import ClosestPoints
from kirisurf.errors import UnusableError
from kirisurf.shape_operator import vertex_shape_operators
from kirisurf.surface import Surface


def mesh_only(name: str, resolution: int) -> Surface:
    """A sample surface without its formula."""
    surface = sample_surfaces.load(name, resolution=resolution)
    return Surface.from_arrays(surface.vertices, surface.faces, name)


def brute_force(surface: Surface, points: np.ndarray) -> np.ndarray:
    """Distances by trying every triangle with trimesh's closest-point formula."""
    triangles = surface.vertices[surface.faces]
    return np.array(
        [
            np.linalg.norm(
                trimesh.triangles.closest_point(triangles, np.tile(p, (len(triangles), 1))) - p, axis=1
            ).min()
            for p in points
        ]
    )


@pytest.mark.parametrize("name", ["peaks", "sphere", "face_mask"])
def test_distances_equal_brute_force(name: str) -> None:
    surface = mesh_only(name, 12)
    rng = np.random.default_rng(0)
    low, high = surface.vertices.min(axis=0), surface.vertices.max(axis=0)
    points = rng.uniform(low - 0.2 * surface.diagonal, high + 0.2 * surface.diagonal, (60, 3))
    closest = ClosestPoints(surface)
    expected = brute_force(surface, points)
    np.testing.assert_allclose(closest.distances(points), expected, atol=1e-12 * surface.diagonal)
    np.testing.assert_allclose(closest.project(points).distances, expected, atol=1e-9 * surface.diagonal)


def test_located_points_are_where_the_barycentric_coordinates_say() -> None:
    surface = mesh_only("peaks", 12)
    weights = np.random.default_rng(1).dirichlet([1, 1, 1], 50)
    faces = np.random.default_rng(2).integers(0, len(surface.faces), 50)
    points = np.einsum("nk,nki->ni", weights, surface.vertices[surface.faces[faces]])
    found, found_weights = ClosestPoints(surface).locate(points)
    np.testing.assert_array_equal(found, faces)
    np.testing.assert_allclose(found_weights, weights, atol=1e-9)


def test_normals_are_continuous_across_edges() -> None:
    surface = mesh_only("sphere", 16)
    closest = ClosestPoints(surface)
    # on the convex side, where the closest point itself is continuous
    path = np.linspace([-0.6, -0.35, -0.9], [0.6, 0.3, -0.9], 4001)
    path *= 1.05 / np.linalg.norm(path, axis=1, keepdims=True)
    found = closest.project(path)
    steps = np.linalg.norm(np.diff(path, axis=0), axis=1).max()
    assert np.linalg.norm(np.diff(found.normals, axis=0), axis=1).max() < 3 * steps
    # the faces' own normals jump by much more from face to face
    assert np.linalg.norm(np.diff(surface.face_normals[found.faces], axis=0), axis=1).max() > 30 * steps


def test_shape_operators_of_a_sphere_converge() -> None:
    errors = []
    for resolution in (12, 24, 48):
        surface = mesh_only("sphere", resolution)
        inner = np.setdiff1d(np.arange(len(surface.vertices)), surface.boundary_edges)
        shape = vertex_shape_operators(surface)[inner]
        n = surface.normals[inner]
        # normals of the lower cap face +z: toward the center, so every direction bends toward them by 1
        expected = np.eye(3) - n[:, :, None] * n[:, None, :]
        errors.append(np.median(np.abs(shape - expected).max(axis=(1, 2))))
        np.testing.assert_allclose(shape, np.swapaxes(shape, 1, 2), atol=1e-12)
        np.testing.assert_allclose(np.einsum("nij,nj->ni", shape, n), 0.0, atol=1e-12)
    assert np.log2(errors[0] / errors[1]) > 0.9 and np.log2(errors[1] / errors[2]) > 0.9


def test_a_formula_replaces_the_triangles() -> None:
    surface = sample_surfaces.load("hypar", resolution=8)
    points = surface.vertices + 0.05
    found = ClosestPoints(surface).project(points)
    expected, normals, shape = surface.smooth.project(points)
    np.testing.assert_array_equal(found.points, expected)
    np.testing.assert_array_equal(found.normals, normals)
    np.testing.assert_array_equal(found.shape_operators, shape)
    assert ClosestPoints(surface).distances(points).max() != found.distances.max()


def test_the_rim_is_known_with_its_outward_conormal() -> None:
    square = Surface.from_arrays(
        [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0.5, 0.5, 0]], [[0, 1, 4], [1, 2, 4], [2, 3, 4], [3, 0, 4]]
    )
    points = np.array([[0.5, -0.3, 0.1], [1.4, 0.4, 0.0], [0.4, 0.45, 0.2], [-0.2, 0.6, -0.1]])
    found = ClosestPoints(square).project(points)
    np.testing.assert_array_equal(found.on_rim, [True, True, False, True])
    np.testing.assert_allclose(found.rim_points[[0, 1, 3]], [[0.5, 0, 0], [1, 0.4, 0], [0, 0.6, 0]], atol=1e-12)
    beyond = np.einsum("ni,ni->n", points - found.rim_points, found.rim_conormals)
    assert (beyond[[0, 1, 3]] > 0).all() and beyond[2] < 0


@pytest.mark.parametrize(
    ("vertices", "faces"),
    [
        (np.eye(3), np.zeros((0, 3), np.int64)),
        (np.eye(3) * np.nan, np.array([[0, 1, 2]])),
        (np.eye(3), np.array([[0, 1, 1]])),
        (np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]]), np.array([[0, 1, 2]])),
    ],
)
def test_arrays_that_would_kill_native_code_are_refused(vertices: np.ndarray, faces: np.ndarray) -> None:
    with pytest.raises(UnusableError, match="expected"):
        ClosestPoints(Surface(vertices, faces))


def test_queries_that_are_not_finite_are_refused() -> None:
    with pytest.raises(FloatingPointError, match="finite"):
        ClosestPoints(mesh_only("hypar", 6)).locate(np.array([[0.0, np.nan, 0.0]]))


def test_normals_across_a_fold_are_unit_vectors() -> None:
    """Where a sheet lies folded on itself, the vertex normals on both sides of the fold cancel between them."""
    strip = np.array([[1, 0, 0], [0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [1, 1, 0]], float)
    faces = np.array([[0, 1, 3], [1, 4, 3], [1, 2, 4], [2, 5, 4]])
    found = ClosestPoints(Surface.from_arrays(strip, faces)).project(np.array([[0.5, 0.5, 0.2], [0.0, 0.5, 0.1]]))
    assert np.allclose(np.linalg.norm(found.normals, axis=1), 1.0)
