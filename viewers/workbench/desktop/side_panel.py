"""The panel of results: the field on show, numbers of what is picked, residuals, the certificate, notes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any

from viewers.fields import describe_field
from viewers.workbench.desktop.painting import paint_curves
from viewers.workbench.desktop.qt import qt
from viewers.workbench.details import Line, certificate_lines, measure_lines, picked_lines
from viewers.workbench.results import Results
from viewers.workbench.scene import colorings
from viewers.workbench.state import Coloring, State

WHERE = {"hole": "Holes", "tile": "Tiles", "vertex": "Vertices"}


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
        self._color = color
        self._known: tuple[Coloring, ...] | None = None
        self.widget = widgets.QWidget()
        self.widget.setMinimumWidth(330)
        column = widgets.QVBoxLayout(self.widget)
        column.setContentsMargins(12, 10, 12, 12)
        column.addWidget(_heading("Color by"))
        self.fields = widgets.QComboBox()
        self.fields.setMaxVisibleItems(30)
        self.fields.setSizeAdjustPolicy(widgets.QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.fields.currentIndexChanged.connect(self._chosen)
        column.addWidget(self.fields)
        tabs = widgets.QTabWidget()
        tabs.setDocumentMode(True)
        tabs.tabBar().setDrawBase(False)
        self.curves = qt().Painted(self._paint, 240)
        self.picked_title = widgets.QLabel()
        self.picked_title.setObjectName("muted")
        self.picked_title.setWordWrap(True)
        self.picked = _table(("", "value", ""))
        self.whole = _table(("", "value", ""))
        self.verdict = widgets.QLabel()
        self.verdict.setWordWrap(True)
        self.certificate = _table(("", "value", "limit", ""))
        self.notes = widgets.QLabel()
        self.notes.setWordWrap(True)
        self.notes.setTextInteractionFlags(qt().core.Qt.TextInteractionFlag.TextSelectableByMouse)
        self.notes.setAlignment(qt().core.Qt.AlignmentFlag.AlignTop)
        notes = widgets.QScrollArea()
        notes.setWidgetResizable(True)
        notes.setWidget(self.notes)
        self.tabs = tabs
        self.curves.setFixedHeight(400)
        tabs.addTab(_column(self.curves, _heading("The whole sheet"), self.whole), "Solve")
        tabs.addTab(_column(self.picked_title, self.picked), "Picked")
        tabs.addTab(_column(self.verdict, self.certificate), "Certificate")
        tabs.addTab(notes, "Notes")
        column.addSpacing(6)
        column.addWidget(tabs, 1)
        self._steps: Sequence[Any] = ()
        self._tolerance = 1e-9
        self._numbers: tuple[Line, ...] = ()
        self._fitted: Any = None

    def show(self, state: State, results: Results) -> None:
        """Show what is known."""
        self._show_fields(state, results)
        if results.steps is not self._steps or state.spec.tolerance != self._tolerance:
            self._steps, self._tolerance = results.steps, state.spec.tolerance
            self.curves.update()
        self._show_picked(state, results)
        self._show_verdict(results)
        sentences = [f"\u26a0 {warning}" for warning in results.warnings] + list(results.notes)
        text = "\n\n".join(sentences) or "Nothing to say yet."
        if self.notes.text() != text:
            self.notes.setText(text)

    def _show_fields(self, state: State, results: Results) -> None:
        known = colorings(results)
        self.fields.blockSignals(True)
        if known != self._known:
            self._known = known
            self.fields.clear()
            self.fields.addItem("plain tiles", None)
            for where, title in WHERE.items():
                names = [name for place, name in known if place == where]
                if names:
                    self.fields.insertSeparator(self.fields.count())
                for name in names:
                    values = results.sheet.fields[where, name] if results.sheet is not None else ()
                    label = describe_field(name, where, values, limits=(0.0, 1.0)).label  # type: ignore[arg-type]
                    self.fields.addItem(f"{title}: {label}", f"{where}/{name}")
        index = self.fields.findData("/".join(state.coloring)) if state.coloring is not None else 0
        self.fields.setCurrentIndex(max(index, 0))
        self.fields.blockSignals(False)

    def _show_picked(self, state: State, results: Results) -> None:
        lines: tuple[Line, ...] = ()
        title = "Click a tile or a hole in one of the pictures to read its numbers."
        if results.sheet is not None and state.selection is not None:
            lines = picked_lines(results.sheet, state.selection)
            title = f"{state.selection.kind.capitalize()} {state.selection.number}"
        if results.fitted is not self._fitted:
            self._fitted = results.fitted
            known = () if results.fitted is None else measure_lines(results.fitted.numbers, results.fitted.spec.units)
            _fill(self.whole, [(line.label, line.value, line.unit) for line in known])
        if lines != self._numbers or self.picked_title.text() != title:
            self._numbers = lines
            self.picked_title.setText(title)
            _fill(self.picked, [(line.label, line.value, line.unit) for line in lines])

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
        _fill(self.certificate, [(row.title, row.value, row.limit, row.mark) for row in rows])
        for k, row in enumerate(rows):
            self.certificate.item(k, 0).setToolTip(row.meaning)
            self.certificate.item(k, 3).setToolTip(row.verdict_word)

    def _chosen(self, index: int) -> None:
        chosen = self.fields.itemData(index)
        where, _, name = str(chosen or "").partition("/")
        self._color((where, name) if chosen else None)

    def _paint(self, painter: Any, width: int, height: int) -> None:
        paint_curves(painter, width, height, [step.residuals for step in self._steps], self._tolerance)


def _heading(words: str) -> Any:
    label = qt().widgets.QLabel(words)
    label.setObjectName("muted")
    return label


def _column(*inside: Any) -> Any:
    holder = qt().widgets.QWidget()
    column = qt().widgets.QVBoxLayout(holder)
    column.setContentsMargins(0, 10, 0, 0)
    for widget in inside:
        column.addWidget(widget)
    return holder


def _table(headers: Sequence[str]) -> Any:
    widgets = qt().widgets
    table = widgets.QTableWidget(0, len(headers))
    table.setHorizontalHeaderLabels(list(headers))
    table.horizontalHeader().setVisible("limit" in headers)
    table.verticalHeader().hide()
    table.setEditTriggers(widgets.QAbstractItemView.EditTrigger.NoEditTriggers)
    table.setSelectionMode(widgets.QAbstractItemView.SelectionMode.NoSelection)
    table.setFocusPolicy(qt().core.Qt.FocusPolicy.NoFocus)
    table.setShowGrid(False)
    modes = widgets.QHeaderView.ResizeMode
    table.horizontalHeader().setSectionResizeMode(modes.ResizeToContents)
    table.horizontalHeader().setSectionResizeMode(0, modes.Stretch)
    table.setWordWrap(True)
    table.verticalHeader().setSectionResizeMode(modes.ResizeToContents)
    return table


def _fill(table: Any, rows: Sequence[Sequence[str]]) -> None:
    widgets = qt().widgets
    table.setRowCount(len(rows))
    for i, row in enumerate(rows):
        for j, words in enumerate(row):
            item = widgets.QTableWidgetItem(words)
            item.setToolTip(words)
            table.setItem(i, j, item)
