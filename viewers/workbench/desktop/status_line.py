"""The line at the foot of the window: what was done, what is wrong, and how far a job is."""

from __future__ import annotations

from typing import Any

from viewers.workbench.desktop.painting import paint_progress
from viewers.workbench.desktop.qt import qt

WIDTH = 220
BESIDE = WIDTH + 40
"""Pixels of the line that the sentence does not get."""


class StatusLine:
    """A sentence and a progress bar.

    A problem with what the user just did stays until the next deed, whatever a fit that runs has to tell.

    Parameters
    ----------
    bar : QStatusBar

    Attributes
    ----------
    label : QLabel
    progress : QWidget
    """

    def __init__(self, bar: Any) -> None:
        widgets = qt().widgets
        self._bar = bar
        self._held, self._is_problem = "", False
        self._share: float | None = None
        bar.setSizeGripEnabled(False)
        bar.setContentsMargins(10, 0, 10, 0)
        self.label = widgets.QLabel()
        self.label.setWordWrap(True)
        self.label.setTextInteractionFlags(qt().core.Qt.TextInteractionFlag.TextSelectableByMouse)
        self.label.setSizePolicy(widgets.QSizePolicy.Policy.Ignored, widgets.QSizePolicy.Policy.Preferred)
        # not Qt's own, which paints the whole window at once whenever it moves
        self.progress = qt().Painted(self._paint, 6)
        self.progress.setFixedSize(WIDTH, 6)
        bar.addWidget(self.label, 1)
        bar.addPermanentWidget(self.progress)

    def hold(self, words: str, is_problem: bool = False) -> None:
        """Say what stays until :meth:`forget`: what is wrong with the last deed, what a hand that drags does."""
        self._held, self._is_problem = words, is_problem
        self.say(words, is_problem)

    def forget(self) -> None:
        """Let the next words replace what was held."""
        self._held = ""

    def follow(self, words: str, is_problem: bool, share: float | None) -> None:
        """Say what a job tells, and show how far it is (None: there is none)."""
        if self._held:
            self.say(self._held, self._is_problem)
        else:
            self.say(words, is_problem)
        if share != self._share:
            self._share = share
            self.progress.update()

    def say(self, words: str, is_problem: bool = False) -> None:
        """Say something now."""
        shown = f"\u26a0 {words}" if is_problem else words
        if self.label.text() == shown:
            return
        name = "problem" if is_problem else "muted"
        if self.label.objectName() != name:
            self.label.setObjectName(name)
            self.label.style().unpolish(self.label)
            self.label.style().polish(self.label)
        self.label.setText(shown)
        self.label.setToolTip(words)
        # a long sentence gets as many lines as it needs: the bar alone would cut it
        self.label.setFixedHeight(self.label.heightForWidth(max(self._bar.width() - BESIDE, 200)))

    def _paint(self, painter: Any, width: int, height: int) -> None:
        paint_progress(painter, width, height, self._share)
