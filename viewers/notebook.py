"""The card by which a design or a run shows itself in a notebook: verdict, numbers, picture; one piece of HTML.

Everything is inside: styles stand at the elements, the picture is a data address, no script runs. The card has its own
light paper, so that it reads the same in a dark notebook.
"""

from __future__ import annotations

import base64
import tempfile
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any

import numpy as np

from viewers import theme
from viewers.fields import name_unit
from viewers.parts import ReportParts, curvature_summary, passed, verdict
from viewers.scenes import Scene, Sheet, standard_scenes
from viewers.words import number

PANEL = (480, 450)
"""Width and height of one picture in pixels."""
SHOWN = 320
"""Width of one picture on the page: less than it has pixels, for sharp screens."""
_CHOSEN = ("pattern", "deployed", "gaussian_curvature")
_RIGID = ("length", "angle", "planarity", "isometry", "closure")
_CERTIFIED = "Certified: closed and opened it is one sheet of the same rigid tiles."
_GOOD, _BAD = "#1b7f4d", "#b3261e"


@dataclass(frozen=True)
class Card:
    """What a card shows.

    Attributes
    ----------
    title, verdict : str
    passed : bool
    rows : tuple of (str, str)
        What it is, and its value in words.
    picture : str
        Address of a picture, data: of PNG or SVG; empty for none.
    alt : str
        The picture in words.
    note : str
        One line below; empty for none.
    panels : int
        How many pictures stand side by side in it.
    """

    title: str
    verdict: str
    passed: bool
    rows: tuple[tuple[str, str], ...] = ()
    picture: str = ""
    alt: str = ""
    note: str = ""
    panels: int = 1


def card_of(parts: ReportParts, picture: str = "", alt: str = "", note: str = "", panels: int = 1) -> Card:
    """Return the card of a design: the numbers that a reader asks for first, those that are known.

    Parameters
    ----------
    parts : ReportParts
    picture, alt, note : str
        As in `Card`.
    panels : int
    """
    rows = [row for row in (_size(parts), _sheet(parts), _rigid(parts), _distance(parts), _shape(parts)) if row]
    found = curvature_summary(parts)
    if found is not None and found.gaussian[0] > 0:
        share = number(round(100 * found.gaussian[1] / found.gaussian[0], 1))
        rows.append(("curvature", f"holes differ from the target's Gaussian curvature by {share} % in the median"))
    good = passed(parts)
    words = (
        _CERTIFIED + (" With warnings that need reading, below." if parts.warnings else "") if good else verdict(parts)
    )
    said = " ".join([*parts.warnings, note]).strip()
    return Card(parts.title, words, good, tuple(rows), picture, alt, said, panels)


def card_html(card: Card) -> str:
    """Return a card as HTML to put anywhere in a page.

    Examples
    --------
    >>> "<script>" in card_html(Card("<script>", "Certified.", True))
    False
    """
    color, mark = (_GOOD, "\u2713") if card.passed else (_BAD, "\u2717")
    cell = f"border:0;padding:2px 14px 2px 0;vertical-align:top;text-align:left;background:{theme.PAPER};"
    rows = "".join(
        f'<tr style="background:{theme.PAPER}"><td style="{cell}color:{theme.MUTED};white-space:nowrap">'
        f'{escape(name)}</td><td style="{cell}color:{theme.INK}">{escape(value)}</td></tr>'
        for name, value in card.rows
    )
    table = f'<table style="border-collapse:collapse;border:0;margin:8px 0 0 0;font-size:13px">{rows}</table>'
    wide = f"width:100%;max-width:{card.panels * SHOWN}px"
    image = (
        f'<img src="{escape(card.picture)}" alt="{escape(card.alt)}" '
        f'style="display:block;{wide};margin:10px 0 0 0;background:{theme.PAPER}">'
    )
    note = f'<div style="margin:6px 0 0 0;font-size:12px;color:{theme.MUTED}">{escape(card.note)}</div>'
    return (
        f'<div style="max-width:{3 * SHOWN + 40}px;box-sizing:border-box;padding:14px 18px;border:1px solid '
        f"{theme.HAIRLINE};border-radius:8px;background:{theme.PAPER};color:{theme.INK};"
        'font-family:system-ui,sans-serif;line-height:1.4">'
        f'<div style="font-size:16px;font-weight:600">{escape(card.title)}</div>'
        f'<div style="margin:2px 0 0 0;font-size:13px"><span style="color:{color};font-weight:700">{mark}</span> '
        f"{escape(card.verdict)}</div>"
        f"{table if card.rows else ''}{image if card.picture else ''}{note if card.note else ''}</div>"
    )


