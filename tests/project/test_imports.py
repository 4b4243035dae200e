"""What starts quickly must not load what draws; what is loaded must be checked."""

from __future__ import annotations

import subprocess
import sys
import tomllib
from pathlib import Path

import numpy as np
import pytest


@pytest.mark.parametrize("package", ["kirisurf", "analysis", "sample_surfaces"])
def test_computing_packages_load_no_drawing_library(package: str) -> None:
    code = f"import sys, {package}; print(*{{name.split('.')[0] for name in sys.modules}})"
    child = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert set(child.stdout.split()) & {"vtk", "vtkmodules", "pyvista", "matplotlib", "trame", "pymeshlab"} == set()


def test_shape_hints_are_checked_in_this_run() -> None:
    from jaxtyping import TypeCheckError

    from kirisurf.loops import Loops

    with pytest.raises(TypeCheckError):
        Loops(np.zeros((2, 2), dtype=np.int64), np.zeros(0, dtype=np.int64))


def test_version_stands_in_two_places_and_is_one() -> None:
    import kirisurf

    project = tomllib.loads((Path(__file__).resolve().parents[2] / "pyproject.toml").read_text(encoding="utf-8"))
    assert kirisurf.__version__ == project["project"]["version"]
