"""The command line: help, streams, one exit code for every kind of trouble, never a traceback unasked."""

from __future__ import annotations

import json
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

import kirisurf.cli as cli
from kirisurf.cli.output import Outcome
from kirisurf.errors import OutputError, ParameterError
from kirisurf.failures import explained
from kirisurf.tessellation_names import TESSELLATIONS

ROOT = Path(__file__).resolve().parents[3]
COMMANDS = ("demo", "fit", "audit", "curvature", "deploy", "report", "view", "export", "reproduce", "samples")

Captured = pytest.CaptureFixture[str]


def process(*words: str, cwd: Path = ROOT, path: str = "", **options: object) -> subprocess.CompletedProcess[str]:
    environment = {**os.environ, "PYTHONPATH": os.pathsep.join(filter(None, [path, str(ROOT)]))}
    command = [sys.executable, "-m", "kirisurf", *words]
    options.setdefault("stdout", subprocess.PIPE)
    return subprocess.run(command, cwd=cwd, env=environment, stderr=subprocess.PIPE, text=True, check=False, **options)  # type: ignore[call-overload]


def test_the_first_page_names_every_command(capsys: Captured) -> None:
    assert cli.main(["--help"]) == 0
    page = capsys.readouterr().out
    assert all(f"    {name} " in page for name in COMMANDS)
    assert all(f"{code} " in page for code in (0, 1, 2, 3, 4, 5, 6, 7, 70, 130))


@pytest.mark.parametrize("name", COMMANDS)
def test_every_command_has_a_page_with_examples(name: str, capsys: Captured) -> None:
    assert cli.main([name, "--help"]) == 0
    page = capsys.readouterr().out
    assert f"kirisurf {name}" in page.partition("examples:")[2]


