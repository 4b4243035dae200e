"""The main job from the command line, and what can be done with its run folder."""

from __future__ import annotations

import json
import os
import shutil
import signal
import struct
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from pathlib import Path

import pytest

from kirisurf.cli import main
from kirisurf.runs import read_run

ROOT = Path(__file__).resolve().parents[3]
Captured = pytest.CaptureFixture[str]


def contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in folder.iterdir()}


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    where = tmp_path_factory.mktemp("cli") / "run"
    assert main(["fit", "hypar", "-o", str(where), "--cells", "2x2", "--units", "mm", "--no-pictures", "-q"]) == 0
    return where


def test_the_run_is_told_to_people_and_programs(tmp_path: Path, capsys: Captured) -> None:
    words = ["fit", "hypar", "--cells", "2x2", "--no-pictures", "-o"]
    assert main([*words, str(tmp_path / "a")]) == 0
    out, err = capsys.readouterr()
    assert out == f"{tmp_path / 'a' / 'report.html'}\n"
    assert (
        "step   1: length" in err and "certified. Converged" in err and "planarity" in err and "takes it as mm" in err
    )
    # what the target asks for is said before the solve, and once
    asked = "The target asks for stretches"
    assert err.count(asked) == 1 and err.index(asked) < err.index("step   1: length")
    assert main([*words, str(tmp_path / "b"), "--json"]) == 0
    printed = json.loads(capsys.readouterr().out)
    assert printed["status"] == "CONVERGED" and printed["folder"] == str(tmp_path / "b")
    assert printed["certificate"]["length"] <= 1e-9


def test_the_spec_in_the_run_repeats_it(folder: Path, tmp_path: Path) -> None:
    assert main(["fit", "--spec", str(folder / "run.toml"), "-o", str(tmp_path / "again"), "--no-pictures", "-q"]) == 0
    first, second = contents(folder), contents(tmp_path / "again")
    assert first.keys() == second.keys()
    assert [name for name in first if first[name] != second[name]] == ["result.json"]


