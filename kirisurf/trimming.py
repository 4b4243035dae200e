"""Trimming: which tiles of a lattice make a sound sheet inside an outline."""

from __future__ import annotations

import numpy as np
import shapely
from jaxtyping import Bool
from scipy.ndimage import binary_fill_holes, label

BLOCK = np.ones((2, 2), bool)


def sound_mask(mask: Bool[np.ndarray, "columns rows"]) -> Bool[np.ndarray, "columns rows"]:
    """Return the largest part of a tile mask that is a sheet.

    Every tile belongs to a full 2x2 block (so that no tile dangles on one hinge), the tiles are connected
    through such blocks along common edges, no hole is left open, and no two tiles touch at a corner only.
    """
    mask = binary_fill_holes(mask)
    for _ in range(mask.size + 1):
        opened = _opened(mask)
        # scipy's own labels: tiles connected along edges
        parts, count = label(opened)
        if count > 1:
            sizes = np.bincount(parts.ravel())[1:]
            opened = parts == 1 + int(np.argmax(sizes))
        pinched = _corner_contacts(opened)
        opened = opened & ~pinched
        if (opened == mask).all():
            return opened
        mask = binary_fill_holes(opened)
    return mask


def overlap_fractions(outline: shapely.Polygon, squares: np.ndarray) -> np.ndarray:
    """Return the part of every square (q, 4, 2) that lies inside the outline, (q,)."""
    polygons = shapely.polygons(squares)
    shapely.prepare(outline)
    fraction = np.zeros(len(squares))
    inside = shapely.contains_properly(outline, polygons)
    fraction[inside] = 1.0
    edge = shapely.intersects(outline, polygons) & ~inside
    fraction[edge] = shapely.area(shapely.intersection(polygons[edge], outline)) / shapely.area(polygons[edge])
    return fraction


def _opened(mask: np.ndarray) -> np.ndarray:
    """Tiles that belong to a full 2x2 block."""
    full = mask[:-1, :-1] & mask[1:, :-1] & mask[:-1, 1:] & mask[1:, 1:]
    opened = np.zeros_like(mask)
    for i in range(2):
        for j in range(2):
            opened[i : i + full.shape[0], j : j + full.shape[1]] |= full
    return opened


def _corner_contacts(mask: np.ndarray) -> np.ndarray:
    """One tile of every pair that touches at a corner only."""
    a, b, c, d = mask[:-1, :-1], mask[1:, :-1], mask[:-1, 1:], mask[1:, 1:]
    pinched = np.zeros_like(mask)
    pinched[:-1, :-1] |= a & d & ~b & ~c
    pinched[1:, :-1] |= b & c & ~a & ~d
    return pinched
