"""DXF for a user without a home folder, as a container has."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

HOMELESS = """
import os, pwd

def nobody(user):
    raise KeyError(user)

pwd.getpwuid = nobody
assert os.path.expanduser("~") == "~"
from kirisurf.dxf_library import load_dxf_library
load_dxf_library()
import ezdxf
print(ezdxf.new("R2000").dxfversion, "HOME" in os.environ)
"""


def test_no_home_folder_is_needed(tmp_path: Path) -> None:
    environment = {key: value for key, value in os.environ.items() if key != "HOME" and not key.startswith("XDG_")}
    environment["PYTHONPATH"] = str(Path(__file__).resolve().parents[2])
    command = [sys.executable, "-c", HOMELESS]
    child = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)
    assert (child.stdout, child.stderr) == ("AC1015 False\n", "")
    assert not list(tmp_path.iterdir())


def test_a_home_folder_stays_what_it_was(monkeypatch) -> None:
    from kirisurf.dxf_library import load_dxf_library

    monkeypatch.setenv("HOME", "/somewhere")
    load_dxf_library()
    assert os.environ["HOME"] == "/somewhere"
