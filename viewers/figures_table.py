"""The table of published configurations as one self-contained page."""

from __future__ import annotations

import base64
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from viewers.words import number


@dataclass(frozen=True)
class TableRow:
    """One line of the table; numbers that are None are shown as a dash.

    Attributes
    ----------
    heading : str
        Of the group of lines that it belongs to.
    values : tuple of tuple of (float, int, str or None)
        The cells, by group of columns (see `ColumnGroup`); those of the first group name the line.
    shortcomings : tuple of str
        Why the line is not as it should be; empty where it is.
    """

    heading: str
    values: tuple[tuple[float | int | str | None, ...], ...]
    shortcomings: tuple[str, ...] = ()


@dataclass(frozen=True)
class ColumnGroup:
    """Columns under one heading: title, and the columns' titles."""

    title: str
    columns: tuple[str, ...]


def table_page(
    title: str,
    lead: Sequence[str],
    groups: Sequence[ColumnGroup],
    rows: Sequence[TableRow],
    picture: bytes | None = None,
) -> str:
    """Return the page: a verdict, a table with groups of columns, and a picture below it.

    Parameters
    ----------
    title : str
    lead : sequence of str
        Paragraphs on what the columns are.
    groups : sequence of ColumnGroup
    rows : sequence of TableRow
    picture : bytes, optional
        PNG.

    Returns
    -------
    str
        HTML.
    """
    headings = list(dict.fromkeys(row.heading for row in rows))
    shown = [
        (heading, [(_name(row), _cells(row), row.shortcomings) for row in rows if row.heading == heading])
        for heading in headings
    ]
    good = sum(not row.shortcomings for row in rows)
    address = None if picture is None else f"data:image/png;base64,{base64.b64encode(picture).decode('ascii')}"
    return _template().render(
        title=title,
        lead=lead,
        groups=groups,
        width=sum(len(group.columns) for group in groups) + 1,
        sections=shown,
        good=good,
        total=len(rows),
        picture=address,
    )


def _cells(row: TableRow) -> list[tuple[str, bool]]:
    """Text of every cell, and whether it begins a group."""
    return [(_text(value), k == 0 and g > 0) for g, values in enumerate(row.values) for k, value in enumerate(values)]


def _name(row: TableRow) -> str:
    return " ".join(value for value in row.values[0] if isinstance(value, str))


def _text(value: float | int | str | None) -> str:
    if isinstance(value, float) and 0 < abs(value) < 9.5e-3:
        return f"{value:.0e}".replace("e-0", "e-")
    return number(value)


def _template() -> Any:
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("viewers", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template("published.html")
