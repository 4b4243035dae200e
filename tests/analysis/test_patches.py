"""Bezier arithmetic with exact rational truths, and least-squares patches."""

from __future__ import annotations

from dataclasses import replace
from fractions import Fraction

import numpy as np
import pytest

from analysis.bernstein import bernstein, cubic_basis, difference_matrix
from analysis.bezier import BezierPatch
from analysis.curvature import hole_curvature
from analysis.patch_fitting import conditions, fit_patches
from analysis.patches import hole_patches
from kirisurf.errors import ParameterError
from kirisurf.loops import Loops
from kirisurf.surroundings import surrounding_vertices
from tests.analysis.patterns import NAMES, in_space, regular

# B_0 ... B_3 at 1/4, and their derivatives: 27, 27, 9, 1 over 64; -27, 9, 15, 3 over 16; 72, -120, 24, 24 over 16
QUARTER = [
    [Fraction(27, 64), Fraction(27, 64), Fraction(9, 64), Fraction(1, 64)],
    [Fraction(-27, 16), Fraction(9, 16), Fraction(15, 16), Fraction(3, 16)],
    [Fraction(72, 16), Fraction(-120, 16), Fraction(24, 16), Fraction(24, 16)],
    [Fraction(-6), Fraction(18), Fraction(-18), Fraction(6)],
]


@pytest.mark.parametrize("order", range(4))
def test_cubic_basis_at_a_quarter_is_exact(order):
    assert cubic_basis(np.array(0.25), order).tolist() == [float(value) for value in QUARTER[order]]


def test_basis_sums_to_one_and_derivatives_to_zero():
    t = np.linspace(-0.5, 1.5, 9)
    assert bernstein(t).sum(axis=1) == pytest.approx(np.ones(9))
    for order in (1, 2, 3):
        assert cubic_basis(t, order).sum(axis=1) == pytest.approx(np.zeros(9), abs=1e-13)


def test_basis_derivatives_have_taylor_slope_two():
    t, direction = 0.3, 1.0
    for order in range(3):
        errors = []
        for h in (1e-2, 5e-3, 2.5e-3):
            exact = cubic_basis(np.array(t), order) + h * direction * cubic_basis(np.array(t), order + 1)
            errors.append(np.abs(cubic_basis(np.array(t + h), order) - exact).max())
        if order < 2:
            assert np.log2(errors[0] / errors[2]) / 2 == pytest.approx(2, abs=0.05)
        else:
            assert max(errors) <= 1e-13


def test_third_differences_vanish_on_quadratics():
    i = np.arange(4.0)
    assert difference_matrix(4, 3) @ np.stack([i**0, i, i**2], axis=1) == pytest.approx(np.zeros((1, 3)))
    assert (difference_matrix(4, 3) @ i**3).item() == 6


def test_patch_reproduces_a_bicubic_polynomial():
    # control points of u^3 + 2 u v^2 - v: blossoms of the monomials at the corners
    u, u3 = np.arange(4) / 3, np.array([0.0, 0, 0, 1])
    v, v2 = np.arange(4) / 3, np.array([0.0, 0, 1 / 3, 1])
    net = u3[:, None] + 2 * u[:, None] * v2 - v
    patch = BezierPatch(np.stack([np.broadcast_to(u[:, None], (4, 4)), np.broadcast_to(v, (4, 4)), net], axis=2)[None])
    s, t = np.random.default_rng(0).uniform(size=(2, 1, 7))
    expected = np.stack([s, t, s**3 + 2 * s * t**2 - t], axis=2)
    assert patch.evaluate(s, t) == pytest.approx(expected)
    assert patch.derivative(s, t, 1, 1)[..., 2] == pytest.approx(4 * t)
    assert patch.derivative(s, t, 2, 0)[..., 2] == pytest.approx(6 * s)
    assert patch.derivative(s, t, 0, 1)[..., 2] == pytest.approx(4 * s * t - 1)
    assert patch.derivative(s, t, 1, 2)[..., 2] == pytest.approx(np.full((1, 7), 4.0))


@pytest.mark.parametrize("n", [9, 12, 18])
def test_quadratics_are_fitted_exactly_whatever_the_smoothing(n):
    rng = np.random.default_rng(n)
    uv = rng.uniform(size=(n, 2))
    quadratic = 1 + uv[:, 0] - 3 * uv[:, 1] + 2 * uv[:, 0] ** 2 + uv[:, 0] * uv[:, 1] - uv[:, 1] ** 2
    for smoothing in (1e-6, 1e-3, 1e3):
        net = fit_patches(quadratic[:, None], uv, Loops.from_lists([np.arange(n)]), smoothing)
        s, t = rng.uniform(size=(2, 1, 20))
        patch = BezierPatch(np.concatenate([net, net, net], axis=3))
        expected = 1 + s - 3 * t + 2 * s**2 + s * t - t**2
        assert patch.evaluate(s, t)[..., 0] == pytest.approx(expected, abs=1e-8)


