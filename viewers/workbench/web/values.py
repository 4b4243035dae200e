"""What the page shows, as plain values that trame sends to it: pure functions of a session."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import Any

from kirisurf.formats.source import FORMATS
from kirisurf.outlines.reading import FORMATS as OUTLINE_FORMATS
from kirisurf.spec import FitSpec
from kirisurf.targets import samples
from viewers.fields import describe_field
from viewers.scenes import Scene
from viewers.sheet import Sheet
from viewers.workbench.details import Line, certificate_lines, measure_lines, picked_lines
from viewers.workbench.options import is_offered, options
from viewers.workbench.pipeline import STAGES, Stage
from viewers.workbench.progress import progress_words, solved_share
from viewers.workbench.results import Results
from viewers.workbench.scene import coloring, colorings
from viewers.workbench.session import Session
from viewers.workbench.state import State
from viewers.workbench.web.charts import color_bar, residual_curves
from viewers.workbench.web.downloads import KINDS
from viewers.workbench.web.editors import option_groups, option_values

WHERE = {"hole": "Holes", "tile": "Tiles", "vertex": "Vertices"}
ACCEPTED = ",".join(sorted({*FORMATS, *OUTLINE_FORMATS}))
"""Suffixes of the files that can be opened, for the browser's dialog."""


def fixed_values() -> dict[str, Any]:
    """Return what stays the same for the life of a page: options, stages, samples."""
    return {
        "groups": option_groups(),
        "stages": [
            {"name": stage.value, "title": stage.value.capitalize(), "help": stage.explained} for stage in STAGES
        ],
        "samples": [{"name": sample.name, "title": sample.title} for sample in samples()],
        "accepted": ACCEPTED,
        "downloads": [{"name": name, "words": kind.words, "needs": kind.needs} for name, kind in KINDS.items()],
    }


def page_values(session: Session, scenes: tuple[Scene, Scene]) -> dict[str, Any]:
    """Return everything on the page that changes, but for the pictures themselves."""
    state, results = session.state, session.results
    words, is_problem = progress_words(results, session.is_stale)
    share = solved_share([step.residuals for step in results.steps], state.spec.tolerance)
    found = None if results.moving is not None else coloring(state, results)
    is_idle, has_sheet = results.running is None, results.sheet is not None
    can_save = is_idle and has_sheet and not session.is_stale and (results.is_current or not results.job)
    return {
        "target": target_title(state.spec),
        "sample": state.spec.target if any(state.spec.target == sample.name for sample in samples()) else "",
        "option_values": option_values(state.spec),
        "offered": {option.name: is_offered(option, state.spec) for option in options()},
        "layout_kind": "cells" if state.spec.cells is not None else "tiles",
        "shown": {stage.value: stage in state.shown for stage in STAGES},
        "running": "" if results.running is None else results.running.value,
        "status": without_folder(words, state.spec),
        "is_problem": is_problem,
        "progress": -1 if is_idle else round(share, 3) if results.running is Stage.FIT else 1.0,
        "next_step": next_step(session),
        "can": {
            "stop": not is_idle,
            "resume": results.can_resume and not session.is_stale,
            "undo": bool(session.history.past),
            "redo": bool(session.history.future),
            "save": can_save,
            "snapshot": is_idle and results.target is not None,
            "animate": is_idle and has_sheet,
            "deploy": has_sheet and results.moving is None,
        },
        "is_live": state.is_live,
        "is_linked": state.is_linked,
        "titles": [scene.title for scene in scenes],
        "picture_notes": [scene.note for scene in scenes],
        "bar": color_bar(found, WHERE[found.where]) if found is not None else None,
        "colorings": coloring_choices(results),
        "coloring": "/".join(state.coloring) if state.coloring in colorings(results) else "",
        "deployment": round(100 * state.share),
        "curves": residual_curves([step.residuals for step in results.steps], state.spec.tolerance),
        **side_values(state, results),
    }


def side_values(state: State, results: Results) -> dict[str, Any]:
    """Return what stands beside the pictures: numbers of what is picked and of the sheet, verdict, notes."""
    title = "Click a tile or a hole in one of the pictures to read its numbers."
    picked: tuple[Line, ...] = ()
    if results.sheet is not None and state.selection is not None:
        picked = picked_lines(results.sheet, state.selection)
        title = f"{state.selection.kind.capitalize()} {state.selection.number}"
    whole = () if results.fitted is None else measure_lines(results.fitted.numbers, results.fitted.spec.units)
    verdict, kind = verdict_words(results)
    return {
        "picked_title": title,
        "picked": [[line.label, line.value, line.unit] for line in picked],
        "whole": [[line.label, line.value, line.unit] for line in whole],
        "verdict": verdict,
        "verdict_kind": kind,
        "certificate": [
            {
                "title": row.title,
                "value": row.value,
                "limit": row.limit,
                "mark": row.mark,
                "meaning": f"{row.meaning} ({row.unit})" if row.unit else row.meaning,
                "verdict": row.verdict,
            }
            for row in certificate_lines(results.certified)
        ],
        "warnings": list(results.warnings),
        "notes": list(results.notes),
    }


def target_title(spec: FitSpec) -> str:
    """Return the name of a target for a reader: of a file without its folder."""
    return Path(spec.target).name


def without_folder(words: str, spec: FitSpec) -> str:
    """Return a sentence with the file's name instead of its path: where an upload lies says nothing to a reader."""
    path = Path(spec.target)
    return words.replace(str(path), path.name) if path.is_absolute() else words


def coloring_choices(results: Results) -> list[dict[str, Any]]:
    """Return the fields that can color the sheet, by where they lie."""
    return [] if results.sheet is None else _choices(results.sheet, colorings(results))


def verdict_words(results: Results) -> tuple[str, str]:
    """Return the verdict on a sheet in a sentence, and whether that is good, bad or open."""
    if results.certified is None:
        return ("No verdict yet.", "open") if results.running is None else ("Being checked \u2026", "open")
    if results.certified.passed:
        return "Certified: closed and opened it is one sheet of the same rigid tiles.", "good"
    count = len(results.certified.failures)
    return f"Not certified: {count} row{'s' * (count > 1)} fail{'s' * (count == 1)}.", "bad"


def next_step(session: Session) -> str:
    """Return what a person may want to do next, in a sentence."""
    results, state = session.results, session.state
    if results.running is not None:
        return ""
    if results.problem:
        return "Change an option, or open another file."
    if results.moving is not None and state.is_live:
        # a pattern that was laid while a hand drags it
        return "Let go to fit."
    if results.sheet is None or session.is_stale:
        return "Press Fit."
    if results.can_resume:
        return "Press Resume to go on, or change an option."
    if results.certified is not None and not results.certified.passed:
        return "See under Certificate which rows fail; try more tiles, or another tessellation."
    if state.selection is None:
        return "Click a hole to read its numbers, change an option, or download the cut file."
    return "Download the cut file, or change an option."


# asked for at every change, and the same for every one of a sheet
@lru_cache(maxsize=4)
def _choices(sheet: Sheet, known: tuple[tuple[str, str], ...]) -> list[dict[str, Any]]:
    groups = []
    for where, title in WHERE.items():
        names = [name for place, name in known if place == where]
        labels = [describe_field(name, where, sheet.fields[where, name], limits=(0.0, 1.0)).label for name in names]
        listed = [
            {"value": f"{where}/{name}", "words": f"{title}: {label}"}
            for name, label in zip(names, labels, strict=True)
        ]
        if listed:
            groups.append({"title": title, "fields": listed})
    return groups
