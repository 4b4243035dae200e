"""The options of a fit as editors of the page: what they show, and what they give back."""

from __future__ import annotations

from typing import Any

from kirisurf.errors import ParameterError
from kirisurf.spec import FitSpec
from viewers.workbench.options import options


def option_groups() -> list[dict[str, Any]]:
    """Return every option as the page's template wants it, in groups."""
    groups: dict[str, list[dict[str, Any]]] = {}
    for option in options():
        groups.setdefault(option.group, []).append(
            {
                "name": option.name,
                "label": option.label,
                "kind": option.kind,
                "help": option.help,
                "choices": [{"value": name, "words": name or "not said (mm)"} for name in option.choices],
                "least": option.least,
                "most": option.most,
                "step": option.step if option.kind == "number" else 1,
                "unit": option.unit,
                "without": option.without,
                "is_open": option.is_open,
            }
        )
    return [{"title": title, "options": listed} for title, listed in groups.items()]


def option_values(spec: FitSpec) -> dict[str, Any]:
    """Return the value of every option as an editor shows it; None where a number has none."""
    shown = {}
    for option in options():
        value = getattr(spec, option.name)
        if option.kind in ("number", "whole") and isinstance(value, str):
            value = None
        if option.kind == "choice" and value is None:
            value = ""
        shown[option.name] = list(value) if isinstance(value, tuple) else value
    return shown


def option_value(name: str, given: Any) -> Any:
    """Return the value of an option from what an editor of the page gave: text, or a list of two numbers.

    Raises
    ------
    ParameterError
        Where it is no option, or no number where one is expected.
    """
    option = next((option for option in options() if option.name == name), None)
    if option is None:
        raise ParameterError(f"option: expected one of the panel's, got {str(name)[:60]!r}")
    if option.kind == "choice":
        if not option.is_open and given not in option.choices:
            raise ParameterError(
                f"{option.label}: expected one of {', '.join(option.choices)}, got {str(given)[:60]!r}"
            )
        return str(given)
    if option.kind == "pair":
        parts = given if isinstance(given, (list, tuple)) else ()
        if len(parts) != 2:
            raise ParameterError(f"{option.label}: expected two whole numbers, got {str(given)[:60]!r}")
        return tuple(_whole(option.label, part) for part in parts)
    text = str(given).strip() if given is not None else ""
    if not text or text == option.without:
        if option.without:
            return option.without_value
        raise ParameterError(f"{option.label}: expected a number, got none")
    if option.kind == "whole":
        return _whole(option.label, text)
    try:
        return float(text.replace(",", "."))
    except ValueError:
        raise ParameterError(f"{option.label}: expected a number, got {text[:60]!r}") from None


def _whole(label: str, given: Any) -> int:
    try:
        return int(str(given).strip())
    except ValueError:
        raise ParameterError(f"{label}: expected a whole number, got {str(given)[:60]!r}") from None
