"""The input file, read back with a reader of its own: mesh, sets, material, and the way that the rim takes."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.spatial.transform import Rotation

import kirisurf
from kirisurf.deployment import deploy_run
from kirisurf.elastic.calculix import Material
from kirisurf.elastic.input_file import elastic_text, export_elastic, placed_states
from kirisurf.elastic.sheet_mesh import sheet_mesh
from kirisurf.errors import OutputError, ParameterError, UnusableError
from kirisurf.pattern import quad_pattern
from tests.kirisurf.elastic import reading

PAPER = Material(1000.0, 0.3, 0.02)


@pytest.fixture(scope="module")
def sheet():
    pattern = quad_pattern(2, 1)
    return pattern, np.array(pattern.contracted)


@pytest.fixture(scope="module")
def text(sheet):
    pattern, flat = sheet
    return elastic_text(
        pattern, flat, [flat, 0.5 * (flat + pattern.deployed), pattern.deployed], PAPER, 0.05, units="mm"
    )


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    return kirisurf.fit("hypar", cells=(1, 2)).save(tmp_path_factory.mktemp("run") / "hypar", pictures=False)


def test_the_mesh_comes_back(sheet, text):
    mesh = sheet_mesh(*sheet, 0.05)
    nodes, elements = reading.mesh(text)
    assert nodes[:, :2] == pytest.approx(mesh.nodes, abs=1e-12)
    assert not nodes[:, 2].any()
    assert np.array_equal(elements, mesh.triangles)
    corner = nodes[elements[:, :3], :2]
    u, v = corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0]
    areas = 0.5 * (u[:, 0] * v[:, 1] - u[:, 1] * v[:, 0])
    assert areas.min() > 0
    assert areas.sum() == pytest.approx(2.0, rel=1e-10)  # two cells of area 1


def test_sets_are_tiles_vertices_and_ligaments(sheet, text):
    pattern, flat = sheet
    mesh = sheet_mesh(pattern, flat, 0.05)
    elements = reading.sets(text, "ELSET")
    assert sorted(elements) == sorted(f"TILE_{k}" for k in range(pattern.n_tiles))
    assert sorted(np.concatenate(list(elements.values()))) == list(range(len(mesh.triangles)))
    nodes = reading.sets(text, "NSET")
    assert nodes["VERTICES"].tolist() == list(range(pattern.n_vertices))
    assert np.array_equal(np.sort(nodes["DRIVEN"]), np.unique(pattern.outline))
    for k, ligament in enumerate(mesh.ligaments):
        assert np.array_equal(nodes[f"LIGAMENT_{k}"], ligament)


def test_numbers_and_lines_are_as_short_as_the_solver_reads_them(text):
    for line in text.splitlines():
        assert line.isascii()
        if not line.startswith("*"):
            assert len(line) <= 132
            assert all(len(field.strip()) <= 20 for field in line.split(","))


def test_the_material_is_that_of_small_strain(text):
    blocks = {name: (options, rows) for name, options, rows in reading.blocks(text)}
    options, [[first, second]] = blocks["HYPERELASTIC"]
    assert "NEO HOOKE" in options
    shear, bulk = 2 * float(first), 2 / float(second)
    assert 9 * bulk * shear / (3 * bulk + shear) == pytest.approx(1000.0, rel=1e-12)
    assert (3 * bulk - 2 * shear) / (6 * bulk + 2 * shear) == pytest.approx(0.3, rel=1e-12)
    assert float(blocks["SHELL SECTION"][1][0][0]) == 0.02
    assert "NLGEOM" in blocks["STEP"][0]


def test_forces_are_asked_for_at_every_increment(text):
    """The solver takes the last frequency of a step for all prints: one alone would leave a few forces to integrate."""
    prints = [options for name, options, _ in reading.blocks(text) if name == "NODE PRINT"]
    assert len(prints) == 4 and not any("FREQUENCY" in options for options in prints)


def test_driven_nodes_end_every_step_where_the_states_have_them(sheet, text):
    pattern, flat = sheet
    nodes, _ = reading.mesh(text)
    way = placed_states(flat, [flat, 0.5 * (flat + pattern.deployed), pattern.deployed])
    steps = reading.drives(text)
    assert len(steps) == 2
    for state, step in zip(way, steps, strict=True):
        assert len(step) == 3 * len(np.unique(pattern.outline))
        for (node, axis), value in step.items():
            assert nodes[node, axis] + value == pytest.approx(state[node, axis], abs=1e-12)


def test_units_and_what_to_do_are_said_in_comments(text):
    comments = [line for line in text.splitlines() if line.startswith("**")]
    said = " ".join(comments)
    assert "lengths in mm" in said
    assert "ccx -i NAME" in said
    assert "0.05 to 0.05 wide" in said


def test_states_are_placed_by_one_rigid_motion():
    pattern = quad_pattern(2, 2)
    flat = np.array(pattern.contracted)
    bowl = np.c_[pattern.deployed, 0.1 * (pattern.deployed**2).sum(axis=1)]
    expected = placed_states(flat, [np.c_[flat, np.zeros(len(flat))], bowl])
    turn = Rotation.from_rotvec([0.4, -1.0, 2.0])
    moved = [turn.apply(state) + np.array([5, 6, 7]) for state in (np.c_[flat, np.zeros(len(flat))], bowl)]
    assert placed_states(flat, np.array(moved))[0] == pytest.approx(expected[0], abs=1e-12)


def test_corners_are_four_vertices_and_nothing_else_is_moved(sheet):
    pattern, flat = sheet
    steps = reading.drives(elastic_text(pattern, flat, [flat, pattern.deployed], PAPER, 0.05, "corners"))
    assert len({node for node, _ in steps[-1]}) == 4


def test_a_run_is_written(run, tmp_path):
    written = export_elastic(run, tmp_path / "sheet.inp", thickness=0.01, steps=3)
    text = written.read_text()
    steps = reading.drives(text)
    assert len(steps) == 3
    nodes, _ = reading.mesh(text)
    end = {node: nodes[node] for node, _ in steps[-1]}
    for (node, axis), value in steps[-1].items():
        end[node] = end[node] + value * np.eye(3)[axis]
    places = np.array(list(end.values()))
    wanted = run.deployed[list(end)]
    apart = [np.linalg.norm(points[:, None] - points[None], axis=2) for points in (places, wanted)]
    assert apart[0] == pytest.approx(apart[1], abs=1e-9)  # the rim of the deployed sheet, moved rigidly
    again = export_elastic(run, tmp_path / "again.inp", thickness=0.01, steps=3)
    assert again.read_bytes() == written.read_bytes()


def test_the_rim_goes_through_the_states_of_a_computed_path(run, tmp_path):
    """Distances between driven vertices are those of every state; that of the default way at the end."""
    path = deploy_run(run, torsion=0.0, steps=6).paths[0]
    text = export_elastic(run, tmp_path / "path.inp", thickness=0.01, states=path.points).read_text()
    nodes, _ = reading.mesh(text)
    steps = reading.drives(text)
    assert len(steps) == 6
    apart = []
    for state, step in zip(path.points[1:], steps, strict=True):
        which = sorted({node for node, _ in step})
        places = np.array([nodes[node] + [step[node, axis] for axis in range(3)] for node in which])
        apart.append(np.linalg.norm(places[:, None] - places[None], axis=2))
        assert apart[-1] == pytest.approx(np.linalg.norm(state[which][:, None] - state[which][None], axis=2), abs=1e-9)
    usual = reading.drives(export_elastic(run, tmp_path / "usual.inp", thickness=0.01, steps=1).read_text())[-1]
    assert list(usual.values()) == pytest.approx(list(steps[-1].values()), abs=1e-9)


def test_a_planar_path_keeps_the_sheet_in_its_plane(tmp_path):
    run = kirisurf.fit("circle", cells=(1, 1)).save(tmp_path / "run", pictures=False)
    path = deploy_run(run, torsion=0.0, steps=4).paths[0]
    steps = reading.drives(export_elastic(run, tmp_path / "a.inp", thickness=0.01, states=path.points).read_text())
    assert len(steps) == 4
    assert all(value == 0 for step in steps for (_, axis), value in step.items() if axis == 2)


def test_any_vertices_may_be_moved(run, tmp_path):
    written = export_elastic(run, tmp_path / "a.inp", thickness=0.01, steps=1, drive=[5, 0, 5])
    nodes = reading.mesh(written.read_text())[0]
    moved = {node for node, _ in reading.drives(written.read_text())[0]}
    assert nodes[sorted(moved), :2] == pytest.approx(run.contracted[[0, 5]], abs=1e-9)
    with pytest.raises(ParameterError, match="drive"):
        export_elastic(run, tmp_path / "b.inp", thickness=0.01, drive="free")
    with pytest.raises(ParameterError, match="numbers of vertices"):
        export_elastic(run, tmp_path / "b.inp", thickness=0.01, drive=[10**6])


def test_finer_ways_end_at_the_same_place(run, tmp_path):
    ends = [
        reading.drives(export_elastic(run, tmp_path / "sheet.inp", thickness=0.01, steps=steps).read_text())[-1]
        for steps in (1, 4)
    ]
    assert list(ends[0].values()) == pytest.approx(list(ends[1].values()), abs=1e-9)


@pytest.mark.parametrize(
    ("changed", "said"),
    [
        ({"thickness": 0.0}, "thickness"),
        ({"thickness": float("nan")}, "thickness"),
        ({"young": -1.0}, "young"),
        ({"poisson": 0.5}, "poisson"),
        ({"hinge_width": 1e3}, "--hinge-width"),
        ({"drive": "wind"}, "drive"),
        ({"steps": 0}, "steps"),
        ({"refinement": 0}, "refinement"),
    ],
)
def test_wrong_values_are_named_and_nothing_is_written(run, tmp_path, changed, said):
    with pytest.raises(ParameterError, match=said):
        export_elastic(run, tmp_path / "sheet.inp", **{"thickness": 0.01, **changed})
    assert not list(tmp_path.iterdir())


def test_wrong_names_and_states_are_named(run, tmp_path):
    with pytest.raises(ParameterError, match=r"ends in \.inp"):
        export_elastic(run, tmp_path / "sheet.txt", thickness=0.01)
    with pytest.raises(OutputError):
        export_elastic(run, tmp_path / "no" / "sheet.inp", thickness=0.01, steps=1)
    with pytest.raises(UnusableError, match="flat sheet first"):
        export_elastic(run, tmp_path / "sheet.inp", thickness=0.01, states=[run.deployed, run.deployed])
    with pytest.raises(UnusableError, match="at least one more"):
        export_elastic(run, tmp_path / "sheet.inp", thickness=0.01, states=[run.deployed])


def test_it_is_a_format_of_the_export(run, tmp_path):
    making = kirisurf.Fabrication(thickness=0.01, hinge_width=0.02, units="cm")
    written = kirisurf.export(run, tmp_path / "sheet.inp", making=making).read_text()
    assert "lengths in cm" in written
    assert "0.02 wide" in written
    with pytest.raises(ParameterError, match="--thickness"):
        kirisurf.export(run, tmp_path / "other.inp")
    with pytest.raises(ParameterError, match="--state"):
        kirisurf.export(run, tmp_path / "other.inp", state="deployed", making=making)
