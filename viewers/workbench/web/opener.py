"""Opening the page in the user's browser, without its key on a command line that other users could read."""

from __future__ import annotations

import os
import sys
import tempfile
import threading
import webbrowser
from html import escape
from pathlib import Path

DISPLAYS = ("DISPLAY", "WAYLAND_DISPLAY")
KEPT = 60.0
"""Seconds after which the file that leads to the page is removed: a browser that starts may take some."""


def open_page(address: str) -> None:
    """Open an address in the user's browser, if there is one; returns at once.

    The browser is given a file that only this user can read and that leads on to the address. Without a display there
    is none to open: those that draw into a terminal would take it from kirisurf.
    """
    if sys.platform.startswith("linux") and not any(os.environ.get(name) for name in DISPLAYS):
        return
    threading.Thread(target=_open, args=(address,), daemon=True).start()


def redirect(address: str) -> str:
    """Return a page that leads on to an address at once.

    Examples
    --------
    >>> "url=http://127.0.0.1:1/k/" in redirect("http://127.0.0.1:1/k/")
    True
    """
    shown = escape(address, quote=True)
    return (
        '<!doctype html><meta charset="utf-8"><meta name="referrer" content="no-referrer"><title>kirisurf</title>'
        f'<meta http-equiv="refresh" content="0; url={shown}"><p><a href="{shown}">Open the workbench</a></p>\n'
    )


def _open(address: str) -> None:
    handle, name = tempfile.mkstemp(prefix="kirisurf-", suffix=".html")
    path = Path(name)
    with os.fdopen(handle, "w", encoding="utf-8") as file:
        file.write(redirect(address))
    timer = threading.Timer(KEPT, path.unlink, kwargs={"missing_ok": True})
    timer.daemon = True
    timer.start()
    try:
        webbrowser.open(path.as_uri())
    except (webbrowser.Error, OSError):
        # its address stands in the terminal
        path.unlink(missing_ok=True)
