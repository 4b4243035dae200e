"""What the page needs beyond kirisurf itself: an extra, looked for before anything is opened."""

from __future__ import annotations

import importlib.util

from kirisurf.errors import ParameterError

INSTALL_LINE = "pip install 'kirisurf[web]'"
LIBRARIES = ("trame", "aiohttp")


def is_installed() -> bool:
    """Return whether the extra kirisurf[web] is there."""
    return all(importlib.util.find_spec(name) is not None for name in LIBRARIES)


def require_libraries() -> None:
    """Raise a ParameterError with the line that installs what is missing, where something is."""
    if not is_installed():
        raise ParameterError(f"--web: expected trame, got a set-up without; install it: {INSTALL_LINE}")
