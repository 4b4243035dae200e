"""The panel of options: one row for each, made from the table in `options`; every change is told at once."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

from kirisurf.spec import FitSpec
from viewers.workbench.desktop.qt import qt
from viewers.workbench.options import Option, is_offered, options, with_cells, with_tiles

Changed = Callable[[str, Any], None]
LAYOUT = (
    "Unit cells: columns and rows, stretched to the target's four corners. "
    "Trimmed: a regular pattern of about so many tiles, cut where it leaves the target."
)
WIDTH = 286
NARROW = 56
"""Least width of an editor: Qt would ask for that of the largest number it takes."""
ROW = 26
"""Least height of an editor, in pixels: Qt squeezes spin boxes where rows are hidden and shown again."""


class OptionPanel:
    """Rows of options.

    Parameters
    ----------
    change : callable
        Receives the name of an option and its new value.
    replace_spec : callable
        Receives a whole spec, where rectangular patterns are exchanged for trimmed ones.

    Attributes
    ----------
    widget : QWidget
    """

    def __init__(self, change: Changed, replace_spec: Callable[[FitSpec], None]) -> None:
        self._change, self._replace_spec = change, replace_spec
        self._spec: FitSpec | None = None
        self._rows: dict[str, tuple[Option, Any, Any]] = {}
        widgets, self._alignment = qt().widgets, qt().core.Qt.AlignmentFlag
        inside = widgets.QWidget()
        column = widgets.QVBoxLayout(inside)
        column.setContentsMargins(12, 4, 12, 12)
        for group in dict.fromkeys(option.group for option in options()):
            column.addWidget(self._group(group))
        column.addStretch(1)
        self.widget = widgets.QScrollArea()
        self.widget.setWidgetResizable(True)
        self.widget.setHorizontalScrollBarPolicy(qt().core.Qt.ScrollBarPolicy.ScrollBarAlwaysOff)
        self.widget.setWidget(inside)
        # with the bar to scroll by, which would otherwise lie on the editors
        extent = self.widget.style().pixelMetric(widgets.QStyle.PixelMetric.PM_ScrollBarExtent)
        self.widget.setMinimumWidth(WIDTH + extent)

    def show(self, spec: FitSpec) -> None:
        """Show the values of a spec, without telling of it as a change."""
        self._spec = spec
        self._kind.blockSignals(True)
        self._kind.setCurrentIndex(0 if spec.cells is not None else 1)
        self._kind.blockSignals(False)
        for option, editor, label in self._rows.values():
            offered = is_offered(option, spec)
            if option.name in ("cells", "tiles", "orientation"):
                editor.setVisible(offered)
                label.setVisible(offered)
            editor.setEnabled(offered)
            show_value(option, editor, getattr(spec, option.name))

    def editor(self, name: str) -> Any:
        """Return the widget that edits an option."""
        return self._rows[name][1]

    def _group(self, group: str) -> Any:
        widgets = qt().widgets
        box = widgets.QGroupBox(group)
        form = widgets.QFormLayout(box)
        form.setContentsMargins(0, 6, 0, 0)
        form.setHorizontalSpacing(10)
        form.setLabelAlignment(self._alignment.AlignLeft | self._alignment.AlignVCenter)
        form.setFieldGrowthPolicy(widgets.QFormLayout.FieldGrowthPolicy.AllNonFixedFieldsGrow)
        for option in options():
            if option.group != group:
                continue
            if option.name == "cells":
                self._kind = widgets.QComboBox()
                self._kind.addItems(["unit cells, to four corners", "trimmed to the outline"])
                self._kind.currentIndexChanged.connect(self._exchange)
                layout = widgets.QLabel("Layout")
                for widget in (layout, self._kind):
                    widget.setToolTip(LAYOUT)
                self._kind.setMinimumWidth(NARROW)
                leave_to_window(self._kind)
                form.addRow(layout, self._kind)
            editor = make_editor(option, partial(self._change, option.name))
            label = widgets.QLabel(option.label)
            for widget in (label, editor):
                widget.setToolTip(option.help)
            for inner in getattr(editor, "sides", [editor]):
                inner.setMinimumSize(NARROW, ROW)
                leave_to_window(inner)
            form.addRow(label, editor)
            self._rows[option.name] = (option, editor, label)
        return box

    def _exchange(self, index: int) -> None:
        if self._spec is not None:
            self._replace_spec(with_cells(self._spec) if index == 0 else with_tiles(self._spec))


def leave_to_window(editor: Any) -> None:
    """Leave to the window what an editor would take: the wheel where it was not clicked before, undo and redo."""
    core, keys = qt().core, qt().gui.QKeySequence.StandardKey
    kinds = core.QEvent.Type
    editor.setFocusPolicy(core.Qt.FocusPolicy.StrongFocus)

    def heard(event: Any) -> bool:
        kind = event.type()
        leaves = (kind == kinds.Wheel and not editor.hasFocus()) or (
            kind == kinds.ShortcutOverride and (event.matches(keys.Undo) or event.matches(keys.Redo))
        )
        if leaves:
            event.ignore()
        return leaves

    editor.listener = qt().Listener(heard)
    for widget in (editor, *editor.findChildren(qt().widgets.QLineEdit)):
        widget.installEventFilter(editor.listener)


def make_editor(option: Option, tell: Callable[[Any], None]) -> Any:
    """Return the widget that edits an option and tells its new values."""
    widgets = qt().widgets
    if option.kind == "choice":
        choice = widgets.QComboBox()
        choice.setEditable(option.is_open)
        for name in option.choices:
            choice.addItem(name or "not said (mm)", name)
        if option.is_open:
            choice.setInsertPolicy(widgets.QComboBox.InsertPolicy.NoInsert)
            choice.lineEdit().editingFinished.connect(lambda: tell(choice.currentText()))
            choice.activated.connect(lambda index: tell(choice.itemData(index)))
        else:
            choice.currentIndexChanged.connect(lambda index: tell(choice.itemData(index)))
        choice.setSizeAdjustPolicy(widgets.QComboBox.SizeAdjustPolicy.AdjustToMinimumContentsLengthWithIcon)
        return choice
    if option.kind == "pair":
        pair = widgets.QWidget()
        row = widgets.QHBoxLayout(pair)
        row.setContentsMargins(0, 0, 0, 0)
        pair.sides = []
        for k in range(2):
            side = widgets.QSpinBox()
            side.setRange(1, int(option.most))
            side.setKeyboardTracking(False)
            row.addWidget(side, 1)
            pair.sides.append(side)
            if k == 0:
                row.addWidget(widgets.QLabel("\u00d7"))
        for side in pair.sides:
            side.valueChanged.connect(lambda _: tell(tuple(each.value() for each in pair.sides)))
        return pair
    whole = option.kind == "whole"
    editor = widgets.QSpinBox() if whole else widgets.QDoubleSpinBox()
    # the lowest value says that there is none
    lowest = option.least - option.step if option.without else option.least
    if not whole:
        editor.setDecimals(option.digits)
    editor.setRange(int(lowest) if whole else lowest, int(option.most) if whole else option.most)
    editor.setSingleStep(int(option.step) if whole else option.step)
    editor.setKeyboardTracking(False)
    if option.unit:
        editor.setSuffix(option.unit)
    if option.without:
        editor.setSpecialValueText(option.without)

    def told(value: float) -> None:
        tell(option.without_value if option.without and value < option.least else value)

    editor.valueChanged.connect(told)
    return editor


def show_value(option: Option, editor: Any, value: Any) -> None:
    """Show a value in its editor, without telling of it as a change."""
    inner = getattr(editor, "sides", [editor])
    for widget in inner:
        widget.blockSignals(True)
    if option.kind == "choice":
        index = editor.findData(value if value is not None else "")
        if index >= 0:
            editor.setCurrentIndex(index)
        elif option.is_open:
            editor.setEditText(str(value))
        else:
            editor.addItem(str(value), value)
            editor.setCurrentIndex(editor.count() - 1)
    elif option.kind == "pair":
        for side, count in zip(editor.sides, value or (), strict=False):
            _show_number(side, count)
    else:
        _show_number(editor, editor.minimum() if value is None or isinstance(value, str) else value)
    for widget in inner:
        widget.blockSignals(False)


def _show_number(editor: Any, value: float | int) -> None:
    """Show a number where there is another: a report of a fit takes nothing from what is just being typed."""
    shown = round(value, editor.decimals()) if hasattr(editor, "decimals") else value
    if editor.value() != shown:
        editor.setValue(value)
