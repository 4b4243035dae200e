"""The library that reads and writes DXF, loaded also where there is no home folder."""

from __future__ import annotations

import logging
import os

# What it says while it reads stands in its audit too; that it can keep no list of fonts changes nothing here.
logging.getLogger("ezdxf").addHandler(logging.NullHandler())


def load_dxf_library() -> None:
    """Import ezdxf, which asks for a home folder: a user without a name, as in a container, is without one."""
    is_homeless = os.path.expanduser("~") == "~"
    if is_homeless:
        os.environ["HOME"] = os.devnull  # no folder: nothing is found there, and nothing kept
    try:
        import ezdxf  # noqa: F401
    finally:
        if is_homeless:
            del os.environ["HOME"]
