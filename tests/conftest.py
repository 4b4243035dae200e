"""What every test stands on: shape-checked hints, off-screen drawing, and the folder of reference designs."""

from __future__ import annotations

import ctypes
import os
import signal
from pathlib import Path

import pytest
from hypothesis import HealthCheck, settings
from jaxtyping import install_import_hook


def _opengl_is_installed() -> bool:
    try:
        for library in ("libGL.so.1", "libEGL.so.1", "libOpenGL.so.0"):
            ctypes.CDLL(library)
    except OSError:
        return False
    return True


# A shell's background job starts with Ctrl-C ignored, and its children inherit that: the tests of signals need it.
signal.signal(signal.SIGINT, signal.default_int_handler)

# Before NumPy is loaded: one thread, so that sums come out the same everywhere and parallel runs share the cores.
os.environ.setdefault("OMP_NUM_THREADS", "1")
os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")
os.environ["MPLBACKEND"] = "Agg"
if _opengl_is_installed():
    # An empty value makes VTK crash, so it is set or absent.
    os.environ["VTK_DEFAULT_OPENGL_WINDOW"] = "vtkEGLRenderWindow"
else:
    os.environ.pop("VTK_DEFAULT_OPENGL_WINDOW", None)

# Before the packages are loaded: every shape in a type hint is checked at every call of the test run.
install_import_hook(["kirisurf", "analysis", "sample_surfaces", "viewers"], "beartype.beartype")

# The same examples every time, however slow the machine is just then; `--hypothesis-profile default` looks for others.
settings.register_profile(
    "same", derandomize=True, database=None, deadline=None, suppress_health_check=[HealthCheck.too_slow]
)
settings.load_profile("same")

ROOT = Path(__file__).resolve().parent.parent


def pytest_collection_modifyitems(items: list[pytest.Item]) -> None:
    """Quick tests first: what fails in a second is not reported after minutes."""
    items.sort(key=lambda item: item.get_closest_marker("slow") is not None)


@pytest.fixture
def reference(request: pytest.FixtureRequest) -> Path:
    """Return the folder of reference designs beside the project, or skip and say what did not run."""
    folder = ROOT.parent / "shared"
    if not (folder / "reference").is_dir():
        pytest.skip(f"{request.node.name} did not run: there is no folder shared/reference beside the project")
    return folder


@pytest.fixture
def opengl(request: pytest.FixtureRequest) -> None:
    """Let a test draw, or skip it and say what did not run."""
    from viewers.opengl import probe

    answer = probe()
    if not answer.available:
        pytest.skip(f"{request.node.name} did not run: {answer.reason}")