def sheet_card(
    values: Mapping[str, Any], result: Mapping[str, Any], drawn: Sheet, pattern: str = "", units: str = "unit"
) -> str:
    """Return the card of a sheet as HTML: with a picture, or where none can be drawn with the flat pattern.

    Parameters
    ----------
    values : mapping
        title, certificate, limits, failures, numbers, warnings and note.
    result : mapping
        tiles, holes and edge_length.
    drawn : Sheet
    pattern : str
        SVG; empty for none.
    units : str
    """
    from viewers.snapshot import NoOpenGLError

    known = {name: value for name, value in values.items() if name != "note"}
    width, height = np.ptp(drawn.contracted[:, :2], axis=0).tolist()
    parts = ReportParts(
        **known, target_name="", units=units, result=result, fields=drawn.fields, sheet_size=(width, height)
    )
    scenes = chosen_scenes(standard_scenes(drawn))
    alt, note, panels = ", ".join(scene.title for scene in scenes.values()), str(values["note"]), len(scenes)
    try:
        picture = picture_address(list(scenes.values()))
    except NoOpenGLError as problem:
        picture = address("image/svg+xml", pattern.encode("utf-8")) if pattern else ""
        alt, note, panels = "Cut pattern, flat", f"{note} {problem}".strip(), 1
    return card_html(card_of(parts, picture, alt, note, panels))


def chosen_scenes(scenes: dict[str, Scene]) -> dict[str, Scene]:
    """Return the scenes that a card shows: the flat sheet, the open one, and the curvature where there is any."""
    return {name: scenes[name] for name in _CHOSEN if name in scenes}


def picture_address(scenes: Sequence[Scene], panel: tuple[int, int] = PANEL) -> str:
    """Draw scenes side by side and return the picture as a data address.

    Raises
    ------
    NoOpenGLError
        Where nothing can be drawn here.
    """
    from viewers.snapshot import render_overview

    with tempfile.TemporaryDirectory(prefix="kirisurf-") as folder:
        return address("image/png", render_overview(scenes, Path(folder, "card.png"), len(scenes), panel).read_bytes())


def address(media: str, content: bytes) -> str:
    """Return content as a data address."""
    return f"data:{media};base64,{base64.b64encode(content).decode('ascii')}"


def _size(parts: ReportParts) -> tuple[str, str] | None:
    tiles, holes, edge = (parts.result.get(key) for key in ("tiles", "holes", "edge_length"))
    if tiles is None or edge is None:
        return None
    return "sheet", f"{tiles} tiles, {holes} holes, median edge {number(edge)} {name_unit(parts.units, edge)}"


def _sheet(parts: ReportParts) -> tuple[str, str] | None:
    if parts.sheet_size is None:
        return None
    width, height = parts.sheet_size
    return "flat sheet", f"{number(width)} \u00d7 {number(height)} {name_unit(parts.units, height)}"


def _rigid(parts: ReportParts) -> tuple[str, str] | None:
    rows = {name: parts.certificate.get(name) for name in _RIGID}
    known = {name: value for name, value in rows.items() if value is not None}
    if not known:
        return None
    worst = max(known, key=lambda name: known[name])
    return "rigid", f"to {number(known[worst])} of a tile edge or rad (largest: {worst})"


def _distance(parts: ReportParts) -> tuple[str, str] | None:
    rms, largest = (parts.certificate.get(key) for key in ("distance_rms", "distance_max"))
    if rms is None or largest is None:
        return None
    covered = parts.certificate.get("coverage")
    share = "" if covered is None else f", {100 * covered:.3g} % of it covered"
    return "target", f"vertices off by {number(rms)} of a tile edge (rms), {number(largest)} at most{share}"


def _shape(parts: ReportParts) -> tuple[str, str] | None:
    edge, opening = parts.certificate.get("min_edge"), parts.numbers.get("opening_angle_min")
    if edge is None or opening is None:
        return None
    degrees = number(round(opening * 57.29577951308232, 1))
    return "shapes", f"shortest edge {number(edge)} of the median, smallest opening {degrees}\N{DEGREE SIGN}"
