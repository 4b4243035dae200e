"""A sheet on its way from flat to deployed: its states painted from one place at one scale, strained tiles in color."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from jaxtyping import Float
from PIL import Image, ImageDraw, ImageFont

from kirisurf.loops import Loops
from viewers import theme
from viewers.framing import Frame, View, fit_frame
from viewers.painting import line_of_sight, painted

if TYPE_CHECKING:
    from matplotlib.colors import LinearSegmentedColormap

UNSTRAINED = 1e-4
"""Strain up to which a sheet is drawn as paper, without a scale of colors."""

_MARGIN, _COLORS = 0.03, 64
_MILLISECONDS, _REST = 60, 900
# pixels
_FOOT, _BAR = 58, (60, 8)


@dataclass(frozen=True, eq=False)
class MovingSheet:
    """States of a sheet, from flat to deployed.

    Attributes
    ----------
    tiles, holes : Loops
    states : (k, n, 3)
    strains : (k, t)
        Of every tile.
    largest_strain : float
        Where the scale of colors ends.
    """

    tiles: Loops
    holes: Loops
    states: Float[np.ndarray, "k n 3"]
    strains: Float[np.ndarray, "k t"]
    largest_strain: float

    @property
    def is_strained(self) -> bool:
        """Whether there is a strain to be seen."""
        return self.largest_strain > UNSTRAINED

    @property
    def extent(self) -> tuple[float, float]:
        """Width and height of all states, as they are seen."""
        seen = self._local[:, self.tiles.indices].reshape(-1, 3) @ self.view.axes[:2].T
        width, height = np.ptp(seen, axis=0).tolist()
        return width, height

    def picture(self, k: int, size: tuple[int, int]) -> Image.Image:
        """Return the picture of a state, (width, height) in pixels, at the scale of all others of this size."""
        colors = None
        if self.is_strained:
            shares = np.clip(self.strains[k] / self.largest_strain, 0.0, 1.0)
            colors = 255.0 * strain_colors()(shares)[:, :3]
        return painted(self._local[k], self.tiles, self._holes, self.view, self._frame(size), size, colors)

    @cached_property
    def view(self) -> View:
        """Line of sight, chosen for the last state."""
        return line_of_sight(self._local[-1], self.tiles)

    @cached_property
    def _local(self) -> np.ndarray:
        """States about the middle of the last one, whose longest extent is 1."""
        corners = self.states[-1][self.tiles.indices]
        low, high = corners.min(axis=0), corners.max(axis=0)
        return (self.states - 0.5 * (low + high)) / float((high - low).max())

    @property
    def _holes(self) -> Loops:
        """Holes are painted in space, where the tiles behind would be seen through them."""
        is_flat = float(np.ptp(self._local[:, :, 2])) < 1e-9
        return Loops.from_lists([]) if is_flat else self.holes

    def _frame(self, size: tuple[int, int]) -> Frame:
        return fit_frame(self.view, self._local[:, self.tiles.indices].reshape(-1, 3), size[0] / size[1], _MARGIN)


def strain_colors() -> LinearSegmentedColormap:
    """Return the colors of strain: from paper to a dark red."""
    from matplotlib.colors import LinearSegmentedColormap

    return LinearSegmentedColormap.from_list("strain", (theme.TILE, "#ea7b3c", "#9c1f1f", "#3d0a1e"))


def deployment_film(
    sheet: MovingSheet, openings: Float[np.ndarray, " k"], torsion: float, drive: str, width: int = 440
) -> bytes:
    """Return a film of a sheet that opens and closes again.

    Parameters
    ----------
    sheet : MovingSheet
    openings : (k,)
        Of every state, over that of the deployed sheet.
    torsion : float
        lambda.
    drive : str
    width : int
        In pixels.

    Returns
    -------
    bytes
        GIF.
    """
    extent = sheet.extent
    height = int(np.clip(width * extent[1] / extent[0], 0.5 * width, 1.1 * width))
    font, small = ImageFont.load_default(17), ImageFont.load_default(13)
    frames: list[Image.Image] = []
    for k, opening in enumerate(openings.tolist()):
        page = Image.new("RGB", (width, height + _FOOT), theme.PAPER)
        page.paste(sheet.picture(k, (width, height)), (0, 0))
        canvas = ImageDraw.Draw(page)
        strain = f"largest strain {100 * float(sheet.strains[k].max()):.1f} %" if sheet.is_strained else "no strain"
        canvas.text((14, height + 8), f"open to {100 * abs(opening):.0f} %", theme.INK, font)
        canvas.text((14, height + 32), f"physical path, lambda = {torsion:g}, {drive} drive", theme.MUTED, small)
        canvas.text((width - 14, height + 8), strain, theme.INK, font, "ra")
        if sheet.is_strained:
            _scale(page, canvas, small, sheet.largest_strain)
        frames.append(page.quantize(_COLORS, Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE))
    there_and_back = [*frames, *frames[-2:0:-1]]
    seconds: Sequence[int] = [_REST if k in (0, len(frames) - 1) else _MILLISECONDS for k in range(len(there_and_back))]
    buffer = io.BytesIO()
    frames[0].save(buffer, "GIF", save_all=True, append_images=there_and_back[1:], duration=seconds, loop=0)
    return buffer.getvalue()


def _scale(page: Image.Image, canvas: ImageDraw.ImageDraw, font: Any, largest: float) -> None:
    """Draw the scale of strain into the lower right corner."""
    width, (length, depth) = page.width, _BAR
    y = page.height - _FOOT + 32
    words = f"{100 * largest:.2g} %"
    right = width - 14 - round(canvas.textlength(words, font)) - 6
    colors = np.rint(255 * strain_colors()(np.linspace(0, 1, length))[:, :3]).astype(np.uint8)
    page.paste(Image.fromarray(np.repeat(colors[None], depth, axis=0)), (right - length, y + 4))
    canvas.text((width - 14, y), words, theme.MUTED, font, "ra")
    canvas.text((right - length - 6, y), "0", theme.MUTED, font, "ra")
