"""Names of the tessellations, known without loading anything that a cell is built with."""

from __future__ import annotations

from functools import cache
from pathlib import Path

TESSELLATIONS = ("quad", "kagome", "hexagon", "islamic-quad", "islamic-triangle")
"""Those of the paper."""

FILES = Path(__file__).parent / "unit_cells" / "files"
"""Where the bundled cells stand."""

SUFFIX = ".cell"


@cache
def tessellation_names() -> tuple[str, ...]:
    """Return the names of all tessellations: those of the paper, then the bundled files', which bear them too.

    Examples
    --------
    >>> tessellation_names()[:3]
    ('quad', 'kagome', 'hexagon')
    """
    return TESSELLATIONS + tuple(file.stem for file in sorted(FILES.glob(f"*{SUFFIX}")))
