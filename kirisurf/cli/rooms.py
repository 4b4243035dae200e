"""Whether `analysis`, `viewers` and `sample_surfaces` are kirisurf's own and not a user's file of that name."""

from __future__ import annotations

import importlib.util
from pathlib import Path

from kirisurf.errors import KirisurfError

ROOMS = ("analysis", "viewers", "sample_surfaces")


def check_rooms() -> None:
    """Check that the packages beside kirisurf are the ones that would be imported.

    Raises
    ------
    KirisurfError
        Where a file or folder of the same name comes first on Python's path, or one is missing.
    """
    home = Path(__file__).resolve().parents[2]
    for name in ROOMS:
        spec = importlib.util.find_spec(name)
        if spec is None:
            raise KirisurfError(f"expected kirisurf's package {name!r}, got none: install kirisurf again")
        place = spec.origin or next(iter(spec.submodule_search_locations or ()), "an unknown place")
        if Path(place).resolve().parent != home / name:
            raise KirisurfError(
                f"expected kirisurf's own package {name!r}, got {place}, which comes first on Python's path: "
                "rename it, take its folder out of PYTHONPATH, or run from another folder"
            )
