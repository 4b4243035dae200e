"""Strips: designs as rows of pictures at one scale a row, with scale bars, color bars and few colors."""

from __future__ import annotations

import io
from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.collections import PolyCollection
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from PIL import Image

import kirisurf
from kirisurf.publishing import sheet
from kirisurf.reproducing import Shape
from viewers import theme
from viewers.drawing import colormap
from viewers.fields import Field, name_unit
from viewers.figures import TONES
from viewers.framing import fit_frame, round_length
from viewers.scenes import Scene, standard_scenes
from viewers.snapshot import draw

TITLES = {
    "target": "Target",
    "pattern": "Flat, closed",
    "deployed": "Opened on the target",
    "mean_curvature": "Mean curvature",
    "gaussian_curvature": "Gaussian curvature",
}
PLANAR = ("flat, closed", "open in its outline")
DPI = 100
HEAD, BAR = 52, 60  # pixels above all rows for the headings, and below every row for the bars
WORDS, NUMBERS = 20.0, 16.5  # points at DPI; pages show the pictures at half to two thirds of their size
COLORS = 256
_RAISED = str.maketrans("-0123456789", "⁻⁰¹²³⁴⁵⁶⁷⁸⁹")


def surfaces(
    designs: Sequence[tuple[str, kirisurf.Design]], path: Path, panel: tuple[int, int], columns: Sequence[str]
) -> None:
    """Write one row of pictures for every design on a surface, all of a row at one scale.

    Parameters
    ----------
    designs : sequence of (str, Design)
        Name in the margin, empty for none, and design.
    path : Path
    panel : (int, int)
        Width and height of one picture in pixels.
    columns : sequence of str
        Keys of `TITLES`.
    """
    page = _Page([name for name, _ in designs], [TITLES[key] for key in columns], panel)
    for row, (_, design) in enumerate(designs):
        scenes = _scenes(design)
        frames = {key: fit_frame(scenes[key].view, scenes[key].frame, panel[0] / panel[1], 0.02) for key in columns}
        largest = max(frame.half_height for frame in frames.values())
        page.scale(row, 1, 2 * largest / panel[1], design.spec.units or "unit")
        for column, (key, frame) in enumerate(frames.items()):
            page.axes(row, column).imshow(
                draw(scenes[key], panel, replace(frame, half_height=largest)), interpolation="nearest"
            )
            field = scenes[key].field
            if field is not None:
                page.color_bar(row, column, field)
    page.save(path)


def outlines(designs: Sequence[tuple[str, kirisurf.Design]], path: Path, panel: tuple[int, int]) -> None:
    """Write planar designs in one row, each closed and open in its outline, the two at one scale.

    Parameters
    ----------
    designs : sequence of (str, Design)
        Name in the headings, empty for none, and design.
    path : Path
    panel : (int, int)
        Width and height of one picture in pixels.
    """
    titles = [f"{name}: {word}" if name else word.capitalize() for name, _ in designs for word in PLANAR]
    page = _Page([""], titles, panel)
    for k, (_, design) in enumerate(designs):
        shape = Shape.of(design)
        if shape.outline is None:
            raise ValueError(f"{design.surface.name}: expected a planar outline, got a surface")
        states = shape.contracted, shape.deployed[:, :2]
        curve = np.concatenate([shape.outline, shape.outline[:1]])
        per_pixel = max(float((np.ptp(points, axis=0) / panel).max()) for points in (*states, curve)) / 0.94
        for column, points in zip((2 * k, 2 * k + 1), states, strict=True):
            axes = page.axes(0, column)
            _tiles(axes, shape, points)
            around = points if column == 2 * k else np.concatenate([points, curve])
            if column > 2 * k:
                axes.plot(*curve.T, color=theme.SERIES[0], linewidth=1.6)
            middle, half = 0.5 * (around.min(axis=0) + around.max(axis=0)), 0.5 * np.array(panel) * per_pixel
            axes.set_xlim(middle[0] - half[0], middle[0] + half[0])
            axes.set_ylim(middle[1] - half[1], middle[1] + half[1])
        page.scale(0, 2 * k, per_pixel, design.spec.units or "unit")
    page.save(path)


def _scenes(design: kirisurf.Design) -> Mapping[str, Scene]:
    fields = {(where, key): v for where in ("vertex", "tile", "hole") for key, v in design.fields(where).items()}
    points = design.deployed_points, design.contracted_points
    return standard_scenes(sheet(design.tessellation, *points, design.surface, fields, design.spec.units))


def _tiles(axes: object, shape: Shape, points: np.ndarray) -> None:
    fine = min(1.0, (150.0 / len(shape.tiles)) ** 0.5)
    axes.add_collection(
        PolyCollection(
            [points[tile] for tile in shape.tiles],
            facecolors=[TONES[tone] for tone in shape.tones.tolist()],
            edgecolors=theme.TILE_EDGE,
            linewidths=1.3 * fine,
            joinstyle="round",
        )
    )


