"""The options of a fit as a report names them."""

from __future__ import annotations

from pathlib import Path
from typing import Any

from kirisurf.naming import printable
from kirisurf.spec import FitSpec

SHOWN = ("tessellation", "cells", "tiles", "closeness")
"""Options that a report names even where they are the usual ones."""


def shown_options(spec: FitSpec) -> dict[str, Any]:
    """Return the options of a fit that are not the usual ones, and `SHOWN`; not the target, which may be a path.

    Examples
    --------
    >>> shown_options(FitSpec(target="hypar", cells=(2, 2), contracted="rectangle"))["contracted"]
    'rectangle'
    """
    usual = FitSpec(target=spec.target).as_dict()
    return {
        # of a file its name: a report is mailed, the folders of its writer are not
        name: printable(Path(value).name) if isinstance(value, str) else value
        for name, value in spec.as_dict().items()
        if name != "target" and value is not None and (name in SHOWN or value != usual.get(name))
    }
