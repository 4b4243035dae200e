"""Running kirisurf in one environment, and judging what it did and what it left behind."""

from __future__ import annotations

import hashlib
import json
import subprocess
import sys
import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path

SECONDS = 600.0
"""No command of a row may take longer, on a machine that does other things too."""

_CACHES = tuple(
    f"home/{name}"
    for name in (".cache/ezdxf", ".cache/fontconfig", ".cache/matplotlib", ".cache/mesa", ".config/matplotlib")
)
"""What libraries keep in a home folder where there is one: their lists of fonts, and compiled shaders."""


@dataclass(frozen=True)
class Environment:
    """What a row of the table runs in; {scratch} in its texts stands for the folder of the row.

    Attributes
    ----------
    name : str
    variables : mapping of str to str
        All that there is in the environment.
    python : tuple of str
        What the interpreter is given before the words of the command.
    start : callable, optional
        Called in the child before it becomes Python: limits, closed streams, fewer rights.
    prepare : callable, optional
        Called with the folder of the row before anything runs.
    target : str
    pictures : bool
        Draw, and not only compute.
    chain : bool
        After `fit` also `audit`, `export`, `curvature` and `samples`.
    like : str
        Name of the row whose files have the same bytes; empty where there is none.
    code : int
        Exit code of `fit`.
    refused : bool
        Whether `fit` is to end with its code and without a run.
    says : str
        What standard error of `fit` must hold.
    lacking : callable
        Why the row cannot run on this machine; empty where it can.
    before : tuple of str
        A program, with its arguments, that starts the interpreter.
    """

    name: str
    variables: Mapping[str, str] = field(default_factory=dict)
    python: tuple[str, ...] = ("-m", "kirisurf")
    start: Callable[[], None] | None = None
    prepare: Callable[[Path], None] | None = None
    target: str = "hypar"
    pictures: bool = False
    chain: bool = False
    like: str = "nothing at all"
    code: int = 0
    refused: bool = False
    says: str = ""
    lacking: Callable[[], str] = str
    before: tuple[str, ...] = ()


@dataclass(frozen=True)
class Result:
    """What came of a row: commands, their exit codes, and why it fails, if it does.

    Attributes
    ----------
    files : mapping of str to str
        SHA-256 of every file of the run; that of the record without its times.
    """

    ran: tuple[str, ...] = ()
    codes: tuple[int, ...] = ()
    certified: bool | None = None
    seconds: float = 0.0
    problems: tuple[str, ...] = ()
    skipped: str = ""
    files: Mapping[str, str] = field(default_factory=dict)

    @property
    def verdict(self) -> str:
        """One phrase for the table."""
        return f"did not run: {self.skipped}" if self.skipped else "; ".join(self.problems) or "pass"


def run_row(
    row: Environment, scratch: Path, expected: Mapping[str, str] | None = None, interpreter: str = sys.executable
) -> Result:
    """Run the commands of a row in an empty folder and judge them.

    Parameters
    ----------
    row : Environment
    scratch : path
        An empty folder; home, temporary folder, current folder and output are made in it.
    expected : mapping of str to str, optional
        The `files` of the row that this one must equal.
    interpreter : path
        The Python that kirisurf is installed for.
    """
    if reason := row.lacking():
        return Result(skipped=reason)
    for name in ("home", "tmp", "out", "here"):
        (scratch / name).mkdir()
    if row.prepare is not None:
        row.prepare(scratch)
    before, began, run = _listed(scratch), time.monotonic(), scratch / "out" / "run"
    problems: list[str] = []
    ran: list[str] = []
    codes: list[int] = []
    for words, code in _commands(row, run):
        ended = _child(row, words, scratch, interpreter)
        ran, codes = [*ran, words[0]], [*codes, ended.returncode]
        problems += _complaints(words[0], ended, code, row.says if words[0] == "fit" else "")
        if problems:
            break
    seconds = time.monotonic() - began
    record = _record(run)
    certified = record.get("certified")
    files = _hashes(run, record)
    if certified is not True and not row.refused:
        problems.append("not certified")
    if row.refused and record:
        problems.append("a run that should have been refused")
    if not row.refused and set(files) != {*record.get("files", {}), "result.json"}:
        problems.append("the folder holds other files than its record lists")
    different = [] if expected is None else sorted(name for name in expected if files.get(name) != expected[name])
    if different:
        problems.append(f"other bytes than {row.like!r}: {', '.join(different[:4])}")
    left = [name for name in sorted(_listed(scratch) - before) if not name.startswith(("out/", *_CACHES))]
    if left:
        problems.append(f"left behind: {', '.join(left[:4])}")
    return Result(tuple(ran), tuple(codes), certified, seconds, tuple(problems), files=files)


def _commands(row: Environment, run: Path) -> list[tuple[list[str], int]]:
    """Command lines, and the exit codes that they should have."""
    target = row.target.format(scratch=run.parents[1])
    fit = ["fit", target, "-o", str(run), "--cells", "3x3", *([] if row.pictures else ["--no-pictures"])]
    if not row.chain:
        return [(fit, row.code)]
    states = [str(run / f"{state}.obj") for state in ("deployed", "contracted")]
    exported = [str(run.parent / f"exported.{suffix}") for suffix in ("svg", "dxf", "stl", "obj", "vtp", "csv")]
    return [
        (fit, row.code),
        (["audit", *states, "--target", target], 0),
        (["export", str(run), "--to", *exported], 0),
        (["curvature", str(run)], 0),
        (["samples"], 0),
    ]


def _child(
    row: Environment, words: Sequence[str], scratch: Path, interpreter: str
) -> subprocess.CompletedProcess[bytes]:
    """Run one command with nothing in its environment but what the row gives."""
    (scratch / "here").mkdir(exist_ok=True)
    return subprocess.run(
        [*row.before, interpreter, *(part.format(scratch=scratch) for part in row.python), *words],
        cwd=scratch / "here",
        env={name: value.format(scratch=scratch) for name, value in row.variables.items()},
        preexec_fn=row.start,
        stdin=subprocess.DEVNULL,
        capture_output=True,
        timeout=SECONDS,
        check=False,
    )


def _complaints(command: str, ended: subprocess.CompletedProcess[bytes], code: int, says: str) -> list[str]:
    said = ended.stderr.decode("utf-8", "replace")
    problems = []
    if ended.returncode != code:
        problems.append(f"{command}: expected code {code}, got {ended.returncode}: {' '.join(said.split())[-200:]}")
    # Python's own reports, and those of libraries: kirisurf's begin with a small letter
    problems += [
        f"{command}: {word} on standard error" for word in ("Traceback", "Warning:", "Matplotlib") if word in said
    ]
    if says not in said:
        problems.append(f"{command}: expected {says!r} on standard error")
    return problems


def _record(run: Path) -> dict:
    try:
        return json.loads((run / "result.json").read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return {}


def _hashes(run: Path, record: Mapping[str, object]) -> dict[str, str]:
    found = {name.name: name.read_bytes() for name in sorted(run.iterdir())} if run.is_dir() else {}
    if "result.json" in found:
        found["result.json"] = json.dumps({key: value for key, value in record.items() if key != "seconds"}).encode()
    return {name: hashlib.sha256(content).hexdigest() for name, content in found.items()}


def _listed(folder: Path) -> set[str]:
    return {str(path.relative_to(folder)) for path in folder.rglob("*") if not path.is_dir()}
