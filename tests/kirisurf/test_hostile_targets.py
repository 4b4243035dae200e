"""Arrays and surfaces that nobody should give, doors of the system instead of files: one line, or a sound result."""

from __future__ import annotations

import errno
import os
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest

import kirisurf
from kirisurf.errors import KirisurfError, UnreadableError, UnusableError
from kirisurf.failures import explained
from kirisurf.formats.source import read_bytes
from kirisurf.naming import printable
from kirisurf.provenance import inputs
from kirisurf.runs import RunFolder, read_run
from kirisurf.spec import FitSpec
from kirisurf.surface import Surface
from tests.kirisurf.formats.seeds import FACES, VERTICES


def _changed(row: int, value: Any) -> np.ndarray:
    vertices = VERTICES.copy()
    vertices[row] = value
    return vertices


MASKED = np.ma.masked_array(VERTICES, mask=VERTICES > 0.9)
ARRAYS: dict[str, tuple[Any, Any, str]] = {
    "texts": (VERTICES.astype(str), FACES, "expected numbers, got <U"),
    "complex": (VERTICES.astype(complex), FACES, "expected numbers, got complex128"),
    "dates": (VERTICES.astype("m8[s]"), FACES, "expected numbers, got timedelta64"),
    "masked": (MASKED, FACES, "masked array"),
    "fractions in faces": (VERTICES, FACES.astype(float), "expected integers, got float64"),
    "beyond int64": (VERTICES, np.where(FACES == 3, 2**63 + 1, FACES).astype("u8"), "below 2"),
    "negative": (VERTICES, np.where(FACES == 3, -1, FACES), "indices from 0 to 15"),
    "out of range": (VERTICES, np.where(FACES == 3, 16, FACES), "indices from 0 to 15"),
    "nan": (_changed(3, np.nan), FACES, "finite"),
    "one far vertex": (_changed(3, 1e300), FACES, "overflow"),
    "huge": (VERTICES * 1e300, FACES, "overflow"),
    "tiny": (VERTICES * 1e-300, FACES, "underflow"),
    "far away": (VERTICES + 1e13, FACES, "too few digits"),
    "in one place": (np.ones_like(VERTICES), FACES, "extent"),
    "ragged": ([[0, 0, 0], [1, 0]], FACES, "expected numbers of shape"),
}


@pytest.mark.parametrize("name", ARRAYS)
def test_arrays_that_are_refused(name: str) -> None:
    vertices, faces, said = ARRAYS[name]
    with pytest.raises(UnusableError, match=said):
        kirisurf.load((vertices, faces))


@pytest.mark.parametrize(
    "change", [np.asfortranarray, lambda a: np.repeat(a, 2, axis=0)[::2], np.ma.masked_array, list]
)
def test_arrays_that_only_look_odd(change: Any) -> None:
    surface = kirisurf.load((change(VERTICES), change(FACES)))
    assert np.array_equal(surface.vertices, VERTICES)
    assert np.array_equal(surface.faces, FACES)


def test_a_surface_made_by_hand_is_checked_too() -> None:
    for vertices, faces in ((_changed(3, np.inf), FACES), (VERTICES, FACES + 9), (VERTICES * 1e300, FACES)):
        with pytest.raises(UnusableError):
            kirisurf.load(Surface(vertices, faces))


TRAPS = {
    "collinear": "v[:, 1:] = 0",
    "coincident": "v[:] = 1",
    "nearly collinear": "v[:, 1:] *= 1e-15",
    "very thin": "v[:, 1] *= 1e-7",
    "isolated vertex": "v = np.vstack([v, [[9, 9, 9]]])",
    "repeated corner": "f = np.vstack([f, [[0, 0, 1]]])",
    "face twice": "f = np.vstack([f, f[:1]])",
    "folded flat": "v[:, 0] = np.abs(v[:, 0] - 0.5); v[:, 2] = 0",
    "every second face turned": "f[::2] = f[::2, ::-1].copy()",
}


@pytest.mark.slow
def test_geometry_that_ends_native_code_does_not_end_us() -> None:
    """In a child, which a library could take down with it."""
    code = (
        "import numpy as np, kirisurf, warnings\n"
        "from kirisurf.errors import KirisurfError\n"
        "from tests.kirisurf.formats.seeds import FACES, VERTICES\n"
        "warnings.simplefilter('error')\n"
        f"for name, change in {TRAPS!r}.items():\n"
        "    given = {'v': VERTICES.copy(), 'f': FACES.copy(), 'np': np}\n"
        "    exec(change, given)\n"
        "    try:\n"
        "        found = kirisurf.fit((given['v'], given['f']), tiles=12, max_steps=15)\n"
        "        ended = np.isfinite(found.deployed_points).all()\n"
        "    except KirisurfError as problem: ended = bool(str(problem))\n"
        "    print(name, ended, flush=True)\n"
    )
    root = Path(__file__).resolve().parents[2]
    child = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, cwd=root)
    assert child.stdout.splitlines() == [f"{name} True" for name in TRAPS], child.stderr[-2000:]
    assert child.returncode == 0


