"""`kirisurf view --web`: what it says where it cannot serve, and how it ends."""

from __future__ import annotations

import importlib.util
import json
import os
import socket
import stat
import time
from pathlib import Path

import pytest

from kirisurf.cli import main
from viewers import opengl
from viewers.opengl import OpenGL
from viewers.workbench.web import libraries, opener
from viewers.workbench.web.libraries import INSTALL_LINE, is_installed
from viewers.workbench.web.serving import port_error

_HERE = importlib.util.spec_from_file_location("page_process", Path(__file__).parent / "page_process.py")
page_process = importlib.util.module_from_spec(_HERE)
_HERE.loader.exec_module(page_process)


@pytest.fixture
def installed(request) -> None:
    if not is_installed():
        pytest.skip(f"{request.node.name} did not run: {INSTALL_LINE}")


def test_without_the_extra_one_sentence_says_how_to_install_it(monkeypatch, capsys):
    monkeypatch.setattr(libraries, "is_installed", lambda: False)
    assert main(["view", "hypar", "--web", "--no-browser"]) == 2
    assert INSTALL_LINE in capsys.readouterr().err


def test_without_opengl_one_sentence_says_how_to_install_it(installed, monkeypatch, capsys):
    monkeypatch.setattr(opengl, "probe", lambda: OpenGL(False, "", "Pictures cannot be drawn: install libgl1"))
    assert main(["view", "hypar", "--web", "--no-browser"]) == 1
    assert "install libgl1" in capsys.readouterr().err


@pytest.mark.parametrize("port", ["0", "65536", "-1", "http"])
def test_a_port_is_a_number_of_a_port(port, capsys):
    assert main(["view", "hypar", "--web", "--no-browser", f"--port={port}"]) == 2
    assert "--port: expected" in capsys.readouterr().err


def test_without_a_page_a_target_is_needed(capsys):
    assert main(["view"]) == 2
    assert "--web" in capsys.readouterr().err


def test_a_port_in_use_is_said_with_another_to_try(installed, opengl, capsys):
    with socket.socket() as taken:
        taken.bind(("127.0.0.1", 0))
        taken.listen()
        port = taken.getsockname()[1]
        assert main(["view", "hypar", "--web", "--no-browser", "--port", str(port)]) == 2
    said = capsys.readouterr().err
    assert f"got {port}, which another program uses" in said and "try --port" in said


def test_other_reasons_why_a_port_cannot_be_had_are_said():
    assert port_error(22, PermissionError(13, "Permission denied")).exit_code == 2
    assert port_error(8080, OSError(99, "Cannot assign requested address")).exit_code == 7


def test_it_ends_with_ctrl_c_and_takes_its_processes_along(installed, opengl):
    with page_process.PageProcess("hypar", "--cells", "2x2", "--json") as page:
        assert page.address.startswith("http://127.0.0.1:"), page.first
        children = page.children()
        assert children
        code, out, err = page.interrupt()
        assert code == 0 and "Traceback" not in err
        assert json.loads(out)["address"] == page.address
        until = time.monotonic() + 60
        while any(map(is_alive, children)) and time.monotonic() < until:
            time.sleep(0.05)
        assert not any(map(is_alive, children))


def is_alive(process):
    """Whether a process runs; one that has ended stays in the list until somebody asks how."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_the_browser_is_given_a_file_that_only_this_user_can_read(monkeypatch, tmp_path):
    given = []

    def look(address):
        path = Path(address.removeprefix("file://"))
        given.append((path.read_text("utf-8"), stat.S_IMODE(path.stat().st_mode), address))

    monkeypatch.setenv("DISPLAY", ":1")
    monkeypatch.setenv("TMPDIR", str(tmp_path))
    monkeypatch.setattr(opener.tempfile, "tempdir", None)
    monkeypatch.setattr(opener.webbrowser, "open", look)
    opener.open_page("http://127.0.0.1:1/secret/")
    until = time.monotonic() + 60
    while not given and time.monotonic() < until:
        time.sleep(0.01)
    text, mode, address = given[0]
    assert "url=http://127.0.0.1:1/secret/" in text and "secret" not in address and mode == 0o600
    for name in opener.DISPLAYS:
        monkeypatch.delenv(name, raising=False)
    given.clear()
    opener.open_page("http://127.0.0.1:1/secret/")
    time.sleep(0.05)
    assert not given or not os.sys.platform.startswith("linux")
