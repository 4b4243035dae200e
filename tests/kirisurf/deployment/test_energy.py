"""The energy of a sheet: derivatives by their Taylor slopes, invariances, and what is known by hand."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.sparse import tril, triu
from scipy.spatial.transform import Rotation

from kirisurf.deployment.elements import SOFT, Contacts
from kirisurf.deployment.energy import Energy
from kirisurf.deployment.springs import energy_of
from kirisurf.derive import derive_tessellation
from kirisurf.errors import ParameterError, UnusableError
from kirisurf.loops import Loops
from kirisurf.pattern import tile_pattern
from kirisurf.unit_cells import find_cell
from tests.kirisurf.deployment.patterns import bumpy, kagome, lifted, squares

SHEETS = ("squares", "kagome", "islamic-triangle")
every_sheet = pytest.mark.parametrize("name", SHEETS)
every_dimension = pytest.mark.parametrize("dimension", [2, 3])


def sheet(name: str, dimension: int, torsion: float = 0.3) -> tuple[Energy, np.ndarray]:
    """Energy and bumpy points: triangles, quadrilaterals, and tiles with 18 corners."""
    if name == "islamic-triangle":
        cell = find_cell(name)
        tessellation = tile_pattern(cell, np.ones((1, 1, len(cell.tiles)), bool))
        points = 0.9 * tessellation.contracted + 0.1 * tessellation.deployed
    else:
        tessellation = squares() if name == "squares" else kagome()
        points = tessellation.deployed
    energy = energy_of(tessellation, tessellation.contracted, torsion, dimension)
    return energy, bumpy(points if dimension == 2 else lifted(points), 0.03 * energy.length)


@every_sheet
@every_dimension
def test_derivatives_have_the_slopes_of_taylor(name: str, dimension: int) -> None:
    energy, points = sheet(name, dimension)
    direction = energy.length * np.random.default_rng(1).standard_normal(points.shape)
    here = energy.evaluate(points)
    assert here.value == pytest.approx(energy.value(points), rel=1e-13)
    sizes = np.array([1e-3, 1e-4])
    first = np.array(
        [energy.value(points + h * direction) - here.value - h * (here.gradient * direction).sum() for h in sizes]
    )
    second = first - 0.5 * sizes**2 * (direction * energy.product(here, direction)).sum()
    slopes = [float(np.log10(abs(rest[0] / rest[1]))) for rest in (first, second)]
    assert slopes[0] == pytest.approx(2.0, abs=0.05)
    assert slopes[1] == pytest.approx(3.0, abs=0.15)


@every_sheet
@every_dimension
def test_the_matrix_is_the_same_as_the_product(name: str, dimension: int) -> None:
    energy, points = sheet(name, dimension)
    here = energy.evaluate(points)
    order = np.random.default_rng(2).permutation(points.size).reshape(points.shape)
    stiffness = energy.stiffness(order)
    upper = stiffness.matrix(stiffness.numbers(here.bends), 0.5)
    assert not tril(upper, -1).nnz
    matrix = upper + triu(upper, 1).T
    shift = np.random.default_rng(3).standard_normal(points.shape)
    packed = np.empty(points.size)
    packed[order.ravel()] = shift.ravel()
    expected = energy.product(here, shift) + 0.5 * shift
    np.testing.assert_allclose((matrix @ packed)[order], expected, atol=1e-11 * np.abs(expected).max())


@every_dimension
def test_held_coordinates_have_no_row(dimension: int) -> None:
    energy, points = sheet("squares", dimension)
    free = np.arange(len(points)) % 3 > 0
    some, every = np.full(points.shape, -1), np.arange(points.size).reshape(points.shape)
    some[free] = np.arange(free.sum() * dimension).reshape(-1, dimension)
    bends = energy.evaluate(points).bends
    part, whole = (s.matrix(s.numbers(bends)).toarray() for s in map(energy.stiffness, (some, every)))
    rows = every[free].ravel()
    np.testing.assert_allclose(part, whole[np.ix_(rows, rows)], atol=1e-13)


@every_sheet
@every_dimension
def test_rigid_motions_cost_nothing_and_forces_balance(name: str, dimension: int) -> None:
    energy, points = sheet(name, dimension)
    turn = (
        Rotation.random(random_state=4).as_matrix() if dimension == 3 else Rotation.from_rotvec([0, 0, 2.0]).as_matrix()
    )
    turn = turn[:dimension, :dimension]
    moved = points @ turn.T + np.arange(1.0, dimension + 1)
    assert energy.value(moved) == pytest.approx(energy.value(points), rel=1e-11)
    force = energy.gradient(points)
    np.testing.assert_allclose(energy.gradient(moved), force @ turn.T, atol=1e-10 * np.abs(force).max())
    np.testing.assert_allclose(force.sum(axis=0), 0, atol=1e-12)
    moments = points.T @ force
    np.testing.assert_allclose(moments, moments.T, atol=1e-12)


@every_dimension
def test_the_unit_of_length_does_not_matter(dimension: int) -> None:
    tessellation = squares()
    points = bumpy(tessellation.deployed if dimension == 2 else lifted(tessellation.deployed))
    values = [
        energy_of(tessellation, scale * tessellation.contracted, 0.2, dimension).value(scale * points)
        for scale in (1.0, 1e3)
    ]
    assert values[1] == pytest.approx(values[0], rel=1e-12)


def test_in_the_plane_space_has_the_same_energy() -> None:
    tessellation = squares()
    flat = bumpy(tessellation.deployed)
    plane, space = (energy_of(tessellation, tessellation.contracted, 0.2, d) for d in (2, 3))
    assert space.value(lifted(flat)) == pytest.approx(plane.value(flat), rel=1e-12)
    np.testing.assert_allclose(space.gradient(lifted(flat))[:, :2], plane.gradient(flat), atol=1e-12)


def test_a_fold_by_hand() -> None:
    # one corner of a square of side 1/2 lifted by h: the tetrahedron has the height h over half of the square
    square = squares(1, 1, 0.0)
    energy = energy_of(square, square.contracted, 0.0, 3)
    points = lifted(square.contracted)
    height = 1e-3
    points[square.tiles[0][0], 2] = height
    assert energy.parts(points)[2] == pytest.approx((height / 0.5) ** 2 / len(energy.rods.stencil), rel=1e-9)


def test_an_angle_beyond_half_a_turn_goes_on_growing() -> None:
    square = squares(1, 1)
    hinge, first, second = energy_of(square, square.contracted, 0.0, 2).hinges.stencil[0]
    energy = energy_of(square, square.contracted, 0.0, 2)
    points = np.array(square.deployed)
    points[first] = points[hinge] + [1.0, 0.0]
    for angle in (-1.0, 0.0, 1e-9, 1.0, np.pi, 4.0):
        points[second] = points[hinge] + [np.cos(angle), np.sin(angle)]
        assert energy.openings(points)[0] == pytest.approx(angle, abs=1e-15)


@pytest.mark.parametrize("angle", [0.0, 1e-8, 1e-3, 0.0299999, 0.0300001, 2.0])
def test_small_angles_in_space_are_smooth(angle: float) -> None:
    square = squares(1, 1)
    energy = energy_of(square, square.contracted, 1.0, 3)
    flat = energy_of(square, square.contracted, 1.0, 2, contact=False)
    hinge, first, second = energy.hinges.stencil[0]
    points = lifted(square.deployed)
    points[first] = points[hinge] + [1.0, 0.0, 0.0]
    points[second] = points[hinge] + [np.cos(angle), np.sin(angle), 0.0]
    # the planar angle has exact derivatives of its own
    np.testing.assert_allclose(energy.gradient(points)[:, :2], flat.gradient(points[:, :2]), atol=1e-11)
    matrices = []
    for one, at in ((energy, points), (flat, points[:, :2])):
        numbers = np.full(at.shape, -1)
        numbers[:, :2] = np.arange(2 * len(at)).reshape(-1, 2)
        stiffness = one.stiffness(numbers)
        matrices.append(stiffness.matrix(stiffness.numbers(one.evaluate(at).bends)).toarray())
    np.testing.assert_allclose(matrices[0], matrices[1], atol=1e-8)


@pytest.mark.parametrize("over", [0.3 * SOFT, 0.999 * SOFT, 1.001 * SOFT, 40 * SOFT])
def test_contacts_resist_overlap_alone_and_smoothly(over: float) -> None:
    square = squares(1, 1, 0.5)
    contact = energy_of(square, square.contracted, 0.0, 2).bounds
    assert isinstance(contact, Contacts)
    u = np.array([[0.8], [0.1]])

    def at(angle: float) -> np.ndarray:
        turn = np.array([[np.cos(angle), -np.sin(angle)], [np.sin(angle), np.cos(angle)]])
        return np.stack([u, 1.7 * turn @ u])

    assert contact.values(at(over)).max() == 0.0
    # its second derivative grows evenly from 0 to 2 over the width SOFT, and stays
    bends = 2 * np.minimum(np.linspace(0, over, 20001) / SOFT, 1.0)
    expected_value = np.trapezoid(np.linspace(over, 0, 20001) * bends, np.linspace(0, over, 20001))
    assert contact.values(at(-over))[0] == pytest.approx(expected_value, rel=1e-6)
    here, along = at(-over), np.random.default_rng(0).standard_normal((2, 2, 1))
    (slope, bends), small = contact.derivatives(here), 1e-5
    first, second = (contact.derivatives(here + sign * small * along)[0] for sign in (1, -1))
    rise = contact.values(here + small * along) - contact.values(here - small * along)
    np.testing.assert_allclose(rise / (2 * small), [(slope * along).sum()], atol=1e-6)
    expected = np.zeros((2, 2))
    for (i, j), bend in bends.items():
        expected[i] += bend[:, :, 0] @ along[j, :, 0]
        if i != j:
            expected[j] += bend[:, :, 0].T @ along[i, :, 0]
    np.testing.assert_allclose(((first - second) / (2 * small))[:, :, 0], expected, atol=1e-5)


@pytest.mark.parametrize("torsion", [-1e-9, np.nan, np.inf])
def test_a_lambda_that_is_none_is_refused(torsion: float) -> None:
    with pytest.raises(ParameterError, match="lambda"):
        energy_of(squares(), squares().contracted, torsion)


def test_sheets_that_have_no_energy_are_refused() -> None:
    tessellation = squares()
    with pytest.raises(ParameterError, match="dimension: expected 2 or 3, got 4"):
        energy_of(tessellation, tessellation.contracted, dimension=4)
    with pytest.raises(UnusableError, match="expected shape"):
        energy_of(tessellation, tessellation.contracted[1:])
    corners = np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [1.0, 1.0]])
    twice = derive_tessellation(corners, corners, Loops.from_lists([[0, 1, 2, 3]]), np.arange(4))
    with pytest.raises(UnusableError, match="two in one place"):
        energy_of(twice, corners)
