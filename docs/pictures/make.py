"""Draw the README's pictures again: `python docs/pictures/make.py`, from anywhere, in less than a minute."""

from __future__ import annotations

import io
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
from matplotlib import colormaps
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.cm import ScalarMappable
from matplotlib.colors import Normalize
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from PIL import Image

import kirisurf
from kirisurf.publishing import sheet
from viewers import theme
from viewers.drawing import colormap
from viewers.fields import Field, name_unit
from viewers.framing import fit_frame, round_length
from viewers.scenes import standard_scenes
from viewers.snapshot import draw

FOLDER = Path(__file__).resolve().parent
COLUMNS = {
    "target": "Target",
    "pattern": "Flat, closed",
    "deployed": "Opened on the target",
    "mean_curvature": "Mean curvature",
    "gaussian_curvature": "Gaussian curvature",
}
DPI = 100
HEAD, BAR = 46, 44  # pixels above all rows for the headings, and below every row for the color bars
WORDS, NUMBERS = 19.0, 14.0  # points at DPI; pages show the pictures at about half their size
COLORS = 256


def strip(designs: Sequence[tuple[str, kirisurf.Design]], path: Path, panel: tuple[int, int]) -> None:
    """Write one row of pictures for every design, all of a row at one scale.

    Parameters
    ----------
    designs : sequence of (str, Design)
        Name in the margin, empty for none, and design.
    path : Path
    panel : (int, int)
        Width and height of one picture in pixels.
    """
    w, h = panel
    left = HEAD if any(name for name, _ in designs) else 0
    width, height = left + w * len(COLUMNS), HEAD + (h + BAR) * len(designs)
    figure = Figure(figsize=(width / DPI, height / DPI), dpi=DPI, facecolor=theme.PAPER)
    FigureCanvasAgg(figure)
    for column, words in enumerate(COLUMNS.values()):
        x = (left + (column + 0.5) * w) / width
        figure.text(x, 1 - 0.72 * HEAD / height, words, fontsize=WORDS, color=theme.INK, ha="center")
    for row, (name, design) in enumerate(designs):
        base = height - HEAD - (row + 1) * (h + BAR) + BAR
        middle = (base + 0.5 * h) / height
        figure.text(
            0.5 * left / width, middle, name, fontsize=WORDS, color=theme.INK, rotation=90, ha="center", va="center"
        )
        fields = {(where, key): v for where in ("vertex", "tile", "hole") for key, v in design.fields(where).items()}
        scenes = standard_scenes(
            sheet(
                design.tessellation,
                design.deployed_points,
                design.contracted_points,
                design.surface,
                fields,
                design.spec.units,
            )
        )
        frames = {key: fit_frame(scenes[key].view, scenes[key].frame, w / h, margin=0.02) for key in COLUMNS}
        largest = max(frame.half_height for frame in frames.values())
        _scale(figure, design.spec.units or "unit", 2 * largest / h, left + 1.5 * w, base - 14, 0.35 * w)
        for column, (key, frame) in enumerate(frames.items()):
            x = left + column * w
            axes = figure.add_axes((x / width, base / height, w / width, h / height))
            axes.imshow(draw(scenes[key], panel, replace(frame, half_height=largest)), interpolation="nearest")
            axes.set_axis_off()
            field = scenes[key].field
            if field is not None:
                _bar(figure, field, x + 0.15 * w, base - 14, 0.7 * w)
    picture = io.BytesIO()
    figure.savefig(picture, format="png", dpi=DPI, metadata={"Software": None})
    _few_colors(Image.open(picture).convert("RGB")).save(path, optimize=True)


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


def _scale(figure: Figure, units: str, per_pixel: float, x: float, y: float, longest: float) -> None:
    """Draw a scale bar about (x, y), in pixels from the lower left: all pictures of a row have one scale."""
    width, height = figure.get_size_inches() * DPI
    length = round_length(longest * per_pixel)
    half = 0.5 * length / per_pixel
    ends = ((x - half, y + 10), (x - half, y), (x + half, y), (x + half, y + 10))
    figure.add_artist(
        Line2D([px / width for px, _ in ends], [py / height for _, py in ends], color=theme.INK, linewidth=1.2)
    )
    label = f"{length:g} {name_unit(units, length)}"
    figure.text(x / width, (y - 20) / height, label, fontsize=NUMBERS, color=theme.MUTED, ha="center")


def _bar(figure: Figure, field: Field, x: float, y: float, length: float) -> None:
    """Draw a color bar of given length with its ends as numbers; (x, y) in pixels from the lower left."""
    width, height = figure.get_size_inches() * DPI
    axes = figure.add_axes((x / width, y / height, length / width, 10 / height))
    bar = figure.colorbar(
        ScalarMappable(Normalize(*field.limits), colormap(field)), cax=axes, orientation="horizontal", ticks=[]
    )
    bar.outline.set_visible(False)
    unit = f" {field.unit}".replace(" 1/unit²", "").replace(" 1/unit", "")
    low, high = field.limits
    for place, value, align in ((x, low, "left"), (x + length, high, "right")):
        text = f"{value:.2g}".replace("-", "\N{MINUS SIGN}") + (unit if align == "right" else "")
        figure.text(place / width, (y - 20) / height, text, fontsize=NUMBERS, color=theme.MUTED, ha=align)


def main() -> None:
    """Write every picture."""
    practical = kirisurf.fit("saddle_roof", tiles=160), kirisurf.fit("face_mask", tiles=300)
    strip([("", design) for design in practical], FOLDER / "overview.png", (400, 270))
    published = ("hypar", "paraboloid", "peaks", "mexicanhat2")
    strip([(name, kirisurf.fit(name, cells=(4, 4))) for name in published], FOLDER / "published.png", (360, 270))


if __name__ == "__main__":
    main()
