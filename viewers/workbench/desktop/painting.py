"""What Qt paints beside the pictures: the color bar of a field, the scale bar of a view, the curves of a solve."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from viewers import theme
from viewers.drawing import colormap
from viewers.fields import Field, name_unit
from viewers.framing import round_length
from viewers.words import number
from viewers.workbench.axis import ticks
from viewers.workbench.desktop.qt import qt


def paint_color_bar(painter: Any, width: int, height: int, field: Field | None) -> None:
    """Paint label, colors and numbers of a field; nothing without one."""
    if field is None:
        return
    gui, core = qt().gui, qt().core
    left, right, top, thick = 14, 14, 24, 12
    span = width - left - right
    words = field.label[:1].upper() + field.label[1:] + (f"  ({field.unit})" if field.unit else "")
    _text(painter, left, 16, words)
    room = span - _text_width(painter, words) - 20
    if field.range_note and _text_width(painter, field.range_note) <= room:
        _text(painter, width - right, 16, field.range_note, theme.MUTED, "right")
    gradient = gui.QLinearGradient(left, 0, left + span, 0)
    colors = colormap(field)(np.linspace(0.0, 1.0, 65))
    for k, color in enumerate(colors):
        gradient.setColorAt(k / 64, gui.QColor.fromRgbF(*(float(c) for c in color)))
    painter.fillRect(core.QRectF(left, top, span, thick), gui.QBrush(gradient))
    low, high = field.limits
    for value in ticks(low, high):
        x = left + span * (value - low) / (high - low)
        painter.setPen(gui.QColor(theme.MUTED))
        painter.drawLine(core.QPointF(x, top + thick), core.QPointF(x, top + thick + 4))
        _text(painter, x, top + thick + 17, number(value), theme.INK, "center")
    below, above = field.exceeds
    for is_outside, x, sign in ((below, left, -1), (above, left + span, 1)):
        if is_outside:
            painter.setBrush(gui.QColor.fromRgbF(*(float(c) for c in colors[0 if sign < 0 else -1])))
            painter.setPen(core.Qt.PenStyle.NoPen)
            corners = ((x, top), (x + 9 * sign, top + 0.5 * thick), (x, top + thick))
            painter.drawPolygon(gui.QPolygonF([core.QPointF(*corner) for corner in corners]))


def paint_scale_bar(painter: Any, width: int, height: int, per_pixel: float, units: str, note: str) -> None:
    """Paint a bar of a round length, and a note to its right."""
    gui, core = qt().gui, qt().core
    taken = 0.0
    if per_pixel > 0:
        length = round_length(0.22 * width * per_pixel)
        x0, x1, y = 14.0, 14.0 + length / per_pixel, 0.5 * height
        painter.setPen(gui.QPen(gui.QColor(theme.INK), 1.4))
        for a, b in (((x0, y), (x1, y)), ((x0, y - 4), (x0, y + 4)), ((x1, y - 4), (x1, y + 4))):
            painter.drawLine(core.QPointF(*a), core.QPointF(*b))
        words = f"{length:g} {name_unit(units, length)}"
        _text(painter, x1 + 8, y + 5, words)
        taken = x1 + 8 + _text_width(painter, words)
    if _text_width(painter, note) <= width - 14 - 10 - taken:
        _text(painter, width - 14, 0.5 * height + 5, note, theme.MUTED, "right")


def paint_progress(painter: Any, width: int, height: int, share: float | None) -> None:
    """Paint how far a job is; nothing while there is none."""
    if share is None:
        return
    gui, core = qt().gui, qt().core
    painter.setPen(core.Qt.PenStyle.NoPen)
    for part, color in ((1.0, theme.HAIRLINE), (share, theme.SERIES[0])):
        painter.setBrush(gui.QColor(color))
        painter.drawRoundedRect(core.QRectF(0, 0, part * width, height), 0.5 * height, 0.5 * height)


def paint_curves(painter: Any, width: int, height: int, steps: Sequence[Mapping[str, float]], tolerance: float) -> None:
    """Paint the largest residual of every block over the steps, on a logarithmic scale."""
    gui, core = qt().gui, qt().core
    painter.fillRect(core.QRectF(0, 0, width, height), gui.QColor(theme.PAPER))
    blocks = [name for name in dict.fromkeys(name for step in steps for name in step)]
    shown = [name for name in blocks if any(step.get(name, 0.0) > 0 for step in steps)]
    rows = -(-len(shown) // 2)
    left, right, top = 44, 10, 10
    bottom = 24 + 18 * max(rows, 1)
    low, high = -16.5, 1.0
    plot_width, plot_height = width - left - right, height - top - bottom

    def place(k: int, value: float) -> Any:
        share = (np.log10(max(value, 10.0**low)) - low) / (high - low)
        x = left + plot_width * (k / max(len(steps) - 1, 1))
        return core.QPointF(x, top + plot_height * (1.0 - min(share, 1.0)))

    for power in range(-16, 1, 4):
        y = place(0, 10.0**power).y()
        painter.setPen(gui.QColor(theme.HAIRLINE))
        painter.drawLine(core.QPointF(left, y), core.QPointF(width - right, y))
        _text(painter, left - 5, y + 4, f"1e{power}" if power else "1", theme.MUTED, "right", 11)
    y = place(0, tolerance).y()
    pen = gui.QPen(gui.QColor(theme.MUTED), 1.0, core.Qt.PenStyle.DashLine)
    painter.setPen(pen)
    painter.drawLine(core.QPointF(left, y), core.QPointF(width - right, y))
    # to the left: the curves come down to it at the right
    _text(painter, left + 4, y + 13, "tolerance", theme.MUTED, "left", 11)
    _text(painter, left + 0.5 * plot_width, top + plot_height + 16, _steps_in_words(len(steps)), theme.MUTED, "center")
    for k, name in enumerate(shown):
        color = gui.QColor(theme.SERIES[k % len(theme.SERIES)])
        style = (core.Qt.PenStyle.SolidLine, core.Qt.PenStyle.DashLine)[k // len(theme.SERIES) % 2]
        painter.setPen(gui.QPen(color, 1.8, style))
        places = [place(i, step[name]) for i, step in enumerate(steps) if name in step]
        painter.drawPolyline(gui.QPolygonF(places))
        painter.setBrush(color)
        for at in places:
            painter.drawEllipse(at, 1.6, 1.6)
        x, y = left + (k % 2) * 0.5 * plot_width, height - bottom + 36 + 18 * (k // 2)
        painter.drawLine(core.QPointF(x, y - 4), core.QPointF(x + 16, y - 4))
        _text(painter, x + 21, y, name.replace("_", " "), theme.INK, "left", 12)


def _steps_in_words(count: int) -> str:
    return "no steps yet" if count == 0 else f"{count} step{'s' * (count > 1)}; worst of every condition"


def _text_width(painter: Any, words: str, size: int = 12) -> float:
    font = painter.font()
    font.setPixelSize(size)
    return float(qt().gui.QFontMetricsF(font).horizontalAdvance(words))


def _text(
    painter: Any,
    x: float | int,
    y: float | int,
    words: str,
    color: str = theme.INK,
    align: str = "left",
    size: int = 12,
) -> None:
    gui = qt().gui
    font = painter.font()
    font.setPixelSize(size)
    painter.setFont(font)
    painter.setPen(gui.QColor(color))
    length = _text_width(painter, words, size)
    start = x - {"left": 0.0, "center": 0.5 * length, "right": length}[align]
    painter.drawText(qt().core.QPointF(start, y), words)
