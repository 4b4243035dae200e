"""Qt, loaded when a window is asked for and never before: PySide6 and pyvistaqt are an extra of kirisurf.

PySide6 is Qt's own binding, under the LGPL (PyQt6 is GPL), and pyvistaqt puts a pyvista plotter into a window of it.
Widgets are held, not inherited from, so that every module here can be imported without Qt; the classes that Qt
wants to be inherited from are made here.
"""

from __future__ import annotations

import importlib
import importlib.util
import os
from collections.abc import Callable
from functools import cache
from types import SimpleNamespace
from typing import Any

from kirisurf.errors import ParameterError

INSTALL_LINE = "pip install 'kirisurf[desktop]'"
LIBRARY_LINE = (
    "on Debian or Ubuntu: apt-get install libegl1 libxkbcommon-x11-0 libxcb-cursor0 libxcb-icccm4 libxcb-keysyms1"
)
LIBRARIES = ("PySide6", "qtpy", "pyvistaqt")


def is_installed() -> bool:
    """Return whether the extra kirisurf[desktop] is there."""
    return all(importlib.util.find_spec(name) is not None for name in LIBRARIES)


@cache
def qt() -> Any:
    """Return Qt: its modules as `core`, `gui`, `widgets`; pyvista's `Plotter`; classes of our own.

    These are `Painted`, `Listener`, `Window` and `Asking`.

    Raises
    ------
    ParameterError
        Where the extra is not installed, or does not load.
    """
    if not is_installed():
        raise ParameterError(f"workbench: expected PySide6 and pyvistaqt, got a set-up without; install {INSTALL_LINE}")
    os.environ["QT_API"] = "pyside6"
    try:
        core, gui, widgets = (importlib.import_module(f"PySide6.Qt{name}") for name in ("Core", "Gui", "Widgets"))
        interactor = importlib.import_module("pyvistaqt").QtInteractor
    except ImportError as problem:
        raise ParameterError(
            f"workbench: expected PySide6 and pyvistaqt, got ones that do not load ({problem}); {LIBRARY_LINE}"
        ) from None
    return SimpleNamespace(core=core, gui=gui, widgets=widgets, Plotter=interactor, **_classes(core, gui, widgets))


def _classes(core: Any, gui: Any, widgets: Any) -> dict[str, Any]:
    class Painted(widgets.QWidget):
        """A widget that a function paints: it receives a painter, the width and the height."""

        def __init__(self, paint: Callable[[Any, int, int], None], height: int) -> None:
            super().__init__()
            self._paint = paint
            self.setMinimumHeight(height)

        def paintEvent(self, event: Any) -> None:
            painter = gui.QPainter(self)
            painter.setRenderHint(gui.QPainter.RenderHint.Antialiasing)
            try:
                self._paint(painter, self.width(), self.height())
            finally:
                painter.end()

    class Listener(core.QObject):
        """Hears the events of a widget before the widget does; those that `heard` says True to end there."""

        def __init__(self, heard: Callable[[Any], bool]) -> None:
            super().__init__()
            self._heard = heard

        def eventFilter(self, watched: Any, event: Any) -> bool:
            return self._heard(event)

    class Window(widgets.QMainWindow):
        """A main window that says when it is closed, and which file was dropped on it."""

        on_close: Callable[[], None] | None = None
        on_drop: Callable[[str], None] | None = None

        def __init__(self) -> None:
            super().__init__()
            self.setAcceptDrops(True)

        def closeEvent(self, event: Any) -> None:
            if self.on_close is not None:
                self.on_close()
            super().closeEvent(event)

        def dragEnterEvent(self, event: Any) -> None:
            if any(url.isLocalFile() for url in event.mimeData().urls()):
                event.acceptProposedAction()

        def dropEvent(self, event: Any) -> None:
            files = [url.toLocalFile() for url in event.mimeData().urls() if url.isLocalFile()]
            if files and self.on_drop is not None:
                event.acceptProposedAction()
                self.on_drop(files[0])

    class Asking(widgets.QFileDialog):
        """A file dialog whose answer a function may refuse: it receives the path as typed."""

        allows: Callable[[str], bool] | None = None

        def accept(self) -> None:
            line = self.findChild(widgets.QLineEdit)
            if self.allows is None or self.allows(self.directory().absoluteFilePath(line.text())):
                super().accept()

    return {"Painted": Painted, "Listener": Listener, "Window": Window, "Asking": Asking}
