"""The panel of results: the field on show, numbers of what is picked, residuals, the certificate, notes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from viewers.fields import describe_field
from viewers.workbench.desktop.field_list import FieldList
from viewers.workbench.desktop.painting import paint_curves
from viewers.workbench.desktop.qt import qt
from viewers.workbench.desktop.style import WARNING
from viewers.workbench.desktop.tables import fill_table, make_table
from viewers.workbench.details import Line, certificate_lines, measure_lines, picked_lines
from viewers.workbench.results import Results
from viewers.workbench.state import Coloring, State

CURVES = (
    "Every line is one family of conditions on the sheet, and its largest violation at every step of the solver: "
    "lengths over a tile edge, angles in radians. Below the dashed line it counts as met."
)
CERTIFICATE = "L: the median tile edge. Point at a row to read what it means."


class SidePanel:
    """Everything to the right of the pictures.

    Parameters
    ----------
    color : callable
        Receives the field to color by, or None.

    Attributes
    ----------
    widget : QWidget
    """

    def __init__(self, color: Callable[[Coloring | None], None]) -> None:
        widgets = qt().widgets
        self.widget = widgets.QWidget()
        self.widget.setMinimumWidth(310)
        column = widgets.QVBoxLayout(self.widget)
        column.setContentsMargins(12, 10, 12, 12)
        self._fields = FieldList(color)
        self.fields = self._fields.box
        column.addWidget(self._fields.heading)
        column.addWidget(self.fields)
        tabs = widgets.QTabWidget()
        tabs.setDocumentMode(True)
        tabs.tabBar().setDrawBase(False)
        self.curves = qt().Painted(self._paint, 190)
        self.curves.setToolTip(CURVES)
        self.picked_title = widgets.QLabel()
        self.picked_title.setObjectName("muted")
        self.picked_title.setWordWrap(True)
        self.picked = make_table(("", "", ""))
        self.whole = make_table(("", "", ""))
        self.verdict = widgets.QLabel()
        self.verdict.setWordWrap(True)
        self.certificate = make_table(("", "value", "limit", "", ""))
        self.notes = widgets.QLabel()
        self.notes.setWordWrap(True)
        self.notes.setTextInteractionFlags(qt().core.Qt.TextInteractionFlag.TextSelectableByMouse)
        self.notes.setAlignment(qt().core.Qt.AlignmentFlag.AlignTop)
        notes = widgets.QScrollArea()
        notes.setWidgetResizable(True)
        notes.setWidget(self.notes)
        self.tabs = tabs
        self.curves.setMaximumHeight(400)
        tabs.addTab(_column(self.curves, _heading("The whole sheet"), self.whole), "Solve")
        tabs.addTab(_column(self.picked_title, self.picked), "Picked")
        tabs.addTab(_column(self.verdict, self.certificate, _heading(CERTIFICATE)), "Certificate")
        tabs.addTab(notes, "Notes")
        column.addSpacing(6)
        column.addWidget(tabs, 1)
        self._steps: Sequence[Any] = ()
        self._tolerance = 1e-9
        self._numbers: tuple[tuple[Line, ...], str] = (), ""
        self._fitted: Any = None

    def show(self, state: State, results: Results) -> None:
        """Show what is known."""
        self._fields.show(state, results)
        if results.steps is not self._steps or state.spec.tolerance != self._tolerance:
            self._steps, self._tolerance = results.steps, state.spec.tolerance
            self.curves.update()
        self._show_picked(state, results)
        self._show_verdict(results)
        sentences = [f"\u26a0 {warning}" for warning in results.warnings] + list(results.notes)
        text = "\n\n".join(sentences) or "Nothing to say yet."
        if self.notes.text() != text:
            self.notes.setText(text)

    def _show_picked(self, state: State, results: Results) -> None:
        lines: tuple[Line, ...] = ()
        title = "Click a tile or a hole in one of the pictures to read its numbers."
        if results.sheet is not None and state.selection is not None:
            lines = picked_lines(results.sheet, state.selection)
            title = f"{state.selection.kind.capitalize()} {state.selection.number}"
        if results.fitted is not self._fitted:
            self._fitted = results.fitted
            known = () if results.fitted is None else measure_lines(results.fitted.numbers, results.fitted.spec.units)
            fill_table(self.whole, [(line.label, line.value, line.unit) for line in known])
        colored = _label(state) if lines else ""
        if (lines, colored) != self._numbers or self.picked_title.text() != title:
            self._numbers = lines, colored
            self.picked_title.setText(title)
            # the field on show stands out among the others
            strong = [k for k, line in enumerate(lines) if colored and line.label.split(", at a corner")[0] == colored]
            fill_table(self.picked, [(line.label, line.value, line.unit) for line in lines], strong)

    def _show_verdict(self, results: Results) -> None:
        rows = certificate_lines(results.certified)
        if results.certified is None:
            words = "No verdict yet." if results.running is None else "Being checked."
        elif results.certified.passed:
            words = "Certified: closed and opened it is one sheet of the same rigid tiles."
        else:
            count = len(results.certified.failures)
            words = f"Not certified: {count} row{'s' * (count > 1)} fail{'s' * (count == 1)}."
        if self.verdict.text() == words and self.certificate.rowCount() == len(rows):
            return
        self.verdict.setText(words)
        # what fails comes first
        rows = tuple(sorted(rows, key=lambda row: row.verdict != "fail"))
        failing = [k for k, row in enumerate(rows) if row.verdict == "fail"]
        words_of_rows = [(row.title, row.value, row.limit, row.short_unit, row.mark) for row in rows]
        fill_table(self.certificate, words_of_rows, failing, WARNING)
        self.tabs.setTabText(2, "Certificate \u2717" if failing else "Certificate")
        for k, row in enumerate(rows):
            self.certificate.item(k, 0).setToolTip(row.meaning)
            self.certificate.item(k, 4).setToolTip(row.verdict_word)

    def _paint(self, painter: Any, width: int, height: int) -> None:
        paint_curves(painter, width, height, [step.residuals for step in self._steps], self._tolerance)


def _label(state: State) -> str:
    """The words of the field that colors the sheet; empty for plain tiles."""
    if state.coloring is None:
        return ""
    where, name = state.coloring
    return describe_field(name, where, np.zeros(0), limits=(0.0, 1.0)).label


def _heading(words: str) -> Any:
    label = qt().widgets.QLabel(words)
    label.setWordWrap(True)
    label.setObjectName("muted")
    return label


def _column(*inside: Any) -> Any:
    holder = qt().widgets.QWidget()
    column = qt().widgets.QVBoxLayout(holder)
    column.setContentsMargins(0, 10, 0, 0)
    for widget in inside:
        column.addWidget(widget, 0 if isinstance(widget, qt().widgets.QLabel) else 1)
    return holder
