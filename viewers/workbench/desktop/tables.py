"""Tables of numbers: words to the left, values and units to the right."""

from __future__ import annotations

from collections.abc import Collection, Sequence
from typing import Any

from viewers.workbench.desktop.qt import qt


def make_table(headers: Sequence[str]) -> Any:
    """Return an empty table; the heads of its columns are shown where one of them says something."""
    widgets = qt().widgets
    table = widgets.QTableWidget(0, len(headers))
    table.setHorizontalHeaderLabels(list(headers))
    table.horizontalHeader().setVisible(any(headers))
    table.horizontalHeader().setDefaultAlignment(qt().core.Qt.AlignmentFlag.AlignLeft)
    table.verticalHeader().hide()
    table.setEditTriggers(widgets.QAbstractItemView.EditTrigger.NoEditTriggers)
    table.setSelectionMode(widgets.QAbstractItemView.SelectionMode.NoSelection)
    table.setFocusPolicy(qt().core.Qt.FocusPolicy.NoFocus)
    table.setShowGrid(False)
    modes = widgets.QHeaderView.ResizeMode
    table.horizontalHeader().setSectionResizeMode(modes.ResizeToContents)
    table.horizontalHeader().setSectionResizeMode(0, modes.Stretch)
    # rows that wrap get their height once the width of the first column is known
    table.horizontalHeader().sectionResized.connect(table.resizeRowsToContents)
    table.setWordWrap(True)
    table.verticalHeader().setSectionResizeMode(modes.ResizeToContents)
    return table


def fill_table(
    table: Any, rows: Sequence[Sequence[str]], strong: Collection[int] = (), color: str | None = None
) -> None:
    """Put rows of words into a table; the strong ones are bold, and of a color where one is given."""
    widgets, gui = qt().widgets, qt().gui
    table.setRowCount(len(rows))
    for i, row in enumerate(rows):
        for j, words in enumerate(row):
            item = widgets.QTableWidgetItem(words)
            item.setToolTip(words)
            if i in strong:
                font = item.font()
                font.setBold(True)
                item.setFont(font)
                if color is not None:
                    item.setForeground(gui.QColor(color))
            table.setItem(i, j, item)
    # a bar to scroll by that comes with the rows makes the first column narrower, and its rows higher
    qt().core.QTimer.singleShot(0, table, table.resizeRowsToContents)