def test_points_enough_for_a_bicubic_are_met_as_smoothing_vanishes():
    u, v = (q.ravel() for q in np.meshgrid(np.linspace(0, 1, 5), np.linspace(0, 1, 5)))
    values = u**3 * v**3 - v**3
    net = fit_patches(values[:, None], np.stack([u, v], axis=1), Loops.from_lists([np.arange(25)]), 1e-14)
    patch = BezierPatch(np.concatenate([net] * 3, axis=3))
    assert patch.evaluate(u[None], v[None])[0, :, 0] == pytest.approx(values, abs=1e-9)


def test_holes_of_the_quad_pattern_have_twelve_vertices_and_face_the_front(flat_design, rotation):
    design = flat_design(3, 2)
    around = surrounding_vertices(design.tessellation)
    assert set(around.sizes) == {12}
    assert len(around) == len(design.tessellation.holes) == 5 * 3
    holes = hole_patches(design.deployed @ rotation.T, design.tessellation)
    s = np.full((len(around), 1), 0.5)
    normal = np.cross(holes.patches.derivative(s, s, 1, 0), holes.patches.derivative(s, s, 0, 1))[:, 0]
    assert normal / np.linalg.norm(normal, axis=1)[:, None] == pytest.approx(np.tile(rotation[:, 2], (15, 1)))
    assert not holes.ill_conditioned.any()
    assert holes.residuals == pytest.approx(np.zeros(15), abs=1e-12)


def test_samples_over_quad_holes_lie_on_the_surface_and_end_at_the_corners(flat_design):
    tessellation = flat_design(3, 3).tessellation
    x, y = (flat_design(3, 3).deployed[:, :2] * 0.1).T
    points = np.stack([x, y, 0.4 * x * x - x * y + 0.2 * y * y], axis=1)
    grid = hole_patches(points, tessellation).sample(5)
    assert grid.shape == (25, 5, 5, 3)
    around = grid[:, [0, -1, -1, 0], [0, 0, -1, -1]]
    middle = np.stack([points[hole].mean(axis=0) for hole in tessellation.holes])
    # a patch over its own tilted plane is no graph of a quadratic over x, y: equal up to higher order
    height = 0.4 * grid[..., 0] ** 2 - grid[..., 0] * grid[..., 1] + 0.2 * grid[..., 1] ** 2
    assert grid[..., 2] == pytest.approx(height, abs=2e-3)
    assert around == pytest.approx(np.stack([points[hole] for hole in tessellation.holes]), abs=2e-3)
    assert grid[:, 2, 2, :2] == pytest.approx(middle[:, :2], abs=2e-3)


def test_samples_of_flat_quad_holes_are_the_bilinear_blend_of_their_corners(flat_design):
    design = flat_design(2, 2)
    grid = hole_patches(design.deployed, design.tessellation).sample(3)
    for hole, patch in zip(design.tessellation.holes, grid, strict=True):
        a, b, c, d = design.deployed[hole]
        rows = [[a, (a + d) / 2, d], [(a + b) / 2, (a + b + c + d) / 4, (c + d) / 2], [b, (b + c) / 2, c]]
        assert patch == pytest.approx(np.array(rows), abs=1e-12)


def test_no_samples_for_flagged_holes(flat_design):
    holes = hole_patches(flat_design(2, 2).deployed, flat_design(2, 2).tessellation)
    flagged = replace(holes, ill_conditioned=np.arange(len(holes.patches)) == 3)
    assert np.isnan(flagged.sample(4)).all(axis=(1, 2, 3)).tolist() == [k == 3 for k in range(len(holes.patches))]
    with pytest.raises(ParameterError, match="at least 2"):
        holes.sample(1)