class _Page:
    """A page of panels with headings above, names in the margin and room for bars below every row."""

    def __init__(self, names: Sequence[str], titles: Sequence[str], panel: tuple[int, int]) -> None:
        self.panel, self.rows = panel, len(names)
        self.left = HEAD if any(names) else 0
        self.width, self.height = self.left + panel[0] * len(titles), HEAD + (panel[1] + BAR) * len(names)
        self.figure = Figure(figsize=(self.width / DPI, self.height / DPI), dpi=DPI, facecolor=theme.PAPER)
        FigureCanvasAgg(self.figure)
        for column, words in enumerate(titles):
            self.write(self.left + (column + 0.5) * panel[0], self.height - 0.72 * HEAD, words, WORDS, theme.INK)
        for row, name in enumerate(names):
            middle = self.base(row) + 0.5 * panel[1]
            self.write(0.5 * self.left, middle, name, WORDS, theme.INK, rotation=90, va="center")

    def base(self, row: int) -> float:
        """Height of the lower edge of a row's pictures above the page's."""
        return self.height - HEAD - (row + 1) * (self.panel[1] + BAR) + BAR

    def axes(self, row: int, column: int) -> object:
        """Axes that fill a panel, without a frame."""
        x = self.left + column * self.panel[0]
        place = (x / self.width, self.base(row) / self.height)
        axes = self.figure.add_axes((*place, self.panel[0] / self.width, self.panel[1] / self.height))
        axes.set_axis_off()
        return axes

    def write(
        self, x: float, y: float, words: str, size: float, color: str, ha: str = "center", **more: object
    ) -> None:
        """Write words at (x, y), in pixels from the lower left."""
        self.figure.text(x / self.width, y / self.height, words, fontsize=size, color=color, ha=ha, **more)

    def scale(self, row: int, column: int, per_pixel: float, units: str) -> None:
        """Draw a scale bar below a panel: all pictures of the row have one scale."""
        length = round_length(0.35 * self.panel[0] * per_pixel)
        x, y, half = self.left + (column + 0.5) * self.panel[0], self.base(row) - 18, 0.5 * length / per_pixel
        ends = ((x - half, y + 10), (x - half, y), (x + half, y), (x + half, y + 10))
        line = [px / self.width for px, _ in ends], [py / self.height for _, py in ends]
        self.figure.add_artist(Line2D(*line, color=theme.INK, linewidth=1.6))
        self.write(x, y - 28, f"{length:g} {name_unit(units, length)}", NUMBERS, theme.MUTED)

    def color_bar(self, row: int, column: int, field: Field) -> None:
        """Draw the color bar of a signed field below a panel, with the number at both ends."""
        length = 0.74 * self.panel[0]
        x, y = self.left + column * self.panel[0] + 0.13 * self.panel[0], self.base(row) - 20
        axes = self.figure.add_axes((x / self.width, y / self.height, length / self.width, 12 / self.height))
        mappable = ScalarMappable(Normalize(*field.limits), colormap(field))
        bar = self.figure.colorbar(mappable, cax=axes, orientation="horizontal", ticks=[])
        bar.outline.set_visible(False)
        self.write(x, y - 27, "\N{MINUS SIGN}", NUMBERS, theme.MUTED)
        self.write(x + length, y - 27, "+", NUMBERS, theme.MUTED)
        self.write(x + 0.5 * length, y - 27, _both_ends(field), NUMBERS, theme.MUTED)

    def save(self, path: Path) -> None:
        """Write the page."""
        picture = io.BytesIO()
        self.figure.savefig(picture, format="png", dpi=DPI, metadata={"Software": None})
        _few_colors(Image.open(picture).convert("RGB")).save(path, optimize=True)


def _both_ends(field: Field) -> str:
    """The number at the ends of a color bar that is symmetric about zero, with its unit."""
    largest = field.limits[1]
    power = 0 if largest >= 0.01 else int(np.floor(np.log10(largest)))
    words = f"\N{PLUS-MINUS SIGN}{largest / 10.0**power:.2g}"
    if power:
        words += f"·10{str(power).translate(_RAISED)}"
    return words if "unit" in field.unit else f"{words} {field.unit}"


def _few_colors(picture: Image.Image) -> Image.Image:
    """Return a picture with a palette, a third of the bytes; the colors of the maps get their share of it."""
    name, low, high = theme.DIVERGING
    colors = (255 * colormaps[name](np.linspace(low, high, picture.width))[None, :, :3]).round().astype(np.uint8)
    swatch = Image.fromarray(np.repeat(colors, picture.height // 5, axis=0))
    both = Image.new("RGB", (picture.width, picture.height + swatch.height))
    both.paste(picture, (0, 0))
    both.paste(swatch, (0, picture.height))
    result = picture.quantize(palette=both.quantize(COLORS), dither=Image.Dither.NONE)
    palette = result.getpalette()
    paper = 3 * int(result.getpixel((0, 0)))
    palette[paper : paper + 3] = [255, 255, 255]  # the nearest color to white is not quite white
    result.putpalette(palette)
    return result
