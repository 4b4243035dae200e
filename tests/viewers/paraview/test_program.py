"""The child process behind the filters, played by small scripts: found, listened to, interrupted, never waited for."""

from __future__ import annotations

import os
import sys
import time
from pathlib import Path

import pytest

from viewers.paraview import program
from viewers.paraview.program import Answer, ProgramError


@pytest.fixture
def played(tmp_path: Path):
    """Make a program of some lines of Python."""

    def make(lines: str, name: str = "kirisurf") -> str:
        path = tmp_path / name
        path.write_text(f"#!{sys.executable}\nimport json, os, signal, sys, time\n{lines}\n", encoding="utf-8")
        path.chmod(0o755)
        return str(path)

    return make


def test_progress_rises_and_the_answer_arrives(played) -> None:
    path = played(
        "say = lambda line: print(line, file=sys.stderr, flush=True)\n"
        'say("reading a ...")\nsay("solving ...")\n'
        'say("step   1: length 1.0e-01  angle 2.0e-02  (0.1 s)")\n'
        'say("step   5: length 1.0e-06  angle 2.0e-08  (0.2 s)")\n'
        'say("measuring ...")\nsay("writing the report ...")\n'
        'print(json.dumps({"certified": True, "words": sys.argv[1:]}))'
    )
    heard: list[tuple[float, str]] = []
    answer = program.run([path, "--json", "a b"], lambda share, line: heard.append((share, line)))
    shares = [share for share, _ in heard]
    assert answer.code == 0 and answer.result == {"certified": True, "words": ["--json", "a b"]}
    assert shares == sorted(shares) and shares[0] > 0 and shares[-1] < 1
    assert [line for _, line in heard] == list(answer.said) and len(heard) == 6
    assert shares[3] == pytest.approx(0.1 + 0.7 * 0.5)  # five digits of ten


def test_much_that_is_said_does_not_block(played) -> None:
    path = played('sys.stderr.write("x" * 99 + "\\n" * 40000)\nprint(json.dumps({"a": "y" * 1000000}))')
    assert len(program.run([path]).result["a"]) == 1000000


def test_an_interrupted_program_may_save_what_it_has(played) -> None:
    path = played(
        "def stop(*_):\n"
        '    print(json.dumps({"saved": True}), flush=True)\n'
        "    os._exit(130)\n"
        "signal.signal(signal.SIGINT, stop)\n"
        'print("ready", file=sys.stderr, flush=True)\ntime.sleep(60)'
    )
    heard: list[str] = []
    began = time.monotonic()
    answer = program.run([path], lambda share, line: heard.append(line), lambda: bool(heard))
    assert answer == Answer(130, {"saved": True}, ("ready",)) and time.monotonic() - began < 30


def test_one_that_does_not_listen_is_ended(played, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(program, "_GRACE", 0.2)
    path = played(
        'signal.signal(signal.SIGINT, signal.SIG_IGN)\nprint("ready", file=sys.stderr, flush=True)\ntime.sleep(60)'
    )
    heard: list[str] = []
    answer = program.run([path], lambda share, line: heard.append(line), lambda: bool(heard))
    assert answer.code < 0 and answer.result == {}


def test_a_listener_that_fails_leaves_no_child(played, tmp_path: Path) -> None:
    path = played(
        'open(sys.argv[1], "w").write(str(os.getpid()))\nprint("ready", file=sys.stderr, flush=True)\ntime.sleep(60)'
    )

    def fail(share: float, line: str) -> None:
        raise RuntimeError("no window")

    with pytest.raises(RuntimeError, match="no window"):
        program.run([path, str(tmp_path / "pid")], fail)
    with pytest.raises(ProcessLookupError):
        os.kill(int((tmp_path / "pid").read_text()), 0)


@pytest.mark.parametrize(
    ("lines", "code", "complaint"),
    [
        ('print(json.dumps({"error": "expected a mesh, got none"})); sys.exit(3)', 3, "expected a mesh, got none"),
        ('print("kirisurf: expected x, got y", file=sys.stderr); sys.exit(2)', 2, "expected x, got y"),
        ("sys.exit(70)", 70, "kirisurf ended with code 70 and without a word"),
        ('print("[1]"); sys.exit(70)', 70, "kirisurf ended with code 70 and without a word"),
        ('print("not json"); sys.exit(70)', 70, "kirisurf ended with code 70 and without a word"),
    ],
)
def test_what_went_wrong_is_one_sentence(played, lines: str, code: int, complaint: str) -> None:
    answer = program.run([played(lines)])
    assert answer.code == code and answer.complaint == complaint


def test_a_program_that_cannot_start(tmp_path: Path) -> None:
    (tmp_path / "kirisurf").write_text("no program")
    with pytest.raises(ProgramError, match=r"expected to start .*kirisurf, got: Permission denied"):
        program.run([str(tmp_path / "kirisurf")])


def test_the_property_wins_over_the_variable_and_that_over_the_path(
    played, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    folders = [tmp_path / name for name in ("property", "variable", "path")]
    for folder in folders:
        (folder / "bin").mkdir(parents=True)
        os.rename(played(""), folder / "bin" / "kirisurf")
    property_, variable, path = (str(folder / "bin" / "kirisurf") for folder in folders)
    monkeypatch.setenv("PATH", str(folders[2] / "bin"))
    monkeypatch.delenv(program.VARIABLE, raising=False)
    assert program.find_program() == path
    monkeypatch.setenv(program.VARIABLE, str(folders[1]))  # the folder of an environment
    assert program.find_program() == variable
    assert program.find_program(f" {property_} ") == property_
    with pytest.raises(ProgramError, match="expected the program kirisurf or the folder of its environment, got '/no"):
        program.find_program("/nowhere")
    monkeypatch.delenv(program.VARIABLE)
    monkeypatch.setenv("PATH", str(tmp_path))
    os.unlink(tmp_path / "kirisurf") if (tmp_path / "kirisurf").exists() else None
    with pytest.raises(ProgramError, match="set the property Program or the variable KIRISURF"):
        program.find_program()


def test_the_child_sees_nothing_of_the_python_around_it(played, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("PYTHONHOME", "/opt/ParaView/lib")
    monkeypatch.setenv("PYTHONPATH", "/opt/ParaView/site-packages")
    monkeypatch.setenv("LD_LIBRARY_PATH", "/opt/ParaView-5.13/lib:/usr/local/lib")
    found = program.run([played("print(json.dumps(dict(os.environ)))")]).result
    assert not [name for name in found if name.startswith("PYTHON")]
    assert found["LD_LIBRARY_PATH"] == "/usr/local/lib"
