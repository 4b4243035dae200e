"""The environments that cost some seconds each: the interpreter at hand, in circumstances that it was not made for."""

from __future__ import annotations

import ctypes
import os
import resource
import shutil
import subprocess
from functools import lru_cache, partial
from pathlib import Path

from tests.environments.running import Environment

NOWHERE = "/proc/nowhere"
"""A folder that is not there and that nobody can make, root neither."""
HOME = {"HOME": "{scratch}/home", "TMPDIR": "{scratch}/tmp", "PATH": "/usr/bin:/bin", "LANG": "C.UTF-8"}
GERMAN = "de_DE.UTF-8"
_LOCALIZED = """\
import locale, sys
locale.setlocale(locale.LC_ALL, "")
assert locale.localeconv()["decimal_point"] == ","
from kirisurf.cli import main
sys.exit(main(sys.argv[1:]))
"""
_IN_QT = """\
import locale, sys
from PySide6.QtCore import QCoreApplication
application = QCoreApplication([])
assert locale.localeconv()["decimal_point"] == ","
from kirisurf.cli import main
sys.exit(main(sys.argv[1:]))
"""
_STRICT = """\
import sys, warnings
warnings.filterwarnings("error", module=r"(kirisurf|analysis|viewers|sample_surfaces)(\\.|$)")
from kirisurf.cli import main
sys.exit(main(sys.argv[1:]))
"""
_NO_STREAMS = "import os, sys; os.close(1); os.close(2); os.execv(sys.executable, [sys.executable, *sys.argv[1:]])"

_NAMELESS = (
    "setpriv",
    "--reuid=54321",
    "--regid=54321",
    "--clear-groups",
    "--inh-caps=+dac_read_search",
    "--ambient-caps=+dac_read_search",
)  # it may read where Python is installed, wherever that is


def cheap() -> list[Environment]:
    """Return the rows, the one that others are compared with first."""
    return [
        Environment("nothing at all", chain=True),
        *_folders(),
        *_languages(),
        *_interpreters(),
        *_limits(),
        *_pictures(),
    ]


def _folders() -> list[Environment]:
    return [
        Environment("plain", HOME, chain=True),
        Environment("HOME is not there", {**HOME, "HOME": NOWHERE}, chain=True),
        Environment(
            "HOME cannot be written", HOME, start=_as_a_user, prepare=partial(_locked, name="home"), chain=True
        ),
        Environment("TMPDIR is not there", {**HOME, "TMPDIR": NOWHERE}, chain=True),
        Environment("TMPDIR cannot be written", HOME, start=_as_a_user, prepare=partial(_locked, name="tmp")),
        Environment("current folder deleted", HOME, start=_delete_current_folder, chain=True),
        Environment("current folder unreadable", HOME, start=_as_a_user, prepare=partial(_locked, name="here", mode=0)),
        Environment("files named as our packages lie in the current folder", HOME, prepare=_own_modules, chain=True),
        Environment(
            "a user without name and home, as in a container",
            before=_NAMELESS,
            prepare=_open_to_all,
            chain=True,
            lacking=_no_other_user,
        ),
        Environment("umask 077", HOME, start=partial(os.umask, 0o077)),  # type: ignore[arg-type]
    ]


