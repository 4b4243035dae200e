"""CalculiX on what the writer writes: beams, one hinge, and a sheet pulled open, against formulas."""

from __future__ import annotations

import os
import shutil
import subprocess

import numpy as np
import pytest

from kirisurf.derive import derive_tessellation
from kirisurf.elastic.calculix import Drive, Material, calculix_text
from kirisurf.elastic.driven_work import DrivenWork, read_driven_work
from kirisurf.elastic.grading import Grading
from kirisurf.elastic.input_file import elastic_text
from kirisurf.elastic.polygon_mesh import polygon_mesh
from kirisurf.elastic.sheet_mesh import SheetMesh, _quadratic, sheet_mesh
from kirisurf.loops import Loops
from kirisurf.motion import motion_of
from kirisurf.pattern import tile_pattern
from kirisurf.unit_cell import quad_cell

SOLVER = shutil.which("ccx")
pytestmark = pytest.mark.skipif(SOLVER is None, reason="CalculiX (the program ccx) is not installed")

DEEP_CRACK = 1 / 15.8
"""M = E t w^2 / 15.8 theta: the ligament of width w beside a deep crack (K = 3.975 M / w^1.5, Tada, Paris, Irwin)."""


def solved(folder, text: str) -> DrivenWork:
    (folder / "sheet.inp").write_text(text)
    threads = {**os.environ, "OMP_NUM_THREADS": "1"}
    done = subprocess.run([SOLVER, "-i", "sheet"], cwd=folder, capture_output=True, text=True, env=threads, check=False)
    assert "Job finished" in done.stdout, done.stdout[-2000:]
    return read_driven_work(folder / "sheet.dat")


def strip(length: float, width: float, root: float, size: float) -> tuple[SheetMesh, np.ndarray]:
    """A strip along x from -root to length, and the nodes of its root."""
    corners = np.array(
        [[-root, 0], [0, 0], [length, 0], [length, 0.5 * width], [length, width], [0, width], [-root, width]]
    )
    grading = Grading(np.zeros((0, 2)), np.zeros(0), 0.5, size)
    loop: list[np.ndarray] = []
    for a, b in zip(corners, np.roll(corners, -1, axis=0), strict=True):
        loop += [a, *(a + grading.divided(a, b)[:, None] * (b - a))]
    nodes, triangles = _quadratic(*polygon_mesh(np.array(loop), grading))
    none = np.zeros(0, np.int64)
    mesh = SheetMesh(
        nodes, triangles, np.zeros(len(triangles), np.int64), none, np.zeros((0, 2), np.int64), (), np.zeros(0)
    )
    used = np.flatnonzero(nodes[:, 0] <= 1e-12)
    return mesh, used


@pytest.mark.parametrize("axis", [1, 2])
def test_a_cantilever_bends_as_the_beam_does(tmp_path, axis):
    # along axis 1 in its plane, as ligaments do, along axis 2 out of it; the formula knows no lateral contraction
    length, width, thickness, young, shift = 1.0, 0.1, 0.02, 1000.0, 1e-4
    mesh, root = strip(length, width, 0.1, 0.03)
    tip = int(np.argmin(np.linalg.norm(mesh.nodes - [length, 0.5 * width], axis=1)))
    shifts = np.full((1, len(root) + 1, 3), np.nan)
    shifts[0, :-1] = 0.0
    shifts[0, -1, axis] = shift
    found = solved(
        tmp_path, calculix_text(mesh, Material(young, 0.0, thickness), Drive(np.r_[root, tip], shifts), (), 1)
    )
    depth, breadth = (width, thickness) if axis == 1 else (thickness, width)
    inertia, area = breadth * depth**3 / 12, breadth * depth
    shear = young / 2 * 5 / 6 * area
    expected = shift / (length**3 / (3 * young * inertia) + length / shear)
    # the root, held in its middle plane alone, gives a little
    assert found.forces[-1, -1, axis] == pytest.approx(expected, rel=0.03)
    assert found.work[-1] == pytest.approx(0.5 * expected * shift, rel=0.03)


def two_squares(width: float, refinement: int) -> tuple[SheetMesh, np.ndarray]:
    """Two unit squares with a slit between them, on one ligament at its lower end."""
    flat = np.array([[-1.0, 0], [0, 0], [0, 1], [-1, 1], [1, 0], [1, 1], [0, 1]])
    opened = flat.copy()
    opened[4:] = flat[4:] @ np.array([[np.cos(0.3), -np.sin(0.3)], [np.sin(0.3), np.cos(0.3)]])
    tiles = Loops.from_lists([[0, 1, 2, 3], [1, 4, 5, 6]])
    weld = np.array([0, 1, 2, 3, 4, 5, 2])
    pair = derive_tessellation(opened, flat, tiles, weld, np.array([[0, 0, 0], [0, 0, 1]]), "pair")
    return sheet_mesh(pair, flat, width, refinement), flat


