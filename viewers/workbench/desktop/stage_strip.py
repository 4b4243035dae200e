"""The strip of stages: target -> pattern -> guess -> fit -> contracted -> holes, to show, hide and run again."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from viewers.workbench.desktop.qt import qt
from viewers.workbench.pipeline import STAGES, Stage


class StageStrip:
    """A row of buttons, one for each stage.

    Parameters
    ----------
    toggle, run_again : callable
        Receive a stage.

    Attributes
    ----------
    widget : QWidget
    """

    def __init__(self, toggle: Callable[[Stage], None], run_again: Callable[[Stage], None]) -> None:
        widgets = qt().widgets
        self.widget = widgets.QWidget()
        self.widget.setObjectName("stages")
        self.widget.setAttribute(qt().core.Qt.WidgetAttribute.WA_StyledBackground)
        row = widgets.QHBoxLayout(self.widget)
        row.setContentsMargins(12, 6, 12, 6)
        row.setSpacing(3)
        label = widgets.QLabel("Show")
        label.setObjectName("muted")
        row.addWidget(label)
        row.addSpacing(6)
        self.buttons: dict[Stage, Any] = {}
        self.again: dict[Stage, Any] = {}
        for stage in STAGES:
            if stage.number:
                arrow = widgets.QLabel("\u2192")
                arrow.setObjectName("arrow")
                row.addWidget(arrow)
            button = widgets.QPushButton(stage.value.capitalize())
            button.setObjectName("stage")
            button.setCheckable(True)
            button.setToolTip(f"{stage.explained} Click to show or hide.")
            button.clicked.connect(lambda _=False, stage=stage: toggle(stage))
            again = widgets.QToolButton()
            again.setObjectName("again")
            again.setText("\u21bb")
            again.setToolTip(f"Run again from the {stage.value} on")
            again.clicked.connect(lambda _=False, stage=stage: run_again(stage))
            row.addWidget(button)
            row.addWidget(again)
            self.buttons[stage], self.again[stage] = button, again
        row.addStretch(1)

    def show(self, shown: frozenset[Stage], running: Stage | None) -> None:
        """Show which stages are drawn and which one runs."""
        for stage, button in self.buttons.items():
            button.setChecked(stage in shown)
            if button.property("running") != (stage is running):
                button.setProperty("running", stage is running)
                button.style().unpolish(button)
                button.style().polish(button)
