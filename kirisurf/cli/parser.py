"""The parser: one page of help for every command, and messages of one form: expected ..., got ...."""

from __future__ import annotations

import argparse
import difflib
import re
from collections.abc import Callable
from typing import Any, NoReturn, TypeVar

from kirisurf.errors import ParameterError

T = TypeVar("T")


class Parser(argparse.ArgumentParser):
    """An argument parser that raises instead of ending the process, and never guesses an option."""

    def __init__(self, **options: Any) -> None:
        options.setdefault("formatter_class", argparse.RawDescriptionHelpFormatter)
        super().__init__(allow_abbrev=False, **options)

    def error(self, message: str) -> NoReturn:
        """Raise a ParameterError in kirisurf's own form, with a hint at the page that helps."""
        raise ParameterError(f"{_reworded(message)} (see: {self.prog} --help)")


def _reworded(message: str) -> str:
    """Put argparse's messages into the form: expected ..., got ...."""
    if match := re.fullmatch(r"the following arguments are required: (.*)", message):
        return f"expected {match[1]}, got none"
    if match := re.fullmatch(r"unrecognized arguments: (.*)", message):
        return f"expected known options and no more arguments, got {match[1]}"
    if match := re.fullmatch(r"argument (\w+): invalid choice: '(.*)' \(choose from (.*)\)", message, re.DOTALL):
        choices = re.findall(r"[\w-]+", match[3])
        near = difflib.get_close_matches(match[2], choices, n=1)
        hint = f"; did you mean {near[0]!r}?" if near else ""
        return f"{match[1]}: expected one of {', '.join(choices)}, got {match[2]!r}{hint}"
    return message.removeprefix("argument ")


def add_command(commands: Any, name: str, summary: str, text: str, examples: str) -> Parser:
    """Add a command with its page and the options that every command has."""
    parser: Parser = commands.add_parser(
        name, help=summary, description=f"{summary[0].upper()}{summary[1:]}.\n\n{text}", epilog=f"examples:\n{examples}"
    )
    add_common(parser)
    return parser


def add_common(parser: argparse.ArgumentParser) -> None:
    """Add the options that every command has, before or after its name."""
    group = parser.add_argument_group("output")
    off = argparse.SUPPRESS
    group.add_argument("--json", action="store_true", default=off, help="print one JSON object on standard output")
    group.add_argument("-q", "--quiet", action="store_true", default=off, help="no messages but warnings and errors")
    group.add_argument("--debug", action="store_true", default=off, help="show the traceback of an error")


def value(parse: Callable[[str], T]) -> Callable[[str], T]:
    """Turn a parser of text that raises ParameterError into one whose message argparse shows."""

    def parsed(text: str) -> T:
        try:
            return parse(text)
        except ParameterError as problem:
            message = str(problem)
            raise argparse.ArgumentTypeError(message.partition(": ")[2] or message) from None

    return parsed


@value
def number(text: str) -> float:
    """Return a number."""
    try:
        return float(text)
    except ValueError:
        raise ParameterError(f"value: expected a number, got {text!r}") from None


@value
def whole(text: str) -> int:
    """Return a whole number."""
    try:
        return int(text)
    except ValueError:
        raise ParameterError(f"value: expected a whole number, got {text!r}") from None


@value
def degrees_or_auto(text: str) -> float | str:
    """Return degrees, or auto."""
    try:
        return text if text == "auto" else float(text)
    except ValueError:
        raise ParameterError(f"value: expected degrees or auto, got {text!r}") from None
