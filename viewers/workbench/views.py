"""Both views of a workbench in one pyvista plotter, whatever it draws into: scenes in, picks out."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from viewers.drawing import Drawn, add_item, add_lights, aim, put_values
from viewers.fields import Field
from viewers.framing import fit_frame
from viewers.items import Item
from viewers.scenes import Scene

SIDES = (0, 1)
"""Left: contracted; right: deployed."""

PICKED = ("tiles", "holes")


class Hit(NamedTuple):
    """What lies under a point of the picture: its side, the item's name (empty beside everything), and the face."""

    side: int
    name: str
    face: int


class Views:
    """Two views side by side that turn together.

    Parameters
    ----------
    plotter : pyvista.Plotter
        Of shape (1, 2).
    scale : float
        Pixels per picture point, for the width of lines.
    """

    def __init__(self, plotter: Any, scale: float = 1.0) -> None:
        self.plotter = plotter
        self._scale = scale
        self._drawn: dict[tuple[int, str], tuple[Item, Drawn]] = {}
        self._scenes: dict[int, Scene] = {}
        for side in SIDES:
            plotter.subplot(0, side)
            add_lights(plotter)
            plotter.camera.parallel_projection = True
        plotter.link_views()

    @property
    def is_linked(self) -> bool:
        """Whether both views turn together."""
        left, right = self.plotter.renderers
        return left.camera is right.camera

    def camera(self, side: int) -> Any:
        """Return the camera of a view."""
        return self.plotter.renderers[side].camera

    def show(self, scenes: tuple[Scene, Scene]) -> None:
        """Put two scenes into the plotter; what stays the same stays, what only moved is moved. Nothing is rendered."""
        # pyvista would draw after every item
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
        self.clip()
        self.plotter.suppress_rendering = False

    def clip(self) -> None:
        """Let the cameras see everything, near and far."""
        for side in SIDES:
            self.plotter.renderers[side].ResetCameraClippingRange()

    def reset(self, width: int, height: int) -> None:
        """Look at the scenes from where they say, all of them in a picture of this size."""
        scenes = [scene for scene in self._scenes.values() if len(scene.frame)]
        if not scenes:
            return
        view = scenes[-1].view
        points = np.vstack([scene.frame for scene in scenes])
        frame = fit_frame(view, points, 0.5 * max(width, 2) / max(height, 1), margin=0.06)
        for side in SIDES:
            self.plotter.subplot(0, side)
            aim(self.plotter, view, frame)
        self.clip()

    def link(self, together: bool) -> None:
        """Turn the views together, or each by itself."""
        if together and not self.is_linked:
            self.plotter.link_views()
        elif not together and self.is_linked:
            # each goes on from where both are
            copies = [self.camera(0).copy() for _ in SIDES]
            self.plotter.unlink_views()
            for side, copy in zip(SIDES, copies, strict=True):
                self.plotter.renderers[side].camera = copy
        self.clip()

    def units_per_pixel(self, side: int, height: int) -> float:
        """Length of a pixel in a view of a picture that is `height` pixels high, in units."""
        scale: float = self.camera(side).parallel_scale
        return 2.0 * scale / max(height, 1)

    def hit(self, x: float | int, y: float | int) -> Hit:
        """Return what lies under a point, given as shares of the picture from its upper left corner."""
        from vtkmodules.vtkRenderingCore import vtkCellPicker

        side = int(x > 0.5)
        picker = vtkCellPicker()
        picker.SetTolerance(0.0)
        picker.PickFromListOn()
        names = {}
        for (s, name), (_, drawn) in self._drawn.items():
            if s == side and name in PICKED:
                names[id(drawn.actor)] = name
                drawn.actor.SetPickable(True)
                picker.AddPickList(drawn.actor)
        width, height = self.plotter.render_window.GetSize()
        found = picker.Pick(x * width, height - 1 - y * height, 0.0, self.plotter.renderers[side])
        actor = picker.GetActor() if found else None
        return Hit(side, names.get(id(actor), ""), int(picker.GetCellId()) if actor is not None else -1)

    def item(self, side: int, name: str) -> Item | None:
        """Return what is drawn under a name."""
        found = self._drawn.get((side, name))
        return None if found is None else found[0]

    def drawn(self, side: int, name: str) -> Drawn | None:
        """Return actor and geometry of what is drawn under a name."""
        found = self._drawn.get((side, name))
        return None if found is None else found[1]

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
        added = add_item(self.plotter, item, scale=self._scale)
        if added is not None:
            self._drawn[key] = (item, added)

    def _remove(self, key: tuple[int, str]) -> None:
        self.plotter.subplot(0, key[0])
        self.plotter.remove_actor(self._drawn.pop(key)[1].actor, render=False, reset_camera=False)


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
