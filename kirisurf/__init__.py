"""kirisurf: kirigami sheets that open into a target surface.

>>> import kirisurf
>>> design = kirisurf.fit("hypar", cells=(2, 2))
>>> design.certificate.passed
True

Names are loaded when they are first used (PEP 562), so that the import is quick and a command line that only
prints help needs no NumPy.
"""

from __future__ import annotations

import importlib
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from kirisurf.batch import fit_batch as fit_batch
    from kirisurf.cards import card as card
    from kirisurf.design import Design as Design
    from kirisurf.design import fit as fit
    from kirisurf.errors import KirisurfError as KirisurfError
    from kirisurf.errors import LimitError as LimitError
    from kirisurf.errors import OutputError as OutputError
    from kirisurf.errors import ParameterError as ParameterError
    from kirisurf.errors import UnreadableError as UnreadableError
    from kirisurf.errors import UnusableError as UnusableError
    from kirisurf.exporting import export as export
    from kirisurf.fabrication import Fabrication as Fabrication
    from kirisurf.hole_table import HoleTable as HoleTable
    from kirisurf.hole_table import curvature as curvature
    from kirisurf.judging import audit as audit
    from kirisurf.reporting import report as report
    from kirisurf.runs import Run as Run
    from kirisurf.runs import read_run as read_run
    from kirisurf.sheet import Sheet as Sheet
    from kirisurf.spec import FitSpec as FitSpec
    from kirisurf.status import Status as Status
    from kirisurf.surface import Surface as Surface
    from kirisurf.targets import load as load
    from kirisurf.targets import samples as samples

_HOMES = {
    "fit": "kirisurf.design",
    "fit_batch": "kirisurf.batch",
    "audit": "kirisurf.judging",
    "card": "kirisurf.cards",
    "Design": "kirisurf.design",
    "KirisurfError": "kirisurf.errors",
    "LimitError": "kirisurf.errors",
    "OutputError": "kirisurf.errors",
    "ParameterError": "kirisurf.errors",
    "UnreadableError": "kirisurf.errors",
    "UnusableError": "kirisurf.errors",
    "export": "kirisurf.exporting",
    "Fabrication": "kirisurf.fabrication",
    "HoleTable": "kirisurf.hole_table",
    "curvature": "kirisurf.hole_table",
    "report": "kirisurf.reporting",
    "Run": "kirisurf.runs",
    "read_run": "kirisurf.runs",
    "Sheet": "kirisurf.sheet",
    "FitSpec": "kirisurf.spec",
    "Status": "kirisurf.status",
    "Surface": "kirisurf.surface",
    "load": "kirisurf.targets",
    "samples": "kirisurf.targets",
}

__all__ = [*sorted(_HOMES), "__version__"]


def __getattr__(name: str) -> Any:
    if name == "__version__":
        from importlib import metadata

        try:
            return metadata.version("kirisurf")
        except metadata.PackageNotFoundError:
            return "0+unknown"
    if name not in _HOMES:
        raise AttributeError(f"module 'kirisurf' has no attribute {name!r}")
    found = getattr(importlib.import_module(_HOMES[name]), name)
    globals()[name] = found
    return found


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
