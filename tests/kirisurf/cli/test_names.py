"""Names that nobody would choose, through the commands: every file whole, nothing that steers a terminal."""

from __future__ import annotations

import os
from html.parser import HTMLParser
from pathlib import Path
from xml.parsers import expat

import pytest

import kirisurf.cli as cli
from kirisurf.formats import write_obj
from kirisurf.loops import Loops
from tests.kirisurf.formats.seeds import QUADS, VERTICES

NAME = '-it\'s "50%" #1: größe\x1b[31m\n<blink>&amp;]]>--'


class _Tags(HTMLParser):
    """Keeps the names of the elements of a page."""

    def __init__(self) -> None:
        super().__init__()
        self.found: list[str] = []

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        self.found.append(tag)


@pytest.mark.slow
def test_a_run_of_an_odd_name(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    write_obj(f"{NAME}.obj", VERTICES, Loops.from_lists(QUADS.tolist()))
    run = Path(f"run {NAME}")
    assert cli.main(["fit", "-o", str(run), "--tiles", "12", "--no-pictures", "--", f"{NAME}.obj"]) == 0
    assert cli.main(["fit", "--spec", str(run / "run.toml"), "-o", "again", "--no-pictures"]) == 0
    assert (run / "deployed.obj").read_bytes() == Path("again", "deployed.obj").read_bytes()
    assert cli.main(["audit", f"{run}/deployed.obj", f"{run}/contracted.obj", "--target", f"./{NAME}.obj"]) == 0
    assert cli.main(["report", str(run), "again", "-o", f"{run}.html", "--no-pictures"]) == 0
    assert cli.main(["export", str(run), "--to", f"{run}.svg", f"{run}.vtp", f"{run}.dxf"]) in (0, 1)
    said = capsys.readouterr()
    assert "\x1b" not in said.out + said.err
    for drawn in (run / "pattern.svg", run / "deployed.vtp", run / "run.vtm", Path(f"{run}.svg"), Path(f"{run}.vtp")):
        expat.ParserCreate().Parse(drawn.read_bytes(), True)
    for page in (run / "report.html", Path(f"{run}.html")):
        text = page.read_text(encoding="utf-8")
        tags = _Tags()
        tags.feed(text)
        assert "blink" not in tags.found
        assert "\x1b" not in text
    for line in (run / "deployed.obj").read_text(encoding="utf-8").splitlines():
        assert line[:2] in ("# ", "v ", "f ")
    # the name of a folder that XML cannot hold is said, and nothing is written
    assert cli.main(["export", str(run), "--to", f"{run}.vtm"]) == 7
    assert not Path(f"{run}.vtm").exists()


def test_a_message_is_one_line(capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["fit", "-o", "never", "--", "no\n\x1b[31msuch.obj"]) == 3
    assert len(capsys.readouterr().err.rstrip("\n").splitlines()) <= 3


def test_a_pipe_is_no_spec(tmp_path: Path) -> None:

    if hasattr(os, "mkfifo"):
        os.mkfifo(tmp_path / "run.toml")
        assert cli.main(["fit", "--spec", str(tmp_path / "run.toml"), "-o", str(tmp_path / "x")]) == 3
