"""The canvas: both views of a workbench in one OpenGL widget. Scenes in; picks and drags out."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from viewers.drawing import Drawn, add_item, add_lights, aim, plain_theme, put_values
from viewers.fields import Field
from viewers.framing import fit_frame
from viewers.items import Item
from viewers.scenes import Scene
from viewers.workbench.desktop.qt import qt

SIDES = (0, 1)
"""Left: contracted; right: deployed."""

PICKED = ("tiles", "holes")
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
        self._drawn: dict[tuple[int, str], tuple[Item, Drawn]] = {}
        self._scenes: dict[int, Scene] = {}
        self._is_judged = False
        self._pressed: tuple[float, float] | None = None
        for side in SIDES:
            self.plotter.subplot(0, side)
            add_lights(self.plotter)
            self.plotter.camera.parallel_projection = True
        self.plotter.link_views()
        self._listener = qt().Listener(self._heard)
        self.plotter.interactor.installEventFilter(self._listener)

    @property
    def widget(self) -> Any:
        """The widget to put into a layout."""
        return self.plotter.interactor

    def show(self, scenes: tuple[Scene, Scene]) -> None:
        """Draw two scenes; what stays the same stays, what only moved is moved."""
        # pyvista would draw after every item, and Qt once more: one frame is drawn, when Qt next paints
        self.plotter.suppress_rendering = True
        for side, scene in zip(SIDES, scenes, strict=True):
            self._scenes[side] = scene
            self.plotter.subplot(0, side)
            wanted = {item.name for item in scene.items}
            for key in [key for key in self._drawn if key[0] == side and key[1] not in wanted]:
                self._remove(key)
            for item in scene.items:
                self._draw(side, item)
        self.plotter.subplot(0, 1)
        for side in SIDES:
            self.plotter.renderers[side].ResetCameraClippingRange()
        self.plotter.suppress_rendering = False
        if not self._is_judged and self.widget.isValid():
            self._judge()
        self.widget.update()

    def reset_view(self) -> None:
        """Look at the scenes from where they say, all of them in the picture."""
        scenes = [scene for scene in self._scenes.values() if len(scene.frame)]
        if not scenes:
            return
        width, height = max(self.widget.width(), 2), max(self.widget.height(), 1)
        points = np.vstack([scene.frame for scene in scenes])
        view = scenes[-1].view
        frame = fit_frame(view, points, 0.5 * width / height, margin=0.06)
        for side in SIDES:
            self.plotter.subplot(0, side)
            aim(self.plotter, view, frame)
            self.plotter.renderers[side].ResetCameraClippingRange()
        self.widget.update()

    def link(self, together: bool) -> None:
        """Turn the views together, or each by itself."""
        if together:
            self.plotter.link_views()
        elif self.plotter.renderers[0].camera is self.plotter.renderers[1].camera:
            # each goes on from where both are
            copies = [self.plotter.renderers[0].camera.copy() for _ in SIDES]
            self.plotter.unlink_views()
            for side, copy in zip(SIDES, copies, strict=True):
                self.plotter.renderers[side].camera = copy
                self.plotter.renderers[side].ResetCameraClippingRange()
        self.widget.update()

    def units_per_pixel(self, side: int) -> float:
        """Length of a screen pixel in a view, in units."""
        scale: float = self.plotter.renderers[side].camera.parallel_scale
        return 2.0 * scale / max(self.widget.height(), 1)

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

    def _draw(self, side: int, item: Item) -> None:
        key = (side, item.name)
        if key in self._drawn:
            before, drawn = self._drawn[key]
            if _only_moved(before, item):
                if before.points is not item.points:
                    drawn.data.points = np.array(item.points)
                if item.field is not None and before.field is not item.field:
                    put_values(drawn.data, item.field)
                    drawn.actor.mapper.scalar_range = item.field.limits
                self._drawn[key] = (item, drawn)
                return
            self._remove(key)
        added = add_item(self.plotter, item)
        if added is not None:
            self._drawn[key] = (item, added)

    def _remove(self, key: tuple[int, str]) -> None:
        self.plotter.subplot(0, key[0])
        self.plotter.remove_actor(self._drawn.pop(key)[1].actor, render=False, reset_camera=False)

    def _heard(self, event: Any) -> bool:
        """Hear presses, moves and releases of the left button; True keeps one from turning the camera."""
        kinds = qt().core.QEvent.Type
        kind = event.type()
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
        middle = np.array([0.75 * self.widget.width(), 0.5 * self.widget.height()])
        a, b = ((np.array(place) - middle) * (1.0, -1.0) for place in (first, last))
        angle = np.degrees(np.arctan2(b[1], b[0]) - np.arctan2(a[1], a[0]))
        ratio = float(np.linalg.norm(b) / max(float(np.linalg.norm(a)), 20.0))
        return float((angle + 180.0) % 360.0 - 180.0), max(ratio, 0.05)

    def _pick_at(self, where: tuple[float, float]) -> None:
        from vtkmodules.vtkRenderingCore import vtkCellPicker

        side = int(where[0] > 0.5 * self.widget.width())
        picker = vtkCellPicker()
        picker.SetTolerance(0.0)
        picker.PickFromListOn()
        pickable = {id(drawn.actor): name for (s, name), (_, drawn) in self._drawn.items() if s == side}
        for (s, name), (_, drawn) in self._drawn.items():
            if s == side and name in PICKED:
                drawn.actor.SetPickable(True)
                picker.AddPickList(drawn.actor)
        width, height = self.plotter.render_window.GetSize()
        x = where[0] * width / self.widget.width()
        y = height - 1 - where[1] * height / self.widget.height()
        hit = picker.Pick(x, y, 0.0, self.plotter.renderers[side])
        actor = picker.GetActor() if hit else None
        self._pick(side, pickable.get(id(actor), ""), int(picker.GetCellId()) if actor is not None else -1)

    def item(self, side: int, name: str) -> Item | None:
        """Return what is drawn under a name."""
        found = self._drawn.get((side, name))
        return None if found is None else found[0]


def _only_moved(before: Item, after: Item) -> bool:
    """Whether one item can be drawn as another one that moved or changed its values."""
    same = before.kind == after.kind and before.color == after.color and before.layer == after.layer
    same = same and before.width == after.width and len(before.points) == len(after.points)
    same = same and (before.normals is after.normals) and _same_map(before.field, after.field)
    if not same or before.loops is after.loops:
        return same
    return np.array_equal(before.loops.indices, after.loops.indices) and np.array_equal(
        before.loops.offsets, after.loops.offsets
    )


def _same_map(before: Field | None, after: Field | None) -> bool:
    if before is None or after is None:
        return before is after
    return before.where == after.where and before.signed == after.signed
