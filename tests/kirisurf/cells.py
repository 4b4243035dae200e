"""Every unit cell of the catalog and one of a user's own, with their motions."""

from __future__ import annotations

from functools import cache

import pytest

from kirisurf.motion import Motion, motion_of
from kirisurf.unit_cells import catalog, find_cell, parse_cell

NAMES = (*(entry.name for entry in catalog()), "leaning")


@cache
def motion(name: str) -> Motion:
    return motion_of(find_cell(name) if name != "leaning" else parse_cell(leaning()))


def leaning() -> str:
    """Rotating squares, written with the closed cell turned to the left and the open one upside down."""
    points = [
        ((0, 0), (0, 0)), ((2, 0), (1.6, 1.2)), ((2, 2), (0.4, 2.8)), ((0, 2), (-1.2, 1.6)),
        ((4, 0), (3.2, 0)), ((4, 2), (4.4, 1.6)), ((2, 2), (2.8, 2.8)), ((0, 2), (-1.2, 4)),
        ((2, 4), (1.6, 4.4)), ((0, 4), (0, 5.6)), ((4, 2), (4.4, 4)), ((4, 4), (3.2, 5.6)),
    ]  # fmt: skip
    lines = ["name leaning", "columns 0 4  -5.6 0", "rows -4 0  0 -5.6"]
    lines += [f"point {-y} {x}  {-u} {-v}" for (x, y), (u, v) in points]
    tiles = ["1 2 3 4", "2 5 6 7", "8 3 9 10", "7 11 12 9"]
    return "\n".join([*lines, *(f"tile {tile}" for tile in tiles)])


every_cell = pytest.mark.parametrize("name", NAMES)
moving_cell = pytest.mark.parametrize("name", [name for name in NAMES if not name.startswith("islamic")])
