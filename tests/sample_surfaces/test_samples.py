"""Samples: every one is a well-shaped disk on the surface of its formula, in believable proportions."""

from __future__ import annotations

import tomllib
from importlib.resources import files
from pathlib import Path

import numpy as np
import pytest
from scipy import sparse
from scipy.sparse.linalg import spsolve

import sample_surfaces
from kirisurf.errors import ParameterError
from kirisurf.surface import Surface
from sample_surfaces import catalog

NAMES = sample_surfaces.names()
PUBLISHED = ("hypar", "mexicanhat", "mexicanhat2", "paraboloid", "peaks", "peaks2", "sphere")
PRACTICAL = tuple(name for name in NAMES if name not in PUBLISHED)


def _angles(surface: Surface) -> np.ndarray:
    corners = surface.vertices[surface.faces]
    edges = np.roll(corners, -1, axis=1) - corners
    back = -np.roll(edges, 1, axis=1)
    return np.arctan2(np.linalg.norm(np.cross(edges, back), axis=2), (edges * back).sum(axis=2))


def _gaussian_curvatures(surface: Surface) -> np.ndarray:
    operators = surface.smooth.project(surface.vertices)[2]
    return 0.5 * (np.trace(operators, axis1=1, axis2=2) ** 2 - (operators**2).sum(axis=(1, 2)))


def _vertex_areas(surface: Surface) -> np.ndarray:
    return np.bincount(surface.faces.ravel(), np.repeat(surface.face_areas / 3, 3), len(surface.vertices))


def test_the_list_is_complete():
    """The seven published targets come first; six or more practical surfaces follow."""
    assert NAMES[:7] == PUBLISHED
    assert set(PRACTICAL) >= {"dome", "car_hood", "terrain", "face_mask", "vault", "saddle_roof"}


@pytest.mark.parametrize("name", NAMES)
def test_spec_says_what_a_user_needs(name: str):
    """Nothing is empty, units are known, and one suggestion for a fit is given."""
    spec = sample_surfaces.spec(name)
    assert spec.name == name
    assert all([spec.title, spec.formula, spec.origin, spec.outline])
    assert "\n" not in spec.origin
    assert spec.units in {"1", "mm", "m"}
    assert spec.published == (name in PUBLISHED)
    assert spec.published == (spec.units == "1")
    assert list(spec.fit_options) == (["cells"] if spec.published else ["tiles"])