@pytest.mark.parametrize("name", ["kagome", "hexagon", "islamic-triangle", "right-triangles"])
def test_samples_over_other_polygons_reach_from_the_center_to_every_corner(name):
    pattern = regular(name)
    points = in_space(pattern.deployed)
    grid = hole_patches(points, pattern).sample(4)
    assert grid.shape == (len(pattern.holes), 4, 2 * pattern.holes.sizes.max() + 1, 3)
    for hole, patch in zip(pattern.holes, grid, strict=True):
        corners = points[hole]
        assert patch[0] == pytest.approx(np.broadcast_to(corners.mean(axis=0), patch[0].shape), abs=1e-9)
        apart = np.linalg.norm(patch[-1][:, None] - corners, axis=2)
        assert apart.min(axis=0).max() <= 1e-9
        assert patch[-1][0] == pytest.approx(patch[-1][-1])
        # the rim of the grid is the polygon: points between the corners lie on its sides
        length = np.linalg.norm(np.diff(patch[-1], axis=0), axis=1).sum()
        assert length == pytest.approx(np.linalg.norm(np.roll(corners, -1, axis=0) - corners, axis=1).sum())


GRAPHS = {
    "sphere": (lambda x, y: np.sqrt(4 - x * x - y * y), lambda x, y: 0 * x + 0.25),
    "paraboloid": (lambda x, y: 0.5 * (x * x + y * y), lambda x, y: (1 + x * x + y * y) ** -2.0),
    "hypar": (lambda x, y: 0.5 * x * y, lambda x, y: -0.25 * (1 + 0.25 * (x * x + y * y)) ** -2.0),
}


def _relative_error(name: str, graph: str, n: int) -> tuple[float, float]:
    """Median error of K at the hole centers over the median |K|, and the share of flagged holes."""
    height, exact = GRAPHS[graph]
    pattern = regular(name, n)
    flat = pattern.deployed - pattern.deployed.mean(axis=0)
    flat = 0.9 * flat / np.abs(flat).max()
    holes = hole_patches(np.column_stack([flat, height(*flat.T)]), pattern)
    found = hole_curvature(holes)
    truth = exact(*found.centers[:, :2].T)
    return float(np.median(np.abs(found.gaussian - truth)) / np.median(np.abs(truth))), holes.ill_conditioned.mean()


@pytest.mark.parametrize("graph", GRAPHS)
@pytest.mark.parametrize("name", NAMES)
def test_curvature_of_every_pattern_on_a_surface_is_of_second_order(name, graph):
    (coarse, flagged), (fine, still) = (_relative_error(name, graph, n) for n in (8, 16))
    assert flagged == still == 0
    assert fine <= 3e-3
    # a paraboloid z = xy/2 is nearly met by a patch whatever its size: then the smoothing is what is left
    assert np.log2(coarse / fine) >= 1.8 or fine <= 5e-5


@pytest.mark.parametrize("name", NAMES)
def test_holes_of_trimmed_sheets_are_closed_and_have_their_tiles_all_round(name):
    pattern = regular(name, 6, trimmed=True)
    holes = hole_patches(in_space(pattern.deployed), pattern)
    assert not holes.ill_conditioned.any()
    whole = set(surrounding_vertices(regular(name, 6)).sizes.tolist())
    assert set(surrounding_vertices(pattern).sizes.tolist()) <= whole
    # notches of the rim are no holes: no hole has a vertex pair that is a side of the outline alone
    outline = {tuple(e) for e in np.stack([pattern.outline, np.roll(pattern.outline, -1)], axis=1).tolist()}
    assert not outline & {tuple(e) for e in pattern.holes.edges[:, ::-1].tolist()}


def test_points_on_a_conic_are_ill_conditioned():
    t = np.arange(12) / 12 * 2 * np.pi
    circle = np.stack([np.cos(t), np.sin(t)])
    grid = np.stack([q.ravel() for q in np.meshgrid(np.linspace(-1, 1, 4), np.linspace(-1, 1, 3))])
    x, y = np.stack([circle, grid], axis=1)
    found = conditions(np.stack([np.ones_like(x), x, y, x * x, x * y, y * y], axis=2))
    assert found[0] > 1e12
    assert found[1] < 20
    assert np.isinf(conditions(np.ones((3, 5, 6)))).all()


def test_folded_tiles_are_flagged_and_their_value_kept(flat_design):
    design = flat_design(2, 2, np.pi / 4)
    points = np.array(design.deployed)
    corner = design.tiles[0]
    shared = np.bincount(design.tiles.indices)[corner] > 1
    # fold the corner tile backwards about its two hinges
    a, b = points[corner[shared]]
    axis = (b - a) / np.linalg.norm(b - a)
    relative = points[corner] - a
    along = (relative @ axis)[:, None] * axis
    across = relative - along
    points[corner] = a + along + np.cos(2.6) * across + np.sin(2.6) * np.cross(axis, across)
    holes = hole_patches(points, design.tessellation)
    touched = [int(0 in tiles) for tiles in design.tessellation.hole_tiles]
    assert holes.ill_conditioned.astype(int).tolist() == touched
    assert np.isfinite(holes.patches.nets).all()
