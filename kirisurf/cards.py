"""How a design or a run shows itself in a notebook: what stands on its card, put together once."""

from __future__ import annotations

from collections.abc import Mapping
from html import escape
from typing import TYPE_CHECKING, Any

import numpy as np

from kirisurf import publishing
from kirisurf.cuts import cuts
from kirisurf.errors import ParameterError
from kirisurf.field_units import UNKNOWN
from kirisurf.runs import Run
from kirisurf.svg import svg_text

if TYPE_CHECKING:
    from kirisurf.design import Design
    from kirisurf.tessellation import Tessellation


def card(shown: Design | Run) -> str:
    """Return a design or a run as one piece of HTML: verdict, numbers and a picture, with nothing outside of it.

    It never raises: where something of it cannot be had, the rest is shown, and why.

    Parameters
    ----------
    shown : Design or Run
    """
    try:
        made = _of_run(shown) if isinstance(shown, Run) else _of_design(shown)
    except Exception as problem:
        # a notebook that shows a value must not fail because of how it is shown
        return f"<pre>{escape(type(shown).__name__)}: it cannot be shown ({escape(str(problem))})</pre>"
    return made


def _of_design(design: Design) -> str:
    certificate, measures = design.certificate, design.measures
    fields = {(where, name): v for where in ("vertex", "tile", "hole") for name, v in design.fields(where).items()}
    result = {
        "tiles": design.tessellation.n_tiles,
        "holes": len(design.tessellation.holes),
        "edge_length": certificate.edge_length,
    }
    values = {
        "title": design.surface.name,
        "certificate": dict(certificate.rows),
        "limits": dict(certificate.limits),
        "failures": tuple(certificate.failures),
        "numbers": dict(measures.numbers),
        "warnings": design.warnings,
        "note": "" if design.status.exit_code == 0 else design.status.value,
    }
    states = design.tessellation, design.deployed_points, design.contracted_points
    return _shown(values, result, states, design.surface, fields, design.spec.units)


def _of_run(run: Run) -> str:
    result = run.result
    values = {
        "title": f"{run.name}: {result['target']['name']}",
        "certificate": dict(run.certificate),
        "limits": result["certificate_beside"]["limits"],
        "failures": tuple(result["certificate_beside"]["failures"]),
        "numbers": {name: value for name, value in result["measures"].items() if value is not None},
        "warnings": tuple(result.get("warnings", ())),
        "note": "" if result["certified"] else str(result["reason"]),
    }
    states = run.tessellation, run.deployed, run.contracted
    return _shown(values, result, states, run.target, run.fields, run.spec.units)


def _shown(
    values: Mapping[str, Any],
    result: Mapping[str, Any],
    states: tuple[Tessellation, np.ndarray, np.ndarray],
    target: Any,
    fields: Mapping[tuple[str, str], np.ndarray],
    units: str | None,
) -> str:
    tessellation, deployed, contracted = states
    drawn = publishing.sheet(tessellation, deployed, contracted, target, fields, units)
    return publishing.notebook_card(values, result, drawn, _pattern(tessellation, contracted, units), units or UNKNOWN)


def _pattern(tessellation: Tessellation, contracted: np.ndarray, units: str | None) -> str:
    """The flat pattern as SVG, for where no picture can be drawn; empty where it has no slits that can be cut."""
    try:
        return svg_text(cuts(tessellation, contracted), units)
    except ParameterError:
        return ""