@pytest.mark.parametrize("name", NAMES)
def test_mesh_is_a_disk_that_faces_up(name: str):
    """V - E + F = 1, one boundary loop, every vertex used, every face counter-clockwise from above."""
    surface = sample_surfaces.load(name)
    edges = np.sort(surface.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
    unique, counts = np.unique(edges, axis=0, return_counts=True)
    assert len(surface.vertices) - len(unique) + len(surface.faces) == 1
    assert counts.max() == 2
    assert len(surface.boundary_loops) == 1
    assert len(surface.boundary_loops[0]) == (counts == 1).sum()
    assert np.array_equal(np.unique(surface.faces), np.arange(len(surface.vertices)))
    assert surface.face_normals[:, 2].min() > 0
    assert (surface.name, surface.vertices.flags.writeable) == (name, False)


@pytest.mark.parametrize("name", NAMES)
def test_mesh_is_well_shaped_and_of_moderate_size(name: str):
    """No angle under 20 degrees; the Mexican hats' squares stand on slopes up to 74 degrees, so 12 there."""
    surface = sample_surfaces.load(name)
    assert np.degrees(_angles(surface).min()) > (12 if name.startswith("mexicanhat") else 20)
    assert 2_000 < len(surface.vertices) < 11_000


@pytest.mark.parametrize("name", NAMES)
def test_vertices_lie_on_the_smooth_surface(name: str):
    """To rounding, and so that the projection finds them again."""
    surface = sample_surfaces.load(name)
    points, normals, _ = surface.smooth.project(surface.vertices)
    assert np.linalg.norm(points - surface.vertices, axis=1).max() <= 1e-14 * surface.diagonal
    # Facing the same way: the vertex normals of the mesh are the smooth ones up to the mesh's coarseness.
    assert (normals * surface.normals).sum(axis=1).min() > 0.97


@pytest.mark.parametrize("name", NAMES)
def test_mesh_approaches_the_smooth_surface_at_second_order(name: str):
    """The distance of the faces' centroids falls with the square of the edge length."""
    distances = []
    for resolution in (24, 48):
        surface = sample_surfaces.load(name, resolution)
        centroids = surface.vertices[surface.faces].mean(axis=1)
        points, _, _ = surface.smooth.project(centroids)
        edge = np.sqrt(surface.area / len(surface.faces))
        distances.append((edge, np.sqrt(((points - centroids) ** 2).sum(axis=1).mean())))
    (coarse, far), (fine, near) = distances
    assert np.log(far / near) / np.log(coarse / fine) > 1.85
    default = sample_surfaces.load(name)
    centroids = default.vertices[default.faces].mean(axis=1)
    rms = np.sqrt(((default.smooth.project(centroids)[0] - centroids) ** 2).sum(axis=1).mean())
    # About 64 tiles on the published ones, 300 on the others: a thousandth of a tile edge (a hundredth on the hats).
    tile_edge = np.sqrt(default.area / (64 if name in PUBLISHED else 300))
    assert rms < (0.01 if name.startswith("mexicanhat") else 0.004) * tile_edge


@pytest.mark.parametrize("name", PRACTICAL)
def test_rim_lies_on_the_outline(name: str):
    """The boundary vertices, seen from above, satisfy the equation of the outline."""
    text = files("sample_surfaces").joinpath("specs", f"{name}.toml").read_text(encoding="utf-8")
    table = tomllib.loads(text)["boundary"]
    surface = sample_surfaces.load(name)
    rim = surface.vertices[surface.boundary_loops[0], :2]
    if table["kind"] == "curved_polygon":
        corners = np.array(table["corners"], dtype=float)
        off = []
        for i, bulge in enumerate(table["bulges"]):
            chord = np.roll(corners, -1, axis=0)[i] - corners[i]
            along = (rim - corners[i]) @ chord / (chord @ chord)
            across = (rim - corners[i]) @ np.array([chord[1], -chord[0]]) / (chord @ chord)
            away = np.abs(across - 4 * bulge * along * (1 - along))
            off.append(np.where((along > -1e-9) & (along < 1 + 1e-9), away, np.inf))
        distance = np.min(off, axis=0)
    elif table["kind"] == "rounded_polygon":
        facing = 2 * np.pi * np.arange(table["sides"]) / table["sides"]
        reach = np.maximum(rim @ np.array([np.cos(facing), np.sin(facing)]), 0) / table["apothem"]
        distance = np.abs((reach ** table["sharpness"]).sum(axis=1) ** (1 / table["sharpness"]) - 1)
    else:
        unit = rim / table["semi_axes"]
        turn = np.arctan2(unit[:, 1], unit[:, 0])
        radius = 1 + sum(a * np.cos(k * turn - phase) for k, a, phase in table.get("harmonics", []))
        distance = np.abs(np.linalg.norm(unit, axis=1) - radius)
    assert distance.max() < 1e-13


@pytest.mark.parametrize("name", NAMES)
def test_curvature_of_the_formula_is_that_of_the_mesh(name: str):
    """Gauss-Bonnet in the small: the angle defects sum to the integral of the analytic K over their part."""
    surface = sample_surfaces.load(name)
    defects = 2 * np.pi - np.bincount(surface.faces.ravel(), _angles(surface).ravel())
    inner = np.setdiff1d(np.arange(len(surface.vertices)), surface.boundary_loops[0])
    weighted = _gaussian_curvatures(surface) * _vertex_areas(surface)
    assert abs(defects[inner].sum() - weighted[inner].sum()) < 0.005 * np.abs(weighted).sum()


@pytest.mark.parametrize("name", PRACTICAL)
def test_practical_surfaces_stretch_a_quad_sheet_by_less_than_it_can(name: str):
    """With -Laplace u = K, u = 0 on the rim, exp(u) is a conformal flattening's stretch: below exp(0.3) < sqrt 2."""
    surface = sample_surfaces.load(name)
    cotangents = 1 / np.tan(_angles(surface))
    n = len(surface.vertices)
    stiffness = sparse.csr_matrix((n, n))
    for k in range(3):
        i, j = surface.faces[:, (k + 1) % 3], surface.faces[:, (k + 2) % 3]
        half = 0.5 * cotangents[:, k]
        rows, columns = np.concatenate([i, j, i, j]), np.concatenate([i, j, j, i])
        stiffness = stiffness + sparse.csr_matrix(
            (np.concatenate([half, half, -half, -half]), (rows, columns)), shape=(n, n)
        )
    inner = np.setdiff1d(np.arange(n), surface.boundary_loops[0])
    curvature = (_gaussian_curvatures(surface) * _vertex_areas(surface))[inner]
    u = np.append(spsolve(stiffness[inner][:, inner].tocsc(), curvature), 0.0)
    assert np.ptp(u) < 0.3


FORMULAS = {
    "hypar": lambda x, y: 0.5 * x * y,
    "paraboloid": lambda x, y: 0.5 * (x**2 + y**2),
    "peaks": lambda x, y: 0.5 * np.sin(np.pi * x) * np.cos(np.pi * y),
    "peaks2": lambda x, y: 0.25 * np.sin(2 * np.pi * x) * np.cos(2 * np.pi * y),
    "mexicanhat": lambda x, y: np.sinc(8 * np.hypot(x, y) / np.pi),
    "mexicanhat2": lambda x, y: np.sinc(5 * np.hypot(x, y) / np.pi),
}


@pytest.mark.parametrize("name", FORMULAS)
def test_published_targets_follow_the_published_formulas(name: str):
    """Written out again here, on the square [-1, 1]^2."""
    x, y, z = sample_surfaces.load(name).vertices.T
    assert z == pytest.approx(FORMULAS[name](x, y), abs=1e-14)
    assert (x.min(), x.max(), y.min(), y.max()) == (-1, 1, -1, 1)


def test_sphere_is_a_cap_of_the_unit_sphere():
    """All of the bowl up to 60 degrees from its lowest point."""
    vertices = sample_surfaces.load("sphere").vertices
    assert np.linalg.norm(vertices, axis=1) == pytest.approx(np.ones(len(vertices)), abs=1e-15)
    assert (vertices[:, 2].min(), vertices[:, 2].max()) == pytest.approx((-1, -0.5))


@pytest.mark.parametrize("name", PUBLISHED)
def test_published_targets_are_the_authors_own(name: str, reference: Path):
    """The vertices of the authors' files lie on our surfaces to the six digits that the files hold."""
    lines = (reference / "reference" / "choi2019" / "targets" / f"{name}.obj").read_text().splitlines()
    vertices = np.array([[float(word) for word in line.split()[1:4]] for line in lines if line.startswith("v ")])
    points, _, _ = sample_surfaces.load(name).smooth.project(vertices)
    assert np.linalg.norm(points - vertices, axis=1).max() < 2e-6


def test_samples_are_the_same_every_time():
    """Made twice from nothing, bit by bit."""
    first = sample_surfaces.load("terrain", 30)
    catalog._loaded.cache_clear()
    second = sample_surfaces.load("terrain", 30)
    assert first is not second
    assert np.array_equal(first.vertices, second.vertices)
    assert np.array_equal(first.faces, second.faces)


def test_an_unknown_name_is_refused_with_the_known_ones():
    """The message lists what there is."""
    with pytest.raises(ParameterError, match=r"expected one of hypar, .*got 'hyper'"):
        sample_surfaces.load("hyper")
    with pytest.raises(ParameterError, match="got 'hyper'"):
        sample_surfaces.spec("hyper")


@pytest.mark.parametrize("resolution", [0, 5, -3, 1001, True])
def test_a_resolution_out_of_range_is_refused(resolution: int):
    """A whole number from 6 to 1000."""
    with pytest.raises(ParameterError, match="resolution of hypar: expected a whole number from 6 to 1000"):
        sample_surfaces.load("hypar", resolution)
