"""Draw the gallery of tessellations again: `python docs/tessellations.py`, from anywhere, in a few seconds."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.collections import PolyCollection
from matplotlib.figure import Figure
from PIL import Image

from kirisurf.pattern import tile_pattern
from kirisurf.tessellation import Tessellation
from kirisurf.unit_cell import UnitCell
from kirisurf.unit_cells.catalog import catalog
from viewers import theme

PICTURE = Path(__file__).with_suffix(".png")
COLUMNS, PANEL, HEAD, DPI = 3, (560, 292), 44, 100
TILES = 44
"""About so many tiles each."""

TONES = ((theme.TILE, "#e8bd7c"), (theme.TARGET, "#98b3cb"))
"""Colors of the kinds of tiles, those with the most corners first: turning one way and the other when they open."""

REACH = 12
"""Cells on either side from which a patch is cut."""


def gallery(path: Path) -> None:
    """Write every tessellation of the catalog, closed and open at one scale."""
    entries = catalog()
    rows = -(-len(entries) // COLUMNS)
    width, height = COLUMNS * PANEL[0], rows * PANEL[1]
    figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI, facecolor=theme.PAPER)
    FigureCanvasAgg(figure)
    for k, entry in enumerate(entries):
        left, top = k % COLUMNS * PANEL[0], height - k // COLUMNS * PANEL[1]
        figure.text((left + 22) / width, (top - 32) / height, entry.name, fontsize=15, color=theme.INK)
        axes = figure.add_axes(
            (
                (left + 14) / width,
                (top - PANEL[1] + 8) / height,
                (PANEL[0] - 28) / width,
                (PANEL[1] - HEAD - 10) / height,
            )
        )
        cell = entry.cell()
        _draw(axes, patch(cell), _parts(cell)[1])
    figure.savefig(path, dpi=DPI, metadata={"Software": None})
    Image.open(path).convert("RGB").quantize(96, dither=Image.Dither.NONE).save(path, optimize=True)


def patch(cell: UnitCell) -> Tessellation:
    """Return a patch of a pattern that is about square, whatever the shape of the unit cell."""
    cell = cell.normalized()
    centers = np.array([cell.contracted[tile].mean(axis=0) for tile in cell.tiles])
    step = np.arange(-REACH, REACH + 1)
    column, row = np.meshgrid(step, step, indexing="ij")
    shifts = np.stack([column, row], axis=-1) @ cell.contracted_shifts
    places = shifts[:, :, None] + centers - centers.mean(axis=0)
    # halfway between square when closed and square when open
    stretch = np.diag(_parts(cell)[0])
    side = np.sqrt(TILES / len(cell.tiles)) * np.array([stretch[1] / stretch[0], stretch[0] / stretch[1]]) ** 0.25
    # a half-open square: of two rows of tiles on opposite sides one is in
    mask = ((places > -0.5 * side - 1e-6) & (places <= 0.5 * side - 1e-6)).all(axis=-1)
    while True:
        pattern = tile_pattern(cell, mask)
        # tiles that hang by one hinge only hide the pattern
        hinges = np.bincount(pattern.tiles.indices)[pattern.tiles.indices] > 1
        loose = np.bincount(pattern.tiles.owners, hinges) < 2
        if not loose.any():
            return pattern
        column, row, which = pattern.cells[loose].T
        mask[column, row, which] = False


def _parts(cell: UnitCell) -> tuple[np.ndarray, np.ndarray]:
    """Stretch (symmetric) and rotation whose product leads from the closed cells to the open ones, (2, 2) each."""
    u, values, vt = np.linalg.svd(np.linalg.solve(cell.contracted_shifts, cell.deployed_shifts))
    return (u * values) @ u.T, u @ vt


def _draw(axes: Axes, pattern: Tessellation, rotation: np.ndarray) -> None:
    """Draw a patch closed on the left and open on the right, at one scale."""
    closed, opened = (_centered(points) for points in (pattern.contracted, pattern.deployed @ rotation.T))
    widths = [float(np.ptp(points[:, 0])) for points in (closed, opened)]
    heights = [float(np.ptp(points[:, 1])) for points in (closed, opened)]
    gap = 0.09 * sum(widths)
    # equal polygons share a color
    kinds = np.unique(-pattern.tiles.sizes, return_inverse=True)[1]
    colors = [
        TONES[kind % len(TONES)][int(_turn(closed[tile], opened[tile]) < -1e-6)]
        for kind, tile in zip(kinds.tolist(), pattern.tiles, strict=True)
    ]
    for points, at in ((closed, 0.5 * widths[0]), (opened, widths[0] + gap + 0.5 * widths[1])):
        axes.add_collection(
            PolyCollection(
                [points[tile] + (at, 0.0) for tile in pattern.tiles],
                facecolors=colors,
                edgecolors=theme.TILE_EDGE,
                linewidths=0.7,
                joinstyle="round",
            )
        )
    total, high = sum(widths) + gap, max(heights)
    box = (PANEL[0] - 28) / (PANEL[1] - HEAD - 10)
    total, high = max(total, box * high) * 1.02, max(high, total / box) * 1.02
    axes.set_xlim(0.5 * (sum(widths) + gap - total), 0.5 * (sum(widths) + gap + total))
    axes.set_ylim(-0.5 * high, 0.5 * high)
    axes.set_aspect("equal")
    axes.set_axis_off()


def _centered(points: np.ndarray) -> np.ndarray:
    return points - 0.5 * (points.min(axis=0) + points.max(axis=0))


def _turn(closed: np.ndarray, opened: np.ndarray) -> float:
    """Angle by which a tile turns from the one state to the other."""
    a, b = ((p - p.mean(axis=0)) @ (1, 1j) for p in (closed, opened))
    return float(np.angle(np.vdot(a, b)))


if __name__ == "__main__":
    gallery(PICTURE)
