"""The folder that holds the deployment of a run: its files, and how they are read back.

It lies in the run's by default, and is no part of it: the hashes of the run stay as they are. It is written as a run
folder is, all files together or none, and names the run's states by their hashes, so that the deployment of a run that
was made anew does not pass for its.
"""

from __future__ import annotations

import json
import os
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float

from kirisurf.arrays import frozen
from kirisurf.errors import KirisurfError, UnreadableError
from kirisurf.formats import read_polygons
from kirisurf.formats.pieces import pieces_folder
from kirisurf.runs import Run, RunFolder
from kirisurf.runs.record import sha256

FOLDER, RECORD = "deployment", "deployment.json"
TABLE, FIGURE, SERIES, FILM = "deployment.csv", "deployment.png", "deployment.pvd", "deployment.gif"
_STATES = ("deployed.obj", "contracted.obj")


def deployment_folder(run: Run, path: str | os.PathLike[str] | None = None) -> RunFolder:
    """Return the folder that a deployment is written into, to be entered: by default `deployment` in that of the run.

    An earlier deployment there is replaced.
    """
    return RunFolder(run.folder / FOLDER if path is None else path, overwrite=True, record=RECORD)


def read_deployment(run: Run, path: str | os.PathLike[str] | None = None) -> dict[str, Any] | None:
    """Return the record of a run's deployment; None where there is none, or that of another state of the run.

    Raises
    ------
    UnreadableError
        Where there is a record that cannot be read.
    """
    file = Path(path or run.folder / FOLDER) / RECORD
    try:
        record = json.loads(file.read_text(encoding="utf-8"))
    except FileNotFoundError:
        return None
    except (OSError, ValueError) as problem:
        raise UnreadableError(f"{file}: expected the record of a deployment, got {problem}") from None
    if not isinstance(record, dict) or not isinstance(record.get("paths"), list):
        raise UnreadableError(f"{file}: expected the record of a deployment, got another file")
    return record if record.get("key") == key_of(run) else None


def read_way(run: Run) -> tuple[Float[np.ndarray, "k n 3"], float, str] | None:
    """Return the states of the first path in a run's deployment, its lambda and its drive.

    None where there is no deployment of the run, or one whose files are gone or have changed: who looks at a run must
    not be kept from it.
    """
    folder = run.folder / FOLDER
    try:
        record = read_deployment(run)
        if record is None:
            return None
        first, files = record["paths"][0], record["files"]
        states = []
        for k in range(first["states"]):
            name = f"{pieces_folder(SERIES).name}/{k:04d}_tiles.vtp"
            if sha256(folder / name) != files[name]:
                return None
            states.append(read_polygons(folder / name)[0])
        return frozen(np.array(states)), float(first["lambda"]), str(first["drive"])
    except (KirisurfError, OSError, KeyError, IndexError, TypeError, ValueError):
        return None


def key_of(run: Run) -> dict[str, str]:
    """Return the hashes of a run's states, which say whether a deployment is that of the run as it is now."""
    return {name: run.result["files"][name] for name in _STATES}
