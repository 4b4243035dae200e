"""The middle of the window: both pictures with titles and scale bars, the color bar, and the deployment slider."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from viewers.fields import Field
from viewers.scenes import Scene
from viewers.workbench.desktop.canvas import SIDES, Canvas
from viewers.workbench.desktop.painting import paint_color_bar, paint_scale_bar
from viewers.workbench.desktop.qt import qt


class PicturesPanel:
    """Two pictures side by side and what belongs to them.

    Parameters
    ----------
    pick, drag : callable
        As for :class:`Canvas`.
    deploy : callable
        Receives the deployment in hundredths.

    Attributes
    ----------
    widget : QWidget
    canvas : Canvas
    titles : list of QLabel
    slider : QSlider
        Deployment, in hundredths.
    """

    def __init__(
        self,
        pick: Callable[[int, str, int], None],
        drag: Callable[[float, float, bool], None],
        deploy: Callable[[int], None],
    ) -> None:
        widgets, core = qt().widgets, qt().core
        self._scenes: tuple[Scene, ...] = ()
        self._field: Field | None = None
        self._per_pixel = [0.0, 0.0]
        self.widget = widgets.QWidget()
        self.widget.setObjectName("paper")
        self.widget.setAttribute(core.Qt.WidgetAttribute.WA_StyledBackground)
        column = widgets.QVBoxLayout(self.widget)
        column.setContentsMargins(0, 8, 0, 0)
        column.setSpacing(0)
        heads, feet = widgets.QHBoxLayout(), widgets.QHBoxLayout()
        self.titles: list[Any] = []
        self._feet: list[Any] = []
        for side in SIDES:
            title = widgets.QLabel()
            title.setObjectName("title")
            title.setContentsMargins(14, 0, 0, 2)
            # as wide as the picture below it, whatever it says
            title.setSizePolicy(widgets.QSizePolicy.Policy.Ignored, widgets.QSizePolicy.Policy.Fixed)
            heads.addWidget(title, 1)
            foot = qt().Painted(lambda *canvas, side=side: self._paint_foot(side, *canvas), 26)
            feet.addWidget(foot, 1)
            self.titles.append(title)
            self._feet.append(foot)
        self.canvas = Canvas(self.widget, pick, drag)
        self._bar = qt().Painted(self._paint_bar, 58)
        self._bar.setMaximumHeight(58)
        self.slider = widgets.QSlider(core.Qt.Orientation.Horizontal)
        self.slider.setRange(0, 100)
        self.slider.setToolTip("Moves the sheet between its states: tiles turn part of their way. No mechanical path.")
        self.slider.valueChanged.connect(deploy)
        column.addLayout(heads)
        column.addWidget(self.canvas.widget, 1)
        column.addLayout(feet)
        column.addWidget(self._bar)
        column.addLayout(_between_words(self.slider, "contracted", "deployed"))

    def show(self, scenes: tuple[Scene, Scene], field: Field | None, share: float, can_deploy: bool) -> None:
        """Show the contracted and the deployed view, the field that colors them, and the deployment."""
        self._scenes, self._field = scenes, field
        self.canvas.show(scenes)
        for side, scene in zip(SIDES, scenes, strict=True):
            if self.titles[side].text() != scene.title:
                self.titles[side].setText(scene.title)
                self.titles[side].setToolTip(scene.title)
            self._feet[side].update()
        self._bar.update()
        self.slider.setEnabled(can_deploy)
        self.slider.blockSignals(True)
        self.slider.setValue(round(100 * share))
        self.slider.blockSignals(False)

    def measure(self) -> None:
        """Let the scale bars follow the cameras."""
        for side in SIDES:
            per_pixel = self.canvas.units_per_pixel(side)
            if per_pixel != self._per_pixel[side]:
                self._per_pixel[side] = per_pixel
                self._feet[side].update()

    def _paint_bar(self, painter: Any, width: int, height: int) -> None:
        paint_color_bar(painter, width, height, self._field)

    def _paint_foot(self, side: int, painter: Any, width: int, height: int) -> None:
        if self._scenes and self._scenes[side].items:
            scene = self._scenes[side]
            paint_scale_bar(painter, width, height, self._per_pixel[side], scene.units, scene.note)


def _between_words(slider: Any, first: str, last: str) -> Any:
    widgets = qt().widgets
    row = widgets.QHBoxLayout()
    row.setContentsMargins(14, 4, 14, 10)
    row.setSpacing(12)
    for part in (widgets.QLabel(first), slider, widgets.QLabel(last)):
        if part is not slider:
            part.setObjectName("muted")
        row.addWidget(part)
    return row
