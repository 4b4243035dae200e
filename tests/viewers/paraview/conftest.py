"""ParaView's own Python, as a program beside ours: it gets a script and answers with one JSON line."""

from __future__ import annotations

import json
import os
import shutil
import subprocess
from collections.abc import Callable
from pathlib import Path
from typing import Any

import pytest

import kirisurf
from kirisurf.runs import Run
from viewers import paraview

Ask = Callable[..., Any]

_START = """
import json, sys
from paraview import servermanager, simple
from paraview.vtk.util.numpy_support import vtk_to_numpy
def answer(value):
    print("ANSWER " + json.dumps(value), flush=True)
"""


def paraview_environment() -> dict[str, str]:
    """What ParaView may see of our environment: none of our packages, for two VTKs in one process clash."""
    found = {
        key: value
        for key, value in os.environ.items()
        if not key.startswith(("PYTHON", "VIRTUAL_ENV", "VTK_", "PYTEST")) and key != "DISPLAY"
    }
    # as docs/paraview.md says for ParaView 5.11
    return {**found, "PYTHONPATH": str(Path(paraview.__file__).resolve().with_name("python_3_11"))}


@pytest.fixture(scope="session")
def pvpython(tmp_path_factory: pytest.TempPathFactory) -> Ask:
    """Run a script in ParaView's Python and return what it answered, or skip and say what did not run."""
    program = shutil.which("pvpython")
    if program is None:
        pytest.skip("the tests in ParaView did not run: there is no pvpython (Debian: apt-get install paraview)")
    folder = tmp_path_factory.mktemp("scripts")

    def ask(script: str, *arguments: object, environment: dict[str, str] | None = None) -> Any:
        file = folder / "script.py"
        file.write_text(_START + script, encoding="utf-8")
        ended = subprocess.run(
            [program, str(file), *map(str, arguments)],
            capture_output=True,
            text=True,
            env={**paraview_environment(), **(environment or {})},
            timeout=300,
            check=False,
        )
        said = [line for line in ended.stdout.splitlines() if line.startswith("ANSWER ")]
        assert ended.returncode == 0 and said, f"{ended.returncode}\n{ended.stdout}\n{ended.stderr}"
        answer = json.loads(said[-1].removeprefix("ANSWER "))
        return {**answer, "log": ended.stdout + ended.stderr} if isinstance(answer, dict) else answer

    return ask


@pytest.fixture(scope="session")
def run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """A run with a unit, in a folder with an odd name."""
    folder = tmp_path_factory.mktemp("runs") / "a & b <ü> 'q'"
    return kirisurf.fit("hypar", cells=(2, 3), units="mm").save(folder, pictures=False)


@pytest.fixture(scope="session")
def far_run(tmp_path_factory: pytest.TempPathFactory) -> Run:
    """A run on a target in map coordinates."""
    import numpy as np

    from kirisurf.targets import load

    target = load("hypar")
    moved = np.asarray(target.vertices) + np.array([5e5, 2e6, 300.0])
    return kirisurf.fit((moved, target.faces), cells=(2, 2)).save(
        tmp_path_factory.mktemp("runs") / "far", pictures=False
    )


@pytest.fixture(scope="session")
def opening(run: Run, tmp_path_factory: pytest.TempPathFactory) -> Path:
    from kirisurf.exporting import export

    return export(run, tmp_path_factory.mktemp("series") / "o & <ü>.pvd", frames=5)