def test_options_win_over_the_spec_and_relative_targets_start_at_it(
    folder: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    (tmp_path / "specs").mkdir()
    (tmp_path / "specs" / "mine.toml").write_text('target = "bowl.obj"\ntiles = 40\nmax_steps = 3\n')
    assert main(["export", str(folder), "--to", str(tmp_path / "x.obj")]) == 0
    (tmp_path / "x.obj").rename(tmp_path / "specs" / "bowl.obj")
    monkeypatch.chdir(tmp_path)
    from kirisurf.cli import build_parser
    from kirisurf.cli.fit import spec_of

    spec = spec_of(build_parser().parse_args(["fit", "--spec", "specs/mine.toml", "-o", "x", "--cells", "3x2"]))
    assert spec.target == str(tmp_path / "specs" / "bowl.obj")
    assert (spec.cells, spec.tiles, spec.max_steps) == ((3, 2), None, 3)


def test_an_existing_run_is_refused_and_replaced_only_on_request(tmp_path: Path, capsys: Captured) -> None:
    words = ["fit", "hypar", "--cells", "2x2", "--no-pictures", "-q", "-o", str(tmp_path / "run")]
    assert main(words) == 0
    before = contents(tmp_path / "run")
    assert main(words) == 2
    assert "--overwrite replaces the run" in capsys.readouterr().err
    assert contents(tmp_path / "run") == before
    # what fails while overwriting leaves the old run
    assert main(["fit", "nosuch.stl", "--overwrite", "-q", "-o", str(tmp_path / "run")]) == 3
    assert contents(tmp_path / "run") == before
    assert main([*words, "--overwrite", "--hinge-width", "0.01"]) == 0
    assert contents(tmp_path / "run")["pattern.svg"] != before["pattern.svg"]


def test_a_closed_surface_is_refused_with_the_reason(tmp_path: Path, capsys: Captured) -> None:
    corners = [(x, y, z) for x in (0, 1) for y in (0, 1) for z in (0, 1)]
    sides = [(1, 2, 4, 3), (5, 7, 8, 6), (1, 5, 6, 2), (3, 4, 8, 7), (1, 3, 7, 5), (2, 6, 8, 4)]
    lines = [f"v {x} {y} {z}" for x, y, z in corners] + ["f " + " ".join(map(str, side)) for side in sides]
    (tmp_path / "cube.obj").write_text("\n".join(lines))
    assert main(["fit", str(tmp_path / "cube.obj"), "-o", str(tmp_path / "run")]) == 4
    assert "closed" in capsys.readouterr().err
    assert not (tmp_path / "run").exists()


def test_a_limit_saves_the_best_and_gives_the_reason(tmp_path: Path, capsys: Captured) -> None:
    words = ["fit", "hypar", "--cells", "2x2", "--max-steps", "1", "--no-pictures", "-o", str(tmp_path / "run")]
    assert main(words) == 6
    assert "Step limit" in capsys.readouterr().err
    assert read_run(tmp_path / "run").result["status"] == "STEP_LIMIT"


def test_the_demo_replaces_its_own_run_only(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: Captured) -> None:
    monkeypatch.chdir(tmp_path)
    words = ["demo", "--sample", "hypar", "--no-pictures", "-q"]
    assert main(words) == 0 and main(words) == 0
    assert capsys.readouterr().out.splitlines()[-1] == str(tmp_path / "demo" / "report.html")
    assert main([*words, "-o", "demo"]) == 2
    for path in (tmp_path / "demo").iterdir():
        path.unlink()
    (tmp_path / "demo" / "thesis.tex").write_text("years of work")
    assert main(words) == 2
    assert contents(tmp_path / "demo") == {"thesis.tex": b"years of work"}


def test_every_export_is_written_and_read_back(folder: Path, tmp_path: Path) -> None:
    from kirisurf.formats import read_polygons

    names = [str(tmp_path / f"out.{suffix}") for suffix in ("svg", "obj", "vtp", "stl", "csv")]
    assert main(["export", str(folder), "--to", *names]) == 0
    run = read_run(folder)
    assert (tmp_path / "out.svg").read_bytes() == (folder / "pattern.svg").read_bytes()
    assert (tmp_path / "out.csv").read_bytes() == (folder / "curvature.csv").read_bytes()
    for name in ("out.obj", "out.vtp"):
        points, loops = read_polygons(tmp_path / name)
        assert (points[:, :2] == run.contracted).all() and (loops.indices == run.tessellation.tiles.indices).all()
    stl = (tmp_path / "out.stl").read_bytes()
    (count,) = struct.unpack_from("<I", stl, 80)
    assert count == 2 * run.tessellation.n_tiles and len(stl) == 84 + 50 * count
    assert main(["export", str(folder), "--to", names[1], "--state", "deployed", "--overwrite"]) == 0
    assert (read_polygons(names[1])[0] == run.deployed).all()
    assert main(["export", str(folder), "--to", names[0], "--hinge-width", "0.05", "--units", "in", "--overwrite"]) == 0
    assert ElementTree.parse(names[0]).getroot().attrib["width"].endswith("in")
    assert main(["export", str(folder), "--to", names[0], "--hinge-width", "9", "--overwrite"]) == 2
    assert main(["export", str(folder), "--to", str(tmp_path / "no" / "such" / "folder.svg")]) == 7


def test_curvature_shows_every_hole(folder: Path, tmp_path: Path, capsys: Captured) -> None:
    assert main(["curvature", str(folder), "--csv", str(tmp_path / "holes.csv")]) == 0
    out, err = capsys.readouterr()
    assert len(out.splitlines()) == 1 + read_run(folder).result["holes"]
    assert "median of |K of a hole - K of the target|" in err
    assert (tmp_path / "holes.csv").read_bytes() == (folder / "curvature.csv").read_bytes()
    assert main(["curvature", str(folder), "--json"]) == 0
    assert len(json.loads(capsys.readouterr().out)["holes"]) == read_run(folder).result["holes"]


def test_the_report_of_a_run_is_written_again_and_the_run_stays_whole(folder: Path, tmp_path: Path) -> None:
    report = folder / "report.html"
    report.write_text("gone")
    assert main(["report", str(folder), "--no-pictures"]) == 0
    assert "Certified" in report.read_text()
    from kirisurf.runs.record import hashes

    assert read_run(folder).result["files"] == hashes(folder)
    assert main(["report", str(folder), str(folder), "-o", str(tmp_path / "both.html"), "--no-pictures"]) == 0
    assert (tmp_path / "both.html").read_text().count("<html") == 1


def test_exports_replace_nothing_unasked_and_no_file_of_the_run(folder: Path, tmp_path: Path, capsys: Captured) -> None:
    there = tmp_path / "there.obj"
    there.write_text("mine")
    assert main(["export", str(folder), "--to", str(there)]) == 2
    assert there.read_text() == "mine" and "--overwrite" in capsys.readouterr().err
    before = (folder / "deployed.obj").read_bytes()
    assert main(["export", str(folder), "--to", str(folder / "deployed.obj"), "--overwrite"]) == 2
    assert (folder / "deployed.obj").read_bytes() == before


def test_a_certified_run_is_not_replaced_by_an_unfinished_one(folder: Path, tmp_path: Path, capsys: Captured) -> None:
    old = tmp_path / "run"
    shutil.copytree(folder, old)
    before = {path.name: path.read_bytes() for path in old.iterdir() if path.is_file()}
    words = ["fit", "peaks", "--tiles", "100", "--max-steps", "1", "--no-pictures", "--overwrite", "-o", str(old)]
    assert main(words) == 6
    assert {path.name: path.read_bytes() for path in old.iterdir() if path.is_file()} == before
    assert read_run(tmp_path / "run-unfinished").result["status"] == "STEP_LIMIT"
    assert "was kept" in capsys.readouterr().err


def test_a_window_without_a_display_is_explained(
    folder: Path, capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    for name in ("DISPLAY", "WAYLAND_DISPLAY"):
        monkeypatch.delenv(name, raising=False)
    if not sys.platform.startswith("linux"):
        pytest.skip("a missing display was not tried: only Linux names it in the environment")
    assert main(["view", str(folder)]) == 1
    assert "display" in capsys.readouterr().err


def started(folder: Path, *words: str) -> subprocess.Popen[str]:
    command = [sys.executable, "-m", "kirisurf", "fit", *words, "--no-pictures", "-o", str(folder)]
    return subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)


@pytest.mark.slow
@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
def test_an_interrupted_solve_is_saved(tmp_path: Path, number: signal.Signals) -> None:
    child = started(tmp_path / "run", "peaks", "--cells", "16x16", "--tolerance", "1e-12", "--json")
    assert child.stderr is not None
    for line in child.stderr:
        if line.startswith("step"):
            child.send_signal(number)
            break
    out, err = child.communicate(timeout=300)
    assert child.returncode == 130, err
    assert json.loads(out)["status"] == "INTERRUPTED"
    run = read_run(tmp_path / "run")
    assert run.result["exit_code"] == 130 and len(run.deployed) == run.result["vertices"]


@pytest.mark.slow
def test_two_signals_save_nothing_and_leave_nothing(tmp_path: Path) -> None:
    child = started(tmp_path / "deep" / "run", "peaks", "--cells", "24x24")
    assert child.stderr is not None
    for line in child.stderr:
        if line.startswith("step"):
            child.send_signal(signal.SIGINT)
        elif line.startswith("interrupted"):
            child.send_signal(signal.SIGINT)
            break
    _, err = child.communicate(timeout=300)
    assert child.returncode == 130 and "Traceback" not in err
    assert not list(tmp_path.iterdir())


@pytest.mark.skipif(os.name != "posix", reason="a limit on file sizes was not tried: only POSIX systems set one")
def test_a_disk_that_fills_up_loses_nothing(folder: Path, tmp_path: Path) -> None:
    import shutil

    shutil.copytree(folder, tmp_path / "run")
    before = contents(tmp_path / "run")
    # the child limits itself: between fork and exec nothing is safe in a process with threads
    limited = "import resource, runpy; resource.setrlimit(resource.RLIMIT_FSIZE, (6000, 6000)); "
    limited += "runpy.run_module('kirisurf', run_name='__main__', alter_sys=True)"
    command = [sys.executable, "-c", limited, "fit", "hypar", "--cells", "2x2", "--no-pictures", "--overwrite", "-o"]
    ended = subprocess.run(
        [*command, str(tmp_path / "run")],
        cwd=ROOT,
        capture_output=True,
        text=True,
        check=False,
    )
    assert ended.returncode == 7, ended.stderr
    assert "Traceback" not in ended.stderr
    assert contents(tmp_path / "run") == before