def test_the_version_is_printed(capsys: Captured) -> None:
    assert cli.main(["--version"]) == 0
    assert capsys.readouterr().out.startswith("kirisurf ")
    assert cli.main(["--version", "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["version"]


@pytest.mark.parametrize(
    ("words", "code", "message"),
    [
        ([], 2, "expected a command"),
        (["smaples"], 2, "did you mean 'samples'"),
        (["deploy"], 2, "RUN"),
        (["deploy", "run", "--lambda", "stiff"], 2, "--lambda: expected a number, got 'stiff'"),
        (["batch"], 2, "expected"),
        (["samples", "extra"], 2, "got extra"),
        (["samples", "--frob"], 2, "got --frob"),
        (["fit", "hypar"], 2, "expected -o/--output, got none"),
        (["fit", "-o", "x"], 2, "TARGET: expected"),
        (["fit", "hypar", "-o", "x", "--cells", "4by4"], 2, "--cells: expected WxH"),
        (["fit", "hypar", "-o", "x", "--tiles", "many"], 2, "--tiles: expected a whole number, got 'many'"),
        (["fit", "hypar", "-o", "x", "--tolerance", "tiny"], 2, "--tolerance: expected a number, got 'tiny'"),
        (["fit", "hypar", "-o", "x", "--opening", "wide"], 2, "--opening: expected degrees or auto"),
        (["fit", "hypar", "-o", "x", "--closeness", "near"], 2, "--closeness: expected one of best, exact"),
        (["fit", "hypar", "-o", "x", "--tessellation", "kagom"], 2, "did you mean 'kagome'"),
        (["fit", "hypar", "-o", "x", "--close", "exact"], 2, "expected known options"),
        (["fit", "nosuch.stl", "-o", "x"], 3, "nosuch.stl"),
        (["fit", "hyparr", "-o", "x"], 3, "did you mean 'hypar'"),
        (["fit", "-o", "x", "--", "-odd.obj"], 3, "-odd.obj"),
        (["fit", "--spec", "nosuch.toml", "-o", "x"], 3, "expected a file that can be read"),
        (["demo", "--sample", "moon"], 2, "--sample: expected one of"),
        (["audit", "a.obj", "b.obj"], 3, "a.obj"),
        (["curvature", "nosuch"], 3, "expected a run folder"),
        (["report", "nosuch"], 3, "expected a run folder"),
        (["report", "a", "b"], 2, "expected a file for the comparison"),
        (["export", "run", "--to", "x.pdf"], 2, ".pdf is not available in this version"),
        (["export", "run", "--to", "x.xyz"], 2, "expected a suffix among"),
        (["export", "run", "--to", "x.svg", "--state", "deployed"], 2, "expected --state contracted"),
        (["view", "hypar", "--port", "8000"], 2, "expected together with --web"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_a_mistake_gets_its_code_and_one_line(
    words: list[str], code: int, message: str, capsys: Captured, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(tmp_path)
    assert cli.main(words) == code
    out, err = capsys.readouterr()
    last = err.rstrip().splitlines()[-1]
    assert out == "" and last.startswith("kirisurf: ") and message in last
    assert not list(tmp_path.iterdir())
    assert cli.main(["--json", *words]) == code
    printed = json.loads(capsys.readouterr().out)
    assert printed["exit_code"] == code and message in printed["error"]


@pytest.mark.parametrize(
    ("problem", "code"),
    [
        (ParameterError("x"), 2),
        (OutputError("x"), 7),
        (OSError(28, "No space left on device"), 7),
        (MemoryError(), 6),
        (KeyboardInterrupt(), 130),
        (ZeroDivisionError("division by zero"), 70),
        (RecursionError(), 70),
    ],
    ids=repr,
)
def test_every_exception_has_a_code(
    problem: BaseException, code: int, capsys: Captured, monkeypatch: pytest.MonkeyPatch
) -> None:
    def failing(arguments: object, output: object) -> Outcome:
        raise problem

    monkeypatch.setattr(cli, "_run", failing)
    assert explained(problem)[0] == code
    assert cli.main(["samples"]) == code
    err = capsys.readouterr().err
    assert "Traceback" not in err and len(err.splitlines()) == 1
    assert cli.main(["samples", "--debug"]) == code
    assert "Traceback" in capsys.readouterr().err


def test_samples_are_listed_for_people_and_programs(capsys: Captured) -> None:
    assert cli.main(["samples"]) == 0
    out = capsys.readouterr().out
    assert "hypar" in out and "quad" in out
    assert cli.main(["samples", "--json"]) == 0
    found = json.loads(capsys.readouterr().out)
    assert {"hypar", "car_hood"} <= {sample["name"] for sample in found["samples"]}
    listed = {each["name"]: each for each in found["tessellations"]}
    assert set(TESSELLATIONS) <= set(listed)
    assert listed["kagome"]["tiles"] == 8 and listed["kagome"]["stretch"] == pytest.approx([2, 2])
    outlines = {each["name"]: each for each in found["outlines"]}
    assert outlines["circle"]["published"] and not outlines["disc"]["published"]
    assert all(re.search(rf"^  {name} ", out, re.MULTILINE) for name in (*listed, *outlines))
    # what is listed is what a fit accepts, by its name and by its file
    for name, each in listed.items():
        for given in (name, each["file"] or name):
            command = ["fit", "hypar", "-o", os.devnull, "--tessellation", given, "--tolerance", "5"]
            assert cli.main(command) == 2
            err = capsys.readouterr().err
            assert "--tolerance" in err and "--tessellation" not in err


def test_the_audit_passes_a_good_pair_and_fails_a_planted_fault(tmp_path: Path, capsys: Captured) -> None:
    from kirisurf.formats import write_obj
    from kirisurf.pattern import quad_pattern

    pattern = quad_pattern(2, 2)
    deployed, contracted = tmp_path / "-deployed.obj", tmp_path / "contracted.obj"
    write_obj(deployed, pattern.deployed, pattern.tiles)
    write_obj(contracted, pattern.contracted, pattern.tiles)
    assert cli.main(["audit", str(deployed), str(contracted), "--json"]) == 0
    assert json.loads(capsys.readouterr().out)["passed"]
    bent = np.column_stack([pattern.deployed, np.zeros(pattern.n_vertices)])
    bent[0, 2] = 0.01
    write_obj(deployed, bent, pattern.tiles)
    assert cli.main(["audit", str(deployed), str(contracted)]) == 5
    out, err = capsys.readouterr()
    assert "FAILS" in out and "warning: planarity" in err


def test_a_reader_that_leaves_early_is_no_error() -> None:
    child = subprocess.Popen(
        [sys.executable, "-m", "kirisurf", "samples"], cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE
    )
    assert child.stdout is not None and child.stderr is not None
    child.stdout.close()
    assert child.wait(timeout=300) == 0
    assert child.stderr.read() == b""
    child.stderr.close()


@pytest.mark.skipif(not os.path.exists("/dev/full"), reason="a full disk was not tried: there is no /dev/full here")
def test_a_full_standard_output_is_an_output_error() -> None:
    with open("/dev/full", "w") as full:
        ended = process("samples", stdout=full)
    assert ended.returncode == 7 and ended.stderr.count("\n") == 1


def test_a_users_own_analysis_in_the_current_folder_is_not_taken_for_ours(tmp_path: Path) -> None:
    (tmp_path / "analysis.py").write_text("raise SystemExit('the wrong analysis')")
    assert process("samples", cwd=tmp_path).returncode == 0
    ended = process("samples", cwd=tmp_path, path=str(tmp_path))
    assert ended.returncode == 70
    assert "expected kirisurf's own package 'analysis'" in ended.stderr and "analysis.py" in ended.stderr
