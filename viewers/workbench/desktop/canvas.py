"""The canvas: both views of a workbench in one OpenGL widget. Scenes in; picks and drags out."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from viewers.drawing import plain_theme
from viewers.items import Item
from viewers.scenes import Scene
from viewers.workbench.desktop.qt import qt
from viewers.workbench.placing import turn_and_ratio
from viewers.workbench.views import SIDES, Views

__all__ = ["SIDES", "Canvas"]

SOFTWARE = ("llvmpipe", "softpipe", "swrast", "swiftshader")
"""What OpenGL calls itself where the processor draws."""

STILL = 4
"""Pixels that a click may move without being a drag."""


class Canvas:
    """Two linked views.

    Parameters
    ----------
    parent : QWidget
    pick : callable
        Receives the side, the item's name (or an empty text beside everything) and the number of the face.
    drag : callable
        While patterns are placed: receives the angle (degrees) and the ratio of distances from the middle of the
        target since the drag began, and whether it has ended.

    Attributes
    ----------
    plotter : QtInteractor
    views : Views
    is_placing : bool
        Whether a drag on the right view turns and sizes the pattern instead of the camera.
    """

    def __init__(
        self, parent: Any, pick: Callable[[int, str, int], None], drag: Callable[[float, float, bool], None]
    ) -> None:
        self._pick, self._drag = pick, drag
        self.plotter = qt().Plotter(
            parent,
            shape=(1, 2),
            lighting="none",
            border=False,
            theme=plain_theme(),
            auto_update=False,
            line_smoothing=False,
            multi_samples=4,
        )
        self.is_placing = False
        self.views = Views(self.plotter)
        self._is_judged = False
        self._pressed: tuple[float, float] | None = None
        self._first_look: tuple[Any, ...] | None = None
        self._listener = qt().Listener(self._heard)
        self.plotter.interactor.installEventFilter(self._listener)

    @property
    def widget(self) -> Any:
        """The widget to put into a layout."""
        return self.plotter.interactor

    def show(self, scenes: tuple[Scene, Scene]) -> None:
        """Draw two scenes; what stays the same stays, what only moved is moved."""
        # one frame is drawn, when Qt next paints
        self.views.show(scenes)
        if not self._is_judged and self.widget.isValid():
            self._judge()
        self.widget.update()

    def reset_view(self) -> None:
        """Look at the scenes from where they say, all of them in the picture."""
        self.views.reset(self.widget.width(), self.widget.height())
        self._first_look = self._look()
        self.widget.update()

    def _look(self) -> tuple[Any, ...]:
        """Where the cameras stand."""
        cameras = [renderer.camera for renderer in self.plotter.renderers]
        return tuple((each.position, each.focal_point, each.up, each.parallel_scale) for each in cameras)

    def _resized(self) -> None:
        """Keep everything in the picture when its size changes, as long as the user has not turned it."""
        if self._first_look is not None and self._look() == self._first_look:
            self.reset_view()

    def link(self, together: bool) -> None:
        """Turn the views together, or each by itself."""
        self.views.link(together)
        self.widget.update()

    def units_per_pixel(self, side: int) -> float:
        """Length of a screen pixel in a view, in units."""
        return self.views.units_per_pixel(side, self.widget.height())

    def close(self) -> None:
        """Give the OpenGL window back."""
        self.widget.removeEventFilter(self._listener)
        self.plotter.close()

    def _judge(self) -> None:
        """Leave smooth edges to machines with a graphics card: without one they take two thirds of a frame."""
        # asked of Qt's own context: VTK's question ends a process that has none, as under Qt's off-screen platform
        self._is_judged = True
        told = self.plotter.render_window.ReportCapabilities().lower()
        if any(name in told for name in SOFTWARE):
            self.plotter.render_window.SetMultiSamples(0)

    def _heard(self, event: Any) -> bool:
        """Hear presses, moves and releases of the left button; True keeps one from turning the camera."""
        kinds = qt().core.QEvent.Type
        kind = event.type()
        if kind == kinds.Resize:
            # after the widget has taken its new size
            qt().core.QTimer.singleShot(0, self._resized)
        if kind not in (kinds.MouseButtonPress, kinds.MouseMove, kinds.MouseButtonRelease):
            return False
        left = qt().core.Qt.MouseButton.LeftButton
        if kind != kinds.MouseMove and event.button() != left:
            return False
        here = (event.position().x(), event.position().y())
        if kind == kinds.MouseButtonPress:
            self._pressed = here
            return self._places(here)
        if self._pressed is None:
            return False
        pressed = self._pressed
        if kind == kinds.MouseButtonRelease:
            self._pressed = None
            moved = max(abs(here[0] - pressed[0]), abs(here[1] - pressed[1])) > STILL
            if not moved:
                self._pick_at(here)
            elif self._places(pressed):
                self._drag(*self._turn(pressed, here), True)
            return self._places(pressed)
        if self._places(pressed):
            self._drag(*self._turn(pressed, here), False)
            return True
        return False

    def _places(self, where: tuple[float, float]) -> bool:
        return self.is_placing and where[0] > 0.5 * self.widget.width()

    def _turn(self, first: tuple[float, float], last: tuple[float, float]) -> tuple[float, float]:
        """Angle (degrees, counter-clockwise) and ratio of distances about the middle of the right view."""
        return turn_and_ratio(first, last, (0.75 * self.widget.width(), 0.5 * self.widget.height()))

    def _pick_at(self, where: tuple[float, float]) -> None:
        self._pick(*self.views.hit(where[0] / self.widget.width(), where[1] / self.widget.height()))

    def item(self, side: int, name: str) -> Item | None:
        """Return what is drawn under a name."""
        return self.views.item(side, name)
