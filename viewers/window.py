"""Windows on a design or a target, where there is a display."""

from __future__ import annotations

from kirisurf.errors import KirisurfError
from kirisurf.surface import Surface
from viewers.drawing import add_item, add_lights, aim, plain_theme
from viewers.framing import fit_frame
from viewers.opengl import on_screen_window, probe_display
from viewers.scenes import target_scene
from viewers.sheet import Sheet
from viewers.sheet_window import SheetWindow


class NoDisplayError(KirisurfError):
    """A window was asked for where there is no display; the message names the report as the alternative."""

    exit_code = 1


def show_sheet(sheet: Sheet, title: str = "kirisurf") -> None:
    """Open the window of a design and return when the user closes it.

    Raises
    ------
    NoDisplayError
        Where no window can be opened; the message names the alternative.
    """
    _require_display()
    with on_screen_window():
        window = SheetWindow(sheet, title)
        try:
            window.plotter.show()
        finally:
            window.plotter.close()


def show_surface(surface: Surface, title: str = "kirisurf", units: str = "unit") -> None:
    """Open a window with a target surface alone and return when the user closes it.

    Raises
    ------
    NoDisplayError
        Where no window can be opened.
    """
    _require_display()
    import pyvista

    with on_screen_window():
        scene = target_scene(surface, units)
        plotter = pyvista.Plotter(title=title, window_size=[1000, 800], lighting="none", theme=plain_theme())
        try:
            add_lights(plotter)
            for item in scene.items:
                add_item(plotter, item)
            aim(plotter, scene.view, fit_frame(scene.view, scene.frame, 1.25, margin=0.1))
            plotter.renderer.ResetCameraClippingRange()
            plotter.enable_anti_aliasing("msaa", multi_samples=4)
            plotter.show()
        finally:
            plotter.close()


def _require_display() -> None:
    answer = probe_display()
    if not answer.available:
        raise NoDisplayError(
            f"window: expected a display to open it on, got none: {answer.reason}. The pictures and numbers are in "
            "report.html in the run folder; `kirisurf report RUN` writes it again"
        )
