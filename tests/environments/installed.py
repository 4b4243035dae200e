"""The environments that cost minutes: kirisurf as a package, in a virtual environment of its own.

wheel    built, installed with its pinned dependencies outside the checkout, run from an empty folder
sdist    built, unpacked, its own tests run; a wheel built from it
oldest   with the lowest version of every dependency that pyproject.toml allows
newest   with whatever is newest
"""

from __future__ import annotations

import re
import subprocess
import sys
import tarfile
import time
import tomllib
import urllib.request
import zipfile
from collections.abc import Callable
from pathlib import Path

from packaging.requirements import Requirement

from tests.environments.rows import cheap
from tests.environments.running import Result, run_row

ROOT = Path(__file__).resolve().parents[2]
_ROWS = ("plain", "files named as our packages lie in the current folder", "nothing at all, pictures")
_INSIDE = (
    "viewers/templates/base.html",
    "viewers/paraview/kirisurf_filters.py",
    "sample_surfaces/catalog.py",
    "kirisurf/formats/vtk_worker.py",
)


def wheel(scratch: Path) -> Result:
    """Install the wheel with the pinned versions of everything."""
    built = _built(scratch, "wheel")
    names = set(zipfile.ZipFile(built).namelist())
    wanted = {str(path.relative_to(ROOT)) for room in ("sample_surfaces", "viewers") for path in _data(ROOT / room)}
    missing = sorted((wanted | set(_INSIDE)) - names)
    python = _environment(scratch, f"{built}[web]", "-c", str(ROOT / "constraints.txt"))
    return _judged(scratch, python, [f"not in the wheel: {', '.join(missing)}"] if missing else [], page=True)


def sdist(scratch: Path) -> Result:
    """Build the source distribution, run its tests of the project, and build a wheel from it."""
    began = time.monotonic()
    with tarfile.open(_built(scratch, "sdist")) as archive:
        archive.extractall(scratch, filter="data")
    (source,) = (path for path in scratch.glob("kirisurf-*") if path.is_dir())
    ended = [
        _run(source, sys.executable, "-m", "pytest", "-q", "-m", "not slow", "tests/project", "tests/kirisurf/solvers"),
        _run(source, sys.executable, "-m", "hatchling", "build", "-t", "wheel", "-d", str(scratch / "again")),
    ]
    problems = [f"{name}: {_last(e)}" for name, e in zip(("tests", "wheel"), ended, strict=True) if e.returncode]
    codes = tuple(e.returncode for e in ended)
    return Result(("pytest", "build"), codes, None, time.monotonic() - began, tuple(problems))


def oldest(scratch: Path) -> Result:
    """Install the lowest version of every dependency."""
    project = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    return _judged(scratch, _environment(scratch, str(_built(scratch, "wheel")), *lowest(project["dependencies"])))


def lowest(lines: list[str]) -> list[str]:
    """Return requirements that allow the lowest version alone.

    Examples
    --------
    >>> lowest(["libigl>=2.6,<2.7", "rich>=13"])
    ['libigl==2.6', 'rich==13']
    """
    return [
        f"{found.name}=={next(s.version for s in found.specifier if s.operator == '>=')}"
        for found in map(Requirement, lines)
    ]


def newest(scratch: Path) -> Result:
    """Install whatever is newest."""
    return _judged(scratch, _environment(scratch, str(_built(scratch, "wheel"))))


HEAVY: dict[str, Callable[[Path], Result]] = {"wheel": wheel, "sdist": sdist, "oldest": oldest, "newest": newest}


def _data(room: Path) -> list[Path]:
    return [path for path in room.rglob("*") if path.is_file() and "__pycache__" not in path.parts]


def _built(scratch: Path, kind: str) -> Path:
    _checked(_run(ROOT, sys.executable, "-m", "hatchling", "build", "-t", kind, "-d", str(scratch / "dist")))
    (found,) = (scratch / "dist").iterdir()
    return found


def _environment(scratch: Path, *requirements: str) -> str:
    """Make a virtual environment and return its interpreter."""
    _checked(_run(scratch, sys.executable, "-m", "venv", "environment"))
    python = str(scratch / "environment" / "bin" / "python")
    _checked(_run(scratch, python, "-m", "pip", "install", "--quiet", "--only-binary", ":all:", *requirements))
    return python


def _judged(scratch: Path, python: str, problems: list[str] | None = None, page: bool = False) -> Result:
    """Run the demo and some rows with an interpreter, from an empty folder."""
    began, problems = time.monotonic(), list(problems or ())
    empty = scratch / "empty"
    empty.mkdir()
    demo = _run(empty, python, "-I", "-m", "kirisurf", "demo")
    ran, codes = ["demo"], [demo.returncode]
    if demo.returncode not in (0, 1) or "certified" not in demo.stderr:
        problems.append(f"demo: {_last(demo)}")
    rows = {row.name: row for row in cheap()}
    for i, name in enumerate(_ROWS):
        (scratch / str(i)).mkdir()
        found = run_row(rows[name], scratch / str(i), None, python)
        ran, codes = [*ran, *found.ran], [*codes, *found.codes]
        problems += found.problems
    if page:
        ran.append("view --web")
        problems += _page(empty, python)
    return Result(tuple(ran), tuple(codes), not problems, time.monotonic() - began, tuple(problems))


def _page(folder: Path, python: str) -> list[str]:
    """Start the page, ask for it once by its address, and end it as Ctrl-C does."""
    command = [python, "-I", "-m", "kirisurf", "view", "hypar", "--web", "--no-browser"]
    with subprocess.Popen(command, cwd=folder, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True) as server:
        assert server.stderr is not None
        address = next((m[0] for line in server.stderr if (m := re.search(r"http://\S+", line))), "")
        try:
            status = urllib.request.urlopen(address, timeout=60).status if address else 0
        except OSError as problem:
            return [f"view --web: {problem}"]
        finally:
            server.send_signal(2)
            server.stderr.read()
    return [] if status == 200 and server.returncode in (0, 130) else [f"view --web: {status}, {server.returncode}"]


def _run(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    return subprocess.run(words, cwd=folder, stdin=subprocess.DEVNULL, capture_output=True, text=True, check=False)


def _checked(ended: subprocess.CompletedProcess[str]) -> None:
    if ended.returncode:
        raise RuntimeError(f"{' '.join(ended.args[:6])}: {_last(ended)}")


def _last(ended: subprocess.CompletedProcess[str]) -> str:
    return f"code {ended.returncode}: {' '.join((ended.stdout + ended.stderr).split())[-400:]}"
