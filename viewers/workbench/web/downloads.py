"""Downloads: files that a browser takes away, written by the engine or from a run folder that it wrote."""

from __future__ import annotations

import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path

from kirisurf.errors import ParameterError
from kirisurf.exporting import export
from kirisurf.runs import read_run
from viewers.workbench.events import Draw
from viewers.workbench.scene import deployment_scenes, turntable_scenes
from viewers.workbench.session import Session


@dataclass(frozen=True)
class Kind:
    """A file that can be asked for.

    Attributes
    ----------
    suffix : str
        What follows the target's name in the file's name.
    of : str
        cut (written at once), run (from a run folder), pictures (from one with pictures) or drawing.
    words : str
        What it is, for a menu.
    needs : str
        What has to be there: save (a fit of the options as they are), snapshot (a target) or animate (a sheet).
    """

    suffix: str
    of: str
    words: str
    needs: str = "save"


KINDS = {
    "cut.svg": Kind("-cut.svg", "cut", "Cut file, SVG"),
    "cut.dxf": Kind("-cut.dxf", "cut", "Cut file, DXF"),
    "curvature.csv": Kind("-curvature.csv", "run", "Curvature of every hole, CSV"),
    "deployed.obj": Kind("-deployed.obj", "run", "Deployed sheet, OBJ"),
    "report.html": Kind("-report.html", "pictures", "Report, HTML"),
    "run.zip": Kind("-run.zip", "pictures", "The whole run, ZIP"),
    "snapshot.png": Kind(".png", "drawing", "Snapshot of both pictures, PNG", "snapshot"),
    "deployment.gif": Kind("-deployment.gif", "drawing", "Deployment, animated GIF", "animate"),
    "turntable.gif": Kind("-turntable.gif", "drawing", "Turntable, animated GIF", "animate"),
}
"""By the name that a page asks for."""


def checked_kind(name: str) -> Kind:
    """Return what is meant by a name.

    Raises
    ------
    ParameterError
        Where there is no such file.
    """
    if name not in KINDS:
        raise ParameterError(f"download: expected one of {', '.join(KINDS)}, got {name[:60]!r}")
    return KINDS[name]


def file_name(name: str, target: str) -> str:
    """Return a good name for a file in a user's folder of downloads.

    Examples
    --------
    >>> file_name("cut.svg", "/tmp/x/hood.stl")
    'hood-cut.svg'
    """
    return f"{Path(target).stem or 'target'}{checked_kind(name).suffix}"


def drawing(name: str, session: Session, path: Path) -> Draw:
    """Return the request of a picture or animation of what is on show."""
    state, results = session.state, session.results
    if name == "snapshot.png":
        return Draw(tuple(scene for scene in session.scenes() if scene.items), str(path), (1100, 1000))
    if name == "deployment.gif":
        return Draw(deployment_scenes(state, results), str(path), (800, 640))
    return Draw(turntable_scenes(session.scenes()[1]), str(path), (800, 640))


def from_run(name: str, run: Path, path: Path) -> Path:
    """Write a file of a run folder and return its path.

    Raises
    ------
    KirisurfError
        Where the run cannot be read or the file not be written.
    """
    make: dict[str, Callable[[Path, Path], Path]] = {
        "report.html": lambda run, path: run / "report.html",
        "run.zip": zipped,
        "deployed.obj": lambda run, path: export(read_run(run), path, state="deployed"),
    }
    return make.get(name, lambda run, path: export(read_run(run), path))(run, path)


def zipped(run: Path, path: Path) -> Path:
    """Write all files of a run folder into an archive, under one folder of its name."""
    with zipfile.ZipFile(path, "w", zipfile.ZIP_DEFLATED) as archive:
        for file in sorted(run.rglob("*")):
            if file.is_file():
                archive.write(file, f"{path.stem}/{file.relative_to(run)}")
    return path