@pytest.mark.skipif(not hasattr(os, "mkfifo"), reason="the test of named pipes did not run: this system has none")
def test_doors_of_the_system_are_no_files(tmp_path: Path) -> None:
    os.mkfifo(tmp_path / "pipe.obj")
    (tmp_path / "folder.obj").mkdir()
    (tmp_path / "loop.obj").symlink_to("loop.obj")
    (tmp_path / "zero.obj").symlink_to("/dev/zero")
    for name in ("pipe.obj", "folder.obj", "loop.obj", "zero.obj", "missing.obj"):
        with pytest.raises(UnreadableError, match=name):
            kirisurf.load(tmp_path / name)
        assert inputs(FitSpec(target=str(tmp_path / name))) == {"target": None}
        with pytest.raises(UnreadableError):
            read_run(tmp_path / name)


@pytest.mark.skipif(
    not Path("/proc/self/status").exists(), reason="files of no size did not run: there is no /proc here"
)
def test_a_file_that_says_it_has_no_size_is_empty() -> None:
    """Of some of them, as /proc/kmsg, no end ever comes."""
    assert read_bytes(Path("/proc/self/status"), 1) == b""


def test_a_pipe_in_a_run_folder_is_no_record(tmp_path: Path) -> None:
    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "result.json")
        with pytest.raises(UnreadableError, match="device or pipe"):
            read_run(tmp_path)


def test_names_of_bytes_that_are_no_text(tmp_path: Path) -> None:
    """Neither TOML nor JSON can hold them: that is said before anything is solved."""
    for key in ("target", "tessellation", "contracted"):
        with pytest.raises(UnreadableError, match=rf"{key}: expected a path in UTF-8, got .*\\udcff"):
            FitSpec(**{"target": "hypar", key: "./\udcff.obj"})


def test_names_as_they_may_be_shown() -> None:
    assert printable("größe 日本.obj") == "größe 日本.obj"
    assert printable("a\x1b[31m\n\u202e\udcff") == r"a\x1b[31m\n\u202e\udcff"
    assert printable("a\u00a0b") == "a b"
    assert printable("a\nb\tc\x00", kept="\n\t") == "a\nb\tc\\x00"


@pytest.mark.parametrize(
    ("problem", "code"),
    [
        (ImportError("/x/y.so: failed to map segment from shared object"), 6),
        (ImportError("libz.so: cannot allocate memory in static TLS block"), 6),
        (OSError(errno.ENOMEM, "Cannot allocate memory"), 6),
        (ImportError("cannot import name 'x'"), 70),
    ],
)
def test_memory_that_ran_out_while_something_was_loaded(problem: Exception, code: int) -> None:
    assert explained(problem)[0] == code


def test_a_current_folder_that_is_gone(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    (tmp_path / "gone").mkdir()
    monkeypatch.chdir(tmp_path / "gone")
    (tmp_path / "gone").rmdir()
    with pytest.raises(KirisurfError, match="gone"):
        RunFolder("relative")
    assert RunFolder(tmp_path / "absolute").path == tmp_path / "absolute"


@pytest.mark.slow
def test_size_and_place_of_a_target_change_no_verdict() -> None:
    """Every tolerance is relative: the certificate is the same at any scale and anywhere, to rounding."""
    base = kirisurf.fit((VERTICES, FACES), tiles=12)
    assert base.status.exit_code == 0
    for scale, shift in ((1e-9, 0.0), (1e9, 0.0), (1e-3, 0.0), (1.0, 1e6)):
        away = shift * float(np.linalg.norm(np.ptp(VERTICES, axis=0)))
        other = kirisurf.fit((scale * VERTICES + away, FACES), tiles=12)
        assert other.status is base.status
        assert other.certificate.passed == base.certificate.passed
        assert other.tessellation.n_tiles == base.tessellation.n_tiles
        # the rounding of coordinates at 1e6 diagonals is 1e-10 of one, and the minimum follows it
        close = 1e-4 if shift else 1e-6
        for name, value in base.certificate.rows.items():
            found = other.certificate.rows[name]
            if value is None or found is None:
                assert value is found
            elif name in ("min_edge", "opening_min", "distance_rms", "distance_max", "coverage", "reach_rms"):
                assert abs(found - value) <= close, name
            else:
                assert (abs(found) <= 1e-9) == (abs(value) <= 1e-9) or abs(found - value) <= close, name