def _languages() -> list[Environment]:
    german = {**HOME, "LC_ALL": GERMAN, "LOCPATH": "{scratch}/locales"}
    ascii_only = {**HOME, "LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
    odd = "{scratch}/ziel-größe 目標.obj"
    return [
        Environment("LC_ALL=C", {**HOME, "LC_ALL": "C"}),
        Environment("LC_ALL=C, target beyond ASCII", {**HOME, "LC_ALL": "C"}, target=odd, prepare=_odd_target, like=""),
        Environment("Python without UTF-8", ascii_only, chain=True),
        Environment(
            "Python without UTF-8, target beyond ASCII: refused",
            ascii_only,
            target=odd,
            prepare=_odd_target,
            like="",
            code=3,
            refused=True,
            says="PYTHONUTF8=1",
        ),
        Environment("LC_ALL=de_DE: a comma", german, prepare=_make_german, lacking=_no_german),
        Environment(
            "a comma, and set by the program",
            german,
            ("-c", _LOCALIZED),
            prepare=_make_german,
            lacking=_no_german,
            chain=True,
        ),
        Environment("a comma, set by Qt", german, ("-c", _IN_QT), prepare=_make_german, lacking=_no_qt, chain=True),
        Environment("TERM=dumb", {**HOME, "TERM": "dumb"}),
    ]


def _interpreters() -> list[Environment]:
    module = ("-m", "kirisurf")
    return [
        *(Environment(f"PYTHONHASHSEED={seed}", {**HOME, "PYTHONHASHSEED": seed}) for seed in ("0", "1", "random")),
        Environment("PYTHONOPTIMIZE=2: no docstrings", {**HOME, "PYTHONOPTIMIZE": "2"}, chain=True),
        Environment("python -I", HOME, ("-I", *module)),
        Environment("python -X dev", HOME, ("-X", "dev", *module)),
        Environment("warnings of ours are errors", HOME, ("-c", _STRICT), chain=True),
    ]


def _limits() -> list[Environment]:
    def threads(n: int) -> dict[str, str]:
        return {**HOME, "OMP_NUM_THREADS": str(n), "OPENBLAS_NUM_THREADS": str(n)}

    return [
        Environment("64 open files", HOME, start=partial(_limit, resource.RLIMIT_NOFILE, 64)),
        Environment("24 open files", HOME, start=partial(_limit, resource.RLIMIT_NOFILE, 24), chain=True),
        Environment("no core files", HOME, start=partial(_limit, resource.RLIMIT_CORE, 0)),
        Environment("BLAS on 1 thread", threads(1)),
        Environment("BLAS on 2 threads", threads(2)),
        Environment("BLAS on 7 threads", threads(7)),
        Environment("one core", HOME, start=_one_core, chain=True),
        Environment("standard input closed", HOME, start=partial(os.close, 0)),
        Environment(
            "no standard stream at all", HOME, ("-c", _NO_STREAMS, "-m", "kirisurf"), start=partial(os.close, 0)
        ),
    ]


def _pictures() -> list[Environment]:
    drawn = "nothing at all, pictures"
    windows = {"VTK_DEFAULT_OPENGL_WINDOW": "vtkNoSuchWindow"}
    pyvista = {"PYVISTA_OFF_SCREEN": "perhaps", "PYVISTA_JUPYTER_BACKEND": "none such", "PYVISTA_PLOT_THEME": "dark"}
    return [
        Environment(drawn, pictures=True, like="", lacking=_no_opengl),
        Environment(
            "HOME is not there, MPLBACKEND and MPLCONFIGDIR are nonsense, pictures",
            {**HOME, "HOME": NOWHERE, "MPLBACKEND": "nonsense", "MPLCONFIGDIR": NOWHERE},
            pictures=True,
            like=drawn,
            lacking=_no_opengl,
        ),
        Environment(
            "files named as our packages in the current folder, pictures",
            HOME,
            prepare=_own_modules,
            pictures=True,
            like=drawn,
            lacking=_no_opengl,
        ),
        Environment(
            "PYVISTA_*: nonsense, and a theme of one's own, pictures",
            {**HOME, **pyvista},
            pictures=True,
            like=drawn,
            lacking=_no_opengl,
        ),
        Environment(
            "VTK is asked for a window that there is not, pictures",
            {**HOME, **windows},
            pictures=True,
            like=drawn,
            lacking=_no_opengl,
        ),
        Environment(
            "no libGL: no pictures",
            {**HOME, "LD_LIBRARY_PATH": "{scratch}/broken"},
            prepare=_broken_libraries,
            pictures=True,
            like="",
            code=1,
            says="Pictures cannot be drawn",
        ),
    ]


def _as_a_user() -> None:
    """Let permissions count for root too."""
    for capability in (1, 2):  # to write and to read whatever the permissions say
        ctypes.CDLL(None).prctl(24, capability, 0, 0, 0)


def _limit(what: int, most: int) -> None:
    resource.setrlimit(what, (most, most))


def _one_core() -> None:
    os.sched_setaffinity(0, {min(os.sched_getaffinity(0))})


def _delete_current_folder() -> None:
    os.rmdir(os.getcwd())


def _locked(scratch: Path, name: str, mode: int = 0o500) -> None:
    (scratch / name).chmod(mode)


def _open_to_all(scratch: Path) -> None:
    for folder in (scratch, *scratch.iterdir()):
        folder.chmod(0o777)


def _no_other_user() -> str:
    return "" if os.getuid() == 0 and shutil.which("setpriv") else "only root with setpriv becomes another user"


def _own_modules(scratch: Path) -> None:
    for name in ("analysis", "viewers", "sample_surfaces", "numpy", "json", "vtkmodules"):
        (scratch / "here" / f"{name}.py").write_text("raise SystemExit('a file of the current folder was imported')\n")


def _odd_target(scratch: Path) -> None:
    n = 9
    lines = [f"v {i / (n - 1)} {j / (n - 1)} {0.2 * i * j / (n - 1) ** 2}" for i in range(n) for j in range(n)]
    corners = [i * n + j + 1 for i in range(n - 1) for j in range(n - 1)]
    lines += [f"f {c} {c + n} {c + n + 1}\nf {c} {c + n + 1} {c + 1}" for c in corners]
    (scratch / "ziel-größe 目標.obj").write_text("\n".join(lines) + "\n")


def _make_german(scratch: Path) -> None:
    (scratch / "locales").mkdir()
    subprocess.run(
        ["localedef", "-i", "de_DE", "-f", "UTF-8", str(scratch / "locales" / GERMAN)], capture_output=True, check=True
    )


def _no_german() -> str:
    if shutil.which("localedef") and Path("/usr/share/i18n/locales/de_DE").is_file():
        return ""
    return "the package locales, from which a comma locale is made, is missing"


def _no_qt() -> str:
    from importlib.util import find_spec

    return _no_german() or ("" if find_spec("PySide6") else "the extra kirisurf[desktop] is missing")


@lru_cache(maxsize=1)
def _no_opengl() -> str:
    from viewers.opengl import probe

    return probe().reason


def _broken_libraries(scratch: Path) -> None:
    """Put files that are none before the system's OpenGL libraries: the loader stops at them."""
    (scratch / "broken").mkdir()
    for name in (
        "libGL.so",
        "libEGL.so",
        "libGL.so.1",
        "libEGL.so.1",
        "libOpenGL.so.0",
        "libGLX.so.0",
        "libOSMesa.so.8",
        "libOSMesa.so",
    ):
        (scratch / "broken" / name).write_bytes(bytes(4096))
