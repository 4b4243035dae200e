"""The page of a report: templates, pictures as data: addresses, and numbers that say where they stand in the JSON."""

from __future__ import annotations

import base64
import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from kirisurf.errors import OutputError, ParameterError
from kirisurf.field_units import unit_label
from viewers.fields import name_unit
from viewers.words import number

if TYPE_CHECKING:
    from markupsafe import Markup

_MEDIA = {".png": "image/png", ".svg": "image/svg+xml", ".jpg": "image/jpeg", ".jpeg": "image/jpeg"}
_MINUS = "\N{MINUS SIGN}"


@dataclass(frozen=True)
class Picture:
    """A picture in the page.

    Attributes
    ----------
    name : str
    address : str
        data: address.
    text : str
        What stands for it where it cannot be seen.
    """

    name: str
    address: str
    text: str


def embed(name: str, file: Path, text: str = "") -> Picture:
    """Return a picture file as part of the page.

    Raises
    ------
    ParameterError
        Where the suffix is not .png, .jpg or .svg.
    OutputError
        Where the file cannot be read.
    """
    media = _MEDIA.get(file.suffix.lower())
    if media is None:
        raise ParameterError(f"picture {name}: expected a file of kind {', '.join(_MEDIA)}, got {file.name}")
    try:
        content = file.read_bytes()
    except OSError as problem:
        raise OutputError(f"picture {name}: expected a readable file, got {problem.strerror or problem}") from None
    return Picture(name, data_address(media, content), text or name.replace("_", " "))


def chart_picture(name: str, svg: str, text: str) -> Picture:
    """Return a chart (SVG text) as part of the page."""
    return Picture(name, data_address("image/svg+xml", svg.encode()), text)


def data_address(media: str, content: bytes) -> str:
    """Return content as a data: address."""
    return f"data:{media};base64,{base64.b64encode(content).decode('ascii')}"


def pointed(document: Any, pointer: str) -> Any:
    """Return what a JSON pointer (RFC 6901) points to; None where there is nothing.

    Examples
    --------
    >>> pointed({"a": [{"b/c": 3}]}, "/a/0/b~1c")
    3
    """
    for token in pointer.split("/")[1:]:
        key = token.replace("~1", "/").replace("~0", "~")
        if isinstance(document, Mapping):
            document = document.get(key)
        elif isinstance(document, (list, tuple)) and key.isdecimal() and int(key) < len(document):
            document = document[int(key)]
        else:
            return None
    return document


def formatted(value: object, form: str = "number") -> str:
    """Return a number as the page shows it: with a true minus, and 1e-9 as a power of ten between ^ and $.

    Parameters
    ----------
    value : object
    form : str
        number (three digits), percent (of a ratio; two digits below ten percent, else three), short (two digits), or
        decimals with the power of ten that the column's heading names: 2@-7 shows 1.234e-7 as 1.23.

    Examples
    --------
    >>> formatted(0.0123456), formatted(1e9 + 0.5), formatted(0.0757, "3@0"), formatted(1.234e-7, "2@-7")
    ('0.0123', '10^9$', '0.076', '1.23')
    """
    value = value.item() if isinstance(value, np.generic) else value
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        return str(value) if value is not None else "\N{EN DASH}"
    if form == "percent":
        share = 100 * value
        text = f"{number(float(f'{share:.2g}') if abs(share) < 10 else round(share, 1))}\N{NO-BREAK SPACE}%"
    elif form == "short":
        text = number(float(f"{value:.2g}"))
    elif "@" in form and value == value:
        decimals, power = (int(part) for part in form.split("@"))
        text = f"{round(value / 10.0**power, decimals) + 0.0:.{decimals}f}"
    else:
        text = number(value)
    if match := re.fullmatch(r"(-?[\d.]+)e([+-]?\d+)(.*)", text):
        mantissa, power = match[1], int(match[2])
        text = f"10^{power}${match[3]}" if mantissa == "1" else f"{mantissa}\N{MIDDLE DOT}10^{power}${match[3]}"
    return text.replace("-", _MINUS)


def shower(numbers: Mapping[str, Any]) -> Callable[..., Markup]:
    """Return the function by which a template shows a number: show("certificate", name, "value", form="number")."""
    from markupsafe import Markup, escape

    def show(*tokens: object, form: str = "number") -> Markup:
        pointer = "".join("/" + str(token).replace("~", "~0").replace("/", "~1") for token in tokens)
        value = pointed(numbers, pointer)
        text = Markup(str(escape(formatted(value, form))).replace("^", "<sup>").replace("$", "</sup>"))
        if isinstance(value, bool) or not isinstance(value, (int, float, np.generic)):
            return escape(formatted(value, form))
        value = value.item() if isinstance(value, np.generic) else value
        return Markup('<data value="{}" data-pointer="{}" data-form="{}">{}</data>').format(
            repr(value), pointer, form, text
        )

    return show


def page_template(name: str) -> Any:
    """Return a template of the reports."""
    return _environment().get_template(name)


@cache
def _environment() -> Any:
    """What templates are compiled in, once in a process."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("viewers", "templates"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    environment.filters["unit"] = unit_label
    environment.filters["named"] = name_unit
    return environment
