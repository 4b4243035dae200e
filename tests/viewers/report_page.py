"""What a browser would see of a report: tags, balance, text, and the numbers that say where they stand."""

from __future__ import annotations

from dataclasses import dataclass
from html.parser import HTMLParser


@dataclass(frozen=True)
class Shown:
    """A number of the page."""

    value: str
    pointer: str
    form: str
    text: str


class Page(HTMLParser):
    """A parsed page; fails where a tag is left open or closes nothing."""

    VOID = frozenset({"meta", "img", "br", "link", "hr"})
    UNSEEN = frozenset({"style", "script"})

    def __init__(self, text: str) -> None:
        super().__init__()
        self.tags: list[tuple[str, dict]] = []
        self.open: list[str] = []
        self.text = ""
        self.beside = ""
        self.shown: list[Shown] = []
        self._number: tuple[dict, list[str]] | None = None
        self.feed(text)
        self.close()
        assert not self.open, f"tags left open: {self.open}"

    def handle_starttag(self, tag, attributes):
        self.tags.append((tag, dict(attributes)))
        if tag not in self.VOID:
            self.open.append(tag)
        if tag == "data":
            self._number = (dict(attributes), [])
        elif tag == "sup" and self._number is not None:
            self._number[1].append("^")

    def handle_endtag(self, tag):
        assert self.open and self.open.pop() == tag, f"</{tag}> closes nothing"
        if tag == "data":
            attributes, text = self._number
            self.shown.append(
                Shown(attributes["value"], attributes["data-pointer"], attributes["data-form"], "".join(text))
            )
            self._number = None
        elif tag == "sup" and self._number is not None:
            self._number[1].append("$")

    def handle_data(self, data):
        if self.open and self.open[-1] in self.UNSEEN:
            return
        self.text += data
        if self._number is None:
            self.beside += data
        else:
            self._number[1].append(data)

    def having(self, attribute: str) -> list[dict]:
        """Attributes of the tags that have one."""
        return [found for _, found in self.tags if attribute in found]
