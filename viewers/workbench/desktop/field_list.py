"""The list of fields to color by: in groups with headings, in words and units, each with a line that explains it."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from viewers.workbench.desktop.qt import qt
from viewers.workbench.field_groups import WHERE, field_groups
from viewers.workbench.results import Results
from viewers.workbench.scene import colorings
from viewers.workbench.state import Coloring, State

PLAIN = "Nothing: plain tiles"
ROWS = 26
MARGIN = 40
"""Pixels beside the longest row, for the bar to scroll by."""


class FieldList:
    """A heading that says what is colored, and the list to choose from.

    Parameters
    ----------
    color : callable
        Receives the field to color by, or None.

    Attributes
    ----------
    heading : QLabel
    box : QComboBox
        The data of a row is "where/name", None for plain tiles and for headings.
    """

    def __init__(self, color: Callable[[Coloring | None], None]) -> None:
        widgets = qt().widgets
        self._color = color
        self._known: tuple[Any, ...] | None = None
        self.heading = widgets.QLabel()
        self.heading.setObjectName("muted")
        self.box = widgets.QComboBox()
        self.box.setMaxVisibleItems(ROWS)
        # rows are styled by this delegate alone
        self.box.setItemDelegate(widgets.QStyledItemDelegate(self.box))
        self.box.setObjectName("fields")
        self.box.view().setVerticalScrollBarPolicy(qt().core.Qt.ScrollBarPolicy.ScrollBarAsNeeded)
        self.box.setSizeAdjustPolicy(widgets.QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        self.box.currentIndexChanged.connect(self._chosen)

    def show(self, state: State, results: Results) -> None:
        """Show the fields of the sheet there is, and the one that colors it."""
        known = colorings(results)
        units = "unit" if results.sheet is None else results.sheet.units
        self.box.blockSignals(True)
        if (known, units) != self._known:
            self._known = known, units
            self._fill(known, units)
        self.box.setEnabled(bool(known))
        chosen = state.coloring if state.coloring in known else None
        self.box.setCurrentIndex(max(self.box.findData("/".join(chosen)) if chosen is not None else 0, 0))
        self.box.setToolTip(self.box.currentData(qt().core.Qt.ItemDataRole.ToolTipRole) or "")
        self.box.blockSignals(False)
        self.heading.setText("Color by" if chosen is None else f"Color the {WHERE[chosen[0]]} by")

    def _fill(self, known: tuple[Coloring, ...], units: str) -> None:
        role = qt().core.Qt.ItemDataRole.ToolTipRole
        self.box.clear()
        self.box.addItem(PLAIN if known else "\u2013", None)
        for group in field_groups(known, units):
            self.box.addItem(group.title, None)
            heading = self.box.model().item(self.box.count() - 1)
            heading.setFlags(qt().core.Qt.ItemFlag.NoItemFlags)
            font = heading.font()
            font.setBold(True)
            heading.setFont(font)
            for choice in group.choices:
                self.box.addItem(choice.words, f"{choice.where}/{choice.name}")
                self.box.setItemData(self.box.count() - 1, choice.explained or choice.words, role)
        view = self.box.view()
        view.setMinimumWidth(view.sizeHintForColumn(0) + MARGIN)

    def _chosen(self, index: int) -> None:
        where, _, name = str(self.box.itemData(index) or "").partition("/")
        self._color((where, name) if name else None)
