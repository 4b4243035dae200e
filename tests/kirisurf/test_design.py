"""The Python interface: any target in, meshes with fields out, nothing heavy imported before it is used."""

from __future__ import annotations

import shutil
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import kirisurf
from kirisurf.design import Design
from kirisurf.errors import ParameterError, UnreadableError, UnusableError
from kirisurf.formats import to_polydata, write_obj
from kirisurf.loops import Loops
from kirisurf.spec import FitSpec
from kirisurf.states import Step
from kirisurf.surface import Surface

ROOT = Path(__file__).resolve().parents[2]


@pytest.fixture(scope="module")
def bowl() -> Surface:
    return kirisurf.load("paraboloid", resolution=16)


@pytest.fixture(scope="module")
def design(bowl: Surface) -> Design:
    return kirisurf.fit((bowl.vertices, bowl.faces), cells=(2, 2))


def test_every_kind_of_target_gives_the_same_design(bowl: Surface, design: Design, tmp_path: Path) -> None:
    triangles = Loops(np.arange(0, 3 * len(bowl.faces) + 1, 3), bowl.faces.ravel())
    write_obj(tmp_path / "bowl.obj", bowl.vertices, triangles)
    mesh = to_polydata(bowl.vertices, triangles)
    plain = Surface.from_arrays(bowl.vertices, bowl.faces, "bowl")
    for target in (tmp_path / "bowl.obj", str(tmp_path / "bowl.obj"), mesh, plain):
        other = kirisurf.fit(target, cells=(2, 2))
        assert np.allclose(other.deployed_points, design.deployed_points, rtol=0, atol=1e-9), type(target)


def test_meshes_carry_the_named_fields(design: Design) -> None:
    deployed, contracted, holes = design.deployed, design.contracted, design.holes
    assert deployed.n_cells == contracted.n_cells == design.tessellation.n_tiles == 16
    assert holes.n_cells == len(design.tessellation.holes)
    assert deployed.points.dtype == np.float64 and np.array_equal(deployed.points, design.deployed_points)
    assert not contracted.points[:, 2].any()
    assert {"distance", "closure_gap"} <= set(deployed.point_data) and "planarity" in deployed.cell_data
    assert {"mean_curvature", "gaussian_curvature", "flag"} <= set(holes.cell_data)


def test_a_cell_file_is_needed_for_the_solve_alone(bowl: Surface, tmp_path: Path) -> None:
    own = tmp_path / "own.cell"
    shutil.copyfile(ROOT / "kirisurf" / "unit_cells" / "files" / "rotating-rectangles.cell", own)
    made = kirisurf.fit((bowl.vertices, bowl.faces), tessellation=str(own), cells=(2, 2))
    own.unlink()
    run = made.save(tmp_path / "run", pictures=False)
    assert run.result["certificate"] == pytest.approx(dict(made.certificate.rows), abs=1e-12)


def test_the_saved_target_of_a_mesh_in_memory_repeats_the_run(design: Design, tmp_path: Path) -> None:
    run = design.save(tmp_path / "run", pictures=False)
    assert run.spec.target == "./target.vtp"
    again = kirisurf.fit(tmp_path / "run" / "target.vtp", cells=(2, 2))
    assert np.array_equal(again.deployed_points, design.deployed_points)


def test_progress_and_stop_are_callbacks(bowl: Surface, capfd: pytest.CaptureFixture[str]) -> None:
    steps: list[Step] = []
    design = kirisurf.fit(bowl, cells=(2, 2), progress=steps.append, should_stop=lambda: len(steps) >= 2)
    assert design.status is kirisurf.Status.INTERRUPTED
    assert 2 <= len(steps) <= 3 and all(step.residuals for step in steps)
    assert capfd.readouterr() == ("", "")


def test_a_sample_brings_its_size_and_units() -> None:
    from kirisurf.targets import resolved

    assert resolved(FitSpec("hypar")).cells == (4, 4)
    assert resolved(FitSpec("dome")).units == "m" and resolved(FitSpec("dome", units="ft")).units == "ft"
    assert resolved(FitSpec("hypar", tiles=50), sized=True).tiles == 50
    assert resolved(FitSpec("bowl.stl"), Path("/some/where")).target == "/some/where/bowl.stl"


@pytest.mark.parametrize(
    ("target", "problem", "message"),
    [
        ("hyparr", UnreadableError, "did you mean 'hypar'"),
        ("nothing.stl", UnreadableError, "nothing.stl"),
        ("outline.svg", UnreadableError, "outline.svg"),
        (5, ParameterError, "expected a file"),
        ((np.zeros((3, 3)), np.array([[0, 1, 7]])), UnusableError, "expected vertex indices"),
        ((np.full((3, 3), np.nan), np.array([[0, 1, 2]])), UnusableError, "finite"),
    ],
    ids=["typo", "missing", "planar", "number", "index", "nan"],
)
def test_a_wrong_target_is_refused(target: object, problem: type[Exception], message: str) -> None:
    with pytest.raises(problem, match=message):
        kirisurf.fit(target)


def test_a_closed_surface_is_refused() -> None:
    import pyvista

    with pytest.raises(UnusableError, match="closed"):
        kirisurf.fit(pyvista.Sphere(theta_resolution=8, phi_resolution=8))


def test_audit_finds_a_fault_and_states_that_do_not_match(design: Design) -> None:
    tiles, points = design.tessellation.tiles, design.deployed_points
    assert kirisurf.audit(design.deployed, design.contracted, design.surface).passed
    moved = points.copy()
    moved[3, 2] += 1e-3
    failures = kirisurf.audit((moved, tiles), (design.contracted_points, tiles)).failures
    assert any(sentence.startswith("isometry") for sentence in failures)
    with pytest.raises(UnusableError, match="same polygons"):
        kirisurf.audit((points, tiles), (points, tiles.subset(np.arange(3))))
    with pytest.raises(UnusableError, match="same vertices"):
        kirisurf.audit((points, tiles), (points[:-1], tiles))
    with pytest.raises(ParameterError, match="expected a file"):
        kirisurf.audit(3, 4)


def test_every_public_name_exists_and_no_other() -> None:
    for name in kirisurf.__all__:
        assert getattr(kirisurf, name) is not None, name
    assert set(kirisurf.__all__) <= set(dir(kirisurf))
    with pytest.raises(AttributeError):
        kirisurf.nothing  # noqa: B018


@pytest.mark.parametrize(
    "statement", ["import kirisurf", "from kirisurf.cli import main; assert main(['--help']) == 0"]
)
def test_importing_and_helping_load_nothing_heavy(statement: str) -> None:
    script = f"{statement}\nimport sys; print(sorted({{name.partition('.')[0] for name in sys.modules}}))"
    child = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, cwd=ROOT, check=True)
    loaded = eval(child.stdout.splitlines()[-1])
    assert "kirisurf" in loaded
    assert not {"numpy", "scipy", "igl", "vtk", "vtkmodules", "pyvista", "matplotlib", "rich"} & set(loaded)
