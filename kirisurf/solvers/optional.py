"""Libraries that only some solvers need: loaded when such a solver is chosen, never before."""

from __future__ import annotations

import importlib
import importlib.util
from types import ModuleType

from kirisurf.errors import ParameterError

LIBRARIES = {"ipopt": "ipyopt", "uno": "unopy"}
"""Library of every solver that needs one."""


def is_installed(solver: str) -> bool:
    """Return whether the library of a solver is there; True for a solver that needs none."""
    return solver not in LIBRARIES or importlib.util.find_spec(LIBRARIES[solver]) is not None


def library(solver: str) -> ModuleType:
    """Load the library of a solver.

    Raises
    ------
    ParameterError
        Where it is not installed, or does not load.
    """
    name = LIBRARIES[solver]
    remedy = "install the extra kirisurf[peers] (Linux), or use --solver auto"
    if not is_installed(solver):
        raise ParameterError(f"--solver {solver}: expected {name}, got a set-up without it: {remedy}")
    try:
        return importlib.import_module(name)
    except ImportError as problem:
        raise ParameterError(
            f"--solver {solver}: expected {name}, got one that does not load ({problem}): {remedy}"
        ) from None
