"""Summaries of batches to draw pages of: items, a matrix of them, a comparison, and texts that nobody would choose."""

from __future__ import annotations

from tests.viewers.report_page import Page

PNG = b"\x89PNG\r\n\x1a\n"
HOSTILE = (
    "</title></style></script><script>alert(1)</script>",
    "\"><img src=x onerror=alert(1)>' onmouseover='alert(1)",
    "javascript:alert(1)",
    "{{ 7 * 7 }}{% raw %}",
    "new\nline \u202egpj.exe \x00\x1b[31m \udcff",
)


class BatchPage(Page):
    VOID = Page.VOID | {"input"}


def item(name: str = "hypar--quad", **changes) -> dict:
    return {
        "name": name,
        "target": "hypar",
        "options": {"tessellation": "quad", "cells": "4x4"},
        "code": 0,
        "outcome": "done",
        "expect": [0, 1],
        "is_expected": True,
        "status": "CONVERGED",
        "reason": "Converged.",
        "certified": True,
        "tiles": 64,
        "holes": 49,
        "iterations": 8,
        "measures": {
            "distance_rms": 0.0084,
            "distance_max": 0.03,
            "coverage": 0.98,
            "opening_min": 0.5,
            "min_edge": 0.9,
        },
        "warnings": [],
        "failures": [],
        "seconds": 1.9,
        "peak_mb": 312.0,
        "folder": f"runs/{name}",
        **changes,
    }


CRASHED = {
    "code": 70,
    "outcome": "crashed",
    "is_expected": False,
    "reason": "Ended by signal 11.",
    "certified": None,
    "status": None,
    "tiles": None,
    "iterations": None,
    "measures": {},
    "folder": None,
}


def summary(items: list[dict] | None = None, **changes) -> dict:
    items = [item()] if items is None else items
    return {
        "title": "roofs",
        "kirisurf": "0.1.0",
        "spec": "batch.toml",
        "varied": ["tessellation", "cells"],
        "items": items,
        "comparison": None,
        **changes,
    }


def matrix(n_targets: int = 3, sizes: tuple[str, ...] = ("2x2", "4x4")) -> list[dict]:
    return [
        item(f"t{t}--{kind}--{cells}", target=f"t{t}", options={"tessellation": kind, "cells": cells}, tiles=10 * t + k)
        for t in range(n_targets)
        for kind in ("quad", "kagome")
        for k, cells in enumerate(sizes)
    ]


def compared(items: list[dict], **verdicts: tuple) -> dict:
    """A summary against a baseline: {name: (verdict, changes)}; the others are the same."""
    entries = [{"name": each["name"], "verdict": "same", "changes": []} for each in items]
    entries = [each for each in entries if each["name"] not in verdicts]
    entries += [{"name": name, "verdict": verdict, "changes": changes} for name, (verdict, changes) in verdicts.items()]
    counts: dict[str, int] = {}
    for each in entries:
        counts[each["verdict"]] = counts.get(each["verdict"], 0) + 1
    tolerances = {
        "distance_rms": {"relative": 0.02, "absolute": 1e-6, "better": "lower"},
        "coverage": {"relative": 0.01, "absolute": 0.0, "better": "higher"},
    }
    comparison = {"baseline": "baseline.toml", "tolerances": tolerances, "counts": counts, "items": entries}
    return summary(items, comparison=comparison)


def change(measure: str, before, now, verdict: str) -> dict:
    return {"measure": measure, "before": before, "now": now, "verdict": verdict, "sentence": f"{measure} changed"}


def rows_of(html: str) -> list[str]:
    """The lines of the table of all items, as markup."""
    body = html.split('id="all-items"')[1].split("<tbody>")[1].split("</tbody>")[0]
    return ["<tr" + each for each in body.split("<tr")[1:]]
