"""The script that shows a run draws gray tiles and holes in the colors of their sign, and says what it cannot show."""

from __future__ import annotations

import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from kirisurf.runs import Run
from viewers.paraview import show_run

from .conftest import paraview_environment

SCRIPT = Path(show_run.__file__).resolve()


def shown(*words: object) -> subprocess.CompletedProcess[str]:
    """Run the script under a virtual display, or skip."""
    programs = [shutil.which(name) for name in ("xvfb-run", "pvpython")]
    if None in programs:
        pytest.skip("the picture in ParaView did not run: it needs pvpython and xvfb-run (Debian: paraview, xvfb)")
    ended = subprocess.run(
        [programs[0], "-a", programs[1], str(SCRIPT), *map(str, words)],
        capture_output=True,
        text=True,
        env=paraview_environment(),
        timeout=300,
        check=False,
    )
    if "bad X server connection" in ended.stderr:
        pytest.skip("the picture in ParaView did not run: the virtual display could not be used")
    return ended


@pytest.mark.slow
def test_holes_of_a_saddle_are_blue(run: Run, tmp_path: Path) -> None:
    ended = shown(run.folder, tmp_path / "a.png")
    assert ended.returncode == 0, ended.stderr
    picture = np.asarray(Image.open(tmp_path / "a.png").convert("RGB")).astype(int)
    middle = picture[:, : int(0.85 * picture.shape[1])]  # without the color bar
    red, green, blue = middle.reshape(-1, 3).T
    share = {
        "blue": (blue > red + 30).mean(),
        "red": (red > blue + 60).mean(),
        "gray": ((abs(red - blue) < 25) & (red < 215) & (red > 60)).mean(),
        "white": ((red > 250) & (green > 250) & (blue > 250)).mean(),
    }
    # K < 0 everywhere: no hole is red (the axes in the corner have some)
    assert share["blue"] > 0.05 and share["gray"] > 0.05 and share["red"] < 0.005 and share["white"] > 0.3


@pytest.mark.slow
@pytest.mark.parametrize("words", [("deployed.vtp",), ("run.vtm", "nothing"), ()])
def test_what_cannot_be_shown_is_one_sentence(run: Run, tmp_path: Path, words: tuple[str, ...]) -> None:
    path = [run.folder / words[0], tmp_path / "a.png", *words[1:]] if words else []
    ended = shown(*path)
    assert ended.returncode == 2 and "Traceback" not in ended.stderr
    assert ended.stderr.count("show_run: expected ") == 1 and ", got " in ended.stderr
    assert list(tmp_path.iterdir()) == []