def stiffness(folder, width: float, refinement: int, thickness: float = 0.05, turn: float = 1e-2) -> float:
    """Torsional stiffness of the ligament over E t w^2."""
    mesh, flat = two_squares(width, refinement)
    shifts = np.full((1, 3, 3), np.nan)
    shifts[0, :2] = 0.0
    shifts[0, 2, 1:] = -turn, 0.0
    drive = Drive(mesh.vertices[[0, 3, 4]], shifts)  # the left square is held, the right one turned by its corner
    found = solved(folder, calculix_text(mesh, Material(1000.0, 0.3, thickness), drive, (), 1))
    places = flat + found.vertices[-1][:, :2]
    side = places[5] - places[4]
    angle = float(np.arctan2(side[0], side[1]))
    return 2 * float(found.work[-1]) / angle**2 / (1000.0 * thickness * width**2)


def test_a_hinge_is_as_stiff_as_the_ligament_beside_a_deep_crack(tmp_path):
    found = [stiffness(tmp_path, 0.05, refinement) for refinement in (2, 4)]
    assert found[1] < found[0]  # from above, as displacement elements do
    assert found[1] == pytest.approx(DEEP_CRACK, rel=0.08)


def test_the_stiffness_of_a_hinge_grows_with_thickness_and_width_squared(tmp_path):
    base = stiffness(tmp_path, 0.1, 2)
    assert stiffness(tmp_path, 0.1, 2, thickness=0.01) == pytest.approx(base, rel=0.05)
    assert stiffness(tmp_path, 0.05, 2) == pytest.approx(base, rel=0.05)


def rotating_squares(ways: np.ndarray):
    """The mechanism of 2 x 2 tiles, and its states."""
    motion = motion_of(quad_cell())
    pattern = tile_pattern(motion.cell, np.ones((1, 1), bool))
    states = []
    for way in ways:
        lattice, stretch = motion.lattice(np.array([way]))[0], float(motion.stretch(np.array([way]))[0])
        corners = stretch * motion.corners(pattern.cells, np.full(pattern.n_tiles, way), lattice / stretch)
        points = np.zeros((pattern.n_vertices, 2))
        points[pattern.tiles.indices] = corners
        states.append(points)
    return pattern, states


def test_rotating_squares_pulled_open_follow_their_mechanism_and_cost_the_squared_angle(tmp_path):
    ways = np.array([0.0, 0.05, 0.1, 0.2])
    pattern, states = rotating_squares(ways)
    edge, width, thickness = 0.5, 0.05, 0.05
    text = elastic_text(pattern, states[0], states, Material(1.0, 0.3, thickness), width, "corners", 2)
    found = solved(tmp_path, text)
    for shift, state in zip(found.vertices, states[1:], strict=True):
        assert np.abs(states[0] + shift[:, :2] - state).max() < 0.25 * width
        assert np.abs(shift[:, 2]).max() < 1e-9 * edge
    work = np.array([found.at(time) for time in (1.0, 2.0, 3.0)])
    slopes = np.diff(np.log(work)) / np.diff(np.log(ways[1:]))
    assert slopes == pytest.approx([2.0, 2.0], abs=0.1)
    # four ligaments, two of them pressed to turn about the vertices and not about their own middles
    angle = 0.5 * np.pi * ways[1:]
    ratio = 2 * work / (len(pattern.edge_pairs) * angle**2) / (thickness * width**2)
    assert (ratio > DEEP_CRACK).all()
    assert (ratio < 2.5 * DEEP_CRACK).all()


def test_the_energy_of_an_open_sheet_does_not_depend_on_the_way_there(tmp_path):
    """Along the mechanism and along straight lines, which squeeze the tiles: the material is elastic."""
    pattern, states = rotating_squares(np.linspace(0.0, 0.2, 3))
    straight = [states[0], 0.5 * (states[0] + states[-1]), states[-1]]
    work = []
    for name, way in (("turning", states), ("straight", straight)):
        (tmp_path / name).mkdir()
        text = elastic_text(pattern, states[0], way, Material(1.0, 0.3, 0.05), 0.05, "rim", 2)
        found = solved(tmp_path / name, text)
        assert len(found.times) >= 8 and len(found.vertices) == 2  # forces at every increment, vertices at every step
        work.append([found.at(1.0), found.at(2.0)])
    # half way, tiles of a straight rim are squeezed, and ligaments turn about other points
    assert abs(work[1][0] / work[0][0] - 1) > 0.1
    assert work[1][1] == pytest.approx(work[0][1], rel=5e-3)
