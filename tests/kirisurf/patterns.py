"""Patterns that tests cut and print: quads, trimmed quads, bent and branched slits, tiles that are not convex."""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from kirisurf.derive import derive_tessellation
from kirisurf.loops import Loops
from kirisurf.pattern import quad_pattern, tile_pattern
from kirisurf.tessellation import Tessellation
from kirisurf.unit_cell import quad_cell

NAMES = ("rectangle", "trimmed", "zigzag", "kagome", "opening")


@lru_cache
def pattern(name: str) -> Tessellation:
    if name == "rectangle":
        return quad_pattern(3, 2)
    if name == "zigzag":
        return _zigzag(quad_pattern(2, 2))
    if name == "kagome":
        return _kagome(4)
    mask = np.ones((4, 4, 4), bool)
    if name == "trimmed":
        for column, row in [(0, 0), (0, 1), (3, 3)]:
            mask[column, row] = False
    else:
        mask[1, 2] = mask[2, 2] = False  # an opening that stays open in the flat sheet
    return tile_pattern(quad_cell(), mask)


def bent(tessellation: Tessellation, most: float = 0.06) -> np.ndarray:
    """Contracted points moved a little, copies together: no two edges are equal or parallel any more."""
    shift = np.random.default_rng(1).uniform(-most, most, (tessellation.n_welded, 2))
    return tessellation.contracted + shift[tessellation.weld]


def _zigzag(quads: Tessellation) -> Tessellation:
    """Every tile side becomes two, with a kink: eight corners, four of them reflex."""
    kinks: dict[tuple[int, int], int] = {}
    deployed, contracted = list(quads.deployed), list(quads.contracted)
    weld = quads.weld.tolist()
    welded: dict[tuple[int, int], int] = {}
    loops = []
    for tile in quads.tiles:
        loop = []
        for a, b in zip(tile.tolist(), np.roll(tile, -1).tolist(), strict=True):
            place = tuple(sorted((weld[a], weld[b])))
            welded.setdefault(place, 10**6 + len(welded))
            kinks[a, b] = len(weld)
            weld.append(welded[place])
            for points in (deployed, contracted):
                across = points[b] - points[a] if weld[a] < weld[b] else points[a] - points[b]
                points.append((points[a] + points[b]) / 2 + 0.15 * np.array([-across[1], across[0]]))
            loop += [a, kinks[a, b]]
        loops.append(loop)
    return derive_tessellation(
        np.array(deployed), np.array(contracted), Loops.from_lists(loops), np.array(weld), name="zigzag"
    )


def _kagome(n: int) -> Tessellation:
    """Triangles that hinge in pairs: at every inner vertex of the lattice three slits begin and three end."""
    side, up = np.array([1.0, 0.0]), np.array([0.5, np.sqrt(0.75)])
    loops, points, welds, numbers = [], [], [], {}
    for j in range(n):
        for i in range(n):
            for corners in (((i, j), (i + 1, j), (i, j + 1)), ((i + 1, j), (i + 1, j + 1), (i, j + 1))):
                center = np.mean([a * side + b * up for a, b in corners], axis=0)
                loop = []
                for a, b in corners:
                    at = a * side + b * up
                    toward = np.degrees(np.arctan2(*(center - at)[::-1])) % 360  # 30, 90, ...: pairs of two
                    key = (a, b, int(toward // 120))
                    if key not in numbers:
                        numbers[key] = len(points)
                        points.append(at)
                        welds.append(a * 1000 + b)
                    loop.append(numbers[key])
                loops.append(loop)
    flat = np.array(points)
    return derive_tessellation(flat, flat, Loops.from_lists(loops), np.array(welds), name="kagome")
