"""Opening the window and waiting until its user closes it."""

from __future__ import annotations

import os
import signal
import sys
from typing import Any

from viewers.opengl import VARIABLE
from viewers.workbench.desktop.qt import is_installed, qt
from viewers.workbench.desktop.window import Workbench
from viewers.workbench.engine import Engine
from viewers.workbench.results import Results
from viewers.workbench.session import Session
from viewers.workbench.state import State


def application() -> Any:
    """Return the Qt application of this process, made where there is none."""
    widgets = qt().widgets
    found = widgets.QApplication.instance()
    if found is None:
        found = widgets.QApplication(["kirisurf"])
        found.setApplicationName("kirisurf")
        found.setStyle("Fusion")
    return found


def prepare() -> Engine:
    """Start an engine and load Qt, where it is installed: both take a second, and neither opens anything."""
    engine = Engine()
    if is_installed():
        engine.warm_up()
        qt()
    return engine


def show_workbench(state: State, results: Results, title: str = "kirisurf", engine: Engine | None = None) -> None:
    """Open a workbench and return when its user closes it.

    Parameters
    ----------
    state : State
    results : Results
        What is known already; a target alone is fitted at once.
    title : str
    engine : Engine, optional
        One that was prepared; it is closed with the window.

    Raises
    ------
    ParameterError
        Where the extra kirisurf[desktop] is not installed.
    """
    # a window that a person sees, whatever the environment asks for off-screen
    os.environ.pop(VARIABLE, None)
    engine = engine or prepare()
    app = application()
    # Ctrl-C in the terminal closes the window; the timer of the window lets Python hear it
    names = [getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)]
    before = {number: signal.signal(number, lambda *_: app.quit()) for number in names}
    bench = Workbench(Session(state, results, engine), title)
    hook = sys.excepthook
    # Qt goes on after an exception in one of its callbacks: the user should know
    sys.excepthook = lambda kind, problem, trace: bench.say(f"internal error: {kind.__name__}: {problem}", True)
    try:
        bench.window.show()
        if results.sheet is None:
            bench.fit()
        app.exec()
    finally:
        bench.close()
        sys.excepthook = hook
        for number, handler in before.items():
            signal.signal(number, handler)
